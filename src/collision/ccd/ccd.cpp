#include "collision/ccd.hpp"

#include <ccd/ccd.h>
#ifndef DYN_CCD_LINKED
#include <dlfcn.h>
#endif

#include <algorithm>

#include "shape/list.hpp"

namespace dyn::collision {

namespace {

using namespace shape;
static_assert(sizeof(ccd_real_t) == sizeof(double), "libccd in double precision");

struct Object {
  const Shape* shape;
  Pose X;
};

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const Object& o = *static_cast<const Object*>(object);
  const Vec d = load3(direction->v);
  Vec p = o.X.p;
  visit(*o.shape, [&]<class S>(const S& s) {
    if constexpr (S::type != Type::HalfSpace) p = o.X.act(s.support(transpose_times(o.X.R, d))) + d * (s.radius / norm(d));
  });
  store3(p, out->v);
}
// diagonal start: along an axis, touching boxes give a simplex without volume (libccd issue 25)
void first_direction(const void*, const void*, ccd_vec3_t* out) { store3(Vec::make(1, 1, 1), out->v); }

using Penetration = decltype(&ccdGJKPenetration);

#ifdef DYN_CCD_LINKED
Penetration open() { return ccdGJKPenetration; }
#else
Penetration open() {
  void* library = dlopen("libccd.so.2", RTLD_NOW | RTLD_LOCAL);
  return library ? reinterpret_cast<Penetration>(dlsym(library, "ccdGJKPenetration")) : nullptr;
}
#endif
Penetration penetration() {
  static const Penetration function = open();
  return function;
}

}  // namespace

bool ccd_available() { return penetration() != nullptr; }

bool ccd_overlap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double tolerance, FallbackResult& out) {
  if (a.type == Type::HalfSpace || b.type == Type::HalfSpace || !ccd_available()) return false;
  double small = infinity;
  for (const Shape* s : {&a, &b}) visit(*s, [&](const auto& x) { small = std::min(small, x.extent() + x.radius); });
  // relative to A, so rounding does not grow with the distance from the world's origin
  const Object objects[2] = {{&a, {X_WA.R, Vec::zero()}}, {&b, {X_WB.R, X_WB.p - X_WA.p}}};
  ccd_t ccd{};  // CCD_INIT would link a function of libccd, which is opened at run time
  ccd.support1 = ccd.support2 = support, ccd.first_dir = first_direction;
  // tolerance of squared lengths; libccd's EPA has no iteration cap and stalls on curved shapes below 1e-8
  ccd.max_iterations = 100, ccd.epa_tolerance = std::max(tolerance * tolerance, 1e-8) * small * small;
  ccd_vec3_t direction, position;
  double depth;
  if (penetration()(&objects[0], &objects[1], &ccd, &depth, &direction, &position) != 0) return false;
  const Vec n = load3(direction.v);
  out.normal = n * (1 / norm(n)), out.position = X_WA.p + load3(position.v), out.depth = depth;
  return depth > 0 && dot(n, n) > 0;
}

}  // namespace dyn::collision
