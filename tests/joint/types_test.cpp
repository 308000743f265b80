// Every joint type of the user against its definition written with Eigen: where it places its child, what its velocity means,
// and that the builder's turning of frames does not show.
#include "table/names.hpp"
#include "common/random_tree.hpp"
#include "common/work.hpp"

namespace dyn_test::types_test {
namespace {

constexpr double tol = 2e-14;  // two joints and three fixed placements: some fifty operations on numbers up to 4

M4 turn(const V3& axis, double angle) {
  M4 X = M4::Identity();
  X.topLeftCorner<3, 3>() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return X;
}
M4 move(const V3& p) {
  M4 X = M4::Identity();
  X.topRightCorner<3, 1>() = p;
  return X;
}
M4 orient(const double* q) {
  M4 X = M4::Identity();
  X.topLeftCorner<3, 3>() = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  return X;
}
V3 v3(const std::array<double, 3>& a) { return V3(a[0], a[1], a[2]); }

// Two directions that complete axis to a right-handed triad: z is turned to axis by the smallest angle.
std::pair<V3, V3> plane(const V3& axis) {
  const M3 R = Eigen::Quaterniond::FromTwoVectors(V3::UnitZ(), axis).toRotationMatrix();
  return {R.col(0), R.col(1)};
}

// Pose of the child in the joint's frame; q advances past what was read.
M4 motion_of(const JointSpec& s, const double*& q) {
  const V3 axis = v3(s.axis).normalized(), axis2 = v3(s.axis2);
  const double* x = q;
  q += joint_nq(s.type);
  switch (s.type) {
    case DYN_JOINT_TYPE_FIXED: return M4::Identity();
    case DYN_JOINT_TYPE_REVOLUTE:
    case DYN_JOINT_TYPE_CONTINUOUS: return turn(axis, x[0]);
    case DYN_JOINT_TYPE_PRISMATIC: return move(x[0] * axis);
    case DYN_JOINT_TYPE_HELICAL: return turn(axis, x[0]) * move(s.pitch * x[0] * axis);
    case DYN_JOINT_TYPE_CYLINDRICAL: return turn(axis, x[0]) * move(x[1] * axis);
    case DYN_JOINT_TYPE_UNIVERSAL: return turn(axis, x[0]) * turn(axis2, x[1]);
    case DYN_JOINT_TYPE_SPHERICAL: return orient(x);
    case DYN_JOINT_TYPE_SPHERICAL_ZYX: return turn(V3::UnitZ(), x[0]) * turn(V3::UnitY(), x[1]) * turn(V3::UnitX(), x[2]);
    case DYN_JOINT_TYPE_PLANAR: {
      const auto [e1, e2] = plane(axis);
      return move(x[0] * e1 + x[1] * e2) * turn(axis, x[2]);
    }
    case DYN_JOINT_TYPE_TRANSLATION: return move(V3(x[0], x[1], x[2]));
    case DYN_JOINT_TYPE_FREE_FLYER: return move(V3(x[0], x[1], x[2])) * orient(x + 3);
    case DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED: return turn(axis, std::atan2(x[1], x[0]));
    case DYN_JOINT_TYPE_COMPOSITE: {
      M4 X = M4::Identity();
      for (const JointSpec& p : s.parts) X = X * eigen(p.placement.data()) * motion_of(p, q);
      return X;
    }
  }
  return M4::Identity();
}

// The configuration that is reached from q by the velocity v in time t, by each type's meaning of v: rates of the coordinates,
// or body velocities where there is a quaternion.
void travel(const JointSpec& s, double t, double*& q, const double*& v) {
  double* x = q;
  const double* w = v;
  auto rotate = [&](double* y, const double* rate) {
    const V3 r = t * V3(rate[0], rate[1], rate[2]);
    const Eigen::Quaterniond now(y[3], y[0], y[1], y[2]),
        next = now * Eigen::Quaterniond(Eigen::AngleAxisd(r.norm(), r.normalized()));
    y[0] = next.x(), y[1] = next.y(), y[2] = next.z(), y[3] = next.w();
  };
  if (s.type == DYN_JOINT_TYPE_COMPOSITE) {
    for (const JointSpec& p : s.parts) travel(p, t, q, v);
    return;
  }
  q += joint_nq(s.type), v += joint_nv(s.type);
  if (s.type == DYN_JOINT_TYPE_SPHERICAL) return rotate(x, w);
  if (s.type == DYN_JOINT_TYPE_FREE_FLYER) {
    // to second order in t: the differences below are central, so that the even error cancels
    const M3 R = orient(x + 3).topLeftCorner<3, 3>();
    const V3 p = V3(x[0], x[1], x[2]) + t * R * V3(w[0], w[1], w[2]);
    for (int i = 0; i < 3; ++i) x[i] = p[i];
    return rotate(x + 3, w + 3);
  }
  if (s.type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED) {
    const double angle = std::atan2(x[1], x[0]) + t * w[0];
    x[0] = std::cos(angle), x[1] = std::sin(angle);
    return;
  }
  for (int k = 0; k < joint_nv(s.type); ++k) x[k] += t * w[k];
}

// A skew revolute joint, the joint under test, and a skew revolute joint on it, with bodies and frames everywhere.
struct Bench {
  JointSpec before, joint, after;
  ModelPtr model;
  M4 body_at, frame_at;
  Bench(Dice& dice, dynJointType type) {
    before = random_joint(dice, DYN_JOINT_TYPE_REVOLUTE), before.name = "before";
    joint = random_joint(dice, type), joint.name = "joint", joint.parent.name = "before";
    after = random_joint(dice, DYN_JOINT_TYPE_REVOLUTE), after.name = "after", after.parent.name = "joint";
    body_at = dice.pose(), frame_at = dice.pose();
    Builder b("bench");
    for (const JointSpec* s : {&before, &joint, &after}) {
      b.joint(*s);
      const BodySpec body = random_body(dice, s->name + "_body", s->name);
      b.body(body.name, {s->name, 0}, placement(body_at), body.mass, array3(body.com), array9(body.inertia));
    }
    b.frame("frame", {"joint", 0}, placement(frame_at), DYN_FRAME_TYPE_OP_FRAME);
    model = b.finish();
  }
  std::vector<M4> joints(const VectorXd& q) const {
    const double* x = q.data();
    std::vector<M4> out;
    M4 X = M4::Identity();
    for (const JointSpec* s : {&before, &joint, &after}) {
      X = X * eigen(s->placement.data()) * motion_of(*s, x);
      out.push_back(X);
    }
    EXPECT_EQ(q.data() + q.size(), x);
    return out;
  }
};

int frame_named(const Model& m, const std::string& name) {
  for (Index f = 0; f < m.n.frames; ++f)
    if (m.string(m.frames()[f].name) == name) return f;
  ADD_FAILURE() << "no frame " << name;
  return 0;
}
M4 frame_pose(Work<double>& w, const std::string& name) {
  double X[12];
  frame_placement(w.m, w.d, frame_named(w.m, name), X);
  return eigen(X);
}

class JointType : public testing::TestWithParam<dynJointType> {};

TEST_P(JointType, PlacesItsChildAsDefined) {
  Dice dice(std::uint64_t(GetParam()) + 100);
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    const Bench bench(dice, GetParam());
    Work<double> w(*bench.model);
    const VectorXd q = State(w.m, std::uint64_t(trial)).q * 1.3;  // quaternions and (cos, sin) pairs of norm 1.3
    forward_kinematics<0>(w.m, w.q(q).d);
    const auto X = bench.joints(q);
    EXPECT_LE(gap(frame_pose(w, "before"), X[0]), tol);
    EXPECT_LE(gap(frame_pose(w, "joint"), X[1]), tol);
    EXPECT_LE(gap(frame_pose(w, "joint_body"), X[1] * bench.body_at), tol);
    EXPECT_LE(gap(frame_pose(w, "frame"), X[1] * bench.frame_at), tol);
    EXPECT_LE(gap(frame_pose(w, "after"), X[2]), tol);
    if (HasFailure()) return;
  }
}

TEST_P(JointType, NeutralIsThePlacementGiven) {
  Dice dice(std::uint64_t(GetParam()) + 200);
  const Bench bench(dice, GetParam());
  Work<double> w(*bench.model);
  forward_kinematics<0>(w.m, w.d);
  M4 X = eigen(bench.before.placement.data()) * eigen(bench.joint.placement.data());
  for (const JointSpec& p : bench.joint.parts) {
    X = X * eigen(p.placement.data());
    for (const JointSpec& inner : p.parts) X = X * eigen(inner.placement.data());
  }
  EXPECT_LE(gap(frame_pose(w, "joint"), X), tol);
}

TEST_P(JointType, VelocityMeansWhatTheHeaderSays) {
  Dice dice(std::uint64_t(GetParam()) + 300);
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE(trial);
    const Bench bench(dice, GetParam());
    Work<double> w(*bench.model);
    const State x(w.m, std::uint64_t(trial));
    const VectorXd v = dice.vector(x.v.size());
    auto at = [&](double t) {
      VectorXd q = x.q;
      double* to = q.data();
      const double* rate = v.data();
      for (const JointSpec* s : {&bench.before, &bench.joint, &bench.after}) travel(*s, t, to, rate);
      EXPECT_EQ(v.data() + v.size(), rate);
      return bench.joints(q)[2];
    };
    const double h = 1e-5;
    const M4 dX = (at(h) - at(-h)) / (2 * h), X = at(0);
    forward_kinematics<1>(w.m, w.q(x.q).v(v).d);
    double got[6];
    frame_velocity(w.m, w.d, frame_named(w.m, "after"), DYN_REFERENCE_LOCAL_WORLD_ALIGNED, got);
    // differences in double: truncation h^2 |v|^3 and rounding 1e-16 / h
    EXPECT_LE(gap(V3(got[0], got[1], got[2]), dX.topRightCorner<3, 1>()), 2e-8);
    EXPECT_LE(gap(hat(V3(got[3], got[4], got[5])), dX.topLeftCorner<3, 3>() * X.topLeftCorner<3, 3>().transpose()), 2e-8);
    if (HasFailure()) return;
  }
}

