// Poses at which distance queries of others threw, hung or answered NaN (FCL's regression tests, libccd's issues).
#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

// Rows of a homogeneous matrix, as in FCL's test.
Placement rows(const std::array<double, 12>& x) {
  return {x[0], x[4], x[8], x[1], x[5], x[9], x[2], x[6], x[10], x[3], x[7], x[11]};
}
Placement quaternion(double w, double x, double y, double z, const Vector3& p) {
  const double n = w * w + x * x + y * y + z * z;
  const auto two = [&](double a, double b) { return 2 * a * b / n; };
  return {1 - two(y, y) - two(z, z),
          two(x, y) + two(w, z),
          two(x, z) - two(w, y),
          two(x, y) - two(w, z),
          1 - two(x, x) - two(z, z),
          two(y, z) + two(w, x),
          two(x, z) + two(w, y),
          two(y, z) - two(w, x),
          1 - two(x, x) - two(y, y),
          p[0],
          p[1],
          p[2]};
}

struct Shape {
  dynShapeType type;
  Vector3 size;
  Placement X;
  double extent() const { return std::max({1.0, size[0], size[1], size[2]}); }
};
Shape box(const Vector3& s, const Placement& X) { return {DYN_SHAPE_TYPE_BOX, s, X}; }
Shape cylinder(double r, double l, const Placement& X) { return {DYN_SHAPE_TYPE_CYLINDER, {r, l, 0}, X}; }
Shape sphere(double r, const Placement& X) { return {DYN_SHAPE_TYPE_SPHERE, {r, 0, 0}, X}; }

// How far a point lies outside of a shape.
double outside(const Shape& s, const double* p) {
  double x[3];
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = 0;
    for (std::size_t k = 0; k < 3; ++k) x[i] += s.X[3 * i + k] * (p[k] - s.X[9 + k]);
  }
  if (s.type == DYN_SHAPE_TYPE_SPHERE) return std::hypot(x[0], x[1], x[2]) - s.size[0];
  if (s.type == DYN_SHAPE_TYPE_CYLINDER) return std::max(std::hypot(x[0], x[1]) - s.size[0], std::abs(x[2]) - s.size[1] / 2);
  return std::max({std::abs(x[0]) - s.size[0] / 2, std::abs(x[1]) - s.size[1] / 2, std::abs(x[2]) - s.size[2] / 2});
}

// The pair both ways round: the largest of what is wrong about it, by what is allowed: status, NaN, normal, the gap of the
// witnesses (1e-6), witnesses outside of their shapes (10 eps), and the distance where it is known.
void look(Outcome& out, const Shape& a, const Shape& b, double expected = NAN, double allowed = 1.5e-8) {
  const auto one_way = [&](const Shape& p, const Shape& q) {
    const dynDistance d = dyn::geometry_distance(dyn::geometry(p.type, p.size), p.X, dyn::geometry(q.type, q.size), q.X);
    const double gap = std::hypot(d.point_b[0] - d.point_a[0], d.point_b[1] - d.point_a[1], d.point_b[2] - d.point_a[2]);
    const double length = std::hypot(d.normal[0], d.normal[1], d.normal[2]);
    const double far = std::max({1.0, std::abs(p.X[9]), std::abs(p.X[10]), std::abs(p.X[11])});
    if (d.status == DYN_DISTANCE_STATUS_FAILED) out.off_by(HUGE_VAL);
    out.off_by(std::abs(gap - std::abs(d.distance)) / 1e-6).off_by(std::abs(length - 1) / 1e-12);
    out.off_by(outside(p, d.point_a) / (10 * eps * p.extent() * far))
        .off_by(outside(q, d.point_b) / (10 * eps * q.extent() * far));
    if (std::isnan(expected)) return;
    out.off_by(std::abs(d.distance - expected) / allowed);
    out.reference.push_back(expected), out.result.push_back(d.distance);
  };
  one_way(a, b), one_way(b, a);
}

}  // namespace

