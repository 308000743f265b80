// Material of a pair of shapes: the larger friction and restitution, springs in series. Priorities and kinds of friction are
// MuJoCo's.
#pragma once

#include <algorithm>
#include <cmath>

#include "dyn.h"
#include "base/types.hpp"

namespace dyn::shape {

inline dynMaterial default_material() { return {1, 0, 0, 0, 0, 0, {0, 0, 0}}; }

// A stiffness of 0 means rigid.
inline double stiffness_in_a_row(double a, double b) {
  if (a == 0 || b == 0) return a + b;
  return 1 / (1 / a + 1 / b);
}

struct ShapeMaterial : dynMaterial {
  std::int32_t priority = 0;  // of two shapes the one of higher priority decides alone
  std::uint32_t latent = 0;   // so many kinds of friction, from rolling up, act only beside a shape of which they act
};
inline constexpr int least_priority = -4, largest_priority = 3;

// What acts: latent 1 is without rolling, 2 without torsion, 3 without sliding friction.
inline dynMaterial acting(dynMaterial x, std::uint32_t latent) {
  if (latent > 0) x.rolling = 0;
  if (latent > 1) x.torsion = 0;
  if (latent > 2) x.friction = 0;
  return x;
}

inline dynMaterial combined(const ShapeMaterial& a, const ShapeMaterial& b) {
  if (a.priority != b.priority) {
    const ShapeMaterial& x = a.priority > b.priority ? a : b;
    return acting(x, x.latent);
  }
  const dynMaterial larger = {std::max(a.friction, b.friction),
                              std::max(a.torsion, b.torsion),
                              std::max(a.rolling, b.rolling),
                              std::max(a.restitution, b.restitution),
                              stiffness_in_a_row(a.stiffness, b.stiffness),
                              std::max(a.damping, b.damping),
                              {0, 0, 0}};
  return acting(larger, std::min(a.latent, b.latent));
}

inline Index contact_rows(const dynMaterial& x) {
  if (x.friction == 0) return 1;
  return x.rolling > 0 ? 6 : x.torsion > 0 ? 4 : 3;
}

// Returns the first number out of range with its name, or nullptr.
struct BadNumber {
  const char* name;
  double value;
};
inline BadNumber bad_number(const dynMaterial& x) {
  const BadNumber numbers[] = {{"friction", x.friction},       {"torsion", x.torsion},     {"rolling", x.rolling},
                               {"restitution", x.restitution}, {"stiffness", x.stiffness}, {"damping", x.damping}};
  for (const BadNumber& n : numbers)
    if (!(n.value >= 0 && n.value <= 1e15)) return n;
  if (x.restitution > 1) return {"restitution", x.restitution};
  for (const double v : x.surface_velocity)
    if (!(std::abs(v) <= 1e9)) return {"surface_velocity", v};
  return {nullptr, 0};
}

}  // namespace dyn::shape
