// The backward pass: value functions from the last knot to the first, each with a quadratic program in the box of its inputs.
#include "algorithm/box_step.hpp"
#include "plan/planner.hpp"

namespace dyn::plan {

namespace {

using Lanes = Simd<double, block_lanes>;
static_assert(solver::lanes % block_lanes == 0);  // columns are padded to it

enum class Half { Both, Upper };

// to += A^T B, columns of `ld` numbers, the padded ones zero. to(i, j) = to[i + room j]. In tiles of 2 x 2. Half::Upper: i <= j
// at least.
void add_transposed_product(const double* A, Index a_count, const double* B, Index b_count, Index ld, double* to, Index room,
                            Half half = Half::Both) {
  const auto tile = [&]<int rows, int columns>(Index i, Index j) {
    Lanes sum[rows][columns];
    for (auto& row : sum)
      for (Lanes& s : row) s = Lanes::zero();
    for (Index l = 0; l < ld; l += block_lanes) {
      Lanes a[rows];
      for (int r = 0; r < rows; ++r) a[r] = Lanes::load(A + std::ptrdiff_t(ld) * (i + r) + l);
      for (int c = 0; c < columns; ++c) {
        const Lanes b = Lanes::load(B + std::ptrdiff_t(ld) * (j + c) + l);
        for (int r = 0; r < rows; ++r) sum[r][c] = sum[r][c] + a[r] * b;
      }
    }
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) to[i + r + std::ptrdiff_t(room) * (j + c)] += dyn::sum(sum[r][c]);
  };
  Index j = 0;
  for (; j + 2 <= b_count; j += 2) {
    Index i = 0;
    const Index end = half == Half::Upper ? std::min<Index>(a_count, j + 2) : a_count;
    for (; i + 2 <= end; i += 2) tile.operator()<2, 2>(i, j);
    if (i < end) tile.operator()<1, 2>(i, j);
  }
  for (Index i = 0; j < b_count && i < a_count; ++i) tile.operator()<1, 1>(i, j);
}

// y += A^T x
void add_transposed_times(const double* A, Index count, Index ld, const double* x, double* y) {
  for (Index i = 0; i < count; ++i) y[i] += solver::dot(A + std::ptrdiff_t(ld) * i, x, ld);
}
// y += A x of n rows
void add_times(const double* A, Index count, Index ld, const double* x, double* y, Index n) {
  for (Index j = 0; j < count; ++j)
    if (x[j] != 0) solver::axpy(x[j], A + std::ptrdiff_t(ld) * j, y, n);
}

struct Backward {
  Planner& p;
  double regularisation;
  const Index n = p.n, ld = p.ld, r = p.free_count, rd = p.input_ld;

