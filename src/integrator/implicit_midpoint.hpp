// Implicit midpoint rule on the group. With the midpoint velocity w:
//   v' = v + h ddq(q (+) h/2 w, w)      q' = q (+) h w      w = (v + v') / 2
// Order 2, time-reversible, symplectic on vector spaces: energy stays bounded over long times (Hairer, Lubich, Wanner 2006,
// II.1.3).
#pragma once

#include <algorithm>
#include <cmath>

#include "integrator/chart.hpp"
#include "integrator/stepping.hpp"
#include "integrator/tuning.hpp"
#include "model/length.hpp"

namespace dyn::integrator {

// Rounding of velocities at rest: forces that balance each other leave that of what gravity adds in a step.
template <class T>
T rounding_at_rest(const Model& m, const Data<T>& d, T h) {
  const Vec3<T> g = load3(d.world_gravity);
  return tuning::ulps * std::numeric_limits<T>::epsilon() * h * std::sqrt(dot(g, g)) / T(std::min(1.0, own_length(m)));
}

// Fixed point of w by Anderson mixing of two iterates (Walker and Ni 2011).
// Returns 0, the joint whose forward dynamics failed, or not_converged; the state is then as before.
// at_stage(h): called at the state of the midpoint.
template <class T, class AtStage = NoStage>
Index implicit_midpoint_step(const Model& m, Data<T>& d, const Stages<T>& s, T h, std::int64_t& evaluations,
                             const AtStage& at_stage = {}) {
  s.begin(m, d);
  const Index nv = m.n.nv;
  const T *v0 = s.y0 + nv;
  advance_activations(m, d, s.y0 + 2 * nv, h / 2);
  T *w = s.y, *next = w + nv, *half = s.stage(0), *residual = half + nv, *old_residual = residual + nv,
    *old_next = old_residual + nv;
  for (Index k = 0; k < nv; ++k) w[k] = v0[k];
  T best = std::numeric_limits<T>::infinity();
  int stalled = 0;
  for (int i = 0; i < tuning::midpoint_iterations; ++i) {
    for (Index k = 0; k < nv; ++k) half[k] = h / 2 * w[k], d.v[k] = w[k];
    integrate(m, s.q0, half, d.q);
    ++evaluations;
    if (const Index joint = constrained_forward_dynamics(m, d)) return s.undo(m, d), joint;
    T error = T(0), size = T(0);
    for (Index k = 0; k < nv; ++k) {
      next[k] = v0[k] + h / 2 * d.ddq[k];
      residual[k] = next[k] - w[k];
      if (const T e = std::abs(residual[k]); !(e <= error)) error = e;
      size = std::max(size, std::abs(next[k]));
    }
    if (error != error) return s.undo(m, d), not_converged;
    const T rounding = tuning::ulps * std::numeric_limits<T>::epsilon() * size;
    stalled = error < best / 2 ? 0 : stalled + 1;
    best = std::min(best, error);
    if (error <= rounding || (stalled >= tuning::midpoint_stalls &&
                              error <= tuning::midpoint_rounding * (rounding + rounding_at_rest(m, d, h)))) {
      at_stage(h);
      for (Index k = 0; k < nv; ++k) d.v[k] = v0[k] + h * d.ddq[k], half[k] = h * next[k];
      integrate(m, s.q0, half, d.q);
      advance_activations(m, d, s.y0 + 2 * nv, h);
      return 0;
    }
    // w' = (1 - c) next + c old_next, c minimises the mixed residual
    T mix = T(0);
    if (i > 0) {
      T across = T(0), along = T(0);
      for (Index k = 0; k < nv; ++k) {
        const T change = residual[k] - old_residual[k];
        across += change * residual[k], along += change * change;
      }
      if (along > T(0)) mix = across / along;
    }
    for (Index k = 0; k < nv; ++k) {
      w[k] = i > 0 ? next[k] + mix * (old_next[k] - next[k]) : next[k];  // the first iterate has no predecessor
      old_residual[k] = residual[k], old_next[k] = next[k];
    }
  }
  return s.undo(m, d), not_converged;
}

}  // namespace dyn::integrator
