#include "solver/alart_curnier.hpp"

#include "solver/newton_method.hpp"

namespace dyn::solver {

namespace {

using namespace tuning::alart_curnier;

class DenseNewton {
 public:
  DenseNewton(Workspace& w, Budget& b, Index damped_steps)
      : max_damping(damped_steps > 0 ? 1 : 0),
        most(damped_steps > 0 ? damped_steps : max_steps),
        w(w),
        p(w.problem),
        b(b) {}
  bool run(const double* y, const double* c);

  // of the operator
  static constexpr double least_compliance = tuning::proximal, short_damping = tuning::alart_curnier::short_damping,
                          first_damping = tuning::alart_curnier::first_damping;
  const double max_damping;  // 1: the diagonal of G; beyond, steps are those of a descent along the error
  const Index most;  // steps
  template <class F>
  void for_each(F&& f) const {
    for (Index k = 0; k < p.blocks; ++k) f(p.block[k], w.state[k], k);
  }
  void times(const double* x, double* G_x) const { solver::times(p.G, x, nullptr, G_x, p.n); }
  bool factorize(double compliance);
  void solve(const double* r, double* a, double* G_a) const;

 private:
  Workspace& w;
  const Problem& p;
  Budget& b;
  bool symmetric = true;
  Index unknowns = 0;
  NewtonMethod<DenseNewton> method{*this, p.n, w.newton, w.newton_c, w.step, w.step_c, w.t, w.trial, w.trial_c};

  // Calls f(block, state, directions across the slip, first unknown).
  template <class F>
  void each_acting(F&& f) const {
    Index u = 0;
    for_each([&](const Block& s, const BlockState& state, Index k) {
      if (!state.acts) return;
      f(s, state, w.laws[k], u);
      u += s.rows - (state.mode == BlockState::slip);
    });
  }
  void restrict_to_unknowns(const double* r, double* x) const;
};

// x = F^T r
void DenseNewton::restrict_to_unknowns(const double* r, double* x) const {
  each_acting([&](const Block& s, const BlockState& state, const LawMatrix& T, Index u) {
    const double* own = r + s.first;
    x[u] = own[0];
    if (state.mode == BlockState::stick) std::copy_n(own + 1, s.rows - 1, x + u + 1);
    else
      for (Index q = 1; q + 1 < s.rows; ++q) x[u + q] = dot(T[q], own + 1, s.rows - 1);
  });
}

// F^T (G + C) E
bool DenseNewton::factorize(double compliance) {
  const Matrix& G = p.G;
  Matrix& A = w.active;
  double* const G_E = w.trial;  // one column
  unknowns = 0, symmetric = true;
  each_acting([&](const Block& s, const BlockState& state, LawMatrix& T, Index) {
    const bool slips = state.mode == BlockState::slip;
    unknowns += s.rows - slips, symmetric &= !slips;
    if (slips) basis(state.direction, s.rows - 1, T);
  });
  A.ld = padded(unknowns);
  each_acting([&](const Block& s, const BlockState& state, const LawMatrix& T, Index u) {
    const bool slips = state.mode == BlockState::slip;
    for (Index q = 0; q < s.rows - slips; ++q) {
      const double* column = G.column(s.first + q);
      if (slips) {
        if (q == 0) std::copy_n(column, p.n, G_E);
        else std::fill_n(G_E, p.n, 0.0);
        for (Index l = 1; l < s.rows; ++l)
          axpy(q == 0 ? s.mu * state.direction[l - 1] : T[q][l - 1], G.column(s.first + l), G_E, p.n);
        column = G_E;
      }
      restrict_to_unknowns(column, A.column(u + q));
      A(u + q, u + q) += compliance + (slips && q > 0 ? 1 / state.across - 1 : 0);
    }
  });
  ++b.factorizations;
  return symmetric ? cholesky(A, unknowns) : lu(A, unknowns, w.pivots);
}

void DenseNewton::solve(const double* r, double* a, double* G_a) const {
  double* const x = w.exact;
  restrict_to_unknowns(r, x);
  if (symmetric) cholesky_solve(w.active, unknowns, x);
  else lu_solve(w.active, unknowns, w.pivots, x);
  std::fill_n(a, p.n, 0.0);
  each_acting([&](const Block& s, const BlockState& state, const LawMatrix& T, Index u) {
    double* own = a + s.first;
    if (state.mode == BlockState::stick) return void(std::copy_n(x + u, s.rows, own));
    own[0] = x[u];
    axpy(s.mu * x[u], state.direction, own + 1, s.rows - 1);
    for (Index q = 1; q + 1 < s.rows; ++q) axpy(x[u + q], T[q], own + 1, s.rows - 1);
  });
  times(a, G_a);
}

bool DenseNewton::run(const double* y, const double* c) {
  std::copy_n(y, p.n, w.newton), std::copy_n(c, p.n, w.newton_c);
  const auto keep = [&] {
    project(p, w.newton, w.trial);
    solver::times(p.G, w.trial, p.g, w.trial_c, p.n);  // anew: long steps leave the rounding of their own size in newton_c
    return keep_best(w, b, w.trial, w.trial_c);
  };
  const auto may_step = [&] { return !b.spent() && ++b.newton_steps; };
  int idle = 0;  // steps in a row that hardly reduced the residual
  const auto accept = [&](NewtonMethod<DenseNewton>::Error& error, bool) {
    // a long step along a cone leaves it by a little
    if (error.speed() < tuning::accept::near_round_off * round_off(p, w.newton)) {
      exact_velocity(p, w.newton, w.newton_c);
      std::fill_n(w.step, p.n, 0.0), std::fill_n(w.step_c, p.n, 0.0);
      error = method.error(0);
    }
    // the norm of as many errors as there are rows
    if (!(error.speed() < p.n * std::max(b.tolerance, b.enough))) return Progress::going;
    const double before = b.best;
    const bool solved = keep();
    idle = b.best < tuning::newton_method::progress * before ? 0 : idle + 1;
    return solved || (idle > 2 && b.best <= b.enough) ? Progress::solved : Progress::going;
  };
  return method.run(most, may_step, accept) || keep();
}

}  // namespace

bool alart_curnier(Workspace& w, Budget& b, const double* y, const double* c, Index damped_steps) {
  return DenseNewton(w, b, damped_steps).run(y, c);
}

}  // namespace dyn::solver
