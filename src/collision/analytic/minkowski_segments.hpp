// Separated capsules, boxes and cylinders. Each is a Minkowski sum of segments along its axes and a disc across its z; so is D =
// A
// - B. The gap along n is
//   f(n) = n.p - sum_k l_k |n.e_k| - sum_m r_m sqrt(1 - (n.z_m)^2),
// and the distance is its maximum. Where f > 0 it has one local maximum, which is found piece by piece. For given signs of n.e_k
// a point c and the discs remain. n moves to the maximum of this piece, or to the first n.e_k = 0 on the way. There it stays
// perpendicular to e_k while the foot lies within that segment (|t| <= l_k).
#pragma once

#include "collision/analytic/segments.hpp"
#include "collision/convex_pair.hpp"
#include "shape/box.hpp"
#include "shape/capsule.hpp"
#include "shape/cylinder.hpp"

namespace dyn::collision {

struct SegmentSum {
  Vec half;     // half lengths of the segments along x, y, z
  double disc;  // radius about z
};
inline SegmentSum segment_sum(const shape::Box& s) { return {s.half, 0}; }
inline SegmentSum segment_sum(const shape::Capsule& s) { return {shape::axis(2) * s.half, 0}; }
inline SegmentSum segment_sum(const shape::Cylinder& s) { return {shape::axis(2) * s.half, s.r}; }

template <class S>
inline constexpr bool is_segment_sum =
    S::type == shape::Type::Box || S::type == shape::Type::Capsule || S::type == shape::Type::Cylinder;

// disc_a, disc_b: which of the two has a disc
template <bool disc_a, bool disc_b>
class MinkowskiPair {
 public:
  MinkowskiPair(const SegmentSum& a, const SegmentSum& b, const Pose& X) : a_(a), b_(b), R_(X.R), Rt_(transpose(X.R)), p_(X.p) {}

  // Starts from a direction, perpendicular to the segments `first` of A and `second` of B unless these are -1. Returns false if
  // the shapes overlap or no maximum was found.
  bool solve(const Vec& guess, int first, int second, Cores& out) {
    n_ = guess;
    const Vec in_b = Rt_ * n_;
    for (int k = 0; k < 6; ++k) {
      length_[k] = k < 3 ? a_.half[k] : b_.half[k - 3];
      height_[k] = k < 3 ? n_[k] : in_b[k - 3];
      place_[k] = std::copysign(length_[k], height_[k]);
    }
    if (first >= 0) across_[fixed_++] = first, place_[first] = 0;
    if (second >= 0) across_[fixed_++] = second + 3, place_[second + 3] = 0;
    for (steps_ = 1; steps_ <= max_steps; ++steps_) {
      c_ = p_ - Vec::make(place_[0], place_[1], place_[2]) - R_ * Vec::make(place_[3], place_[4], place_[5]);
      const Vec from = n_;
      if (!maximise_piece()) return false;
      if (stop_at_sign_change(from) || release_segment()) continue;
      return finish(out);
    }
    return false;
  }

 private:
  static constexpr int max_steps = 12;
  static constexpr double straight = 1e-6;  // sine of an angle too small to divide by
  const SegmentSum a_, b_;
  const Mat R_, Rt_;
  const Vec p_;
  Vec n_, c_;
  Vec foot_;          // c less the points of the discs
  Vec on_a_, on_b_;   // points of the discs
  double sine_;       // smaller sine between n and the discs' axes: the angle over which the rims bend
  double length_[6], height_[6];  // half lengths of the segments, and n.e_k
  double place_[6];   // position of the foot along each segment
  int across_[2], fixed_ = 0;  // segments perpendicular to n
  int steps_;

  Vec axis_of(int k) const { return k < 3 ? shape::axis(k) : R_[k - 3]; }
  bool is_fixed(int k) const { return (fixed_ > 0 && across_[0] == k) || (fixed_ > 1 && across_[1] == k); }

