// Derivatives of constraint rows by a displacement of B, against dual numbers.
#include <gtest/gtest.h>

#include <random>

#include "common/every.hpp"
#include "common/dual.hpp"
#include "constraint/list.hpp"

namespace dyn_test {

using D = Dual<double>;

// d(log3 R) = Jlog^T turn, for a rotation from the left.
dyn::Vec3<D> log3(const dyn::Mat3<D>& R) {
  auto part = [&](auto&& of) {
    auto column = [&](const dyn::Vec3<D>& c) { return dyn::Vec3<double>::make(of(c[0]), of(c[1]), of(c[2])); };
    return dyn::Mat3<double>{column(R.x), column(R.y), column(R.z)};
  };
  const dyn::Mat3<double> value = part([](const D& a) { return a.x; });
  const dyn::Vec3<double> w = dyn::log3(value);
  const dyn::Mat3<double> J = transpose(dyn::Jlog3(w));
  D x(w[0]), y(w[1]), z(w[2]);
  for (int k = 0; k < D::directions; ++k) {
    const dyn::Mat3<double> turn = times_transpose(part([&](const D& a) { return a.d[k]; }), value);
    const dyn::Vec3<double> by = J * dyn::Vec3<double>::make(turn(2, 1), turn(0, 2), turn(1, 0));
    x.d[k] = by[0], y.d[k] = by[1], z.d[k] = by[2];
  }
  return dyn::Vec3<D>::make(x, y, z);
}

}  // namespace dyn_test

namespace dyn {

using dyn_test::log3;

namespace {

using dyn_test::Dual;
using D = Dual<double>;
using V = Vec3<double>;

// Displacement of B relative to A: steps, turns, v, w are directions 0-2, 3-5, 6-8, 9-11.
Relative<D> displaced(const Relative<double>& X) {
  auto lift = [](const V& a, int first) {
    D x(a[0]), y(a[1]), z(a[2]);
    x.d[first] = y.d[first + 1] = z.d[first + 2] = 1;
    return Vec3<D>::make(x, y, z);
  };
  auto turned = [](const V& c) {
    D x(c[0]), y(c[1]), z(c[2]);
    for (int k = 0; k < 3; ++k) {
      const V by = cross(unit3<double>(k), c);
      x.d[3 + k] = by[0], y.d[3 + k] = by[1], z.d[3 + k] = by[2];
    }
    return Vec3<D>::make(x, y, z);
  };
  return {lift(X.r, 0), lift(X.v, 6), lift(X.w, 9), {turned(X.R.x), turned(X.R.y), turned(X.R.z)}};
}

template <class K>
void check(const Constraint& c, const Relative<double>& X) {
  std::vector<RowChange<double>> said;
  K::evaluate(c, X, [&](int, const V& f, const V& t, double, double, auto&&... change) {
    said.push_back(RowChange<double>::fixed(f, t, true));
    (change(said.back()), ...);
  });
  K::evaluate(c, displaced(X), [&](int i, const Vec3<D>& f, const Vec3<D>& t, const D& error, const D& extra, auto&&...) {
    const RowChange<double>& by = said[std::size_t(i)];
    SCOPED_TRACE(testing::Message() << "type " << c.type << ", joint " << c.joint_type << ", row " << i);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(error.d[k], by.error_step[k], 1e-13);
      EXPECT_NEAR(error.d[3 + k], by.error_turn[k], 1e-13);
      EXPECT_NEAR(extra.d[k], by.extra_step[k], 1e-12);
      EXPECT_NEAR(extra.d[3 + k], by.extra_turn[k], 1e-12);
      EXPECT_NEAR(extra.d[6 + k], by.extra_v[k], 1e-12);
      EXPECT_NEAR(extra.d[9 + k], by.extra_w[k], 1e-12);
      for (int x = 0; x < 3; ++x) {
        EXPECT_NEAR(f[x].d[k], by.f_step(x, k), 1e-13);
        EXPECT_NEAR(t[x].d[3 + k], by.t_turn(x, k), 1e-13);
        EXPECT_EQ(0, f[x].d[3 + k]);
        EXPECT_EQ(0, t[x].d[k]);
      }
    }
  });
}

TEST(ConstraintChanges, AreThoseOfDualNumbers) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 g{seed};
    std::normal_distribution<double> normal;
    auto random = [&] { return V::make(normal(g), normal(g), normal(g)); };
    auto unit = [](const V& a) { return a * (1 / std::sqrt(dot(a, a))); };
    Constraint c{};
    c.axis = unit(random()), c.n1 = unit(cross(c.axis, random())), c.n2 = cross(c.axis, c.n1), c.axis2 = unit(random());
    c.pitch = 0.3, c.length = 0.7;
    const Relative<double> X{random(), random(), random(), exp3(random() * 0.5)};
    for (int type = 0; type < 100; ++type)
      visit_frame_constraint(dynConstraintType(type), [&]<class K>() {
        c.type = K::type, c.joint_type = DYN_JOINT_TYPE_REVOLUTE;
        if (type != DYN_CONSTRAINT_TYPE_LOOP) return check<K>(c, X);
        for (const dynJointType joint : dyn_test::every<dynJointType>("dynJointType")) {
          c.joint_type = joint;
          if (constraint::Loop::rows(c)) check<K>(c, X);
        }
      });
  }
}

TEST(ConstraintChanges, BetweenJoints) {
  for (int type = 0; type < 100; ++type)
    visit_joint_constraint(dynConstraintType(type), [&]<class K>() {
      Constraint c{};
      c.type = K::type, c.lower = -1, c.upper = 1;
      const double p[] = {0.1, -0.4, 0.3, 0.2, -0.5};
      std::copy(p, p + 5, c.coefficients);
      for (double q1 : {-1.3, 0.2, 1.7}) {
        const JointRow<D> by = K::evaluate(c, D::variable(q1, 0), D::variable(0.6, 1));
        const JointRow<double> row = K::evaluate(c, q1, 0.6);
        EXPECT_EQ(by.error.d[0], row.slope);
        EXPECT_NEAR(by.error.d[1], row.g2, 1e-15);
        EXPECT_NEAR(by.g2.d[1], row.curvature, 1e-14);
        EXPECT_NEAR(by.curvature.d[1], row.third, 1e-14);
        for (const D& x : {by.g1, by.g2, by.curvature}) EXPECT_EQ(0, x.d[0]);
        EXPECT_EQ(0, by.g1.d[1]);
      }
    });
}

}  // namespace
}  // namespace dyn
