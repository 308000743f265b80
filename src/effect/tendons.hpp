// Tendons: forces along lengths L(q) (algorithm/paths.hpp). With a spring that rests between two lengths,
//   f = stiffness (rest0 - L) below rest0, stiffness (rest1 - L) above rest1, less damping L'
// Friction, limits, armature and couplings are rows of a step (simulation/path_rows.hpp), and so are stiff springs and dampers.
#pragma once

#include <cmath>

#include "effect/effect.hpp"

namespace dyn::effect {

struct Tendons : Listed<Tendons> {
  static constexpr std::uint32_t bit = DYN_EFFECT_TENDONS;
  static constexpr const char* absent = "no tendon has a force of its own";
  template <class M>
  static auto records(const M& m) { return std::span(m.tendons(), std::size_t(m.n.tendons)); }
  template <class M, class R>
  static Index joint(const M& m, const R& record) { return m.paths()[&record - m.tendons()].joint; }
  static bool is_limited(const dynTendon& t) { return std::isfinite(t.range[0]) || std::isfinite(t.range[1]); }
  static bool is_sprung(const dynTendon& t) { return t.stiffness > 0 || t.damping > 0 || t.armature > 0; }
  template <class M>
  static bool present(const M& m) {
    if (m.n.couplings > 0) return true;
    for (const auto& r : records(m))
      if (is_sprung(r.spec) || r.spec.friction > 0 || is_limited(r.spec)) return true;
    return false;
  }
  template <class M, class F>
  static void for_each_joint(const M& m, F&& f) {
    if (present(m)) Listed::for_each_joint(m, f);
  }

  // Of the spring: by how much the length is beyond where it rests.
  template <class T>
  static T stretch(const dynTendon& t, T length) {
    return length < T(t.rest[0]) ? length - T(t.rest[0]) : length > T(t.rest[1]) ? length - T(t.rest[1]) : T(0);
  }
  template <class T>
  static T force(const dynTendon& t, T length, T rate) { return -T(t.stiffness) * stretch(t, length) - T(t.damping) * rate; }
  // -df/dL
  template <class T>
  static double slope(const dynTendon& t, T length) { return stretch(t, length) != T(0) ? t.stiffness : 0; }
  template <class T>
  static T energy(const dynTendon& t, T length) {
    const T x = stretch(t, length);
    return T(0.5 * t.stiffness) * x * x;
  }
};

}  // namespace dyn::effect
