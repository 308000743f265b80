// A convex core whose shape is known at run time. GJK, EPA and Newton's method over it are compiled once, and not once a pair: a
// small image has 250 KB less of them, and a support point costs a jump. Results are those of the shapes' own types.
#pragma once

#include "shape/list.hpp"

namespace dyn::collision {

// Whether the narrow phase takes it: in images for little flash.
#if DYN_NO_HOST && DYN_SMALL
inline constexpr bool takes_any_core = true;
#else
inline constexpr bool takes_any_core = false;
#endif

// is_curved: of the pair. A straight shape of a curved pair has pieces that are points, without curvature.
template <bool is_curved>
struct AnyCore {
  static constexpr bool curved = is_curved, has_faces = true;
  const shape::Shape& shape;
  double radius;
  bool short_nearest;

  explicit AnyCore(const shape::Shape& s) : shape(s), radius(s.radius) {
    short_nearest = get<bool>([](const auto& x) { return x.short_nearest; });
  }
  shape::Vec support(const shape::Vec& d) const {
    return get<shape::Vec>([&](const auto& x) { return x.support(d); });
  }
  shape::Vec support_on_piece(const shape::Vec& from, const shape::Vec& n) const {
    return get<shape::Vec>([&]<class S>(const S& x) {
      if constexpr (S::curved) return x.support_on_piece(from, n);
      else return from;
    });
  }
  shape::CurvatureRadii curvature_radii(const shape::Vec& from, const shape::Vec& n, const shape::Vec& u, const shape::Vec& v) const {
    return get<shape::CurvatureRadii>([&]<class S>(const S& x) {
      if constexpr (S::curved) return x.curvature_radii(from, n, u, v);
      else return shape::CurvatureRadii{0, 0, 0};
    });
  }
  shape::Nearest nearest(const shape::Vec& p) const {
    return get<shape::Nearest>([&](const auto& x) { return x.nearest(p); });
  }
  shape::Flat flat(const shape::Vec& n) const {
    return get<shape::Flat>([&](const auto& x) { return x.flat(n); });
  }
  shape::Face face(const shape::Vec& n) const {
    return get<shape::Face>([&]<class S>(const S& x) {
      if constexpr (S::has_faces) return x.face(n);
      else return shape::Face{false, shape::Vec::zero()};
    });
  }
  bool under_face(const shape::Vec& n, const shape::Vec& p) const {
    return get<bool>([&]<class S>(const S& x) {
      if constexpr (S::has_faces) return x.under_face(n, p);
      else return false;
    });
  }
  double extent() const {
    return get<double>([](const auto& x) { return x.extent(); });
  }

  // f(x) of the shape itself. Spheres and half spaces have closed forms with all others.
  template <class R, class F>
  R get(F&& f) const {
    R out{};
    shape::visit(shape, [&]<class S>(const S& x) {
      if constexpr (S::type != shape::Type::HalfSpace && S::type != shape::Type::Sphere && S::type < shape::Type::Triangles)
        out = f(x);
    });
    return out;
  }
};

}  // namespace dyn::collision
