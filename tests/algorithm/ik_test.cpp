// Inverse kinematics: exactness of the tasks' Jacobians, the step in a box, and reachable targets on robots of all joint types.
#include "algorithm/ik.hpp"

#include "algorithm/trees.hpp"

namespace dyn_test {
namespace {

dynIkTask task(dynIkTaskType type, Index frame = 0) {
  dynIkTask t{};
  t.struct_size = sizeof t, t.type = type, t.frame = frame, t.weight = 1;
  return t;
}
void aim(dynIkTask& t, const M4& X) {
  const Placement p = placement(X);
  std::copy(p.begin(), p.end(), t.target);
}
dynIkOptions some_options() {
  dynIkOptions o{};
  o.struct_size = sizeof o, o.max_iterations = 100, o.restarts = 20, o.tolerance_linear = o.tolerance_angular = 1e-8,
  o.limits = 1;
  return o;
}

// The error of a task at q moved along a step, in quadruple precision.
Quads errors(Work<Quad>& w, const dynIkTask& t, const VectorXd& q, const VectorXd& direction, Quad h) {
  const Model& m = w.m;
  Quads from, step, moved(std::size_t(m.n.nq)), out;
  for (double x : q) from.emplace_back(x);
  for (double x : direction) step.emplace_back(h * Quad(x));
  ik_retract(m, from.data(), step.data(), moved.data());
  w.q(moved);
  center_of_mass(m, w.d, 0);
  if (t.type == DYN_IK_TASK_TYPE_POSTURE) {
    for_posture(m, w.d.q, t, [&]<class J>(const Body&, const Quad*, const Quad* e) { out.insert(out.end(), e, e + J::nv); });
    return out;
  }
  const IkError<Quad> x = ik_error(m, w.d, t);
  for (int k = rows_of(t.type).begin; k < rows_of(t.type).end; ++k) out.push_back(k < 3 ? x.e.linear[k] : x.e.angular[k - 3]);
  return out;
}

// With one component weighted, g = J^T r and J^T J are e e' and e' e'^T of that component: e' along a random step, by
// differences.
TEST(InverseKinematics, JacobiansAreTheDerivativesOfTheErrors) {
  TreeOptions small;
  small.joints = 12;
  for_trees([](Case& c) {
    Dice dice(c.x.q.size() ? std::uint64_t(1e6 + 1e5 * c.x.q[0]) : 1);
    Work<Quad> w(c.m);
    const State other(c.m, 99);
    for (dynIkTaskType type : {DYN_IK_TASK_TYPE_POSE, DYN_IK_TASK_TYPE_POSITION, DYN_IK_TASK_TYPE_ORIENTATION,
                               DYN_IK_TASK_TYPE_COM, DYN_IK_TASK_TYPE_POSTURE}) {
      dynIkTask t = task(type, dice.below(c.m.n.frames));
      aim(t, dice.pose(0.5));
      t.posture = other.q.data();
      const VectorXd direction = dice.vector(c.nv);
      const VectorXd rates = rate([&](Quad h) { return errors(w, t, c.x.q, direction, h); }, row_count(c.m, type));
      const VectorXd values = scaled_difference(errors(w, t, c.x.q, direction, Quad(0)),
                                                Quads(std::size_t(rates.size()), Quad(0)), Quad(1), rates.size());
      center_of_mass(c.m, c.w.d, 0);
      for (Index k = 0; k < row_count(c.m, type); ++k) {
        VectorXd weights = VectorXd::Zero(row_count(c.m, type)), r(c.nv), g(c.nv);
        MatrixXd A(c.nv, c.nv), factor(c.nv, c.nv);
        weights[k] = t.weight = 2;
        t.weights = weights.data();
        LeastSquares<double> s{c.nv, c.nv, A.data(), factor.data(), r.data(), g.data(), 0};
        s.clear();
        ik_linearise(c.m, c.w.d, t, 0.25, s);  // 2 x 2 x 0.25 is one
        s.finish();
        const double size = 1 + largest(rates) + std::abs(values[k]);
        EXPECT_NEAR(g.dot(direction), values[k] * rates[k], 1e-11 * size * size) << type << " " << k;
        EXPECT_NEAR(direction.dot(A * direction), rates[k] * rates[k], 1e-11 * size * size) << type << " " << k;
      }
    }
  }, 60, small);
}

// Of products of random matrices, wide and tall: J itself and its normal equations.
TEST(LeastSquares, RankOfAProduct) {
  Dice dice(11);
  for (Index n = 1; n <= 7; ++n)
    for (Index rows = 1; rows <= 7; ++rows)
      for (Index inner = 1; inner <= std::min(n, rows); ++inner) {
        const auto random = [&](Index a, Index b) { return MatrixXd(dice.vector(a * b).reshaped(a, b)); };
        const MatrixXd J = random(rows, inner) * random(inner, n);
        const VectorXd e = dice.vector(rows);
        std::vector<Index> list;
        for (Index k = 0; k < n; ++k) list.push_back(k);
        VectorXd matrix(49), factor(49), r(7), g(7);
        LeastSquares<double> s{n, rows, matrix.data(), factor.data(), r.data(), g.data(), 0};
        s.clear();
        s.add(rows, e.data(), J.data(), list.data(), n);
        s.finish();
        EXPECT_EQ(inner, rank(s)) << rows << " x " << n;
      }
}

// Against the optimality conditions, which are sufficient for a strictly convex program; J itself and J^T J alike.
TEST(BoxStep, SolvesTheProgram) {
  Dice dice(7);
  for (int round = 0; round < 3000; ++round) {
    const Index n = 1 + dice.below(12), rows = 1 + dice.below(14);
    const MatrixXd J = dice.chance(0.3) ? MatrixXd(dice.vector(rows) * dice.vector(n).transpose())
                                        : MatrixXd(dice.vector(Index(rows * n)).reshaped(rows, n));
    const VectorXd e = dice.vector(rows);
    std::vector<Index> list, state(2 * std::size_t(n));
    for (Index k = 0; k < n; ++k) list.push_back(k);
    const Index room = std::max(n, rows);
    VectorXd matrix(room * room), factor(room * room), r(room), g(n), d(n), z(n), work(room), lower(n), upper(n);
    for (Index k = 0; k < n; ++k) {
      lower[k] = dice.chance(0.3) ? 0 : dice.chance(0.3) ? -infinity : -dice.in(0, 0.5);
      upper[k] = dice.chance(0.2) ? 0 : dice.chance(0.3) ? infinity : dice.in(0, 0.5);
    }
    LeastSquares<double> s{n, rows, matrix.data(), factor.data(), r.data(), g.data(), 0};
    s.clear();
    s.add(rows, e.data(), J.data(), list.data(), n);
    s.finish();
    const double lambda = dice.chance(0.5) ? 1e-6 : 0.1;
    const double decrease = BoxStep<double>{s, lower.data(), upper.data(), d.data(), z.data(), work.data(), state.data()}(lambda);
    // the solution of the damped equations is exact to their condition
    const double rounding = 1e-15 * (1 + J.squaredNorm() / lambda);
    EXPECT_NEAR(decrease, 0.5 * (e.squaredNorm() - (e + J * d).squaredNorm()), rounding);
    EXPECT_GE(decrease, -rounding);
    const VectorXd gradient = J.transpose() * (e + J * d) + lambda * d;
    const double small = 1e-9 * (1 + J.norm());
    for (Index k = 0; k < n; ++k) {
      ASSERT_TRUE(lower[k] <= d[k] && d[k] <= upper[k]);
      EXPECT_TRUE(d[k] == lower[k] || gradient[k] <= small) << round;
      EXPECT_TRUE(d[k] == upper[k] || gradient[k] >= -small) << round;
    }
  }
}

// Targets from random configurations within the limits, from other random configurations.
TEST(InverseKinematics, ReachesWhatCanBeReached) {
  TreeOptions small;
  small.joints = 9;
  int reached = 0, all = 0;
  for_trees([&](Case& c) {
    Dice dice(std::uint64_t(c.nv) * 31 + 7);
    dynIkTask tasks[3];
    ensure_position(c.m, c.w.d);
    for (int k = 0; k < 3; ++k) {
      tasks[k] = task(k == 0   ? DYN_IK_TASK_TYPE_POSE
                      : k == 1 ? DYN_IK_TASK_TYPE_POSITION
                               : DYN_IK_TASK_TYPE_ORIENTATION,
                      dice.below(c.m.n.frames));
      frame_placement(c.m, c.w.d, tasks[k].frame, tasks[k].target);
    }
    const State start(c.m, 1234);
    c.w.q(start.q);
    const IkTasks list{tasks, 3};
    dynIkResult result{};
    ASSERT_TRUE(inverse_kinematics(c.m, c.w.d, list, some_options(), result));
    const VectorXd q = matrix(c.w.d.q, c.m.n.nq);
    ++all, reached += result.reason == DYN_IK_REASON_CONVERGED;
    EXPECT_EQ(0, zero_norm_joint(c.m, q.data()));
    for (Index j = 1; j < c.m.n.joints; ++j)
      for (Index k = c.m.joints()[j].idx_q; k < c.m.joints()[j].idx_q + c.m.joints()[j].nq; ++k)
        EXPECT_TRUE(c.m.joints()[j].nq != c.m.joints()[j].nv || (c.m.lower_limit()[k] <= q[k] && q[k] <= c.m.upper_limit()[k]))
            << k;
    if (result.reason != DYN_IK_REASON_CONVERGED) return;
    c.w.d.changed(input_q);
    ensure_position(c.m, c.w.d);
    for (const dynIkTask& t : tasks) {
      Placement x;
      frame_placement(c.m, c.w.d, t.frame, x.data());
      const SE3<double> target = load_se3(t.target), X = load_se3(x.data());
      const double angle = eigen(log3(target.inverse().R * X.R)).norm(), distance = (eigen(X.p) - eigen(target.p)).norm();
      EXPECT_LE(t.type == DYN_IK_TASK_TYPE_ORIENTATION ? 0 : distance, 1.0001e-8);
      EXPECT_LE(t.type == DYN_IK_TASK_TYPE_POSITION ? 0 : angle, 1.0001e-8);
    }
  }, tree_count, small);
  EXPECT_GE(reached, all * 99 / 100);
}

}  // namespace
}  // namespace dyn_test
