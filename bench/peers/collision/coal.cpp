// Coal: the functors of a pair, signed distance, contacts, its defaults otherwise.
#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>
#include <coal/distance.h>
#include <coal/shape/convex.h>
#include <coal/shape/geometric_shapes.h>

#include <optional>

#include "engine.hpp"

namespace dyn_bench {
namespace {

std::shared_ptr<coal::CollisionGeometry> convert(const shape::TriangleTree& tree) {
  std::vector<coal::Vec3s> points;
  std::vector<coal::Triangle> triangles;
  for (Index v = 0; v < tree.vertices; ++v)
    points.emplace_back(tree.vertex[3 * v], tree.vertex[3 * v + 1], tree.vertex[3 * v + 2]);
  for (Index t = 0; t < tree.triangles; ++t)
    triangles.emplace_back(tree.corner[3 * t], tree.corner[3 * t + 1], tree.corner[3 * t + 2]);
  auto out = std::make_shared<coal::BVHModel<coal::OBBRSS>>();
  out->beginModel();
  out->addSubModel(points, triangles);
  out->endModel();
  return out;
}

std::shared_ptr<coal::CollisionGeometry> convert(const Solid& s) {
  const Vec& h = s.shape.size;
  switch (s.shape.type) {
    case Type::HalfSpace: return std::make_shared<coal::Halfspace>(coal::Vec3s(0, 0, 1), 0);
    case Type::Sphere: return std::make_shared<coal::Sphere>(s.shape.radius);
    case Type::Capsule: return std::make_shared<coal::Capsule>(s.shape.radius, 2 * h[2]);
    case Type::Box: return std::make_shared<coal::Box>(2 * h[0], 2 * h[1], 2 * h[2]);
    case Type::Cylinder: return std::make_shared<coal::Cylinder>(h[0], 2 * h[2]);
    case Type::Cone: return std::make_shared<coal::Cone>(h[0], 2 * h[2]);
    case Type::Ellipsoid: return std::make_shared<coal::Ellipsoid>(h[0], h[1], h[2]);
    case Type::Triangles: return convert(*s.shape.triangles);
    case Type::Convex: case Type::HeightField: break;
  }
  const shape::Hull& hull = s.hull->hull;
  auto points = std::make_shared<std::vector<coal::Vec3s>>();
  auto triangles = std::make_shared<std::vector<coal::Triangle>>();
  for (Index i = 0; i < hull.vertices; ++i) points->emplace_back(hull.x[i], hull.y[i], hull.z[i]);
  for (Index f = 0; f < hull.faces; ++f)
    for (Index k = hull.face_start[f] + 1; k + 1 < hull.face_start[f + 1]; ++k)
      triangles->emplace_back(hull.face_vertices[hull.face_start[f]], hull.face_vertices[k], hull.face_vertices[k + 1]);
  return std::make_shared<coal::Convex<coal::Triangle>>(points, unsigned(points->size()), triangles, unsigned(triangles->size()));
}

coal::Transform3s convert(const Pose& X) {
  coal::Matrix3s R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R(i, j) = X.R(i, j);
  return {R, coal::Vec3s(X.p[0], X.p[1], X.p[2])};
}

struct Coal : Engine {
  std::shared_ptr<coal::CollisionGeometry> a, b;
  std::optional<coal::ComputeDistance> distance;
  std::optional<coal::ComputeCollision> collision;
  std::vector<std::pair<coal::Transform3s, coal::Transform3s>> poses;
  coal::DistanceRequest request;

  Coal() { request.enable_signed_distance = true; }
  const char* name() const override { return "Coal"; }
  bool load(const Solid& x, const Solid& y) override {
    a = convert(x), b = convert(y);
    distance.emplace(a.get(), b.get()), collision.emplace(a.get(), b.get());
    return true;
  }
  void place(const std::vector<Scene>& scenes) override {
    poses.clear();
    for (const Scene& s : scenes) poses.emplace_back(convert(s.A), convert(s.B));
  }
  void ask(double* d) override {
    for (const auto& X : poses) {
      coal::DistanceResult result;
      try {
        *d = (*distance)(X.first, X.second, request, result);
      } catch (const std::exception&) {
        *d = NAN;
      }
      ++d;
    }
  }
  bool contacts(double* d) override {
    const coal::CollisionRequest asked(coal::CONTACT, 8);
    for (const auto& X : poses) {
      coal::CollisionResult result;
      double least = shape::infinity;
      try {
        (*collision)(X.first, X.second, asked, result);
        for (std::size_t i = 0; i < result.numContacts(); ++i)
          least = std::min(least, double(result.getContact(i).penetration_depth));
      } catch (const std::exception&) {
        least = NAN;
      }
      *d++ = least;
    }
    return true;
  }
};

}  // namespace

std::unique_ptr<Engine> make_coal() { return std::make_unique<Coal>(); }

}  // namespace dyn_bench
