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

// libccd has absolute tolerances besides the given one, which suit shapes of this size: shapes are scaled to it.
constexpr double usual_size = 0.1;
// Its EPA has no bound of iterations, each of which takes as long as there are faces: after so many support points the origin
// is the answer, which is no farther than any face, so it ends with the face that it has.
constexpr int most_points = 1000;

struct Object {
  const Shape* shape;
  Pose X;
  double scale;
  mutable int left = most_points;
};

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const Object& o = *static_cast<const Object*>(object);
  if (o.left-- <= 0) return store3(Vec::zero(), out->v);
  const Vec d = load3(direction->v);
  Vec p = o.X.p;
  visit(*o.shape, [&]<class S>(const S& s) {
    if constexpr (S::type != Type::HalfSpace) p = o.X.act(s.support(transpose_times(o.X.R, d))) + d * (s.radius / norm(d));
  });
  store3(p * o.scale, out->v);
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
  const double scale = usual_size / small;
  if (!(scale < infinity)) return false;
  // relative to A, so rounding does not grow with the distance from the world's origin
  const Object objects[2] = {{&a, {X_WA.R, Vec::zero()}, scale}, {&b, {X_WB.R, X_WB.p - X_WA.p}, scale}};
  ccd_t ccd{};  // CCD_INIT would link a function of libccd, which is opened at run time
  ccd.support1 = ccd.support2 = support, ccd.first_dir = first_direction;
  // tolerance of squared lengths; libccd's EPA stalls on curved shapes below 1e-8
  ccd.max_iterations = 100, ccd.epa_tolerance = std::max(tolerance * tolerance, 1e-8) * usual_size * usual_size;
  ccd_vec3_t direction, position;
  double depth;
  if (penetration()(&objects[0], &objects[1], &ccd, &depth, &direction, &position) != 0) return false;
  const Vec n = load3(direction.v);
  out.normal = n * (1 / norm(n)), out.position = X_WA.p + load3(position.v) * (1 / scale), out.depth = depth / scale;
  return depth > 0 && dot(n, n) > 0;
}

}  // namespace dyn::collision
