// A time step with contacts, limits and constraints, at the level of velocities
// (Stewart and Trinkle 1996; Anitescu and Potra 1997; Moreau's law for impacts):
//   v_free = v + h ddq(q, v, tau)      v' = v_free + M^-1 J^T lambda      q' = q (+) (h v' + M^-1 J^T mu)
// An open gap may close within the step but not more: c_n >= -gap / h.
// Overlap and constraint drift are corrected by mu in q alone, so no correction becomes velocity.
#pragma once

#include "collision/pair_contacts.hpp"
#include "algorithm/constrained/path_row.hpp"
#include "constraint/list.hpp"
#include "simulation/workspace.hpp"

namespace dyn::simulation {

inline bool has_friction_rows(const Data<double>& d) { return (d.acting & acting_friction_rows) != 0; }
// Returns whether any contact, limit or constraint can act in steps of this data.
inline bool has_constraints(const Model& m, const Data<double>& d) {
  if ((m.n.contacts > 0 && d.step->pair_count != 0) || (d.acting & (DYN_EFFECT_LIMITS | acting_friction_rows))) return true;
  for (Index k = 0; k < m.n.slots; ++k)
    if (d.slots[k].rows) return true;
  return m.n.path_rows > 0 && (d.acting & driving_effects);
}
bool paths_may_jump(const Model& m, const Data<double>& d);  // path_rows.hpp
// Whether rows are as an MJCF file has them (compliant_rows.cpp).
template <class T>
bool has_file_rows(const Data<T>& d) {
  if constexpr (std::is_same_v<T, double>) return d.step->options.contact_model == DYN_CONTACT_MODEL_AS_FILE;
  return false;
}

// Returns whether velocities may jump: contacts, limits or dry friction. Bilateral constraints do not make them jump.
inline bool may_jump(const Model& m, const Data<double>& d) {
  if (m.n.contacts > 0 || (d.acting & DYN_EFFECT_LIMITS)) return true;
  for (Index k = 0; k < m.n.slots; ++k)
    if (d.slots[k].rows && one_sided(d.slots[k].c.type)) return true;
  return m.n.path_rows > 0 && paths_may_jump(m, d);
}

// Returns the body of an expanded degree of freedom.
inline Index body_of_dof(const Model& m, Index dof) {
  Index low = 1, high = m.n.bodies;
  while (high - low > 1) {
    const Index middle = (low + high) / 2;
    (m.bodies()[middle].idx_v <= dof ? low : high) = middle;
  }
  return low;
}

// Returns the unit of a limited coordinate: 1 for an angle, else the model's length scale (m).
inline double unit_of(const Model& m, const Workspace& w, const LimitRecord& r) {
  return m.bodies()[r.body].type == BodyType::Prismatic ? w.length : 1;
}

inline bool is_ball(const Model& m, const LimitRecord& r) { return m.bodies()[r.body].type == BodyType::Spherical; }
// Gap of a ball joint's limit and its gradient: gap = max angle - a, a = 2 atan2(|u|, |w|), axis = da / d(rotation) in body axes.
// At zero rotation the axis is the direction of v.
struct BallGap {
  double gap;
  Vec3<double> axis;
};
BallGap ball_gap(const Model& m, const Data<double>& d, const LimitRecord& r, const double* v);  // find_constraints.cpp
inline double ball_speed(const LimitRecord& r, const double* v) { return shape::norm(load3(v + r.dof)); }
// Velocity of a bounded row. v: expanded.
inline double box_rate(const Model& m, const Data<double>& d, const ConstraintInstance<double>& s, const double* v) {
  if (of_path(s.c)) [[unlikely]] return path_rate(m, d, s, v);
  return of_ball(s.c) ? dot(s.c.axis, load3(v + s.c.v1)) : s.g1 * v[s.c.v1];
}

// Speed (m/s) below which impacts are treated as rest: max(0.32 sqrt(g L), 1e-3 L/h), L the model's length scale.
inline double slow_speed(const Data<double>& d, double h) {
  const double length = d.step->length, g = shape::norm(load3(d.world_gravity));
  return std::max(tuning::slow_fall * std::sqrt(g * length), tuning::slow_shift * length / h);
}

// Largest speed (m/s) at which overlaps and drift are removed: that of a fall over length / 20, 0.32 sqrt(g L), however short the
// step, so that shorter steps find the same motion. Without gravity nothing but the step sets a speed: 1e-3 L/h.
inline bool correction_falls(const Data<double>& d) {
  return shape::norm(load3(d.world_gravity)) > 0;
}
inline double correction_speed(const Data<double>& d, double h) {
  const double length = d.step->length, g = shape::norm(load3(d.world_gravity));
  return correction_falls(d) ? tuning::slow_fall * std::sqrt(g * length) : tuning::slow_shift * length / h;
}

// Whether a degree of freedom is a length: of a prismatic joint, or the first three of a free flyer.
inline bool is_length(const Model& m, Index dof) {
  const Body& b = m.bodies()[body_of_dof(m, dof)];
  return b.type == BodyType::Prismatic || (b.type == BodyType::FreeFlyer && dof < b.idx_v + 3);
}

// Gap beyond which shapes do not meet within a step of h. max_speed: before the step (m/s).
// radius: of the smaller shape, in lanes or alone. In fixed steps no contact beyond would get an impulse (drop_open).
template <class T>
T contact_margin(const Workspace& w, double h, double max_speed, const T& radius) {
  if (w.closed_gap > 0) return T(w.reopen_gap + tuning::free_closing * h * max_speed);
  if (w.options.accuracy > 0) return T(HUGE_VAL);  // the search for the next event
  return radius * tuning::search::touching + tuning::speed_growth * h * max_speed;
}

// Finds the contacts, limits and constraints that act in a step of h, after forward dynamics with the free velocity v_free.
// Returns their number. d.step->order holds them by islands, d.step->contacts the contacts.
Index find_constraints(const Model& m, Data<double>& d, const double* v_free, double h);

// Solves all islands: v becomes v', dq the position correction. v_before: velocity at the beginning of the step.
// Returns whether there is a correction.
bool solve_constraints(const Model& m, Data<double>& d, Index slots, const double* v_before, double h, double* v, double* dq);

// contact_points.cpp. min_distance: lower bound of the distance between any two shapes, if positive.
Index find_contacts(const Model& m, Data<double>& d, double h, double& min_distance);
void take_previous_forces(const Model& m, Data<double>& d);  // first_guess.cpp
// contact_rows.cpp: the bodies and the material of a contact, then its rows.
void init_contact(const Model& m, Data<double>& d, Index contact, double h);
void assemble_contact(const Model& m, Data<double>& d, ActiveConstraint& x);
// For rows as the file has them (compliant_rows.cpp): keeps the contacts that touch; sets a constraint's rows as MuJoCo has them.
void keep_touching(const Model& m, Workspace& w);
void set_file_rows(const Model& m, const Data<double>& d, ConstraintInstance<double>& s, const double* v);
// Drops the contacts with the largest distances while the rows of all exceed their room.
void fit_contact_rows(const Model& m, Data<double>& d);
void order_by_islands(const Model& m, Data<double>& d, Index slots);  // islands.cpp

// The wrenches of a contact's rows, in an instance that the next call overwrites. Its frame must be known (assemble_contact).
const ConstraintInstance<double>& contact_wrenches(const Model& m, Data<double>& d, const ActiveConstraint& x);
// Rows that are not kept. slot: 0 or 1, which of two are made.
PropagatedRows propagate_anew(const Model& m, Data<double>& d, const ActiveConstraint& x, int slot);
// J^T columns propagated to the root; sets s.support_count.
inline void propagate_rows(const Model& m, Data<double>& d, ConstraintInstance<double>& s, Index* support, double* Y) {
  if (m.has_mimic) eliminate_constraint(m, d, s, support, Y);
  else propagate(m, d, s, support, Y);
  if (s.dropped) clear_dropped(s, Y);
}
// Propagates the rows of s and keeps them for x, if there is room.
inline void keep_rows(const Model& m, Data<double>& d, ConstraintInstance<double>& s, ActiveConstraint& x) {
  Workspace& w = *d.step;
  Index* const support = w.support + w.stored;
  double* const Y = w.Y + row_lanes * std::ptrdiff_t(w.stored);
  propagate_rows(m, d, s, support, Y);
  x.support_count = s.support_count, x.kept = {support, Y};
  if (w.stored + s.support_count <= columns(m)) w.stored += s.support_count;
  else x.kept = {};
}
inline bool is_path_row(const ActiveConstraint& x) { return x.s && of_path(x.s->c); }
inline const double* rates_of(const Workspace& w, const ActiveConstraint& x) { return x.s ? x.s->rate : w.laws[x.index].rate; }

// Returns by how much (m) the bounding box of a shape is enlarged in a step.
double box_margin(const Workspace& w, const Data<double>& d, Index geom, double h);

// Calls f(contact, the same contact in the previous step or nullptr) for the contacts that `asked` selects.
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
// Copies force and moment from the previous step, zero if there was none.
inline void copy_force(dynContactForce& f, const dynContactForce* before) {
  for (int i = 0; i < 3; ++i)
    f.force_on_b[i] = before ? before->force_on_b[i] : 0, f.moment_on_b[i] = before ? before->moment_on_b[i] : 0;
}

inline bool is_active(const dynContactForce& f) { return dot(load3(f.force_on_b), load3(f.force_on_b)) > 0; }
// Gap of a contact or a limit (m or rad).
inline double gap_of(const Workspace& w, const ActiveConstraint& x) {
  return x.kind == RowKind::Contact ? w.contacts[x.index].contact.distance : x.s->error[0];
}
// Speed at which the gap shrinks. v: velocities of the expanded coordinates (Data::expand).
double approach_speed(const Model& m, const Data<double>& d, const ActiveConstraint& x, const double* v);
// Enters in overshoot and overshoot_time by how much a further displacement dq takes inactive contacts and limits beyond
// closed_gap.
void record_overshoot(const Model& m, Data<double>& d, const double* dq, double closed);

// Velocity of a shape's belt, world axes.
inline Vec3<double> surface_velocity(const Data<double>& d, Index geom) {
  return d.geom_poses[geom].R * load3(d.step->materials[geom].surface_velocity);
}

// Velocity of the point x (world axes) of a body. V: the body's twist at the tree's root, by default d.step->root_velocity.
inline Vec3<double> velocity_at(const Data<double>& d, Index body, const Vec3<double>& x, const Motion<double>& V) {
  return V.linear + cross(V.angular, x - (d.p[body] - d.rel[body]));
}
inline Vec3<double> velocity_at(const Data<double>& d, Index body, const Vec3<double>& x) {
  return velocity_at(d, body, x, d.step->root_velocity[body]);
}

}  // namespace dyn::simulation
