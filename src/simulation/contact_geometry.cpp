#include "simulation/contact_geometry.hpp"

#include "spatial/explog.hpp"

namespace dyn::simulation {

namespace {

using shape::Type;

// A point of the shape, with its rounding as a ball, lies on a half-space.
bool has_round_corners(const shape::Shape& s) {
  return s.type == Type::Sphere || s.type == Type::Capsule || s.type == Type::Box || s.type == Type::Convex;
}

Mat3<double> less_normal(const Vec3<double>& n, double share) { return Mat3<double>::identity() - outer(n, n) * share; }

// B is a ball of radius r, or has one, on the half-space A. Its centre is at p + (r + gap / 2) n.
ContactGeometry on_plane(const Vec3<double>& n, double arm) {
  const Mat3<double> none = Mat3<double>::zero();
  return {{none, less_normal(n, 0.5), n}, {none, skew(n * -arm), Vec3<double>::zero()}};
}
// The same with A and B exchanged, n from A to B: common motion less that of A.
ContactGeometry under_plane(const Vec3<double>& n, double arm) {
  return {{Mat3<double>::zero(), outer(n, n) * 0.5, n}, {Mat3<double>::identity(), skew(n * -arm), Vec3<double>::zero()}};
}
ContactGeometry of_balls(const Vec3<double>& n, double radius_a, double radius_b, double gap) {
  const double length = radius_a + radius_b + gap, arm_a = radius_a + gap / 2, arm_b = radius_b + gap / 2;
  const Mat3<double> turn = skew(n) * (1 / length), move = less_normal(n, 1) * (arm_a / length) + outer(n, n) * 0.5,
                     at_center = skew(n * -arm_b);
  return {{turn, move, n}, {turn * at_center, move * at_center, Vec3<double>::zero()}};
}

struct PairDifferences {
  const Model& m;
  Data<double>& d;
  const dynContact& c;
  const collision::Geom &a, &b;
  const collision::Pose &A, &B;
  static constexpr double size = 1e-5;  // m, rad

  struct Point {
    Vec3<double> normal, position;
    double distance;
  };
  bool at(const Vec3<double>& step, const Vec3<double>& turn, Point& out) const {
    const Vec3<double> p = load3(c.position);
    const Mat3<double> R = exp3(turn);
    const collision::Pose moved{R * B.R, p + step + R * (B.p - p)};
    const double margin = std::max(0.0, c.distance) + 10 * size;
    collision::Manifold found;
    collision::contacts(a.shape, A, b.shape, moved, margin, *d.collision_workspace, found);
    for (int i = 0; i < found.count; ++i)
      if (found.points[i].feature == c.feature)
        return out = {found.normal, found.points[i].position, found.points[i].distance}, true;
    return false;
  }
  bool along(const Vec3<double>& step, const Vec3<double>& turn, Vec3<double>& rotation, Vec3<double>& motion,
             double& gap) const {
    Point plus, minus;
    bool two = at(step, turn, plus);
    double over = 2 * size;
    if (!two && !at(Vec3<double>::zero(), Vec3<double>::zero(), plus)) return false;
    if (!at(step * -1.0, turn * -1.0, minus)) {
      if (!two || !at(Vec3<double>::zero(), Vec3<double>::zero(), minus)) return false;
      two = false;
    }
    if (!two) over = size;
    rotation = cross(load3(c.normal), plus.normal - minus.normal) * (1 / over);
    motion = (plus.position - minus.position) * (1 / over), gap = (plus.distance - minus.distance) / over;
    return true;
  }
  bool by(bool turns, ContactGeometry::Change& out) const {
    Vec3<double>*const turn[] = {&out.turn.x, &out.turn.y, &out.turn.z}, *const move[] = {&out.move.x, &out.move.y, &out.move.z};
    const Vec3<double> o = Vec3<double>::zero();
    double gap[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3<double> e = unit3<double>(k) * size;
      if (!along(turns ? o : e, turns ? e : o, *turn[k], *move[k], gap[k])) return false;
    }
    out.gap = load3(static_cast<const double*>(gap));
    return true;
  }
};

}  // namespace

bool contact_geometry(const Model& m, Data<double>& d, const dynContact& c, const ContactLaw& law, ContactGeometry& out) {
  const collision::Geom &a = d.geoms[law.geom_a], &b = d.geoms[law.geom_b];
  const Vec3<double> n = load3(c.normal);
  const double half = c.distance / 2;
  if (a.shape.type == Type::HalfSpace && has_round_corners(b.shape)) return out = on_plane(n, b.shape.radius + half), true;
  if (b.shape.type == Type::HalfSpace && has_round_corners(a.shape)) return out = under_plane(n, a.shape.radius + half), true;
  if (a.shape.type == Type::Sphere && b.shape.type == Type::Sphere)
    return out = of_balls(n, a.shape.radius, b.shape.radius, c.distance), true;
  const PairDifferences pair{m, d, c, a, b, d.geom_poses[law.geom_a], d.geom_poses[law.geom_b]};
  return pair.by(false, out.by_step) && pair.by(true, out.by_turn);
}

}  // namespace dyn::simulation
