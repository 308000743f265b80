// Bodies that turn freely or about a point.
#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

// Uniform, 10 kg, 0.1 x 0.4 x 0.9 m (Peters and Hsu 2014).
Play box(double gravity, const Vector3& velocity, const Vector3& rate, double dt = 0.1) {
  Builder b("box");
  b.set_gravity({0, 0, -gravity});
  add_free(b, "box", 10, box_inertia(10, {0.1, 0.4, 0.9}));
  Play play(b.finish(), DYN_INTEGRATOR_REFERENCE, dt);
  play.set_state(play.model().neutral(), Vector{velocity[0], velocity[1], velocity[2], rate[0], rate[1], rate[2]});
  return play;
}
Play complex_box(double gravity = 9.8, double dt = 0.1) { return box(gravity, {-2, 2, 8}, {0.1, 5, 0.1}, dt); }

// q or -q against (w, x, y, z).
void compare_attitude(Outcome& out, const double* xyzw, const std::array<double, 4>& wxyz) {
  const double w = xyzw[3], sign = w * wxyz[0] + xyzw[0] * wxyz[1] + xyzw[1] * wxyz[2] + xyzw[2] * wxyz[3] < 0 ? -1 : 1;
  out.compare(wxyz[0], sign * w)
      .compare(wxyz[1], sign * xyzw[0])
      .compare(wxyz[2], sign * xyzw[1])
      .compare(wxyz[3], sign * xyzw[2]);
}
void draw_rates(Outcome& out, Play& play, int steps, int first = 3) {
  out.picture = {"time, s", "rate in the body, rad/s", false, {{"x", {}, {}}, {"y", {}, {}}, {"z", {}, {}}}};
  play.steps(steps, [&](double t) {
    for (std::size_t k = 0; k < 3; ++k) out.picture.curves[k].add(t, play.v()[static_cast<std::size_t>(first) + k]);
  });
}

// Pinned at the origin.
Play top(double mass, const Vector3& com, const std::array<double, 9>& inertia, const Vector& q, const Vector& v, double dt) {
  Builder b("top");
  b.add_joint("pin", DYN_JOINT_TYPE_SPHERICAL).add_body("top", "pin", mass, com, inertia);
  Play play(b.finish(), DYN_INTEGRATOR_REFERENCE, dt);
  play.set_state(q, v);
  return play;
}

// m = 15 kg, J about the centre of mass diag(0.234375, 0.46875, 0.234375) (Bruels and Cardona 2010).
Outcome heavy_top(double duration, const std::array<double, 6>& reference) {
  Play play = top(15, {0, 1, 0}, diagonal(0.234375, 0.46875, 0.234375), {0, 0, 0, 1}, {0, 150, -4.61538}, 0.01);
  Outcome out;
  out.picture = {"x of the centre of mass, m", "z, m", false, {}};
  Curve& path = out.curve("path");
  const int frame = play.model().frame_id("top");
  Vector3 x{};
  play.steps(static_cast<int>(std::lround(duration / 0.01)),
             [&](double) { x = play.point(frame, {0, 1, 0}), path.add(x[0], x[2]); });
  for (std::size_t k = 0; k < 3; ++k) out.compare(reference[k], x[k]).compare(reference[3 + k], play.v()[k]);
  return out;
}

// A symmetric top upright, I1 = 0.012, I3 = 0.001, m g l = 0.981, tilted by 1e-6: its tilt at the end against the linear solution
//   I1 z'' - i I3 w z' - m g l z = 0,  z(0) = tilt, z'(0) = 0 in the frame that does not turn
Outcome sleeping_top(double factor, double duration) {
  const double I1 = 0.012, I3 = 0.001, mgl = 0.981, tilt = 1e-6, rate = factor * std::sqrt(4 * mgl * I1) / I3;
  Play play =
      top(1, {0, 0, 0.1}, diagonal(I1 - 0.01, I1 - 0.01, I3), {std::sin(tilt / 2), 0, 0, std::cos(tilt / 2)}, {0, 0, rate}, 0.05);
  Outcome out;
  out.picture = {"time, s", "tilt, rad", true, {}};
  Curve& curve = out.curve("tilt");
  const double half = I3 * rate / (2 * I1), square = half * half - mgl / I1, root = std::sqrt(std::abs(square));
  double found = 0, expected = 0, largest = 0, off = 0;
  play.steps(static_cast<int>(std::lround(duration / 0.05)), [&](double t) {
    const auto q = play.q();
    found = 2 * std::asin(std::hypot(q[0], q[1]));
    const double c = square > 0 ? std::cos(root * t) : std::cosh(root * t),
                 s = square > 0 ? std::sin(root * t) : std::sinh(root * t);
    expected = tilt * std::hypot(c, half / root * s);  // |e^(i half t) (c - i half / root s)|
    largest = std::max(largest, expected), off = std::max(off, std::abs(found - expected));
    curve.add(t, found);
  });
  out.compare(expected, found, expected);
  return out.off_by(off / largest);
}

}  // namespace

