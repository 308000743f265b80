// Coal's times on the poses of bench/collision.   usage: coal_collision [part of a pair's name]
// Build: c++ -O3 -march=native -std=c++20 -I tests -I bench/collision -I include -I capi -I <coal>/include bench/peers/coal_collision.cpp
//        build/.../libdyn.a -L <coal>/lib -lcoal    (the package `coal` of PyPI has headers and library in cmeel.prefix)
#include <coal/distance.h>
#include <coal/shape/convex.h>
#include <coal/shape/geometric_shapes.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "poses.hpp"

namespace {

using namespace dyn_bench;

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
    case Type::Convex: case Type::Triangles: case Type::HeightField: break;
  }
  const shape::Hull& hull = s.hull->hull;
  auto points = std::make_shared<std::vector<coal::Vec3s>>();
  auto triangles = std::make_shared<std::vector<coal::Triangle32>>();
  for (Index i = 0; i < hull.vertices; ++i) points->emplace_back(hull.x[i], hull.y[i], hull.z[i]);
  for (Index f = 0; f < hull.faces; ++f)
    for (Index k = hull.face_start[f] + 1; k + 1 < hull.face_start[f + 1]; ++k)
      triangles->emplace_back(hull.face_vertices[hull.face_start[f]], hull.face_vertices[k], hull.face_vertices[k + 1]);
  return std::make_shared<coal::Convex<coal::Triangle32>>(points, unsigned(points->size()), triangles, unsigned(triangles->size()));
}

coal::Transform3s convert(const Pose& X) {
  coal::Matrix3s R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R(i, j) = X.R(i, j);
  return {R, coal::Vec3s(X.p[0], X.p[1], X.p[2])};
}

}  // namespace

int main(int argc, char** argv) {
  std::printf("%-24s %10s %10s %10s   ns (largest difference of the distances)\n", "pair", "apart", "near", "penetrating");
  for (int a = 0; a < shape::type_count; ++a)
    for (int b = std::max(a, 1); b < shape::type_count; ++b) {
      const std::string name = std::string(name_of(Type(a))) + "-" + name_of(Type(b));
      if (argc > 1 && name.find(argv[1]) == std::string::npos) continue;
      const PairOfShapes pair = make_pair(Type(a), Type(b));
      const auto ga = convert(pair.a), gb = convert(pair.b);
      const coal::ComputeDistance distance(ga.get(), gb.get());
      coal::DistanceRequest request;
      request.enable_signed_distance = true;
      std::printf("%-24s", name.c_str());
      for (int c = 0; c < classes; ++c) {
        std::vector<std::pair<coal::Transform3s, coal::Transform3s>> poses_of_coal;
        for (const Scene& s : pair.scenes[c]) poses_of_coal.emplace_back(convert(s.A), convert(s.B));
        std::size_t next = 0;
        double sum = 0, worst = 0;
        auto ask = [&](const Scene&) {
          coal::DistanceResult result;
          const auto& X = poses_of_coal[next];
          next = (next + 1) % poses_of_coal.size();
          const double d = distance(X.first, X.second, request, result);
          sum += d;
          return d;
        };
        for (const Scene& s : pair.scenes[c]) worst = std::max(worst, std::abs(ask(s) - query(s).distance));
        std::printf(" %6.0f (%.0e)", time(pair.scenes[c], ask), worst);
      }
      std::printf("\n");
    }
}
