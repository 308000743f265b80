// Contact solvers: residuals of random and hard problems, closed forms, invariances.
#include "solver/scenes.hpp"

namespace dyn_test {
namespace {

// Checks the conditions from lambda and G, independently of the report, relative to speeds and impulses.
void expect_solved(Scene& s, const Answer& a, double tolerance, const std::string& what) {
  const int n = s.rows();
  Vector c(s.g);
  double speed = 0, impulse = 0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) c[i] += s.G[i + n * j] * a.lambda[j];
    speed = std::max(speed, std::fabs(s.g[j])), impulse = std::max(impulse, std::fabs(a.lambda[j]));
  }
  for (std::size_t k = 0; k < s.friction.size(); ++k) {
    const double mu = s.friction[k], *l = &a.lambda[3 * k], *v = &c[3 * k];
    const double lt = std::hypot(l[0], l[1]), vt = std::hypot(v[0], v[1]);
    EXPECT_LE(lt, mu * l[2] + 1e-14 * impulse) << what << " cone " << k;
    EXPECT_GE(v[2], -tolerance * speed) << what << " dual " << k;
    EXPECT_LE(std::fabs(l[2] * v[2]), 10 * tolerance * impulse * speed) << what << " signorini " << k;
    // maximum dissipation: l_t = -mu l_n v_t / |v_t|
    for (int i = 0; i < 2; ++i)
      EXPECT_NEAR(0, l[i] * vt + mu * l[2] * v[i], 20 * tolerance * impulse * speed) << what << " dissipation " << k;
  }
}

TEST(ContactSolver, RandomProblemsAreSolved) {
  for (const dynContactSolverType type : all_solvers)
    for (const int contacts : {1, 2, 5, 12, 30})
      for (const double mu : {0.0, 0.05, 0.5, 1.0})
        for (const int dof : {6, 2 * contacts + 6, 3 * contacts}) {
          Scene s = random_scene(contacts, dof, mu, 1000 * contacts + dof);
          const Answer a = solve(s, with(type, type == DYN_CONTACT_SOLVER_TYPE_PGS ? 100000 : 100));
          const std::string what = std::string(solver_names[type]) + " contacts " + std::to_string(contacts) + " mu " +
                                   std::to_string(mu) + " dof " + std::to_string(dof);
          EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, a.report.status)
              << what << " residual " << a.report.residual << " iterations " << a.report.iterations;
          EXPECT_LE(a.report.residual, 1e-10) << what;
          expect_solved(s, a, 1e-9, what);
        }
}

// Stacks with mass ratios to 1e6: the impulse under a body is g dt times the mass above, nothing moves.
TEST(ContactSolver, StacksOfUnequalMassesCarryTheirLoad) {
  const double dt = 1e-3;
  for (const dynContactSolverType type : {DYN_CONTACT_SOLVER_TYPE_ADMM, DYN_CONTACT_SOLVER_TYPE_NEWTON})
    for (const Vector& masses : std::vector<Vector>{
             {1, 1}, {1, 1e3}, {1, 1e6}, {1e-3, 1e3}, {1e3, 1e-3}, {1e6, 1}, {1, 10, 100, 1e3, 1e4, 1e5, 1e6}, Vector(10, 1.0)}) {
      const Bodies bodies = stack(masses);
      Scene s = bodies.scene(0.7, bodies.falling(dt));
      const Answer a = solve(s, with(type, 100));
      EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, a.report.status)
          << solver_names[type] << " " << masses.size() << " " << masses.back() << " residual " << a.report.residual;
      double above = 0, total = 0;
      for (const double m : masses) total += m;
      for (int b = int(masses.size()) - 1; b >= 0; --b) {
        double normal = 0;
        above += masses[b];
        for (int k = 0; k < 4; ++k) normal += a.lambda[12 * b + 3 * k + 2];
        EXPECT_NEAR(above * gravity * dt, normal, 1e-9 * total * gravity * dt) << b;
      }
      // round-off of G lambda, whose terms are as large as the load over the lightest mass
      const double terms = total * gravity * dt / *std::min_element(masses.begin(), masses.end());
      for (const double c : a.velocity) EXPECT_NEAR(0, c, 2e-10 * gravity * dt + 4 * 2.2e-16 * terms);
    }
}

