// Newton refinement of the separating normal. GJK and EPA know support points alone and converge slowly on curved boundaries.
//
// The signed distance is max f(n), f(n) = -h(n), over unit normals n; h is the support function of D = A - B. At the maximum one
// to three smooth pieces i of D's boundary hold the plane. Their support points s_i(n) have equal height, and their weighted sum
// is parallel to n:
//   n.(s_i - s_1) = 0,    P sum_i m_i s_i(n) = 0,    sum_i m_i = 1,    P the projection across n.
// With H_i = ds_i/dn (curvature, H_i n = 0), y = sum m_i s_i, f = -n.s_1, e_i = P (s_i - s_1), the Newton step (d, dm) with d.n =
// 0 is
//   (sum m_i H_i + f) d + sum_i dm_i e_i = -P y,    e_i.d = -n.(s_i - s_1).
#pragma once

#include "collision/simplex.hpp"

namespace dyn::collision {

struct Refined {
  Vec normal, a, b;   // witness points on the two cores
  double distance;    // f
  double residual;    // norm of the residual of the equations above
  bool unique;        // f decreases in every direction
};

namespace detail {

// An iterate of the equations for given pieces, each represented by a point.
template <class D>
struct Pieces {
  const D* difference;
  Vertex s[3];
  double weight[3];
  int size;
  Vec n, y;
  double f, residual;
  // the next step
  Vec next;
  double change[3];    // of the weights
  double length;       // of the normal
  bool near;           // it is the full Newton step
  bool flat;           // f is constant in some direction

  // Evaluates all pieces at a normal. Merges pieces that have become one.
  void evaluate(const Vec& normal) {
    const D& d = *difference;
    n = normal;
    const Vec against = d.Rt * -n;
    int kept = 0;
    for (int i = 0; i < size; ++i) {
      const Vertex p = d.support_on_piece(s[i], n, against);
      auto apart = [&](const Vertex& q) {
        const Vec e = p.w - q.w;
        return dot(e, e) > 1e-24 * (dot(p.w, p.w) + d.small * d.small);
      };
      int same = 0;
      while (same < kept && apart(s[same])) ++same;
      if (same < kept)
        weight[same] += weight[i];
      else
        s[kept] = p, weight[kept++] = weight[i];
    }
    size = kept;
    if (size == 3) drop_middle();
    f = -dot(n, s[0].w);
    y = Vec::zero();
    double uneven = 0;
    for (int i = 0; i < size; ++i) y += s[i].w * weight[i], uneven = std::max(uneven, std::abs(dot(n, s[i].w) + f));
    residual = shape::norm(y + n * -dot(n, y)) + uneven;
  }

  // Steps uphill also where f is not concave.
  void compute_step() {
    const Vec u = shape::across(n), v = cross(n, u);
    change[0] = change[1] = change[2] = 0, near = true, flat = false;
    const shape::CurvatureRadii H = difference->curvature_radii(s, weight, size, n, u, v);
    const double a = H.uu + f, b = H.uv, c = H.vv + f, gu = -dot(u, y), gv = -dot(v, y);
    double du, dv;
    if (size == 1) {
      const double mean = (a + c) / 2, least = mean - std::sqrt((a - c) * (a - c) / 4 + b * b),
                   shift = positive_curvature(least, mean) - least;
      const double as = a + shift, cs = c + shift, det = as * cs - b * b;
      du = (cs * gu - b * gv) / det, dv = (as * gv - b * gu) / det;
    } else if (size == 2) {
      const Vec e = s[1].w - s[0].w;
      const double eu = dot(u, e), ev = dot(v, e), ee = eu * eu + ev * ev;
      // along e from the heights, across e from the gradient
      const double along = -dot(n, e) / ee, across = (a * ev * ev - 2 * b * eu * ev + c * eu * eu) / ee,
                   curved = positive_curvature(across, across);
      const double ru = gu - along * (a * eu + b * ev), rv = gv - along * (b * eu + c * ev);
      const double side = (rv * eu - ru * ev) / ee / curved;
      du = along * eu - side * ev, dv = along * ev + side * eu;
      const double dm = ((gu - a * du - b * dv) * eu + (gv - b * du - c * dv) * ev) / ee;
      change[1] = dm, change[0] = -dm;
    } else {
      const Vec e = s[1].w - s[0].w, g = s[2].w - s[0].w;
      const double eu = dot(u, e), ev = dot(v, e), hu = dot(u, g), hv = dot(v, g), det = eu * hv - ev * hu;
      const double re = -dot(n, e), rg = -dot(n, g);
      du = (re * hv - rg * ev) / det, dv = (rg * eu - re * hu) / det;
      const double ru = gu - a * du - b * dv, rv = gv - b * du - c * dv;
      const double me = (ru * hv - rv * hu) / det, mg = (rv * eu - ru * ev) / det;
      change[1] = me, change[2] = mg, change[0] = -me - mg;
    }
    length = std::sqrt(du * du + dv * dv);
    const double shorter = std::min(1.0, 0.3 / length);
    near = near && shorter == 1;
    next = n + u * (du * shorter) + v * (dv * shorter);
    next = next * (1 / shape::norm(next));
  }
  void apply_step() {
    for (int i = 0; i < size; ++i) weight[i] += change[i];
    evaluate(next);
  }

  // Whether the plane across n separates the shapes by more than their reach.
  bool is_beyond() const {
    const D& d = *difference;
    return f > d.reach && d.is_beyond(-dot(n, d.support(n).w));
  }

