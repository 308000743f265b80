// A loop closed by a joint: B moves as the child of that joint in A. The rows are the 6 - nv directions that the joint fixes.
// a is the axis, n1 and n2 are unit vectors perpendicular to it:
//   position    all: C = r        across a: C = n . r        along a (planar): C = a . r
//   orientation all: C = log3 R        of the axis: C = n . (a x R a), dC/dt = n . w where R a = a
//   universal   C = a . (R b - b), b the second axis in B: with b' = R b, dC/dt = (b' x a) . w, d2C/dt2 = (b' x a) . dw + ((w x
//   b') x a) . w
//   helical     C = a . r - h phi, phi the angle of R about a, to the nearest turn: dC/dt = a . v - h a . w
#pragma once

#include "base/portable.hpp"
#include "constraint/orientation.hpp"

namespace dyn::constraint {

struct Loop {
  static constexpr dynConstraintType type = DYN_CONSTRAINT_TYPE_LOOP;
  // 0: such a joint closes no loop.
  static int rows(dynJointType type) {
    switch (type) {
      case DYN_JOINT_TYPE_REVOLUTE:
      case DYN_JOINT_TYPE_CONTINUOUS:
      case DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED:
      case DYN_JOINT_TYPE_PRISMATIC:
      case DYN_JOINT_TYPE_HELICAL:
        return 5;
      case DYN_JOINT_TYPE_CYLINDRICAL: case DYN_JOINT_TYPE_UNIVERSAL: return 4;
      case DYN_JOINT_TYPE_SPHERICAL:
      case DYN_JOINT_TYPE_SPHERICAL_ZYX:
      case DYN_JOINT_TYPE_PLANAR:
      case DYN_JOINT_TYPE_TRANSLATION:
        return 3;
      default: return 0;
    }
  }
  static int rows(const Constraint& c) { return rows(c.joint_type); }

  template <class T, class Out>
  static DYN_INLINE void evaluate(const Constraint& c, const Relative<T>& X, Out&& out) {
    const Vec3<T> a = cast<T>(c.axis), n1 = cast<T>(c.n1), n2 = cast<T>(c.n2), o = Vec3<T>::zero();
    int i = 0;
    auto point = [&] {
      for (int k = 0; k < 3; ++k) out(i++, unit3<T>(k), o, X.r[k], T(0));
    };
    auto across = [&] { out(i++, n1, o, dot(n1, X.r), T(0)), out(i++, n2, o, dot(n2, X.r), T(0)); };
    auto axis = [&] {
      const Vec3<T> leaning = X.R * a;
      for (const Vec3<T>& n : {n1, n2})
        out(i++, o, n, dot(n, cross(a, leaning)), T(0), [&](auto& by) { by.error_turn = cross(leaning, cross(n, a)); });
    };
    auto orientation = [&] {
      const Vec3<T> turn = log3(X.R);
      for (int k = 0; k < 3; ++k) out(i++, o, unit3<T>(k), turn[k], T(0), [&](auto& by) { set_turn(turn, k, by); });
    };
    switch (c.joint_type) {
      case DYN_JOINT_TYPE_REVOLUTE:
      case DYN_JOINT_TYPE_CONTINUOUS:
      case DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED:
        return point(), axis();
      case DYN_JOINT_TYPE_PRISMATIC: return across(), orientation();
      case DYN_JOINT_TYPE_CYLINDRICAL: return across(), axis();
      case DYN_JOINT_TYPE_HELICAL: {
        using math::atan2;
        using std::remainder;
        const Vec3<T> x = X.R * n1;
        const T y1 = dot(n1, x), y2 = dot(n2, x), phi = atan2(y2, y1), h = T(c.pitch), turn = T(6.283185307179586477) * h;
        out(i++, n1, o, dot(n1, X.r), T(0)), out(i++, n2, o, dot(n2, X.r), T(0));
        const T e = dot(a, X.r) - h * phi;
        out(i++, a, a * -h, turn != T(0) ? T(remainder(e, turn)) : e, T(0), [&](auto& by) {
          by.error_turn = (cross(x, n2) * y1 - cross(x, n1) * y2) * (-h / (y1 * y1 + y2 * y2));
        });
        return axis();
      }
      case DYN_JOINT_TYPE_UNIVERSAL: {
        const Vec3<T> b = X.R * cast<T>(c.axis2);
        point();
        return out(i, o, cross(b, a), dot(a, b) - dot(a, cast<T>(c.axis2)), dot(cross(cross(X.w, b), a), X.w), [&](auto& by) {
          const T ab = dot(a, b), wa = dot(X.w, a), wb = dot(X.w, b);  // extra = wa wb - ab w . w
          by.t_turn = {b * a[0] - unit3<T>(0) * ab, b * a[1] - unit3<T>(1) * ab, b * a[2] - unit3<T>(2) * ab};
          by.extra_w = a * wb + b * wa - X.w * (T(2) * ab);
          by.extra_turn = cross(b, X.w) * wa - cross(b, a) * dot(X.w, X.w);
        });
      }
      case DYN_JOINT_TYPE_SPHERICAL: case DYN_JOINT_TYPE_SPHERICAL_ZYX: return point();
      case DYN_JOINT_TYPE_PLANAR: return out(i++, a, o, dot(a, X.r), T(0)), axis();
      case DYN_JOINT_TYPE_TRANSLATION: return orientation();
      default: return;
    }
  }
};

}  // namespace dyn::constraint
