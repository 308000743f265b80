// Material of a pair of shapes: the larger friction (MuJoCo's rule) and restitution, springs in series.
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

inline dynMaterial combined(const dynMaterial& a, const dynMaterial& b) {
  return {std::max(a.friction, b.friction),
          std::max(a.torsion, b.torsion),
          std::max(a.rolling, b.rolling),
          std::max(a.restitution, b.restitution),
          stiffness_in_a_row(a.stiffness, b.stiffness),
          std::max(a.damping, b.damping),
          {0, 0, 0}};
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