// Duplicated contacts, four and six legs: sum and moments are determined, at rest, pushed and sliding.
TEST(ContactSolver, RedundantLegsShareTheLoad) {
  for (const dynContactSolverType type : all_solvers)
    for (const int legs : {4, 6})
      for (const int copies : {1, 2, 10})
        for (const double push : {0.0, 0.004, 0.05}) {
          const Bodies bodies = table(legs, copies, 0.2);
          Vector v = bodies.falling(1e-3);
          v[0] = push, v[1] = 0.3 * push;
          Scene s = bodies.scene(0.5, v);
          const Answer a = solve(s, with(type, type == DYN_CONTACT_SOLVER_TYPE_PGS ? 100000 : 100));
          const std::string what = std::string(solver_names[type]) + " legs " + std::to_string(legs) + " x " +
                                   std::to_string(copies) + " push " + std::to_string(push);
          EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, a.report.status) << what << " residual " << a.report.residual;
          expect_solved(s, a, 1e-9, what);
          if (push > 0) continue;
          double sum = 0;
          for (int c = 0; c < legs * copies; ++c) sum += a.lambda[3 * c + 2];
          EXPECT_NEAR(gravity * 1e-3, sum, 1e-9 * gravity * 1e-3) << what;
        }
}

// Painleve's paradox (mu > 4/3): at velocity level an impulse exists and is found in at most 100 iterations.
TEST(ContactSolver, PainleveRodHasASolution) {
  std::mt19937 generator(8);
  std::uniform_real_distribution<double> u(-1, 1);
  int paradoxical = 0;
  for (int k = 0; k < 1000; ++k) {
    const double mu = 1.7 + 0.3 * u(generator), theta = (63 + 6 * u(generator)) * pi / 180;
    Scene s = painleve(theta, mu, u(generator), -0.00981 + 0.01 * u(generator), u(generator));
    paradoxical += 1 + 3 * std::cos(theta) * std::cos(theta) - 3 * mu * std::sin(theta) * std::cos(theta) < 0;
    for (const dynContactSolverType type : all_solvers) {
      const Answer a = solve(s, with(type, 100));
      ASSERT_EQ(DYN_CONTACT_STATUS_CONVERGED, a.report.status)
          << solver_names[type] << " " << k << " residual " << a.report.residual;
      expect_solved(s, a, 1e-9, std::string(solver_names[type]) + " " + std::to_string(k));
    }
  }
  EXPECT_GT(paradoxical, 300);
}

// A block of four contacts slides the same way in 64 directions: v' = v - mu g dt, straight on.
TEST(ContactSolver, FrictionIsIsotropic) {
  const double mu = 0.4, dt = 1e-3;
  Bodies block = stack({1});
  for (auto& c : block.contacts) c.on_a[2] = 0;  // friction through the centre of mass: no tipping
  for (const dynContactSolverType type : all_solvers)
    for (int k = 0; k < 64; ++k) {
      const double angle = 2 * pi * k / 64, x = std::cos(angle), y = std::sin(angle);
      Vector v = block.falling(dt);
      double speed = 1, travelled = 0;
      while (speed > 0) {
        v[0] = speed * x, v[1] = speed * y;
        Scene s = block.scene(mu, v);
        const Answer a = solve(s, with(type, 10000, 1e-13));
        double l[2] = {0, 0};
        for (int c = 0; c < 4; ++c) l[0] += a.lambda[3 * c], l[1] += a.lambda[3 * c + 1];
        const double along = v[0] * x + v[1] * y + l[0] * x + l[1] * y, across = l[1] * x - l[0] * y;
        EXPECT_NEAR(0, across, 1e-12);
        speed = along < 1e-12 ? 0 : along, travelled += speed * dt;
        if (k % 16 != 0) break;  // one step for all, a few directions to the end
      }
      if (k % 16 != 0) {
        EXPECT_NEAR(1 - mu * gravity * dt, speed, 1e-12) << solver_names[type] << " " << k;
      } else {
        double expected = 0;
        for (double w = 1 - mu * gravity * dt; w > 0; w -= mu * gravity * dt) expected += w * dt;
        EXPECT_NEAR(expected, travelled, 1e-9) << solver_names[type] << " " << k;
      }
    }
}