 private:
  // Drops the middle one of three collinear points.
  void drop_middle() {
    const Vec p = s[1].w - s[0].w, q = s[2].w - s[0].w, area = cross(p, q);
    const double longest2 = dot(p, p) + dot(q, q);
    if (dot(area, area) > 1e-17 * longest2 * longest2) return;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      const Vec e = s[k].w - s[j].w, g = s[i].w - s[j].w;
      const double t = dot(e, g) / dot(e, e);
      if (t <= 0 || t >= 1 || shape::norm(g - e * t) > 1e-9 * shape::norm(e)) continue;
      weight[j] += (1 - t) * weight[i], weight[k] += t * weight[i];
      s[i] = s[2], weight[i] = weight[2];
      size = 2;
      return;
    }
  }
  // Absolute value of a curvature, bounded below.
  double positive_curvature(double curvature, double mean) {
    const double size = std::abs(f) + std::abs(mean);
    near = curvature > 0, flat = curvature <= 1e-7 * size;
    return std::max(std::abs(curvature), 1e-9 * size + 1e-300);
  }
};

}  // namespace detail

namespace detail {

// Newton's iteration. Where f is nearly flat (coaxial cylinders) it wanders, so the best iterate is kept.
template <class D>
inline bool solve(Pieces<D>& p, double wanted, double acceptable) {
  Pieces<D> best = p;
  const double first = p.residual;
  double before = shape::infinity, least = shape::infinity;
  for (int i = 0, stale = 0; i < 40 && stale < 8; ++i) {
    if (!(p.residual < shape::infinity)) break;
    if (p.is_beyond()) return true;
    p.compute_step();
    // where f is nearly flat, a small residual does not make the normal accurate
    if (p.residual <= 0.1 * wanted && (p.length <= 1e-8 || p.flat)) return true;
    if (p.residual <= std::min(acceptable, best.residual)) best = p;
    stale = p.residual < least ? 0 : stale + 1;
    least = std::min(least, p.residual);
    if (i == 6 && least > 0.1 * first) break;  // no root is near
    const bool slow = p.near && p.residual >= before * 0.5;
    if (slow ? i > 2 && least <= acceptable : p.residual <= wanted && !p.near) break;
    before = p.residual;
    p.apply_step();
    // quadratic convergence: the next step shrinks as the residual does
    if (p.near && !p.flat && p.residual <= 0.1 * wanted && p.length * p.residual <= 1e-9 * before) return true;
  }
  p = best;
  return p.residual <= acceptable;
}

}  // namespace detail

// Solution on a flat face of one shape, above the support point of the other. It is the face normal, where f has a kink and the
// equations have no root.
template <class D>
inline bool on_face(const D& d, const Vec& n, Refined& out) {
  using A = std::decay_t<decltype(d.A_)>;
  using B = std::decay_t<decltype(d.B_)>;
  if constexpr (A::has_faces) {
    const shape::Face face = d.A_.face(n);
    if (face.exists) {
      const Vec m = face.normal, b = d.X.act(d.B_.support(d.Rt * -m));
      if (d.A_.under_face(m, b)) {
        const double distance = dot(m, b - d.A_.support(m));
        out = {m, b - m * distance, b, distance, 0, true};
        return true;
      }
    }
  }
  if constexpr (B::has_faces) {
    const shape::Face face = d.B_.face(d.Rt * -n);
    if (face.exists) {
      const Vec m = d.X.R * -face.normal, a = d.A_.support(m);
      if (d.B_.under_face(face.normal, d.X.act_inverse(a))) {
        const double distance = dot(m, d.X.act(d.B_.support(face.normal)) - a);
        out = {m, a, a + m * distance, distance, 0, true};
        return true;
      }
    }
  }
  return false;
}

// From support points near the solution, their weights, and a normal. Returns false if no solution was found. Ends early where a
// plane separates the shapes by more than their reach; the distance is then a lower bound.
template <class D>
[[gnu::noinline]] inline bool newton_refine(const D& d, const Vertex* points, const double* weights, int size, const Vec& normal,
                                            double wanted, Refined& out) {
  detail::Pieces<D> p{&d, {}, {}, size, {}, {}, 0, 0, {}, {}, 0, true, false};
  for (int i = 0; i < size; ++i) p.s[i] = points[i], p.weight[i] = weights[i];
  p.evaluate(normal);
  if (!detail::solve(p, wanted, std::max(wanted, 1e-7 * d.small))) return false;
  out.normal = p.n, out.residual = p.residual, out.unique = !p.flat;
  out.a = out.b = Vec::zero();
  double sum = 0;
  for (int i = 0; i < p.size; ++i) {
    if (p.weight[i] * d.large < -1e-8 * d.small) return false;
    const double weight = std::max(0.0, p.weight[i]);
    out.a += p.s[i].a * weight, out.b += p.s[i].b * weight, sum += weight;
  }
  out.a = out.a * (1 / sum), out.b = out.b * (1 / sum);
  // the pieces must hold the plane: no part of D lies beyond it
  const double h = dot(p.n, d.support(p.n).w);
  out.distance = -h;
  // a clamped weight moves the points off the normal, which is then not unique
  const Vec between = out.b - out.a;
  if (shape::norm(between + p.n * h) > 1e-7 * std::abs(h) + 8 * d.rounding()) out.unique = false;
  return h + p.f <= std::max(wanted, p.residual) || d.is_beyond(-h);
}

}  // namespace dyn::collision
