#include "solver/problem.hpp"

namespace dyn::solver {

namespace {

double at(const double* x, Index i) { return x ? x[i] : 0.0; }

// Rows of a contact, the normal first.
constexpr Index order[7][6] = {{}, {0}, {}, {2, 0, 1}, {2, 0, 1, 3}, {}, {2, 0, 1, 3, 4, 5}};

// Friction coefficient of row j in that order.
double coefficient(const dynContactProblem& x, Index k, Index rows, Index j) {
  if (j < 3) return at(x.friction, k);
  return j == rows - 1 ? at(x.torsion, k) : at(x.rolling, k);
}

struct Scaler {
  const dynContactProblem& x;
  Problem& p;
  std::ptrdiff_t stride;
  // fallback: unit of rows that nothing moves. least: diagonal of equalities and limits that only rounding moves
  double fallback, least;

  double diagonal(Index row) const { return x.G[row * stride + row] + at(x.compliance, row); }
  // a power of two scales without round-off
  double root(double diagonal, double least_one = 0) const {
    return diagonal > least_one ? std::ldexp(1.0, -(std::ilogb(diagonal) >> 1)) : fallback;
  }
  void add(Index row, double d, double unit) {
    const Index i = p.n++;
    p.source[i] = row, p.d[i] = d, p.unit[i] = unit, p.per_unit[i] = 1 / unit, p.approach[i] = 0;
  }
  // The block of the rows from `first` on.
  Block& block(Index first, Block::Kind kind) {
    Block& s = p.block[p.blocks++];
    s.kind = kind, s.first = first, s.rows = p.n - first;
    std::copy_n(p.per_unit + first, s.rows, s.per_speed), std::fill_n(s.soft, s.rows, 0.0);
    return s;
  }
  void box(Index row, double d, double lower, double upper) {
    add(row, d, d);
    Block& s = block(p.n - 1, Block::Kind::rows);
    s.lower = lower / d, s.upper = upper / d;
  }
  void rebound(Index k, Index row) {
    const double e = at(x.restitution, k), v = (x.v_minus ? x.v_minus : x.g)[row];
    if (e > 0 && v < 0) p.approach[p.n - 1] = p.d[p.n - 1] * e * v, p.bounces = true;
  }
  void contact(Index k, Index first, Index rows, bool cones);
};

// Adds a contact with the rows that have a coefficient, if it is a cone. Without any, the normal is a box.
void Scaler::contact(Index k, Index first, Index rows, bool cones) {
  double largest = 0, mu = 0;
  for (Index j = 1; j < rows; ++j)
    if (const double m = coefficient(x, k, rows, j); m > 0) {
      if (mu == 0) mu = m;
      largest = std::max(largest, m / mu * m / mu * diagonal(first + order[rows][j]));
    }
  if (cones != (mu > 0)) return;
  const Index normal = first + order[rows][0], row = p.n;
  const double d = root(diagonal(normal)), dt = largest > 0 ? root(largest) : d;
  if (!cones) return box(normal, d, 0, HUGE_VAL), rebound(k, normal);
  add(normal, d, d), rebound(k, normal);
  for (Index j = 1; j < rows; ++j)
    if (const double m = coefficient(x, k, rows, j); m > 0) add(first + order[rows][j], dt * m / mu, dt);
  block(row, Block::Kind::cone).mu = mu * d / dt;
}

}  // namespace

void scale(const dynContactProblem& x, Problem& p) {
  const Index first = x.equalities + x.boxes;
  const std::ptrdiff_t rows = row_count(x);
  Scaler s{x, p, x.G_stride ? x.G_stride : rows, 1, 0};
  double largest = 0;
  for (Index i = 0; i < rows; ++i) largest = std::max(largest, s.diagonal(i));
  if (largest > 0) s.fallback = 1 / std::sqrt(largest), s.least = tuning::accept::immovable * largest;
  p.n = p.blocks = 0;
  p.bounces = false;
  for (Index i = 0; i < first; ++i) {
    const bool bounded = i >= x.equalities;
    s.box(i, s.root(s.diagonal(i), s.least), bounded ? x.lower[i - x.equalities] : -HUGE_VAL,
          bounded ? x.upper[i - x.equalities] : HUGE_VAL);
  }
  for (const bool cones : {false, true})
    for (Index k = 0, row = first; k < x.contacts; row += rows_of(x, k), ++k) s.contact(k, row, rows_of(x, k), cones);
  p.G.ld = padded(p.n);
  for (Index j = 0; j < p.n; ++j) {
    const double *column = x.G + p.source[j] * s.stride, dj = p.d[j];
    double* out = p.G.column(j);
    for (Index i = 0; i < p.n; ++i) out[i] = p.d[i] * dj * column[p.source[i]];
    for (Index i = p.n; i < p.G.ld; ++i) out[i] = 0;
    out[j] += dj * dj * at(x.compliance, p.source[j]);
    p.g[j] = dj * (x.g[p.source[j]] + at(x.bias, p.source[j]));
  }
  LocalCone* next = p.local;
  p.for_each([&](Block& b) {
    const double own = p.G(b.first, b.first);
    if (b.is_cone()) b.cone = next++, b.cone->set(&p.G(b.first, b.first), p.G.ld, b.rows);
    else b.response[0] = own > tuning::pgs::tiny ? 1 / own : 0;
  });
}

void velocity(const dynContactProblem& x, const double* lambda, double* c) {
  const Index rows = Index(row_count(x));
  const std::ptrdiff_t stride = x.G_stride ? x.G_stride : rows;
  for (Index i = 0; i < rows; ++i) c[i] = x.g[i] + at(x.bias, i) + at(x.compliance, i) * lambda[i];
  for (Index j = 0; j < rows; ++j)
    if (lambda[j] != 0) axpy(lambda[j], x.G + j * stride, c, rows);
}

namespace {

// Dot products with more digits than a double: x87 where available, else two doubles (Ogita, Rump and Oishi 2005).
#if defined(__x86_64__) && !DYN_REPRODUCIBLE
class LongSum {
 public:
  explicit LongSum(double x) : sum_(x) {}
  void add(double a, double b) { sum_ += static_cast<long double>(a) * b; }
  double value() const { return static_cast<double>(sum_); }

