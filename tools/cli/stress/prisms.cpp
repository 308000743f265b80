// Prisms whose axes are parallel to 3e-9: the distance of their polygons in the plane says what theirs is.
#include <algorithm>
#include <array>

#include "cases.hpp"
#include "scene.hpp"

namespace cli::stress {

namespace {

using Point = std::array<double, 2>;
using Polygon = std::vector<Point>;  // anticlockwise

double cross(const Point& a, const Point& b) { return a[0] * b[1] - a[1] * b[0]; }
Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1]}; }

// How far the other is beyond the line of any of one's edges.
double separation(const Polygon& one, const Polygon& other) {
  double out = -HUGE_VAL;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const Point edge = minus(one[(i + 1) % one.size()], one[i]);
    double nearest = HUGE_VAL;
    for (const Point& x : other) nearest = std::min(nearest, -cross(edge, minus(x, one[i])) / std::hypot(edge[0], edge[1]));
    out = std::max(out, nearest);
  }
  return out;
}
double to_edges(const Polygon& one, const Polygon& other) {
  double out = HUGE_VAL;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const Point edge = minus(one[(i + 1) % one.size()], one[i]);
    for (const Point& x : other) {
      const Point off = minus(x, one[i]);
      const double s = std::clamp((off[0] * edge[0] + off[1] * edge[1]) / (edge[0] * edge[0] + edge[1] * edge[1]), 0.0, 1.0);
      out = std::min(out, std::hypot(off[0] - s * edge[0], off[1] - s * edge[1]));
    }
  }
  return out;
}
double signed_distance(const Polygon& a, const Polygon& b) {
  const double apart = std::max(separation(a, b), separation(b, a));
  return apart <= 0 ? apart : std::min(to_edges(a, b), to_edges(b, a));
}

// One high, the polygon in its x-y plane.
struct Prism {
  Polygon polygon;
  Placement X;
  dyn::Mesh hull;

  Prism(const Polygon& p, const Placement& at) : polygon(p), X(at), hull(made(p)) {}
  static dyn::Mesh made(const Polygon& p) {
    Vector vertices;
    for (const double z : {-0.5, 0.5})
      for (const Point& x : p) vertices.insert(vertices.end(), {x[0], x[1], z});
    return dyn::Mesh::from_arrays(vertices, static_cast<std::int64_t>(2 * p.size())).hull();
  }
  Polygon in_world() const {
    Polygon out;
    for (const Point& x : polygon) out.push_back({X[9] + X[0] * x[0] + X[3] * x[1], X[10] + X[1] * x[0] + X[4] * x[1]});
    return out;
  }
  double outside(const double* p) const {
    double x[3];
    for (std::size_t i = 0; i < 3; ++i) {
      x[i] = 0;
      for (std::size_t k = 0; k < 3; ++k) x[i] += X[3 * i + k] * (p[k] - X[9 + k]);
    }
    return std::max(separation(polygon, {{x[0], x[1]}}), std::abs(x[2]) - 0.5);
  }
};

// Largest of what is wrong, by what is allowed.
void look(Outcome& out, const Prism& a, const Prism& b) {
  const auto geometry = [](const Prism& p) { return dyn::geometry(DYN_SHAPE_TYPE_CONVEX, {1, 1, 1}, 0, p.hull.get()); };
  const dynDistance d = dyn::geometry_distance(geometry(a), a.X, geometry(b), b.X);
  const double expected = signed_distance(a.in_world(), b.in_world());
  const double gap = std::hypot(d.point_b[0] - d.point_a[0], d.point_b[1] - d.point_a[1], d.point_b[2] - d.point_a[2]);
  if (d.status == DYN_DISTANCE_STATUS_FAILED) out.off_by(HUGE_VAL);
  out.compare(expected, d.distance, 1.5e-8);
  out.off_by(std::abs(gap - std::abs(d.distance)) / 1e-6)
      .off_by(a.outside(d.point_a) / 1e-13)
      .off_by(b.outside(d.point_b) / 1e-13);
}

