// Long chains and heavy tips against their condition numbers: |ID(FD(tau)) - tau| <= 50 eps cond(M) (after Featherstone 2004).
#include <random>

#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

// Uniform rods of 1 kg and 1 m in a plane; the last one tip kg.
Model chain(int n, double tip = 1) {
  Builder b("chain");
  std::string parent;
  for (int k = 0; k < n; ++k) {
    const std::string joint = "j" + std::to_string(k);
    b.add_joint(hinge(joint, parent, {0, 0, 1}, at(k ? 1 : 0, 0, 0)));
    const double m = k + 1 == n ? tip : 1;
    b.add_body("rod" + std::to_string(k), joint, m, {0.5, 0, 0}, diagonal(0, m / 12, m / 12));
    parent = joint;
  }
  return b.set_gravity({0, -g, 0}).finish();
}

// Largest eigenvalue of a symmetric operator, by powers.
template <class F>
double largest_of(std::size_t n, F&& apply) {
  Vector x(n), y(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = 1 + 0.3 * std::sin(7.0 * static_cast<double>(i)) + (i % 2 ? 0.2 : -0.2);
  double value = 0, before = -1;
  for (int k = 0; k < 1000 && std::abs(value - before) > 1e-7 * value; ++k) {
    double size = 0;
    apply(x, y);
    for (const double e : y) size += e * e;
    before = value, value = std::sqrt(size);
    for (std::size_t i = 0; i < n; ++i) x[i] = y[i] / value;
  }
  return value;
}
double largest(const Vector& A, std::size_t n) {
  return largest_of(n, [&](const Vector& x, Vector& y) {
    std::fill(y.begin(), y.end(), 0.0);
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) y[i] += A[i + n * j] * x[j];
  });
}

// cond(M) of that chain, without the library: M by sums over what hangs on each joint, about that joint; its inverse by a factor.
double condition_of(const Vector& q, double tip) {
  const std::size_t n = q.size();
  Vector x(n + 1), y(n + 1), mass(n), moment_x(n), moment_y(n), inertia(n), M(n * n);
  double angle = 0;
  for (std::size_t k = 0; k < n; ++k) angle += q[k], x[k + 1] = x[k] + std::cos(angle), y[k + 1] = y[k] + std::sin(angle);
  for (std::size_t k = n; k-- > 0;) {
    const double m = k + 1 == n ? tip : 1, dx = x[k + 1] - x[k], dy = y[k + 1] - y[k];
    mass[k] = m, moment_x[k] = m * dx / 2, moment_y[k] = m * dy / 2, inertia[k] = m / 3;
    if (k + 1 == n) continue;
    const double more = mass[k + 1], hx = moment_x[k + 1], hy = moment_y[k + 1];
    mass[k] += more, moment_x[k] += hx + more * dx, moment_y[k] += hy + more * dy;
    inertia[k] += inertia[k + 1] + 2 * (hx * dx + hy * dy) + more;
  }
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i <= j; ++i)
      M[i + n * j] = M[j + n * i] = inertia[j] + (x[j] - x[i]) * moment_x[j] + (y[j] - y[i]) * moment_y[j];
  const double high = largest(M, n);
  for (std::size_t j = 0; j < n; ++j) {  // M = L L^T, L in the lower half
    for (std::size_t k = 0; k < j; ++k)
      for (std::size_t i = j; i < n; ++i) M[i + n * j] -= M[i + n * k] * M[j + n * k];
    const double pivot = std::sqrt(M[j + n * j]);
    for (std::size_t i = j; i < n; ++i) M[i + n * j] /= pivot;
  }
  return high * largest_of(n, [&](const Vector& b, Vector& z) {
           z = b;
           for (std::size_t j = 0; j < n; ++j) {
             z[j] /= M[j + n * j];
             for (std::size_t i = j + 1; i < n; ++i) z[i] -= M[i + n * j] * z[j];
           }
           for (std::size_t j = n; j-- > 0;) {
             for (std::size_t i = j + 1; i < n; ++i) z[j] -= M[i + n * j] * z[i];
             z[j] /= M[j + n * j];
           }
         });
}

struct Arm : Data {
  explicit Arm(const Model& model)
      : Data(model, DYN_PART_MINV | DYN_PART_MASS | DYN_PART_INVERSE | DYN_PART_FORWARD | DYN_PART_CHOLESKY),
        n(static_cast<std::size_t>(model.nv())) {}
  std::size_t n;

