// A massless rod of the length L between the origins. With n = r / |r|:
//   C = |r| - L        dC/dt = n . v        d2C/dt2 = n . dv + (v . v - (n . v)^2) / |r|
// Where r = 0 it has no direction: then n is x, and the last term 0.
#pragma once

#include "constraint/constraint.hpp"

namespace dyn::constraint {

struct Distance {
  static constexpr dynConstraintType type = DYN_CONSTRAINT_TYPE_DISTANCE;
  static int rows(const Constraint&) { return 1; }
  template <class T, class Out>
  static DYN_INLINE void evaluate(const Constraint& c, const Relative<T>& X, Out&& out) {
    using std::sqrt;
    const T size = sqrt(dot(X.r, X.r));
    if (!(size > T(0))) return out(0, unit3<T>(0), Vec3<T>::zero(), T(-c.length), T(0));
    const Vec3<T> n = X.r * (T(1) / size);
    const T along = dot(n, X.v);
    const T extra = (dot(X.v, X.v) - along * along) / size;
    out(0, n, Vec3<T>::zero(), size - T(c.length), extra, [&](auto& by) {
      auto across = [&](const Vec3<T>& a) { return (a - n * dot(n, a)) * (T(1) / size); };  // dn = across(dr)
      by.f_step = {across(unit3<T>(0)), across(unit3<T>(1)), across(unit3<T>(2))};
      by.extra_v = across(X.v) * T(2);
      by.extra_step = (across(X.v) * (T(2) * along) + n * extra) * (T(-1) / size);
    });
  }
};

}  // namespace dyn::constraint