  // Support point of a disc about z along n. Returns the sine of the angle between n and z.
  static double rim(const Vec& n, const Vec& z, double r, Vec& point) {
    const double height = dot(n, z);
    const Vec across = n - z * height;
    const double sine = shape::norm(across);
    point = across * (r / sine);
    return sine;
  }
  // Moves n_ to the maximum of this piece.
  bool maximise_piece() {
    if (fixed_ == 2) {
      const Vec n = cross(axis_of(across_[0]), axis_of(across_[1]));
      const double sine = shape::norm(n);
      if (sine < straight) return false;
      n_ = n * (std::copysign(1.0, dot(n, c_)) / sine);
      return at_rims();
    }
    return fixed_ == 1 ? maximise_across_segment(axis_of(across_[0])) : maximise_free();
  }
  // Sets the support points of the discs at n_. Returns false if the shapes overlap or n is a disc's axis.
  bool at_rims() {
    foot_ = c_, sine_ = 1;
    if constexpr (disc_a) sine_ = std::min(sine_, rim(n_, shape::axis(2), a_.disc, on_a_));
    if constexpr (disc_b) sine_ = std::min(sine_, rim(n_, R_.z, b_.disc, on_b_));
    if (!(sine_ > straight)) return false;
    if constexpr (disc_a) foot_ -= on_a_;
    if constexpr (disc_b) foot_ -= on_b_;
    return dot(foot_, n_) > 0;
  }
  // n perpendicular to e: Newton's method on its angle.
  bool maximise_across_segment(const Vec& e) {
    const Vec start = !(disc_a || disc_b) || (disc_a != disc_b && across_[0] == (disc_a ? 2 : 5)) ? c_ : n_;
    n_ = start - e * dot(e, start);
    n_ = n_ * (1 / shape::norm(n_));
    double za = 0, zb = 0;
    if constexpr (disc_a) za = a_.disc * e[2] * e[2];
    if constexpr (disc_b) zb = b_.disc * dot(e, R_.z) * dot(e, R_.z);
    for (int i = 0; i < 10; ++i) {
      if (!at_rims()) return false;
      const Vec m = cross(e, n_);
      const double slope = dot(foot_, m);
      double curvature = dot(foot_, n_);
      auto add = [&](double zz, const Vec& z) {
        const double h = dot(n_, z), s2 = 1 - h * h;
        curvature += zz / (s2 * std::sqrt(s2));
      };
      if constexpr (disc_a) add(za, shape::axis(2));
      if constexpr (disc_b) add(zb, R_.z);
      const double step = slope / curvature;
      if (std::abs(step) <= 1e-15) return true;
      n_ = n_ + m * std::clamp(step, -0.5, 0.5);
      n_ = n_ * (1 / shape::norm(n_));
      if (std::abs(step) <= 1e-7 * sine_) return at_rims();
    }
    return false;
  }
  // Any n: the direction to the nearest point of a disc. Two discs use Newton's method.
  bool maximise_free() {
    if constexpr (!disc_a && !disc_b) {
      foot_ = c_, n_ = c_ * (1 / shape::norm(c_));
      return true;
    }
    const Vec za = shape::axis(2), zb = R_.z;
    if constexpr (disc_a && !disc_b) return toward_disc(za, a_.disc, c_, on_a_), true;
    if constexpr (disc_b && !disc_a) return toward_disc(zb, b_.disc, c_, on_b_), true;
    // alternate nearest points first, which is exact if one lies within its disc
    rim(n_, zb, b_.disc, on_b_);
    if (toward_disc(za, a_.disc, c_ - on_b_, on_a_)) {
      rim(n_, zb, b_.disc, on_b_);
      if (toward_disc(za, a_.disc, c_ - on_b_, on_a_)) return true;
    }
    if (toward_disc(zb, b_.disc, c_ - on_a_, on_b_)) {
      rim(n_, za, a_.disc, on_a_);
      if (toward_disc(zb, b_.disc, c_ - on_a_, on_b_)) return true;
    }
    for (int i = 0; i < 10; ++i) {
      if (!at_rims()) return false;
      const Vec sa = cross(za, n_), sb = cross(zb, n_);
      const double sines_a = dot(sa, sa), sines_b = dot(sb, sb);
      // in the basis of the tangent of A's rim and its normal
      const Vec u = sa * (1 / std::sqrt(sines_a)), v = cross(n_, u);
      const double f = dot(foot_, n_), ka = a_.disc / std::sqrt(sines_a), kb = b_.disc / (sines_b * std::sqrt(sines_b));
      const double bu = dot(sb, u), bv = dot(sb, v), gu = dot(foot_, u), gv = dot(foot_, v);
      const double uu = f + ka + kb * bu * bu, uv = kb * bu * bv, vv = f + kb * bv * bv, det = uu * vv - uv * uv;
      const double du = (vv * gu - uv * gv) / det, dv = (uu * gv - uv * gu) / det, step2 = du * du + dv * dv;
      const double shorter = step2 > 0.25 ? 0.5 / std::sqrt(step2) : 1;
      if (step2 <= 1e-30) return true;
      n_ = n_ + u * (du * shorter) + v * (dv * shorter);
      n_ = n_ * (1 / shape::norm(n_));
      if (step2 <= 1e-14 * sine_ * sine_) return at_rims();
    }
    return false;
  }
  // Sets n_ from the nearest point of a disc to c. Returns whether that point is within the rim.
  bool toward_disc(const Vec& z, double r, const Vec& c, Vec& on) {
    const Vec d = c - z * dot(z, c);
    const double rho = shape::norm(d);
    on = rho > r ? d * (r / rho) : d;
    foot_ = c - on;
    n_ = rho > r ? foot_ * (1 / shape::norm(foot_)) : z * std::copysign(1.0, dot(z, c));
    return rho <= r;
  }

