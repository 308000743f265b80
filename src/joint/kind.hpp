// The joints that users name. Each kind K is one file: it derives from Kind<K> and gives, as static members,
//   type           its dynJointType
//   nq, nv         sizes of its coordinates
//   elements(g)    the chain of primitives that it is, in the joint's frame; algorithms see those only
// kinds.hpp names them all.
#pragma once

#include <array>

#include "dyn.h"
#include "joint/body.hpp"

namespace dyn {

using Axis = std::array<double, 3>;
inline constexpr Axis x_axis = {1, 0, 0}, y_axis = {0, 1, 0}, z_axis = {0, 0, 1};

// What the user says of a joint: unit vectors; x and y complete axis to a right-handed triad.
struct JointGeometry {
  Axis axis, axis2, x, y;
  double pitch;  // m/rad
};

struct Element {
  BodyType type;
  Axis axis;  // unit, in the joint's frame
  double pitch = 0;
  bool wraps = false;  // differences go the short way round
};

struct Elements {
  Element element[3];
  int count;
  constexpr const Element* begin() const { return element; }
  constexpr const Element* end() const { return element + count; }
};

template <class K>
struct Kind {
  static constexpr bool needs_axis2 = false;

 protected:
  template <class... E>
  static constexpr Elements chain(E... e) {
    return {{e...}, int(sizeof...(E))};
  }
};

}  // namespace dyn
