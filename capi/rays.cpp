// Rays, closest points, swept tests, groups of shapes: thin wrappers.
#include <cmath>

#include "collision.hpp"
#include "collision/masks.hpp"
#include "collision/rays.hpp"
#include "collision/sweep.hpp"
#include "shape/list.hpp"
#include "simulation/workspace.hpp"

using namespace dyn;
using namespace dyn::capi;
using shape::max_length;

namespace {

// n numbers of the caller's, each within bounds of what queries compute with.
dynStatus check_numbers(const char* function, const char* name, const double* x, std::ptrdiff_t n) {
  if (!x && n > 0) return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, name);
  for (std::ptrdiff_t k = 0; k < n; ++k)
    if (!(std::abs(x[k]) <= max_length))
      return fail(std::isfinite(x[k]) ? DYN_ERROR_INVALID : DYN_ERROR_NONFINITE, "%s: %s[%td] is %g: give numbers within %g",
                  function, name, k, x[k], max_length);
  return DYN_OK;
}

dynStatus check_directions(const char* function, const char* name, const double* x, std::ptrdiff_t rays) {
  if (const dynStatus s = check_numbers(function, name, x, 3 * rays)) return s;
  for (std::ptrdiff_t k = 0; k < rays; ++k)
    if (!(shape::norm(load3(x + 3 * k)) >= shape::min_length))
      return fail(DYN_ERROR_INVALID, "%s: %s: column %td is (%g, %g, %g): it has no direction", function, name, k, x[3 * k],
                  x[3 * k + 1], x[3 * k + 2]);
  return DYN_OK;
}

}  // namespace

template <>
dynRays capi::defaults() {
  return {0, 0, 0xffffffff, nullptr, nullptr, HUGE_VAL};
}

extern "C" {

dynStatus dyn_data_set_shape_masks(const dynModel* model, dynData* data, int shape, uint32_t contype, uint32_t conaffinity) {
  Call call(model, data, DYN_PART_COLLISION, "dyn_data_set_shape_masks");
  if (!call) return call.status;
  const Index geom = geom_of_shape(call, shape, -1);
  if (!call) return call.status;
  for (Index k = geom < 0 ? 0 : geom, end = geom < 0 ? call.m().n.geoms : geom + 1; k < end; ++k)
    collision::set_masks(call.m(), call.d(), k, {contype, conaffinity});
  simulation::invalidate_sleep(call.d());
  if (call.d().step) call.d().step->advancement_cache.square = 0, call.d().step->pair_count = -1;
  return DYN_OK;
}

dynStatus dyn_data_shape_masks(const dynModel* model, dynData* data, int shape, uint32_t* contype, uint32_t* conaffinity) {
  Call call(model, data, DYN_PART_COLLISION, "dyn_data_shape_masks");
  if (!call) return call.status;
  const Index geom = geom_of_shape(call, shape, 0);
  if (!call) return call.status;
  if (contype) *contype = call.d().geom_masks[geom].contype;
  if (conaffinity) *conaffinity = call.d().geom_masks[geom].conaffinity;
  return DYN_OK;
}

dynStatus dyn_geometry_ray(const dynGeometry* shape, const double* placement, const double* origin, const double* direction,
                           dynRayHit* out) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_geometry_ray";
  PlacedShape S;
  dynStatus s = read_geometry(function, "shape", shape, S);
  if (s == DYN_OK) s = read_placement(function, "placement", placement, S.X);
  if (s == DYN_OK) s = check_numbers(function, "origin", origin, 3);
  if (s == DYN_OK) s = check_directions(function, "direction", direction, 1);
  if (s == DYN_OK) s = check_struct(function, "out", out);
  if (s != DYN_OK) return s;
  const auto o = load3(origin), d = load3(direction);
  shape::Hit h{};
  shape::visit(S.shape, [&](const auto& x) { h = x.ray(S.X.act_inverse(o), transpose_times(S.X.R, d)); });
  const bool hit = h.t < shape::infinity;
  dynRayHit found;
  found.shape = hit ? 0 : -1, found.t = h.t;
  store3(hit ? o + d * h.t : shape::Vec::zero(), found.position),
      store3(hit ? S.X.R * h.normal : shape::Vec::zero(), found.normal);
  write_struct(found, out);
  return DYN_OK;
}

