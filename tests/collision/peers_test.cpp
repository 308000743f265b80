// Poses on which other engines are known to throw, hang, or give wrong results.
#include "collision/survey.hpp"

namespace dyn_test {
namespace {

Pose pose(const double (&m)[12]) {  // rows of [R p]
  return {{Vec::make(m[0], m[4], m[8]), Vec::make(m[1], m[5], m[9]), Vec::make(m[2], m[6], m[10])}, Vec::make(m[3], m[7], m[11])};
}
Pose turned(double x, double y, double z, double qx, double qy, double qz, double qw) {
  const double q[4] = {qx, qy, qz, qw};
  return {rotation(load_quaternion(q)), Vec::make(x, y, z)};
}

// Witness points lie in both shapes, at the distance found.
Result consistent(const Scene& s, double ulps = 10) {
  const Result r = query(s);
  EXPECT_NE(Status::Failed, r.status);
  const double size = std::max(1.0, std::max(size_of(s.a), size_of(s.b)));
  EXPECT_LE(shape::norm(r.point_b - r.point_a - r.normal * r.distance), 1e-9 * size);
  EXPECT_LE(outside(s.a, s.A, r.point_a), ulps * 2.3e-16 * size);
  EXPECT_LE(outside(s.b, s.B, r.point_b), ulps * 2.3e-16 * size);
  if (r.distance > 0) {
    EXPECT_NEAR(r.distance, -reach(s.a, s.A, r.normal) - reach(s.b, s.B, -r.normal), 1e-9 * size);
  }
  return r;
}
void expect(const Scene& s, double distance, double tol = 1e-12) {
  const Result r = consistent(s);
  EXPECT_NEAR(distance, r.distance, tol);
  const Result e = consistent({s.b, s.a, s.B, s.A});
  EXPECT_NEAR(distance, e.distance, tol);
}

// boxes, and the same boxes as convex polytopes
void expect_boxes(const double (&a)[3], const Pose& A, const double (&b)[3], const Pose& B, double distance, double tol = 1e-12) {
  const Solid boxes[2] = {box(a[0], a[1], a[2]), box(b[0], b[1], b[2])};
  const Solid hulls[2] = {make_convex(corners(a[0], a[1], a[2])), make_convex(corners(b[0], b[1], b[2]))};
  expect({boxes[0], boxes[1], A, B}, distance, tol);
  expect({boxes[0], hulls[1], A, B}, distance, tol);
  expect({hulls[0], boxes[1], A, B}, distance, tol);
  expect({hulls[0], hulls[1], A, B}, distance, tol);
}

TEST(Ccd, CubesThatTouchByFaceEdgeAndCorner) {
  const double two[3] = {2, 2, 2};
  expect_boxes(two, at(0, 0, 0), two, at(0, 0, 1.9), -0.1);
  expect_boxes(two, at(0, 0, 0), two, at(0, 0, 2), 0);
  expect_boxes(two, at(0, 0, 0), two, at(0, 0, 0), -2);
  expect_boxes(two, at(0, 0, 0), two, at(0.5, 0.5, 1.9), -0.1);
  expect_boxes(two, at(0, 0, 0), two, at(2, 0, 1.9), 0);
  expect_boxes(two, at(0, 0, 0), two, at(2, 2, 2), 0);
  expect_boxes(two, at(0, 0, 0), two, at(2.5, 2.5, 2.5), 0.5 * std::sqrt(3.0));
}

TEST(Ccd, SmallCubeOnALargePlate) {
  const double cube[3] = {0.2, 0.2, 0.2}, large[3] = {200, 200, 200}, plate[3] = {100, 100, 0.01};
  expect_boxes(cube, at(17, -3, 100.1 - 1e-4), large, at(0, 0, 0), -1e-4);
  expect_boxes(cube, at(17, -3, 0.105 - 1e-4), plate, at(0, 0, 0), -1e-4);
}

TEST(Ccd, StackedFaces) {
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    Chance g{std::uint64_t(i)};
    const double a[3] = {g.uniform(0.1, 2), g.uniform(0.1, 2), g.uniform(0.1, 2)},
                 b[3] = {g.uniform(0.1, 2), g.uniform(0.1, 2), g.uniform(0.1, 2)};
    const double yaw = g.uniform(-3, 3), h = (a[2] + b[2]) / 2 - 1e-3;
    const Scene s = {box(a[0], a[1], a[2]), box(b[0], b[1], b[2]), at(0, 0, 0),
                     turned(g.uniform(-1, 1) * a[0] / 2, g.uniform(-1, 1) * a[1] / 2, h, 0, 0, std::sin(yaw), std::cos(yaw))};
    const Result r = consistent(s);
    ASSERT_GE(r.distance, -1e-3 - 1e-14);
    // at the rim a shorter way may lead past an edge
    if (r.distance < -1e-3 + 1e-12) {
      ASSERT_NEAR(1, r.normal[2], 1e-9);
    }
  }
}

TEST(Fcl, CylinderAndBox319) {
  const double X[12] = {-0.99999999997999022838, 6.2572835802045040178e-10, 6.3260669852976095481e-06, 0.57500009756757608503,
                        6.3260669851683709551e-06, -6.3943303429958554955e-10, 0.99999999997999056145, -0.42711963046787942977,
                        6.2573180158128459924e-10, 1, 6.3942912945996747041e-10, 1.1867093358746836351};
  const double Y[12] = {0, -1, 0, .8, 1, 0, 0, -.4575, 0, 0, 1, 1.0225};
  consistent({cylinder(0.05, 0.06), box(0.025, 0.35, 1.845), pose(X), pose(Y)});
}
TEST(Fcl, CylinderAndBox390) {
  const double X[12] = {-0.97313010759279283679, -0.12202804064972551379, 0.19526123781136842106, 0.87472781461138560122,
                        0.20950801135757171623, -0.11745920569593325607, 0.97072639199619581429, -0.4038687881347159947,
                        -0.095520609678929752073, 0.98555187191549953329, 0.13986894183635001365, 1.5871328698116491385};
  const double Y[12] = {0, -1, 0, .8, 1, 0, 0, -.4575, 0, 0, 1, 1.0225};
  consistent({cylinder(0.05, 0.06), box(0.025, 0.35, 1.845), pose(X), pose(Y)});
}
TEST(Fcl, Boxes388) {
  const double X[12] = {-3.0627937852578681533e-08, -0.99999999999999888978, -2.8893865161583314238e-08, 0.63499979627350811029,
                        0.9999999999999980016, -3.0627939739957803544e-08, 6.4729926918527511769e-08, -0.48500002215636439651,
                        -6.4729927722963847085e-08, -2.8893863029448751323e-08, 0.99999999999999711342, 1.0778146458339641356};
  consistent({box(0.03, 0.12, 0.1), box(1, 1, 1), pose(X), at(0, 0, 0)});
}
TEST(Fcl, PlateInABox398) {
  // the plate's mid-plane at z = 0.935 in a box from 0.7265 to 1.0965: out through the top by 1.0965 - 0.930
  expect({box(.614, 3, .37), box(.494, .552, .01), at(-.675, 0, .9115), at(-.692, 0, .935)}, -(1.0965 - 0.930), 1e-12);
}
TEST(Fcl, Boxes428) {
  consistent({box(.2, .33, .1), box(.452, .27, .6), at(-0.071, -0.772, 0.8),
              at(0.121, -0.78769605692727695523, 0.53422044196125151316)});
}
TEST(Fcl, SphereAndBox408) {
  const double X[12] = {
      -1, -4.4637642593504144998e-09, 0, 1.7855056639081962376e-10, 4.4637642593504144998e-09, -1, 0, 0.04, 0, 0, 1, 0.33};
  expect({sphere(0.06), box(.1, .1, .1), pose(X), at(.05, .15, .35)}, 0, 1e-6);
}
TEST(Fcl, CylinderAndSphere391) {
  consistent({cylinder(.03, .65), sphere(.055), at(.6, 0, .325), at(0.5419794018, -0.0621175025, 0.6016236576)});
}
TEST(Fcl, BoxAndCylinder319) {
  consistent({box(.05, .39, 1.47), cylinder(.18, .18), turned(.8, -.385, .735, 0, 0, .707107, .707107),
              turned(.4, -.4, .93, 0, 0, -.130526, .991445)});
}

TEST(Drake, Boxes21673) {
  const double X[12] = {0.00079632671073326442932, -0.99999968293183538748, 0, 0.75000000000000055511,
                        0.99999968293183538748, 0.00079632671073326442932, 0, -2.4083553715553102684e-15, 0, 0, 1, .15};
  const double Y[12] = {6.1232339957367660359e-17, 0, 1, .75, -1, 6.1232339957367660359e-17, 6.1232339957367660359e-17, 0,
                        -6.1232339957367660359e-17, -1, 3.7493994566546440196e-33, .15};
  consistent({box(.05, .55, .3), box(.25, .2, .15), pose(X), pose(Y)});
}
// Prisms: a regular polygon along x and a triangle along z (Drake 21673, of test_fcl_signed_distance.cpp).
TEST(Drake, Prisms21673) {
  struct Prisms {
    int corners;            // -4: a rectangle, every other edge of the octagon
    double R[2][2], p[2];   // the polygon's y and z in the world's x and y; its x is the world's z, but for 3e-9
    double triangle[3][2];
  };
  static constexpr Prisms cases[] = {
      {8,
       {{0.77129744817973977522, 0.63647485922966484662}, {-0.63647485922966484662, 0.77129744817973977522}},
       {11.477445682202462862, 9.7785056920756936449},
       {{10.294759, 8.932157}, {11.618371, 9.456563}, {11.452373, 8.227672}}},
      {6,
       {{0.34009658459984087875, 0.94039051098122172778}, {-0.94039051098122172778, 0.34009658459984087875}},
       {4.2864836941313040342, 7.3869576872253679412},
       {{4.149402, 8.493709}, {5.188451, 7.476263}, {3.931647, 7.374503}}},
      {7,
       {{-0.76923712747984118732, 0.63896341186844385351}, {-0.63896341186844385351, -0.76923712747984118732}},
       {13.670417904867957049, 13.169816779836704512},
       {{14.835101, 13.060409}, {13.785037, 12.890524}, {14.767995, 13.150248}}},
      {-4,
       {{-0.56303944378188575115, 0.82643002410717436579}, {-0.82643002410717436579, -0.56303944378188575115}},
       {15.712812998638135298, 10.219809745800642276},
       {{15.417082, 9.698621}, {16.236605, 9.233231}, {16.22432, 8.915849}}},
      {6,
       {{0.7148738189791493669, 0.69925347545662319693}, {-0.69925347545662319693, 0.7148738189791493669}},
       {6.3335747278141161232, 8.4631576303276716544},
       {{5.242363, 9.122811}, {6.359664, 8.28526}, {5.670377, 7.598539}}},
      {5,
       {{-0.085331461972016672823, 0.99635261910516315087}, {-0.99635261910516315087, -0.085331461972016672823}},
       {11.261494468063983021, 5.7102314848013024928},
       {{10.924769, 5.670102}, {10.839257, 4.83299}, {11.452507, 5.520981}}},
      {3,
       {{-0.17548349096519452739, 0.98448237383849002136}, {-0.98448237383849002136, -0.17548349096519452739}},
       {9.4277544959429171456, 4.3549730982604870633},
       {{7.502455, 3.992667}, {7.91275, 2.73346}, {8.674382, 3.710847}}},
  };
  for (const Prisms& c : cases) {
    SCOPED_TRACE(c.corners);
    std::vector<Vec> polygon, triangle;
    auto millionths = [](double x) { return std::round(x * 1e6) / 1e6; };
    for (int k = 0; k < std::abs(c.corners); ++k) {
      const double angle = c.corners > 0 ? 2 * pi * k / c.corners : pi / 8 * (k < 2 ? 2 * k - 1 : 2 * k + 3);
      for (double x : {-0.5, 0.5}) polygon.push_back(Vec::make(x, millionths(std::cos(angle)), millionths(std::sin(angle))));
    }
    for (const auto& t : c.triangle)
      for (double z : {-0.5, 0.5}) triangle.push_back(Vec::make(t[0], t[1], z));
    const Vec y = Vec::make(c.R[0][0], c.R[0][1], 0), z = Vec::make(c.R[1][0], c.R[1][1], -3.2051032938795742666e-09);
    const Scene s = {
        make_convex(polygon), make_convex(triangle), {{cross(y, z), y, z}, Vec::make(c.p[0], c.p[1], 0)}, at(0, 0, 0)};
    const Result r = consistent(s);
    const Faults f = faults(s, r);
    EXPECT_LE(f.plane, 1e-9);
    EXPECT_LE(f.depth, 1e-9);
  }
}
TEST(Drake, BoxAndFlatCylinder10578) {
  for (int i = 0; i < 200; ++i) {
    Chance g{std::uint64_t(i)};
    consistent({box(.49, .63, .015), cylinder(.08, .002), at(0, 0, 0),
                at(g.uniform(-.25, .25), g.uniform(-.3, .3), 0.0085 + g.uniform(-1, 1) * 1e-3)});
  }
}

// Cubes that touch to the last bit (FCL 493). MuJoCo gives +dim for some.
TEST(Fcl, KissingCubes493) {
  const Mat3<double> R = {Vec::make(0.94096063217417758029, -0.23569836841299879326, -0.2429801799032638987),
                          Vec::make(0.29296840037289501035, 0.92661523595848427348, 0.23569836841299884878),
                          Vec::make(0.16959541586174811667, -0.29296840037289506586, 0.94096063217417758029)};
  for (double dim : {.01, .25, .5, 10., 1000.})
    for (double d : {-1e-15, -2.5e-16, -1e-16, 0., 1e-16, 2.5e-16, 1e-15}) {
      SCOPED_TRACE(dim);
      SCOPED_TRACE(d);
      const Pose A = {R, Vec::make(0, 0, 5 * dim)};
      const double gap = d * std::max(1.0, dim);
      const Pose B = {R, A.p + R * Vec::make(0, dim + gap, 0)};
      const double size[3] = {dim, dim, dim};
      expect_boxes(size, A, size, B, gap, 1e-14 * std::max(1.0, dim));
    }
}

// MuJoCo finds no contact here; FCL does not return.
TEST(MuJoCo, CoincidentCentres) {
  for (double offset : {0., 1e-16, 1e-12, 1e-8, 1e-4}) {
    SCOPED_TRACE(offset);
    expect({sphere(0.5), sphere(0.3), at(0, 0, 0), at(0, offset, 0)}, offset - 0.8);
    // coaxial cylinders: out through the side or the caps
    expect({cylinder(0.5, 2), cylinder(0.25, 3), at(0, 0, 0), at(0, offset, 0)}, offset - 0.75, 1e-7);
    expect({cylinder(0.5, 0.2), cylinder(0.25, 0.3), at(0, 0, 0), at(0, 0, offset)}, offset - 0.25, 1e-9);
    const Solid egg = make(Type::Ellipsoid, Vec::make(0.3, 0.4, 0.5), 0);
    expect({egg, egg, at(0, 0, 0), at(offset, 0, 0)}, offset - 0.6, 1e-9);
    expect({egg, box(1, 2, 2), at(0, 0, 0), at(offset, 0, 0)}, offset - 0.8, 1e-9);
    expect({cylinder(0.25, 3), box(1, 2, 9), at(0, 0, 0), at(offset, 0, 0)}, offset - 0.75, 1e-9);
  }
}
TEST(MuJoCo, BoxAndCylinderAHairApart) {
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    Chance g{std::uint64_t(i)};
    Scene s = {box(g.uniform(.2, 2), g.uniform(.2, 2), g.uniform(.2, 2)), cylinder(g.uniform(.1, 1), g.uniform(.2, 2)),
               {g.rotation(), Vec::zero()}, {g.rotation(), g.direction() * 2.0}};
    const Result r = query(s);
    s.B.p -= r.normal * (r.distance - 1e-12);
    EXPECT_NEAR(1e-12, consistent(s, 40).distance, 1e-9);
  }
}
TEST(MuJoCo, CapsuleWhoseAxisEntersABox) {
  // axis along x from -1.5 to 0.5 through the face x = -1: out upwards by 1 - 0.3 + radius
  const double c = std::sqrt(0.5);
  const Scene s = {capsule(0.1, 2), box(2, 2, 2), turned(-0.5, 0, 0.3, 0, c, 0, c), at(0, 0, 0)};
  expect(s, -(0.7 + 0.1), 1e-12);
  const Scene tiny = {capsule(1e-6, 2e-6), box(2, 2, 2), turned(0.3, 0.2, 1 + 0.5e-6, 0, c, 0, c), at(0, 0, 0)};
  expect(tiny, -0.5e-6, 1e-15);
}

