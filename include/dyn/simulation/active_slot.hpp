// What a step of simulation works on: the slots of rows that act in it, by island.
#pragma once

#include "dyn/constraint/slot.hpp"

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

// What a contact is beside its rows.
struct ContactLaw {
  Vec3<double> axes[3];  // two across the normal, the normal
  dynMaterial material;
  double slip[3];        // wanted velocity of B relative to A along the axes
  Index body_a, body_b, rows;
};

inline constexpr int island_vectors = 12;

inline dynStepOptions default_options() {
  return {sizeof(dynStepOptions), DYN_SEMI_IMPLICIT_EULER, 1e-3, 0, DYN_CONTACT_ADMM, 100, 1e-9};
}

}  // namespace dyn::simulation
