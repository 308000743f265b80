// Translation in the plane normal to axis, then rotation about it. The x and y of the plane are those of the joint's frame,
// turned by the smallest rotation that takes its z to axis.
#pragma once

#include "joint/kind.hpp"

namespace dyn {

namespace kind {

struct Planar : Kind<Planar> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_PLANAR;
  static constexpr int nq = 3, nv = 3;
  static constexpr Elements elements(const JointGeometry& g) {
    return chain(Element{BodyType::Prismatic, g.x}, Element{BodyType::Prismatic, g.y}, Element{BodyType::Revolute, g.axis});
  }
};

}  // namespace kind

}  // namespace dyn