// FCL does not return within 25 s.
TEST(Fcl, SpheresThatAllButCoincide) {
  for (double offset : {0., 1e-12, 1e-3}) expect({sphere(1), sphere(1), at(0, 0, 0), at(offset, 0, 0)}, offset - 2);
}
// FCL crashes for five of these.
TEST(Fcl, ShapesAgainstAHalfSpace) {
  const Solid plane = make(Type::HalfSpace, Vec::zero(), 0);
  const Solid solids[] = {sphere(0.5),
                          capsule(0.2, 0.6),
                          box(1, 1, 1),
                          cylinder(0.3, 1),
                          make(Type::Cone, Vec::make(0.3, 0.3, 0.5), 0),
                          make(Type::Ellipsoid, Vec::make(0.3, 0.4, 0.5), 0),
                          make_convex(corners(1, 1, 1))};
  for (const Solid& s : solids)
    for (double height : {-3., 0., 0.4, 0.5, 2.}) expect({s, plane, at(0, 0, height), at(0, 0, 0)}, height - 0.5);
}
// Coal is off by up to 1.7e-2.
TEST(Coal, CoincidentCurvedShapes) {
  const Type curved[] = {Type::Cylinder, Type::Cone, Type::Ellipsoid};
  for (Type a : curved)
    for (Type b : curved)
      for (int i = 0; i < 100; ++i) {
        Scene s = scene(a, b, Case::Random, std::uint64_t(i));
        s.B.p = s.A.p;
        const Result r = query(s);
        const Faults f = faults(s, r);
        EXPECT_FALSE(f.failed);
        EXPECT_LE(f.depth, 1e-6) << name_of(a) << ' ' << name_of(b) << ' ' << i;
      }
}