TEST_P(JointType, IntegrateFollowsTheVelocity) {
  Dice dice(std::uint64_t(GetParam()) + 400);
  const Bench bench(dice, GetParam());
  const State x(*bench.model, 5);
  auto by_hand = [&](double t) {
    VectorXd q = x.q;
    double* to = q.data();
    const double* rate = x.v.data();
    for (const JointSpec* s : {&bench.before, &bench.joint, &bench.after}) travel(*s, t, to, rate);
    return q;
  };
  const double t = 1e-6;
  VectorXd step = t * x.v, q(x.q.size());
  integrate(*bench.model, x.q.data(), step.data(), q.data());
  EXPECT_LE(gap(q, by_hand(t)), 2 * t * t);  // by_hand is of first order in the free flyer's position
  VectorXd v(x.v.size());
  difference(*bench.model, x.q.data(), q.data(), v.data());
  EXPECT_LE(gap(v / t, x.v), 1e-9);  // rounding 1e-16 / t
}

TEST_P(JointType, SizesAndRecord) {
  Dice dice(std::uint64_t(GetParam()) + 500);
  const Bench bench(dice, GetParam());
  const Model& m = *bench.model;
  const JointRecord& r = m.joints()[2];
  EXPECT_EQ(GetParam(), r.type);
  EXPECT_EQ(spec_nq(bench.joint), r.nq);
  EXPECT_EQ(spec_nv(bench.joint), r.nv);
  EXPECT_EQ(1, r.idx_q);
  EXPECT_EQ(1, r.idx_v);
  EXPECT_EQ(1, r.parent);
  EXPECT_EQ(2 + r.nq, m.n.nq);
  EXPECT_EQ(2 + r.nv, m.n.nv);
  EXPECT_LE(gap(eigen(r.placement), eigen(bench.joint.placement.data())), 2e-15);  // made orthonormal
  EXPECT_EQ(bench.joint.axis, (std::array<double, 3>{r.axis[0], r.axis[1], r.axis[2]})) << "as given";
}