// A point mass on a plane, closed forms: open, stick, slip, exactly at the cone's angle.
TEST(ContactSolver, PointMassMatchesClosedForms) {
  for (const dynContactSolverType type : all_solvers) {
    const auto point = [&](Vector g, double mu) {
      Scene s;
      s.G = {1, 0, 0, 0, 1, 0, 0, 0, 1}, s.g = std::move(g), s.friction = {mu};
      return solve(s, with(type));
    };
    const Answer apart = point({1, 2, 3}, 0.5), stuck = point({0.3, 0.4, -2}, 0.5), slides = point({3, 4, -2}, 0.5),
                 limit = point({0.6, 0.8, -2}, 0.5);
    EXPECT_EQ((Vector{0, 0, 0}), apart.lambda);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR((Vector{-0.3, -0.4, 2})[i], stuck.lambda[i], 1e-14);
      EXPECT_NEAR(0, stuck.velocity[i], 1e-14);
      EXPECT_NEAR((Vector{-0.6, -0.8, 2})[i], slides.lambda[i], 1e-10);
      EXPECT_NEAR((Vector{2.4, 3.2, 0})[i], slides.velocity[i], 1e-10);
      EXPECT_NEAR((Vector{-0.6, -0.8, 2})[i], limit.lambda[i], 1e-9);
      EXPECT_NEAR(0, limit.velocity[i], 1e-9);
    }
    EXPECT_EQ(0, apart.report.energy);
    EXPECT_NEAR(-0.5 * (0.09 + 0.16 + 4), stuck.report.energy, 1e-13);
  }
}

// Torsion and rolling: a ball spinning about the normal stops at the rate of its coefficient; without rolling friction it rolls
// on.
TEST(ContactSolver, TorsionAndRollingMatchClosedForms) {
  for (const dynContactSolverType type : all_solvers) {
    Scene s;
    const double G[6] = {1, 1, 1, 2, 2, 2};
    s.G.assign(36, 0);
    for (int i = 0; i < 6; ++i) s.G[7 * i] = G[i];
    s.g = {0, 0, -1, 0.5, 0, 3}, s.friction = {0.5}, s.torsion = {0.01}, s.rolling = {0}, s.rows_of = {6};
    Answer a = solve(s, with(type));
    EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, a.report.status);
    EXPECT_NEAR(-0.01, a.lambda[5], 1e-12);  // torsion times the normal impulse
    EXPECT_NEAR(3 - 0.02, a.velocity[5], 1e-11);
    EXPECT_EQ(0, a.lambda[3]);
    EXPECT_EQ(0.5, a.velocity[3]);
    // on the ellipsoid, sliding, spinning and rolling at once: lambda_i = -(coefficient^2) v_i s
    s.g = {0.3, 0, -1, 0.5, -0.2, 3}, s.rolling = {0.002};
    a = solve(s, with(type));
    const double c[6] = {0.5, 0.5, 0, 0.002, 0.002, 0.01};
    double ellipsoid = 0, ratio = 0;
    for (const int i : {0, 1, 3, 4, 5}) {
      ellipsoid += a.lambda[i] * a.lambda[i] / (c[i] * c[i]);
      if (s.g[i] == 0) continue;
      const double r = -a.lambda[i] / (c[i] * c[i] * a.velocity[i]);
      if (ratio == 0) ratio = r;
      EXPECT_NEAR(ratio, r, 1e-8 * ratio) << i;
    }
    EXPECT_NEAR(a.lambda[2] * a.lambda[2], ellipsoid, 1e-9);
    EXPECT_LE(a.report.dissipation, 1e-9);
  }
}

