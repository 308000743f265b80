// Energies, and what follows from them: gravity, the joint-space inertia, the power balance, the Coriolis matrix.
#include "algorithm/energy.hpp"

#include "algorithm/trees.hpp"
#include "algorithm/crba.hpp"

namespace dyn_test {
namespace {

struct Energies {
  const Case& c;
  Work<Quad> w;
  explicit Energies(const Case& c_) : c(c_), w(c_.m, DYN_PART_ENERGY) {}
  Quads potential(Quad t, const VectorXd& v) {
    potential_energy(c.m, w.q(on_path(c.m, c.x.q, v, VectorXd::Zero(v.size()), t)).d);
    return {w.d.potential[0]};
  }
  // at (q, v) along the path with acceleration a
  Quads total(Quad t, const VectorXd& v, const VectorXd& a) {
    Quads vt;
    for (Eigen::Index k = 0; k < v.size(); ++k) vt.push_back(Quad(v[k]) + t * Quad(a[k]));
    w.q(on_path(c.m, c.x.q, v, a, t)).v(vt);
    kinetic_energy(c.m, w.d), potential_energy(c.m, w.d);
    return {w.d.kinetic[0] + w.d.potential[0]};
  }
};

TEST(Energy, GravityIsTheGradientOfPotentialEnergy) {
  for_trees([](Case& c) {
    Energies e(c);
    const VectorXd g = c.gravity();
    for (int trial = 0; trial < 3; ++trial) {
      const VectorXd u = Dice(std::uint64_t(trial) + 1).vector(c.nv);
      const double dV = rate([&](Quad t) { return e.potential(t, u); }, 1)(0, 0);
      EXPECT_LE(std::abs(g.dot(u) - dV), tol * (g.cwiseAbs().dot(u.cwiseAbs())));
    }
  });
}

TEST(Energy, EachComponentOfGravity) {
  TreeOptions small;
  small.joints = 8;
  for_trees(
      [](Case& c) {
        Energies e(c);
        const VectorXd g = c.gravity();
        for (Index k = 0; k < c.nv; ++k)
          EXPECT_LE(std::abs(g[k] - rate([&](Quad t) { return e.potential(t, VectorXd::Unit(c.nv, k)); }, 1)(0, 0)),
                    tol * (1 + largest(g)));
      },
      50, small);
}

TEST(Energy, KineticIsHalfVTMV) {
  for_trees([](Case& c) {
    const MatrixXd M = c.M();
    const VectorXd u = Dice(5).vector(c.nv);
    // three speeds fix the bilinear form, too: u M v = T(u + v) - T(u) - T(v)
    auto T = [&](const VectorXd& v) {
      c.w.v(v);
      kinetic_energy(c.m, c.w.d);
      return c.w.d.kinetic[0];
    };
    const double scale = c.x.v.cwiseAbs().dot(M.cwiseAbs() * c.x.v.cwiseAbs()) + u.cwiseAbs().dot(M.cwiseAbs() * u.cwiseAbs());
    EXPECT_LE(std::abs(T(c.x.v) - 0.5 * c.x.v.dot(M * c.x.v)), tol * scale);
    EXPECT_LE(std::abs(T(u + c.x.v) - T(u) - T(c.x.v) - u.dot(M * c.x.v)), 4 * tol * scale);
    EXPECT_EQ(0, T(VectorXd::Zero(c.nv)));
    EXPECT_GT(T(u), 0);
  });
}

TEST(Energy, PowerBalance) {
  for_trees([](Case& c) {
    // dE/dt = v^T tau, tau from inverse dynamics
    Energies e(c);
    const VectorXd tau = c.rnea(c.x.v, c.x.a);
    const double dE = rate([&](Quad t) { return e.total(t, c.x.v, c.x.a); }, 1)(0, 0);
    EXPECT_LE(std::abs(dE - c.x.v.dot(tau)), tol * c.nv * c.terms(c.x.a));
    // and for the motion that forward dynamics finds
    const VectorXd ddq = c.aba(c.x.tau);
    const double dE_forward = rate([&](Quad t) { return e.total(t, c.x.v, ddq); }, 1)(0, 0);
    EXPECT_LE(std::abs(dE_forward - c.x.v.dot(c.x.tau)), tol * c.nv * (c.terms(ddq) + largest(c.x.tau)));
  });
}

TEST(Energy, PotentialIsMassTimesHeight) {
  for_trees(
      [](Case& c) {
        potential_energy(c.m, c.w.d);
        center_of_mass(c.m, c.w.d, 0);
        const double V = -c.m.total_mass * c.tree.gravity.dot(V3(c.w.d.com));
        EXPECT_LE(std::abs(c.w.d.potential[0] - V), tol * c.m.total_mass * 10 * (1 + largest(matrix(c.w.d.com, 3))));
      },
      50);
}

TEST(Coriolis, TimesVelocityPlusGravityIsNle) {
  for_trees([](Case& c) {
    coriolis_matrix(c.m, c.w.d);
    const MatrixXd C = matrix(c.w.d.coriolis, c.nv, c.nv);
    EXPECT_LE(gap(C * c.x.v + c.gravity(), c.nle()), tol * ((C.cwiseAbs() * c.x.v.cwiseAbs()).maxCoeff() + largest(c.gravity())));
  });
}

TEST(Coriolis, RateOfTheInertiaIsCPlusItsTranspose) {
  for_trees(
      [](Case& c) {
        if (c.nv > 70) return;  // M in quadruple precision costs nv^2
        coriolis_matrix(c.m, c.w.d);
        const MatrixXd C = matrix(c.w.d.coriolis, c.nv, c.nv);
        Work<Quad> q(c.m, DYN_PART_MASS | DYN_PART_KINEMATICS);
        const VectorXd none = VectorXd::Zero(c.nv);
        const MatrixXd dM = rate(
            [&](Quad t) {
              crba(c.m, q.q(on_path(c.m, c.x.q, c.x.v, none, t)).d);
              return Quads(q.d.M, q.d.M + std::ptrdiff_t(c.nv) * c.nv);
            },
            c.nv);
        // C may vanish while its terms, of the size of M v, do not: a hundredth of them is the floor of rounding at this tol
        double inertia = 0;
        for (std::ptrdiff_t k = 0; k < std::ptrdiff_t(c.nv) * c.nv; ++k) inertia = std::max(inertia, std::abs(double(q.d.M[k])));
        const double scale = largest(C) + largest(dM) + 0.01 * inertia * largest(c.x.v);
        EXPECT_LE(gap(C + C.transpose(), dM), tol * scale);
        const MatrixXd S = dM - 2 * C;
        EXPECT_LE(gap(S, -S.transpose()), 2 * tol * scale) << "dM/dt - 2 C is skew-symmetric";
      },
      120);
}

}  // namespace
}  // namespace dyn_test
