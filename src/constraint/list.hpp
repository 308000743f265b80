// The closed list of constraints and their only dispatch. A new one is a file, a line here, and a line in dynConstraintType.
#pragma once

#include "constraint/coupling.hpp"
#include "constraint/distance.hpp"
#include "constraint/frame_contact.hpp"
#include "constraint/friction.hpp"
#include "constraint/limit.hpp"
#include "constraint/loop.hpp"
#include "constraint/point_contact.hpp"

namespace dyn {

#define DYN_FRAME_CONSTRAINTS(X) X(PointContact) X(FrameContact) X(Connect) X(Weld) X(Distance) X(Loop)
#define DYN_JOINT_CONSTRAINTS(X) X(Coupling) X(Limit) X(Friction)
#define DYN_CONSTRAINT_CASE(K) \
  case constraint::K::type: return f.template operator()<constraint::K>();

// Calls f.template operator()<K>() if the type is a constraint between frames; below, between joints.
template <class F>
DYN_INLINE void visit_frame_constraint(dynConstraintType type, F&& f) {
  switch (type) {
    DYN_FRAME_CONSTRAINTS(DYN_CONSTRAINT_CASE)
    default: return;
  }
}
template <class F>
DYN_INLINE void visit_joint_constraint(dynConstraintType type, F&& f) {
  switch (type) {
    DYN_JOINT_CONSTRAINTS(DYN_CONSTRAINT_CASE)
    default: return;
  }
}
#undef DYN_CONSTRAINT_CASE

inline bool between_joints(dynConstraintType type) { return type >= DYN_CONSTRAINT_TYPE_COUPLING; }
// Constraints whose force has bounds.
inline bool one_sided(dynConstraintType type) {
  return type == DYN_CONSTRAINT_TYPE_LIMIT || type == DYN_CONSTRAINT_TYPE_FRICTION;
}

inline int constraint_rows(const Constraint& c) {
  int rows = 0;
  auto count = [&]<class K>() { rows = K::rows(c); };
  visit_frame_constraint(c.type, count), visit_joint_constraint(c.type, count);
  return rows;
}

}  // namespace dyn