dynStatus dyn_rays(const dynModel* model, dynData* data, const double* q, const dynRays* rays, double* t, int* shapes,
                   double* normals) {
  Call call(model, data, DYN_PART_COLLISION, "dyn_rays");
  if (!call || !call.required("rays", rays)) return call.status;
  const Given<dynRays> given(call.function, rays);
  if (given.status != DYN_OK) return given.status;
  const double *origins = given->origins, *directions = given->directions, max_t = given->max_t;
  const int n = given->count;
  if (n < 0) return fail(DYN_ERROR_ARGUMENT, "dyn_rays: count is %d: give 0 or more", n);
  if (!(max_t > 0))
    return fail(std::isnan(max_t) ? DYN_ERROR_NONFINITE : DYN_ERROR_ARGUMENT, "dyn_rays: max_t is %g: give a number above 0",
                max_t);
  if (const dynStatus s = check_numbers(call.function, "origins", origins, 3 * std::ptrdiff_t(n))) return s;
  if (const dynStatus s = check_directions(call.function, "directions", directions, n)) return s;
  if (!call.inputs(q, nullptr, nullptr, nullptr) || !placed(call)) return call.status;
  const Model& m = call.m();
  const Data<double>& d = call.d();
  collision::place_geoms(m, call.d());
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    const collision::RayHit h = collision::cast(m, d, load3(origins + 3 * k), load3(directions + 3 * k), max_t, [&](Index geom) {
      return (d.geom_masks[geom].contype & given->mask) != 0 && m.shapes()[m.geoms()[geom].shape].type != DYN_SHAPE_TYPE_MESH;
    });
    if (t) t[k] = h.t;
    if (shapes) shapes[k] = h.geom < 0 ? -1 : int(m.geoms()[h.geom].shape);
    if (normals) store3(h.normal, normals + 3 * k);
  }
  return DYN_OK;
}

dynStatus dyn_geometry_closest_point(const dynGeometry* shape, const double* placement, const double* point,
                                     dynClosestPoint* out) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_geometry_closest_point";
  PlacedShape S;
  dynStatus s = read_geometry(function, "shape", shape, S);
  if (s == DYN_OK) s = read_placement(function, "placement", placement, S.X);
  if (s == DYN_OK) s = check_numbers(function, "point", point, 3);
  if (s == DYN_OK) s = check_struct(function, "out", out);
  if (s != DYN_OK) return s;
  shape::Nearest near{};
  shape::visit(S.shape, [&](const auto& x) { near = x.signed_distance(S.X.act_inverse(load3(point))); });
  dynClosestPoint found;
  found.unique = near.unique, found.distance = near.distance;
  store3(S.X.act(near.point), found.point), store3(S.X.R * near.normal, found.normal);
  write_struct(found, out);
  return DYN_OK;
}

dynStatus dyn_geometry_sweep(const dynGeometryPair* pair, double duration, double margin, dynImpact* out) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_geometry_sweep";
  static constexpr double rest[6] = {};
  if (!pair) return fail(DYN_ERROR_ARGUMENT, "%s: pair is NULL: it is required", function);
  const Given<dynGeometryPair> given(function, pair);
  if (given.status != DYN_OK) return given.status;
  const double *motion_a = given->motion_a ? given->motion_a : rest, *motion_b = given->motion_b ? given->motion_b : rest;
  PlacedShape A, B;
  dynStatus s = read_pair(function, *given, A, B);
  if (s == DYN_OK) s = check_numbers(function, "motion_a", motion_a, 6);
  if (s == DYN_OK) s = check_numbers(function, "motion_b", motion_b, 6);
  if (s == DYN_OK) s = check_margin(function, margin);
  if (s == DYN_OK) s = check_struct(function, "out", out);
  if (s != DYN_OK) return s;
  if (!(duration >= 0 && duration <= max_length))
    return fail(std::isfinite(duration) ? DYN_ERROR_ARGUMENT : DYN_ERROR_NONFINITE,
                "%s: duration is %g: give seconds from 0 to %g", function, duration, max_length);
  const collision::Moving moving_a = {A.shape, A.X, load3(motion_a), load3(motion_a + 3)},
                          moving_b = {B.shape, B.X, load3(motion_b), load3(motion_b + 3)};
  for (const auto& [x, name] : {std::pair{&moving_a, "a"}, std::pair{&moving_b, "b"}})
    if (x->shape.type == shape::Type::HalfSpace && dot(x->w, x->w) > 0)
      return fail(DYN_ERROR_UNSUPPORTED, "%s: %s is a half-space that turns: it would sweep everything", function, name);
  collision::Workspace workspace;
  collision::SweepOptions options;
  options.margin = margin;
  const collision::Impact i = collision::sweep(moving_a, moving_b, duration, workspace, options);
  dynImpact found;
  found.status = dynSweepStatus(i.status), found.time = i.time, found.distance = i.result.distance;
  store3(i.result.normal, found.normal), store3(i.result.point_a, found.point_a), store3(i.result.point_b, found.point_b);
  write_struct(found, out);
  return DYN_OK;
}

}  // extern "C"
