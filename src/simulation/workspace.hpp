// What steps need beside the fields of data: options, report, contacts, and the slots of rows that act in a step.
#pragma once

#include "collision/pair_contacts.hpp"
#include "collision/pair_search.hpp"
#include "simulation/conservative_advancement.hpp"
#include "simulation/elimination.hpp"
#include "simulation/free_bodies.hpp"
#include "simulation/sleep.hpp"
#include "solver/workspace.hpp"

namespace dyn::simulation {

enum class RowKind : Index { Equality, Box, Contact };

struct ActiveConstraint {
  ConstraintInstance<double>* s;
  Index* support;   // degrees of freedom that carry it, descending
  double* Y;  // J^T columns propagated to the root, row_lanes numbers a supporting dof (algorithm/constrained/delassus.hpp)
  RowKind kind;
  Index index;         // number of the contact, or -1
  Index tree1, tree2;  // islands are connected trees; -1: the world
  Index island;
  bool idle;           // with all of its island
};

// What a contact is beside its rows.
struct ContactLaw {
  Index geom_a, geom_b;
  Vec3<double> axes[3];  // two across the normal, the normal
  dynMaterial material;
  double slip[2];        // wanted velocity of B relative to A across the normal
  Index rows;
  bool idle;             // it opens by itself, or stays as it is
  Index island;          // its number, of what may rest (Sleep::island)
  // of its moments and forces: the axis of a row
  const Vec3<double>& axis(Index row) const { return axes[rows == 1 || (rows == 4 && row == 3) ? 2 : row % 3]; }
};

inline bool is_soft(const dynMaterial& x) { return x.stiffness > 0 || x.damping > 0; }
// Of a contact's rows.
inline Index normal_row(Index rows) { return rows == 1 ? 0 : 2; }

// What Gauss-Seidel without a matrix needs of a slot: its own block of G with the normal first, rows scaled so that the cone is round.
struct ConstraintBlock {
  alignas(64) double G[max_rows * row_lanes];
  double diagonal[max_rows], scale[max_rows];
  solver::LocalCone local;
};

// A slot in a step of Newton's method, its rows with the normal first, in units in which diagonals are 1 and cones round.
struct NewtonConstraint {
  const Index* order;   // of its rows
  Index rows, unknowns;  // none: at a bound, or apart
  bool cone;
  decltype(solver::ConeState::mode) mode;
  double mu, across, lower, upper;
  double correction, corrected, relaxed;  // de Saxce's, held (interior.cpp): m/s in these units; what it last lacked, and the factor that was taken of that
  double unit[max_rows], speed[2];  // of impulses; of normal and other velocities of a cone
  double direction[5][5];            // along the sliding, then across
  double stiffness[max_rows];       // of unknowns: impulse by velocity
  double law[max_rows][max_rows];  // the same of rows: impulse (first index) by velocity
};
inline constexpr int island_vectors = 13, newton_vectors = 17;

// Two shapes that may meet, a < b, and the number of their pair, if it is listed.
struct NearPair {
  Index a, b, number;
};

// Pairs one after another in the list, from `first` on: the shape a with b, b + 1, ...
struct PairRow {
  Index a, b, first, count;
};

// What the ledger needs of a state: energy, powers by source, momentum and its rate by what comes from outside.
struct LedgerState {
  struct Power {
    double applied, actuators, wrenches, damping, friction, fluid;
  };
  double energy;
  Power power;
  double momentum[3], force[3];
};
// Work of the impulses of a step, and what is wrong with them.
struct LedgerRows {
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
  bool (*expired)(const void*);  // null: the step has no deadline
  const void* clock;
  bool time_is_up() const { return expired && expired(clock); }
  Index contact_count, previous_count, saved_count;
  double overshoot, overshoot_time;     // since they were set to 0, at most: how far, m, rad, and how long, s, what was met had been nearer than closed
  double length;           // of the model (own_length): m, where others are rad
  double time_to_pass;             // s: until two of the shapes found last have moved by their distance, or by a fifth of what the smaller reaches
  double closed_gap;           // m, rad: what comes nearer within the step meets at once; 0: what is apart closes its gap in it
  int drift_count;              // with closed: displacements since the step began

  Ledger ledger;
  FreeBodies free_bodies;