// Coal ignores the caps when the sphere's centre is inside.
TEST(Coal, SphereInACylinder) {
  expect({sphere(0.1), cylinder(1, 1), at(0.2, 0.1, 0.45), at(0, 0, 0)}, -0.15);
  expect({sphere(0.1), cylinder(1, 4), at(0, 0, 0), at(0, 0, 0)}, -1.1);
  expect({sphere(0.1), cylinder(1, 4), at(0.9, 0, 0), at(0, 0, 0)}, -0.2);
}
// A foot in another leg's hip of the go2. Coal separates through the side, 1.5 cm deeper than through the cap.
TEST(Coal, FootInACylinderOfTheGo2) {
  const Pose foot = at(0.07816108330756405, 0.19404302073175989, 0.63663705484369637);
  const Pose hip = {{Vec::make(0.24157705261448326, -0.96914757452577027, -0.048923475356067989),
                     Vec::make(0.032792291126815171, 0.058541217972520279, -0.99774625603955425),
                     Vec::make(0.96982740386769506, 0.2394282869443593, 0.045922784302959443)},
                    Vec::make(0.056543629518687938, 0.21104419375336689, 0.6516454493683933)};
  const Vec c = hip.act_inverse(foot.p);
  const double cap = 0.02 - std::abs(c[2]), side = 0.046 - std::hypot(c[0], c[1]);
  ASSERT_TRUE(0 < cap && cap < side);
  const Scene s = {sphere(0.022), cylinder(0.046, 0.04), foot, hip};
  expect(s, -(cap + 0.022));
  EXPECT_NEAR(-0.0411859965, -(side + 0.022), 1e-9);  // result of Coal 3.0.3
  EXPECT_NEAR(cap + 0.022, BruteForce(s).depth(), 1e-9);
}
TEST(Coal, SizeRatio) {
  for (double size : {1., 1e-3, 1e-6})
    for (double depth : {0.5, 0.01, -0.01, -0.5}) {
      SCOPED_TRACE(size);
      SCOPED_TRACE(depth);
      const Solid small[] = {sphere(size),
                             cylinder(size, 2 * size),
                             box(2 * size, 2 * size, 2 * size),
                             capsule(size / 2, size),
                             make(Type::Ellipsoid, Vec::make(size, size, size), 0),
                             make_convex(corners(2 * size, 2 * size, 2 * size))};
      const Solid large[] = {box(2, 2, 2), cylinder(2, 2), make_convex(corners(2, 2, 2))};
      for (const Solid& a : small)
        for (const Solid& b : large)
          expect({a, b, at(0.3, 0.2, 1 + size * (1 - depth)), at(0, 0, 0)}, -size * depth, 1e-9 * size + 2e-15);
    }
}

}  // namespace
}  // namespace dyn_test
