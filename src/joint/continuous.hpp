// Angle about axis without limits: differences are wrapped to (-pi, pi].
#pragma once

#include "joint/kind.hpp"

namespace dyn {

namespace kind {

struct Continuous : Kind<Continuous> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_CONTINUOUS;
  static constexpr int nq = 1, nv = 1;
  static constexpr Elements elements(const JointGeometry& g) {
    return chain(Element{BodyType::Revolute, g.axis, 0, true});
  }
};

}  // namespace kind

}  // namespace dyn
