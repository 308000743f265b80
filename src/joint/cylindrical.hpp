// Angle about axis, then displacement along it.
#pragma once

#include "joint/kind.hpp"

namespace dyn {

namespace kind {

struct Cylindrical : Kind<Cylindrical> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_CYLINDRICAL;
  static constexpr int nq = 2, nv = 2;
  static constexpr Elements elements(const JointGeometry& g) {
    return chain(Element{BodyType::Revolute, g.axis}, Element{BodyType::Prismatic, g.axis});
  }
};

}  // namespace kind

}  // namespace dyn
