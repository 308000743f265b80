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

struct Arm : Data {
  explicit Arm(const Model& model)
      : Data(model, DYN_PART_MINV | DYN_PART_MASS | DYN_PART_INVERSE | DYN_PART_FORWARD | DYN_PART_CHOLESKY),
        n(static_cast<std::size_t>(model.nv())) {}
  std::size_t n;

  // Largest eigenvalue of a symmetric matrix, by powers.
  double largest(const double* A) const {
    Vector x(n), y(n);
    for (std::size_t i = 0; i < n; ++i) x[i] = 1 + 0.3 * std::sin(7.0 * static_cast<double>(i)) + (i % 2 ? 0.2 : -0.2);
    double value = 0, before = -1;
    for (int k = 0; k < 1000 && std::abs(value - before) > 1e-10 * value; ++k) {
      double size = 0;
      std::fill(y.begin(), y.end(), 0.0);
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t i = 0; i < n; ++i) y[i] += A[i + n * j] * x[j];
      for (const double e : y) size += e * e;
      before = value, value = std::sqrt(size);
      for (std::size_t i = 0; i < n; ++i) x[i] = y[i] / value;
    }
    return value;
  }
  double condition(const Vector& q) {
    const double high = largest(crba(q).data());
    return high * largest(minv(q).data());
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
      const double error = measure(arm, q, arm.condition(q), dice);
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
      const double condition = arm.condition(q),
                   error = std::max(round_trip(arm, q, condition, dice), disagreement(arm, q, condition, dice));
      out.off_by(error);
      out.picture.curves[n == 20].add(std::log10(tip), error);
    }
  return out;
}

}  // namespace cli::stress