// Limits, dry friction and equalities beside contacts, by closed forms on one axis.
TEST(ContactSolver, BoxesAndEqualitiesMatchClosedForms) {
  for (const dynContactSolverType type : all_solvers) {
    Scene s;
    s.problem.equalities = 1, s.problem.boxes = 3;
    s.G.assign(16, 0);
    for (int i = 0; i < 4; ++i) s.G[5 * i] = 2;
    s.g = {1, -1, 3, 0.1}, s.lower = {0, -0.5, -0.5}, s.upper = {HUGE_VAL, 0.5, 0.5};
    Answer a = solve(s, with(type));
    EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, a.report.status);
    const Vector lambda{-0.5, 0.5, -0.5, -0.05}, velocity{0, 0, 2, 0};
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(lambda[i], a.lambda[i], 1e-10);
      EXPECT_NEAR(velocity[i], a.velocity[i], 1e-10);
    }
  }
}

TEST(ContactSolver, ProblemsAtRestNeedNoImpulse) {
  for (const dynContactSolverType type : all_solvers) {
    Scene none;
    EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, solve(none, with(type)).report.status);
    Scene still;
    still.G = {1, 0, 0, 0, 1, 0, 0, 0, 1}, still.g = {0, 0, 0}, still.friction = {1};
    dynContactOptions warm = with(type);
    warm.warm_start = 1;
    for (const Answer& a : {solve(still, with(type)), solve(still, warm, {1, 2, 3})}) {
      EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, a.report.status);
      EXPECT_EQ((Vector{0, 0, 0}), a.lambda);
      EXPECT_EQ(0, a.report.residual);
    }
  }
}

// Rows that nothing moves (planar mechanisms) and problems without a solution: no NaN, and a residual that shows it.
TEST(ContactSolver, ImmovableRowsAreReported) {
  for (const dynContactSolverType type : all_solvers) {
    Scene planar;
    planar.G = {1, 0, 0, 0, 0, 0, 0, 0, 1}, planar.g = {0.1, 0, -1}, planar.friction = {0.5};
    const Answer a = solve(planar, with(type));
    EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, a.report.status);
    EXPECT_NEAR(-0.1, a.lambda[0], 1e-12);
    EXPECT_NEAR(0, a.lambda[1], 1e-12);
    EXPECT_NEAR(1, a.lambda[2], 1e-12);
    Scene belt = planar;  // surface velocity in the immovable direction
    belt.g = {0, 0.3, -1};
    const Answer b = solve(belt, with(type));
    EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, b.report.status) << solver_names[type];
    EXPECT_NEAR(-0.5, b.lambda[1], 1e-9);
    Scene impossible = planar;
    impossible.G[8] = 0;
    const Answer c = solve(impossible, with(type, 200));
    EXPECT_NE(DYN_CONTACT_STATUS_CONVERGED, c.report.status);
    EXPECT_GE(c.report.residual, 0.5);
    for (const double l : c.lambda) EXPECT_TRUE(std::isfinite(l));
    // two contradicting equalities
    Scene torn;
    torn.problem.equalities = 2, torn.G = {1, 1, 1, 1}, torn.g = {1, -1};
    const Answer d = solve(torn, with(type, 200));
    EXPECT_NE(DYN_CONTACT_STATUS_CONVERGED, d.report.status);
    EXPECT_GE(d.report.residual, 0.9);
    for (const double l : d.lambda) EXPECT_TRUE(std::isfinite(l));
  }
}

}  // namespace
}  // namespace dyn_test
