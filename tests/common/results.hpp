// What two models must agree in: inverse dynamics, M, and placements of frames.
#pragma once

#include "common/work.hpp"

namespace dyn_test {

struct Results {
  VectorXd tau;
  MatrixXd M;
  std::vector<M4> frames;
  Results(const Model& m, const VectorXd& q, const VectorXd& v) : Results(m, q, v, VectorXd::Zero(m.n.nv)) {}
  Results(const Model& m, const VectorXd& q, const VectorXd& v, const VectorXd& a) : tau(m.n.nv) {
    Work<double> w(m);
    w.q(q).v(v).a(a);
    inverse_dynamics<double>(w.m, w.d, w.d.v, w.d.a, nullptr, tau.data());
    crba(w.m, w.d);
    M = matrix(w.d.M, m.n.nv, m.n.nv);
    forward_kinematics<0>(w.m, w.d);
    for (Index f = 0; f < m.n.frames; ++f) {
      double X[12];
      frame_placement(w.m, w.d, f, X);
      frames.push_back(eigen(X));
    }
  }
};

}  // namespace dyn_test
