// Which pairs of a collision shape are left out.
#pragma once

#include <cstdint>

namespace dyn {

// For two shapes the lower rule counts. Masks and disabled pairs count besides.
enum class PairFilter : std::uint8_t {
  Guess,     // a body and its parent; shapes that overlap in nearly every configuration
  Parents,   // a body and its parent: the file (SRDF) lists all other pairs
  Mujoco,    // a body and its parent, unless the parent is fixed to the world
  SameBody,  // MuJoCo's, without its filter of parents
};

}  // namespace dyn
