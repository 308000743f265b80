// Semi-implicit Euler: velocity first, then the configuration with the new velocity.
//   v' = v + h ddq(q, v')      q' = q (+) h v'
// Order 1. Damping, friction and actuator gains are implicit (taken at v'), so no coefficient is too large:
//   (M + h D) ddq = tau - nle      (gains: implicit_actuators.hpp)
// So are springs that explicit steps would resolve poorly (implicit_springs); the others keep the energy of their oscillations
// bounded.
#pragma once

#include "integrator/chart.hpp"
#include "integrator/free_flight.hpp"
#include "simulation/implicit_actuators.hpp"
#include "simulation/ledger.hpp"
#include "simulation/step.hpp"

namespace dyn::integrator {

// Calls f(part) without the free bodies that are integrated in batches (simulation/free_bodies.hpp).
template <class T, class Part, class F>
DYN_INLINE decltype(auto) with_unbatched_trees(const Data<T>& d, const Part& part, F&& f) {
  if constexpr (std::is_same_v<T, double>) return simulation::with_unbatched_trees(d, part, f);
  else return f(part);
}

enum class ConstraintOutcome { Nothing, Rows, Correction, Sleeper };

// From the free velocity to that at the end of the step. Correction: s.f is a displacement beside h v.
// Sleeper: an awake body touches a sleeping one; nothing was changed.
template <class T>
DYN_INLINE ConstraintOutcome apply_constraints(const Model& m, Data<T>& d, const Stages<T>& s, T h) {
  if constexpr (std::is_same_v<T, double>) {
    simulation::Workspace& w = *d.step;
    w.constraint_count = 0;
    if (!simulation::has_constraints(m, d) || simulation::cache_excludes_contact(m, d, h)) return ConstraintOutcome::Nothing;
    w.constraint_count = simulation::find_constraints(m, d, d.v, h);
    if (w.sleep.touched || w.sleep.contacts_full) return ConstraintOutcome::Sleeper;
    if (w.constraint_count == 0) return ConstraintOutcome::Nothing;
    return simulation::solve_constraints(m, d, w.constraint_count, s.y0 + m.n.nv, h, d.v, s.f) ? ConstraintOutcome::Correction
                                                                                               : ConstraintOutcome::Rows;
  }
  return ConstraintOutcome::Nothing;
}

// Which springs are implicit.
enum class Springs { None, Stiff, All };

// Calls f(degree of freedom, stiffness) for the implicit springs of a step of h. Stiff: with h^2 k above a quarter of the body's
// own inertia about its axis, which bounds the joint's inertia from below in every configuration.
template <class T, class F>
void implicit_springs(const Model& m, const Data<T>& d, T h, Springs which, F&& f) {
  if (which == Springs::All || m.has_mimic) {
    for (Index k = 0; which != Springs::None && k < m.n.nv; ++k) f(k, d.stiffness[k]);
    return;
  }
  for (Index i = 1; which == Springs::Stiff && i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    if (b.type == BodyType::FreeFlyer) continue;
    const bool ball = b.type == BodyType::Spherical;
    const T own = T(b.type == BodyType::Prismatic ? b.m : ball ? std::min({b.I(0, 0), b.I(1, 1), b.I(2, 2)}) : b.I(2, 2));
    for (Index k = b.user_v; k < b.user_v + (ball ? 3 : 1); ++k)
      if (h * h * d.stiffness[k] > T(simulation::tuning::stiff_spring) * own) f(k, d.stiffness[k]);
  }
}

// d.armature += h D
template <class T, class Part>
void add_damping(const Model& m, Data<T>& d, T h, const Part& part) {
  if (!(d.acting & DYN_EFFECT_DAMPING)) return;
  for_each_dof_range(m, part, [&](Index first, Index end) {
    for (Index k = first; k < end; ++k) d.armature[k] += h * d.damping[k];
  });
}

// Rows as the file has them meet the inertia M without damping, as in MuJoCo's Euler step, and damping acts on the change
// x of the velocity that follows: v' = v + (M + h D)^-1 M x = v + x - (M + h D)^-1 h D x.
template <class T, class Part>
[[gnu::cold, gnu::noinline]] void damp_change(const Model& m, Data<T>& d, const T* v0, T h, const Part& part, T* without) {
  if (!(d.acting & DYN_EFFECT_DAMPING)) return;
  T *const armature = d.armature, *const tau = d.constraint_step, *const with = d.constraint_ddq;
  const std::uint32_t acting = d.acting;
  d.armature = d.net + m.n.nv, d.acting |= DYN_EFFECT_ARMATURE;  // as the step's forward dynamics left it
  add_damping(m, d, h, part);
  for_each_dof_range(m, part, [&](Index first, Index end) {
    for (Index k = first; k < end; ++k) tau[k] = d.damping[k] * (d.v[k] - v0[k]);
  });
  const T *const rest = d.zero, *const no_forces = nullptr;
  forward_dynamics(m, d, part, rest, static_cast<const T*>(tau), no_forces, with);
  forward_dynamics(m, d, part, rest, rest, no_forces, without);
  for_each_dof_range(m, part, [&](Index first, Index end) {
    for (Index k = first; k < end; ++k) d.v[k] -= h * (with[k] - without[k]);
  });
  d.armature = armature, d.acting = acting;
}

// d.armature = armature plus the implicit terms of a step of h. The same bits in every call.
template <class T, class Part>
void add_implicit_terms(const Model& m, Data<T>& d, const T* armature, T h, Springs springs, const Part& part) {
  implicit_armature(m, d, armature, h, part);
  implicit_springs(m, d, h, springs, [&](Index k, T stiffness) { d.armature[k] += h * h * stiffness; });
}
// Rows as the file has them: damping acts later (damp_change), and dry friction is rows.
template <class T, class Part>
[[gnu::cold, gnu::noinline]] void set_file_armature(const Model& m, Data<T>& d, const T* armature, T h, Springs springs,
                                                    const Part& part) {
  d.acting &= ~std::uint32_t(DYN_EFFECT_FRICTION);
  add_implicit_terms(m, d, armature, h, springs, part);
  add_damping(m, d, -h, part);
}
template <class T, class Part>
[[gnu::noinline]] void set_implicit_armature(const Model& m, Data<T>& d, const T* armature, T h, Springs springs,
                                             const Part& part) {
  if (simulation::has_file_rows(d)) [[unlikely]] return set_file_armature(m, d, armature, h, springs, part);
  add_implicit_terms(m, d, armature, h, springs, part);
}

// Forward dynamics under tau and the actuators at the end of a step of h.
// When an actuator saturates, d.armature is rebuilt from armature, so actuators do not affect other trees.
// Returns 0 or the joint whose forward dynamics failed.
template <class T, class Part>
[[gnu::noinline]] Index actuated_dynamics(const Model& m, Data<T>& d, const T* tau, const T* armature, T h, Springs springs,
                                          const Part& part) {
  const T* fext = forces_on_bodies(m, d);
  simulation::ImplicitActuators<T> actuators(m, d, h);
  for (;;) {  // each round fixes one more actuator at least
    const T *const v = d.v, *const driven = actuators.apply(part, tau);
    if (const Index joint = forward_dynamics(m, d, part, v, driven, fext, d.ddq)) return joint;
    if (!actuators.saturate(d.ddq)) return 0;
    set_implicit_armature(m, d, armature, h, springs, part);  // again without the gains of saturated actuators
  }
}

// Forward dynamics of an Euler step with its implicit terms.
template <class T, class Part>
Index implicit_dynamics(const Model& m, Data<T>& d, const Stages<T>& s, T h, bool springs, const Part& part) {
  T* const armature = d.armature;
  const T* tau = d.tau_applied;
  constexpr std::uint32_t always = implicit_effects(false);
  const std::uint32_t acting = d.acting;
  Springs which = !(acting & DYN_EFFECT_SPRINGS) ? Springs::None : springs ? Springs::All : Springs::Stiff;
  bool some = which == Springs::All;
  if (which == Springs::Stiff && simulation::has_file_rows(d)) [[unlikely]] which = Springs::None;  // as MuJoCo's
  if (which == Springs::Stiff) implicit_springs(m, d, h, which, [&](Index, T stiffness) { some = some || stiffness > T(0); });
  if (!some) which = Springs::None;
  if (some || (acting & always)) {
    d.armature = d.net + m.n.nv;
    set_implicit_armature(m, d, armature, h, which, part);
    if (some) {
      std::copy_n(d.tau_applied, m.n.nv, s.y);
      implicit_springs(m, d, h, which, [&](Index k, T stiffness) { s.y[k] -= h * stiffness * d.v[k]; });
      tau = s.y;
    }
    d.acting |= DYN_EFFECT_ARMATURE;
  }
  const Index joint = d.acting & driving_effects
                          ? actuated_dynamics(m, d, tau, armature, h, which, part)
                          : forward_dynamics(m, d, part, static_cast<const T*>(d.v), tau, forces_on_bodies(m, d), d.ddq);
  d.armature = armature, d.acting = acting;
  return joint;
}

// Apart, so that steps of rigid rows have no part in them.
template <class Part, class T>
[[gnu::cold, gnu::noinline]] void plain_flight(const Model& m, const Part& part, const T* v0, const T* ddq, T h, T* v) {
  free_flight<true>(m, part, v0, ddq, h, v);
}
template <class Part, class T>
[[gnu::cold, gnu::noinline]] void end_plain_flight(const Model& m, const Part& part, const T* q0, T h, const T* correction, T* q,
                                                   T* v) {
  end_flight<true>(m, part, q0, h, correction, q, v);
}

template <class Part>
[[gnu::cold, gnu::noinline]] void record_euler_work(const Model& m, Data<double>& d, const double* v0, double h,
                                                    const Part& part) {
  for_each_dof_range(m, part, [&](Index first, Index end) { simulation::record_joint_work(d, v0, h, first, end); });
  simulation::record_drive_work(m, d, v0, h);
}

// Ends an Euler step of some trees. rests: slow trees may come to rest. Returns false if a sleeping body was touched: v is then
// as before.
template <class T, class Part>
bool end_euler_step(const Model& m, Data<T>& d, const Stages<T>& s, T h, const Part& part, bool rests) {
  s.keep(m, d, part);
  T *const hv = s.y, *const v0 = s.y0 + m.n.nv;
  bool batched = false;
  const bool plain = simulation::has_file_rows(d);
  if constexpr (std::is_same_v<T, double>)
    if ((batched = d.step->free_bodies.batched)) simulation::integrate_velocity(m, d, h);
  with_unbatched_trees(d, part, [&](const auto& others) {
    others.for_each_group(m, [&](const Trees& t) {
      for (Index k = t.v; k < t.v_end; ++k) d.v[k] += h * d.ddq[k];
    });
    if (plain) [[unlikely]] plain_flight(m, others, v0, d.ddq, h, d.v);
    else free_flight<false>(m, others, v0, d.ddq, h, d.v);
  });
  const ConstraintOutcome met = apply_constraints(m, d, s, h);
  if (met == ConstraintOutcome::Sleeper) {
    part.for_each_group(m, [&](const Trees& t) { std::copy(v0 + t.v, v0 + t.v_end, d.v + t.v); });
    return false;
  }
  if (plain) [[unlikely]]
    with_unbatched_trees(d, part, [&](const auto& others) { damp_change(m, d, static_cast<const T*>(v0), h, others, s.f); });
  const T* const correction = met == ConstraintOutcome::Correction ? s.f : nullptr;
  if constexpr (std::is_same_v<T, double>)
    if (rests) simulation::detect_rest(m, d, v0, correction, h);
  if constexpr (std::is_same_v<T, double>)
    if (simulation::has_open_ledger(d)) record_euler_work(m, d, v0, h, part);
  part.for_each_group(m, [&](const Trees& t) {
    for (Index k = t.v; k < t.v_end; ++k) hv[k] = h * d.v[k] + (correction ? correction[k] : T(0));
  });
  with_unbatched_trees(d, part, [&](const auto& others) {
    integrate(m, others, static_cast<const T*>(d.q), static_cast<const T*>(hv), d.q);
    if (plain) [[unlikely]] end_plain_flight(m, others, s.q0, h, correction, d.q, d.v);
    else end_flight<false>(m, others, s.q0, h, correction, d.q, d.v);
  });
  if constexpr (std::is_same_v<T, double>)
    if (batched) simulation::integrate_position(d, h, correction);
  advance_activations(m, d, s.y0 + 2 * m.n.nv, h);
  if constexpr (std::is_same_v<T, double>)
    if (correction && simulation::has_open_ledger(d)) simulation::record_correction(m, d, s.q0, hv, correction);
  if constexpr (std::is_same_v<T, double>)
    if (rests) simulation::hold_at_rest(m, d, s.q0);
  return true;
}

// Free bodies are integrated in batches within this scope.
struct FreeBodyScope {
  simulation::Workspace* w = nullptr;
  explicit FreeBodyScope(Data<double>& d) : w(d.step) {
    if (!simulation::has_file_rows(d)) [[likely]] simulation::begin_free_body_step(d);
  }
  template <class T>
  explicit FreeBodyScope(const Data<T>&) {}
  FreeBodyScope(const FreeBodyScope&) = delete;
  ~FreeBodyScope() {
    if (w) w->free_bodies.batched = false;
  }
};

// One step. springs: implicit too (implicit_fast), (M + h D + h^2 K) ddq = tau - nle - h K v: no stiffness is too large.
// Without, the energy of oscillations stays bounded (symplectic).
// Returns 0, or the joint whose forward dynamics failed: the state is then as before.
template <class T>
Index euler_step(const Model& m, Data<T>& d, const Stages<T>& s, T h, bool springs) {
  const AllTrees all;
  const FreeBodyScope flight(d);
  if (const Index joint =
          with_unbatched_trees(d, all, [&](const auto& others) { return implicit_dynamics(m, d, s, h, springs, others); }))
    return joint;
  end_euler_step(m, d, s, h, all, false);
  return 0;
}

// The same after begin_sleep: sleeping trees are left out until touched. Awake trees take the same code, for the same bits.
inline Index euler_step_of_awake(const Model& m, Data<double>& d, const Stages<double>& s, double h, bool springs) {
  const simulation::Sleep& z = d.step->sleep;
  const FreeBodyScope flight(d);
  for (;;) {
    const auto dynamics = [&](const auto& part) { return implicit_dynamics(m, d, s, h, springs, part); };
    const Index joint =
        z.unconstrained ? with_unbatched_trees(d, z.awake, dynamics) : with_unbatched_trees(d, AllTrees{}, dynamics);
    if (joint) return joint;
    if (end_euler_step(m, d, s, h, z.awake, true)) return 0;
    simulation::wake_touched(m, d);
  }
}

}  // namespace dyn::integrator
