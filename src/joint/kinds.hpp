// The closed list of the kinds of joints that users name. A new kind is a file, a line here, and a line in dynJointType.
#pragma once

#include "joint/continuous.hpp"
#include "joint/cylindrical.hpp"
#include "joint/list.hpp"
#include "joint/planar.hpp"
#include "joint/spherical_zyx.hpp"
#include "joint/translation.hpp"
#include "joint/universal.hpp"

namespace dyn {

#define DYN_KINDS(X)                                                                                            \
  X(Revolute) X(Continuous) X(Prismatic) X(Helical) X(Cylindrical) X(Universal) X(Spherical) X(SphericalZYX) X(Planar) \
  X(Translation) X(FreeFlyer) X(RevoluteUnbounded)

// f.template operator()<K>() for the kind of that type; nothing for FIXED, COMPOSITE and unknown types.
template <class F>
void visit_kind(dynJointType type, F&& f) {
#define DYN_TRY(K) \
  if (type == kind::K::type) return f.template operator()<kind::K>();
  DYN_KINDS(DYN_TRY)
#undef DYN_TRY
}

}  // namespace dyn
