// The configuration space of whole models: integrate, difference, interpolate, distance, random, normalise, and their Jacobians.
#include "common/random_tree.hpp"
#include "common/work.hpp"

namespace dyn_test {
namespace {

constexpr double tol = 2e-14;  // a chain of one logarithm and one exponential for each joint, numbers up to 3

struct Pair {
  ModelPtr model;
  State a, b;
  explicit Pair(std::uint64_t seed) : model(random_tree(seed).build()), a(*model, seed), b(*model, seed + 1000) {}
  const Model& m() const { return *model; }
};
template <class F>
void for_pairs(F&& f) {
  for (std::uint64_t seed = 1; seed <= tree_count; ++seed) {
    SCOPED_TRACE(seed);
    Pair p(seed);
    f(p);
    if (testing::Test::HasFailure()) return;
  }
}
VectorXd plus(const Model& m, const VectorXd& q, const VectorXd& v) {
  VectorXd out(q.size());
  integrate(m, q.data(), v.data(), out.data());
  return out;
}
VectorXd minus(const Model& m, const VectorXd& q1, const VectorXd& q0) {
  VectorXd out(m.n.nv);
  difference(m, q0.data(), q1.data(), out.data());
  return out;
}

TEST(Configuration, IntegrateAndDifferenceAreInverse) {
  for_pairs([](Pair& p) {
    const VectorXd v = minus(p.m(), p.b.q, p.a.q);
    EXPECT_LE(largest(minus(p.m(), plus(p.m(), p.a.q, v), p.b.q)), tol);
    EXPECT_LE(gap(minus(p.m(), plus(p.m(), p.a.q, p.a.v), p.a.q), p.a.v), tol);
    EXPECT_LE(gap(minus(p.m(), p.a.q, p.b.q), -v), tol);
    EXPECT_LE(norm_error(p.m(), plus(p.m(), p.a.q * 1.4, v).data()), 4e-16) << "unit on output";
  });
}

TEST(Configuration, InterpolateAndDistance) {
  for_pairs([](Pair& p) {
    const VectorXd v = minus(p.m(), p.b.q, p.a.q);
    VectorXd out(p.a.q.size());
    for (double u : {0.0, 0.3, 1.0}) {
      interpolate(p.m(), p.a.q.data(), p.b.q.data(), u, out.data());
      EXPECT_LE(gap(minus(p.m(), out, p.a.q), u * v), tol);
    }
    EXPECT_LE(largest(minus(p.m(), out, p.b.q)), tol);
    EXPECT_LE(std::abs(distance(p.m(), p.a.q.data(), p.b.q.data()) - v.norm()), tol * v.norm());
    // in place of either end
    VectorXd first = p.a.q, second = p.b.q;
    interpolate(p.m(), first.data(), p.b.q.data(), 0.3, first.data());
    interpolate(p.m(), p.a.q.data(), second.data(), 0.3, second.data());
    EXPECT_EQ(0, gap(first, second));
  });
}

TEST(Configuration, JacobiansAgainstDifferences) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Pair p(seed);
    const Model& m = p.m();
    const Eigen::Index n = m.n.nv;
    MatrixXd dq(n, n), dv(n, n), d0(n, n), d1(n, n);
    for (MatrixXd* x : {&dq, &dv, &d0, &d1}) x->setConstant(7);  // fully written
    integrate_jacobians(m, p.a.q.data(), p.a.v.data(), dq.data(), dv.data());
    difference_jacobians(m, p.a.q.data(), p.b.q.data(), d0.data(), d1.data());
    // along two directions at once, in quadruple precision: e = log of what changed
    const VectorXd x = Dice(seed).vector(n), y = Dice(seed + 1).vector(n), none = VectorXd::Zero(n);
    auto q_of = [&](const VectorXd& q) { return Quads(q.begin(), q.end()); };
    auto apart = [&](const Quads& from, const Quads& to) {
      Quads v(std::size_t(n) + 1, Quad(0));
      difference(m, from.data(), to.data(), v.data());
      v.pop_back();
      return v;
    };
    auto reached = [&](Quad t) {
      const Quads start = on_path(m, p.a.q, x, none, t);
      Quads v = q_of(p.a.v), out(start.size());
      for (Eigen::Index k = 0; k < n; ++k) v[std::size_t(k)] += t * Quad(y[k]);
      integrate(m, start.data(), v.data(), out.data());
      return out;
    };
    const Quads target = reached(Quad(0));
    EXPECT_LE(gap(rate([&](Quad t) { return apart(target, reached(t)); }, n), dq * x + dv * y), 10 * tol);
    EXPECT_LE(gap(rate([&](Quad t) { return apart(on_path(m, p.a.q, x, none, t), on_path(m, p.b.q, y, none, t)); }, n),
                  d0 * x + d1 * y),
              30 * tol);
    if (HasFailure()) return;
  }
}

