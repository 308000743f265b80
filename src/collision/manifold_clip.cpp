#include "collision/manifold.hpp"
#include "collision/manifold_clip.hpp"
#include "shape/list.hpp"

namespace dyn::collision {

void planar_feature_of(const shape::Shape& s, const Pose& X, const ContactPlane& plane, double towards, double band,
                       shape::Feature& feature, PlanarFeature& out) {
  const Vec local = transpose_times(X.R, plane.n * towards);
  shape::visit(s, [&]<class S>(const S& x) {
    if constexpr (S::type != shape::Type::HalfSpace) x.facing(local, band, feature);
  });
  project(feature, X, plane, towards, out);
  out.h += towards * s.radius;
  if (out.count > 2) orient(out);
}

void overlap_of(const PlanarFeature& a, double curvature_a, const PlanarFeature& b, double curvature_b, double eps,
                Overlap& out) {
  if (a.count > 2 && b.count > 2) return clip_faces(a, b, eps, out);
  if (a.count == 2 && b.count == 2) return clip_lines(a, b, curvature_a, curvature_b, eps, out);
  if (a.count == 2 && b.count > 2) return clip_line(a, b, eps, false, out);
  if (b.count == 2 && a.count > 2) return clip_line(b, a, eps, true, out);
}

void clip_against_plane(const PlanarFeature& f, double plane, bool swapped, Overlap& out) {
  for (int k = 0; k < f.count; ++k) {
    const Corner& p = f.p[k];
    const double high = f.height(p.x, p.y);
    if (swapped)
      out.add({p.x, p.y, plane, high - plane});
    else
      out.add({p.x, p.y, high, plane - high});
  }
}

void clip_faces(const PlanarFeature& a, const PlanarFeature& b, double eps, Overlap& out) {
  struct Point {
    double x, y;
  };
  Point buffers[2][Overlap::most];
  Point *from = buffers[0], *to = buffers[1];
  int count = a.count;
  for (int k = 0; k < count; ++k) from[k] = {a.p[k].x, a.p[k].y};
  for (int k = 0; k < b.count && count > 0; ++k) {
    int kept = 0;
    auto keep = [&](double x, double y) {
      if (kept < Overlap::most) to[kept++] = {x, y};
    };
    const Edge edge(b.p[k], b.p[k + 1 < b.count ? k + 1 : 0]);
    auto inside = [&](const Point& p) { return edge.inner(p.x, p.y); };
    double here = inside(from[0]);
    for (int i = 0; i < count; ++i) {
      const Point &p = from[i], &q = from[i + 1 < count ? i + 1 : 0];
      const double there = inside(q);
      if (here >= -eps) keep(p.x, p.y);
      if ((here > eps && there < -eps) || (here < -eps && there > eps)) {
        const double t = here / (here - there);
        keep(p.x + t * (q.x - p.x), p.y + t * (q.y - p.y));
      }
      here = there;
    }
    count = kept;
    std::swap(from, to);
  }
  for (int i = 0; i < count; ++i) {
    const double high = a.height(from[i].x, from[i].y);
    out.add({from[i].x, from[i].y, high, b.height(from[i].x, from[i].y) - high});
  }
}

void clip_line(const PlanarFeature& line, const PlanarFeature& face, double eps, bool swapped, Overlap& out) {
  const Corner &p = line.p[0], &q = line.p[1];
  double low = 0, high = 1;
  for (int k = 0; k < face.count; ++k) {
    const Edge edge(face.p[k], face.p[k + 1 < face.count ? k + 1 : 0]);
    const double at_p = edge.inner(p.x, p.y), at_q = edge.inner(q.x, q.y);
    if (at_p < -eps && at_q < -eps) return;
    if (at_p < -eps) low = std::max(low, at_p / (at_p - at_q));
    if (at_q < -eps) high = std::min(high, at_p / (at_p - at_q));
  }
  if (low > high) return;
  for (const double t : {low, high}) {
    const double x = p.x + t * (q.x - p.x), y = p.y + t * (q.y - p.y), on_line = line.height(x, y), on_face = face.height(x, y);
    if (swapped)
      out.add({x, y, on_face, on_line - on_face});
    else
      out.add({x, y, on_line, on_face - on_line});
  }
}

void clip_lines(const PlanarFeature& a, const PlanarFeature& b, double curvature_a, double curvature_b, double eps,
                Overlap& out) {
  auto ends = [&](const PlanarFeature& of, const PlanarFeature& over, double curvature_radius, bool swapped) {
    const double ex = over.p[1].x - over.p[0].x, ey = over.p[1].y - over.p[0].y, length = shape::length2(ex, ey);
    const double steeper = std::sqrt(1 + over.gx * over.gx + over.gy * over.gy);  // the cross section is an ellipse
    for (const Corner& p : {of.p[0], of.p[1]}) {
      const double rx = p.x - over.p[0].x, ry = p.y - over.p[0].y;
      const double along = (rx * ex + ry * ey) / length, beside = std::abs(rx * ey - ry * ex) / length;
      if (along < -eps || along > length + eps || beside > std::max(curvature_radius, eps)) continue;
      const double falls =
          curvature_radius > 0
              ? steeper * (curvature_radius - std::sqrt(std::max(0.0, curvature_radius * curvature_radius - beside * beside)))
              : 0;
      const double x = over.p[0].x + ex * (along / length), y = over.p[0].y + ey * (along / length);
      const double own = of.height(p.x, p.y), other = over.height(x, y) + (swapped ? -falls : falls);
      if (swapped)
        out.add({p.x, p.y, other, own - other});
      else
        out.add({p.x, p.y, own, other - own});
    }
  };
  ends(a, b, curvature_b, false), ends(b, a, curvature_a, true);
}

void merge(Overlap& o, double eps) {
  int kept = 0;
  const auto apart = [&](const ClipPoint& a, const ClipPoint& b) {
    const double x = a.x - b.x, y = a.y - b.y;
    return x * x + y * y > eps * eps;
  };
  for (int i = 0; i < o.count; ++i) {
    int same = 0;
    while (same < kept && apart(o.p[same], o.p[i])) ++same;
    if (same == kept) o.p[kept++] = o.p[i];
    if (o.p[i].gap < o.p[same].gap) o.p[same] = o.p[i];
  }
  o.count = kept;
}

// Monotone chain: Andrew, Inf. Proc. Letters 9(5), 1979.
void hull(Overlap& o, double eps) {
  if (o.count < 3) return;
  std::sort(o.p, o.p + o.count, [](const ClipPoint& a, const ClipPoint& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  ClipPoint deepest = o.p[0], ring[Overlap::most + 1];
  for (int i = 1; i < o.count; ++i)
    if (o.p[i].gap < deepest.gap) deepest = o.p[i];
  int count = 0, first = 0;
  auto take = [&](const ClipPoint& p) {
    while (count - first >= 2) {
      const ClipPoint &a = ring[count - 2], &b = ring[count - 1];
      const double ex = p.x - a.x, ey = p.y - a.y;
      if (ex * (b.y - a.y) - ey * (b.x - a.x) < -eps * shape::length2(ex, ey)) break;  // b lies to the right: keep it
      --count;
    }
    ring[count++] = p;
  };
  for (int i = 0; i < o.count; ++i) take(o.p[i]);
  first = count - 1;
  for (int i = o.count - 2; i >= 0; --i) take(o.p[i]);
  --count;  // the first point again
  o.count = count;
  for (int i = 0; i < count; ++i) o.p[i] = ring[i];
  for (int i = 0; i < count; ++i)
    if (o.p[i].gap <= deepest.gap + eps) return;
  o.insert(deepest);
}

// Drops the point whose triangle with its neighbours is least, again and again.
void reduce_points(Overlap& o, int most, double eps) {
  if (o.count <= most) return;
  // the deepest stays if no other is as deep
  int deepest, as_deep;
  double depth;
  const auto sound = [&] {
    deepest = as_deep = 0;
    for (int i = 1; i < o.count; ++i)
      if (o.p[i].gap < o.p[deepest].gap) deepest = i;
    depth = o.p[deepest].gap + eps;
    for (int i = 0; i < o.count; ++i) as_deep += o.p[i].gap <= depth;
  };
  double area[Overlap::most];
  const auto measure = [&](int i) {
    const ClipPoint &l = o.p[i > 0 ? i - 1 : o.count - 1], &r = o.p[i + 1 < o.count ? i + 1 : 0], &p = o.p[i];
    area[i] = std::abs((p.x - l.x) * (r.y - l.y) - (p.y - l.y) * (r.x - l.x));
  };
  sound();
  for (int i = 0; i < o.count; ++i) measure(i);
  while (o.count > most) {
    const int kept = as_deep > 1 ? -1 : deepest;
    int least = -1;
    double smallest = shape::infinity;
    for (int i = 0; i < o.count; ++i)
      if (i != kept && area[i] < smallest * (1 - 1e-6)) smallest = area[i], least = i;
    if (least < 0) least = kept == 0 ? 1 : 0;  // all on one line
    as_deep -= o.p[least].gap <= depth;
    std::copy(o.p + least + 1, o.p + o.count, o.p + least), std::copy(area + least + 1, area + o.count, area + least);
    --o.count;
    if (deepest == least)
      sound();
    else if (deepest > least)
      --deepest;
    measure(least > 0 ? least - 1 : o.count - 1), measure(least < o.count ? least : 0);
  }
}

}  // namespace dyn::collision
