#include "collision/pairs.hpp"

#include "algorithm/kinematics.hpp"
#include "collision/bounding_sphere.hpp"
#include "collision/gradient.hpp"
#include "shape/list.hpp"

namespace dyn::collision {

namespace {

Result pair_distance(const Model& m, Data<double>& d, Index pair, const Options& options = {}) {
  const Index a = m.pairs()[pair].a, b = m.pairs()[pair].b;
  return distance(d.geoms[a].shape, d.geom_poses[a], d.geoms[b].shape, d.geom_poses[b], *d.collision_workspace, options);
}

}  // namespace

void place_geoms(const Model& m, Data<double>& d) {
  ensure_position(m, d);
  for (Index k = 0; k < m.n.geoms; ++k) {
    const Geom& g = d.geoms[k];
    const SE3<double> X{d.R[g.body], d.p[g.body]};
    d.geom_poses[k] = X * g.X;
  }
}

void distances(const Model& m, Data<double>& d) {
  place_geoms(m, d);
  for (Index k = 0; k < m.n.pairs; ++k) {
    const bool tested = d.pair_states[k] == DYN_PAIR_REASON_TESTED;
    if (tested) d.results[k] = pair_distance(m, d, k);
    d.distances[k] = tested ? d.results[k].distance : shape::infinity;
  }
  d.mark_fresh(Stage::Distances);
}

Index collisions(const Model& m, Data<double>& d, double margin, int* pairs, Index capacity) {
  place_geoms(m, d);
  Index count = 0;
  Options limited;
  limited.says_unique = false, limited.max_distance = margin;
  for (Index k = 0; k < m.n.pairs; ++k) {
    if (d.pair_states[k] != DYN_PAIR_REASON_TESTED) continue;
    const PairRecord& p = m.pairs()[k];
    if (distance_lower_bound(d.geoms[p.a], d.geom_poses[p.a], d.geoms[p.b], d.geom_poses[p.b]) > margin) continue;
    if (!(pair_distance(m, d, k, limited).distance <= margin)) continue;
    if (count < capacity) pairs[count] = int(k);
    ++count;
  }
  return count;
}

void add_gradient(const Model& m, const Data<double>& d, Index pair, const Result& r, double weight, double* out,
                  std::ptrdiff_t stride) {
  // from both bodies up to their common ancestor
  auto carry = [&](Index i, Force<double> Gradient::*side) {
    const Body& b = m.bodies()[i];
    const Force<double> slope = gradient(r, d.p[i], d.p[i]).*side;
    visit(b.type, [&]<class J>() {
      for (int k = 0; k < J::nv; ++k) out[stride * (b.user_v + k)] += weight * b.ratio * dot(J::column(b, d.R[i], k), slope);
    });
    return b.parent;
  };
  Index a = d.geoms[m.pairs()[pair].a].body, b = d.geoms[m.pairs()[pair].b].body;
  while (a != b) {  // bodies follow their parents
    if (a > b)
      a = carry(a, &Gradient::a);
    else
      b = carry(b, &Gradient::b);
  }
}

void distance_gradient(const Model& m, const Data<double>& d, Index pair, double* out, std::ptrdiff_t stride) {
  for (Index k = 0; k < m.n.nv; ++k) out[stride * k] = 0;
  if (d.pair_states[pair] == DYN_PAIR_REASON_TESTED && d.results[pair].unique)
    add_gradient(m, d, pair, d.results[pair], 1, out, stride);
}

}  // namespace dyn::collision