  // the rest is there when something may act
  AdvancementCache advancement_cache;
  dynMaterial* materials;       // of collision shapes
  double *speeds, *centers;     // no point of theirs is faster; where they are, x, y and z of all by components, and how far they reach
  NearPair* pairs;              // that can ever meet,
  Index* geoms;                 // and their shapes
  Index pair_count, geom_count;  // -1: to be found
  NearPair* awake_pairs;        // those of which something is awake,
  Index* awake_geoms;           // and what is of their shapes
  Index awake_pair_count, awake_geom_count;  // -1: to be found
  PairRow* rows;                // of the pairs that are looked at now
  Index row_count;              // -1: to be found
  bool by_boxes;                // there are more than the list has room for: pairs are found by boxes (collision/pair_search.hpp)
  Index *tree_of, *tree_links;  // of bodies: the first body of the tree, of coupled ones that of the first, -1: the world; union-find
  Motion<double>* root_velocity;  // of bodies: free, W at the tree's root
  ConstraintInstance<double>* instances;          // of contacts and limits
  Index* support;
  double* Y;
  ActiveConstraint* active;
  Index* order;                 // the same by islands
  dynContactForce *contacts, *previous, *saved;  // of the last step, of the one before, and of that after which tries of a step begin
  ContactLaw* laws;
  double *vectors, *matrix;     // of an island's problem
  double* dense;                // what its rows leave at degrees of freedom side by side
  Index* contact_rows;
  ConstraintBlock* blocks;            // of the slots of an island
  double* by_dof;
  Segments segments;            // of Newton's method
  Elimination elimination;
  NewtonConstraint* newton;
  double *newton_vectors, *run_rows, *by_segment, *pivots, *diagonal, *blocks_above;
  Index* where;
  bool *newton_acts, *newton_filled;
  Sleep sleep;
  Index constraint_count;             // that act in this step
  char* solver_memory;
  solver::Workspace solver;
};

// Of the list of pairs. Where clearance leaves most searches out (has_clearance) it pays to have all of them.
inline std::ptrdiff_t pair_capacity(const Model& m) {
  const std::ptrdiff_t some = collision::pairs_a_shape * std::ptrdiff_t(m.n.geoms), listed = m.n.pairs;
  if (!lists_pairs(m)) return some;
  const bool single = m.n.nq == m.n.nv && m.n.bodies - 1 == m.n.nv;  // joints of one coordinate
  return single ? listed : std::min(listed, some);
}

// Trees of bodies that may rest; what these take of the workspace.
Index resting_trees(const Model& m);
std::size_t sleep_bytes(const Model& m);
void set_up_sleep(const Model& m, Workspace& w);  // sleep.cpp

// f(trees that this step goes through)
template <class F>
decltype(auto) with_active_trees(const Data<double>& d, F&& f) {
  return d.step && d.step->sleep.enabled ? f(d.step->sleep.awake) : f(AllTrees{});
}
// The same without those that fly by themselves in this step; part: otherwise.
template <class Part, class F>
decltype(auto) with_unbatched_trees(const Data<double>& d, const Part& part, F&& f) {
  return d.step && d.step->free_bodies.batched ? f(d.step->free_bodies.others) : f(part);
}
template <class F>
decltype(auto) with_unbatched_trees(const Data<double>& d, F&& f) {
  return with_active_trees(d, [&](const auto& part) { return with_unbatched_trees(d, part, f); });
}
// f(first, end) of degrees of freedom that impulses may change.
template <class F>
void for_each_impulse_range(const Model& m, const Data<double>& d, F&& f) {
  with_unbatched_trees(d, [&](const auto& part) { part.for_each_group(m, [&](const Trees& t) { f(t.v, t.v_end); }); });
  const FreeBodies& l = d.step->free_bodies;
  for (Index k = 0; l.batched && k < l.touched_count; ++k) f(m.bodies()[l.touched[k]].idx_v, m.bodies()[l.touched[k]].idx_v + 6);
}
// f(contact) of the last step, of what is awake and of what sleeps, in order.
template <class F>
void for_each_contact(const Workspace& w, F&& f) {
  const dynContactForce *a = w.contacts, *const a_end = a + w.contact_count, *b = w.sleep.sleeping_contacts, *const b_end = b + w.sleep.sleeping_contact_count;
  while (a != a_end || b != b_end) f(b == b_end || (a != a_end && collision::comes_before(a->contact, b->contact)) ? *a++ : *b++);
}
// Tries of a step begin alike.
inline void save_contacts(Workspace& w) { std::copy_n(w.contacts, w.contact_count, w.saved), w.saved_count = w.contact_count; }
inline void restore_contacts(Workspace& w) { std::copy_n(w.saved, w.saved_count, w.contacts), w.contact_count = w.saved_count; }
// What steps begin from may have changed.
inline void invalidate_sleep(Data<double>& d) {
  if (d.step) d.step->sleep.inputs_known = false;
}

// Of a number by shapes that is read four at a time.
inline std::ptrdiff_t geom_capacity(const Model& m) { return std::ptrdiff_t(m.n.geoms) + Wide::lanes; }

// Of an island that is solved by its whole matrix.
inline Index step_constraints(const Model& m) { return m.n.slots + m.n.contacts + m.n.limits; }
inline Index step_rows(const Model& m) { return m.n.constraint_rows + 6 * m.n.contacts + m.n.limits; }
inline Index island_rows(const Model& m) { return std::min<Index>(step_rows(m), 240); }
inline constexpr Index max_dense_dofs = 64;

}  // namespace dyn::simulation
