// From what users say of a constraint to a slot of the data.
#pragma once

#include <type_traits>

#include "constraint/list.hpp"
#include "model/data.hpp"

namespace dyn {

// What dyn_constraint_init says.
dynConstraint default_constraint(dynConstraintType type);
// Whether the model can have it: DYN_OK, or the error with a sentence in message.
dynStatus check_constraint(const Model& m, const dynConstraint& spec, char* message, std::size_t room);
// What it says alone: numbers and types, not yet frames and joints.
dynStatus check_constraint_numbers(const dynConstraint& spec, char* message, std::size_t room);
// spec must have been checked.
Constraint resolve_constraint(const Model& m, const dynConstraint& spec);

// Numbers the rows that act, in the order of the slots.
template <class T>
void number_rows(const Model& m, Data<T>& d) {
  Index first = 0;
  for (Index s = 0; s < m.n.slots; ++s) {
    ConstraintInstance<T>& slot = d.slots[s];
    slot.rows = slot.enabled ? constraint_rows(slot.c) : 0;
    slot.first = first;
    first += slot.rows;
  }
}

// The anchors of a constraint between frames, where mocap bodies carry them.
template <class T>
void place_anchors(const Model& m, Data<T>& d, Index slot) {
  const dynConstraint& spec = d.constraint_specs[slot];
  if (m.n.mocaps == 0 || spec.type == DYN_CONSTRAINT_TYPE_NONE || between_joints(spec.type)) return;
  if constexpr (std::is_same_v<T, double>) {
    const Constraint fixed = resolve_constraint(m, spec);
    Constraint& c = d.slots[slot].c;
    const Index place1 = m.frames()[spec.first].place, place2 = m.frames()[spec.second].place;
    if (place1 >= m.n.bodies) c.X1 = SE3<double>{d.R[place1], d.p[place1]} * fixed.X1;
    if (place2 >= m.n.bodies) c.X2 = SE3<double>{d.R[place2], d.p[place2]} * fixed.X2;
  }
}

template <class T>
void set_constraint(const Model& m, Data<T>& d, Index slot, const dynConstraint& spec) {
  d.slots[slot] = ConstraintInstance<T>{};
  d.slots[slot].c = resolve_constraint(m, spec);
  d.slots[slot].enabled = spec.enabled != 0;
  d.constraint_specs[slot] = spec;
  d.constraint_specs[slot].struct_size = sizeof spec;
  place_anchors(m, d, slot);
}

template <class T>
void set_up_constraints(const Model& m, Data<T>& d) {
  for (Index s = 0; s < m.n.slots; ++s) set_constraint(m, d, s, s < m.n.constraints ? m.constraints()[s].spec : dynConstraint{});
  number_rows(m, d);
}

}  // namespace dyn