  double condition(const Vector& q) {
    const Vector M = crba(q).copy(), inverse = minv(q).copy();
    return largest(M, n) * largest(inverse, n);
  }
};

enum class Pose { straight, random, coil };
Vector pose(std::size_t n, Pose p, std::mt19937& dice) {
  std::uniform_real_distribution<double> angle(-pi, pi);
  Vector q(n);
  for (double& x : q) x = p == Pose::straight ? 0 : p == Pose::coil ? pi / 6 : angle(dice);
  return q;
}
Vector numbers(std::size_t n, std::mt19937& dice) {
  std::uniform_real_distribution<double> number(-1, 1);
  Vector x(n);
  for (double& e : x) e = number(dice);
  return x;
}
double size_of(const Vector& x) {
  double most = 0;
  for (const double e : x) most = std::max(most, std::abs(e));
  return most;
}

// |ID(FD(tau)) - tau| / (eps cond), tau of the size of one.
double round_trip(Arm& arm, const Vector& q, double condition, std::mt19937& dice) {
  const Vector v = numbers(arm.n, dice), tau = numbers(arm.n, dice);
  const Vector ddq = arm.aba(q, v, tau).copy();
  Vector back = arm.rnea(q, v, ddq).copy();
  for (std::size_t k = 0; k < arm.n; ++k) back[k] -= tau[k];
  return size_of(back) / (eps * condition);
}

// Articulated bodies against the factor of M: the relative difference of the accelerations / (eps cond).
double disagreement(Arm& arm, const Vector& q, double condition, std::mt19937& dice) {
  const Vector v = numbers(arm.n, dice), tau = numbers(arm.n, dice);
  const Vector ddq = arm.aba(q, v, tau).copy();
  Vector rest = arm.compute_nle(q, v).copy();
  for (std::size_t k = 0; k < arm.n; ++k) rest[k] = tau[k] - rest[k];
  arm.crba(q), arm.cholesky();
  Vector other = arm.cholesky_solve(rest);
  for (std::size_t k = 0; k < arm.n; ++k) other[k] -= ddq[k];
  return size_of(other) / size_of(ddq) / (eps * condition);
}

template <class F>
Outcome over_chains(F&& measure) {
  Outcome out;
  out.picture = {"log10 of links", "error / (eps cond)", true, {{"straight", {}, {}}, {"random", {}, {}}, {"coil", {}, {}}}};
  std::mt19937 dice(1);
  for (const int n : {8, 16, 32, 64, 128, 256, 512, 1000}) {
    Arm arm(chain(n));
    for (const Pose p : {Pose::straight, Pose::random, Pose::coil}) {
      const Vector q = pose(arm.n, p, dice);
      const double error = measure(arm, q, condition_of(q, 1), dice);
      out.off_by(error);
      out.picture.curves[static_cast<std::size_t>(p)].add(std::log10(n), error);
    }
  }
  return out;
}

}  // namespace

Outcome chain_round_trip() { return over_chains(round_trip); }
Outcome chain_factor() { return over_chains(disagreement); }

Outcome chain_condition() {
  Outcome out;
  std::mt19937 dice(1);
  const std::pair<int, double> straight[] = {{8, 1.797e4}, {32, 4.292e6}, {64, 6.704e7}, {128, 1.058e9}, {256, 1.680e10}};
  for (const auto& [n, condition] : straight) {
    Arm arm(chain(n));
    out.compare(condition, arm.condition(Vector(arm.n)), condition);
  }
  return out;
}

Outcome heavy_tip() {
  Outcome out;
  out.picture = {"log10 of tip / link", "error / (eps cond)", true, {{"10 links", {}, {}}, {"20 links", {}, {}}}};
  std::mt19937 dice(1);
  for (const int n : {10, 20})
    for (const double tip : {1.0, 1e2, 1e3, 1e4, 1e6}) {
      Arm arm(chain(n, tip));
      const Vector q(arm.n);
      const double condition = condition_of(q, tip),
                   error = std::max(round_trip(arm, q, condition, dice), disagreement(arm, q, condition, dice));
      out.off_by(error);
      out.picture.curves[n == 20].add(std::log10(tip), error);
    }
  return out;
}

}  // namespace cli::stress
