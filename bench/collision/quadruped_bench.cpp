// A quadruped's distances beside Coal's on the same pairs and poses, its own and those to the ground, us for all pairs of one
// configuration.
//   usage: quadruped_bench go2.urdf
// Build: c++ -O3 -march=native -ffp-contract=fast -fno-math-errno -fno-trapping-math -std=c++20 -I include -I capi -isystem
// <eigen> -isystem <coal>/include
//        bench/collision/quadruped_bench.cpp
//        src/collision/{distance,convex_straight,convex_cylinder,convex_other,surface_distance,surface_manifold,manifold,manifold_clip}.cpp -L build/.../lib -ldyn -L <coal>/lib -lcoal, both with -Wl,-rpath
// The robot is loaded and placed by the library; distances of shapes at given placements are timed, as Coal's are.
#include <coal/collision.h>
#include <coal/distance.h>
#include <coal/shape/geometric_shapes.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

#include "dyn.h"
#include "collision/bounding_sphere.hpp"
#include "collision/manifold.hpp"
#include "shape/list.hpp"

namespace {

constexpr int configurations = 200, passes = 15;

std::shared_ptr<coal::ShapeBase> convert(const dynShapeInfo& s) {
  switch (s.type) {
    case DYN_SHAPE_TYPE_BOX: return std::make_shared<coal::Box>(s.size[0], s.size[1], s.size[2]);
    case DYN_SHAPE_TYPE_SPHERE: return std::make_shared<coal::Sphere>(s.size[0]);
    case DYN_SHAPE_TYPE_CYLINDER: return std::make_shared<coal::Cylinder>(s.size[0], s.size[1]);
    case DYN_SHAPE_TYPE_CAPSULE: return std::make_shared<coal::Capsule>(s.size[0], s.size[1]);
    case DYN_SHAPE_TYPE_HALF_SPACE: return std::make_shared<coal::Halfspace>(coal::Vec3s(0, 0, 1), 0);
    default: return nullptr;
  }
}
coal::Transform3s convert(const double* X) {
  coal::Matrix3s R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R(i, j) = X[3 * j + i];
  return {R, coal::Vec3s(X[9], X[10], X[11])};
}

template <class F>
double median_us(F&& f) {
  std::vector<double> t;
  for (int k = 0; k < passes; ++k) {
    const auto start = std::chrono::steady_clock::now();
    for (int c = 0; c < configurations; ++c) f(c);
    t.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() * 1e6 / configurations);
  }
  std::nth_element(t.begin(), t.begin() + passes / 2, t.end());
  return t[passes / 2];
}

}  // namespace

