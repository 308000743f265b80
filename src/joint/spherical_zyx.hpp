// Ball joint by angles about z, then y, then x; singular where the second is +-pi/2.
#pragma once

#include "joint/kind.hpp"

namespace dyn {

namespace kind {

struct SphericalZYX : Kind<SphericalZYX> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_SPHERICAL_ZYX;
  static constexpr int nq = 3, nv = 3;
  static constexpr Elements elements(const JointGeometry&) {
    return chain(Element{BodyType::Revolute, z_axis}, Element{BodyType::Revolute, y_axis}, Element{BodyType::Revolute, x_axis});
  }
};

}  // namespace kind

}  // namespace dyn
