// Explicit Runge-Kutta steps of any tableau.
#pragma once

#include <algorithm>
#include <cmath>

#include "integrator/chart.hpp"
#include "integrator/tableaus.hpp"

namespace dyn::integrator {

// The state at the end of a step of h, in d. Returns 0, or the joint whose forward dynamics failed (state restored).
// at_stage(share of h): called at the state of each stage.
template <class Tableau, class T, class AtStage = NoStage>
Index explicit_step(const Model& m, Data<T>& d, const Stages<T>& s, T h, const AtStage& at_stage = {}) {
  s.begin(m, d);
  const ChartMotion<T> motion{m, d, s.q0};
  const auto combine = [&](const double* weights, int count) {
    for (Index k = 0; k < s.n; ++k) {
      T sum = T(0);
      for (int j = 0; j < count; ++j) sum += T(weights[j]) * s.stage(j)[k];
      s.y[k] = s.y0[k] + h * sum;
    }
  };
  for (int i = 0; i < Tableau::stages; ++i) {
    combine(Tableau::a[i], i);
    if (const Index joint = motion(s.y, s.stage(i))) return s.undo(m, d), joint;
    at_stage(h * T(Tableau::b[i]));
  }
  combine(Tableau::b, Tableau::stages);
  motion.place(s.y);
  return 0;
}

// out = h sum_j weights_j f_j. out may be a stage without weight.
template <class T>
void defect(const Stages<T>& s, const double* weights, int count, T h, T* out) {
  for (Index k = 0; k < s.n; ++k) {
    T sum = T(0);
    for (int j = 0; j < count; ++j)
      if (weights[j] != 0) sum += T(weights[j]) * s.stage(j)[k];
    out[k] = h * sum;
  }
}
// Largest component after a step. Under constraints, only what the projection leaves.
template <class T>
T largest_defect(const Model& m, Data<T>& d, const Stages<T>& s, T* x, bool held) {
  if constexpr (std::is_same_v<T, double>)
    if (held) s.rotate_to_end_axes(m, d, x), remove_constrained_errors(m, d, x);
  T largest = T(0);
  for (Index k = 0; k < s.n; ++k)
    if (const T size = std::abs(x[k]); !(size <= largest)) largest = size;  // NaN counts as the largest
  return largest;
}

// Error of the step that was just made (rad, m and their rates). held: under constraints, at the end of the step.
template <class T>
T step_error(DormandPrince5, const Model& m, Data<T>& d, const Stages<T>& s, T h, bool held) {
  defect(s, DormandPrince5::e, DormandPrince5::stages, h, s.y);
  return largest_defect(m, d, s, s.y, held);
}
template <class T>
T step_error(DormandPrince8, const Model& m, Data<T>& d, const Stages<T>& s, T h, bool held) {
  T *five = s.y, *three = s.stage(1);
  defect(s, DormandPrince8::e5, DormandPrince8::stages, h, five), defect(s, DormandPrince8::e3, DormandPrince8::stages, h, three);
  const T e5 = largest_defect(m, d, s, five, held), e3 = largest_defect(m, d, s, three, held);
  return e5 == T(0) ? T(0) : e5 * e5 / std::sqrt(e5 * e5 + T(0.01) * e3 * e3);
}

// Error and end of the step. Under constraints the error is evaluated after the projection, only if it is too large as it is.
// raw: error without the projection. moved: change of v by the projection.
template <class Tableau, class T>
Index finish_step(const Model& m, Data<T>& d, const Stages<T>& s, T h, T allowed, T& error, T& raw, T& moved) {
  moved = T(0), raw = error = step_error(Tableau(), m, d, s, h, false);
  if constexpr (std::is_same_v<T, double>) {
    if (active_rows(m, d) == 0) return 0;
    T* const before = s.stage(1);
    std::copy(d.v, d.v + m.n.nv, before);
    if (const Index joint = project_to_constraints(m, d)) return s.undo(m, d), error = std::numeric_limits<T>::infinity(), joint;
    for (Index k = 0; k < m.n.nv; ++k) moved = std::max(moved, std::abs(d.v[k] - before[k]));
    if (error > allowed) error = step_error(Tableau(), m, d, s, h, true);
  }
  return 0;
}

}  // namespace dyn::integrator
