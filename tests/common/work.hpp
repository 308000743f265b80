// A model's data for one scalar, and differences along motions in quadruple precision.
#pragma once

#include <new>

#include "common/eigen.hpp"
#include "common/quad.hpp"
#include "algorithm/configuration.hpp"
#include "algorithm/declarations.hpp"
#include "integrator/stepping.hpp"
#include "model/block.hpp"
#include "model/builder.hpp"
#include "simulation/data_layout.hpp"

namespace dyn_test {

// Eigen's expressions evaluated; other things as they are.
template <class X>
decltype(auto) plain(const X& x) {
  if constexpr (requires { x.eval(); })
    return VectorXd(x);
  else
    return (x);
}

template <class T>
class Work {
  Zeros zeros;

 public:
  const Model& m;
  Data<T> d;

  // With all effects that the model has.
  explicit Work(const Model& model, dynParts parts = DYN_PART_ALL)
      : zeros(data_bytes<T>(model, parts)), m(model), d{} {
    if (!zeros.memory) throw std::bad_alloc();
    data_layout(model, parts, zeros.memory, d);
    std::fill_n(d.effects, model.n.joints, DYN_EFFECT_ALL);
    apply_effects(model, d);
  }
  // Sets an input (d.q, input_q) from numbers of any kind.
  template <class X>
  void set(T* to, Input input, const X& from) {
    std::size_t k = 0;
    for (const auto& value : from) to[k++] = T(value);
    d.changed(input);
  }
  template <class X>
  Work& q(const X& x) {
    set(d.q, input_q, plain(x));
    return *this;
  }
  template <class X>
  Work& v(const X& x) {
    set(d.v, input_v, plain(x));
    return *this;
  }
  template <class X>
  Work& a(const X& x) {
    set(d.a, input_a, plain(x));
    return *this;
  }
  template <class X>
  Work& tau(const X& x) {
    set(d.tau_applied, input_tau, plain(x));
    return *this;
  }
};

template <class T>
MatrixXd matrix(const T* x, Eigen::Index rows, Eigen::Index cols = 1) {
  MatrixXd out(rows, cols);
  for (Eigen::Index k = 0; k < rows * cols; ++k) out.data()[k] = double(x[k]);
  return out;
}

// A state of a model: configuration within its limits, the rest in [-1, 1].
struct State {
  VectorXd q, v, a, tau;
  State(const Model& m, std::uint64_t seed) : q(m.n.nq) {
    Dice dice(seed);
    random_configuration(m, dice.next(), m.lower_limit(), m.upper_limit(), q.data());
    v = dice.vector(m.n.nv), a = dice.vector(m.n.nv), tau = dice.vector(m.n.nv, 10);
  }
};

using Quads = std::vector<Quad>;

// out = q (+) (t v + t^2 / 2 a): passes q at t = 0 with velocity v and acceleration a
inline Quads on_path(const Model& m, const VectorXd& q, const VectorXd& v, const VectorXd& a, Quad t) {
  Quads from, step, out(std::size_t(m.n.nq));
  for (double x : q) from.emplace_back(x);
  for (Eigen::Index k = 0; k < v.size(); ++k) step.emplace_back(t * Quad(v[k]) + Quad(0.5) * t * t * Quad(a[k]));
  step.emplace_back(0);  // never empty
  integrate(m, from.data(), step.data(), out.data());
  return out;
}

inline MatrixXd scaled_difference(const Quads& a, const Quads& b, Quad scale, Eigen::Index rows) {
  MatrixXd out(rows, Eigen::Index(a.size()) / std::max<Eigen::Index>(rows, 1));
  for (std::size_t k = 0; k < a.size(); ++k) out.data()[k] = double((a[k] - b[k]) * scale);
  return out;
}
// First and second derivatives at t = 0 of f(t), a vector of Quad, by central differences. Steps: truncation h^2 |v|^2 and
// rounding 1e-33 / h (1e-33 / h^2) both stay below 1e-13 of the result.
template <class F>
MatrixXd rate(F&& f, Eigen::Index rows) {
  const Quad h(1e-10);
  return scaled_difference(f(h), f(-h), Quad(0.5) / h, rows);
}
template <class F>
MatrixXd second_rate(F&& f, Eigen::Index rows) {
  const Quad h(1e-8);
  const Quads plus = f(h), minus = f(-h);
  Quads middle = f(Quad(0)), sum = plus;
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += minus[k], middle[k] *= Quad(2);
  return scaled_difference(sum, middle, Quad(1) / (h * h), rows);
}

// One step of an integrator, or the joint that it failed at.
inline Index take_step(const Model& m, Data<double>& d, dynIntegrator integrator, double h) {
  dynStepReport report{};
  return integrator::step(m, d, integrator, h, report);
}

}  // namespace dyn_test
