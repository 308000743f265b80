#include "dyn/collision/manifold.hpp"

#include "dyn/collision/manifold_clip.hpp"
#include "dyn/shape/list.hpp"

namespace dyn::collision {

namespace {

// relative to the size of the smaller shape
constexpr double coincident = 1e-7, same_point = 1e-5;

void feature_of(const shape::Shape& s, const Pose& X, const Vec& n, double band, shape::Feature& f) {
  const Vec local = transpose_times(X.R, n);
  shape::visit(s, [&]<class S>(const S& x) {
    if constexpr (S::type != shape::Type::HalfSpace) x.facing(local, band, f);
  });
}
double size_of(const shape::Shape& s) {
  double size = 0;
  shape::visit(s, [&](const auto& x) { size = x.extent() + x.radius; });
  return size;
}

// Over a plane all corners count.
void over_plane(const Figure& f, double plane, bool swapped, Overlap& out) {
  for (int k = 0; k < f.count; ++k) {
    const Corner& p = f.p[k];
    const double high = f.height(p.x, p.y);
    if (swapped)
      out.add({p.x, p.y, plane, high - plane});
    else
      out.add({p.x, p.y, high, plane - high});
  }
}

}  // namespace

void contacts(const shape::Shape& a, const Pose& X_WA, const shape::Shape& b, const Pose& X_WB, double margin, Workspace& workspace,
              Manifold& out, const Options& options) {
  out.count = 0, out.normal = Vec::zero();
  const bool plane_a = a.type == shape::Type::HalfSpace, plane_b = b.type == shape::Type::HalfSpace;
  if (plane_a && plane_b) return;
  const Result r = distance(a, X_WA, b, X_WB, workspace, options);
  if (!(r.distance <= margin)) return;
  out.normal = r.normal;

  const double size = std::min(size_of(a), size_of(b)), eps = coincident * size, same = same_point * size;
  const double band = std::max(margin - r.distance, 0.0) + eps;
  const Across plane(r.normal, r.point_a);
  shape::Feature feature_a, feature_b;
  Figure fa, fb;
  if (!plane_a) feature_of(a, X_WA, r.normal, band, feature_a), fa = project(feature_a, X_WA, plane, 1), fa.h += a.radius;
  if (!plane_b) feature_of(b, X_WB, -r.normal, band, feature_b), fb = project(feature_b, X_WB, plane, -1), fb.h -= b.radius;

  Overlap overlap;
  if (plane_a) {
    over_plane(fb, 0, true, overlap);
  } else if (plane_b) {
    over_plane(fa, r.distance, false, overlap);
  } else if (fa.count > 2 && fb.count > 2) {
    orient(fa), orient(fb);
    clip_faces(fa, fb, eps, overlap);
  } else if (fa.count == 2 && fb.count == 2) {
    clip_lines(fa, fb, feature_a.bend + a.radius, feature_b.bend + b.radius, eps, overlap);
  } else if (fa.count == 2 && fb.count > 2) {
    orient(fb);
    clip_line(fa, fb, eps, false, overlap);
  } else if (fb.count == 2 && fa.count > 2) {
    orient(fa);
    clip_line(fb, fa, eps, true, overlap);
  }

  // within the margin, and the witness points themselves when they are deeper than all that the features show
  int kept = 0;
  double deepest = shape::infinity;
  for (int i = 0; i < overlap.count; ++i) {
    if (!(overlap.p[i].gap <= margin)) continue;
    deepest = std::min(deepest, overlap.p[i].gap);
    overlap.p[kept++] = overlap.p[i];
  }
  overlap.count = kept;
  merge(overlap, same);
  if (deepest > r.distance + eps) overlap.insert({0, 0, 0, r.distance});
  thin_out(overlap, Manifold::most, eps);
  for (int i = 0; i < overlap.count; ++i) {
    const ClipPoint& p = overlap.p[i];
    out.points[out.count++] = {plane.origin + plane.u * p.x + plane.v * p.y + plane.n * (p.high + p.gap / 2), p.gap,
                               std::uint64_t(part_of(fa, p.x, p.y, same)) << 32 | part_of(fb, p.x, p.y, same)};
  }
  std::sort(out.points, out.points + out.count, [](const Contact& x, const Contact& y) { return x.feature < y.feature; });
}

}  // namespace dyn::collision
