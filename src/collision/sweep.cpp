#include "collision/sweep.hpp"

#include "collision/surface_distance.hpp"
#include "shape/list.hpp"
#include "spatial/explog.hpp"

namespace dyn::collision {

namespace {

// Radius of a core about its origin, without and with rounding. Rounding is no lever: a sphere does not move when it turns about
// its centre.
struct CoreRadii {
  double core, all;
};
CoreRadii core_radii_of(const shape::Shape& s) {
  CoreRadii r{};
  shape::visit(s, [&](const auto& x) { r = {x.extent(), x.extent() + x.radius}; });
  return r;
}

// Bound of the speed along n of a core's points by rotation: n.(w x r) = (n x w).r
double turning(const Vec& n, const Vec& w, double lever) {
  const double speed = shape::norm(cross(n, w));
  return speed > 0 ? speed * lever : 0;
}

}  // namespace

Pose Moving::at(double t) const { return {dot(w, w) > 0 ? exp3(w * t) * X.R : X.R, X.p + v * t}; }

Impact sweep(const Moving& a, const Moving& b, double duration, Workspace& workspace, const SweepOptions& options) {
  const CoreRadii ra = core_radii_of(a.shape), rb = core_radii_of(b.shape);
  const double enough = options.margin + options.tolerance * std::min(ra.all, rb.all);
  Impact out{Impact::Status::None, 0, 0, {}};
  for (;;) {
    out.result = distance(a.shape, a.at(out.time), b.shape, b.at(out.time), workspace);
    const Result& r = out.result;
    const double gap = r.distance > 0 ? r.distance - r.residual : r.distance;
    if (gap <= enough) return out.status = Impact::Status::Hit, out;
    if (++out.steps > options.max_steps) return out.status = Impact::Status::Undecided, out;
    // convex shapes are separated by a plane; other parts of a surface may approach from any direction
    const bool convex = !is_surface(a.shape.type) && !is_surface(b.shape.type);
    const double nearing = convex ? dot(a.v - b.v, r.normal) + turning(r.normal, a.w, ra.core) + turning(r.normal, b.w, rb.core)
                                  : shape::norm(a.v - b.v) + shape::norm(a.w) * ra.core + shape::norm(b.w) * rb.core;
    if (!(nearing > 0) || out.time + (gap - options.margin) / nearing > duration) return out.time = duration, out;
    out.time += (gap - options.margin) / nearing;
  }
}

}  // namespace dyn::collision
