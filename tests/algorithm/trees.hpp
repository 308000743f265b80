// The random robots that every identity is tested on, each with a state.
#pragma once

#include "common/random_tree.hpp"
#include "common/work.hpp"

namespace dyn_test {

struct Case {
  Tree tree;
  ModelPtr model;
  const Model& m;
  Index nv;
  State x;
  Work<double> w;

  explicit Case(std::uint64_t seed, const TreeOptions& options = {})
      : tree(random_tree(seed, options)), model(tree.build()), m(*model), nv(m.n.nv), x(m, seed), w(m) {
    w.q(x.q).v(x.v).a(x.a).tau(x.tau);
  }

  VectorXd rnea(const VectorXd& v, const VectorXd& a, const double* fext = nullptr) {
    VectorXd tau(nv);
    inverse_dynamics(m, w.d, v.data(), a.data(), fext, tau.data());
    return tau;
  }
  VectorXd nle() { return rnea(x.v, VectorXd::Zero(nv)); }
  VectorXd gravity() { return rnea(VectorXd::Zero(nv), VectorXd::Zero(nv)); }
  VectorXd aba(const VectorXd& tau, const double* fext = nullptr) {
    VectorXd ddq(nv);
    EXPECT_EQ(0, forward_dynamics(m, w.d, x.v.data(), tau.data(), fext, ddq.data()));
    return ddq;
  }
  MatrixXd M() {
    crba(m, w.d);
    return matrix(w.d.M, nv, nv);
  }
  // what the terms of M a + nle add up without their signs: rounding is measured by it
  double terms(const VectorXd& a) { return (M().cwiseAbs() * a.cwiseAbs()).maxCoeff() + largest(nle()) + largest(gravity()); }
};

template <class F>
void for_trees(F&& f, int count = tree_count, const TreeOptions& options = {}) {
  for (int seed = 1; seed <= count; ++seed) {
    SCOPED_TRACE(testing::Message() << "tree " << seed);
    Case c(std::uint64_t(seed), options);
    f(c);
    if (testing::Test::HasFailure()) return;
  }
}

// 60 joints, each adding a few roundings of 1.1e-16 relative to the terms
inline constexpr double tol = 2e-13;

inline const dynReference references[] = {DYN_REFERENCE_LOCAL, DYN_REFERENCE_WORLD, DYN_REFERENCE_LOCAL_WORLD_ALIGNED};

// the frame of type JOINT of a joint
inline Index joint_frame(const Model& m, Index joint) {
  for (Index f = 0; f < m.n.frames; ++f)
    if (m.frames()[f].type == DYN_FRAME_TYPE_JOINT && m.frames()[f].joint == joint) return f;
  return 0;
}

}  // namespace dyn_test
