// A quadruped's distances beside Coal's on the same pairs and poses, its own and those to the ground, us for all pairs of one configuration.
//   usage: quadruped_bench go2.urdf
// Build: c++ -O3 -march=native -std=c++20 -I capi -isystem <eigen> -isystem <coal>/include bench/collision/quadruped_bench.cpp -L build/.../lib -ldyn
//        -L <coal>/lib -lcoal, both with -Wl,-rpath
#include <coal/collision.h>
#include <coal/distance.h>
#include <coal/shape/geometric_shapes.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

#include "dyn.hpp"

namespace {

constexpr int configurations = 200, passes = 15;

std::shared_ptr<coal::ShapeBase> convert(const dynShapeInfo& s) {
  switch (s.type) {
    case DYN_SHAPE_BOX: return std::make_shared<coal::Box>(s.size[0], s.size[1], s.size[2]);
    case DYN_SHAPE_SPHERE: return std::make_shared<coal::Sphere>(s.size[0]);
    case DYN_SHAPE_CYLINDER: return std::make_shared<coal::Cylinder>(s.size[0], s.size[1]);
    case DYN_SHAPE_CAPSULE: return std::make_shared<coal::Capsule>(s.size[0], s.size[1]);
    case DYN_SHAPE_HALF_SPACE: return std::make_shared<coal::Halfspace>(coal::Vec3s(0, 0, 1), 0);
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
  floor.type = DYN_SHAPE_HALF_SPACE;
  if (dyn_model_load(argv[1], &options, &robot) || dyn_builder_new("quadruped", &b) || dyn_builder_attach(b, robot, "", nullptr) || dyn_builder_shape(b, &floor) ||
      dyn_builder_finish(b, &m))
    return std::puts(dyn_last_error()), 1;
  dynData* d = nullptr;
  dyn_data_new(m, DYN_PART_COLLISION | DYN_PART_FRAMES, &d);
  dyn_data_set_pair(m, d, -1, 1);  // the floor overlaps the robot in its neutral configuration
  const int nq = dyn_nq(m), pairs = dyn_npairs(m), shapes = dyn_nshapes(m);

  std::vector<std::vector<double>> q;
  std::vector<std::vector<coal::Transform3s>> X;
  std::vector<std::shared_ptr<coal::ShapeBase>> geometry;
  std::vector<dynShapeInfo> info;
  for (int k = 0; k < shapes; ++k) {
    dynShapeInfo s{};
    s.struct_size = sizeof s;
    dyn_shape_info(m, k, &s);
    info.push_back(s), geometry.push_back(s.role == DYN_ROLE_COLLISION ? convert(s) : nullptr);
  }
  for (int c = 0; c < configurations; ++c) {
    std::vector<double> x(static_cast<std::size_t>(nq));
    dyn_random(m, std::uint64_t(c + 1), nullptr, nullptr, x.data());
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
    dyn_pair(m, k, &a, &c, nullptr), dyn_data_pair(m, d, k, &reason);
    if (reason == DYN_PAIR_TESTED) list.push_back({a, c, {geometry[std::size_t(a)].get(), geometry[std::size_t(c)].get()}, {geometry[std::size_t(a)].get(), geometry[std::size_t(c)].get()}});
  }
  std::vector<double> ours(static_cast<std::size_t>(pairs));
  double worst = 0;
  for (int c = 0; c < configurations; ++c) {
    dyn_distances(m, d, q[std::size_t(c)].data(), ours.data());
    for (std::size_t k = 0; k < list.size(); ++k) {
      coal::DistanceResult r;
      const double theirs = list[k].distance(X[std::size_t(c)][std::size_t(list[k].a)], X[std::size_t(c)][std::size_t(list[k].b)], coal::DistanceRequest(true), r);
      worst = std::max(worst, std::abs(theirs - ours[k]));
    }
  }
  std::printf("%zu pairs of %d shapes, largest difference %.1e m\n", list.size(), int(dyn_nshapes(m)), worst);
  const double fk = median_us([&](int c) { dyn_forward_kinematics(m, d, q[std::size_t(c)].data(), nullptr, nullptr); });
  const double dyn_us = median_us([&](int c) { dyn_distances(m, d, q[std::size_t(c)].data(), ours.data()); });
  double sum = 0;
  const double coal_us = median_us([&](int c) {
    for (const Pair& p : list) {
      coal::DistanceResult r;
      sum += p.distance(X[std::size_t(c)][std::size_t(p.a)], X[std::size_t(c)][std::size_t(p.b)], coal::DistanceRequest(true), r);
    }
  });
  std::printf("distances: dyn %.2f us (kinematics %.2f of it), Coal %.2f: %.2f\n", dyn_us, fk, coal_us, dyn_us / coal_us);
  std::vector<int> found(static_cast<std::size_t>(pairs));
  int count = 0, coal_count = 0;
  for (const double margin : {0.0, 0.05}) {
    const double t = median_us([&](int c) { dyn_collisions(m, d, q[std::size_t(c)].data(), margin, found.data(), pairs, &count); });
    std::vector<dynContact> contacts(1000);
    const double tc = median_us([&](int c) { dyn_contacts(m, d, q[std::size_t(c)].data(), margin, contacts.data(), 1000, &count); });
    const double theirs = median_us([&](int c) {
      for (const Pair& p : list) {
        coal::CollisionResult r;
        coal::CollisionRequest request;
        request.security_margin = margin;
        coal_count += int(p.collide(X[std::size_t(c)][std::size_t(p.a)], X[std::size_t(c)][std::size_t(p.b)], request, r));
      }
    });
    std::printf("margin %.2f m: collisions: dyn %.2f us, Coal %.2f: %.2f; contact points of all: dyn %.2f\n", margin, t, theirs, t / theirs, tc);
  }
  return sum == 0.5 || coal_count < 0;
}
