// Angle about axis, then about axis2, which turns with it.
#pragma once

#include "joint/kind.hpp"

namespace dyn {

namespace kind {

struct Universal : Kind<Universal> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_UNIVERSAL;
  static constexpr int nq = 2, nv = 2;
  static constexpr bool needs_axis2 = true;
  static constexpr Elements elements(const JointGeometry& g) {
    return chain(Element{BodyType::Revolute, g.axis}, Element{BodyType::Revolute, g.axis2});
  }
};

}  // namespace kind

}  // namespace dyn
