#include "base/portable.hpp"
#include "collision/smooth.hpp"

#include "collision/manifold.hpp"
#include "collision/pairs.hpp"

namespace dyn::collision {

int smooth_distance(const Model& m, Data<double>& d, Index pair, double smoothing, double& out, double* gradient,
                    std::ptrdiff_t stride) {
  constexpr double negligible = 36;  // exp(-36) is below the last bit
  const PairRecord& p = m.pairs()[pair];
  const Pose &A = d.geom_poses[p.a], &B = d.geom_poses[p.b];
  const Result r = distance(d.geoms[p.a].shape, A, d.geoms[p.b].shape, B, *d.collision_workspace);
  Manifold points;
  contacts(d.geoms[p.a].shape, A, d.geoms[p.b].shape, B, r, r.distance + negligible * smoothing, points);
  double sum = 0;
  for (int i = 0; i < points.count; ++i) sum += math::exp((r.distance - points.points[i].distance) / smoothing);
  out = points.count > 0 ? r.distance - smoothing * math::log(sum) : r.distance;
  for (int i = 0; gradient && i < points.count; ++i) {
    const Contact& c = points.points[i];
    Result at = r;
    at.point_a = c.position - r.normal * (c.distance / 2), at.point_b = c.position + r.normal * (c.distance / 2);
    add_gradient(m, d, pair, at, math::exp((r.distance - c.distance) / smoothing) / sum, gradient, stride);
  }
  return points.count;
}

}  // namespace dyn::collision