  void begin() const {
    const double *const l_x = p.l_x + std::ptrdiff_t(p.knots) * n, *const l_xx = p.l_xx + std::ptrdiff_t(p.knots) * n * n;
    std::copy_n(l_x, n, p.V_x);
    for (Index j = 0; j < n; ++j) std::copy_n(l_xx + std::ptrdiff_t(n) * j, n, p.V_xx + std::ptrdiff_t(ld) * j);
  }
  // Q of knot k: costs of the knot and of what follows, by x and the free inputs.
  void expand(Index k) const {
    const double *const A = p.A_of(k), *const B = p.B_of(k), *const gap = p.gaps + std::ptrdiff_t(k) * n;
    add_times(p.V_xx, n, ld, gap, p.V_x, n);  // at the end of the step
    std::fill_n(p.VA, std::ptrdiff_t(n) * ld, 0.0), std::fill_n(p.VB, std::ptrdiff_t(r) * ld, 0.0);
    add_transposed_product(p.V_xx, n, A, n, ld, p.VA, ld);
    add_transposed_product(p.V_xx, n, B, r, ld, p.VB, ld);
    std::copy_n(p.l_x + std::ptrdiff_t(k) * n, n, p.Q_x);
    std::copy_n(p.l_xx + std::ptrdiff_t(k) * n * n, std::ptrdiff_t(n) * n, p.Q_xx);
    const double *const l_u = p.l_u + std::ptrdiff_t(k) * p.inputs,
                 *const l_uu = p.l_uu + std::ptrdiff_t(k) * p.inputs * p.inputs,
                 *const l_ux = p.l_ux + std::ptrdiff_t(k) * p.inputs * n;
    std::fill_n(p.Q_u, rd, 0.0), std::fill_n(p.Q_ux, std::ptrdiff_t(n) * rd, 0.0);
    std::fill_n(p.Q_uu, std::ptrdiff_t(r) * rd, 0.0);
    for (Index a = 0; a < r; ++a) {
      p.Q_u[a] = l_u[p.free[a]];
      for (Index b = 0; b < r; ++b) p.Q_uu[a + std::ptrdiff_t(rd) * b] = l_uu[p.free[a] + std::ptrdiff_t(p.inputs) * p.free[b]];
      for (Index j = 0; j < n; ++j) p.Q_ux[a + std::ptrdiff_t(rd) * j] = l_ux[p.free[a] + std::ptrdiff_t(p.inputs) * j];
    }
    add_transposed_times(A, n, ld, p.V_x, p.Q_x), add_transposed_times(B, r, ld, p.V_x, p.Q_u);
    add_transposed_product(A, n, p.VA, n, ld, p.Q_xx, n, Half::Upper);
    add_transposed_product(B, r, p.VA, n, ld, p.Q_ux, rd);
    add_transposed_product(B, r, p.VB, r, ld, p.Q_uu, rd);
  }
  // The best step of the inputs within the box, and its feedback on the inputs that are not at their bounds.
  bool optimise(Index k) const {
    double* const H = p.product;  // r x r
    double largest = 0;
    for (Index a = 0; a < r; ++a) largest = std::max(largest, std::abs(p.Q_uu[a + std::ptrdiff_t(rd) * a]));
    for (Index b = 0; b < r; ++b) {
      for (Index a = 0; a < r; ++a)
        H[a + std::ptrdiff_t(r) * b] = 0.5 * (p.Q_uu[a + std::ptrdiff_t(rd) * b] + p.Q_uu[b + std::ptrdiff_t(rd) * a]);
      double& pivot = H[b + std::ptrdiff_t(r) * b];
      pivot += regularisation * std::max(std::abs(pivot), 1e-9 * largest);
    }
    const double* const u = p.u + std::ptrdiff_t(k) * p.inputs;
    for (Index a = 0; a < r; ++a)
      p.box_lower[a] = p.lower[p.free[a]] - u[p.free[a]], p.box_upper[a] = p.upper[p.free[a]] - u[p.free[a]];
    const LeastSquares<double> square{r, r, H, p.factor, nullptr, p.Q_u, 0};
    BoxStep<double> box{square, p.box_lower, p.box_upper, p.step, p.dual, p.work, p.box_state};
    if (box(0.0) < 0) return false;
    for (Index a = 0; a < r; ++a)
      if (box.wanted(a) != p.box_state[a]) return false;  // it ran out of passes
    const Index* const loose = p.box_state + r;  // what the factor is of
    Index count = 0;
    for (Index a = 0; a < r; ++a) count += p.box_state[a] == bound_none;
    double *const step = p.k + std::ptrdiff_t(k) * p.inputs, *const K = p.K_of(k);
    std::fill_n(step, p.inputs, 0.0), std::fill_n(K, std::ptrdiff_t(p.inputs) * n, 0.0);
    std::fill_n(p.gain, std::ptrdiff_t(n) * rd, 0.0);
    for (Index a = 0; a < r; ++a) step[p.free[a]] = p.step[a];
    for (Index j = 0; j < n; ++j) {
      for (Index a = 0; a < count; ++a) p.work[a] = -p.Q_ux[loose[a] + std::ptrdiff_t(rd) * j];
      detail::cholesky_solve(p.factor, count, p.work);
      for (Index a = 0; a < count; ++a)
        p.gain[loose[a] + std::ptrdiff_t(rd) * j] = K[p.free[loose[a]] + std::ptrdiff_t(p.inputs) * j] = p.work[a];
    }
    return true;
  }
  // V_x = Q_x + K^T (Q_uu k + Q_u) + Q_ux^T k,  V_xx = Q_xx + K^T (Q_uu K + Q_ux) + Q_ux^T K
  void contract() const {
    std::copy_n(p.Q_x, n, p.V_x);
    add_transposed_times(p.Q_ux, n, rd, p.step, p.V_x);
    add_times(p.Q_uu, r, rd, p.step, p.Q_u, r);
    add_transposed_times(p.gain, n, rd, p.Q_u, p.V_x);
    double* const T = p.product;
    std::copy_n(p.Q_ux, std::ptrdiff_t(n) * rd, T);
    add_transposed_product(p.Q_uu, r, p.gain, n, rd, T, rd);
    add_transposed_product(p.gain, n, T, n, rd, p.Q_xx, n, Half::Upper);
    add_transposed_product(p.Q_ux, n, p.gain, n, rd, p.Q_xx, n, Half::Upper);
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i <= j; ++i)
        p.V_xx[i + std::ptrdiff_t(ld) * j] = p.V_xx[j + std::ptrdiff_t(ld) * i] = p.Q_xx[i + std::ptrdiff_t(n) * j];
  }
};

}  // namespace