INSTANTIATE_TEST_SUITE_P(All, JointType, testing::ValuesIn(moving_types()),
                         [](const auto& p) { return std::string(name_of(p.param)); });

TEST(JointAxes, EveryDirectionMinusZIncluded) {
  Dice dice(7);
  std::vector<V3> axes = {V3(0, 0, 1),      V3(0, 0, -1),     V3(1, 0, 0),         V3(-1, 0, 0),
                          V3(0, 1, 0),      V3(0, -1, 0),     V3(0, 0, -5),        V3(1e-12, 0, -1),
                          V3(0, -1e-9, -1), V3(1e-300, 0, 0), V3(3e200, 4e200, 0), V3(1e-170, 0, 1)};
  for (int k = 0; k < 20; ++k) axes.push_back(dice.direction());
  for (const V3& axis : axes) {
    Builder b("axis");
    JointSpec s;
    s.name = "j", s.axis = array3(axis);
    b.joint(s);
    b.body("link", {"j", 0}, identity_placement, 1, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1});
    const ModelPtr m = b.finish();
    Work<double> w(*m);
    for (double angle : {0.0, 0.7, -2.5, pi}) {
      forward_kinematics<0>(*m, w.q(VectorXd::Constant(1, angle)).d);
      EXPECT_LE(gap(frame_pose(w, "j"), turn(V3(axis / axis.cwiseAbs().maxCoeff()), angle)), 2e-15)
          << axis.transpose() << " by " << angle;
    }
  }
}

TEST(JointAxes, PlanarMovesInThePlaneNormalToItsAxis) {
  Dice dice(8);
  for (int trial = 0; trial < 50; ++trial) {
    const V3 axis = trial == 0 ? V3(V3::UnitZ()) : trial == 1 ? V3(-V3::UnitZ()) : dice.direction();
    Builder b("planar");
    JointSpec s;
    s.name = "j", s.type = DYN_JOINT_TYPE_PLANAR, s.axis = array3(axis);
    b.joint(s);
    b.body("link", {"j", 0}, identity_placement, 1, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1});
    const ModelPtr m = b.finish();
    Work<double> w(*m);
    auto at = [&](double x, double y, double angle) {
      forward_kinematics<0>(*m, w.q(V3(x, y, angle)).d);
      return frame_pose(w, "j");
    };
    const V3 ex = at(1, 0, 0).topRightCorner<3, 1>(), ey = at(0, 1, 0).topRightCorner<3, 1>();
    EXPECT_LE(std::abs(ex.norm() - 1) + std::abs(ey.norm() - 1) + std::abs(ex.dot(ey)) + std::abs(ex.dot(axis)), 4e-15);
    EXPECT_LE(gap(ex.cross(ey), axis), 2e-15);
    EXPECT_LE(gap(at(0.3, -2, 1.1), move(0.3 * ex - 2 * ey) * turn(axis, 1.1)), 4e-15);
    if (trial == 0) {
      EXPECT_LE(gap(ex, V3::UnitX()) + gap(ey, V3::UnitY()), 1e-15);
    }
  }
}

}  // namespace
}  // namespace dyn_test::types_test
