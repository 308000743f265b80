// A step with contacts, limits and constraints (Stewart and Trinkle 1996; Anitescu and Potra 1997; Moreau's law for impacts): the free
// velocity at the end of the step, the impulses lambda that the rows of all that acts need there, and the configuration that follows:
//   v_free = v + h ddq(q, v, tau)      v' = v_free + M^-1 J^T lambda      q' = q (+) (h v' + M^-1 J^T mu)
// What is still apart may close its gap, not more: c_n >= -gap / h. What overlaps, and constraints that drifted, are corrected by mu in q
// alone, so that no correction becomes velocity.
#pragma once

#include "collision/pair_contacts.hpp"
#include "algorithm/constrained/delassus.hpp"
#include "constraint/list.hpp"
#include "simulation/workspace.hpp"

namespace dyn::simulation {

// Whether steps of this data may meet rows at all.
inline bool has_constraints(const Model& m, const Data<double>& d) {
  if ((m.n.contacts > 0 && d.step->pair_count != 0) || (d.acting & DYN_EFFECT_LIMITS)) return true;
  for (Index k = 0; k < m.n.slots; ++k)
    if (d.slots[k].rows) return true;
  return false;
}

// Whether some of them may make velocities jump: contacts, limits, dry friction. Constraints that hold at every moment do not.
inline bool may_jump(const Model& m, const Data<double>& d) {
  if (m.n.contacts > 0 || (d.acting & DYN_EFFECT_LIMITS)) return true;
  for (Index k = 0; k < m.n.slots; ++k)
    if (d.slots[k].rows && one_sided(d.slots[k].c.type)) return true;
  return false;
}

// Whose degree of freedom it is, of the expanded ones.
inline Index body_of_dof(const Model& m, Index dof) {
  Index low = 1, high = m.n.bodies;
  while (high - low > 1) {
    const Index middle = (low + high) / 2;
    (m.bodies()[middle].idx_v <= dof ? low : high) = middle;
  }
  return low;
}

// Of the model's own length, or rad:
inline constexpr double slop = 1e-9;         // what no correction is made for
inline constexpr double limit_margin = 1e-4;  // limits this near count however slow the joint is

// Of a coordinate, or a velocity, that is an angle 1, else the model's own length.
inline double unit_of(const Model& m, const Workspace& w, const LimitRecord& r) { return m.bodies()[r.body].type == BodyType::Prismatic ? w.length : 1; }

inline bool is_ball(const Model& m, const LimitRecord& r) { return m.bodies()[r.body].type == BodyType::Spherical; }
// Of a ball joint by how much its angle a = 2 atan2(|u|, |w|) may grow, and da / d(rotation), which is the unit axis in its own axes; where there is
// no rotation yet, along the velocity v there.
struct BallGap {
  double gap;
  Vec3<double> axis;
};
BallGap ball_gap(const Model& m, const Data<double>& d, const LimitRecord& r, const double* v);  // find_constraints.cpp
inline double ball_speed(const LimitRecord& r, const double* v) { return shape::norm(load3(v + r.dof)); }
// Rate of the one row of a limit.
inline double limit_rate(const ConstraintInstance<double>& s, const double* v) { return of_ball(s.c) ? dot(s.c.axis, load3(v + s.c.v1)) : s.g1 * v[s.c.v1]; }

// Slow, m/s: what has fallen a twentieth of the model's own length, or comes to a thousandth of it in the step.
inline double slow_speed(const Data<double>& d, double h) {
  const double length = d.step->length, g = shape::norm(load3(d.world_gravity));
  return std::max(0.32 * std::sqrt(g * length), 1e-3 * length / h);
}

// What is farther apart does not meet within a step of h, whatever impulses there are; fast: speeds before. Where steps follow from an
// accuracy they may be so short that all that is near would be far.
inline constexpr double reopen_factor = 3;  // of w.closed: what was pressed in the step before opens later than it would close
inline double contact_margin(const Workspace& w, double h, double fast) { return w.closed_gap > 0 ? reopen_factor * w.closed_gap + 10 * h * fast : HUGE_VAL; }

// After forward dynamics, with its free velocity v_free: contacts within reach of a step of h, limits, constraints. Answers how many slots
// act; by islands in d.step->order, and contacts in d.step->contacts.
Index find_constraints(const Model& m, Data<double>& d, const double* v_free, double h);

// The impulses of all islands: v becomes v', and dq the correction. Answers whether there is one. v_before: at the beginning of the step.
bool solve_constraints(const Model& m, Data<double>& d, Index slots, const double* v_before, double h, double* v, double* dq);

// steps of this file
// contact_points.cpp; between: no two shapes are nearer, if positive
Index find_contacts(const Model& m, Data<double>& d, double h, double& min_distance);
// contact_rows.cpp: what a contact is between, by which law; the rest of its slot
void init_contact(const Model& m, Data<double>& d, Index contact, double h, ConstraintInstance<double>& s);
void assemble_contact(const Model& m, Data<double>& d, const ActiveConstraint& x);
void order_by_islands(Data<double>& d, Index slots);                  // islands.cpp

// What the rows of a slot leave at degrees of freedom.
inline void propagate_rows(const Model& m, Data<double>& d, const ActiveConstraint& x) {
  if (m.has_mimic) eliminate_constraint(m, d, *x.s, x.support, x.Y);
  else propagate(m, d, *x.s, x.support, x.Y);
}

// What a step's box of a shape is wider by.
double box_margin(const Workspace& w, const Data<double>& d, Index geom, double h);

// f(contact, the same one in the step before or nullptr), of those that are asked for.
template <class Asked, class F>
void for_each_with_previous(Workspace& w, Asked&& asked, F&& f) {
  using collision::comes_before;
  Index k = 0;
  for (Index i = 0; i < w.contact_count; ++i) {
    dynContactForce& x = w.contacts[i];
    if (!asked(x)) continue;
    while (k < w.previous_count && comes_before(w.previous[k].contact, x.contact)) ++k;
    f(x, k < w.previous_count && !comes_before(x.contact, w.previous[k].contact) ? w.previous + k : nullptr);
  }
}
// What it exerted then.
inline void copy_force(dynContactForce& f, const dynContactForce* before) {
  for (int i = 0; i < 3; ++i) f.force_on_b[i] = before ? before->force_on_b[i] : 0, f.moment_on_b[i] = before ? before->moment_on_b[i] : 0;
}

inline bool is_active(const dynContactForce& f) { return dot(load3(f.force_on_b), load3(f.force_on_b)) > 0; }
// Of a contact or a limit.
inline double gap_of(const Workspace& w, const ActiveConstraint& x) { return x.kind == RowKind::Contact ? w.contacts[x.index].contact.distance : x.s->error[0]; }
// How fast it becomes smaller; v: of all coordinates (Data::expand).
double approach_speed(const Model& m, const Data<double>& d, const ActiveConstraint& x, const double* v);
// Of contacts and limits of the last step, which met none of these, what a further displacement dq makes nearer than closed: to passed and late.
void record_overshoot(const Model& m, Data<double>& d, const double* dq, double closed);

// Velocity of the point of a body that is at x of the world; V: at the tree's root, else d.step->root_velocity.
inline Vec3<double> velocity_at(const Data<double>& d, Index body, const Vec3<double>& x, const Motion<double>& V) {
  return V.linear + cross(V.angular, x - (d.p[body] - d.rel[body]));
}
inline Vec3<double> velocity_at(const Data<double>& d, Index body, const Vec3<double>& x) { return velocity_at(d, body, x, d.step->root_velocity[body]); }

}  // namespace dyn::simulation
