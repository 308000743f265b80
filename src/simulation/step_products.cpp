// Products of the derivatives of a step: along directions (forward) and transposed (reverse); and its derivatives by parameters.
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

namespace {

std::ptrdiff_t inputs(const Model& m, const StepProducts& p) { return derivative_count(m) + p.numbers; }

}  // namespace

// Of y.given and y.gradient.
double StepJacobian::product_with_given() const {
  double sum = 0;
  const auto add = [&](const double* a, const double* b, std::ptrdiff_t n) { sum += inner(a, b, n); };
  const StepChange &a = y.given, &b = y.gradient;
  add(a.force, b.force, nv), add(a.velocity, b.velocity, nv), add(a.end, b.end, 2 * nv);
  if (rows > 0) add(a.row, b.row, rows), add(a.slide, b.slide, rows);
  add(a.wrong, b.wrong, corrections);
  if (exact) add(a.displacement, b.displacement, nv), add(a.G, b.G, exact_corrections(m) * exact_corrections(m));
  return sum;
}

// Inputs are q, v, tau, controls outside, and q, v, controls, tau here.
void StepJacobian::multiply(const StepProducts& p) {
  const std::ptrdiff_t first = mixed + nv, n = inputs(m, p), nu = m.n.nu;
  const auto analytic = [](const StepParameter& a) { return a.type != DYN_STEP_PARAMETER_TYPE_TIME_STEP; };
  const auto for_each_number = [&](auto&& f) {
    p.for_each_parameter([&](const StepParameter& a, Index number) {
      for (Index c = 0; analytic(a) && c < parameter_size(a.type); ++c) f(a, c, number + c);
    });
  };
  if (p.P) {
    std::fill_n(y.direction, first, 0.0);
    for_each_number([&](const StepParameter& a, Index c, Index number) {
      clear_given(), add_parameter(a, c, 1), apply(), write(p.P + 2 * nv * number);
    });
  }
  for (Index t = 0; t < p.tangent_count; ++t) {
    const double* const in = p.tangents + n * t;
    std::copy_n(in, 2 * nv, y.direction), std::copy_n(in + 3 * nv, nu, y.direction + 2 * nv);
    std::copy_n(in + 2 * nv, nv, y.direction + mixed);
    clear_given();
    for_each_number([&](const StepParameter& a, Index c, Index number) {
      if (const double factor = in[first + number]; factor != 0) add_parameter(a, c, factor);
    });
    apply(), write(p.jvp + 2 * nv * t);
  }
  for (Index t = 0; t < p.cotangent_count; ++t) {
    double* const out = p.vjp + n * t;
    apply_transposed(p.cotangents + 2 * nv * t);
    std::copy_n(y.adjoint, 2 * nv, out), std::copy_n(y.adjoint + mixed, nv, out + 2 * nv);
    std::copy_n(y.adjoint + 2 * nv, nu, out + 3 * nv);
    for_each_number([&](const StepParameter& a, Index c, Index number) {
      clear_given(), add_parameter(a, c, 1), out[first + number] = product_with_given();
    });
  }
}

void multiply(const Model& m, const StepDerivatives& x, const StepProducts& p) {
  const std::ptrdiff_t rows = 2 * std::ptrdiff_t(m.n.nv), first = derivative_count(m), n = inputs(m, p);
  for (Index t = 0; t < p.tangent_count; ++t) {
    std::fill_n(p.jvp + rows * t, rows, 0.0);
    for (std::ptrdiff_t k = 0; k < first; ++k) solver::add_row(p.jvp + rows * t, x.by + rows * k, p.tangents[n * t + k], rows);
  }
  for (Index t = 0; t < p.cotangent_count; ++t)
    for (std::ptrdiff_t k = 0; k < first; ++k)
      p.vjp[n * t + k] = StepJacobian::inner(x.by + rows * k, p.cotangents + rows * t, rows);
}

void add_column(const Model& m, const StepProducts& p, Index number, const double* column) {
  const std::ptrdiff_t rows = 2 * std::ptrdiff_t(m.n.nv), at = derivative_count(m) + number, n = inputs(m, p);
  if (p.P) std::copy_n(column, rows, p.P + rows * number);
  for (Index t = 0; t < p.tangent_count; ++t) solver::add_row(p.jvp + rows * t, column, p.tangents[n * t + at], rows);
  for (Index t = 0; t < p.cotangent_count; ++t) p.vjp[n * t + at] = StepJacobian::inner(column, p.cotangents + rows * t, rows);
}

}  // namespace dyn::simulation
