// Centre of mass, its derivatives and Jacobian, of everything and of subtrees, against sums over the links.
#include "algorithm/center_of_mass.hpp"

#include "algorithm/trees.hpp"

namespace dyn_test {
namespace {

// Mass and centre of the links that joints of the set carry, from each link's own frame.
template <class Carried>
std::pair<double, V3> sum_of_links(Case& c, Carried&& carried) {
  double mass = 0;
  V3 moment = V3::Zero();
  for (Index f = 0; f < c.m.n.frames; ++f) {
    const FrameRecord& frame = c.m.frames()[f];
    if (frame.type != DYN_FRAME_TYPE_BODY || frame.joint == 0 || !carried(frame.joint)) continue;
    double X[12];
    frame_placement(c.m, c.w.d, f, X);
    const LinkRecord& link = c.m.links()[frame.link];
    mass += link.mass;
    moment += link.mass * (eigen(X) * V3(link.com).homogeneous()).head<3>();
  }
  return {mass, mass > 0 ? V3(moment / mass) : V3(V3::Zero())};
}
bool carries(const Model& m, Index root, Index joint) {
  while (joint > root) joint = m.joints()[joint].parent;
  return joint == root;
}
template <class T>
Vec3<T> subtree(const Model& m, const Data<T>& d, Index joint) {
  const Index body = m.joints()[joint].first_body;
  return d.p[body] + d.hsub[body] * (T(1) / d.msub[body]);
}

TEST(CenterOfMass, IsTheSumOverTheLinks) {
  for_trees([](Case& c) {
    center_of_mass(c.m, c.w.d, 2);
    const auto [mass, com] = sum_of_links(c, [](Index) { return true; });
    EXPECT_LE(gap(V3(c.w.d.com), com), tol * (1 + largest(com)));
    EXPECT_LE(std::abs(mass - c.m.total_mass), 1e-14 * mass);
    EXPECT_LE(std::abs(mass - c.w.d.msub[0]), 1e-14 * mass);
    for (Index j = 1; j < c.m.n.joints; ++j) {
      const auto [part, center] = sum_of_links(c, [&](Index k) { return carries(c.m, j, k); });
      EXPECT_LE(std::abs(part - c.w.d.msub[c.m.joints()[j].first_body]), 1e-14 * part);
      EXPECT_LE(gap(eigen(subtree(c.m, c.w.d, j)), center), tol * (1 + largest(center)));
    }
  });
}

TEST(CenterOfMass, VelocityAndAccelerationAreItsRates) {
  for_trees([](Case& c) {
    Work<Quad> q(c.m, DYN_PART_COM);
    auto com = [&](Quad t) {
      center_of_mass(c.m, q.q(on_path(c.m, c.x.q, c.x.v, c.x.a, t)).d, 0);
      return Quads(q.d.com, q.d.com + 3);
    };
    center_of_mass(c.m, c.w.d, 2);
    const V3 v(c.w.d.vcom), a(c.w.d.acom);
    forward_kinematics<2>(c.m, c.w.d);
    double speed = 1;  // of the fastest body
    for (Index i = 1; i < c.m.n.bodies; ++i)
      speed = std::max({speed, largest(eigen(c.w.d.vel[i])), largest(eigen(c.w.d.omega[i]))});
    EXPECT_LE(gap(v, rate(com, 3)), tol * speed);
    EXPECT_LE(gap(a, second_rate(com, 3)), 10 * tol * speed * speed);
  });
}

TEST(CenterOfMass, JacobianTimesVelocity) {
  for_trees([](Case& c) {
    center_of_mass(c.m, c.w.d, 1);
    MatrixXd J = MatrixXd::Constant(3, c.nv, 777);
    center_of_mass_jacobian(c.m, c.w.d, 0, J.data());
    EXPECT_LE(gap(J * c.x.v, V3(c.w.d.vcom)), tol * (1 + largest(J)));
    // m Jcom is the linear block of the momentum: its rows are the force that a unit acceleration takes
    const MatrixXd M = c.M();
    const VectorXd g = c.gravity();
    EXPECT_LE(gap(-c.m.total_mass * J.transpose() * c.tree.gravity, g), tol * (1 + c.m.total_mass * 10 * largest(J)));
  });
}

TEST(CenterOfMass, JacobiansOfSubtrees) {
  for_trees([](Case& c) {
    center_of_mass(c.m, c.w.d, 0);
    Work<Quad> q(c.m, DYN_PART_COM);
    const VectorXd none = VectorXd::Zero(c.nv);
    MatrixXd J(3, c.nv);
    for (Index j = 1; j < c.m.n.joints; j += 1 + c.m.n.joints / 3) {
      J.setConstant(777);
      center_of_mass_jacobian(c.m, c.w.d, c.m.joints()[j].first_body, J.data());
      const MatrixXd v = rate(
          [&](Quad t) {
            center_of_mass(c.m, q.q(on_path(c.m, c.x.q, c.x.v, none, t)).d, 0);
            const Vec3<Quad> x = subtree(c.m, q.d, j);
            return Quads{x[0], x[1], x[2]};
          },
          3);
      EXPECT_LE(gap(J * c.x.v, v), tol * (1 + largest(J)));
    }
  });
}

}  // namespace
}  // namespace dyn_test
