// The contract of every constraint in the list. Rows are the first and second derivatives of the errors along allowed motions.
// The number of rows agrees with `rows`.
#include <gtest/gtest.h>

#include <random>

#include "common/every.hpp"
#include "common/eigen.hpp"
#include "constraint/list.hpp"

namespace dyn {
namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6>;

struct Found {
  Eigen::VectorXd error, extra;
  Rows J;
};
Vec3<double> vec(const Eigen::Vector3d& a) { return Vec3<double>::make(a[0], a[1], a[2]); }

template <class K>
Found evaluate(const Constraint& c, const Relative<double>& X) {
  const int n = K::rows(c);
  Found out{Eigen::VectorXd(n), Eigen::VectorXd(n), Rows(n, 6)};
  int count = 0;
  K::evaluate(c, X, [&](int i, const Vec3<double>& f, const Vec3<double>& t, double error, double extra, auto&&...) {
    EXPECT_EQ(count++, i);
    out.error[i] = error, out.extra[i] = extra;
    for (int k = 0; k < 3; ++k) out.J(i, k) = f[k], out.J(i, 3 + k) = t[k];
  });
  EXPECT_EQ(n, count);
  return out;
}

// A state where the constraint holds: the frames coincide, or the measured length is right.
template <class K>
void check(Constraint c, int seed) {
  std::mt19937 g{static_cast<unsigned>(seed)};
  std::normal_distribution<double> normal;
  auto random = [&] { return Eigen::Vector3d(normal(g), normal(g), normal(g)); };
  const Eigen::Vector3d a = random().normalized(), n1 = a.cross(random()).normalized(), n2 = a.cross(n1);
  c.axis = vec(a), c.n1 = vec(n1), c.n2 = vec(n2), c.axis2 = vec((n1 + 0.3 * a).normalized());
  c.pitch = 0.3, c.length = 0.7;
  const auto at = [](const Eigen::Vector3d& r) {
    return Relative<double>{vec(r), Vec3<double>::zero(), Vec3<double>::zero(), Mat3<double>::identity()};
  };
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  if (evaluate<K>(c, at(start)).error.norm() > 0) {
    start = random();  // then Newton's steps to the nearest solution
    for (int k = 0; k < 20; ++k) {
      const Found f = evaluate<K>(c, at(start));
      start -= f.J.leftCols(3).completeOrthogonalDecomposition().solve(f.error);
    }
  }
  const Found here = evaluate<K>(c, at(start));
  EXPECT_LE(here.error.cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(here.J * here.J.transpose(), Eigen::EigenvaluesOnly).eigenvalues()[0],
            1e-6)
      << "rows are independent";

  // an allowed velocity, any acceleration
  Eigen::Matrix<double, 6, 1> velocity, acceleration;
  for (int k = 0; k < 6; ++k) velocity[k] = normal(g), acceleration[k] = normal(g);
  velocity -= here.J.transpose() * (here.J * here.J.transpose()).ldlt().solve(here.J * velocity);
  const Eigen::Vector3d v = velocity.head<3>(), w = velocity.tail<3>(), dv = acceleration.head<3>(), dw = acceleration.tail<3>();
  auto error = [&](double t) {
    const Relative<double> X{vec(start + v * t + 0.5 * dv * t * t), Vec3<double>::zero(), Vec3<double>::zero(),
                             exp3(vec(w * t + 0.5 * dw * t * t))};
    return evaluate<K>(c, X).error;
  };
  const double h = 1e-3;
  const Eigen::VectorXd first = (8 * (error(h) - error(-h)) - (error(2 * h) - error(-2 * h))) / (12 * h);
  const Eigen::VectorXd second = (16 * (error(h) + error(-h)) - (error(2 * h) + error(-2 * h)) - 30 * error(0)) / (12 * h * h);
  const Found moving = evaluate<K>(c, {vec(start), vec(v), vec(w), Mat3<double>::identity()});
  EXPECT_LE(first.cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LE((second - here.J * acceleration - moving.extra).cwiseAbs().maxCoeff(), 1e-6);
  // also the rates at any velocity
  for (int k = 0; k < 6; ++k) velocity[k] = normal(g);
  auto along = [&](double t) {
    return evaluate<K>(c, {vec(start + velocity.head<3>() * t), Vec3<double>::zero(), Vec3<double>::zero(),
                           exp3(vec(velocity.tail<3>() * t))})
        .error;
  };
  EXPECT_LE(((8 * (along(h) - along(-h)) - (along(2 * h) - along(-2 * h))) / (12 * h) - here.J * velocity).cwiseAbs().maxCoeff(),
            1e-9);
}

constexpr int beyond = 100;  // any type
#define DYN_ONE_MORE(K) +1

TEST(ConstraintContract, BetweenFrames) {
  int types = 0;
  for (int type = 0; type < beyond; ++type)
    visit_frame_constraint(dynConstraintType(type), [&]<class K>() {
      ++types;
      EXPECT_EQ(type, K::type);
      EXPECT_FALSE(between_joints(K::type)) << type;
      for (int seed = 0; seed < 20; ++seed) {
        Constraint c{};
        c.type = K::type, c.joint_type = DYN_JOINT_TYPE_REVOLUTE;
        if (type != DYN_CONSTRAINT_TYPE_LOOP) {
          check<K>(c, seed);
          continue;
        }
        int closing = 0;
        for (const dynJointType joint : dyn_test::every<dynJointType>("dynJointType")) {
          c.joint_type = joint;
          if (constraint::Loop::rows(c)) ++closing, check<K>(c, seed);
        }
        EXPECT_EQ(11, closing);
      }
    });
  EXPECT_EQ(0 DYN_FRAME_CONSTRAINTS(DYN_ONE_MORE), types);
}

// A screw moves by its pitch for each radian, over turns without end, and what it is off is measured to the nearest turn.
TEST(ConstraintContract, ScrewsGoOnOverManyTurns) {
  Constraint c{};
  c.type = DYN_CONSTRAINT_TYPE_LOOP, c.joint_type = DYN_JOINT_TYPE_HELICAL, c.pitch = 0.3;
  c.axis = vec({0, 0, 1}), c.n1 = vec({1, 0, 0}), c.n2 = vec({0, 1, 0});
  for (int turns = -3; turns <= 3; ++turns)
    for (const double off : {-0.4, 0.0, 0.2}) {  // m, within half a turn: 0.94
      const double angle = 0.7 + 6.283185307179586 * turns;
      const Relative<double> X{vec({0, 0, 0.3 * angle + off}), Vec3<double>::zero(), Vec3<double>::zero(),
                               exp3(vec({0, 0, angle}))};
      EXPECT_NEAR(off, evaluate<constraint::Loop>(c, X).error[2], 1e-14) << turns;
    }
}

TEST(ConstraintContract, BetweenJoints) {
  int types = 0;
  for (int type = 0; type < beyond; ++type)
    visit_joint_constraint(dynConstraintType(type), [&]<class K>() {
      ++types;
      EXPECT_TRUE(between_joints(K::type)) << type;
      Constraint c{};
      c.type = K::type;
      c.lower = -1, c.upper = 1;
      const double p[] = {0.1, -0.4, 0.3, 0.2, -0.5};
      std::copy(p, p + 5, c.coefficients);
      const double q1 = 1.3, q2 = 0.6, h = 1e-3;
      auto error = [&](double a, double b) { return K::evaluate(c, a, b).error; };
      const JointRow<double> row = K::evaluate(c, q1, q2);
      if (type != DYN_CONSTRAINT_TYPE_FRICTION) {
        EXPECT_NEAR((error(q1 + h, q2) - error(q1 - h, q2)) / (2 * h), row.g1, 1e-9);
      }
      EXPECT_NEAR((8 * (error(q1, q2 + h) - error(q1, q2 - h)) - (error(q1, q2 + 2 * h) - error(q1, q2 - 2 * h))) / (12 * h),
                  row.g2, 1e-9);
      EXPECT_NEAR((error(q1, q2 + h) + error(q1, q2 - h) - 2 * error(q1, q2)) / (h * h), row.curvature, 1e-5);
      EXPECT_EQ(1, K::rows(c));
    });
  EXPECT_EQ(0 DYN_JOINT_CONSTRAINTS(DYN_ONE_MORE), types);
}

}  // namespace
}  // namespace dyn
