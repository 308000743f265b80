#include "solver/residuals.hpp"

namespace dyn::solver {

void report(const dynContactProblem& x, const Problem& p, const double* y, const double* c, dynContactReport& out) {
  const Worst worst = residual(p, y, c);
  out.worst = worst.row < 0 ? -1 : p.source[worst.row];
  out.residual = is_lost_to_round_off(p, y) ? HUGE_VAL : worst.residual > 0 ? worst.residual / p.speed : 0;
  out.primal = out.dual = out.complementarity = out.natural_map = out.signorini = out.dissipation = out.energy = 0;
  const auto largest = [](double& a, double b) { a = std::max(a, b); };
  const auto bounded = [&](const Block& s) {
    const double unit = p.unit[s.first], lower = unit * s.lower, upper = unit * s.upper;
    const double l = unit * y[s.first], v = c[s.first] / unit;
    const bool above = std::isinf(lower), below = std::isinf(upper);  // an infinite bound: no force can hold such a velocity
    largest(out.primal, std::fabs(l - std::clamp(l, lower, upper)));
    largest(out.dual, std::max(above ? v : 0.0, below ? -v : 0.0));
    const double gap = v > 0 ? (above ? l : l - lower) : (below ? l : upper - l);
    largest(out.complementarity, std::fabs(v * gap));
    largest(out.natural_map, std::fabs(l - std::clamp(l - v, lower, upper)));
    if (lower == 0 && below) largest(out.signorini, std::fabs(l * v));
  };
  const auto contact = [&](const Block& s) {
    const double mu = s.mu * p.unit[s.first + 1] / p.unit[s.first];
    double l[6] = {}, u[6] = {}, e[6], product = 0;
    for (Index i = 0; i < s.rows; ++i)
      l[i] = p.unit[s.first + i] * y[s.first + i], u[i] = c[s.first + i] * p.per_unit[s.first + i];
    natural_map(mu, s.rows, l, u, e);
    largest(out.natural_map, norm(e, s.rows));
    largest(out.primal, distance_to_cone(mu, s.rows, l));
    largest(out.signorini, std::fabs(l[0] * u[0]));
    largest(out.dissipation, norm(u + 1, s.rows - 1) * (mu * l[0] - norm(l + 1, s.rows - 1)));
    u[0] += de_saxce(mu, s.rows, u);
    largest(out.dual, distance_to_dual_cone(mu, s.rows, u));
    for (Index i = 0; i < s.rows; ++i) product += l[i] * u[i];
    largest(out.complementarity, std::fabs(product));
  };
  p.for_each([&](const Block& s) { s.is_cone() ? contact(s) : bounded(s); });
  for (Index i = 0; i < p.n; ++i) {
    const Index row = p.source[i];
    const double l = p.d[i] * y[i], R = x.compliance ? x.compliance[row] : 0;
    out.energy += l * (x.g[row] + 0.5 * ((c[i] - p.g[i]) / p.d[i] - R * l));
  }
}

}  // namespace dyn::solver
