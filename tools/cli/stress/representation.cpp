// Rotations near 0 and pi, joints without a third axis, bodies without inertia, other units.
#include <span>

#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

Model ball_joint() {
  Builder b("ball");
  b.add_joint("ball", DYN_JOINT_TYPE_SPHERICAL).add_body("link", "ball", 2, {0.1, 0.2, -0.3}, diagonal(0.1, 0.2, 0.25));
  return b.finish();
}

}  // namespace

// exp and back by log about (1, 2, 3): in ulp of the angle.
Outcome rotations_round_trip() {
  const Model m = ball_joint();
  Outcome out;
  const double axis[] = {1 / std::sqrt(14.0), 2 / std::sqrt(14.0), 3 / std::sqrt(14.0)};
  for (const double angle : {pi - 1e-3, pi - 1e-8, pi - 1e-15, 3.0, 1.0, 1e-3, 1e-8, 1e-15, 1e-160, 1e-300}) {
    const Vector v = {axis[0] * angle, axis[1] * angle, axis[2] * angle},
                 back = m.difference(m.neutral(), m.integrate(m.neutral(), v));
    for (std::size_t k = 0; k < 3; ++k) out.off_by(std::abs(back[k] - v[k]) / (eps * angle));
  }
  return out;
}

// The quaternions themselves, small parts by their own size.
Outcome rotations_values() {
  const Model m = ball_joint();
  Outcome out;
  const double axis[] = {1 / std::sqrt(14.0), 2 / std::sqrt(14.0), 3 / std::sqrt(14.0)};
  const auto of = [&](double angle) {
    return m.integrate(m.neutral(), Vector{axis[0] * angle, axis[1] * angle, axis[2] * angle});
  };
  for (const auto& [angle, w] :
       {std::pair{pi - 1e-3, 4.9999997916666693e-4}, {pi - 1e-8, 5e-9}, {pi - 1e-15, 5e-16}, {1e-8, 1.0}, {1e-160, 1.0}})
    out.compare(w, of(angle)[3], eps);
  const double small[] = {1.3363062095621219e-161, 2.6726124191242438e-161, 4.0089186286863658e-161};
  for (std::size_t k = 0; k < 3; ++k) out.off_by(std::abs(of(1e-160)[k] / small[k] - 1) / eps);
  return out;
}

// Where the angles of a gimbal have lost an axis: refused, or accelerations that inverse dynamics confirms.
Outcome gimbal() {
  Builder b("gimbal");
  b.add_joint("angles", DYN_JOINT_TYPE_SPHERICAL_ZYX).add_body("link", "angles", 2, {0.1, 0.2, -0.3}, diagonal(0.1, 0.2, 0.25));
  Data data(b.finish());
  Outcome out;
  const Vector v = {0.3, -0.2, 0.5}, tau = {1, 2, 3};
  for (const double off : {-1e-3, -1e-6, -1e-9, -1e-12, 0.0, 1e-12, 1e-9}) {
    try {
      const Vector q = {0.4, pi / 2 + off, -0.7}, ddq = data.aba(q, v, tau).copy(), back = data.rnea(q, v, ddq).copy();
      double size = 0, error = 0;
      for (std::size_t k = 0; k < 3; ++k)
        size = std::max(size, std::abs(ddq[k])), error = std::max(error, std::abs(back[k] - tau[k]));
      out.off_by(error / (eps * (1 + size)));
    } catch (const dyn::Error& e) {
      if (e.status() != DYN_ERROR_NUMERIC) throw;
    }
  }
  return out;
}

// q and -q are one attitude: forces bit for bit.
Outcome quaternion_sign() {
  const Model m = ball_joint();
  Data data(m);
  Outcome out;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Vector q = m.random(seed);
    const Vector v = {0.3, -0.2, 0.5}, a = {1, 2, 3}, tau = data.rnea(q, v, a).copy(), ddq = data.aba(q, v, a).copy();
    for (double& x : q) x = -x;
    const auto same = data.rnea(q, v, a).copy(), again = data.aba(q, v, a).copy();
    for (std::size_t k = 0; k < 3; ++k) out.off_by(std::abs(tau[k] - same[k])).off_by(std::abs(ddq[k] - again[k]));
  }
  return out;
}

