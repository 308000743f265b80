// Buffers of a simulation step: options, report, contacts and the constraints that act.
#pragma once

#include "collision/pair_contacts.hpp"
#include "collision/pair_search.hpp"
#include "simulation/clearances.hpp"
#include "simulation/conservative_advancement.hpp"
#include "simulation/elimination.hpp"
#include "simulation/free_bodies.hpp"
#include "simulation/sleep.hpp"
#include "simulation/tuning.hpp"
#include "solver/time_limit.hpp"
#include "solver/workspace.hpp"

namespace dyn::simulation {

enum class RowKind : Index { Equality, Box, Contact };

// Degrees of freedom that a constraint acts on, descending, and its J^T columns propagated to the root, row_lanes numbers each
// (algorithm/constrained/delassus.hpp).
struct PropagatedRows {
  const Index* support;
  const double* Y;
};

struct ActiveConstraint {
  ConstraintInstance<double>* s;  // null: of a contact (ContactLaw)
  PropagatedRows kept;            // null: there was no room, they are made anew where they are read (rows_of)
  Index support_count, rows, first;
  RowKind kind;
  Index index;         // number of the contact or joint limit, or -1
  Index tree1, tree2;  // -1: the world
  Index island;
  bool idle;           // all constraints of its island are idle: nothing to solve; or it is open
  bool open;           // a contact that cannot close within the step
  bool far = false;    // an equality that is further off than a step corrects
};

// Frame and material of a contact.
struct ContactLaw {
  alignas(64) double rate[row_lanes];  // free velocities of its rows
  Index geom_a, geom_b;
  Vec3<double> axes[3];  // two tangents, then the normal
  dynMaterial material;
  double slip[2];        // wanted tangential velocity of B relative to A (m/s)
  Index rows;
  bool idle;             // it separates, or stays at rest, without any impulse
  Index island;          // island number in Sleep
  // axis of a row's force or moment
  const Vec3<double>& axis(Index row) const { return axes[rows == 1 || (rows == 4 && row == 3) ? 2 : row % 3]; }
};

inline bool is_soft(const dynMaterial& x) { return x.stiffness > 0 || x.damping > 0; }
// Index of the normal among a contact's rows.
inline Index normal_row(Index rows) { return rows == 1 ? 0 : 2; }

// A constraint in a Newton step.
struct NewtonConstraint : solver::BlockState {
  // de Saxce's correction while it is fixed (fixed_correction.cpp): its value, its last change, the over-relaxation factor
  double correction, corrected, relaxed;
  solver::LawMatrix law;
};
inline constexpr int island_vectors = 7, contact_vectors = 4, newton_vectors = 17;

// A row on the length of a path (path_rows.hpp).
struct PathRow {
  Index row, path;
};

// Two shapes that can meet, a < b. number: their pair, -1 if it is not listed.
struct NearPair {
  Index a, b, number;
};

// Consecutive pairs of the list from `first` on: shape a with b, b + 1, ...
struct PairRow {
  Index a, b, first, count;
};

// State of the ledger: energy (J), powers by source (W), momentum and external force.
struct LedgerState {
  struct Power {
    double applied, actuators, wrenches, damping, friction, fluid;
  };
  double energy;
  Power power;
  double momentum[3], force[3];
};
// Work of the impulses of a step (J), and their errors. work: that of forces, where the integrator tells it: those at joints (an
// Euler step), or all (its stages).
struct LedgerRows {
  LedgerState::Power work;
  bool at_joints, all;
  double normal, sliding, limits, constraints, correction, impulse[3], drift, cone, complementarity;
};
struct Ledger {
  bool open;
  dynErrorLedger report;  // of the last call that made steps
  LedgerState before;
  LedgerRows rows;
  double *q, *tau;
};

struct Workspace {
  dynStepOptions options;
  dynStepReport report;  // of the last call that made steps
  solver::TimeLimit limit;  // of the step
  bool time_is_up() { return limit.is_up(); }
  // What the options ask for; 0 is the default. Without a tolerance a solve ends where it no longer improves.
  bool has_tolerance() const { return options.tolerance > 0 || options.accuracy > 0; }
  double tolerance() const {
    return options.tolerance > 0 ? options.tolerance : has_tolerance() ? tuning::island::fine : tuning::island::tolerance;
  }
  // Over everything that the solve of an island tries; of one method.
  Index max_iterations() const {
    return options.max_iterations > 0 ? options.max_iterations
           : has_tolerance()          ? tuning::island::fine_iterations
                                      : tuning::island::iterations;
  }
  Index method_iterations() const {
    return std::max(std::min(max_iterations(), tuning::island::iterations), max_iterations() / tuning::island::methods);
  }
  Index contact_count, previous_count, saved_count;
  // largest distance (m, rad) and time (s) by which something passed closed_gap before its impulse
  double overshoot, overshoot_time;
  double length;           // length scale of the model (own_length), m; angles use 1 rad
  bool ends_fast;          // something may move by more than guarded_motion in a step as the last, or its speed is no number
  double guarded_motion;   // rad, or of the length: a step with less of it is not guarded (energy_guard.hpp)
  // time (s) in which the fastest pair found moves by its gap, at least a fifth of the smaller shape's radius
  double time_to_pass;
  // gap (m, rad) that counts as closed; 0 in fixed steps, where an open gap may close exactly
  double closed_gap;
  double reopen_gap;            // hysteresis: active contacts open at a larger gap, when closed_gap > 0
  int drift_count;              // drifts since the step began, when closed_gap > 0
  // rows_add_energy: impulses of an island, or an explicit step beside them, may have done positive work.
  // rows_work: what soft rows, gains, restitution and belts give (J)
  bool rows_add_energy;
  bool corrected;               // an error of positions was corrected in the step
  double rows_work;
  double growth;                // of the kinetic energy, that nothing explained in steps so far (energy_guard.hpp)
  Index failed_joint;           // that the message of a refused step names
  double stable_dt;             // s, of an explicit method that is unstable
  double recorded_time;         // s, of the step: the part before an event, which the ledger has already

