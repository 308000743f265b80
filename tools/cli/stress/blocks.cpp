// Blocks without mortar: an arch that is thick enough or not, and a stack that hangs over or falls.
#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

// A semicircle of voussoirs about y, mean radius 1 m, radial joints. Those that stand may not sink; those that are too thin must
// fall.
double arch_sinks(int count, double thickness, double duration, Curve& curve) {
  constexpr double depth = 0.3, density = 2000;
  Builder b("arch");
  add_ground(b);
  Vector q;
  for (int k = 0; k < count; ++k) {
    Vector vertices;
    for (const int end : {k, k + 1})
      for (const double r : {1 - thickness / 2, 1 + thickness / 2})
        for (const double y : {-depth / 2, depth / 2})
          vertices.insert(vertices.end(), {r * std::cos(pi * end / count), y, r * std::sin(pi * end / count)});
    if (k + 1 == count)
      for (const std::size_t i : {14u, 17u, 20u, 23u}) vertices[i] = 0;  // sin(pi)
    dynMeshInfo info = dyn::Mesh::from_arrays(vertices, 8).hull().info();
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] -= info.com[i % 3];
    const dyn::Mesh hull = dyn::Mesh::from_arrays(vertices, 8).hull();
    std::array<double, 9> inertia;
    for (std::size_t i = 0; i < 9; ++i) inertia[i] = density * info.inertia[i];
    const std::string name = "block" + std::to_string(k);
    add_free(b, name, density * info.volume, inertia);
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = name.c_str(), s.type = DYN_SHAPE_TYPE_CONVEX, s.material = material(0.7), s.surface = hull.get();
    s.size[0] = s.size[1] = s.size[2] = 1;
    dyn::check(dyn_builder_add_shape(b.get(), &s));
    q.insert(q.end(), {info.com[0], info.com[1], info.com[2], 0, 0, 0, 1});
  }
  Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3);
  play.set_state(q);
  dynStepOptions options = play.step_options();
  options.max_iterations = 200;  // more rows than are solved by one matrix: sweeps
  play.set_step_options(options);
  const auto crown = static_cast<std::size_t>(7 * (count / 2) + 2);
  double sunk = 0;
  for (int k = 0; k < static_cast<int>(duration / 1e-3) && std::abs(sunk) < 0.05; ++k) {
    play.step();
    sunk = q[crown] - play.q()[crown];
    if (k % 20 == 0) curve.add(play.time(), std::abs(sunk));
  }
  return std::abs(sunk);
}

// Ten blocks of length 1, each over the one below by share / (2 k), k from the top: what the topmost has moved after a while.
double overhang_moves(double share, Curve& curve) {
  constexpr int count = 10;
  constexpr double height = 0.1;
  Builder b("overhang");
  add_shape(b, "", DYN_SHAPE_TYPE_BOX, {4, 1, 1}, material(0), at(-2, 0, -0.5));  // a table that ends at x = 0
  Vector q(7 * count);
  double end = 0;
  for (int k = count; k >= 1; --k) {  // from below
    end += share / (2.0 * k);
    const std::string name = "block" + std::to_string(k);
    add_box(b, name, 1, {1, 0.5, height}, material(0.7));
    const auto first = static_cast<std::size_t>(7 * (count - k));
    q[first] = end - 0.5, q[first + 2] = height * (count - k + 0.5), q[first + 6] = 1;
  }
  Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3);
  play.set_state(q);
  const std::size_t top = 7 * (count - 1);
  double moved = 0;
  for (int k = 0; k < 3000 && moved < 0.05; ++k) {
    play.step();
    moved = std::hypot(play.q()[top] - q[top], play.q()[top + 2] - q[top + 2]);
    if (k % 20 == 0) curve.add(play.time(), moved);
  }
  return moved;
}

Outcome drawn(const char* what) {
  Outcome out;
  out.picture = {"time, s", what, true, {}};
  out.picture.curves.reserve(4);
  return out;
}

}  // namespace

Outcome arch_stands() {
  Outcome out = drawn("crown sunk by, m");
  return out.off_by(arch_sinks(20, 0.110, 10, out.curve("t/R = 0.110")));
}
Outcome arch_falls() {
  Outcome out = drawn("crown sunk by, m");
  const double sunk = arch_sinks(20, 0.104, 10, out.curve("t/R = 0.104"));
  out.reference = {0.05}, out.result = {sunk};
  return out.off_by(sunk >= 0.05 ? 0 : HUGE_VAL);
}
Outcome overhang() {
  Outcome out = drawn("top moved by, m");
  out.off_by(overhang_moves(0.999, out.curve("0.1 % less")));
  return out.off_by(overhang_moves(1.001, out.curve("0.1 % more")) >= 0.05 ? 0 : HUGE_VAL);
}

}  // namespace cli::stress
