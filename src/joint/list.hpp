// The closed list of primitives and the one place that dispatches on them: visit expands to a switch, so that each case
// inlines. A new primitive is a file, a line here, and a line in BodyType (joint/body.hpp).
#pragma once

#include "joint/free_flyer.hpp"
#include "joint/helical.hpp"
#include "joint/prismatic.hpp"
#include "joint/revolute.hpp"
#include "joint/revolute_unbounded.hpp"
#include "joint/spherical.hpp"

namespace dyn {

#define DYN_PRIMITIVES(X) X(Revolute) X(Prismatic) X(Helical) X(RevoluteUnbounded) X(Spherical) X(FreeFlyer)

// f.template operator()<J>()
template <class F>
DYN_INLINE void visit(BodyType type, F&& f) {
  switch (type) {
#define DYN_CASE(J) \
  case BodyType::J: \
    f.template operator()<J>(); \
    break;
    DYN_PRIMITIVES(DYN_CASE)
#undef DYN_CASE
  }
}

}  // namespace dyn
