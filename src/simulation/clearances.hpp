// Lower bounds of the distances of shapes that were apart: the distance that a query found, less the way that both have moved
// since (after Mirtich, Impulse-based dynamic simulation of rigid body systems, 1996). While a bound exceeds the margin,
// a query would find no contact, and none is made: results are the same to the last bit.
#pragma once

#include "collision/geom.hpp"

namespace dyn::simulation {

class Clearances {
  struct Known {
    Index a, b;
    double until;  // distance plus what both shapes had moved by then (m)
  };
  Known* known_;              // in buckets, by a hash of the pair; a new pair takes the place of the one that is nearest
  double* moved_;             // by shape: bound of the way of any of its points (m)
  collision::Pose* placed_;   // by shape

  static constexpr double rounding = 1e-12;  // of the sums
  static constexpr int ways = 4;              // places in a bucket: pairs that share one do not displace each other every step
  // Places are three times the pairs that come near at once, as a power of two.
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
  double left(const Known& k) const { return k.until * (1 - rounding) - moved_[k.a] - moved_[k.b]; }

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
  // Lower bound of the distance, negative where nothing is known.
  double bound(Index a, Index b) const {
    for (const Known *k = bucket(a, b), *end = k + ways; k != end; ++k)
      if (k->a == a && k->b == b) return left(*k);
    return -shape::infinity;
  }
  void learn(Index a, Index b, double distance) {
    Known *const first = bucket(a, b), *place = first;
    for (Known *k = first, *end = first + ways; k != end; ++k) {
      if (k->a == a && k->b == b) {
        place = k;
        break;
      }
      if (left(*k) < left(*place)) place = k;
    }
    *place = {a, b, distance + moved_[a] + moved_[b]};
  }
};

}  // namespace dyn::simulation
