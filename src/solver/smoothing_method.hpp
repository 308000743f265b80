// Smoothing Newton method over a Delassus operator: zeros of the natural map with a smoothed projection (smoothed.hpp) and a
// smoothed correction,
//   y - P(y - rho (c + Gamma(c))),  Gamma(c) = sqrt(|c_t|^2 + eps^2) of the normal, in units in which cones are their own duals
// while eps falls to zero. It needs no good guess, and where contacts jam and slide it finds solutions that other methods miss.
// With D and B the derivatives of P and of c + Gamma, a step is
//   (1 - D + damped) dy = -map - rho D B G dy,  or  dy = left - K G dy,  K = (1 - D + damped)^-1 rho D B
// Operator: for_each(f(block, state, k)); law(k), in which K of a block is put, and acts of its state, whether K is not zero;
// factorize() of 1 + K G; solve(left, dy, dc), which sets dc = G dy, compliance included.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/block_state.hpp"
#include "solver/newton_method.hpp"
#include "solver/smoothed.hpp"

namespace dyn::solver {

template <class Operator>
struct SmoothingMethod {
  Operator& G;
  Index n;  // rows
  double *y, *c, *dy, *dc, *left;
  Smoothed smooth{};
  double damped = 0;  // added to 1 - D

  // At most max_steps steps from y and c, while may_step(), until accept() is not `going`. accept may change dy, dc and left.
  // Returns true if it is `solved`.
  template <class MayStep, class Accept>
  bool run(Index max_steps, MayStep&& may_step, Accept&& accept);

