// Steps of dt by the integrators of higher order, through contacts and limits that last.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

constexpr dynIntegrator higher[] = {DYN_INTEGRATOR_RK4, DYN_INTEGRATOR_IMPLICIT_MIDPOINT, DYN_INTEGRATOR_RK45,
                                    DYN_INTEGRATOR_REFERENCE};

struct Steps : Simulation {
  Steps(Model model, dynIntegrator by, double dt) : Simulation(std::move(model), dt) {
    options.integrator = by;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &options));
  }
  Numbers state() const {
    Numbers x(q, q + m.nq());
    x.insert(x.end(), v, v + m.nv());
    return x;
  }
};

// A ball of 10 cm that rolls off a fixed one of 50 cm.
constexpr double reach = 0.6, off = 0.02;
Steps rolling_off(dynIntegrator by, double dt) {
  Scene s;
  s.shape("universe", DYN_SHAPE_TYPE_SPHERE, {0.5, 0, 0}, material(1)).sphere("ball", 1, 0.1, material(1));
  return Steps(s.finish(), by, dt);
}
const Numbers above = {off, 0, std::sqrt(reach * reach - off * off), 0, 0, 0, 1};

// Error of the ball's angle about the fixed one after 0.6 s. It rolls without sliding: phi'' = 5/7 g sin(phi) / 0.6.
double error_of_rolling(dynIntegrator by, double dt) {
  double phi = std::asin(off / reach), rate = 0;
  const double a = 5.0 / 7 * g / reach, h = 1e-4;
  for (int k = 0; k < 6000; ++k) {  // Stoermer and Verlet, to 1e-8
    rate += h / 2 * a * std::sin(phi), phi += h * rate, rate += h / 2 * a * std::sin(phi);
  }
  Steps run = rolling_off(by, dt);
  run.set(above, Numbers(6, 0));
  run.steps(static_cast<int>(std::lround(0.6 / dt)));
  return std::abs(std::atan2(run.q[0], run.q[2]) - phi);
}

TEST(LastingContacts, RollingOffABallHasOrderThree) {
  for (const dynIntegrator by : higher) {
    const double coarse = error_of_rolling(by, 0.05), fine = error_of_rolling(by, 0.025);
    EXPECT_LT(coarse, 2e-5);
    EXPECT_GT(coarse, 6 * fine);
  }
  EXPECT_GT(error_of_rolling(DYN_INTEGRATOR_IMPLICIT_FAST, 0.05), 1e-3);
}

// Gaps stay below a tenth of those that count as closed, a thousandth of g dt^2, and substeps agree: to 3 % of the speed in 0.7 s, when the
// ball has gone round a quarter of the other one and would lift off.
TEST(LastingContacts, GapsStayClosedInLongSteps) {
  Steps run = rolling_off(DYN_INTEGRATOR_RK45, 0.1);
  run.set(above, Numbers(6, 0));
  for (int k = 0; k < 6; ++k) {
    run.steps(1);
    EXPECT_EQ(6, run.report().evaluations) << k;
    EXPECT_NEAR(reach, std::hypot(run.q[0], run.q[2]), 1e-4 * g * 0.1 * 0.1) << k;
  }
  Steps longer = rolling_off(DYN_INTEGRATOR_RK45, 0.7);
  longer.set(above, Numbers(6, 0));
  longer.steps(1);
  EXPECT_EQ(6, longer.report().evaluations);
  EXPECT_LT(longer.report().error_estimate, 0.03 * std::abs(longer.v[4]));
}

// A ball slides, then rolls: friction mu decelerates it by mu g until v = 5/7 v0, after t = 2/7 v0 / (mu g).
TEST(LastingContacts, SlidingBecomesRolling) {
  const double v0 = 3, mu = 0.3, slides = 2 * v0 / (7 * mu * g);
  const double x = v0 * slides - mu * g * slides * slides / 2 + 5 * v0 / 7 * (1 - slides);
  const auto error = [&](dynIntegrator by) {
    Scene s;
    Steps run(s.ground().sphere("ball", 1, 0.1, material(mu)).finish(), by, 0.05);
    run.set({0, 0, 0.1, 0, 0, 0, 1}, {v0, 0, 0, 0, 0, 0});
    run.steps(20);
    EXPECT_NEAR(5 * v0 / 7, std::hypot(run.v[0], run.v[2]), 2e-5);
    return std::abs(run.q[0] - x);
  };
  for (const dynIntegrator by : higher) EXPECT_LT(error(by), 1e-3);
  EXPECT_GT(error(DYN_INTEGRATOR_IMPLICIT_FAST), 2e-2);
}

TEST(LastingContacts, ABoxRests) {
  for (const dynIntegrator by : higher) {
    Scene s;
    Steps run(s.ground().box("box", 2, {0.2, 0.2, 0.1}, material(0.5)).finish(), by, 0.01);
    run.place({{0, 0, 0.05}});
    run.steps(1000);
    double force = 0;
    for (const dynContactForce& f : run.contacts()) force += std::abs(f.force_on_b[2]);
    EXPECT_NEAR(2 * g, force, 1e-6);
    EXPECT_NEAR(0.05, run.q[2], 1e-8);
    EXPECT_NEAR(0, std::hypot(run.q[0], run.q[1]), 1e-9);
  }
}