  Ledger ledger;
  FreeBodies free_bodies;

  // allocated only for models with contacts, limits or constraints
  AdvancementCache advancement_cache;
  shape::ShapeMaterial* materials;  // of collision shapes
  // speeds: bound on the speed of any point of a shape. centers: x, y, z and bounding radius, each for all shapes
  double *speeds, *centers;
  Clearances clearances;
  NearPair* pairs;              // pairs that can ever meet
  Index* geoms;                 // shapes of these pairs
  Index pair_count, geom_count;  // -1: not yet found
  NearPair* awake_pairs;        // pairs with an awake body
  Index* awake_geoms;           // awake shapes of these
  Index awake_pair_count, awake_geom_count;  // -1: not yet found
  PairRow* rows;                // rows of the pairs in use
  Index row_count;              // -1: not yet found
  bool by_boxes;                // too many pairs for the list: the broad phase finds them (collision/pair_search.hpp)
  // tree_of: first body of a body's tree, -1 the world; trees coupled by mimic joints share it. tree_links: union-find
  Index *tree_of, *tree_links;
  Motion<double>* root_velocity;  // free twist of each body at its tree's root
  ConstraintInstance<double>* instances;  // step_instances; one more: a contact, while its rows are made
  // PropagatedRows: `stored` of columns() in use, room for two constraints whose rows are not kept, and for the rows on paths
  Index* support;
  double* Y;
  Index stored;
  ActiveConstraint* active;
  Index* order;                 // active constraints by islands
  // contacts of the last step, of the one before, and those saved for retries of a step
  dynContactForce *contacts, *previous, *saved;
  // of joint limits, likewise: N, N m, negative at an upper limit
  double *limit_forces, *previous_limit_forces, *saved_limit_forces;  // of remembered_rows
  Index limits;
  PathRow* path_rows;  // that act
  // of constraints between frames, by slots: force and moment about the world's origin on the first body, then on the second
  double* frame_forces;  // nullptr: no sensor reads them
  ContactLaw* laws;
  // of one island: by rows, by bounded rows, by contacts; its matrix
  double *vectors, *bounds, *coefficients, *matrix;
  Index* contact_rows;
  solver::Block* blocks;        // of an island's constraints
  solver::LocalCone* cones;     // of some whose friction cone has more than three rows, or a singular block
  double* by_dof;
  double* tree_speeds;          // of an island: fastest point of a tree, and of the trees that it touches
  Segments segments;            // of Newton's method
  Elimination elimination;
  NewtonConstraint* newton;
  double *newton_vectors, *run_rows, *by_segment, *diagonal, *blocks_above;
  Index* where;
  bool *newton_acts, *newton_filled;
  Sleep sleep;
  Index constraint_count;             // active in this step
  solver::Workspace solver;     // of islands with a dense matrix
};

// Room of the pair list. It holds all pairs where the advancement cache skips most searches.
inline std::ptrdiff_t pair_capacity(const Model& m) {
  const std::ptrdiff_t some = collision::search_pairs_per_shape * std::ptrdiff_t(m.n.geoms), listed = m.n.pairs;
  if (!lists_pairs(m)) return some;
  const bool single = m.n.nq == m.n.nv && m.n.bodies - 1 == m.n.nv;  // every joint has one coordinate
  return single ? listed : std::min(listed, some);
}

std::ptrdiff_t frame_force_numbers(const Model& m);  // frame_forces.cpp
// Trees of bodies that can rest, and the bytes they take in the workspace.
Index resting_trees(const Model& m);
std::size_t sleep_bytes(const Model& m);
void set_up_sleep(const Model& m, Workspace& w);  // sleep.cpp

// Calls f with the trees that this step visits.
template <class F>
decltype(auto) with_active_trees(const Data<double>& d, F&& f) {
  return d.step && d.step->sleep.enabled ? f(d.step->sleep.awake) : f(AllTrees{});
}
// The same without the bodies that are integrated in batches. part: the trees otherwise.
template <class Part, class F>
decltype(auto) with_unbatched_trees(const Data<double>& d, const Part& part, F&& f) {
  return d.step && d.step->free_bodies.batched ? f(d.step->free_bodies.others) : f(part);
}
template <class F>
decltype(auto) with_unbatched_trees(const Data<double>& d, F&& f) {
  return with_active_trees(d, [&](const auto& part) { return with_unbatched_trees(d, part, f); });
}
// Calls f(first, end) for each range of degrees of freedom that impulses may change.
template <class F>
void for_each_impulse_range(const Model& m, const Data<double>& d, F&& f) {
  with_unbatched_trees(d, [&](const auto& part) { part.for_each_group(m, [&](const Trees& t) { f(t.v, t.v_end); }); });
  const FreeBodies& l = d.step->free_bodies;
  for (Index k = 0; l.batched && k < l.touched_count; ++k) f(m.bodies()[l.touched[k]].idx_v, m.bodies()[l.touched[k]].idx_v + 6);
}
// Calls f(contact) for all contacts of the last step in order, those of sleeping bodies included.
template <class F>
void for_each_contact(const Workspace& w, F&& f) {
  const dynContactForce *a = w.contacts, *const a_end = a + w.contact_count,
                        *b = w.sleep.sleeping_contacts, *const b_end = b + w.sleep.sleeping_contact_count;
  while (a != a_end || b != b_end) f(b == b_end || (a != a_end && collision::comes_before(a->contact, b->contact)) ? *a++ : *b++);
}
// Retries of a step start from the same contacts and forces.
inline void save_forces(Workspace& w) {
  std::copy_n(w.contacts, w.contact_count, w.saved), w.saved_count = w.contact_count;
  std::copy_n(w.limit_forces, w.limits, w.saved_limit_forces);
}
inline void restore_forces(Workspace& w) {
  std::copy_n(w.saved, w.saved_count, w.contacts), w.contact_count = w.saved_count;
  std::copy_n(w.saved_limit_forces, w.limits, w.limit_forces);
}
// Must be called when anything a step starts from may have changed.
inline void invalidate_sleep(Data<double>& d) {
  if (d.step) d.step->sleep.inputs_known = false;
}

// Arrays over shapes are read four at a time.
inline std::ptrdiff_t geom_capacity(const Model& m) { return std::ptrdiff_t(m.n.geoms) + Double4::lanes; }

// Instances of limits, of rows on paths and of dry friction as the file has it (compliant_rows.cpp).
inline Index step_instances(const Model& m) { return m.n.limits + m.n.path_rows + m.n.friction_rows; }
inline Index step_constraints(const Model& m) { return m.n.slots + m.n.contacts + step_instances(m); }
// Bounded rows.
inline Index step_bounds(const Model& m) { return m.n.slots + step_instances(m); }
// Rows of contacts: three each. Contacts with torsion or rolling have up to six.
inline Index contact_row_capacity(const Model& m) {
  return std::min(6 * m.n.contacts, 3 * m.n.contacts + tuning::capacity::more_contact_rows);
}
// Cones that are kept between sweeps.
inline Index cone_capacity(const Model& m) {
  return std::min(step_constraints(m), tuning::capacity::cones + std::max<Index>(0, step_constraints(m) - 3 * tuning::capacity::few));
}
inline Index step_rows(const Model& m) { return m.n.constraint_rows + contact_row_capacity(m) + step_instances(m); }
// Whose forces are remembered: limits, then rows on paths.
inline Index remembered_rows(const Model& m) { return m.n.limits + m.n.path_rows; }
// Rows of the largest island for which there is a dense Delassus matrix. More than two a degree of freedom are redundant: other
// methods are cheaper.
inline Index dense_capacity(const Model& m) {
  const Index some = std::max(tuning::capacity::dense_rows * std::max<Index>(1, m.n.manifold_joints), 2 * m.n.nv);
  return std::min({step_rows(m), some, tuning::island::dense_rows});
}
// Small models: the matrix of an island is made anew after each solve, which uses its memory.
inline bool matrix_is_shared(const Model& m) { return dense_capacity(m) <= tuning::capacity::dense_rows; }
// Columns of rows that are kept, by supporting degrees of freedom; those of other constraints are made anew (PropagatedRows).
inline std::ptrdiff_t columns(const Model& m) {
  using namespace tuning::capacity;
  const std::ptrdiff_t own = m.n.contacts + m.n.limits + m.n.friction_rows,
                       wide = std::max<Index>(0, m.n.carriers - short_support);
  return std::min(own * m.n.carriers, std::max<std::ptrdiff_t>(least_columns, own_columns * (own - few)) + wide_rows * wide);
}

// The workspace in the memory given: zeros, aligned to 64 bytes. Arrays that an island's solve alone uses lie in buffers of
// other parts that it does not use (SharedMemory in workspace.cpp).
std::size_t workspace_bytes(const Model& m);
Workspace* place(const Model& m, Data<double>& d, void* memory);
dynStepOptions default_options();
dynStepOptions default_options(const Model& m);  // of new data

}  // namespace dyn::simulation
