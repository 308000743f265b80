// Joints that are chains of primitives: how each user's joint type moves, in the joint's frame.
// A new joint type that is a chain is a line here and a line in dynJointType; the algorithms see its primitives only.
#pragma once

#include <array>
#include <vector>

#include "dyn.h"
#include "dyn/model/body.hpp"

namespace dyn {

using Axis = std::array<double, 3>;

struct Element {
  BodyType type;
  Axis axis;  // unit, in the joint's frame
  double pitch = 0;
  bool wraps = false;
};

// axis, axis2: unit vectors; x, y complete axis to a right-handed triad
inline std::vector<Element> chain_elements(dynJointType type, const Axis& axis, const Axis& axis2, const Axis& x, const Axis& y,
                                           double pitch) {
  constexpr Axis ex = {1, 0, 0}, ey = {0, 1, 0}, ez = {0, 0, 1};
  switch (type) {
    case DYN_JOINT_REVOLUTE: return {{BodyType::Revolute, axis}};
    case DYN_JOINT_CONTINUOUS: return {{BodyType::Revolute, axis, 0, true}};
    case DYN_JOINT_PRISMATIC: return {{BodyType::Prismatic, axis}};
    case DYN_JOINT_HELICAL: return {{BodyType::Helical, axis, pitch}};
    case DYN_JOINT_CYLINDRICAL: return {{BodyType::Revolute, axis}, {BodyType::Prismatic, axis}};
    case DYN_JOINT_UNIVERSAL: return {{BodyType::Revolute, axis}, {BodyType::Revolute, axis2}};
    case DYN_JOINT_SPHERICAL: return {{BodyType::Spherical, ez}};
    case DYN_JOINT_SPHERICAL_ZYX: return {{BodyType::Revolute, ez}, {BodyType::Revolute, ey}, {BodyType::Revolute, ex}};
    case DYN_JOINT_PLANAR: return {{BodyType::Prismatic, x}, {BodyType::Prismatic, y}, {BodyType::Revolute, axis}};
    case DYN_JOINT_TRANSLATION: return {{BodyType::Prismatic, ex}, {BodyType::Prismatic, ey}, {BodyType::Prismatic, ez}};
    case DYN_JOINT_FREE_FLYER: return {{BodyType::FreeFlyer, ez}};
    case DYN_JOINT_REVOLUTE_UNBOUNDED: return {{BodyType::RevoluteUnbounded, axis}};
    case DYN_JOINT_FIXED:
    case DYN_JOINT_COMPOSITE: break;
  }
  return {};
}

}  // namespace dyn
