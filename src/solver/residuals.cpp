#include "solver/residuals.hpp"

namespace dyn::solver {

void report(const dynContactProblem& x, const Problem& p, const double* y, const double* c, dynContactReport& out) {
  const Worst worst = residual(p, y, c);
  out.worst = worst.row < 0 ? -1 : p.source[worst.row];
  out.residual = is_lost_to_round_off(p, y) ? HUGE_VAL : worst.residual > 0 ? worst.residual / p.speed : 0;
  out.primal = out.dual = out.complementarity = out.natural_map = out.signorini = out.dissipation = out.energy = 0;
  const auto largest = [](double& a, double b) { a = std::max(a, b); };
  for (Index i = 0; i < p.boxes; ++i) {
    const double l = p.unit[i] * y[i], v = c[i] * p.per_unit[i], lower = p.unit[i] * p.lower[i], upper = p.unit[i] * p.upper[i];
    const bool above = std::isinf(lower), below = std::isinf(upper);  // an infinite bound: no force can hold such a velocity
    largest(out.primal, std::fabs(l - std::min(std::max(l, lower), upper)));
    largest(out.dual, std::max(above ? v : 0.0, below ? -v : 0.0));
    const double gap = v > 0 ? (above ? l : l - lower) : (below ? l : upper - l);
    largest(out.complementarity, std::fabs(v * gap));
    largest(out.natural_map, std::fabs(l - std::min(std::max(l - v, lower), upper)));
    if (lower == 0 && std::isinf(upper)) largest(out.signorini, std::fabs(l * v));
  }
  for (Index k = 0; k < p.cones; ++k) {
    const Cone& cone = p.cone[k];
    double l[6] = {}, u[6] = {}, e[6];
    for (Index i = 0; i < cone.size; ++i)
      l[i] = p.unit[cone.row + i] * y[cone.row + i], u[i] = c[cone.row + i] * p.per_unit[cone.row + i];
    const Cone own = {cone.row, cone.size, cone.mu * p.unit[cone.row + 1] / p.unit[cone.row]};
    natural_map(own, l, u, e);
    largest(out.natural_map, norm(e, own.size));
    largest(out.primal, distance_to_cone(own.mu, own.size, l));
    largest(out.signorini, std::fabs(l[0] * u[0]));
    largest(out.dissipation, norm(u + 1, own.size - 1) * (own.mu * l[0] - norm(l + 1, own.size - 1)));
    u[0] += de_saxce(own.mu, own.size, u);
    largest(out.dual, distance_to_dual_cone(own.mu, own.size, u));
    double product = 0;
    for (Index i = 0; i < own.size; ++i) product += l[i] * u[i];
    largest(out.complementarity, std::fabs(product));
  }
  for (Index i = 0; i < p.n; ++i) {
    const Index row = p.source[i];
    const double l = p.d[i] * y[i], R = x.compliance ? x.compliance[row] : 0;
    out.energy += l * (x.g[row] + 0.5 * ((c[i] - p.g[i]) / p.d[i] - R * l));
  }
}

}  // namespace dyn::solver
