// Newton's method of Alart and Curnier (solver/alart_curnier.hpp) on an island without a dense matrix.
// With Y the columns at the supporting dofs over the roots of their pivots, G = Y^T Y, and K the stiffness of active rows
// (a small compliance where a contact sticks):
//   (G + K^-1) a = r        (1 + Y K Y^T) z = Y K r,   a = K (r - Y^T z)
// The factorised matrix has the size of the degrees of freedom, however many rows there are, in blocks of segments
// (elimination.hpp).
#pragma once

#include "simulation/block_factor.hpp"
#include "solver/dense.hpp"

namespace dyn::simulation {

class Newton {
 public:
  explicit Newton(const Island& island);
  // Starts from the island's lambda and iterates while the error falls. Returns true when the tolerance is met.
  bool run(dynContactReport& report);
  // At most max_steps steps, each of which must reduce the squared error to `share` of the last.
  bool run(Index max_steps, double share, dynContactReport& report);
  // Sets lambda to the feasible impulses nearest to the result if they are better than the guess.
  void write_best(dynContactReport& report);

 protected:
  using State = NewtonConstraint;
  using P = BlockFactor::P;
  static constexpr int W = BlockFactor::W;

  const Island& x;
  Workspace& w;
  const Elimination& e;
  BlockFactor factor;
  std::ptrdiff_t room;
  double speed, bound;  // speed: largest velocity that is to change. bound: of impulses
  // by rows, normal first, scaled
  double *y = w.newton_vectors, *c = y + room, *dy = c + room, *dc = dy + room, *best = dc + room, *before = best + room;

  struct Error {
    double most = 0, sum = 0;  // largest error and sum of squares, as velocities
    double own = 0;            // sum of squares, scaled
  };
  template <class F>
  void for_each(F&& f) const {
    for (Index k = 0; k < x.constraint_count; ++k) f(x.constraint(k), w.newton[k], k);
  }
  void clear() const { std::fill_n(w.by_segment, W * std::ptrdiff_t(e.size), 0.0); }
  // scatter: w.by_segment += Y by. gather: velocity = Y^T of.
  DYN_INLINE void scatter(Index constraint, Index rows, const double* by) const {
    e.for_each_run(constraint, [&](const ConstraintRun& r) {
      double* const to = w.by_segment + W * e.position[r.segment];
      P sum = P::load(to);
      for (Index i = 0; i < rows; ++i) sum = sum + P::load(r.rows + W * i) * by[i];
      sum.store(to);
    });
  }
  DYN_INLINE void gather(Index constraint, Index rows, const double* of, double* velocity) const {
    P sum[max_rows];
    for (Index i = 0; i < rows; ++i) sum[i] = P::zero();
    e.for_each_run(constraint, [&](const ConstraintRun& r) {
      const P at = P::load(of + W * e.position[r.segment]);
      for (Index i = 0; i < rows; ++i) sum[i] = sum[i] + P::load(r.rows + W * i) * at;
    });
    for (Index i = 0; i < rows; ++i) velocity[i] = dyn::sum(sum[i]);
  }
  double soft(const ActiveConstraint& a, const State& s, Index i) const {
    return x.compliance[a.s->first + s.order[i]] * s.unit[i] * s.unit[i];
  }
  void activate(Index constraint) const {
    e.for_each_run(constraint, [&](const ConstraintRun& r) { w.newton_acts[e.position[r.segment]] = true; });
  }

  void times(const double* of, double* G_of) const;
  void velocities() const;  // c = G y + g
  Error error(double t) const;
  Error error() const {
    std::fill_n(dy, x.rows, 0.0), std::fill_n(dc, x.rows, 0.0);
    return error(0);
  }
  bool factorize() const;  // uses the laws of the constraints
 private:
  double compliant;  // compliance of sticking rows, relative to the unit diagonal

  void load();
  void fill(Index position, double* D) const;
  double classify();
  void set_law(const ActiveConstraint& a, State& s) const;
  bool direction();
  void candidate(double* into) const;
  double residual() const;
  void to_impulses(const double* from) const;
};

// Interior-point method (interior.cpp).
bool interior(const Island& x, dynContactReport& report);

}  // namespace dyn::simulation