// | |q| - 1 | over steps of a tumbling box.
namespace {
Outcome norm_drift(int steps, int every = 1) {
  Builder b("box");
  b.set_gravity({0, 0, 0});
  add_free(b, "box", 10, box_inertia(10, {0.1, 0.4, 0.9}));
  Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3);
  play.set_state(play.model().neutral(), Vector{0, 0, 0, 0.1, 5, 0.1});
  Outcome out;
  for (int k = 0; k < steps; ++k) {
    play.step();
    if (k % every) continue;
    const auto q = play.q();
    const long double square = static_cast<long double>(q[3]) * q[3] + static_cast<long double>(q[4]) * q[4] +
                               static_cast<long double>(q[5]) * q[5] + static_cast<long double>(q[6]) * q[6];
    out.off_by(static_cast<double>(std::abs(std::sqrt(square) - 1)));
  }
  return out;
}
}  // namespace
Outcome quaternion_norm() { return norm_drift(100000); }
Outcome quaternion_norm_long() { return norm_drift(10000000); }
Outcome quaternion_norm_longest() { return norm_drift(1000000000, 100); }

// Bodies that cannot be: refused with the name of the joint or link. Those that can: taken.
Outcome inertias() {
  Outcome out;
  const auto wrong = [&](bool refused, double mass, const std::array<double, 9>& I, bool free) {
    try {
      Builder b("inertias");
      b.add_joint("first", free ? DYN_JOINT_TYPE_FREE_FLYER : DYN_JOINT_TYPE_REVOLUTE);
      b.add_body("culprit", "first", mass, {0, 0, 0}, I);
      const Model m = b.finish();
      Data data(m);
      const Vector q = m.neutral(), zero(static_cast<std::size_t>(m.nv()));
      for (const double x : data.aba(q, zero, zero))
        if (!std::isfinite(x)) return true;
      return refused;
    } catch (const dyn::Error& e) {
      const std::string what = e.what();
      return !refused || e.status() != DYN_ERROR_INVALID ||
             (what.find("culprit") == std::string::npos && what.find("first") == std::string::npos);
    }
  };
  const auto say = [&](bool is_wrong) {
    out.reference.push_back(0), out.result.push_back(is_wrong);
    if (is_wrong) out.error += 1;
  };
  say(wrong(true, 0, no_inertia(), false));                          // a leaf without mass
  say(wrong(true, 1, no_inertia(), false));                          // a point on its axis
  say(wrong(true, -1, diagonal(1, 1, 1), false));                    // a negative mass
  say(wrong(true, 1, diagonal(-1, 1, 1), false));                    // a negative moment
  say(wrong(true, 1, diagonal(0, 1, 1), true));                      // a rod that flies freely: nothing resists its spin
  say(wrong(true, 1, diagonal(1, 1, 0), false));                     // a rod along its own hinge
  say(wrong(true, 1, diagonal(1, 1, 2.001),
            false));  // no masses are spread like that: the triangle inequality; the same of files
  const auto refused = [](const std::string& text, const dyn::LoadOptions& options) {
    try {
      Model::load_string(text, options);
    } catch (const dyn::Error& e) {
      return std::string(e.what()).find("culprit") != std::string::npos;
    }
    return false;
  };
  const auto urdf = [](const char* izz) {
    return std::string(
               "<robot name='r'><link name='culprit'><inertial><mass value='1'/><inertia ixx='1' iyy='1' ixy='0' ixz='0' iyz='0' "
               "izz='") +
           izz + "'/></inertial></link></robot>";
  };
  const auto mjcf = [](const char* moments) {
    return std::string("<mujoco><worldbody><body name='culprit'><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='") +
           moments + "'/></body></worldbody></mujoco>";
  };
  const auto floating = dyn::LoadOptions().base(DYN_BASE_FLOATING).strict();
  say(!refused(urdf("2.001"), floating) || refused(urdf("2"), floating));
  say(!refused(mjcf("1 1 2.001"), {}) || refused(mjcf("1 1 2"), {}));
  say(wrong(false, 1, diagonal(1, 1, 2), false));                    // a disc
  say(wrong(false, 1, diagonal(0.1, 0.1, 0.1), false));
  return out;
}

// Lengths, masses and times in other units: the same numbers without dimensions.
namespace {

struct Units {
  double length, mass, time;
};
constexpr Units units[] = {{1, 1, 1}, {1e-6, 1, 1}, {1e6, 1, 1}, {1, 1e-9, 1}, {1, 1e9, 1}, {1e-6, 1e-9, 1e-3}, {1e6, 1e9, 1e3}};

// Scaling by powers of two rounds nothing.
constexpr double two_30 = 0x1p30, two_10 = 0x1p10;
constexpr Units exact_units[] = {{1, 1, 1},
                                 {1 / two_30, 1, 1},
                                 {two_30, 1, 1},
                                 {1, 1 / two_30, 1},
                                 {1, two_30, 1},
                                 {1 / two_30, 1 / two_30, 1 / two_10},
                                 {two_30, two_30, two_10}};

// q of joints of one coordinate, or of free flyers.
template <class Scene>
Outcome in_units(Scene&& scene, std::span<const Units> others = units) {
  Outcome out;
  const Vector first = scene(units[0]);
  for (const Units& u : others) {
    const Vector now = scene(u);
    for (std::size_t k = 0; k < first.size(); ++k) out.off_by(std::abs(now[k] - first[k]));
  }
  out.reference = {first[0]}, out.result = {scene(others[5])[0]};
  return out;
}
double gravity_in(const Units& u) { return g * u.length / (u.time * u.time); }
std::array<double, 9> inertia_in(const Units& u, double x, double y, double z) {
  const double f = u.mass * u.length * u.length;
  return diagonal(f * x, f * y, f * z);
}

}  // namespace

