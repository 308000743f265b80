// J' v of a path: the acceleration of its length where v is constant. A straight piece from a to b, points of two bodies, adds
//   l' = u . (v_b - v_a)      l'' = u . (v_b - v_a)' + u' . (v_b - v_a)
// with (v)' the rate of a body's velocity at the path's point, which arcs move over the body.
#pragma once

#include "algorithm/paths.hpp"
#include "spatial/dual.hpp"
#include "spatial/motion.hpp"

namespace dyn {

// Placements with their rates, for PathPieces.
template <class T>
struct MovingPlaces {
  const Model& m;
  const Data<T>& d;

  // Velocity about the fixed point at which the body's origin is, and its rate; mocap bodies rest.
  Motion<Dual<T>> motion(Index place) const {
    Motion<T> V = Motion<T>::zero(), A = V;
    for (Index i = place < m.n.bodies ? place : 0; i != 0; i = m.bodies()[i].parent) {
      const Body& b = m.bodies()[i];
      Motion<T> J = Motion<T>::zero();
      visit(b.type, [&]<class Type>() {
        for (int k = 0; k < Type::nv; ++k) J = J + Type::column(b, d.R[i], k) * (T(b.ratio) * d.v[b.user_v + k]);
      });
      J = shift(J, d.p[place] - d.p[i]);
      A = A + cross(J, V), V = V + J;  // as body_motion
    }
    return {dual(V.linear, A.linear), dual(V.angular, A.angular)};
  }
  Vec3<Dual<T>> velocity(const PathPoint<Dual<T>>& a) const {
    const Motion<Dual<T>> V = motion(a.body);
    return V.linear + cross(V.angular, a.x - cast<Dual<T>>(d.p[a.body]));
  }
};
template <class T>
Vec3<Dual<T>> origin_of(const MovingPlaces<T>& at, Index place) {
  const Vec3<Dual<T>> v = at.motion(place).linear;
  return dual(at.d.p[place], Vec3<T>::make(v[0].x, v[1].x, v[2].x));
}
template <class T>
Mat3<Dual<T>> axes_of(const MovingPlaces<T>& at, Index place) {
  const Vec3<Dual<T>> v = at.motion(place).angular;
  const Vec3<T> w = Vec3<T>::make(v[0].x, v[1].x, v[2].x);
  const Mat3<T>& R = at.d.R[place];
  return {dual(R.x, cross(w, R.x)), dual(R.y, cross(w, R.y)), dual(R.z, cross(w, R.z))};
}

// J' v of a tendon, with the placements in d. The moment arms of a FIXED one are constant.
template <class T>
T path_bias(const Model& m, const Data<T>& d, Index tendon) {
  const PathRecord& p = m.paths()[tendon];
  if (p.kind != PathKind::Spatial) return T(0);
  using D = Dual<T>;
  using Point = PathPoint<D>;
  const MovingPlaces<T> places{m, d};
  D rate = T(0);
  PathPieces<D, MovingPlaces<T>>{m, places}.walk(
      p, [](const Point&) {},
      [&](const Point& a, const Point& b, D divisor) {
        if (a.body != b.body) rate += dot(direction(a.x, b.x), places.velocity(b) - places.velocity(a)) / divisor;
      },
      [](const Wrap<D>&, const PathElement&, D) {});
  return rate.d;
}

}  // namespace dyn
