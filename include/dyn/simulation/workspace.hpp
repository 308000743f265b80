// What steps need beside the fields of data: options, report, contacts, and the slots of rows that act in a step.
#pragma once

#include "dyn/model/data.hpp"
#include "dyn/simulation/clearance.hpp"
#include "dyn/simulation/elimination.hpp"
#include "dyn/solver/workspace.hpp"

namespace dyn::simulation {

enum class RowKind : Index { Equality, Box, Contact };

struct ActiveSlot {
  Slot<double>* s;
  Index* support;   // degrees of freedom that carry it, descending
  double* carried;  // what its rows leave there (constraint/delassus.hpp)
  RowKind kind;
  Index index;         // number of the contact, or -1
  Index tree1, tree2;  // islands are connected trees; -1: the world
  Index island;
};

// The trees of a slot, the second -1 where there is one.
inline Index tree_a(const ActiveSlot& s) { return s.tree1 < 0 ? s.tree2 : s.tree1; }
inline Index tree_b(const ActiveSlot& s) { return s.tree1 < 0 || s.tree2 == s.tree1 ? -1 : s.tree2; }

// What a contact is beside its rows.
struct ContactLaw {
  Vec3<double> axes[3];  // two across the normal, the normal
  dynMaterial material;
  double slip[2];        // wanted velocity of B relative to A across the normal
  Index rows;
  // of its moments and forces: the axis of a row
  const Vec3<double>& axis(Index row) const { return axes[rows == 1 || (rows == 4 && row == 3) ? 2 : row % 3]; }
};

inline bool is_soft(const dynMaterial& x) { return x.stiffness > 0 || x.damping > 0; }
// Of a contact's rows.
inline Index normal_row(Index rows) { return rows == 1 ? 0 : 2; }

// What Gauss-Seidel without a matrix needs of a slot: its own block of G with the normal first, rows scaled so that the cone is round.
struct SlotBlock {
  alignas(64) double G[most_rows * row_lanes];
  double diagonal[most_rows], scale[most_rows];
  solver::LocalCone local;
};

// A slot in a step of Newton's method, its rows with the normal first, in units in which diagonals are 1 and cones round.
struct NewtonSlot {
  const Index* order;   // of its rows
  Index rows, unknowns;  // none: at a bound, or apart
  bool cone;
  decltype(solver::ConeState::is) is;
  double mu, across, lower, upper;
  double unit[most_rows], speed[2];  // of impulses; of normal and other velocities of a cone
  double direction[5][5];            // along the sliding, then across
  double stiffness[most_rows];       // of unknowns: impulse by velocity
  double law[most_rows][most_rows];  // the same of rows: impulse (first index) by velocity
};
inline constexpr int island_vectors = 12, newton_vectors = 17;

struct Workspace {
  dynStepOptions options;
  dynStepReport report;  // of the last call that made steps
  Index contact_count, before_count;

  // the rest is there when something may act
  Clearance clearance;
  dynMaterial* materials;       // of collision shapes
  double* speeds;               // no point of theirs is faster
  Index *pairs, *geoms;         // pairs that can ever meet, and their shapes
  Index pair_count, geom_count;  // -1: to be found
  Index *tree_of, *tree_links;  // of bodies: the first body of the tree, of coupled ones that of the first, -1: the world; union-find
  Motion<double>* root_velocity;  // of bodies: free, W at the tree's root
  Slot<double>* slots;          // of contacts and limits
  Index* support;
  double* carried;
  ActiveSlot* active;
  Index* order;                 // the same by islands
  dynContactForce *contacts, *before;  // of the last step, and of the one before
  ContactLaw* laws;
  double *vectors, *matrix;     // of an island's problem
  Index* contact_rows;
  SlotBlock* blocks;            // of the slots of an island
  double* by_dof;
  Segments segments;            // of Newton's method
  Elimination elimination;
  NewtonSlot* newton;
  double *newton_vectors, *run_rows, *by_segment, *pivots, *diagonal, *blocks_above;
  Index* where;
  bool *newton_acts, *newton_filled;
  char* solver_memory;
  solver::Workspace solver;
};

// Of an island that is solved by its whole matrix.
inline Index step_slots(const Model& m) { return m.n.slots + m.n.contacts + m.n.limits; }
inline Index step_rows(const Model& m) { return m.n.constraint_rows + 6 * m.n.contacts + m.n.limits; }
inline Index island_rows(const Model& m) { return std::min<Index>(step_rows(m), 240); }

}  // namespace dyn::simulation