Outcome units_pendulum() {
  return in_units([](const Units& u) {
    Builder b("pendulum");
    b.set_gravity({0, 0, -gravity_in(u)});
    for (int k = 0; k < 2; ++k) {
      b.add_joint(hinge("j" + std::to_string(k), k ? "j0" : "", {0, 1, 0}, at(0, 0, k ? -u.length : 0)));
      b.add_body("b" + std::to_string(k), "j" + std::to_string(k), u.mass, {0, 0, -0.5 * u.length}, inertia_in(u, 0.1, 0.1, 0.1));
    }
    Play play(b.finish(), DYN_INTEGRATOR_RK4, 1e-3 * u.time);
    play.set_state(Vector{1, 0.5});
    play.steps(1000);
    return play.q().copy();
  });
}

// A closed four-bar of unequal bars.
Outcome units_mechanism() {
  return in_units([](const Units& u) {
    Builder b("four_bar");
    b.set_gravity({0, -gravity_in(u), 0});
    const auto bar = [&](const std::string& name, const std::string& parent, double x, double length) {
      b.add_joint(hinge(name, parent, {0, 0, 1}, at(x * u.length, 0, 0)));
      b.add_body(name + "_bar", name, u.mass, {length / 2 * u.length, 0, 0},
                 inertia_in(u, 0, length * length / 12, length * length / 12));
    };
    bar("crank", "", 0, 1), bar("coupler", "crank", 1, 3), bar("rocker", "", 3, 2.5);
    b.add_constraint("corner", connect({3 * u.length, 0, 0}, {2.5 * u.length, 0, 0}), "coupler_bar", "rocker_bar");
    Play play(b.finish(), DYN_INTEGRATOR_RK4, 1e-3 * u.time);
    // crank up: the corner by the intersection of two circles about (0, 1) and (3, 0)
    const double d = std::hypot(3.0, 1.0), along = (9 - 6.25 + d * d) / (2 * d), across = std::sqrt(9 - along * along);
    const double x = (along * 3 + across * 1) / d, y = 1 + (along * -1 + across * 3) / d;
    play.set_state(Vector{pi / 2, std::atan2(y - 1, x) - pi / 2, std::atan2(y, x - 3)});
    play.steps(1000);
    return play.q().copy();
  });
}

// A ball that comes to roll, and boxes that slide against friction.
Outcome sliding_in_units(int steps, std::span<const Units> others = units) {
  return in_units([steps](const Units& u) {
    Builder b("sliding");
    b.set_gravity({0, 0, -gravity_in(u)});
    add_ground(b);
    const auto I = [&](double x) { return inertia_in(u, x, x, x); };
    add_free(b, "ball", u.mass, I(0.004)), add_shape(b, "ball", DYN_SHAPE_TYPE_SPHERE, {0.1 * u.length, 0, 0}, material(0.2));
    add_free(b, "box", 3 * u.mass, I(0.02)),
        add_shape(b, "box", DYN_SHAPE_TYPE_BOX, {0.2 * u.length, 0.2 * u.length, 0.2 * u.length}, material(0.4));
    add_free(b, "top", u.mass, I(0.007)),
        add_shape(b, "top", DYN_SHAPE_TYPE_BOX, {0.2 * u.length, 0.2 * u.length, 0.2 * u.length}, material(0.4));
    Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3 * u.time);
    const double L = u.length, v = u.length / u.time;
    play.set_state(Vector{0, 0, 0.1 * L, 0, 0, 0, 1, 0, L, 0.1 * L, 0, 0, 0, 1, 0.02 * L, L, 0.3 * L, 0, 0, 0, 1},
                   Vector{v, 0, 0, 0, 0, 0, v, 0.5 * v, 0, 0, 0, 0, v, 0.5 * v, 0, 0, 0, 0});
    dynStepOptions options = play.step_options();
    options.tolerance = 1e-15;
    play.set_step_options(options);
    play.steps(steps);
    Vector out;
    for (const std::size_t body : {0u, 7u, 14u})
      for (std::size_t k = 0; k < 3; ++k) out.push_back(play.q()[body + k] / L);
    return out;
  }, others);
}

