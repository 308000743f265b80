// Random robots with random constraints in their slots.
#pragma once

#include "algorithm/trees.hpp"
#include "algorithm/constrained/algorithms.hpp"
#include "constraint/list.hpp"

namespace dyn_test {

inline dynConstraint random_constraint(Dice& dice, const Model& m, bool gains) {
  static const dynConstraintType types[] = {
      DYN_CONSTRAINT_TYPE_POINT,    DYN_CONSTRAINT_TYPE_FRAME, DYN_CONSTRAINT_TYPE_CONNECT, DYN_CONSTRAINT_TYPE_WELD,
      DYN_CONSTRAINT_TYPE_DISTANCE, DYN_CONSTRAINT_TYPE_LOOP,  DYN_CONSTRAINT_TYPE_COUPLING};
  static const dynJointType joints[] = {DYN_JOINT_TYPE_REVOLUTE,    DYN_JOINT_TYPE_PRISMATIC,  DYN_JOINT_TYPE_HELICAL,
                                        DYN_JOINT_TYPE_CYLINDRICAL, DYN_JOINT_TYPE_UNIVERSAL,  DYN_JOINT_TYPE_SPHERICAL,
                                        DYN_JOINT_TYPE_PLANAR,      DYN_JOINT_TYPE_TRANSLATION};
  dynConstraint c = default_constraint(types[dice.below(7)]);
  const bool between_frames = c.type != DYN_CONSTRAINT_TYPE_COUPLING;
  const int count = between_frames ? m.n.frames : m.n.joints;
  c.first = 1 + dice.below(count - 1), c.second = between_frames && dice.chance(0.5) ? 0 : 1 + dice.below(count - 1);
  const Placement X1 = placement(dice.pose(0.2)), X2 = placement(dice.pose(0.5));
  std::copy(X1.begin(), X1.end(), c.placement1), std::copy(X2.begin(), X2.end(), c.placement2);
  c.joint_type = joints[dice.below(8)];
  const V3 axis = dice.direction(), axis2 = dice.direction();
  std::copy_n(axis.data(), 3, c.axis), std::copy_n(axis2.data(), 3, c.axis2);
  c.pitch = 0.2, c.length = 0.6;
  for (double& x : c.coefficients) x = dice.in(-0.5, 0.5);
  if (gains) c.stiffness = dice.in(0, 20), c.damping = dice.in(0, 5);
  return c;
}

// Constraints that the robot can have, some of them twice.
inline void random_constraints(Case& x, Dice& dice, int most, double twice, bool gains) {
  char message[512];
  const int wanted = 1 + dice.below(most);
  Index slot = 0;
  for (int tries = 0; tries < 20 && slot < wanted; ++tries) {
    const dynConstraint c = random_constraint(dice, x.m, gains);
    if (check_constraint(x.m, c, message, sizeof message) != DYN_OK) continue;
    set_constraint(x.m, x.w.d, slot++, c);
    if (slot < x.m.n.slots && dice.chance(twice)) set_constraint(x.m, x.w.d, slot++, c);
  }
  number_rows(x.m, x.w.d);
}

}  // namespace dyn_test
