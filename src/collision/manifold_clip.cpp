#include "dyn/collision/manifold.hpp"
#include "dyn/collision/manifold_clip.hpp"

namespace dyn::collision {

void clip_faces(const Figure& a, const Figure& b, double eps, Overlap& out) {
  ClipPoint buffers[2][Overlap::most];
  ClipPoint *from = buffers[0], *to = buffers[1];
  int count = a.count;
  for (int k = 0; k < count; ++k) from[k] = {a.p[k].x, a.p[k].y, 0, 0};
  for (int k = 0; k < b.count && count > 0; ++k) {
    int kept = 0;
    auto keep = [&](double x, double y) {
      if (kept < Overlap::most) to[kept++] = {x, y, 0, 0};
    };
    auto inside = [&](const ClipPoint& p) { return inner(b.p[k], b.p[(k + 1) % b.count], p.x, p.y); };
    double here = inside(from[0]);
    for (int i = 0; i < count; ++i) {
      const ClipPoint &p = from[i], &q = from[i + 1 < count ? i + 1 : 0];
      const double there = inside(q), t = here / (here - there);
      if (here >= -eps) keep(p.x, p.y);
      if ((here > eps && there < -eps) || (here < -eps && there > eps)) keep(p.x + t * (q.x - p.x), p.y + t * (q.y - p.y));
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

void clip_line(const Figure& line, const Figure& face, double eps, bool swapped, Overlap& out) {
  const Corner &p = line.p[0], &q = line.p[1];
  double low = 0, high = 1;
  for (int k = 0; k < face.count; ++k) {
    const Corner &a = face.p[k], &b = face.p[(k + 1) % face.count];
    const double at_p = inner(a, b, p.x, p.y), at_q = inner(a, b, q.x, q.y), t = at_p / (at_p - at_q);
    if (at_p < -eps && at_q < -eps) return;
    if (at_p < -eps) low = std::max(low, t);
    if (at_q < -eps) high = std::min(high, t);
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

void clip_lines(const Figure& a, const Figure& b, double bend_a, double bend_b, double eps, Overlap& out) {
  auto ends = [&](const Figure& of, const Figure& over, double bend, bool swapped) {
    const double ex = over.p[1].x - over.p[0].x, ey = over.p[1].y - over.p[0].y, length = shape::length2(ex, ey);
    const double steeper = std::sqrt(1 + over.gx * over.gx + over.gy * over.gy);  // the section across is an ellipse
    for (const Corner& p : {of.p[0], of.p[1]}) {
      const double rx = p.x - over.p[0].x, ry = p.y - over.p[0].y;
      const double along = (rx * ex + ry * ey) / length, beside = std::abs(rx * ey - ry * ex) / length;
      if (along < -eps || along > length + eps || beside > std::max(bend, eps)) continue;
      const double falls = bend > 0 ? steeper * (bend - std::sqrt(std::max(0.0, bend * bend - beside * beside))) : 0;
      const double x = over.p[0].x + ex * (along / length), y = over.p[0].y + ey * (along / length);
      const double own = of.height(p.x, p.y), other = over.height(x, y) + (swapped ? -falls : falls);
      if (swapped)
        out.add({p.x, p.y, other, own - other});
      else
        out.add({p.x, p.y, own, other - own});
    }
  };
  ends(a, b, bend_b, false), ends(b, a, bend_a, true);
}

void merge(Overlap& o, double eps) {
  int kept = 0;
  for (int i = 0; i < o.count; ++i) {
    bool twice = false;
    for (int k = 0; k < kept; ++k) twice |= shape::length2(o.p[k].x - o.p[i].x, o.p[k].y - o.p[i].y) <= eps;
    if (!twice) o.p[kept++] = o.p[i];
  }
  o.count = kept;
}

void thin_out(Overlap& o, int most, double eps) {
  while (o.count > most) {
    int deepest = 0;
    for (int i = 1; i < o.count; ++i)
      if (o.p[i].gap < o.p[deepest].gap) deepest = i;
    for (int i = 0; i < o.count; ++i)
      if (i != deepest && o.p[i].gap <= o.p[deepest].gap + eps) {
        deepest = -1;
        break;
      }
    int least = -1;
    double smallest = shape::infinity;
    for (int i = 0; i < o.count; ++i) {
      const ClipPoint &l = o.p[(i + o.count - 1) % o.count], &r = o.p[(i + 1) % o.count], &p = o.p[i];
      const double area = std::abs((p.x - l.x) * (r.y - l.y) - (p.y - l.y) * (r.x - l.x));
      if (i != deepest && area < smallest * (1 - 1e-6)) smallest = area, least = i;
    }
    if (least < 0) least = deepest == 0 ? 1 : 0;  // all on one line
    std::copy(o.p + least + 1, o.p + o.count, o.p + least);
    --o.count;
  }
}

}  // namespace dyn::collision
