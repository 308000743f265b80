#include "derivatives.hpp"

#include <algorithm>
#include <cmath>

namespace cli::accuracy {

namespace {

using Clock = std::chrono::steady_clock;

// Forward dynamics at q (+) dq, v + dv.
struct Dynamics {
  const Scene& scene;
  const Data& data;
  Vector q, v;
  void operator()(const Vector& dq, const Vector& dv, Vector& ddq) {
    const Robot& robot = scene.robot;
    check(dyn_integrate(robot, scene.start.q.data(), dq.data(), q.data()));
    for (int k = 0; k < robot.nv; ++k) v[k] = scene.start.v[k] + dv[k];
    check(dyn_aba(robot, data, q.data(), v.data(), scene.start.tau.data(), nullptr, ddq.data()));
  }
};

// d ddq / d(q, v), nv x 2 nv, by differences of step h.
void differences(Dynamics& f, int nv, double h, bool central, Vector& out) {
  Vector dq(nv), dv(nv), plus(nv), minus(nv);
  if (!central) f(dq, dv, minus);
  for (int c = 0; c < 2 * nv; ++c) {
    double& x = c < nv ? dq[c] : dv[c - nv];
    x = h, f(dq, dv, plus);
    if (central) x = -h, f(dq, dv, minus);
    x = 0;
    for (int r = 0; r < nv; ++r) out[r + std::size_t(nv) * c] = (plus[r] - minus[r]) / (central ? 2 * h : h);
  }
}

double median_time(const auto& f) {
  std::vector<double> times;
  for (int k = 0; k < 5; ++k) {
    const auto before = Clock::now();
    f();
    times.push_back(std::chrono::duration<double>(Clock::now() - before).count());
  }
  std::sort(times.begin(), times.end());
  return times[2];
}

}  // namespace

std::vector<DerivativeCost> derivative_sweep(const Scene& scene) {
  const Robot& robot = scene.robot;
  const std::size_t nv = static_cast<std::size_t>(robot.nv), square = nv * nv;
  const Data data(robot, DYN_PART_FORWARD_DERIVATIVES, scene.effects);
  std::vector<DerivativeCost> out;
  if (nv == 0) return out;
  Vector exact(2 * square), found(2 * square), coarse(2 * square);
  const dynAbaDerivatives wanted = {sizeof wanted, exact.data(), exact.data() + square, nullptr};
  const auto analytic = [&] {
    check(dyn_aba_derivatives(robot, data, scene.start.q.data(), scene.start.v.data(), scene.start.tau.data(), nullptr, &wanted));
  };
  out.push_back({"analytic", 0, 0, median_time(analytic)});
  double largest = 0;
  for (const double x : exact) largest = std::max(largest, std::abs(x));
  Dynamics f{scene, data, Vector(robot.nq), Vector(robot.nv)};
  const auto error = [&] {
    double most = 0;
    for (std::size_t k = 0; k < exact.size(); ++k) most = std::max(most, std::abs(found[k] - exact[k]));
    return largest > 0 ? most / largest : most;
  };
  for (const char* method : {"forward", "central", "extrapolated"})
    for (int e = 1; e <= 12; ++e) {
      const double h = std::pow(10.0, -e);
      const bool central = *method != 'f', extrapolated = *method == 'e';
      const double wall = median_time([&] {
        differences(f, robot.nv, h, central, found);
        if (!extrapolated) return;
        differences(f, robot.nv, 2 * h, true, coarse);
        for (std::size_t k = 0; k < found.size(); ++k) found[k] += (found[k] - coarse[k]) / 3;  // the term of h^2 cancels
      });
      out.push_back({method, h, error(), wall});
    }
  return out;
}

}  // namespace cli::accuracy