// As in FCL's test, which has its axis along x: rows of its pose, but for the last, (1, 0, -3.2e-9, 0).
Prism upright(const Polygon& p, const std::array<double, 4>& r0, const std::array<double, 4>& r1) {
  return {p, {r0[1], r1[1], 0, r0[2], r1[2], -3.2051032938795742666e-09, r0[0], r1[0], 1, r0[3], r1[3], 0}};
}

}  // namespace

// FCL's convex pairs from Drake 21673: prisms of 4 to 8 corners that nearly touch a triangular one, or overlap it.
Outcome prisms() {
  const Polygon octagon = {{1, 0},  {.707107, .707107},   {0, 1},  {-.707107, .707107},
                           {-1, 0}, {-.707107, -.707107}, {0, -1}, {.707107, -.707107}};
  const Polygon heptagon = {{1, 0},
                            {.62349, .781831},
                            {-.222521, .974928},
                            {-.900969, .433884},
                            {-.900969, -.433884},
                            {-.222521, -.974928},
                            {.62349, -.781831}};
  const Polygon hexagon = {{1, 0}, {.5, .866025}, {-.5, .866025}, {-1, 0}, {-.5, -.866025}, {.5, -.866025}};
  const Polygon pentagon = {{1, 0}, {.309017, .951057}, {-.809017, .587785}, {-.809017, -.587785}, {.309017, -.951057}};
  const Polygon oblong = {{.92388, .382683}, {-.92388, .382683}, {-.92388, -.382683}, {.92388, -.382683}};
  Outcome out;
  const auto pair = [&](const Prism& a, const Polygon& triangle) {
    const Prism b(triangle, at(0, 0, 0));
    look(out, a, b), look(out, b, a);
  };
  pair(upright(octagon, {-2.0399676677885372849e-09, 0.77129744817973977522, -0.63647485922966484662, 11.477445682202462862},
               {2.4720879917217940548e-09, 0.63647485922966484662, 0.77129744817973977522, 9.7785056920756936449}),
       {{10.294759, 8.932157}, {11.452373, 8.227672}, {11.618371, 9.456563}});
  pair(upright(hexagon, {-3.0140487242790098936e-09, 0.34009658459984087875, -0.94039051098122172778, 4.2864836941313040342},
               {1.090044683538143324e-09, 0.94039051098122172778, 0.34009658459984087875, 7.3869576872253679412}),
       {{4.149402, 8.493709}, {3.931647, 7.374503}, {5.188451, 7.476263}});
  pair(upright(heptagon, {-2.0479437360480804916e-09, -0.76923712747984118732, -0.63896341186844385351, 13.670417904867957049},
               {-2.4654844510601008403e-09, 0.63896341186844385351, -0.76923712747984118732, 13.169816779836704512}),
       {{14.835101, 13.060409}, {14.767995, 13.150248}, {13.785037, 12.890524}});
  pair(upright(oblong, {-2.6487935924268804787e-09, -0.56303944378188575115, -0.82643002410717436579, 15.712812998638135298},
               {-1.8045995758494454423e-09, 0.82643002410717436579, -0.56303944378188575115, 10.219809745800642276}),
       {{15.417082, 9.698621}, {16.22432, 8.915849}, {16.236605, 9.233231}});
  pair(upright(hexagon, {-2.2411796174427631456e-09, 0.7148738189791493669, -0.69925347545662319693, 6.3335747278141161232},
               {2.2912444319183419853e-09, 0.69925347545662319693, 0.7148738189791493669, 8.4631576303276716544}),
       {{5.242363, 9.122811}, {5.670377, 7.598539}, {6.359664, 8.28526}});
  pair(upright(pentagon, {-3.1934130613594990691e-09, -0.085331461972016672823, -0.99635261910516315087, 11.261494468063983021},
               {-2.7349614983807029573e-10, 0.99635261910516315087, -0.085331461972016672823, 5.7102314848013024928}),
       {{10.924769, 5.670102}, {10.839257, 4.83299}, {11.452507, 5.520981}});
  return out;
}

}  // namespace cli::stress
