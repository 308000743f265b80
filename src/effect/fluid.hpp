// Drag of a medium (dyn_builder_set_medium) on the box of equal inertia of each link without ellipsoids (fluid_ellipsoids.hpp).
// With v, w relative to the medium, in the box's axes, half sizes r, a, b about axis i, and their mean s:
//   force_i  = -(2 density a b |v_i| + 6 pi viscosity s) v_i
//   moment_i = -(density r (a^4 + b^4) |w_i| / 2 + 8 pi viscosity s^3) w_i
#pragma once

#include <cmath>

#include "effect/effect.hpp"
#include "effect/medium.hpp"

namespace dyn::effect {

struct Fluid : Listed<Fluid> {
  static constexpr std::uint32_t bit = DYN_EFFECT_FLUID;
  static constexpr const char* absent = "there is no medium";
  static constexpr bool needs_velocity = true;
  DYN_EFFECT_WORK(fluid)
  template <class M>
  static auto records(const M& m) { return std::span(m.drag_boxes(), std::size_t(m.n.drag_boxes)); }

  template <class T, class M, class R>
  static Force<T> drag(const M& m, const R& box, const Vec3<T>& v, const Vec3<T>& w) {
    using std::abs;
    constexpr double pi = 3.14159265358979323846;
    const double mean = (box.half[0] + box.half[1] + box.half[2]) / 3;
    T force[3], moment[3];
    for (int i = 0; i < 3; ++i) {
      const double r = box.half[i], a = box.half[(i + 1) % 3], b = box.half[(i + 2) % 3];
      const T vi = v[i], wi = w[i];
      force[i] = -(T(2 * m.density * a * b) * abs(vi) + T(6 * pi * m.viscosity * mean)) * vi;
      moment[i] =
          -(T(0.5 * m.density * r * (a * a * a * a + b * b * b * b)) * abs(wi) + T(8 * pi * m.viscosity * mean * mean * mean)) *
          wi;
    }
    return {load3(force), load3(moment)};
  }
  template <class T, class M, class D, class R>
  static Force<T> wrench(const M& m, const D& d, const R& x) {
    return wrench_of_medium<T>(m, d, x, [&](const Vec3<T>& v, const Vec3<T>& w) { return drag<T>(m, x, v, w); });
  }
};

}  // namespace dyn::effect
