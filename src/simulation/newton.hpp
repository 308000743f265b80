// Newton's method on the exact law (solver/newton_method.hpp) on an island without a dense matrix.
// With Y the columns at the supporting dofs over the roots of their pivots, G = Y^T Y, and K the laws of active blocks
// (BlockState::set_law):
//   (G + K^-1) a = r        (1 + Y K Y^T) z = Y K r,   a = K (r - Y^T z)
// The factorised matrix has the size of the degrees of freedom, however many rows there are, in blocks of segments
// (elimination.hpp).
#pragma once

#include "simulation/block_factor.hpp"
#include "simulation/delassus_operator.hpp"
#include "solver/newton_method.hpp"

namespace dyn::simulation {

class Newton {
 public:
  explicit Newton(const Island& island);
  // Starts from the island's lambda and iterates while the error falls. Returns true when the tolerance is met.
  bool run(dynContactReport& report);
  // At most max_steps steps. Ends at a residual of `enough`, too, where it falls slowly.
  bool run(Index max_steps, double enough, dynContactReport& report);
  // Sets lambda to the smallest impulses with which contacts that press in the guess stick; those that would pull are left out.
  // Returns false, and changes nothing, if they are no solution.
  bool least_norm(double tolerance);
  // Sets lambda to the smallest impulses without friction if it is not near to them. tolerance: of the largest error. Returns
  // false, and changes nothing, if they are not found.
  bool frictionless(double tolerance);
  // Sets lambda to the feasible impulses nearest to the result if they are better than the guess.
  void write_best(dynContactReport& report);

  // of the operator
  using Block = solver::Block;
  using State = NewtonConstraint;
  // With its least compliance, short steps need no damping; more than the first damping costs more steps than it saves.
  static constexpr double least_compliance = tuning::newton::min_compliance, short_damping = 0,
                          first_damping = tuning::newton::damping, max_damping = first_damping;
  // Calls f(block, state, its number).
  template <class F>
  void for_each(F&& f) const {
    G.for_each([&](const Block& b, Index k) { f(b, w.newton[k], k); });
  }
  void times(const double* of, double* G_of) const;
  bool factorize(double compliance);
  void solve(double* r, double* a, double* G_a) const {
    solve_laws(r, a, G_a, method.damping > least_compliance ? 0 : least_compliance);
  }

 protected:
  static constexpr int W = BlockFactor::W;

  const Island& x;
  Workspace& w;
  const Elimination& e;
  BySegments G;
  BlockFactor factor;
  std::ptrdiff_t room;
  double bound = 0;          // of impulses
  double least = HUGE_VAL;  // residual of the best
  bool rough = false;       // more than the tolerance is enough
  // by rows, normal first, scaled
  double *y = w.newton_vectors, *c = y + room, *dy = c + room, *dc = dy + room, *best = dc + room, *before = best + room,
         *G_step = before + 3 * room, *g = G_step + room;

  using Method = solver::NewtonMethod<Newton>;
  using Error = Method::Error;
  Method method{*this, x.rows, y, c, dy, dc, before + room, before + 2 * room, G_step};

  // by = law of
  template <int rows>
  static DYN_INLINE void apply(const State& s, const double* of, double* by) {
#pragma GCC unroll 6
    for (int i = 0; i < rows; ++i) {
      by[i] = 0;
#pragma GCC unroll 6
      for (int j = 0; j < rows; ++j) by[i] += s.law[i][j] * of[j];
    }
  }
  void activate(Index constraint) const {
    e.for_each_run(constraint, [&](const ConstraintRun& r) { w.newton_acts[r.segment] = true; });
  }

  void velocities(const double* of, double* into) const;  // into = G of + g
  Error error() const { return std::fill_n(dy, x.rows, 0.0), std::fill_n(dc, x.rows, 0.0), method.error(0); }
  bool factorize_laws(bool symmetric);  // symmetric: all of the laws are
  // (G + K^-1) a = r by refinements: what G a misses of Y^T z, and the compliance removed, is the next right side. Changes r.
  // If none is removed, the step is damped, and for a rough result as good without refinements.
  void solve_laws(double* r, double* a, double* G_a, double removed) const;
  void fill(Index position, double* D) const;
  void candidate(double* into) const;
  double residual(const double* impulses) const;
  // Whether so many contacts slide that redundant ones make a step without damping too long.
  bool slides() const;
  double take(dynContactReport& report);
};

// Interior-point method (interior.cpp).
bool interior(const Island& x, dynContactReport& report);

}  // namespace dyn::simulation