Outcome box_simple() {
  Play play = box(0, {-0.9, 0.4, 0.1}, {0.5, 0, 0});
  Outcome out;
  draw_rates(out, play, 100);
  const auto q = play.q();
  const double place[] = {-9, 4, 1};
  for (std::size_t k = 0; k < 3; ++k) out.compare(place[k], q[k]);
  compare_attitude(out, q.data() + 3, {std::cos(2.5), std::sin(2.5), 0, 0});
  return out;
}

Outcome box_complex() {
  Play play = complex_box();
  Outcome out;
  draw_rates(out, play, 100);
  const auto q = play.q(), v = play.v();
  const double place[] = {-20, 20, 80 - 490}, rate[] = {2.75584040514684941, -3.73596351921621990, -3.16180900346751834};
  for (std::size_t k = 0; k < 3; ++k) out.compare(place[k], q[k]).compare(rate[k], v[3 + k]);
  compare_attitude(out, q.data() + 3, {0.225164563413958164, -0.619927562499452488, -0.277029150687194592, 0.698745723640310141});
  return out;
}

Outcome box_1000s() {
  Play play = complex_box(0, 1);
  Outcome out;
  draw_rates(out, play, 1000);
  compare_attitude(out, play.q().data() + 3,
                   {-0.885636055626914724, -0.0400448466590370319, -0.449882040184558476, -0.107941359770173042});
  const double rate[] = {1.00381000171813646, 4.85258013666904017, 1.15049004941188881};
  for (std::size_t k = 0; k < 3; ++k) out.compare(rate[k], play.v()[3 + k]);
  return out;
}

// Energy and the size of the angular momentum over 1000 s, relative.
Outcome box_invariants() {
  Play play = box(0, {0, 0, 0}, {0.1, 5, 0.1}, 1);
  Outcome out;
  out.picture = {"time, s", "relative error", true, {{"energy", {}, {}}, {"angular momentum", {}, {}}}};
  const auto spin = [&] {
    const auto h = play.centroidal_momentum();
    return std::hypot(h[3], h[4], h[5]);
  };
  const double energy = play.mechanical(), momentum = spin();
  play.steps(1000, [&](double t) {
    const double e = std::abs(play.mechanical() / energy - 1), h = std::abs(spin() / momentum - 1);
    out.off_by(e).off_by(h);
    out.picture.curves[0].add(t, e), out.picture.curves[1].add(t, h);
  });
  return out;
}

// It turns over when a quarter of the period is over: the rate about y is zero.
Outcome box_near_unstable() {
  Play play = box(0, {0, 0, 0}, {1e-9, 5, 0});
  Outcome out;
  draw_rates(out, play, 61);
  const auto v = play.v();
  const auto rate = [&] {
    return (0.9 * 0.9 - 0.1 * 0.1) / (0.9 * 0.9 + 0.1 * 0.1) * v[5] * v[3];
  };  // (Iz - Ix) / Iy wz wx = d/dt wy, but for its sign
  for (int k = 0; k < 6 && v[4] > 1e-9; ++k) play.advance(v[4] / std::abs(rate()));
  return out.compare(24.48171062298172 / 4, play.time() + v[4] / std::abs(rate()));
}

Outcome heavy_top_100ms() {
  return heavy_top(
      0.1, {0.421296658925402044, 0.894571974345592991, -0.149164700561899612, 4.80894133172809231, 150, 1.02830075671832984});
}
Outcome heavy_top_2s() {
  return heavy_top(
      2, {-0.150416822745641760, -0.724165591636895651, -0.673022269560444096, 0.122233219497394237, 150, -5.85562458920545773});
}
Outcome sleeping_top_stable() { return sleeping_top(1.01, 10); }
Outcome sleeping_top_unstable() { return sleeping_top(0.99, 3); }

}  // namespace cli::stress