TEST(Configuration, RandomStaysWithinLimitsAndIsFiniteWithoutThem) {
  for_pairs([](Pair& p) {
    const Model& m = p.m();
    VectorXd q(m.n.nq), again(m.n.nq);
    random_configuration(m, 3, m.lower_limit(), m.upper_limit(), q.data());
    random_configuration(m, 3, m.lower_limit(), m.upper_limit(), again.data());
    EXPECT_EQ(0, gap(q, again));
    for (Index j = 1; j < m.n.joints; ++j) {
      const JointRecord& r = m.joints()[j];
      if (r.nq != r.nv) continue;  // quaternions and (cos, sin) pairs have no limits
      for (Index k = r.idx_q; k < r.idx_q + r.nq; ++k) {
        EXPECT_GE(q[k], m.lower_limit()[k]);
        EXPECT_LE(q[k], m.upper_limit()[k]);
      }
    }
    const VectorXd wide = VectorXd::Constant(m.n.nq, infinity), low = -wide;
    random_configuration(m, 4, low.data(), wide.data(), q.data());
    EXPECT_LT(largest(q), 3.2);
    EXPECT_LE(norm_error(m, q.data()), 4e-16);
  });
}

TEST(Configuration, NormaliseAndZeroNorm) {
  for_pairs([](Pair& p) {
    const Model& m = p.m();
    EXPECT_EQ(0, zero_norm_joint(m, p.a.q.data()));
    for (Index j = 1; j < m.n.joints; ++j) {
      const JointRecord& r = m.joints()[j];
      if (r.type != DYN_JOINT_TYPE_SPHERICAL && r.type != DYN_JOINT_TYPE_FREE_FLYER &&
          r.type != DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED)
        continue;
      const Index first = r.idx_q + (r.type == DYN_JOINT_TYPE_FREE_FLYER ? 3 : 0), count = r.idx_q + r.nq - first;
      VectorXd q = p.a.q;
      q.segment(first, count) *= 3;
      EXPECT_LE(std::abs(norm_error(m, q.data()) - 2), 1e-14);
      normalize(m, q.data());
      EXPECT_LE(gap(q, p.a.q), 4e-16);
      q.segment(first, count).setZero();
      EXPECT_EQ(j, zero_norm_joint(m, q.data()));
    }
  });
}

TEST(Configuration, ContinuousJointsGoTheShortWayRound) {
  Builder b("wheel");
  for (const char* name : {"wheel", "hinge"}) {
    JointSpec s;
    s.name = name, s.type = name == std::string("wheel") ? DYN_JOINT_TYPE_CONTINUOUS : DYN_JOINT_TYPE_REVOLUTE;
    b.joint(s);
    b.body(s.name + "_link", {name, 0}, identity_placement, 1, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1});
  }
  const ModelPtr m = b.finish();
  auto turns = [&](double from, double to) { return minus(*m, Eigen::Vector2d(to, to), Eigen::Vector2d(from, from)); };
  for (double from : {0.0, 1.0, -7.0, 1000.0})
    for (double by : {0.1, 3.0, -3.0, 3.2, -3.2, 6.5, 31.5, -100.0}) {
      const VectorXd v = turns(from, from + by);
      EXPECT_LE(std::abs(v[0] - std::remainder(by, 2 * pi)), 1e-12);  // 1000 holds 1e-13
      EXPECT_LE(std::abs(v[1] - by), 1e-12);
    }
  // half a turn is +pi, never -pi
  for (double by : {pi, -pi, 3 * pi, -3 * pi}) EXPECT_LE(std::abs(turns(0, by)[0] - pi), 1e-15) << by;
}

}  // namespace
}  // namespace dyn_test