 private:
  long double sum_;
};
#else
class LongSum {
 public:
  explicit LongSum(double x) : high_(x) {}
  void add(double a, double b) {
    const double p = a * b, sum = high_ + p, of_p = sum - high_;
    low_ += ((high_ - (sum - of_p)) + (p - of_p)) + rest(a, b, p);
    high_ = sum;
  }
  double value() const { return high_ + low_; }

 private:
  double high_, low_ = 0;

  // a b - p, exact whichever branch computes it
  static double rest(double a, double b, double p) {
#ifdef __FP_FAST_FMA
    return __builtin_fma(a, b, -p);
#else
    const double split = 134217729, ca = split * a, cb = split * b, ah = ca - (ca - a), al = a - ah, bh = cb - (cb - b),
                 bl = b - bh;
    return ((ah * bh - p) + ah * bl + al * bh) + al * bl;
#endif
  }
};
#endif

}  // namespace

void exact_velocity(const Problem& p, const double* y, double* c) {
  for (Index i = 0; i < p.n; ++i) {
    LongSum sum(p.g[i]);
    const double* row = p.G.column(i);  // symmetric
    for (Index j = 0; j < p.n; ++j) sum.add(row[j], y[j]);
    c[i] = sum.value();
  }
}

double round_off(const Problem& p, const double* y) {
  double sum = 0, unit = HUGE_VAL;
  for (Index i = 0; i < p.n; ++i) sum += std::fabs(y[i]), unit = std::min(unit, p.unit[i]);
  return tuning::epsilon * sum / unit;
}

void unscale(const dynContactProblem& x, const Problem& p, const double* y, double* lambda) {
  std::fill_n(lambda, row_count(x), 0.0);
  for (Index i = 0; i < p.n; ++i) lambda[p.source[i]] = p.d[i] * y[i];
}

void scale_guess(const Problem& p, const double* lambda, double* y) {
  for (Index i = 0; i < p.n; ++i) y[i] = lambda[p.source[i]] / p.d[i];
  project(p, y, y);
}

}  // namespace dyn::solver
