#include "solver/smoothing.hpp"

#include "solver/alart_curnier.hpp"
#include "solver/smoothing_method.hpp"

namespace dyn::solver {

namespace {

using namespace tuning::smoothing;
using tuning::interior::newton_error, tuning::interior::newton_reduction;

class DenseSmoothing {
 public:
  DenseSmoothing(Workspace& w, Budget& b) : w(w), p(w.problem), b(b) {}
  bool run();

  // of the operator
  template <class F>
  void for_each(F&& f) const {
    for (Index k = 0; k < p.blocks; ++k) f(p.block[k], w.state[k], k);
  }
  LawMatrix& law(Index k) const { return w.laws[k]; }
  bool factorize();
  void solve(const double* left, double* dy, double* dc) const;

 private:
  Workspace& w;
  const Problem& p;
  Budget& b;
  double tried = HUGE_VAL;
  SmoothingMethod<DenseSmoothing> method{*this, p.n, w.x, w.v, w.t, w.z, w.r};

  Progress accept();
};

// 1 + K G
bool DenseSmoothing::factorize() {
  Matrix& A = w.active;
  A.ld = padded(p.n);
  for_each([&](const Block& s, const BlockState&, Index k) {
    for (Index j = 0; j < p.n; ++j)
      for (Index i = 0; i < s.rows; ++i) {
        double sum = j == s.first + i;
        for (Index l = 0; l < s.rows; ++l) sum += w.laws[k][i][l] * p.G(s.first + l, j);
        A(s.first + i, j) = sum;
      }
  });
  ++b.factorizations;
  return lu(A, p.n, w.pivots);
}

void DenseSmoothing::solve(const double* left, double* dy, double* dc) const {
  std::copy_n(left, p.n, dy);
  lu_solve(w.active, p.n, w.pivots, dy);
  times(p.G, dy, nullptr, dc, p.n);
}

// Whether y, projected, meets the tolerance, or Newton's method from it does.
Progress DenseSmoothing::accept() {
  double *const at = w.u, *const c = w.s;
  project(p, w.x, at);
  times(p.G, at, p.g, c, p.n);
  if (keep_best(w, b, at, c)) return Progress::solved;
  const double now = residual(p, at, c).residual;
  if (!(now < newton_error * p.speed && now < newton_reduction * tried)) return Progress::going;
  tried = now;
  return alart_curnier(w, b, at, c) ? Progress::solved : Progress::going;
}

bool DenseSmoothing::run() {
  if (p.n > max_rows) return false;
  std::copy_n(w.y, p.n, w.x), std::copy_n(w.c, p.n, w.v);
  // a rough solve leaves most of its iterations for interior points: they solve contradictory contacts, which this does not
  const Index left = b.max_iterations - b.iterations - b.newton_steps;
  const Index most = b.is_rough() ? std::min(max_steps, Index(rough_share * double(left))) : max_steps;
  return method.run(most, [&] { return !b.spent() && ++b.newton_steps; }, [&] { return accept(); });
}

}  // namespace

bool smoothing_newton(Workspace& w, Budget& b) { return DenseSmoothing(w, b).run(); }

}  // namespace dyn::solver
