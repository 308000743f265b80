// Equations of motion in exponential coordinates about q0: y = (u, v) with q = q0 (+) u, so methods for vector spaces
// keep their order on rotations (Munthe-Kaas 1999; Hairer, Lubich, Wanner 2006, IV.8.2):
//   du/dt = J(u)^-1 v      dv/dt = ddq(q0 (+) u, v, tau)
// Positions and linear velocities of free flyers are in the axes at the beginning of the step, so rotation does not mix into
// them:
//   p = p0 + R0 u      du/dt = w      dw/dt = E (a + omega x v),  E = R0' R = exp(u_angular),  v = E' w
// Activations of actuators follow v; they have equations of their own (algorithm/actuators.hpp).
#pragma once

#include "algorithm/declarations.hpp"
#include "algorithm/tree_groups.hpp"
#include "integrator/free_flight.hpp"
#include "integrator/constrained_motion.hpp"

namespace dyn::integrator {

template <class T>
struct ChartMotion {
  const Model& m;
  Data<T>& d;
  const T* q0;

  // Sets d.q, d.v and d.act to the state y.
  void place(const T* y) const {
    integrate(m, q0, y, d.q);
    for (Index k = 0; k < m.n.nv; ++k) d.v[k] = y[m.n.nv + k];
    for (Index k = 0; k < (m.n.na > 0 ? m.n.actuators : 0); ++k)
      if (const ActuatorRecord& r = m.actuators()[k]; r.act >= 0)
        for (Index i = r.act; i < r.act + r.spec.activations; ++i) d.act[i] = clamp_to(y[2 * m.n.nv + i], r.spec.act_range);
    for_each_free_flyer<T>(m, WholeModel{}, [&](const Body& b, Index, const Vec3<T>&) {
      store3(load3(q0 + b.user_q) + rotation(load_quaternion(q0 + b.user_q + 3)) * load3(y + b.user_v), d.q + b.user_q);
      store3(transpose_times(exp3(load3(y + b.user_v + 3)), load3(d.v + b.user_v)), d.v + b.user_v);
    });
  }
  // f = dy/dt. Returns 0, or the joint whose forward dynamics failed.
  Index operator()(const T* y, T* f) const {
    place(y);
    if (const Index joint = constrained_forward_dynamics(m, d)) return joint;
    chart_rate(m, y, d.v, f);
    for (Index k = 0; k < m.n.nv; ++k) f[m.n.nv + k] = d.ddq[k];
    for_each_free_flyer<T>(m, WholeModel{}, [&](const Body& b, Index, const Vec3<T>&) {
      const Vec3<T> v = load3(d.v + b.user_v), omega = load3(d.v + b.user_v + 3), a = load3(d.ddq + b.user_v);
      store3(load3(y + m.n.nv + b.user_v), f + b.user_v);
      store3(exp3(load3(y + b.user_v + 3)) * (a + cross(omega, v)), f + m.n.nv + b.user_v);
    });
    for (Index k = 0; k < (m.n.na > 0 ? m.n.actuators : 0); ++k)
      if (const ActuatorRecord& r = m.actuators()[k]; r.act >= 0)
        activation_rates(r, d, static_cast<const T*>(d.act + r.act), f + 2 * m.n.nv + r.act);
    return 0;
  }
};

template <class T>
T largest(const T* x, Index n) {
  T out = T(0);
  for (Index k = 0; k < n; ++k)
    if (const T size = std::abs(x[k]); !(size <= out)) out = size;
  return out;
}

// What steps do at their stages: nothing.
struct NoStage {
  template <class T>
  void operator()(T) const {}
};

// Buffers of a step: q at its beginning, y at its beginning and in its stages, and the stage derivatives.
template <class T>
struct Stages {
  T *q0, *y0, *y, *f;
  Index n;

  Stages(const Model& m, Data<T>& d) : q0(d.stages), y0(q0 + m.n.nq), n(2 * m.n.nv + m.n.na) { y = y0 + n, f = y + n; }
  T* stage(int k) const { return f + k * n; }

  // Begins a step: the chart is centred at the state in d.
  void begin(const Model& m, const Data<T>& d) const {
    keep(m, d, AllTrees{});
    for (Index k = 0; k < m.n.nv; ++k) y0[k] = T(0);
  }
  // Saves the state alone.
  template <class Part>
  void keep(const Model& m, const Data<T>& d, const Part& part) const {
    part.for_each_group(m, [&](const Trees& t) {
      for (Index k = t.q; k < t.q_end; ++k) q0[k] = d.q[k];
      for (Index k = t.v; k < t.v_end; ++k) y0[m.n.nv + k] = d.v[k];
    });
    for (Index k = 0; k < m.n.na; ++k) y0[2 * m.n.nv + k] = d.act[k];
  }
  // Rotates changes x (2 nv) of the chart's coordinates into the axes of the state in d.
  void rotate_to_end_axes(const Model& m, const Data<T>& d, T* x) const {
    for_each_free_flyer<T>(m, WholeModel{}, [&](const Body& b, Index, const Vec3<T>&) {
      const Mat3<T> R0 = rotation(load_quaternion(q0 + b.user_q + 3)), R = rotation(load_quaternion(d.q + b.user_q + 3));
      for (T* part : {x + b.user_v, x + m.n.nv + b.user_v}) store3(transpose_times(R, R0 * load3(part)), part);
    });
  }
  void undo(const Model& m, Data<T>& d) const {
    for (Index k = 0; k < m.n.nq; ++k) d.q[k] = q0[k];
    for (Index k = 0; k < m.n.nv; ++k) d.v[k] = y0[m.n.nv + k];
    for (Index k = 0; k < m.n.na; ++k) d.act[k] = y0[2 * m.n.nv + k];
  }
};
}  // namespace dyn::integrator
