// What steps cost from arbitrary velocities, the first without a guess: iterations of twelve scenes of each kind, and islands
// that stay above their tolerance. More or fewer by more than the stated share are a change of the method.
#include <random>

#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

using Place = std::array<double, 3>;

// Uniform numbers and sums of twelve of them (nearly normal), the same with every standard library.
class Dice {
 public:
  explicit Dice(int seed) : generator_(unsigned(seed)) {}
  double uniform(double low, double high) { return low + (high - low) * double(generator_()) / 4294967296.0; }
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform(0, 1);
    return sum;
  }

 private:
  std::mt19937 generator_;
};

// Free bodies that touch, and slides before them.
struct Pack {
  Scene scene;
  Numbers q;
  int bodies = 0;

  std::string next() { return "body" + std::to_string(bodies++); }
  void at(const Place& p) { q.insert(q.end(), {p[0], p[1], p[2], 0, 0, 0, 1}); }
  void box(double mass, const Place& size, const dynMaterial& x, const Place& p) {
    scene.box(next().c_str(), mass, size, x), at(p);
  }
  void ball(double mass, const dynMaterial& x, const Place& p) { scene.sphere(next().c_str(), mass, 0.1, x), at(p); }
  void plane(const dynMaterial& x, const std::array<double, 12>& placement) {
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = "universe", s.type = DYN_SHAPE_TYPE_HALF_SPACE, s.material = x;
    std::copy(placement.begin(), placement.end(), s.placement);
    EXPECT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &s)) << dyn_last_error();
  }
  void ground(const dynMaterial& x) { plane(x, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}); }
};

// Cubes, one on the other, every other one `heavy` kg.
void tower(Pack& p, int count, double heavy) {
  p.ground(material(0.5));
  for (int k = 0; k < count; ++k) p.box(k % 2 ? heavy : 1, {0.1, 0.1, 0.1}, material(0.5), {0, 0, 0.05 + 0.1 * k});
}
void bricks(Pack& p, int columns, int rows, double friction) {
  p.ground(material(friction));
  for (int k = 0; k < columns * rows; ++k)
    p.box(1 + 0.3 * (k % columns % 4), {0.2, 0.1, 0.08}, material(friction),
          {(k % columns + 0.5 * (k / columns % 2)) * 0.2, 0, 0.04 + 0.08 * (k / columns)});
}
// n^3 balls in a pit.
void lattice(Pack& p, int n, const dynMaterial& x, double heavy) {
  p.ground(x);
  for (const double side : {-1.0, 1.0})
    p.plane(x, {0, -side, 0, 0, 0, 1, -side, 0, 0, side * 0.1 * n, 0, 0}),
        p.plane(x, {0, 0, 1, -side, 0, 0, 0, -side, 0, 0, side * 0.1 * n, 0});
  for (int k = 0; k < n * n * n; ++k)
    p.ball(k % 3 == 2 ? heavy : 1, x,
           {0.2 * (k % n) + 0.1 - 0.1 * n, 0.2 * (k / n % n) + 0.1 - 0.1 * n, 0.1 + 0.2 * (k / (n * n))});
}
// Each ball lies on four others.
void pyramid(Pack& p, int layers, double friction, double heavy) {
  p.ground(material(friction));
  for (int l = 0, k = 0; l < layers; ++l)
    for (int i = 0; i < layers - l; ++i)
      for (int j = 0; j < layers - l; ++j)
        p.ball(k++ % 3 == 2 ? heavy : 1, material(friction), {0.2 * i + 0.1 * l, 0.2 * j + 0.1 * l, 0.1 + l * std::sqrt(0.02)});
}
// Two towers whose cubes are joined in pairs by ball joints.
void tied(Pack& p, int count) {
  p.ground(material(0.3));
  for (int k = 0; k < 2 * count; ++k)
    p.box(1 + k % count, {0.1, 0.1, 0.1}, material(0.3), {0.15 * (k / count), 0, 0.05 + 0.1 * (k % count)});
  for (int k = 0; k < count; ++k) {
    dynConstraint tie;
    dyn_constraint_init(&tie, DYN_CONSTRAINT_TYPE_CONNECT);
    tie.placement1[9] = 0.075, tie.placement2[9] = -0.075;
    EXPECT_EQ(DYN_OK, dyn_builder_add_constraint(p.scene.builder(), ("tie" + std::to_string(k)).c_str(), &tie,
                                                 ("body" + std::to_string(k)).c_str(),
                                                 ("body" + std::to_string(count + k)).c_str()))
        << dyn_last_error();
  }
}
// Cubes on vertical slides at their lower limits, with dry friction, and cubes on them.
void slides(Pack& p, int count) {
  const double inertia[9] = {0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01}, com[3] = {0, 0, 0}, lower = 0, upper = 0.2;
  for (int k = 0; k < count; ++k) {
    const std::string name = "slide" + std::to_string(k), body = name + "_cube";
    Spec slide(name.c_str(), DYN_JOINT_TYPE_PRISMATIC, nullptr, {0.1 * k, 0, 0.05});
    slide.about(0, 0, 1), slide.lower = &lower, slide.upper = &upper;
    EXPECT_EQ(DYN_OK, dyn_builder_add_joint(p.scene.builder(), &slide)) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_builder_add_body(p.scene.builder(), body.c_str(), name.c_str(), nullptr, 1, com, inertia))
        << dyn_last_error();
    p.scene.shape(body.c_str(), DYN_SHAPE_TYPE_BOX, {0.1, 0.1, 0.1}, material(0.5));
    dynConstraint dry;
    dyn_constraint_init(&dry, DYN_CONSTRAINT_TYPE_FRICTION);
    dry.force = 20;
    const std::string own = "dry" + std::to_string(k);
    EXPECT_EQ(DYN_OK, dyn_builder_add_constraint(p.scene.builder(), own.c_str(), &dry, name.c_str(), nullptr)) << dyn_last_error();
    p.q.push_back(0);
  }
  for (int k = 0; k + 1 < count; ++k) p.box(1 + k, {0.1, 0.1, 0.1}, material(0.5), {0.1 * k + 0.05, 0, 0.15});
}
dynMaterial rolling() {
  dynMaterial x = material(0.5);
  x.torsion = 0.02, x.rolling = 0.01;
  return x;
}