// Numbers 1 - 3, 6, 7, 9, 11, 12 of the table of FCL's tests.
Outcome fcl_poses() {
  Outcome out;
  const Shape shelf = box({.025, .35, 1.845}, rows({0, -1, 0, .8, 1, 0, 0, -.4575, 0, 0, 1, 1.0225}));
  look(out,
       cylinder(.05, .06,
                rows({-0.99999999997999022838, 6.2572835802045040178e-10, 6.3260669852976095481e-06, 0.57500009756757608503,
                      6.3260669851683709551e-06, -6.3943303429958554955e-10, 0.99999999997999056145, -0.42711963046787942977,
                      6.2573180158128459924e-10, 1, 6.3942912945996747041e-10, 1.1867093358746836351})),
       shelf);
  look(out,
       cylinder(.05, .06,
                rows({-0.97313010759279283679, -0.12202804064972551379, 0.19526123781136842106, 0.87472781461138560122,
                      0.20950801135757171623, -0.11745920593569325607, 0.97072639199619581429, -0.4038687881347159947,
                      -0.095520609678929752073, 0.98555187191549953329, 0.13986894183635001365, 1.5871328698116491385})),
       shelf);
  look(out,
       box({.03, .12, .1},
           rows({-3.0627937852578681533e-08, -0.99999999999999888978, -2.8893865161583314238e-08, 0.63499979627350811029,
                 0.9999999999999980016, -3.0627939739957803544e-08, 6.4729926918527511769e-08, -0.48500002215636439651,
                 -6.4729927722963847085e-08, -2.8893863029448751323e-08, 0.99999999999999711342, 1.0778146458339641356})),
       shelf);
  look(out, box({.614, 3, .37}, at(-.675, 0, .9115)), box({.494, .552, .01}, at(-.692, 0, .935)));
  look(out, box({.2, .33, .1}, at(-0.071, -0.772, 0.8)),
       box({.452, .27, .6}, at(0.121, -0.78769605692727695523, 0.53422044196125151316)));
  look(
      out,
      box({.05, .55, .3}, rows({0.00079632671073326442932, -0.99999968293183538748, 0, 0.75000000000000055511,
                                0.99999968293183538748, 0.00079632671073326442932, 0, -2.4083553715553102684e-15, 0, 0, 1, .15})),
      box({.25, .2, .15}, rows({6.1232339957367660359e-17, 0, 1, .75, -1, 6.1232339957367660359e-17, 6.1232339957367660359e-17, 0,
                                -6.1232339957367660359e-17, -1, 3.7493994566546440196e-33, .15})));
  look(out,
       sphere(.06, rows({-1, -4.4637642593504144998e-09, 0, 1.7855056639081962376e-10, 4.4637642593504144998e-09, -1, 0, 0.04, 0,
                         0, 1, 0.33})),
       box({.1, .1, .1}, at(.05, .15, .35)), 0, 1e-6);
  look(out, cylinder(.03, .65, at(.6, 0, .325)), sphere(.055, at(0.5419794018, -0.0621175025, 0.6016236576)));
  look(out, box({.05, .39, 1.47}, quaternion(.707107, 0, 0, .707107, {.8, -.385, .735})),
       cylinder(.18, .18, quaternion(.991445, 0, 0, -.130526, {.4, -.4, .93})));
  look(out, box({.49, .63, .015}, at(0, 0, 0)), cylinder(.08, .002, at(0, 0, 0.0085)));
  return out;
}

// FCL 493: cubes of five sizes that touch, nearly touch or overlap by less than rounding.
Outcome kissing_cubes() {
  Outcome out;
  const Placement R = rows({0.94096063217417758029, 0.29296840037289501035, 0.16959541586174811667, 0, -0.23569836841299879326,
                            0.92661523595848427348, -0.29296840037289506586, 0, -0.2429801799032638987, 0.23569836841299884878,
                            0.94096063217417758029, 0});
  for (const double dim : {.01, .25, .5, 10.0, 1000.0})
    for (const double d : {-1e-15, -2.5e-16, -1e-16, 0.0, 1e-16, 2.5e-16, 1e-15}) {
      const double far = dim + d * std::max(1.0, dim);
      Placement A = R, B = R;
      A[11] = 5 * dim;
      for (std::size_t k = 0; k < 3; ++k) B[9 + k] = A[9 + k] + R[3 + k] * far;
      look(out, box({dim, dim, dim}, A), box({dim, dim, dim}, B), d * std::max(1.0, dim), 1.5e-8);
    }
  return out;
}

// libccd 25, 49, 55: cubes of side 2 face to face, edge to edge, corner to corner, one in the other; thin plates; wide grounds.
Outcome touching_cubes() {
  Outcome out;
  const auto cube = [](double x, double y, double z) { return box({2, 2, 2}, at(x, y, z)); };
  look(out, cube(0, 0, 0), cube(0, 0, 1.9), -0.1, 1e-12);
  look(out, cube(0, 0, 0), cube(0, 0, 2), 0, 1e-12);
  look(out, cube(0, 0, 0), cube(0, 0, 0), -2, 1e-12);
  look(out, cube(0, 0, 0), cube(.5, .5, 1.9), -0.1, 1e-12);
  look(out, cube(0, 0, 0), cube(2, 0, 1.9), 0, 1e-12);
  look(out, cube(0, 0, 0), cube(2, 2, 2), 0, 1e-12);
  look(out, box({.2, .2, .2}, at(3, 4, .1 - 1e-4)), box({200, 200, 200}, at(0, 0, -100)), -1e-4, 1e-11);
  look(out, box({.2, .2, .2}, at(3, 4, .1 - 1e-4)), box({100, 100, .01}, at(0, 0, -.005)), -1e-4, 1e-11);
  return out;
}

}  // namespace cli::stress
