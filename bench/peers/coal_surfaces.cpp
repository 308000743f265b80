// Triangle meshes: our times, and Coal's on the same poses.   usage: coal_surfaces
// Build: c++ -O3 -march=native -std=c++20 -I tests -I bench/collision -I include -I src -I capi -I <coal>/include bench/peers/coal_surfaces.cpp
//        build/.../libdyn.a -L <coal>/lib -lcoal and what libdyn.a needs (the package `coal` of PyPI has headers and library in cmeel.prefix)
#include <coal/BVH/BVH_model.h>
#include <coal/distance.h>
#include <coal/shape/geometric_shapes.h>

#include <cmath>
#include <cstdio>

#include "collision/surfaces.hpp"
#include "poses.hpp"

namespace {

using namespace dyn_bench;

using Mesh = coal::BVHModel<coal::OBBRSS>;

std::unique_ptr<Mesh> convert(const Faceted& m) {
  std::vector<coal::Vec3s> points;
  std::vector<coal::Triangle> triangles;
  for (std::size_t v = 0; v < m.vertices.size(); v += 3) points.emplace_back(m.vertices[v], m.vertices[v + 1], m.vertices[v + 2]);
  for (std::size_t t = 0; t < m.triangles.size(); t += 3) triangles.emplace_back(m.triangles[t], m.triangles[t + 1], m.triangles[t + 2]);
  auto out = std::make_unique<Mesh>();
  out->beginModel();
  out->addSubModel(points, triangles);
  out->endModel();
  return out;
}

coal::Transform3s convert(const Pose& X) {
  coal::Matrix3s R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R(i, j) = X.R(i, j);
  return {R, coal::Vec3s(X.p[0], X.p[1], X.p[2])};
}

struct Poses {
  std::vector<Pose> A, B;
};

void compare(const char* name, const Faceted& mesh, const coal::CollisionGeometry& coal_mesh, const shape::Shape& other, const coal::CollisionGeometry& coal_other, double low, double high) {
  Poses p;
  std::vector<coal::Transform3s> cA, cB;
  for (int k = 0; int(p.A.size()) < 300 && k < 3000; ++k) {
    Chance g{std::uint64_t(k)};
    const Pose A = {g.rotation(), g.direction()}, B = {g.rotation(), A.p + g.direction() * g.uniform(0.2, 2.5)};
    const double d = query(mesh.shape, A, other, B).distance;
    if (d < low || d > high) continue;
    p.A.push_back(A), p.B.push_back(B), cA.push_back(convert(A)), cB.push_back(convert(B));
  }
  double ours = shape::infinity, theirs = shape::infinity, worst = 0;
  const std::size_t n = p.A.size();
  std::vector<double> d(n);
  const auto now = [] { return std::chrono::steady_clock::now(); };
  const auto ns = [&](auto start) { return std::chrono::duration<double>(now() - start).count() * 1e9 / double(n); };
  for (int pass = 0; pass < 5; ++pass) {
    auto start = now();
    for (std::size_t k = 0; k < n; ++k) d[k] = query(mesh.shape, p.A[k], other, p.B[k]).distance;
    ours = std::min(ours, ns(start));
    start = now();
    for (std::size_t k = 0; k < n; ++k) {
      coal::DistanceRequest request;
      coal::DistanceResult result;
      const double e = coal::distance(&coal_mesh, cA[k], &coal_other, cB[k], request, result);
      worst = std::max(worst, std::abs(e - d[k]));
    }
    theirs = std::min(theirs, ns(start));
  }
  std::printf("%-34s %5zu poses   ours %9.0f   coal %9.0f ns   ratio %5.2f   largest difference %.1e\n", name, n, ours, theirs, ours / theirs, worst);
}

}  // namespace

int main() {
  for (const auto& [n, m] : {std::pair<Index, Index>{24, 12}, {200, 100}}) {
    Faceted ring;
    ring_mesh(ring, n, m);
    const auto coal_ring = convert(ring);
    std::printf("ring of %d triangles\n", int(ring.count()));
    struct {
      const char* name;
      Solid solid;
      std::unique_ptr<coal::CollisionGeometry> coal;
    } others[] = {{"sphere", sphere(0.1), std::make_unique<coal::Sphere>(0.1)},
                  {"capsule", capsule(0.1, 0.3), std::make_unique<coal::Capsule>(0.1, 0.3)},
                  {"box", box(0.2, 0.3, 0.4), std::make_unique<coal::Box>(0.2, 0.3, 0.4)},
                  {"cylinder", cylinder(0.1, 0.3), std::make_unique<coal::Cylinder>(0.1, 0.3)}};
    for (const auto& o : others) {
      compare((std::string(o.name) + ", apart").c_str(), ring, *coal_ring, o.solid.shape, *o.coal, 0.1, 2);
      compare((std::string(o.name) + ", near").c_str(), ring, *coal_ring, o.solid.shape, *o.coal, 1e-4, 0.05);
      compare((std::string(o.name) + ", overlapping").c_str(), ring, *coal_ring, o.solid.shape, *o.coal, -0.05, -1e-4);
    }
    compare("itself, apart", ring, *coal_ring, ring.shape, *coal_ring, 0.1, 2);
    compare("itself, near", ring, *coal_ring, ring.shape, *coal_ring, 1e-4, 0.05);
  }
}