struct Kind {
  const char* name;
  void (*pack)(Pack&, int seed);
};
const Kind kinds[] = {
    {"tower", [](Pack& p, int k) { tower(p, 3 + k % 8, 1); }},
    {"heavy tower", [](Pack& p, int k) { tower(p, 3 + k % 8, 100); }},
    {"bricks", [](Pack& p, int k) { bricks(p, 2 + k % 4, 2 + k % 5, 0.3 + 0.05 * k); }},
    {"lattice", [](Pack& p, int k) { lattice(p, 2 + k % 3, material(0.1 + 0.1 * k), 1); }},
    {"heavy lattice", [](Pack& p, int k) { lattice(p, 2 + k % 3, material(0.1 + 0.1 * k), 100); }},
    {"rolling", [](Pack& p, int k) { lattice(p, 2 + k % 2, rolling(), 1); }},
    {"pyramid", [](Pack& p, int k) { pyramid(p, 3 + k % 3, 0.1 + 0.1 * k, 1); }},
    {"heavy pyramid", [](Pack& p, int k) { pyramid(p, 3 + k % 3, 0.1 + 0.1 * k, 100); }},
    {"tied", [](Pack& p, int k) { tied(p, 2 + k % 3); }},
    {"slides", [](Pack& p, int k) { slides(p, 3 + k); }},
};

// Of all twelve scenes. share: by which rounding of another processor may change the iterations.
struct Cost {
  const char* kind;
  double tolerance;
  int iterations, unsolved;
  double share;
  int steps = 2;
};
const Cost costs[] = {
    {"tower", 0, 539, 0, 0.08},       {"heavy tower", 0, 1212, 1, 0.06},      {"bricks", 0, 540, 0, 0.08},
    {"lattice", 0, 711, 2, 0.08},     {"heavy lattice", 0, 1161, 7, 0.08},    {"rolling", 0, 451, 0, 0.1},
    {"pyramid", 0, 818, 7, 0.08},     {"tied", 0, 396, 0, 0.08},              {"slides", 0, 455, 0, 0.08},
    {"tower", 0, 1323, 0, 0.05, 15},  {"heavy tower", 0, 3600, 5, 0.12, 20},
    {"heavy tower", 1e-9, 2000, 1, 0.3}, {"heavy lattice", 1e-9, 4032, 4, 0.12}, {"heavy pyramid", 1e-9, 4448, 5, 0.12},
    {"rolling", 1e-9, 2430, 3, 0.15},    {"tied", 1e-9, 350, 0, 0.2},            {"slides", 1e-9, 1900, 2, 0.3},
};

const Kind& kind_of(const std::string& name) {
  return *std::find_if(std::begin(kinds), std::end(kinds), [&](const Kind& k) { return k.name == name; });
}

// Sets the options and arbitrary velocities.
void start(Simulation& run, const Pack& pack, int seed) {
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options)) << dyn_last_error();
  Dice draw(seed);
  const double speed = std::pow(10, draw.uniform(-3, -0.5));  // m/s, rad/s
  Numbers v(std::size_t(run.m.nv()));
  for (double& x : v) x = speed * draw.normal();
  run.set(pack.q, v);
}

