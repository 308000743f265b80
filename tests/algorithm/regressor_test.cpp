// Regressors: times the parameters they give forces, energies and the centre of mass, of this robot and of any other with the
// same joints; bodies one by one against Newton and Euler.
#include "algorithm/torque_regressor.hpp"

#include "algorithm/trees.hpp"

namespace dyn_test {
namespace {

VectorXd parameters(const Model& m) {
  VectorXd pi(parameter_count(m));
  inertial_parameters(m, pi.data());
  return pi;
}
MatrixXd torque_regressor(Case& c) {
  joint_torque_regressor(c.m, c.w.d);
  return matrix(c.w.d.regressor, c.nv, parameter_count(c.m));
}
VectorXd armature_torque(Case& c) { return Eigen::Map<const VectorXd>(c.m.armature(), c.nv).cwiseProduct(c.x.a); }

// The same joints with other links.
Tree other_links(Tree tree, std::uint64_t seed) {
  Dice dice(seed);
  for (BodySpec& b : tree.bodies) b = random_body(dice, b.name, b.parent);
  return tree;
}

TEST(Regressor, TorqueIsLinearInTheParameters) {
  for_trees([](Case& c) {
    const MatrixXd Y = torque_regressor(c);
    const VectorXd pi = parameters(c.m);
    EXPECT_LE(gap(Y * pi + armature_torque(c), c.rnea(c.x.v, c.x.a)),
              tol * ((Y.cwiseAbs() * pi.cwiseAbs()).maxCoeff() + c.terms(c.x.a)));
    // Y knows nothing of the links
    const ModelPtr model = other_links(c.tree, 5).build();
    Work<double> w(*model);
    w.q(c.x.q);
    VectorXd tau(c.nv);
    inverse_dynamics<double>(*model, w.d, c.x.v.data(), c.x.a.data(), nullptr, tau.data());
    const VectorXd other = parameters(*model);
    EXPECT_LE(gap(Y * other + armature_torque(c), tau), 2 * tol * ((Y.cwiseAbs() * other.cwiseAbs()).maxCoeff() + largest(tau)));
  });
}

// Chains long enough for whole blocks of rows, and their remainders.
TEST(Regressor, TorqueOfChains) {
  TreeOptions chains;
  chains.branch = chains.mimic = 0, chains.types = {DYN_JOINT_TYPE_REVOLUTE};
  for (chains.joints = 1; chains.joints <= 26; ++chains.joints) {
    SCOPED_TRACE(chains.joints);
    Case c(std::uint64_t(chains.joints), chains);
    const MatrixXd Y = torque_regressor(c);
    const VectorXd pi = parameters(c.m);
    EXPECT_LE(gap(Y * pi + armature_torque(c), c.rnea(c.x.v, c.x.a)),
              tol * ((Y.cwiseAbs() * pi.cwiseAbs()).maxCoeff() + c.terms(c.x.a)));
  }
}

// Joints that do not carry a body do not feel it: exactly, whatever was computed before.
TEST(Regressor, ZeroWhereNothingIsCarried) {
  for_trees(
      [](Case& c) {
        torque_regressor(c);
        const State other(c.m, 99);
        c.w.q(other.q).v(other.v).a(other.a);
        const MatrixXd Y = torque_regressor(c);
        MatrixXd carries = MatrixXd::Zero(c.nv, c.m.n.joints);
        for (Index j = 1; j < c.m.n.joints; ++j)
          for (Index i = c.m.joints()[j].last_body; i != 0; i = c.m.bodies()[i].parent)
            visit(c.m.bodies()[i].type, [&]<class J>() { carries.col(j).segment(c.m.bodies()[i].user_v, J::nv).setOnes(); });
        for (Index j = 1; j < c.m.n.joints; ++j)
          for (Index k = 0; k < c.nv; ++k)
            EXPECT_TRUE(carries(k, j) == 1 || Y.block(k, 10 * (j - 1), 1, 10).isZero(0)) << k << ", " << j;
      },
      100);
}

TEST(Regressor, WithoutMotionItIsThatOfGravity) {
  for_trees(
      [](Case& c) {
        c.w.v(VectorXd(VectorXd::Zero(c.nv))).a(VectorXd(VectorXd::Zero(c.nv)));
        const MatrixXd Y = torque_regressor(c);
        const VectorXd pi = parameters(c.m), g = c.gravity();
        EXPECT_LE(gap(Y * pi, g), tol * ((Y.cwiseAbs() * pi.cwiseAbs()).maxCoeff() + largest(g)));
      },
      50);
}

TEST(Regressor, CentreOfMassAndEnergies) {
  for_trees([](Case& c) {
    const VectorXd pi = parameters(c.m);
    const Index n = parameter_count(c.m);
    static_regressor(c.m, c.w.d), kinetic_energy_regressor(c.m, c.w.d), potential_energy_regressor(c.m, c.w.d);
    const MatrixXd S = matrix(c.w.d.static_regressor, 3, n);
    const VectorXd k = matrix(c.w.d.kinetic_energy_regressor, n), p = matrix(c.w.d.potential_energy_regressor, n);
    center_of_mass(c.m, c.w.d, 0), kinetic_energy(c.m, c.w.d), potential_energy(c.m, c.w.d);
    EXPECT_LE(gap(S * pi, V3(c.w.d.com)), tol * (S.cwiseAbs() * pi.cwiseAbs()).maxCoeff());
    const double rotors = 0.5 * Eigen::Map<const VectorXd>(c.m.armature(), c.nv).dot(c.x.v.cwiseProduct(c.x.v));
    EXPECT_LE(std::abs(k.dot(pi) + rotors - c.w.d.kinetic[0]), tol * (k.cwiseAbs().dot(pi.cwiseAbs()) + rotors));
    EXPECT_LE(std::abs(p.dot(pi) - c.w.d.potential[0]), tol * p.cwiseAbs().dot(pi.cwiseAbs()));
  });
}

// Of a link's frame, merged or not: m (a - g) of its centre of mass and the rate of its spin.
V6 newton_euler(Case& c, Index frame) {
  const LinkRecord& link = c.m.links()[c.m.frames()[frame].link];
  double X[12];
  V6 V, A;
  frame_placement(c.m, c.w.d, frame, X);
  frame_velocity(c.m, c.w.d, frame, DYN_REFERENCE_LOCAL, V.data());
  frame_acceleration(c.m, c.w.d, frame, DYN_REFERENCE_LOCAL, true, A.data());
  const M3 R = eigen(X).topLeftCorner<3, 3>(), I = Eigen::Map<const M3>(link.inertia);
  const V3 com(link.com), w = V.tail<3>(), dw = A.tail<3>();
  const V3 force = link.mass * (A.head<3>() + dw.cross(com) + w.cross(w.cross(com)) - R.transpose() * c.tree.gravity);
  V6 out;
  out << force, I * dw + w.cross(I * w) + com.cross(force);
  return out;
}

TEST(Regressor, OfTheBodyOfAFrame) {
  for_trees([](Case& c) {
    forward_kinematics<2>(c.m, c.w.d);
    MatrixXd sums = MatrixXd::Zero(6, c.m.n.joints);
    VectorXd scale = VectorXd::Zero(c.m.n.joints);
    for (Index k = 0; k < c.m.n.frames; ++k) {
      const FrameRecord& f = c.m.frames()[k];
      if (f.type != DYN_FRAME_TYPE_BODY) continue;
      const LinkRecord& link = c.m.links()[f.link];
      MatrixXd Y(6, 10);
      frame_body_regressor(c.w.d, frame_pose(c.m, c.w.d, k), Y.data());
      VectorXd pi(10);
      store_parameters(Inertia<double>::at_com(link.mass, load3(link.com), load33(link.inertia)), pi.data());
      const V6 force = newton_euler(c, k);
      EXPECT_LE(gap(Y * pi, force), 4 * tol * (Y.cwiseAbs() * pi.cwiseAbs()).maxCoeff());
      // in the joint's frame
      const M4 X = eigen(f.placement);
      sums.col(f.joint) += motion_matrix(X.inverse()).transpose() * force;
      scale[f.joint] += largest(force) * (1 + largest(X));
    }
    for (Index j = 1; j < c.m.n.joints; ++j) {
      MatrixXd Y(6, 10);
      frame_body_regressor(c.w.d, joint_pose(c.m, c.w.d, j), Y.data());
      const VectorXd pi = parameters(c.m).segment(10 * (j - 1), 10);
      EXPECT_LE(gap(Y * pi, sums.col(j)), 10 * tol * (scale[j] + (Y.cwiseAbs() * pi.cwiseAbs()).maxCoeff()));
    }
  });
}

}  // namespace
}  // namespace dyn_test