 private:
  static double rho_of(const Block& s) {  // by the mean diagonal in the units of the map
    return tuning::smoothing::rho * (s.is_cone() ? double(s.rows) / (1 / (s.mu * s.mu) + double(s.rows - 1)) : 1);
  }
  // e = map at y + t dy, z what is projected, slip the derivative of Gamma
  template <int rows>
  void map(const Block& s, double t, double* e, double* z, double* slip) const;
  double error(double t) const;
  template <int rows>
  void set_law(const Block& s, BlockState& state, LawMatrix& law) const;
  bool step(double most, double& size);
};

template <class Operator>
template <int rows>
void SmoothingMethod<Operator>::map(const Block& s, double t, double* e, double* z, double* slip) const {
  const double rho = rho_of(s);
  double own[rows], at[rows];
  for (int i = 0; i < rows; ++i) own[i] = y[s.first + i] + t * dy[s.first + i], at[i] = c[s.first + i] + t * dc[s.first + i];
  if (!s.is_cone()) {
    for (int i = 0; i < rows; ++i) z[i] = own[i] - rho * at[i], e[i] = own[i] - smooth.bounded(z[i], s.lower, s.upper).value;
    return;
  }
  own[0] *= s.mu, at[0] /= s.mu;
  double square = smooth.eps * smooth.eps;
  for (int i = 1; i < rows; ++i) square += at[i] * at[i];
  const double gamma = std::sqrt(square);
  z[0] = own[0] - rho * (at[0] + gamma);
  for (int i = 1; i < rows; ++i) z[i] = own[i] - rho * at[i], slip[i - 1] = at[i] / gamma;
  const Smoothed::Projected p = smooth.cone(z, rows);
  e[0] = own[0] - p.normal;
  for (int i = 1; i < rows; ++i) e[i] = own[i] - p.along * p.direction[i - 1];
}

// Norm of the map at y + t dy.
template <class Operator>
double SmoothingMethod<Operator>::error(double t) const {
  double sum = 0;
  G.for_each([&](const Block& s, const BlockState&, Index) {
    by_rows(s, [&]<int rows>() {
      double e[rows], z[rows], slip[rows];
      map<rows>(s, t, e, z, slip);
      for (int i = 0; i < rows; ++i) sum += e[i] * e[i];
    });
  });
  return std::sqrt(sum);
}

// (1 - D + damped + rho D B soft) [left K] = [-map, rho D B] of one block.
template <class Operator>
template <int rows>
void SmoothingMethod<Operator>::set_law(const Block& s, BlockState& state, LawMatrix& law) const {
  using namespace tuning::smoothing;
  const double share = rho_of(s);
  double A[rows][rows], K[rows][rows], own[rows], z[rows], slip[rows], unit[rows];
  map<rows>(s, 0, own, z, slip);
  std::fill_n(unit, rows, 1.0);
  if (s.is_cone()) {
    unit[0] = 1 / s.mu;
    const Smoothed::Projected p = smooth.cone(z, rows);
    const double* d = p.direction;
    A[0][0] = p.own;
    for (int i = 1; i < rows; ++i) {
      A[0][i] = A[i][0] = p.mixed * d[i - 1];
      for (int j = 1; j < rows; ++j) A[i][j] = (i == j) * p.across + (p.own - p.across) * d[i - 1] * d[j - 1];
    }
    for (int i = 0; i < rows; ++i) {
      K[i][0] = share * A[i][0];
      for (int j = 1; j < rows; ++j) K[i][j] = share * (A[i][j] + A[i][0] * slip[j - 1]);
    }
    state.acts = p.own > tuning::round_off;
  } else {
    state.acts = false;
    for (int i = 0; i < rows; ++i) {
      const double D = smooth.bounded(z[i], s.lower, s.upper).slope;
      for (int j = 0; j < rows; ++j) A[i][j] = (i == j) * D, K[i][j] = share * A[i][j];
      state.acts |= D > tuning::round_off;
    }
  }
  for (int i = 0; i < rows; ++i) {
    own[i] = -own[i];
    for (int j = 0; j < rows; ++j) A[i][j] = (i == j) * (1 + damped) - A[i][j] + K[i][j] * s.soft[j] * unit[j] * unit[j];
  }
  for (int k = 0; k < rows; ++k) {  // Gauss-Jordan; A is near to a positive definite matrix
    const double inverse = 1 / A[k][k];
    for (int j = k + 1; j < rows; ++j) A[k][j] *= inverse;
    for (int j = 0; j < rows; ++j) K[k][j] *= inverse;
    own[k] *= inverse;
    for (int i = 0; i < rows; ++i) {
      if (i == k) continue;
      for (int j = k + 1; j < rows; ++j) A[i][j] -= A[i][k] * A[k][j];
      for (int j = 0; j < rows; ++j) K[i][j] -= A[i][k] * K[k][j];
      own[i] -= A[i][k] * own[k];
    }
  }
  for (int i = 0; i < rows; ++i) {
    left[s.first + i] = unit[i] * own[i];
    for (int j = 0; j < rows; ++j) law[i][j] = unit[i] * K[i][j] * unit[j];
  }
}

// A whole step, or its half if the map's norm is then not below `most`. If that is not either, the step is refused and the next is
// damped more, up to `damping`. Returns false if there is no step.
template <class Operator>
bool SmoothingMethod<Operator>::step(double most, double& size) {
  using namespace tuning::smoothing;
  G.for_each([&](const Block& s, BlockState& state, Index k) {
    by_rows(s, [&]<int rows>() { set_law<rows>(s, state, G.law(k)); });
  });
  if (!G.factorize()) return false;
  G.solve(left, dy, dc);
  const double used = damped, before = size;
  double t = 1;
  size = error(t);
  if (!(size <= most)) size = error(t /= 2), damped = std::min(damping, more_damping * damped);
  else damped = std::max(tuning::proximal, less_damping * damped);
  if (!(size <= most) && used < damping) return damped = std::min(damping, refused_damping * used), size = before, true;
  if (!std::isfinite(size)) return false;
  for (Index i = 0; i < n; ++i) y[i] += t * dy[i], c[i] += t * dc[i];
  return true;
}

template <class Operator>
template <class MayStep, class Accept>
bool SmoothingMethod<Operator>::run(Index max_steps, MayStep&& may_step, Accept&& accept) {
  using namespace tuning::smoothing;
  const double root = std::sqrt(double(n)), least = std::sqrt(std::numeric_limits<double>::min());  // its square is not zero
  std::fill_n(dy, n, 0.0), std::fill_n(dc, n, 0.0);
  smooth.eps = least;
  const double first = std::max(least, error(0) / root);
  smooth.eps = first, damped = damping;
  for (Index steps = 0; steps < max_steps && smooth.eps > tuning::epsilon * first;) {
    double errors[memory], size = error(0);
    std::fill_n(errors, memory, size);
    bool near = false;
    for (Index k = 0; k < steps_each && !near; ++k, ++steps) {
      if (steps == max_steps || !may_step() || !step(*std::max_element(errors, errors + memory), size)) return false;
      errors[k % memory] = size, near = size < closeness * smooth.eps * root;
      if (const Progress progress = accept(); progress != Progress::going) return progress == Progress::solved;
    }
    smooth.eps *= near ? reduction : slow_reduction;
  }
  return false;
}

}  // namespace dyn::solver
