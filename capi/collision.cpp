// Collision and distance: thin wrappers.
#include "collision.hpp"

#include <cmath>

#include "base/format.hpp"
#include "collision/ccd.hpp"
#include "simulation/workspace.hpp"
#include "surfaces.hpp"
#include "reflection.hpp"
#include "rotation.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace dyn::capi {

void write(const collision::Result& r, dynDistance* distance) {
  dynDistance out;
  out.status = dynDistanceStatus(r.status), out.unique = r.unique, out.iterations = r.iterations;
  out.method = r.from_fallback ? DYN_DISTANCE_METHOD_CCD : DYN_DISTANCE_METHOD_GJK;
  out.distance = r.distance, out.residual = r.residual;
  store3(r.normal, out.normal), store3(r.point_a, out.point_a), store3(r.point_b, out.point_b);
  write_struct(out, distance);
}

dynStatus read_geometry(const char* function, const char* name, const dynGeometry* geometry, PlacedShape& read) {
  shape::Shape& out = read.shape;
  if (!geometry) return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, name);
  const Given<dynGeometry> g(function, geometry);
  if (g.status != DYN_OK) return g.status;
  if (g->type == DYN_SHAPE_TYPE_MESH)
    return fail(DYN_ERROR_UNSUPPORTED,
                "%s: %s is a mesh, a name alone: use DYN_SHAPE_TYPE_CONVEX or DYN_SHAPE_TYPE_TRIANGLES with a dynMesh", function,
                name);
  char what[40];
  write_text(what, sizeof what, "%s: type", name);
  if (const dynStatus s = check_value(g->type, function, what)) return s;
  collision::geometry_of(g->type, g->size, g->radius, out);
  for (int k = 0; k < collision::size_count(g->type); ++k)
    if (!(g->size[k] >= shape::min_length && g->size[k] <= shape::max_length))
      return fail(std::isfinite(g->size[k]) ? DYN_ERROR_INVALID : DYN_ERROR_NONFINITE,
                  "%s: %s: size[%d] is %g: give metres from %g to %g", function, name, k, g->size[k], shape::min_length,
                  shape::max_length);
  if (!(g->radius >= 0 && g->radius <= shape::max_length))
    return fail(std::isfinite(g->radius) ? DYN_ERROR_INVALID : DYN_ERROR_NONFINITE,
                "%s: %s: radius is %g: give metres from 0 to %g", function, name, g->radius, shape::max_length);
  SurfacePtr surface;
  if (const dynStatus s = surface_argument(function, name, g->type, g->surface, surface)) return s;
  if (!surface) return DYN_OK;
  if (const auto* hull = std::get_if<Held<shape::Hull>>(&surface->held)) read.hull = hull->view(), out.hull = &read.hull;
  if (const auto* tree = std::get_if<Held<shape::TriangleTree>>(&surface->held))
    read.tree = tree->view(), out.triangles = &read.tree;
  if (const auto* grid = std::get_if<Held<shape::Grid>>(&surface->held)) read.grid = grid->view(), out.grid = &read.grid;
  return DYN_OK;
}

dynStatus read_placement(const char* function, const char* name, const double* x, collision::Pose& out) {
  if (!x) return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, name);
  for (int k = 0; k < 12; ++k)
    if (!(std::abs(x[k]) <= shape::max_length))
      return fail(std::isfinite(x[k]) ? DYN_ERROR_INVALID : DYN_ERROR_NONFINITE, "%s: %s[%d] is %g: give numbers within %g",
                  function, name, k, x[k], shape::max_length);
  out = load_se3(x);
  if (!is_rotation(out.R))
    return fail(DYN_ERROR_INVALID, "%s: %s is no rotation and translation: its columns are not orthonormal", function, name);
  return DYN_OK;
}

dynStatus check_pair(const char* function, const Model& m, int pair, int first) {
  return pair >= first && pair < 0 ? DYN_OK : check_index(function, "pair", pair, m.n.pairs);
}

// So many shapes that pairs are not listed would otherwise look like none that collide.
Index geom_of_shape(Call& call, int shape, int first) {
  const Model& m = call.m();
  if (const Index geom = collision::geom_of_shape(m, shape); geom >= 0) return geom;
  if (shape >= 0 && shape < m.n.shapes)
    call.status = fail(DYN_ERROR_ARGUMENT, "%s: shape %d is no collision shape", call.function, shape);
  else if (shape < first || shape >= m.n.shapes)
    call.status = check_index(call.function, "shape", shape, m.n.shapes);
  return -1;
}

