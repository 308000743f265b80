// Steps stopped before their tolerance: impulses are feasible, the residual is reported, and more time or iterations never make
// it worse.
#include "common/every.hpp"
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

constexpr double mu = 0.5;

// Layers of boxes, each over the gaps of the one below: one island with many contacts.
struct Wall {
  Scene scene;
  std::vector<std::array<double, 3>> at;
  explicit Wall(int layers, double restitution = 0) {
    scene.ground();
    for (int layer = 0, k = 0; layer < layers; ++layer)
      for (int i = 0; i < layers - layer; ++i, ++k) {
        scene.box(("box" + std::to_string(k)).c_str(), 1 + layer, {0.2, 0.1, 0.1}, material(mu, restitution));
        at.push_back({0.21 * (i + 0.5 * layer), 0, 0.05 + 0.1 * layer});
      }
  }
};

struct Pile : Simulation {
  explicit Pile(int layers, dynContactSolverType solver, double restitution = 0) : Pile(Wall(layers, restitution), solver) {}
  void kick() {
    Numbers u(v, v + dyn_model_nv(m));
    for (std::size_t k = 0; k < u.size(); ++k) u[k] += 0.1 * std::sin(2.7 * double(k));
    set({}, u);
  }
  void budget(int iterations, double seconds) {
    options.max_iterations = iterations, options.time_budget = seconds;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &options)) << dyn_last_error();
  }

 private:
  Pile(Wall wall, dynContactSolverType solver) : Simulation(wall.scene.finish(), 1e-3, solver) {
    exactly(), place(wall.at);
    steps(5);
    kick();
  }
};

void expect_in_cones(const Simulation& play) {
  const auto contacts = play.contacts();
  EXPECT_GT(contacts.size(), 8u);
  for (const dynContactForce& c : contacts) {
    const double *n = c.contact.normal, *f = c.force_on_b, normal = n[0] * f[0] + n[1] * f[1] + n[2] * f[2];
    double across = 0;
    for (int k = 0; k < 3; ++k) across += (f[k] - normal * n[k]) * (f[k] - normal * n[k]);
    EXPECT_GE(normal, -1e-9);
    EXPECT_LE(std::sqrt(across), mu * normal + 1e-9 * (1 + normal));
  }
}

const std::vector<dynContactSolverType> solvers = every<dynContactSolverType>("dynContactSolverType");

// Small islands use their dense matrix, large ones Gauss-Seidel and segments.
TEST(Anytime, MoreIterationsNeverRaiseTheResidual) {
  for (const int layers : {3, 9})
    for (const dynContactSolverType solver : solvers) {
      double before = HUGE_VAL, first = 0;
      for (const int iterations : {3, 6, 9, 15, 30, 90, 300, 1200}) {
        Pile pile(layers, solver);
        pile.budget(iterations, 0);
        pile.steps(1);
        const dynStepReport r = pile.report();
        expect_in_cones(pile);
        EXPECT_EQ(r.unsolved > 0, r.residual > pile.options.tolerance) << layers << " " << solver << " " << iterations;
        if (solver != DYN_CONTACT_SOLVER_TYPE_PGS) {  // its last sweep counts
          EXPECT_LE(r.residual, before * (1 + 1e-6)) << layers << " " << solver << " " << iterations;
        }
        if (before == HUGE_VAL) first = r.residual;
        before = r.residual;
      }
      EXPECT_GT(first, 1e-6) << layers << " " << solver;  // one is not enough
      EXPECT_LT(before, 0.1 * first) << layers << " " << solver;
      if (layers == 3 && solver != DYN_CONTACT_SOLVER_TYPE_PGS) {
        EXPECT_LE(before, 1e-9) << solver;
      }
    }
}

// A deadline that has passed when the step begins, and one that never passes: neither depends on the machine's speed.
TEST(Anytime, ExpiredDeadlineStillMakesOneSweep) {
  for (const int layers : {3, 9})
    for (const double restitution : {0.0, 0.5})
      for (const dynContactSolverType solver : solvers) {
        Pile one(layers, solver, restitution), again(layers, solver, restitution), whole(layers, solver, restitution),
            free(layers, solver, restitution);
        one.budget(100, 1e-12), again.budget(100, 1e-12), whole.budget(1200, 1e9);
        for (int k = 0; k < 100; ++k) {
          one.steps(1), again.steps(1);
          expect_in_cones(one);
          ASSERT_LE(one.report().iterations, 4 * one.report().islands) << k;  // a nearly good guess needs few sweeps
          if (k < 5) whole.steps(1), free.steps(1);
        }
        for (int k = 0; k < dyn_model_nq(one.m); ++k) {
          ASSERT_EQ(one.q[k], again.q[k]);
          ASSERT_EQ(whole.q[k], free.q[k]);
          ASSERT_LT(std::abs(one.q[k]), 3);  // the pile stays together
        }
        EXPECT_LT(one.report().penetration, 0.02) << layers << " " << solver << " " << restitution;
      }
}

TEST(Anytime, DeadlineWithinTheStepIsKept) {
  Pile pile(9, DYN_CONTACT_SOLVER_TYPE_ADMM);
  for (const double seconds : {1e-6, 1e-5, 5e-5, 1e-4, 3e-4, 1e-3, 3e-3}) {
    pile.budget(100, seconds);
    pile.kick(), pile.steps(1);
    expect_in_cones(pile);
  }
}

}  // namespace
}  // namespace dyn_test
