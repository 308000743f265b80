// Springs: r = c e with the displacement e = q (-) reference, c in N m/rad or N/m. Turns of a continuous joint count.
// A ball joint has one c for its three degrees of freedom: with e a rotation vector, dr/dq = c Jlog3(e).
#pragma once

#include "effect/effect.hpp"
#include "spatial/explog.hpp"

namespace dyn::effect {

struct Springs : Coefficient<Springs> {
  static constexpr std::uint32_t bit = DYN_EFFECT_SPRINGS;
  static constexpr const char* name = "a stiffness";
  static constexpr dynModelArray array = DYN_MODEL_ARRAY_STIFFNESS;
  static constexpr dynParameterGroup group = DYN_PARAMETER_GROUP_SPRINGS;
  static constexpr const char *quantity = "springs", *absent = "no joint has springs", *mjcf = "stiffness", *urdf = nullptr;
  static constexpr Implicit implicit = Implicit::ImplicitFast;
  static constexpr bool of_configuration = true;
  DYN_EFFECT_COEFFICIENT(stiffness)

  // e of the body's joint J; q: of all joints.
  template <class J, class B, class M, class T>
  static void displacement(const M& m, const B& b, const T* q, T* e) {
    T reference[7];
    for (int k = 0; k < J::nq; ++k) reference[k] = T(m.spring_reference()[b.user_q + k]);
    if constexpr (J::nq == 1) e[0] = q[b.user_q] - reference[0];
    else J::difference(b, reference, q + b.user_q, e);
  }
  // r += c e
  template <class J, class T>
  static void add_force(const T* c, const T* e, T* r) {
    for (int k = 0; k < J::nv; ++k) r[k] += c[k] * e[k];
  }
  // dq += dr/dq, a block of a matrix with the leading dimension ld.
  template <class J, class T>
  static void add_slope(const T* c, const T* e, T* dq, std::ptrdiff_t ld) {
    if constexpr (J::nv == 3) {
      const Mat3<T> by_q = Jlog3(load3(e));
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) dq[i + ld * k] += c[0] * by_q(i, k);
    } else {
      dq[0] += c[0];
    }
  }
  // dqdq += d2(lambda . r)/dq2, likewise.
  template <class J, class T>
  static void add_curvature(const T* c, const T* e, const Vec3<T>& lambda, T* dqdq, std::ptrdiff_t ld) {
    static_assert(J::nv == 3);
    const Vec3<T> w = load3(e);
    const Mat3<T> H = dJlog3(w, lambda) * Jlog3(w);
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) dqdq[i + ld * k] += c[0] * H(i, k);
  }
  // c |e|^2
  template <class J, class T>
  static T twice_energy(const T* c, const T* e) {
    T sum = T(0);
    for (int k = 0; k < J::nv; ++k) sum += c[k] * e[k] * e[k];
    return sum;
  }
};

}  // namespace dyn::effect
