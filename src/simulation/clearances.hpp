// Lower bounds of the distances of shapes that were apart: the distance that a query found, less the way that both have moved
// since (after Mirtich, Impulse-based dynamic simulation of rigid body systems, 1996). While a bound exceeds the margin,
// a query would find no contact, and none is made. Then the direction that separated the shapes is tried first: while the gap
// along it exceeds the margin, that gap is the new bound. Results are the same to the last bit.
#pragma once

#include <cstdint>

#include "collision/gap_along.hpp"
#include "collision/geom.hpp"

namespace dyn::simulation {

class Clearances {
 public:
  // Of a pair.
  struct Known {
    Index a, b;
    float until;           // distance plus what both shapes had moved by then, or less (m)
    std::int16_t axis[3];  // the direction from A to B in A's axes; zero: none
  };

 private:
  Known* known_;              // in buckets, by a hash of the pair; a new pair takes the place of the one that is nearest
  double* moved_;             // by shape: bound of the way of any of its points (m)
  collision::Pose* placed_;   // by shape

  static constexpr double axis_scale = 32767;  // a component of 1
  static constexpr int ways = 4;              // places in a bucket: pairs that share one do not displace each other every step
  // Places are three times the pairs that come near at once, as a power of two: up to six a pair, 144 bytes.
  static_assert(6 * sizeof(Known) <= 200);
  static int bits(const Model& m) {
    const std::ptrdiff_t geoms = m.n.geoms, all = lists_pairs(m) ? m.n.pairs : geoms * (geoms - 1) / 2,
                         pairs = std::min(16 * geoms, all);
    int count = 1;
    while (std::ptrdiff_t(ways) << count < 3 * pairs) ++count;
    return count;
  }
  int shift_;
  Known* bucket(Index a, Index b) const {  // mixed as by MurmurHash3 (Appleby)
    std::uint32_t h = std::uint32_t(a) * 0x9e3779b1u + std::uint32_t(b);
    h = (h ^ h >> 15) * 0x85ebca77u, h = (h ^ h >> 13) * 0xc2b2ae3du;
    return known_ + ways * (h >> shift_);
  }
  // Less by 3e-8 of it or more: far more than the rounding of moved_.
  static float below(double bound) { return std::nextafter(float(bound), -HUGE_VALF); }

 public:
  template <class F>
  void for_each_array(const Model& m, F&& f) {
    shift_ = 32 - bits(m);
    f(known_, std::ptrdiff_t(ways) << bits(m)), f(moved_, m.n.geoms), f(placed_, m.n.geoms);
  }
  // A shape is at X. A turn moves a point at r by at most |R - R'| r in the spectral norm, 1/sqrt 2 of the Frobenius norm.
  void move(Index geom, const collision::Pose& X, double radius) {
    const collision::Pose& last = placed_[geom];
    const Vec3<double> way = X.p - last.p, x = X.R.x - last.R.x, y = X.R.y - last.R.y, z = X.R.z - last.R.z;
    const double turned = dot(x, x) + dot(y, y) + dot(z, z);
    moved_[geom] += std::sqrt(dot(way, way)) + (turned > 0 ? std::sqrt(0.5 * turned) * radius : 0);
    placed_[geom] = X;
  }
  // Null where nothing is known of a pair.
  Known* find(Index a, Index b) const {
    for (Known *k = bucket(a, b), *end = k + ways; k != end; ++k)
      if (k->a == a && k->b == b) return k;
    return nullptr;
  }
  // Lower bound of the distance.
  double bound(const Known& k) const { return double(k.until) - moved_[k.a] - moved_[k.b]; }
  // The gap along the remembered direction, negative if there is none. If it exceeds the margin, it is the new bound.
  double bound_along_axis(Known& k, const collision::Geom* geoms, const collision::Pose* poses, double margin) const {
    const Index a = k.a, b = k.b;
    const Vec3<double> axis = Vec3<double>::make(k.axis[0], k.axis[1], k.axis[2]);
    const double length = shape::norm(axis);
    if (!(length > 0)) return -shape::infinity;
    const double gap =
        collision::gap_along(geoms[a].shape, poses[a], geoms[b].shape, poses[b], poses[a].R * (axis * (1 / length)));
    if (gap > margin) k.until = below(gap + moved_[a] + moved_[b]);
    return gap;
  }
  // axis: the unit vector that separates the shapes, from A to B in A's axes; zero if no plane does.
  void learn(Index a, Index b, double distance, const Vec3<double>& axis) {
    Known* place = find(a, b);
    if (!place) {
      Known* const first = place = bucket(a, b);
      for (Known *k = first, *end = first + ways; k != end; ++k)
        if (bound(*k) < bound(*place)) place = k;
    }
    const auto stored = [&](int i) { return std::int16_t(axis[i] * axis_scale); };
    *place = {a, b, below(distance + moved_[a] + moved_[b]), {stored(0), stored(1), stored(2)}};
  }
  // The shapes are near each other: no direction is worth trying.
  void forget_axis(Index a, Index b) {
    if (Known* const k = find(a, b)) k->axis[0] = k->axis[1] = k->axis[2] = 0;
  }
};

}  // namespace dyn::simulation
