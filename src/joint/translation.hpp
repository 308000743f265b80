// Translation in three directions.
#pragma once

#include "joint/kind.hpp"

namespace dyn {

namespace kind {

struct Translation : Kind<Translation> {
  static constexpr dynJointType type = DYN_JOINT_TYPE_TRANSLATION;
  static constexpr int nq = 3, nv = 3;
  static constexpr Elements elements(const JointGeometry&) {
    return chain(Element{BodyType::Prismatic, x_axis}, Element{BodyType::Prismatic, y_axis},
                 Element{BodyType::Prismatic, z_axis});
  }
};

}  // namespace kind

}  // namespace dyn
