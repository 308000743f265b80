// Stacks of very different masses, and what holds a table.
#include "cases.hpp"
#include "contact_law.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

constexpr double side = 0.2, friction = 0.6;

// Cubes one on another, the first one below, stepped by 1 ms for a second.
struct Stack {
  Play play;
  std::vector<double> masses;
  double penetration = 0, law_error = 0, iterations = 0;

  static Model build(const std::vector<double>& masses) {
    Builder b("stack");
    add_ground(b);
    for (std::size_t k = 0; k < masses.size(); ++k)
      add_box(b, "box" + std::to_string(k), masses[k], {side, side, side}, material(friction));
    return b.finish();
  }
  explicit Stack(const std::vector<double>& m) : play(build(m), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3), masses(m) {
    Vector q;
    for (std::size_t k = 0; k < m.size(); ++k) q.insert(q.end(), {0, 0, side * (0.5 + static_cast<double>(k)), 0, 0, 0, 1});
    play.set_state(q);
    dynStepOptions options = play.step_options();
    options.tolerance = 1e-9;
    play.set_step_options(options);
  }
  void run(Curve* depth = nullptr) {
    ContactLaw law(play, masses, friction, 1e-3);
    for (int k = 0; k < 1000; ++k) {
      law_error = std::max(law_error, law.step());
      const dynStepReport r = play.step_report();
      penetration = std::max(penetration, r.penetration);
      iterations = std::max(iterations, static_cast<double>(r.iterations));
      if (depth) depth->add(play.time(), r.penetration);
    }
  }
  // Of the normal forces between bodies k - 1 and k (k = 0: on the ground): relative error.
  double force_error() {
    double worst = 0;
    const auto contacts = play.step_contacts();
    for (std::size_t k = 0; k < masses.size(); ++k) {
      double sum = 0, weight = 0;
      for (const auto& c : contacts)
        if (c.contact.shape_a == static_cast<int>(k)) sum += c.force_on_b[2];
      for (std::size_t i = k; i < masses.size(); ++i) weight += g * masses[i];
      worst = std::max(worst, std::abs(sum / weight - 1));
    }
    return worst;
  }
};

const std::vector<std::vector<double>>& ratios() {
  static const std::vector<std::vector<double>> all = {{1, 1},
                                                       {1, 1e3},
                                                       {1, 1e6},
                                                       {1e-3, 1e3},
                                                       {1e3, 1e-3},
                                                       {1e6, 1},
                                                       std::vector<double>(10, 1.0),
                                                       {1, 4.6, 21.5, 1e2, 4.6e2, 2.15e3, 1e4, 4.6e4, 2.15e5, 1e6},
                                                       {1e6, 2.15e5, 4.6e4, 1e4, 2.15e3, 4.6e2, 1e2, 21.5, 4.6, 1}};
  return all;
}

template <class F>
Outcome over_ratios(F&& measure) {
  Outcome out;
  out.picture = {"time, s", "depth, m", true, {}};
  for (const auto& masses : ratios()) {
    Stack stack(masses);
    Curve& curve = out.curve(std::to_string(masses.size()) + " boxes");
    stack.run(&curve);
    out.off_by(measure(stack));
  }
  return out;
}

// A table on four spherical feet at (+-a, +-b), its centre of mass off the middle.
constexpr double a = 0.5, b_ = 0.3, mass = 12, height = 0.7, foot = 0.02;
struct Table {
  double x, y;
  Play play;
  static Model build(double x, double y) {
    Builder b("table");
    add_ground(b);
    b.add_joint("table_joint", DYN_JOINT_TYPE_FREE_FLYER)
        .add_body("table", "table_joint", mass, {x, y, 0}, box_inertia(mass, {2 * a, 2 * b_, 0.05}));
    for (const double i : {-1.0, 1.0})
      for (const double j : {-1.0, 1.0})
        add_shape(b, "table", DYN_SHAPE_TYPE_SPHERE, {foot, 0, 0}, material(0.5), at(i * a, j * b_, -height + foot));
    return b.finish();
  }
  Table(double cx, double cy) : x(cx), y(cy), play(build(cx, cy), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3) {
    play.set_state(Vector{0, 0, height, 0, 0, 0, 1});
    dynStepOptions options = play.step_options();
    options.tolerance = 1e-12;
    play.set_step_options(options);
    play.steps(100);
  }
};
constexpr std::pair<double, double> offsets[] = {{0, 0}, {0.1, 0.05}, {-0.2, 0.08}, {0.25, -0.1}};

}  // namespace

Outcome stack_penetration() {
  return over_ratios([](Stack& s) { return s.penetration; });
}
Outcome stack_laws() {
  return over_ratios([](Stack& s) { return s.law_error; });
}
Outcome stack_iterations() {
  return over_ratios([](Stack& s) { return s.iterations; });
}
Outcome stack_forces() {
  return over_ratios([](Stack& s) { return s.force_error(); });
}

// Sum and moments of the normal forces, by W and W a.
Outcome table_sums() {
  Outcome out;
  for (const auto& [x, y] : offsets) {
    Table t(x, y);
    double sum = 0, about_x = 0, about_y = 0;
    for (const auto& c : t.play.step_contacts()) {
      const double f = c.force_on_b[2] / (mass * g);
      sum += f, about_x += f * c.contact.position[1], about_y += f * c.contact.position[0];
    }
    out.compare(1, sum).compare(x, about_y).compare(y, about_x);
  }
  return out;
}

// The least of all forces that hold it: W/4 (1 + x cx / a^2 + y cy / b^2), by W. Of inverse dynamics with its feet held.
Outcome table_least() {
  Outcome out;
  for (const auto& [x, y] : offsets) {
    Data data(Table::build(x, y), DYN_PART_CONSTRAINTS | DYN_PART_INVERSE);
    int slot = 0;
    for (const double i : {-1.0, 1.0})
      for (const double j : {-1.0, 1.0}) {
        dynConstraint c = connect({i * a, j * b_, -height}, {i * a, j * b_, 0});
        c.type = DYN_CONSTRAINT_TYPE_POINT, c.first = data.model().frame_id("table");
        data.set_constraint(slot++, c);
      }
    const auto found = data.constrained_inverse_dynamics(Vector{0, 0, height, 0, 0, 0, 1}, Vector(6), Vector(6));
    std::size_t row = 2;
    for (const double i : {-1.0, 1.0})
      for (const double j : {-1.0, 1.0}) out.compare((1 + i * x / a + j * y / b_) / 4, found.lambda[row] / (mass * g)), row += 3;
  }
  return out;
}

}  // namespace cli::stress
