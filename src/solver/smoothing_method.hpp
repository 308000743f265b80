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
#include <type_traits>
#include <utility>

#include "base/simd.hpp"
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
  // Rows of a block, or of several cones in lanes. S: double, or Simd
  template <class S, int rows>
  struct Rows {
    S y[rows], c[rows], dy[rows], dc[rows], soft[rows], mu;
  };
  static constexpr int lanes = block_lanes;
  using Lanes = Simd<double, lanes>;
  struct Member {
    const Block* block;
    BlockState* state;
    Index number;
  };

  // Calls f.template operator()<S, rows>(members, their number): friction cones of three rows in lanes, others one by one. Lanes
  // beyond the number repeat the first.
  template <class F>
  void for_each_group(F&& f) const;
  template <class S, int rows>
  Rows<S, rows> load(const Member* of) const;
  // By the mean diagonal in the units of the map.
  template <class S, int rows>
  static S cone_rho(const S& mu) {
    return S(tuning::smoothing::rho * rows) / (S(1.0) / (mu * mu) + S(double(rows - 1)));
  }
  // e = map at y + t dy, z what is projected, slip the derivative of Gamma
  template <class S, int rows>
  void cone_map(const Rows<S, rows>& s, double t, S* e, S* z, S* slip) const;
  double error(double t) const;
  template <class S, int rows>
  void set_cone_law(const Member* of, int count) const;
  template <int rows>
  void set_bounded_law(const Member& of) const;
  // (A + K soft) [left K] = [left, K] of cones or bounded rows, stored
  template <class S, int rows>
  void finish_law(const Member* of, int count, const S* soft, const S* unit, S (&A)[rows][rows], S (&K)[rows][rows], S* own) const;
  bool step(double most, double& size);
};

template <class Operator>
template <class F>
void SmoothingMethod<Operator>::for_each_group(F&& f) const {
  Member group[lanes];
  int count = 0;
  G.for_each([&](const Block& s, BlockState& state, Index k) {
    const Member member{&s, &state, k};
    if (!s.is_cone() || s.rows != 3) {
      by_rows(s, [&]<int rows>() { f.template operator()<double, rows>(&member, 1); });
      return;
    }
    group[count++] = member;
    if (count == lanes) f.template operator()<Lanes, 3>(group, lanes), count = 0;
  });
  if (count == 0) return;
  std::fill(group + count, group + lanes, group[0]);
  f.template operator()<Lanes, 3>(group, count);
}

template <class Operator>
template <class S, int rows>
DYN_INLINE auto SmoothingMethod<Operator>::load(const Member* of) const -> Rows<S, rows> {
  Rows<S, rows> out;
  const auto each = [&](S& into, auto&& value) DYN_INLINE_LAMBDA {
    if constexpr (std::is_same_v<S, double>) into = value(*of->block);
    else
      into = [&]<std::size_t... k>(std::index_sequence<k...>) DYN_INLINE_LAMBDA {
        return S(value(*of[k].block)...);
      }(std::make_index_sequence<lanes>{});
  };
  for (int i = 0; i < rows; ++i) {
    each(out.y[i], [&](const Block& s) DYN_INLINE_LAMBDA { return y[s.first + i]; });
    each(out.c[i], [&](const Block& s) DYN_INLINE_LAMBDA { return c[s.first + i]; });
    each(out.dy[i], [&](const Block& s) DYN_INLINE_LAMBDA { return dy[s.first + i]; });
    each(out.dc[i], [&](const Block& s) DYN_INLINE_LAMBDA { return dc[s.first + i]; });
    each(out.soft[i], [&](const Block& s) DYN_INLINE_LAMBDA { return s.soft[i]; });
  }
  each(out.mu, [](const Block& s) DYN_INLINE_LAMBDA { return s.mu; });
  return out;
}

template <class Operator>
template <class S, int rows>
DYN_INLINE void SmoothingMethod<Operator>::cone_map(const Rows<S, rows>& s, double t, S* e, S* z, S* slip) const {
  using std::sqrt;
  const S rho = cone_rho<S, rows>(s.mu);
  S own[rows], at[rows];
  for (int i = 0; i < rows; ++i) own[i] = s.y[i] + S(t) * s.dy[i], at[i] = s.c[i] + S(t) * s.dc[i];
  own[0] = own[0] * s.mu, at[0] = at[0] / s.mu;
  S square = S(smooth.eps * smooth.eps);
  for (int i = 1; i < rows; ++i) square = square + at[i] * at[i];
  const S gamma = sqrt(square);
  z[0] = own[0] - rho * (at[0] + gamma);
  for (int i = 1; i < rows; ++i) z[i] = own[i] - rho * at[i], slip[i - 1] = at[i] / gamma;
  const auto p = smooth.template cone<rows>(z);
  e[0] = own[0] - p.normal;
  for (int i = 1; i < rows; ++i) e[i] = own[i] - p.along * p.direction[i - 1];
}

