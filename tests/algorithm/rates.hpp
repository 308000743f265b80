// Derivatives by central differences in quadruple precision (truncation 1e-16 of the third derivative).
#pragma once

#include "algorithm/trees.hpp"

namespace dyn_test {

// Column k: the derivative of f(q, v, a) along the k-th direction of the tangent space at q, of v, or of a.
template <class F>
MatrixXd by(const Case& c, Input input, F&& f) {
  const Quads q(c.x.q.begin(), c.x.q.end()), v(c.x.v.begin(), c.x.v.end()), a(c.x.a.begin(), c.x.a.end());
  MatrixXd out;
  for (Index k = 0; k < c.nv; ++k) {
    auto moved = [&](Quad t) {
      if (input == input_q) return f(on_path(c.m, c.x.q, VectorXd::Unit(c.nv, k), VectorXd::Zero(c.nv), t), v, a);
      Quads x = input == input_v ? v : a;
      x[std::size_t(k)] += t;
      return input == input_v ? f(q, x, a) : f(q, v, x);
    };
    if (k == 0) out.resize(Eigen::Index(moved(Quad(0)).size()), c.nv);
    out.col(k) = rate(moved, out.rows());
  }
  return out;
}
template <class F>
MatrixXd by_q(const Case& c, F&& f) {
  return by(c, input_q, f);
}
template <class F>
MatrixXd by_v(const Case& c, F&& f) {
  return by(c, input_v, f);
}

inline TreeOptions up_to(int joints) {
  TreeOptions options;
  options.joints = joints;
  return options;
}

}  // namespace dyn_test