// A capsule, an ellipsoid and a box that are thrown down one on another, and bounce.
Outcome units_bounces_exact() {
  return in_units([](const Units& u) {
    const double L = u.length, v = u.length / u.time, w = 1 / u.time;
    const dynMaterial m = material(0.5, 0.3);
    Builder b("bounces");
    b.set_gravity({0, 0, -gravity_in(u)});
    add_ground(b, m);
    add_free(b, "capsule", u.mass, inertia_in(u, 0.02, 0.02, 0.003)),
        add_shape(b, "capsule", DYN_SHAPE_TYPE_CAPSULE, {0.05 * L, 0.3 * L, 0}, m);
    add_free(b, "ellipsoid", 2 * u.mass, inertia_in(u, 0.02, 0.03, 0.04)),
        add_shape(b, "ellipsoid", DYN_SHAPE_TYPE_ELLIPSOID, {0.1 * L, 0.07 * L, 0.05 * L}, m);
    add_free(b, "box", 2 * u.mass, inertia_in(u, 0.02, 0.03, 0.04)),
        add_shape(b, "box", DYN_SHAPE_TYPE_BOX, {0.1 * L, 0.2 * L, 0.15 * L}, m);
    Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3 * u.time);
    play.set_state(
        Vector{0,        0,       0.3 * L, 0.3, 0.1, 0.2, std::sqrt(0.86), 0.5 * L, 0, 0.3 * L, 0.1, 0.5, 0.2, std::sqrt(0.7),
               0.05 * L, 0.1 * L, 0.7 * L, 0.4, 0.1, 0.2, std::sqrt(0.79)},
        Vector{0.3 * v, 0.1 * v, -v, w, 2 * w, 3 * w, -0.5 * v, 0.1 * v, -v, 3 * w, 2 * w, w, 0.1 * v, 0.1 * v, -v, w, -2 * w,
               3 * w});
    play.steps(500);
    Vector out;
    for (const std::size_t body : {0u, 7u, 14u})
      for (std::size_t k = 0; k < 7; ++k) out.push_back(play.q()[body + k] / (k < 3 ? L : 1));
    return out;
  }, exact_units);
}

// Balls of 1 g to 1 t that hang on rods, one a tenth too long as it begins; a rod between points too far apart: what is open
// closes.
Outcome units_rows_exact() {
  return in_units([](const Units& u) {
    const double L = u.length;
    const auto distance = [&](double length) {
      dynConstraint c;
      dyn_constraint_init(&c, DYN_CONSTRAINT_TYPE_DISTANCE);
      c.length = length * L;
      return c;
    };
    Builder b("rows");
    b.set_gravity({0, 0, -gravity_in(u)});
    Vector q;
    const double masses[] = {1, 1e3, 1, 1e-3, 1};
    for (int k = 0; k < 5; ++k) {
      const std::string name = "ball" + std::to_string(k);
      add_free(b, name, masses[k] * u.mass, inertia_in(u, 0.004, 0.004, 0.004));
      b.add_constraint("rod" + std::to_string(k), distance(0.3), name, k ? "ball" + std::to_string(k - 1) : "");
      q.insert(q.end(), {0.3 * (k + 1) * L + (k == 4 ? 0.03 * L : 0), 0, 0, 0, 0, 0, 1});
    }
    add_free(b, "rod", u.mass, inertia_in(u, 0.01, 1.0 / 12, 1.0 / 12));
    b.add_constraint("left", connect({-0.5 * L, 0, 0}, {0, 0, 0}), "rod")
        .add_constraint("right", connect({0.5 * L, 0, 0}, {1.1 * L, 0, 0}), "rod");
    q.insert(q.end(), {0.5 * L, 0.01 * L, 0, 0, 0, 0, 1});
    Play play(b.finish(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-3 * u.time);
    play.set_state(q);
    play.steps(300);
    Vector out;
    for (std::size_t k = 0; k < q.size(); ++k) out.push_back(play.q()[k] / (k % 7 < 3 ? L : 1));
    return out;
  }, exact_units);
}

Outcome units_contact() { return sliding_in_units(100); }
// Until all has come to rest: bit for bit, as no threshold anywhere has a unit.
Outcome units_contact_exact() { return sliding_in_units(500, exact_units); }
// The same in decimal units: what these round grows as it slides.
Outcome units_contact_to_rest() { return sliding_in_units(500); }

}  // namespace cli::stress