bool listed(Call& call) {
  if (lists_pairs(call.m())) return true;
  call.status = fail(DYN_ERROR_LIMIT, "%s: the model has %d collision shapes: pairs are listed up to %d", call.function,
                     int(call.m().n.geoms), int(max_geoms));
  return false;
}

bool placed(Call& call) {
  ensure_position(call.m(), call.d());
  return no_overflow(call, 0, shape::max_length);
}

dynStatus check_margin(const char* function, double margin) {
  if (margin >= 0 && margin <= shape::max_length) return DYN_OK;
  return fail(std::isfinite(margin) ? DYN_ERROR_ARGUMENT : DYN_ERROR_NONFINITE, "%s: margin is %g: give metres from 0 to %g",
              function, margin, shape::max_length);
}

dynStatus check_capacity(const char* function, int capacity) {
  return capacity >= 0 ? DYN_OK : fail(DYN_ERROR_ARGUMENT, "%s: capacity is %d: it can't be negative", function, capacity);
}

dynStatus read_tolerance(const char* function, double tolerance, collision::Options& options) {
  if (tolerance != 0) options.tolerance = tolerance;
  if (options.tolerance > 0 && options.tolerance < 1) return DYN_OK;
  return fail(std::isfinite(tolerance) ? DYN_ERROR_ARGUMENT : DYN_ERROR_NONFINITE,
              "%s: tolerance is %g: give a number between 0 and 1, or 0 for the default", function, tolerance);
}

dynStatus read_options(const char* function, const dynDistanceOptions* options, collision::Options& out) {
  const Given<dynDistanceOptions> read(function, options);
  if (read.status != DYN_OK) return read.status;
  const dynDistanceOptions& given = *read;
  if (const dynStatus s = check_value(given.method, function, "method")) return s;
  if (given.method == DYN_DISTANCE_METHOD_CCD && !collision::ccd_available())
    return fail(DYN_ERROR_UNSUPPORTED, "%s: method CCD needs libccd.so.2, which cannot be opened: install it (Debian: libccd2)",
                function);
  out.fallback_first = given.method == DYN_DISTANCE_METHOD_CCD;
  return read_tolerance(function, given.tolerance, out);
}

dynStatus read_pair(const char* function, const dynGeometryPair& pair, PlacedShape& A, PlacedShape& B) {
  dynStatus s = read_geometry(function, "a", pair.a, A);
  if (s == DYN_OK) s = read_geometry(function, "b", pair.b, B);
  if (s == DYN_OK) s = read_placement(function, "placement_a", pair.placement_a, A.X);
  if (s == DYN_OK) s = read_placement(function, "placement_b", pair.placement_b, B.X);
  return s;
}

}  // namespace dyn::capi

template <>
dynGeometry capi::defaults() {
  return {0, DYN_SHAPE_TYPE_SPHERE, {}, 0, nullptr};
}

template <>
dynGeometryPair capi::defaults() {
  return {};
}

template <>
dynDistanceOptions capi::defaults() {
  return {0, DYN_DISTANCE_METHOD_GJK, collision::Options().tolerance};
}

extern "C" {

dynStatus dyn_geometry_distance(const dynGeometry* a, const double* placement_a, const dynGeometry* b, const double* placement_b,
                             const dynDistanceOptions* options, dynDistance* out) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_geometry_distance";
  PlacedShape A, B;
  collision::Options inner;
  dynStatus s = read_pair(function, {0, a, b, placement_a, placement_b, nullptr, nullptr}, A, B);
  if (s == DYN_OK) s = check_struct(function, "out", out);
  if (s == DYN_OK && options) s = read_options(function, options, inner);
  if (s != DYN_OK) return s;
  inner.fallback = collision::ccd_overlap;
  collision::Workspace workspace;
  write(collision::distance(A.shape, A.X, B.shape, B.X, workspace, inner), out);
  return DYN_OK;
}

int dyn_model_npairs(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.pairs) : -1; }

dynStatus dyn_model_pair(const dynModel* model, int pair, int* shape_a, int* shape_b, dynPairReason* reason) {
  if (const dynStatus s = check(model)) return s;
  const Model& m = *model->m;
  if (const dynStatus s = check_pair("dyn_model_pair", m, pair)) return s;
  const PairRecord& p = m.pairs()[pair];
  if (shape_a) *shape_a = int(m.geoms()[p.a].shape);
  if (shape_b) *shape_b = int(m.geoms()[p.b].shape);
  if (reason) *reason = dynPairReason(p.reason);
  return DYN_OK;
}

