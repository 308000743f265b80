// The shortest way between two points around a circle, and from it around a sphere or an endless cylinder (Garner and Pandy
// 2000, "The obstacle-set method for representing muscle paths in musculoskeletal models"). In the plane of the circle, about
// its centre, a tangent from the point d, |d| = L, touches at
//   t = (r^2 d +- r sqrt(L^2 - r^2) n) / L^2        n = (d_y, -d_x)
#pragma once

#include <algorithm>
#include <cmath>

#include "base/portable.hpp"
#include "spatial/mat3.hpp"

namespace dyn {

template <class T>
struct Vec2 {
  T x, y;
  friend DYN_INLINE Vec2 operator+(const Vec2& a, const Vec2& b) { return {a.x + b.x, a.y + b.y}; }
  friend DYN_INLINE Vec2 operator-(const Vec2& a, const Vec2& b) { return {a.x - b.x, a.y - b.y}; }
  friend DYN_INLINE Vec2 operator*(const Vec2& a, T s) { return {a.x * s, a.y * s}; }
  friend DYN_INLINE T dot(const Vec2& a, const Vec2& b) { return a.x * b.x + a.y * b.y; }
  friend DYN_INLINE T det(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }
};

// Points where the path meets and leaves the circle, and its length between them.
template <class T>
struct Arc {
  bool touches;
  Vec2<T> first, last;
  T length;
};

namespace detail {

inline constexpr double smallest_wrap = 1e-15;  // m and m^2: below it there is no circle, or no way between the points

template <class T>
T size(const Vec2<T>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

// Whether the segments a b and c d cross.
template <class T>
bool cross_each_other(const Vec2<T>& a, const Vec2<T>& b, const Vec2<T>& c, const Vec2<T>& d) {
  using std::abs;
  const Vec2<T> u = b - a, w = d - c, from = a - c;
  const T all = det(u, w);
  if (abs(all) < T(smallest_wrap)) return false;
  const T s = det(w, from) / all, t = det(u, from) / all;
  return s >= T(0) && s <= T(1) && t >= T(0) && t <= T(1);
}

// The point of the segment a b that is nearest to the centre.
template <class T>
Vec2<T> nearest(const Vec2<T>& a, const Vec2<T>& b) {
  const Vec2<T> along = b - a;
  return a + along * std::clamp(-dot(along, a) / dot(along, along), T(0), T(1));
}

}  // namespace detail

// Around the outside, on the shorter side. Where the centre lies between the segment and the direction `side`, on the far one.
template <class T>
Arc<T> wrap_outside(const Vec2<T>& a, const Vec2<T>& b, T r, const Vec2<T>* side) {
  using namespace detail;
  using std::abs;
  using std::sqrt;
  using math::atan2;
  const Arc<T> straight{false, a, b, T(0)};
  const T a2 = dot(a, a), b2 = dot(b, b), r2 = r * r;
  if (a2 < r2 || b2 < r2 || r < T(smallest_wrap) || dot(b - a, b - a) < T(smallest_wrap)) return straight;
  const Vec2<T> at = nearest(a, b);
  const T turns = det(a, b);
  const bool through = side && abs(turns) <= T(1e-12) * sqrt(a2 * b2);  // the centre: both ways are as long
  const bool far = side && turns * det(b, *side) > T(0) && turns * det(*side, a) > T(0);
  if (dot(at, at) > r2 && !far) return straight;
  // angles between a and b, and of it beside the straight pieces
  const T between = atan2(abs(turns), dot(a, b)), free = atan2(sqrt(a2 - r2), r) + atan2(sqrt(b2 - r2), r);
  Arc<T> best = straight;
  T most = T(-HUGE_VAL);
  for (const T turn : {T(1), T(-1)}) {  // clockwise, and the other way
    const T at_a = turn * r * sqrt(a2 - r2), at_b = -turn * r * sqrt(b2 - r2);
    const Vec2<T> first = (a * r2 + Vec2<T>{a.y, -a.x} * at_a) * (T(1) / a2),
                  last = (b * r2 + Vec2<T>{b.y, -b.x} * at_b) * (T(1) / b2);
    const Vec2<T> sum = first + last, apart = first - last;
    const bool crossed = cross_each_other(a, first, b, last);
    const T good = crossed ? T(-1e4) : through ? dot(sum, *side) : far ? turn * turns : -dot(apart, apart);
    if (!(good > most)) continue;
    const T around = turn * turns > T(0) ? T(2 * 3.14159265358979323846) - between : between;
    most = good, best = {!crossed, first, last, r * std::max(T(0), around - free)};
  }
  return best.touches ? best : straight;
}

// Through the inside: the shortest way that touches the circle at one point, between the directions of a and b. Its angle x
// from a makes |a - e| + |e - b| stationary.
template <class T>
Arc<T> wrap_inside(const Vec2<T>& a, const Vec2<T>& b, T r) {
  using namespace detail;
  using std::abs;
  using std::sqrt;
  using math::atan2;
  using math::cos;
  using math::sin;
  const Arc<T> straight{false, a, b, T(0)};
  const T la = size(a), lb = size(b);
  if (la <= r || lb <= r || r < T(smallest_wrap)) return straight;
  if (const Vec2<T> along = b - a; dot(along, along) > T(smallest_wrap)) {
    const Vec2<T> at = nearest(a, b);
    if (size(at) <= r) return straight;
  }
  const T between = atan2(abs(det(a, b)), dot(a, b)), turn = det(a, b) < T(0) ? T(-1) : T(1);
  if (T(3.14159265358979323846) - between < T(1e-7)) return straight;
  // derivative of the length by x, over r; it rises
  const auto slope = [&](T x, T& bend) {
    T sum = T(0);
    bend = T(0);
    const auto add = [&](T l, T angle, T sign) {
      const T s = sin(angle), c = cos(angle), far = sqrt(l * l + r * r - T(2) * l * r * c);
      sum += sign * l * s / far, bend += l * c / far - l * s * (l * r * s) / (far * far * far);
    };
    add(la, x, T(1)), add(lb, between - x, T(-1));
    return sum;
  };
  T low = T(0), high = between, x = between / T(2);
  for (int k = 0; k < 60; ++k) {
    T bend;
    const T s = slope(x, bend);
    (s > T(0) ? high : low) = x;
    T next = bend > T(0) ? x - s / bend : low;
    if (!(next > low && next < high)) next = (low + high) / T(2);
    const bool found = abs(next - x) <= T(1e-16) * between;
    x = next;
    if (found) break;
  }
  const T c = cos(turn * x), s = sin(turn * x), unit = r / la;
  const Vec2<T> at = Vec2<T>{c * a.x - s * a.y, s * a.x + c * a.y} * unit;
  return {true, at, at, T(0)};
}

// The way between two points around a sphere or a cylinder.
template <class T>
struct Wrap {
  bool touches;
  Vec3<T> first, last;
  T length;  // between first and last
};

// a, b and side (or nullptr) in the axes of the surface, about its centre; a cylinder is along z.
template <class T>
Wrap<T> wrap_around(bool cylinder, const Vec3<T>& a, const Vec3<T>& b, T r, const Vec3<T>* side) {
  using std::abs;
  using std::sqrt;
  const auto length = [](const Vec3<T>& x) { return sqrt(dot(x, x)); };
  const Wrap<T> straight{false, a, b, T(0)};
  const T la = length(a), lb = length(b);
  if (la < T(detail::smallest_wrap) || lb < T(detail::smallest_wrap)) return straight;
  Vec3<T> x = Vec3<T>::make(T(1), T(0), T(0)), y = Vec3<T>::make(T(0), T(1), T(0));  // axes of the plane
  if (!cylinder) {
    x = a * (T(1) / la);
    Vec3<T> normal = cross(a, b);
    if (length(normal) < T(detail::smallest_wrap)) {  // any plane will do: that of the axes that x is least along
      int largest = 0;
      for (int i = 1; i < 3; ++i)
        if (abs(x[i]) > abs(x[largest])) largest = i;
      normal = cross(x, Vec3<T>::make(T(largest != 0), T(largest != 1), T(largest != 2)));
    }
    y = cross(normal, x);
    y = y * (T(1) / length(y));
  }
  const auto flat = [&](const Vec3<T>& p) { return Vec2<T>{dot(p, x), dot(p, y)}; };
  Vec2<T> prefers{};
  if (side) {
    prefers = flat(*side);
    prefers = prefers * (T(1) / std::max(detail::size(prefers), T(detail::smallest_wrap)));
  }
  const Vec2<T> p = flat(a), q = flat(b);
  const Arc<T> arc = side && length(*side) < r ? wrap_inside(p, q, r) : wrap_outside(p, q, r, side ? &prefers : nullptr);
  if (!arc.touches) return straight;
  Wrap<T> out{true, x * arc.first.x + y * arc.first.y, x * arc.last.x + y * arc.last.y, arc.length};
  if (cylinder) {  // a straight line on the unrolled surface
    const T before = detail::size(p - arc.first), after = detail::size(q - arc.last), all = before + arc.length + after;
    const T rise = all > T(0) ? (b[2] - a[2]) / all : T(0);
    const Vec3<T> z = Vec3<T>::make(T(0), T(0), T(1));
    out.first = out.first + z * (a[2] + rise * before), out.last = out.last + z * (a[2] + rise * (before + arc.length));
    out.length = arc.length * sqrt(T(1) + rise * rise);
  }
  return out;
}

}  // namespace dyn