// A ball falls 0.2 m, bounces with restitution e, and meets the ground again after 2 e v0 / g: it rises to e^2 of the height each time.
// Steps end where it meets the ground, so that only their short parts there, a thousandth, are of order 1.
TEST(LastingContacts, BouncesKeepTheEnergyOfTheirLaw) {
  for (const dynIntegrator by : {DYN_INTEGRATOR_RK4, DYN_INTEGRATOR_RK45, DYN_INTEGRATOR_IMPLICIT_MIDPOINT})
    for (const double e : {1.0, 0.8}) {
      Scene s;
      Steps run(s.ground().sphere("ball", 1, 0.1, material(0, e)).finish(), by, 0.016);
      run.place({{0, 0, 0.3}});
      const double fall = std::sqrt(2 * 0.2 / g);
      double time = 0, next = fall, scale = 1;
      for (int k = 0; k < 60; ++k) {
        run.steps(1), time += 0.016;
        if (time > next) scale *= e * e, next += 2 * fall * std::sqrt(scale);
        EXPECT_NEAR(scale, (g * (run.q[2] - 0.1) + run.v[2] * run.v[2] / 2) / (g * 0.2), 6e-4) << int(by) << " " << time;
      }
      EXPECT_LT(next, time + 2 * fall);
    }
}

// Many rows, and steps with a deadline, are steps of IMPLICIT_FAST, bit for bit.
Numbers after(dynIntegrator by, Model model, const Numbers& q, const Numbers& v, double time_budget = 0) {
  Steps run(std::move(model), by, 0.01);
  run.options.time_budget = time_budget;
  EXPECT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
  run.set(q, v);
  run.steps(1);
  return run.state();
}
Model a_ball() {
  Scene s;
  return s.ground().sphere("ball", 1, 0.1, material(0.3)).finish();
}
TEST(LastingContacts, StepsWithADeadlineAreOfOrderOne) {
  const Numbers q = {0, 0, 0.1, 0, 0, 0, 1}, v = {1, 0, 0, 0, 0, 0};
  for (const dynIntegrator by : higher) {
    EXPECT_NE(after(DYN_INTEGRATOR_IMPLICIT_FAST, a_ball(), q, v), after(by, a_ball(), q, v));
    EXPECT_EQ(after(DYN_INTEGRATOR_IMPLICIT_FAST, a_ball(), q, v, 1), after(by, a_ball(), q, v, 1));
  }
}
// An open gap counts as closed up to a thousandth of g dt^2: the ball floats there. In a larger one it falls.
TEST(LastingContacts, SmallGapsCountAsClosed) {
  const double unit = 1e-3 * g * 0.01 * 0.01;
  const auto height = [&](double gap) {
    return after(DYN_INTEGRATOR_RK4, a_ball(), {0, 0, 0.1 + gap, 0, 0, 0, 1}, {1, 0, 0, 0, 0, 0})[2] - 0.1;
  };
  EXPECT_NEAR(0.5 * unit, height(0.5 * unit), 0.01 * unit);
  EXPECT_NEAR(0, height(3 * unit), 0.5 * unit);
}

// Corners of a turning box meet the ground where no gap foretold it: with restitution 1 it keeps its energy to 6 % in a second.
TEST(LastingContacts, CornersThatTurnToTheGroundAreMet) {
  for (const dynIntegrator by : {DYN_INTEGRATOR_RK4, DYN_INTEGRATOR_RK45, DYN_INTEGRATOR_IMPLICIT_MIDPOINT}) {
    Scene s;
    Steps run(s.ground().box("box", 1, {0.2, 0.3, 0.1}, material(0, 1)).finish(), by, 0.01);
    run.set({0, 0, 0.4, 0, 0, 0, 1}, {0, 0, 0, 3, 2, 1});
    const double before = run.energy();
    for (int k = 0; k < 100; ++k) {
      run.steps(1);
      EXPECT_NEAR(before, run.energy(), 0.06 * before) << int(by) << " " << k;
    }
  }
}

// A rod stands on its foot and tips over. The other end meets the ground at once with the foot's last sliding; the step is divided
// there at the second try, and the time of the fall is not rounded to steps.
TEST(LastingContacts, AStepIsTriedAgainUpToWhereSomethingMeets) {
  const auto fallen = [](double dt) {
    Scene s;
    Steps run(s.ground().rod("rod", 1, 0.02, 0.4, material(0.5)).finish(), DYN_INTEGRATOR_RK4, dt);
    const double tilt = 0.6;
    run.set({0, 0, 0.02 + 0.2 * std::cos(tilt), 0, std::sin(tilt / 2), 0, std::cos(tilt / 2)}, Numbers(6, 0));
    std::int64_t most = 0;
    for (int k = 0; k < std::lround(0.6 / dt); ++k) run.steps(1), most = std::max<std::int64_t>(most, run.report().rejected);
    EXPECT_EQ(2, most);
    return run.q[0];
  };
  EXPECT_NEAR(fallen(0.01), fallen(0.04), 2e-3);
}

TEST(LastingContacts, ManyRowsAreStepsOfOrderOne) {
  const auto stack = [] {
    const std::array<double, 3> brick = {0.2, 0.2, 0.1};
    Scene s;
    return s.ground().box("a", 1, brick, material(0.5)).box("b", 1, brick, material(0.5)).box("c", 1, brick, material(0.5)).finish();
  };
  Numbers q, v(18, 0);
  for (const double z : {0.05, 0.15, 0.25}) q.insert(q.end(), {0, 0, z, 0, 0, 0, 1});
  v[0] = v[6] = v[12] = 1;
  for (const dynIntegrator by : higher) EXPECT_EQ(after(DYN_INTEGRATOR_IMPLICIT_FAST, stack(), q, v), after(by, stack(), q, v));
}

}  // namespace
}  // namespace dyn_test
