// Newton's method on the exact law, nonsmooth and nonsymmetric, over a Delassus operator (Alart and Curnier 1991). Zeros of:
//   boxes   y - P(y - c)
//   cones   y_n - max(0, r),  y_t - P_B(mu max(0, r)) (y_t - c_t),  r = y_n - c_n
// States: open: y = 0; stick: c = 0; slip along d = a / |a|, a = y_t - c_t: c_n = 0 and y_t = mu r d.
// In slip, y_d = mu y_n + ... is known but for mu dy_n; rows across d are divided by k = mu r / |a|, which adds 1/k - 1 >= 0 to
// their compliance. With T the directions across d, a step is what is known plus a:
//   F^T (G + C) a = F^T r,  a = E x      E, F = 1 in stick;  E = [1 0; mu d T],  F = [1 0; 0 T] in slip
// C is the added compliance, r = -c - G (what is known), -c_t / k across.
// Operator: for_each(f(block, state, k)); times(y, G_y); factorize(compliance) of these equations; solve(r, a, G_a), which may
// change r. Of the unit diagonal: least_compliance, with which steps are unique for redundant contacts; the damping after a short
// step (states change along it; redundant contacts make null directions too long), after a failed one, and at most.
#pragma once

#include "solver/block_state.hpp"

namespace dyn::solver {

enum class Progress { going, solved, stuck };

template <class Operator>
struct NewtonMethod {
  Operator& G;
  Index n;                                   // rows
  double *y, *c, *dy, *dc, *rhs, *a, *G_a;
  double damping = 0;

  struct Error {
    double most = 0, sum = 0;  // largest error and sum of squares, as velocities
    double own = 0;            // sum of squares, scaled
    double speed() const { return std::sqrt(sum); }
  };
  // Of the function at y + t dy.
  Error error(double t) const;
  // Sets dy and dc = G dy. Returns false if singular.
  bool direction();
  // At most max_steps steps, while may_step(), until accept(error, whether the step was damped) is not `going`. Returns true if
  // it is `solved`. If no step length reduces the error, steps are damped (Levenberg and Marquardt). From then on the error need
  // only fall below one of the last twelve (nonmonotone: Grippo, Lampariello and Lucidi 1986), and differ from that of two states
  // ago: steps may alternate between two states.
  template <class MayStep, class Accept>
  bool run(Index max_steps, MayStep&& may_step, Accept&& accept);
};

template <class Operator>
typename NewtonMethod<Operator>::Error NewtonMethod<Operator>::error(double t) const {
  Error out;
  G.for_each([&](const Block& s, const BlockState&, Index) {
    const Index first = s.first;
    by_rows(s, [&]<int rows>() DYN_INLINE_LAMBDA {
      double yk[rows], ck[rows], wrong[rows] = {};
      for (int i = 0; i < rows; ++i) yk[i] = y[first + i] + t * dy[first + i], ck[i] = c[first + i] + t * dc[first + i];
      s.alart_curnier(yk, ck, wrong);
      for (int i = 0; i < rows; ++i) {
        const double velocity = wrong[i] * s.per_speed[i];
        out.most = std::max(out.most, std::abs(velocity)), out.sum += velocity * velocity, out.own += wrong[i] * wrong[i];
      }
    });
  });
  return out;
}

template <class Operator>
bool NewtonMethod<Operator>::direction() {
  bool known = false;
  G.for_each([&](const Block& s, BlockState& state, Index) {
    known |= state.find(s, y + s.first, c + s.first, dy + s.first);
  });
  if (known) G.times(dy, dc);
  else std::fill_n(dc, n, 0.0);
  if (!G.factorize(std::max(Operator::least_compliance, damping))) return false;
  G.for_each([&](const Block& s, const BlockState& state, Index) {
    const double across = state.mode == BlockState::slip ? 1 / state.across : 1;
    for (Index i = 0; i < s.rows; ++i) rhs[s.first + i] = -dc[s.first + i] - (i > 0 ? across : 1) * c[s.first + i];
  });
  G.solve(rhs, a, G_a);
  for (Index i = 0; i < n; ++i) dy[i] += a[i], dc[i] += G_a[i];
  return true;
}

template <class Operator>
template <class MayStep, class Accept>
bool NewtonMethod<Operator>::run(Index max_steps, MayStep&& may_step, Accept&& accept) {
  using namespace tuning::newton_method;
  using tuning::shortest_part;
  std::fill_n(dy, n, 0.0), std::fill_n(dc, n, 0.0);
  double errors[memory];
  std::fill_n(errors, memory, error(0).sum);
  bool strayed = false;
  for (Index k = 0, taken = 0; k < max_steps && may_step(); ++k) {
    if (!direction()) return false;
    const double most = strayed ? *std::max_element(errors, errors + memory) : errors[taken % memory];
    double t = 1;
    Error next = error(t);
    while (!(next.sum < most) && t > shortest_part) next = error(t /= 2);
    const double before = errors[(taken + memory - 1) % memory];  // two states ago
    const bool cycles = strayed && std::abs(next.sum - before) < std::sqrt(tuning::round_off) * before;
    if (!(next.sum < most) || cycles) {
      if (damping >= G.max_damping) return false;
      damping = std::max(Operator::first_damping, damping_factor * damping), strayed = true;
      continue;
    }
    const bool damped = damping > Operator::least_compliance;
    for (Index i = 0; i < n; ++i) y[i] += t * dy[i], c[i] += t * dc[i];
    if (t < 1 && Operator::short_damping > 0) damping = std::max(Operator::short_damping, damping_factor * damping);
    else damping = damped ? damping / damping_factor : 0;
    const Progress progress = accept(next, damped);
    if (progress != Progress::going) return progress == Progress::solved;
    errors[++taken % memory] = next.sum;
  }
  return false;
}

}  // namespace dyn::solver