int main(int, char** argv) {
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FLOATING;
  dynModel *robot = nullptr, *m = nullptr;
  dynBuilder* b = nullptr;
  dynShapeSpec floor;
  dyn_shape_spec_init(&floor);
  floor.type = DYN_SHAPE_TYPE_HALF_SPACE;
  if (dyn_model_load(argv[1], &options, &robot) || dyn_builder_new("quadruped", &b) ||
      dyn_builder_attach(b, robot, "", nullptr) || dyn_builder_add_shape(b, &floor) || dyn_builder_finish(b, &m))
    return std::puts(dyn_last_error()), 1;
  dynData* d = nullptr;
  dyn_data_new(m, DYN_PART_COLLISION | DYN_PART_FRAMES, &d);
  dyn_data_set_pair(m, d, -1, 1);  // the floor overlaps the robot in its neutral configuration
  const int nq = dyn_model_nq(m), pairs = dyn_model_npairs(m), shapes = dyn_model_nshapes(m);

  std::vector<std::vector<double>> q;
  std::vector<std::vector<coal::Transform3s>> X;
  std::vector<std::shared_ptr<coal::ShapeBase>> geometry;
  std::vector<dynShapeInfo> info;
  for (int k = 0; k < shapes; ++k) {
    dynShapeInfo s{};
    s.struct_size = sizeof s;
    dyn_model_shape_info(m, k, &s);
    info.push_back(s), geometry.push_back(s.role == DYN_SHAPE_ROLE_COLLISION ? convert(s) : nullptr);
  }
  for (int c = 0; c < configurations; ++c) {
    std::vector<double> x(static_cast<std::size_t>(nq));
    dyn_configuration_random(m, std::uint64_t(c + 1), nullptr, nullptr, x.data());
    x[0] = x[1] = 0, x[2] = 0.6;
    q.push_back(x);
    dyn_forward_kinematics(m, d, x.data(), nullptr, nullptr);
    X.emplace_back();
    for (int k = 0; k < shapes; ++k) {
      double F[12];
      dyn_frame_placement(m, d, info[std::size_t(k)].frame, F);
      X.back().push_back(convert(F) * convert(info[std::size_t(k)].placement));
    }
  }
  struct Pair {
    int a, b;
    coal::ComputeDistance distance;
    coal::ComputeCollision collide;
  };
  std::vector<Pair> list;
  for (int k = 0; k < pairs; ++k) {
    int a, c;
    dynPairReason reason;
    dyn_model_pair(m, k, &a, &c, nullptr), dyn_data_pair(m, d, k, &reason);
    if (reason == DYN_PAIR_REASON_TESTED)
      list.push_back({a,
                      c,
                      {geometry[std::size_t(a)].get(), geometry[std::size_t(c)].get()},
                      {geometry[std::size_t(a)].get(), geometry[std::size_t(c)].get()}});
  }
  // ours
  std::vector<dyn::collision::Geom> geoms;
  std::vector<std::vector<dyn::collision::Pose>> Y;
  for (int k = 0; k < shapes; ++k) {
    dyn::collision::Geom g{};
    if (geometry[std::size_t(k)])
      dyn::collision::geometry_of(info[std::size_t(k)].type, info[std::size_t(k)].size, info[std::size_t(k)].radius, g.shape);
    dyn::shape::visit(g.shape, [&](const auto& x) { g.bounding_radius = x.extent() + x.radius; });
    geoms.push_back(g);
  }
  for (const auto& of : X) {
    Y.emplace_back();
    for (const coal::Transform3s& x : of) {
      double v[12];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) v[3 * j + i] = x.getRotation()(i, j);
      for (int i = 0; i < 3; ++i) v[9 + i] = x.getTranslation()[i];
      Y.back().push_back(dyn::load_se3(v));
    }
  }
  dyn::collision::Workspace workspace;
  auto distance = [&](int c, const Pair& p) {
    const auto &A = Y[std::size_t(c)][std::size_t(p.a)], &B = Y[std::size_t(c)][std::size_t(p.b)];
    return dyn::collision::distance(geoms[std::size_t(p.a)].shape, A, geoms[std::size_t(p.b)].shape, B, workspace).distance;
  };
  auto farther = [&](int c, const Pair& p, double margin) {
    return dyn::collision::distance_lower_bound(geoms[std::size_t(p.a)], Y[std::size_t(c)][std::size_t(p.a)],
                                                geoms[std::size_t(p.b)], Y[std::size_t(c)][std::size_t(p.b)]) > margin;
  };
  double worst = 0, sum = 0;
  int differ = 0;
  for (int c = 0; c < configurations; ++c)
    for (const Pair& p : list) {
      coal::DistanceResult r;
      const double theirs =
          p.distance(X[std::size_t(c)][std::size_t(p.a)], X[std::size_t(c)][std::size_t(p.b)], coal::DistanceRequest(true), r);
      // beyond its tolerance of 1e-6: a cylinder whose caps Coal ignores, as it does around the centre of a sphere
      const double difference = std::abs(theirs - distance(c, p));
      if (difference > 1e-5)
        ++differ;
      else
        worst = std::max(worst, difference);
    }
  std::printf("%zu pairs of %d shapes, %d configurations; %d distances differ, the others by at most %.1e m\n", list.size(),
              shapes, configurations, differ, worst);
  const double dyn_us = median_us([&](int c) {
    for (const Pair& p : list) sum += distance(c, p);
  });
  const double coal_us = median_us([&](int c) {
    for (const Pair& p : list) {
      coal::DistanceResult r;
      sum += p.distance(X[std::size_t(c)][std::size_t(p.a)], X[std::size_t(c)][std::size_t(p.b)], coal::DistanceRequest(true), r);
    }
  });
  std::printf("distances of all pairs: dyn %.2f us, Coal %.2f: %.2f\n", dyn_us, coal_us, dyn_us / coal_us);
  const double whole_us = median_us([&](int c) { dyn_distances(m, d, q[std::size_t(c)].data(), nullptr), sum += 1; });
  std::printf("dyn_distances, kinematics and placements included: %.2f us: %.2f of Coal's queries alone\n", whole_us,
              whole_us / coal_us);
  for (const double margin : {0.0, 0.05}) {
    int count = 0, points = 0, coal_count = 0;
    const double t = median_us([&](int c) {
      for (const Pair& p : list) count += !farther(c, p, margin) && distance(c, p) <= margin;
    });
    dyn::collision::Manifold found;
    const double tc = median_us([&](int c) {
      for (const Pair& p : list) {
        if (farther(c, p, margin)) continue;
        dyn::collision::contacts(geoms[std::size_t(p.a)].shape, Y[std::size_t(c)][std::size_t(p.a)],
                                 geoms[std::size_t(p.b)].shape, Y[std::size_t(c)][std::size_t(p.b)], margin, workspace, found);
        points += found.count;
      }
    });
    const double theirs = median_us([&](int c) {
      for (const Pair& p : list) {
        coal::CollisionResult r;
        coal::CollisionRequest request;
        request.security_margin = margin;
        coal_count += int(p.collide(X[std::size_t(c)][std::size_t(p.a)], X[std::size_t(c)][std::size_t(p.b)], request, r) > 0);
      }
    });
    std::printf("within %.2f m: pairs: dyn %.2f us (%d), Coal %.2f (%d): %.2f; our contact points %.2f us (%d)\n", margin, t,
                count / passes / configurations, theirs, coal_count / passes / configurations, t / theirs, tc,
                points / passes / configurations);
  }
  return sum == 0.5;
}
