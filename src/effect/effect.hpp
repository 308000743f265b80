// The effect contract. An effect acts at joints or on links beside inertia and gravity. Each is one file, with its law at the
// top; list.hpp names them. A type E gives, as static members,
//   bit                       its DYN_EFFECT_...
//   present(m)                whether the model has it; absent: why it has not, for people
//   for_each_joint(m, f)      f(joint) for each joint that it may act at
//   part                      data without this part never has it; 0: all data may
//   implicit                  whether Euler steps take it at their end (Implicit)
// An effect with a coefficient for each degree of freedom gives of(x), that array of a model, a data, a JointSpec or a
// JointRecord, and
//   name, quantity            for messages: "a damping", "damping"
//   array, group              its dynModelArray and dynParameterGroup
//   mjcf, urdf                the attribute of a joint (URDF: of its <dynamics>) that holds it; nullptr: the format lacks it
//   reflected(ratio, c)       coefficient c of a follower (mimic joint), at its leader
// A law of the velocity, r(v) in M a + nle + r = tau, gives also
//   force(c, v) = r, slope(c, v) = dr/dv, [curvature(c, v) = d2r/dv2], secant(c, v) = D with r = D v, secant_slope(c, v) = dD/dv,
//   work(ledger): where its power is noted, bounded: whether r is
// A law of the configuration gives displacement, add_force, add_slope, add_curvature, energy (springs.hpp).
// A force on links gives records(m), one for each link, and
//   wrench(m, d, record)      world axes, at the origin of the record's body
//   needs_velocity, work(ledger)
// What is absent costs nothing: its loops are skipped by its bit in Data::acting, and its arrays are not laid out.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "dyn.h"
#include "base/portable.hpp"
#include "base/types.hpp"

namespace dyn::effect {

enum class Implicit { Never, Always, ImplicitFast };  // ImplicitFast: by that integrator alone

// The member x.name, or x.name() of a model.
#define DYN_EFFECT_COEFFICIENT(member)                     \
  template <class X>                                       \
  static decltype(auto) of(X& x) {                         \
    if constexpr (requires { x.member(); }) return x.member(); \
    else return (x.member);                                \
  }
// Where a ledger notes the power of an effect.
#define DYN_EFFECT_WORK(member) \
  template <class Ledger>       \
  static auto& work(Ledger& x) { return x.member; }

template <class E>
struct Coefficient {
  static constexpr dynParts part = 0;
  static constexpr Implicit implicit = Implicit::Never;
  static constexpr bool bounded = false;
  template <class M>
  static bool present(const M& m) {
    return std::any_of(E::of(m), E::of(m) + m.n.nv, [](double c) { return c != 0; });
  }
  static double reflected(double ratio, double c) { return ratio * ratio * c; }
  // Of a joint with one degree of freedom, from its JointSpec.
  template <class Spec>
  static double own(const Spec& s) { return E::of(s).empty() ? 0 : E::of(s)[0]; }
};

// Of a list of records in the model, each of which names its joint.
template <class E>
struct Listed {
  static constexpr dynParts part = DYN_PART_SIMULATION;
  static constexpr Implicit implicit = Implicit::Never;
  template <class M>
  static bool present(const M& m) { return !E::records(m).empty(); }
  template <class M, class F>
  static void for_each_joint(const M& m, F&& f) {
    for (const auto& r : E::records(m)) f(E::joint(m, r));
  }
  template <class M, class R>
  static Index joint(const M&, const R& record) { return record.joint; }
};

template <class E>
concept HasCoefficient = requires { E::name; };
template <class E>
concept OfVelocity = requires(double x) { E::slope(x, x); };
template <class E>
concept OfConfiguration = requires { E::of_configuration; };
template <class E>
concept OnLinks = requires { E::needs_velocity; };

}  // namespace dyn::effect