// Norm of the map at y + t dy.
template <class Operator>
double SmoothingMethod<Operator>::error(double t) const {
  double total = 0;
  for_each_group([&]<class S, int rows>(const Member* of, int count) {
    if constexpr (std::is_same_v<S, double>)
      if (const Block& s = *of->block; !s.is_cone()) {
        for (Index i = s.first; i < s.first + rows; ++i) {
          const double now = y[i] + t * dy[i], at = now - tuning::smoothing::rho * (c[i] + t * dc[i]);
          const double e = now - smooth.bounded(at, s.lower, s.upper).value;
          total += e * e;
        }
        return;
      }
    if constexpr (rows > 1) {
      S e[rows], z[rows], slip[rows];
      cone_map<S, rows>(load<S, rows>(of), t, e, z, slip);
      S squares = e[0] * e[0];
      for (int i = 1; i < rows; ++i) squares = squares + e[i] * e[i];
      if constexpr (std::is_same_v<S, double>) total += squares;
      else
        for (int k = 0; k < count; ++k) total += squares[k];
    }
  });
  return std::sqrt(total);
}

template <class Operator>
template <class S, int rows>
DYN_INLINE void SmoothingMethod<Operator>::finish_law(const Member* of, int count, const S* soft, const S* unit,
                                                      S (&A)[rows][rows], S (&K)[rows][rows], S* own) const {
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) A[i][j] = S((i == j) * (1 + damped)) - A[i][j] + K[i][j] * soft[j] * unit[j] * unit[j];
  for (int k = 0; k < rows; ++k) {  // Gauss-Jordan; A is near to a positive definite matrix
    const S inverse = S(1.0) / A[k][k];
    for (int j = k + 1; j < rows; ++j) A[k][j] = A[k][j] * inverse;
    for (int j = 0; j < rows; ++j) K[k][j] = K[k][j] * inverse;
    own[k] = own[k] * inverse;
    for (int i = 0; i < rows; ++i) {
      if (i == k) continue;
      for (int j = k + 1; j < rows; ++j) A[i][j] = A[i][j] - A[i][k] * A[k][j];
      for (int j = 0; j < rows; ++j) K[i][j] = K[i][j] - A[i][k] * K[k][j];
      own[i] = own[i] - A[i][k] * own[k];
    }
  }
  const auto store = [&](const S& x, auto&& into) DYN_INLINE_LAMBDA {
    if constexpr (std::is_same_v<S, double>) into(*of) = x;
    else
      for (int k = 0; k < count; ++k) into(of[k]) = x[k];
  };
  for (int i = 0; i < rows; ++i) {
    store(unit[i] * own[i], [&](const Member& m) -> double& { return left[m.block->first + i]; });
    for (int j = 0; j < rows; ++j)
      store(unit[i] * K[i][j] * unit[j], [&](const Member& m) -> double& { return G.law(m.number)[i][j]; });
  }
}

// (1 - D + damped + rho D B soft) [left K] = [-map, rho D B] of friction cones.
template <class Operator>
template <class S, int rows>
void SmoothingMethod<Operator>::set_cone_law(const Member* of, int count) const {
  const Rows<S, rows> s = load<S, rows>(of);
  const S rho = cone_rho<S, rows>(s.mu);
  S A[rows][rows], K[rows][rows], own[rows], z[rows], slip[rows], unit[rows];
  cone_map<S, rows>(s, 0, own, z, slip);
  const auto p = smooth.template cone<rows>(z);
  const S* d = p.direction;
  A[0][0] = p.own;
  for (int i = 1; i < rows; ++i) {
    A[0][i] = A[i][0] = p.mixed * d[i - 1];
    for (int j = 1; j < rows; ++j) A[i][j] = S(double(i == j)) * p.across + (p.own - p.across) * d[i - 1] * d[j - 1];
  }
  unit[0] = S(1.0) / s.mu;
  for (int i = 1; i < rows; ++i) unit[i] = S(1.0);
  for (int i = 0; i < rows; ++i) {
    own[i] = -own[i], K[i][0] = rho * A[i][0];
    for (int j = 1; j < rows; ++j) K[i][j] = rho * (A[i][j] + A[i][0] * slip[j - 1]);
  }
  for (int k = 0; k < count; ++k) {
    double act;
    if constexpr (std::is_same_v<S, double>) act = p.own;
    else act = p.own[k];
    of[k].state->acts = act > tuning::round_off;
  }
  finish_law<S, rows>(of, count, s.soft, unit, A, K, own);
}

// The same of bounded rows.
template <class Operator>
template <int rows>
void SmoothingMethod<Operator>::set_bounded_law(const Member& of) const {
  const Block& s = *of.block;
  double A[rows][rows] = {}, K[rows][rows] = {}, own[rows], unit[rows];
  of.state->acts = false;
  for (int i = 0; i < rows; ++i) {
    const double now = y[s.first + i];
    const Smoothed::Value<double> at = smooth.bounded(now - tuning::smoothing::rho * c[s.first + i], s.lower, s.upper);
    own[i] = at.value - now, unit[i] = 1, A[i][i] = at.slope, K[i][i] = tuning::smoothing::rho * at.slope;
    of.state->acts |= at.slope > tuning::round_off;
  }
  finish_law<double, rows>(&of, 1, s.soft, unit, A, K, own);
}

// A whole step, or its half if the map's norm is then not below `most`. If that is not either, the step is refused and the next is
// damped more, up to `damping`. Returns false if there is no step.
template <class Operator>
bool SmoothingMethod<Operator>::step(double most, double& size) {
  using namespace tuning::smoothing;
  for_each_group([&]<class S, int rows>(const Member* of, int count) {
    if constexpr (rows > 1) {
      if (of->block->is_cone()) return set_cone_law<S, rows>(of, count);
    }
    if constexpr (std::is_same_v<S, double>) set_bounded_law<rows>(*of);
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
