// Explicit Runge-Kutta steps of any tableau.
#pragma once

#include <algorithm>
#include <cmath>

#include "dyn/integrator/chart.hpp"
#include "dyn/integrator/tableaus.hpp"

namespace dyn::integrator {

// The state at the end of a step of h, in d. Returns 0, or the joint whose forward dynamics failed: the state is then as before.
template <class Tableau, class T>
Index explicit_step(const Model& m, Data<T>& d, const Stages<T>& s, T h) {
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
  }
  combine(Tableau::b, Tableau::stages);
  motion.place(s.y);
  return 0;
}

// Largest component of h sum_j weights_j f_j.
template <class T>
T largest_defect(const Stages<T>& s, const double* weights, int count, T h) {
  T largest = T(0);
  for (Index k = 0; k < s.n; ++k) {
    T sum = T(0);
    for (int j = 0; j < count; ++j) sum += T(weights[j]) * s.stage(j)[k];
    if (const T size = std::abs(h * sum); !(size <= largest)) largest = size;  // also NaN
  }
  return largest;
}

// What a step that was just made is off by, in rad, m and their rates.
template <class T>
T step_error(DormandPrince5, const Stages<T>& s, T h) { return largest_defect(s, DormandPrince5::e, DormandPrince5::stages, h); }
template <class T>
T step_error(DormandPrince8, const Stages<T>& s, T h) {
  const T e5 = largest_defect(s, DormandPrince8::e5, DormandPrince8::stages, h), e3 = largest_defect(s, DormandPrince8::e3, DormandPrince8::stages, h);
  return e5 == T(0) ? T(0) : e5 * e5 / std::sqrt(e5 * e5 + T(0.01) * e3 * e3);
}

}  // namespace dyn::integrator
