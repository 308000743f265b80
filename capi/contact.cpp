// Contact points: thin wrappers.
#include <cmath>

#include "collision.hpp"
#include "collision/pair_contacts.hpp"
#include "collision/smooth.hpp"

using namespace dyn;
using namespace dyn::capi;

extern "C" {

dynStatus dyn_geometry_contacts(const dynGeometryPair* pair, double margin, double tolerance, dynContact* contacts, int* count) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_geometry_contacts";
  if (!pair) return fail(DYN_ERROR_ARGUMENT, "%s: pair is NULL: it is required", function);
  const Given<dynGeometryPair> given(function, pair);
  if (given.status != DYN_OK) return given.status;
  PlacedShape A, B;
  collision::Options options;
  dynStatus s = read_pair(function, *given, A, B);
  if (s == DYN_OK) s = check_margin(function, margin);
  if (s == DYN_OK) s = read_tolerance(function, tolerance, options);
  if (s != DYN_OK) return s;
  if (!contacts || !count)
    return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, contacts ? "count" : "contacts");
  collision::Workspace workspace;
  collision::Manifold found;
  collision::contacts(A.shape, A.X, B.shape, B.X, margin, workspace, found, options);
  for (int i = 0; i < found.count; ++i) contacts[i] = collision::contact_of(found, i);
  *count = found.count;
  return DYN_OK;
}

dynStatus dyn_contacts(const dynModel* model, dynData* data, const double* q, double margin, dynContact* contacts, int capacity,
                       int* count) {
  Call call(model, data, DYN_PART_COLLISION, "dyn_contacts");
  if (!call) return call.status;
  if (const dynStatus s = check_margin(call.function, margin)) return s;
  if (const dynStatus s = check_capacity(call.function, capacity)) return s;
  if (!call.required("contacts", contacts, capacity) || !call.required("count", count) ||
      !call.inputs(q, nullptr, nullptr, nullptr))
    return call.status;
  if (!placed(call)) return call.status;
  *count = int(collision::contacts(call.m(), call.d(), margin, contacts, capacity));
  return DYN_OK;
}

dynStatus dyn_smooth_distances(const dynModel* model, dynData* data, const double* q, double smoothing, double* distances,
                               double* gradients, int* points) {
  Call call(model, data, DYN_PART_COLLISION, "dyn_smooth_distances");
  if (!call || !listed(call)) return call.status;
  if (!(smoothing >= shape::min_length && smoothing <= shape::max_length))
    return fail(std::isfinite(smoothing) ? DYN_ERROR_ARGUMENT : DYN_ERROR_NONFINITE,
                "dyn_smooth_distances: smoothing is %g: give metres from %g to %g", smoothing, shape::min_length,
                shape::max_length);
  if (!call.inputs(q, nullptr, nullptr, nullptr) || !placed(call)) return call.status;
  const Model& m = call.m();
  collision::place_geoms(m, call.d());
  if (gradients) std::fill_n(gradients, std::ptrdiff_t(m.n.pairs) * m.n.nv, 0.0);
  for (Index k = 0; k < m.n.pairs; ++k) {
    double distance = shape::infinity;
    int count = 0;
    if (call.d().pair_states[k] == DYN_PAIR_REASON_TESTED)
      count = collision::smooth_distance(m, call.d(), k, smoothing, distance, gradients ? gradients + k : nullptr, m.n.pairs);
    if (distances) distances[k] = distance;
    if (points) points[k] = count;
  }
  return DYN_OK;
}

}  // extern "C"