void expect_work(bool to_tolerance) {
  for (const Cost& cost : costs) {
    if ((cost.tolerance > 0) != to_tolerance) continue;
    int iterations = 0, unsolved = 0;
    for (int seed = 1; seed <= 12; ++seed) {
      Pack pack;
      kind_of(cost.kind).pack(pack, seed);
      Simulation run(pack.scene.finish());
      run.options.tolerance = cost.tolerance;
      start(run, pack, seed);
      for (int k = 0; k < cost.steps; ++k) {
        run.steps(1);
        const dynStepReport r = run.report();
        iterations += int(r.iterations), unsolved += r.unsolved;
      }
    }
    EXPECT_NEAR(cost.iterations, iterations, cost.share * cost.iterations) << cost.kind << ", tolerance " << cost.tolerance;
    EXPECT_LE(unsolved, cost.unsolved + 2 + cost.share * cost.unsolved) << cost.kind << ", tolerance " << cost.tolerance;
  }
}

TEST(SolveWork, ByDefaultIsAsStated) { expect_work(false); }
TEST(SolveWork, ToATightToleranceIsAsStated) { expect_work(true); }

// A tolerance that no method reaches: all of them spend what they may. Cubes of 10 t lie on cubes of 1 kg.
TEST(SolveWork, UnattainableTolerancesSpendAllIterations) {
  int iterations = 0;
  for (const int count : {4, 6, 9}) {
    Pack pack;
    tower(pack, count, 1e4);
    Simulation run(pack.scene.finish());
    run.options.tolerance = 1e-18;
    start(run, pack, count);
    for (int k = 0; k < 4; ++k) run.steps(1), iterations += int(run.report().iterations);
  }
  EXPECT_NEAR(8540, iterations, 0.03 * 8540);
}

// Gauss-Seidel alone. Anderson's acceleration by the last five sweeps takes 2060 iterations, by the last three 2580, by one 3450.
TEST(SolveWork, SweepsAreAcceleratedByThoseBefore) {
  int iterations = 0;
  for (const char* name : {"tower", "lattice", "tied"})
    for (int seed = 1; seed <= 12; ++seed) {
      Pack pack;
      kind_of(name).pack(pack, seed);
      Simulation run(pack.scene.finish(), 1e-3, DYN_CONTACT_SOLVER_TYPE_PGS);
      run.options.tolerance = 1e-6, run.options.max_iterations = 1000;
      start(run, pack, seed);
      run.steps(1);
      iterations += int(run.report().iterations);
    }
  EXPECT_NEAR(2060, iterations, 0.12 * 2060);
}

// A free ball takes 80 kB of the data of a step: contacts, rows, and room for the fill-in of factorizations.
TEST(SolveWork, MemoryOfABodyIsAsStated) {
  const auto bytes = [](int count) {
    Pack p;
    p.ground(material(0.5));
    for (int k = 0; k < count; ++k) p.ball(1, material(0.5), {0, 0, 0});
    return double(dyn_data_size(p.scene.finish(), DYN_PART_SIMULATION));
  };
  EXPECT_NEAR(80e3, (bytes(128) - bytes(64)) / 64, 8e3);
}

// A hundred links in a row take 780 kB: of blocks of the Newton matrix, 240 less than a larger model has for as many segments.
TEST(SolveWork, MemoryOfAChainIsAsStated) {
  Builder b;
  std::string parent;
  for (int k = 0; k < 100; ++k) {
    const std::string name = "joint" + std::to_string(k);
    const Spec joint(name.c_str(), DYN_JOINT_TYPE_REVOLUTE, parent.empty() ? nullptr : parent.c_str(), {0.1, 0, 0});
    b.joint(joint).body(("link" + std::to_string(k)).c_str(), name.c_str(), 1, {0, 0, 0});
    parent = name;
  }
  EXPECT_NEAR(780e3, double(dyn_data_size(b.finish(), DYN_PART_SIMULATION)), 25e3);
}

// All joints of a chain hit their limits. Up to about 100 links its segments have room for the rows; of longer chains the dense
// matrix is solved, which takes fewer iterations.
TEST(SolveWork, SegmentsOfDeepChainsHaveRoomAsStated) {
  for (const auto& [links, least, most] : {std::array{90, 20, 30}, {140, 1, 8}}) {
    std::string text = "<mujoco><option gravity='0 0 0'/><worldbody>";
    for (int k = 0; k < links; ++k)
      text += std::string("<body pos='.1 0 0'><joint type='hinge' limited='true' range='0 1' axis='") +
              (k % 2 ? "0 1 0" : "0 0 1") + "'/><inertial pos='.05 0 0' mass='1' diaginertia='.01 .01 .01'/>";
    for (int k = 0; k < links; ++k) text += "</body>";
    text += "</worldbody></mujoco>";
    dynModel* m = nullptr;
    ASSERT_EQ(DYN_OK, dyn_model_load_string(text.c_str(), nullptr, &m)) << dyn_last_error();
    Simulation run(Model(m), 1e-3);
    Numbers v;
    for (int k = 0; k < links; ++k) v.push_back(-0.05 * (1 + std::sin(7.0 * k)));
    run.set(Numbers(std::size_t(links), 0.0), v);
    run.steps(1);
    EXPECT_GE(int(run.report().iterations), least) << links;
    EXPECT_LE(int(run.report().iterations), most) << links;
  }
}

}  // namespace
}  // namespace dyn_test
