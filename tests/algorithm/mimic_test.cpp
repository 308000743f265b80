// A model with mimic joints equals the model in which they are free, projected with G: q = G q_leaders + offset. All algorithms.
#include "algorithm/trees.hpp"

namespace dyn_test {
namespace {

struct Twins {
  Case c;
  ModelPtr free_model;
  const Model& f;
  Work<double> w;
  MatrixXd G;  // nv of the free model x nv
  VectorXd q;

  explicit Twins(std::uint64_t seed, const TreeOptions& options)
      : c(seed, options), free_model(c.tree.build(false)), f(*free_model), w(f), G(MatrixXd::Zero(f.n.nv, c.nv)), q(f.n.nq) {
    EXPECT_EQ(c.m.n.joints, f.n.joints);
    for (Index j = 1; j < f.n.joints; ++j) {
      const JointRecord &own = c.m.joints()[j], &full = f.joints()[j];
      EXPECT_STREQ(c.m.string(own.name), f.string(full.name));
      for (Index k = 0; k < full.nv; ++k) G(full.idx_v + k, own.idx_v + k) = own.leader >= 0 ? own.ratio : 1;
      for (Index k = 0; k < full.nq; ++k)
        q[full.idx_q + k] = own.leader >= 0 ? own.ratio * c.x.q[own.idx_q] + own.offset : c.x.q[own.idx_q + k];
    }
    w.q(q).v(G * c.x.v).a(G * c.x.a);
  }
  VectorXd full_rnea(const VectorXd& v, const VectorXd& a, const double* fext = nullptr) {
    const VectorXd gv = G * v, ga = G * a;
    VectorXd tau(f.n.nv);
    inverse_dynamics(f, w.d, gv.data(), ga.data(), fext, tau.data());
    return G.transpose() * tau;
  }
};
template <class F>
void for_twins(F&& f, int count = 100) {
  TreeOptions options;
  options.mimic = 0.5;
  int with_mimic = 0;
  for (int seed = 1; seed <= count; ++seed) {
    SCOPED_TRACE(testing::Message() << "tree " << seed);
    Twins t(std::uint64_t(seed), options);
    with_mimic += t.c.m.has_mimic;
    f(t);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(with_mimic, count / 2);
}

TEST(MimicModel, InverseAndForwardDynamics) {
  for_twins([](Twins& t) {
    Case& c = t.c;
    const double scale = c.terms(c.x.a);
    EXPECT_LE(gap(c.rnea(c.x.v, c.x.a), t.full_rnea(c.x.v, c.x.a)), tol * scale);
    const MatrixXd f = Eigen::Map<MatrixXd>(Dice(3).vector(6 * c.m.n.joints, 10).data(), 6, c.m.n.joints);
    EXPECT_LE(gap(c.rnea(c.x.v, c.x.a, f.data()), t.full_rnea(c.x.v, c.x.a, f.data())), tol * (scale + 1e4));
    // forward dynamics solves the projected equation
    const VectorXd ddq = c.aba(c.x.tau, f.data());
    EXPECT_LE(gap(t.full_rnea(c.x.v, ddq, f.data()), c.x.tau), tol * (c.terms(ddq) + 1e4));
  });
}

TEST(MimicModel, InertiaAndCoriolis) {
  for_twins([](Twins& t) {
    Case& c = t.c;
    crba(t.f, t.w.d);
    const MatrixXd M = matrix(t.w.d.M, t.f.n.nv, t.f.n.nv), projected = t.G.transpose() * M * t.G;
    EXPECT_LE(gap(c.M(), projected), tol * largest(projected));
    coriolis_matrix(c.m, c.w.d);
    coriolis_matrix(t.f, t.w.d);
    const MatrixXd C = t.G.transpose() * matrix(t.w.d.coriolis, t.f.n.nv, t.f.n.nv) * t.G;
    EXPECT_LE(gap(matrix(c.w.d.coriolis, c.nv, c.nv), C), tol * largest(C));
  });
}

TEST(MimicModel, KinematicsAndJacobians) {
  for_twins([](Twins& t) {
    Case& c = t.c;
    forward_kinematics<2>(c.m, c.w.d);
    forward_kinematics<2>(t.f, t.w.d);
    MatrixXd J(6, c.nv), full(6, t.f.n.nv);
    for (Index k = 0; k < c.m.n.frames; k += 1 + c.m.n.frames / 9) {
      double X[12], Y[12];
      frame_placement(c.m, c.w.d, k, X), frame_placement(t.f, t.w.d, k, Y);
      EXPECT_LE(gap(eigen(X), eigen(Y)), tol * (1 + largest(eigen(X))));
      for (dynReference r : references) {
        V6 a, b;
        frame_velocity(c.m, c.w.d, k, r, a.data()), frame_velocity(t.f, t.w.d, k, r, b.data());
        EXPECT_LE(gap(a, b), tol * (1 + largest(a)));
        frame_acceleration(c.m, c.w.d, k, r, false, a.data()), frame_acceleration(t.f, t.w.d, k, r, false, b.data());
        EXPECT_LE(gap(a, b), tol * (1 + largest(a)));
        frame_jacobian(c.m, c.w.d, k, r, J.data()), frame_jacobian(t.f, t.w.d, k, r, full.data());
        EXPECT_LE(gap(J, full * t.G), tol * (1 + largest(J)));
        frame_jacobian_time_variation(c.m, c.w.d, k, r, J.data()), frame_jacobian_time_variation(t.f, t.w.d, k, r, full.data());
        EXPECT_LE(gap(J, full * t.G), tol * (1 + largest(J)));
      }
    }
    joint_jacobians_time_variation(c.m, c.w.d), joint_jacobians_time_variation(t.f, t.w.d);
    EXPECT_LE(gap(matrix(c.w.d.J, 6, c.nv), matrix(t.w.d.J, 6, t.f.n.nv) * t.G), tol * (1 + largest(matrix(c.w.d.J, 6, c.nv))));
    EXPECT_LE(gap(matrix(c.w.d.dJ, 6, c.nv), matrix(t.w.d.dJ, 6, t.f.n.nv) * t.G),
              tol * (1 + largest(matrix(c.w.d.dJ, 6, c.nv))));
  });
}

TEST(MimicModel, CenterOfMassAndEnergy) {
  for_twins([](Twins& t) {
    Case& c = t.c;
    center_of_mass(c.m, c.w.d, 2), center_of_mass(t.f, t.w.d, 2);
    for (auto get : {+[](Data<double>& d) { return d.com; }, +[](Data<double>& d) { return d.vcom; },
                     +[](Data<double>& d) { return d.acom; }})
      EXPECT_LE(gap(V3(get(c.w.d)), V3(get(t.w.d))), tol * (1 + largest(V3(get(c.w.d)))));
    MatrixXd J(3, c.nv), full(3, t.f.n.nv);
    for (Index root : {Index(0), c.m.n.bodies - 1}) {
      center_of_mass_jacobian(c.m, c.w.d, root, J.data()), center_of_mass_jacobian(t.f, t.w.d, root, full.data());
      EXPECT_LE(gap(J, full * t.G), tol * (1 + largest(J)));
    }
    kinetic_energy(c.m, c.w.d), kinetic_energy(t.f, t.w.d);
    potential_energy(c.m, c.w.d), potential_energy(t.f, t.w.d);
    EXPECT_LE(std::abs(c.w.d.kinetic[0] - t.w.d.kinetic[0]), tol * (1 + c.w.d.kinetic[0]));
    EXPECT_LE(std::abs(c.w.d.potential[0] - t.w.d.potential[0]), tol * (1 + 1e3 * c.m.total_mass));
  });
}

TEST(MimicModel, CentroidalAndRegressor) {
  for_twins([](Twins& t) {
    Case& c = t.c;
    const Index n = t.f.n.nv, parameters = parameter_count(t.f);
    auto same = [&](double* Data<double>::*field) {
      const MatrixXd got = matrix(c.w.d.*field, 6, c.nv), expected = matrix(t.w.d.*field, 6, n) * t.G;
      EXPECT_LE(gap(got, expected), tol * (1 + largest(expected)));
    };
    centroidal_map<true>(c.m, c.w.d), centroidal_map<true>(t.f, t.w.d);
    same(&Data<double>::Ag), same(&Data<double>::dAg);
    EXPECT_LE(gap(matrix(c.w.d.hg, 6), matrix(t.w.d.hg, 6)), tol * (1 + largest(matrix(t.w.d.hg, 6))));
    centroidal_derivatives(c.m, c.w.d), centroidal_derivatives(t.f, t.w.d);
    same(&Data<double>::Ag), same(&Data<double>::dh_dq), same(&Data<double>::dhdot_dq), same(&Data<double>::dhdot_dv);
    joint_torque_regressor(c.m, c.w.d), joint_torque_regressor(t.f, t.w.d);
    const MatrixXd Y = t.G.transpose() * matrix(t.w.d.regressor, n, parameters);
    EXPECT_LE(gap(matrix(c.w.d.regressor, c.nv, parameters), Y), tol * (1 + largest(Y)));
  });
}

TEST(MimicModel, SolveAndInverse) {
  for_twins(
      [](Twins& t) {
        Case& c = t.c;
        const MatrixXd M = c.M();
        ASSERT_EQ(0, factorize(c.m, c.w.d));
        VectorXd x = c.x.tau;
        solve(c.m, c.w.d, x.data(), x.data(), x.data());
        EXPECT_LE(gap(M * x, c.x.tau), tol * ((M.cwiseAbs() * x.cwiseAbs()).maxCoeff() + 10));
      },
      60);
}

}  // namespace
}  // namespace dyn_test