  // Stops n at the first change of sign of n.e_k on the way.
  bool stop_at_sign_change(const Vec& from) {
    const Vec in_b = Rt_ * n_;
    double first = shape::infinity;
    int at = -1;
    double now[6];
    for (int k = 0; k < 6; ++k) {
      now[k] = k < 3 ? n_[k] : in_b[k - 3];
      if (length_[k] == 0 || is_fixed(k) || !(now[k] * place_[k] < 0)) continue;
      const double t = height_[k] / (height_[k] - now[k]);
      if (t < first) first = t, at = k;
    }
    if (at >= 0 && fixed_ < 2) {
      n_ = from + (n_ - from) * first;
      n_ = n_ * (1 / shape::norm(n_));
      place_[at] = 0, across_[fixed_++] = at;
      for (int k = 0; k < 6; ++k) height_[k] += (now[k] - height_[k]) * first;
      return true;
    }
    for (int k = 0; k < 6; ++k) height_[k] = now[k];
    if (at >= 0)
      for (int k = 0; k < 6; ++k)
        if (!is_fixed(k)) place_[k] = std::copysign(length_[k], now[k]);
    return at >= 0;
  }
  // Position of the foot on the segments perpendicular to n. A foot beyond the end is clamped, and n leaves that segment.
  bool release_segment() {
    if (fixed_ == 0) return false;
    const Vec e = axis_of(across_[0]);
    double t[2] = {dot(foot_, e), 0};
    if (fixed_ == 2) {
      const Vec g = axis_of(across_[1]);
      const double eg = dot(e, g), along = dot(foot_, g), det = 1 - eg * eg;
      t[1] = (along - eg * t[0]) / det, t[0] = (t[0] - eg * along) / det;
    }
    double most = 0;
    int out = -1;
    for (int i = 0; i < fixed_; ++i) {
      const double over = std::abs(t[i]) - length_[across_[i]];
      if (over > most) most = over, out = i;
    }
    if (out < 0) {
      for (int i = 0; i < fixed_; ++i) place_[across_[i]] = t[i];
      return false;
    }
    for (int i = 0; i < fixed_; ++i) place_[across_[i]] = 0;
    const int k = across_[out];
    place_[k] = std::copysign(length_[k], t[out]), height_[k] = std::copysign(1e-300, t[out]);
    across_[0] = across_[1 - out], --fixed_;
    return true;
  }
  bool finish(Cores& out) const {
    Vec a = Vec::make(place_[0], place_[1], place_[2]), b = p_ - R_ * Vec::make(place_[3], place_[4], place_[5]);
    if constexpr (disc_a) a += on_a_;
    if constexpr (disc_b) b -= on_b_;
    out.normal = n_, out.a = a, out.b = b, out.iterations = steps_, out.unique = true;
    return true;
  }
};

// The nearest points of the axes of two capsules or cylinders.
template <class D>
inline SegmentPair nearest_on_axes(const D& d) {
  return nearest_on_segments(shape::axis(2), d.A_.half, d.X.p, d.X.R.z, d.B_.half);
}

// Whether a cylinder's axis and those of the other shape are nearly parallel or square, as where one lies on the other.
template <class D>
inline bool lie_flat(const D& d) {
  constexpr double angle = 0.01;
  const Vec cosines = sizes(d.X.R.z);
  if constexpr (D::First::type == shape::Type::Box) return shape::smallest(cosines) < angle;
  return cosines[2] < angle || cosines[2] > 1 - angle * angle / 2;
}
// Direction from A to B: between the axes of cylinders, whose sides may cross or lie along each other, or the centres.
template <class D>
inline Vec start_between(const D& d) {
  if constexpr (D::First::type == shape::Type::Box) return d.X.p;
  else {
    const SegmentPair s = nearest_on_axes(d);
    return d.X.p + d.X.R.z * s.t - shape::axis(2) * s.s;
  }
}

// Returns false if no solution was found.
template <class A, class B>
inline bool minkowski_pair(const Difference<A, B>& d, const Vec& guess, double enough, Cores& out) {
  const SegmentSum a = segment_sum(d.A_), b = segment_sum(d.B_);
  MinkowskiPair<A::curved, B::curved> pair(a, b, d.X);
  if constexpr (A::type == shape::Type::Box || B::type == shape::Type::Box) {
    if (!pair.solve(guess, -1, -1, out)) return false;
  } else {
    const SegmentPair s = nearest_on_axes(d);
    auto within = [](double at, double half) { return std::abs(at) < half ? 2 : -1; };
    if (!pair.solve(d.X.p + d.X.R.z * s.t - shape::axis(2) * s.s, within(s.s, a.half[2]), within(s.t, b.half[2]), out))
      return false;
  }
  // the witness points give an upper bound, the supporting plane a lower one
  out.distance = -dot(out.normal, d.support(out.normal).w);
  out.residual = shape::norm(out.b - out.a) - out.distance;
  return out.distance > enough && out.residual <= enough;
}

}  // namespace dyn::collision