bool solve_backward(Planner& p, double regularisation) {
  const Backward pass{p, regularisation};
  pass.begin();
  for (Index k = p.knots - 1; k >= 0; --k) {
    pass.expand(k);
    if (!pass.optimise(k)) return false;
    pass.contract();
  }
  return true;
}

Expected expected_change(Planner& p) {
  const Index n = p.n, r = p.inputs;
  Expected e{};
  std::fill_n(p.dx, n, 0.0);
  for (Index k = 0; k < p.knots; ++k) {
    const double *const l_xx = p.l_xx + std::ptrdiff_t(k) * n * n, *const l_uu = p.l_uu + std::ptrdiff_t(k) * r * r,
                 *const l_ux = p.l_ux + std::ptrdiff_t(k) * r * n;
    std::copy_n(p.k + std::ptrdiff_t(k) * r, r, p.du);
    add_times(p.K_of(k), n, r, p.dx, p.du, r);
    e.linear += solver::dot(p.l_x + std::ptrdiff_t(k) * n, p.dx, n) + solver::dot(p.l_u + std::ptrdiff_t(k) * r, p.du, r);
    for (Index j = 0; j < n; ++j) {
      if (p.dx[j] == 0) continue;
      e.quadratic += p.dx[j] * (solver::dot(l_xx + std::ptrdiff_t(n) * j, p.dx, n) +
                                2 * solver::dot(l_ux + std::ptrdiff_t(r) * j, p.du, r));
    }
    for (Index j = 0; j < r; ++j) e.quadratic += p.du[j] * solver::dot(l_uu + std::ptrdiff_t(r) * j, p.du, r);
    std::copy_n(p.gaps + std::ptrdiff_t(k) * n, n, p.next_dx);
    add_times(p.A_of(k), n, p.ld, p.dx, p.next_dx, n);
    for (Index a = 0; a < p.free_count; ++a)
      solver::axpy(p.du[p.free[a]], p.B_of(k) + std::ptrdiff_t(p.ld) * a, p.next_dx, n);
    std::swap(p.dx, p.next_dx);
  }
  const double* const l_xx = p.l_xx + std::ptrdiff_t(p.knots) * n * n;
  e.linear += solver::dot(p.l_x + std::ptrdiff_t(p.knots) * n, p.dx, n);
  for (Index j = 0; j < n; ++j) e.quadratic += p.dx[j] * solver::dot(l_xx + std::ptrdiff_t(n) * j, p.dx, n);
  return e;
}

}  // namespace dyn::plan