dynStatus dyn_data_set_pair(const dynModel* model, dynData* data, int pair, int tested) {
  Call call(model, data, DYN_PART_COLLISION, "dyn_data_set_pair");
  if (!call) return call.status;
  const Model& m = call.m();
  if (const dynStatus s = check_pair(call.function, m, pair, -1)) return s;
  if (pair >= 0 && tested && m.pairs()[pair].reason == DYN_PAIR_REASON_MESH)
    return fail(DYN_ERROR_UNSUPPORTED, "dyn_data_set_pair: pair %d has a mesh, of which only the name is known", pair);
  if (pair < 0 && !listed(call)) return call.status;
  for (Index k = pair < 0 ? 0 : pair, end = pair < 0 ? m.n.pairs : pair + 1; k < end; ++k) {
    const auto before = dynPairReason(m.pairs()[k].reason);
    if (before != DYN_PAIR_REASON_MESH)
      call.d().pair_states[k] = tested ? DYN_PAIR_REASON_TESTED : before == DYN_PAIR_REASON_TESTED ? DYN_PAIR_REASON_OFF : before;
  }
  call.d().invalidate(Stage::Distances);
  simulation::invalidate_sleep(call.d());
  if (call.d().step) call.d().step->advancement_cache.square = 0, call.d().step->pair_count = -1;
  return DYN_OK;
}

dynStatus dyn_data_pair(const dynModel* model, dynData* data, int pair, dynPairReason* reason) {
  Call call(model, data, DYN_PART_COLLISION, "dyn_data_pair");
  if (!call || !call.required("reason", reason)) return call.status;
  if (const dynStatus s = check_pair(call.function, call.m(), pair)) return s;
  *reason = call.d().pair_states[pair];
  return DYN_OK;
}

dynStatus dyn_distances(const dynModel* model, dynData* data, const double* q, double* distances) {
  Call call(model, data, DYN_PART_COLLISION, "dyn_distances");
  if (!call || !listed(call) || !call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  Data<double>& d = call.d();
  if (!placed(call)) return call.status;
  collision::distances(call.m(), d);
  copy_out(d.distances, call.m().n.pairs, distances);
  return DYN_OK;
}

dynStatus dyn_pair_distance(const dynModel* model, dynData* data, int pair, dynDistance* out) {
  Call call(model, data, DYN_PART_COLLISION, "dyn_pair_distance");
  if (!call) return call.status;
  if (const dynStatus s = check_pair(call.function, call.m(), pair)) return s;
  if (const dynStatus s = check_struct(call.function, "out", out)) return s;
  if (!call.fresh(Stage::Distances, "the distance", "dyn_distances")) return call.status;
  if (call.d().pair_states[pair] != DYN_PAIR_REASON_TESTED)
    return fail(DYN_ERROR_ARGUMENT,
                "dyn_pair_distance: pair %d is not tested: dyn_data_pair says why, dyn_data_set_pair switches it on", pair);
  write(call.d().results[pair], out);
  return DYN_OK;
}

dynStatus dyn_distance_gradients(const dynModel* model, dynData* data, double* gradients) {
  Call call(model, data, DYN_PART_COLLISION, "dyn_distance_gradients");
  const std::ptrdiff_t pairs = call ? call.m().n.pairs : 0;
  if (!call || !call.required("gradients", gradients, pairs * call.m().n.nv) ||
      !call.fresh(Stage::Distances, "the distance", "dyn_distances"))
    return call.status;
  for (std::ptrdiff_t k = 0; k < pairs; ++k) collision::distance_gradient(call.m(), call.d(), Index(k), gradients + k, pairs);
  return DYN_OK;
}

dynStatus dyn_collisions(const dynModel* model, dynData* data, const double* q, double margin, int* pairs, int capacity,
                         int* count) {
  Call call(model, data, DYN_PART_COLLISION, "dyn_collisions");
  if (!call || !listed(call)) return call.status;
  if (const dynStatus s = check_margin(call.function, margin)) return s;
  if (const dynStatus s = check_capacity(call.function, capacity)) return s;
  if (!call.required("pairs", pairs, capacity) || !call.required("count", count) || !call.inputs(q, nullptr, nullptr, nullptr))
    return call.status;
  if (!placed(call)) return call.status;
  *count = int(collision::collisions(call.m(), call.d(), margin, pairs, capacity));
  return DYN_OK;
}

}  // extern "C"
