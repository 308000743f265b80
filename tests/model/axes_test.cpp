// Joints along the axes of their frame: nothing of the turn to the internal axis z shows, not in the last bit.
#include "common/random_tree.hpp"
#include "common/work.hpp"
#include "../src/model/builder_impl.hpp"

namespace dyn_test::axes_test {
namespace {

constexpr std::array<double, 9> unit_inertia = {1, 0, 0, 0, 1, 0, 0, 0, 1};
const Axis along[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

double off_rotation(const Mat3<double>& R) {
  const Mat3<double> E = transpose(R) * R - Mat3<double>::identity();
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) worst = std::max(worst, std::abs(E(i, j)));
  return worst;
}
bool zeros_and_ones(const Mat3<double>& R) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (R(i, j) != 0 && std::abs(R(i, j)) != 1) return false;
  return true;
}

TEST(Axes, TurnedToZExactly) {
  for (const Axis& a : along) {
    const Mat3<double> R = z_to(a);
    EXPECT_TRUE(zeros_and_ones(R)) << a[0] << " " << a[1] << " " << a[2];
    EXPECT_EQ(0, off_rotation(R));
    for (int i = 0; i < 3; ++i) EXPECT_EQ(a[std::size_t(i)], R(i, 2));
  }
}

// Any axis, near the poles too: a rotation whose last column is the axis, and the smallest (its trace is 1 + 2 cos of the angle).
TEST(Axes, TurnedToZ) {
  Random g{1};
  std::vector<Axis> all;
  for (int k = 0; k < 1000; ++k) all.push_back({g.normal(), g.normal(), g.normal()});
  for (double e : {1e-3, 1e-8, 1e-12, 1e-160, 1e-310})
    for (double z : {1.0, -1.0, 0.0}) all.push_back({e, -2 * e, z}), all.push_back({1, e, e * z}), all.push_back({0, e, z});
  for (Axis a : all) {
    const double n = std::hypot(a[0], a[1], a[2]);
    if (n < 1e-100) continue;
    for (double& x : a) x /= n;  // to rounding, as the builder does
    const Mat3<double> R = z_to(a);
    EXPECT_LT(off_rotation(R), 2e-15) << a[0] << " " << a[1] << " " << a[2];
    EXPECT_GT(dot(cross(R.x, R.y), R.z), 0.9);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[std::size_t(i)], R(i, 2), 1e-300);
    EXPECT_NEAR(1 + 2 * a[2], R(0, 0) + R(1, 1) + R(2, 2), 1e-15);
  }
}

// A chain of joints of all types along all axes, some placed by quarter turns: at the neutral configuration every placement is
// made of the given numbers alone, and every column of the Jacobian is an axis.
TEST(Axes, ChainWithoutNoise) {
  Placement quarter = identity_placement;  // about x
  quarter[4] = 0, quarter[5] = 1, quarter[7] = -1, quarter[8] = 0;
  Builder b("axes");
  std::string parent;
  int k = 0;
  for (const dynJointType type : moving_types())
    for (const Axis& a : along) {
      if (type == DYN_JOINT_TYPE_COMPOSITE) continue;  // has no axis
      JointSpec s;
      s.name = "j" + std::to_string(k), s.parent.name = parent, s.type = type;
      s.axis = a, s.axis2 = {a[1], a[2], a[0]};
      s.placement = k % 3 == 2 ? quarter : identity_placement;
      s.placement[9 + std::size_t(k % 3)] = 0.5;
      b.joint(s);
      b.body("l" + std::to_string(k++), {s.name, 0}, identity_placement, 1, {0.5, 0.25, 0.125}, unit_inertia);
      parent = s.name;
    }
  const ModelPtr m = b.finish();
  Work<double> work(*m, DYN_PART_JACOBIANS);
  Data<double>& d = work.d;
  joint_jacobians(*m, d);
  double expected[12], X[12];
  SE3<double> W = SE3<double>::identity();
  for (Index j = 1; j < m->n.joints; ++j) {
    W = W * load_se3(m->joints()[j].placement);
    store_se3(W, expected);
    Index f = 0;
    while (m->frames()[f].type != DYN_FRAME_TYPE_JOINT || m->frames()[f].joint != j) ++f;
    frame_placement(*m, d, f, X);
    for (int i = 0; i < 12; ++i) ASSERT_EQ(expected[i], X[i]) << m->string(m->joints()[j].name) << " " << i;
    EXPECT_TRUE(zeros_and_ones(load_se3(X).R));
  }
  for (Index c = 0; c < m->n.nv; ++c)
    for (int i = 3; i < 6; ++i) {
      const double w = d.J[i + 6 * c];
      EXPECT_TRUE(w == 0 || std::abs(w) == 1) << c << " " << i << " " << w;
    }
}

}  // namespace
}  // namespace dyn_test::axes_test
