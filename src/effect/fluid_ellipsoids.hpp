// Forces of a medium (dyn_builder_set_medium) on the ellipsoids of shapes (dyn_builder_set_shape_fluid): MuJoCo's ellipsoid-based
// fluid model. With u, w relative to the medium, in the ellipsoid's axes, semiaxes d, density rho, viscosity beta:
//   n_i = (d_j d_k)^2 u_i, A = pi |n| / sqrt(n . u) the area that the flow sees, A_max = pi d_max d_mid
//   drag      -(3 pi D beta + rho |u| (C_blunt A + C_slender (A_max - A))) u,  D = 2/3 (d_1 + d_2 + d_3)
//   spin drag -(pi D^3 beta + rho |C_angular I w + C_slender (I_max - I) w|) w,
//             I_i = 8/15 pi d_i max(d_j, d_k)^4, I_max = 8/15 pi d_mid d_max^4
//   lift      C_Kutta rho cos(u, n) A (n x u) x u / |n| = C_Kutta rho pi sqrt(n . u) / (|u| |n|) (n x u) x u
//   Magnus    C_Magnus rho V w x u,  V = 4/3 pi d_1 d_2 d_3
//   added mass m and inertia J of the potential flow: force (m u) x w, moment (m u) x u + (J w) x w
// Lift, Magnus force and added mass do no work.
#pragma once

#include <algorithm>
#include <cmath>

#include "effect/effect.hpp"
#include "effect/medium.hpp"

namespace dyn::effect {

struct FluidEllipsoids : Listed<FluidEllipsoids> {
  static constexpr std::uint32_t bit = DYN_EFFECT_FLUID_ELLIPSOIDS;
  static constexpr const char* absent = "no shape has fluid forces of its own";
  static constexpr bool needs_velocity = true;
  DYN_EFFECT_WORK(fluid)
  template <class M>
  static auto records(const M& m) { return std::span(m.fluid_ellipsoids(), std::size_t(m.n.fluid_ellipsoids)); }

  template <class T>
  static T length(const Vec3<T>& x) {
    using std::sqrt;
    return dot(x, x) > T(0) ? sqrt(dot(x, x)) : T(0);  // at zero the root has no derivative, and all that it scales is zero
  }
  // In the ellipsoid's axes, about its centre.
  template <class T, class M, class R>
  static Force<T> on(const M& m, const R& e, const Vec3<T>& u, const Vec3<T>& w) {
    using std::sqrt;
    constexpr double pi = 3.14159265358979323846;
    const double* const d = e.half;
    const auto& [blunt, slender, angular, kutta, magnus] = e.coefficients;
    const double largest = std::max({d[0], d[1], d[2]}),
                 middle = std::max(std::min(d[0], d[1]), std::min(std::max(d[0], d[1]), d[2]));
    const double rho = m.density, round = 2.0 / 3 * (d[0] + d[1] + d[2]), most_area = pi * largest * middle;
    double face[3], inertia[3];
    for (int i = 0; i < 3; ++i) {
      const double a = d[(i + 1) % 3], b = d[(i + 2) % 3], c = std::max(a, b);
      face[i] = a * b * a * b, inertia[i] = 8.0 / 15 * pi * d[i] * c * c * c * c;
    }
    const double most_inertia = 8.0 / 15 * pi * middle * largest * largest * largest * largest;
    const auto scaled = [](const double* s, const Vec3<T>& x) {
      return Vec3<T>::make(T(s[0]) * x[0], T(s[1]) * x[1], T(s[2]) * x[2]);
    };

    const Vec3<T> n = scaled(face, u);
    const T speed = length(u), normal = length(n), along = dot(n, u);
    const T root = along > T(0) ? sqrt(along) : T(0), area = root > T(0) ? T(pi) * normal / root : T(0);
    const T drag = T(3 * pi * round * m.viscosity) + T(rho) * speed * (T(blunt) * area + T(slender) * (T(most_area) - area));
    Vec3<T> force = u * -drag + cross(w, u) * T(magnus * rho * 4 / 3 * pi * d[0] * d[1] * d[2]);
    if (root > T(0)) force += cross(cross(n, u), u) * (T(kutta * rho * pi) * root / (speed * normal));

    double spin[3];
    for (int i = 0; i < 3; ++i) spin[i] = angular * inertia[i] + slender * (most_inertia - inertia[i]);
    const T spin_drag = T(pi * round * round * round * m.viscosity) + T(rho) * length(scaled(spin, w));
    const Vec3<T> p = scaled(e.added_mass, u) * T(rho), L = scaled(e.added_inertia, w) * T(rho);
    force += cross(p, w);
    return {force, w * -spin_drag + cross(p, u) + cross(L, w)};
  }
  template <class T, class M, class D, class R>
  static Force<T> wrench(const M& m, const D& d, const R& x) {
    return wrench_of_medium<T>(m, d, x, [&](const Vec3<T>& u, const Vec3<T>& w) { return on<T>(m, x, u, w); });
  }
};

}  // namespace dyn::effect
