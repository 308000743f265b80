// Tendons: lengths, rates and moment arms.
#include <cmath>
#include <cstring>

#include "algorithm/paths.hpp"
#include "guard.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

constexpr int points_of_a_turn = 64;  // of an arc: as many as this share of a whole turn

dynTendon default_tendon(dynTendonType type) {
  dynTendon t{};
  t.struct_size = sizeof t, t.type = type;
  t.rest[0] = t.rest[1] = NAN, t.range[0] = -HUGE_VAL, t.range[1] = HUGE_VAL;
  return t;
}
dynTendonElement default_element(dynTendonElementType type) {
  dynTendonElement e{};
  e.struct_size = sizeof e, e.type = type, e.value = 1, e.id = e.side_id = -1;
  return e;
}

// Points of an arc between its ends, on the great circle or the helix.
template <class Point>
void arc_points(const Wrap<double>& w, const PathElement& e, const SE3<double>& X, Point&& point) {
  const Vec3<double> a = transpose_times(X.R, w.first - X.p), b = transpose_times(X.R, w.last - X.p);
  const bool cylinder = e.type == DYN_TENDON_ELEMENT_TYPE_CYLINDER;
  const double rise = cylinder ? b[2] - a[2] : 0, angle = std::sqrt(std::max(0.0, w.length * w.length - rise * rise)) / e.value;
  Vec3<double> n = Vec3<double>::make(0, 0, cross(a, b)[2] < 0 ? -1 : 1);
  if (!cylinder) n = cross(a, b);
  const double size = std::sqrt(dot(n, n));
  if (!(size > 0)) return;
  n = n * ((angle > 3.14159265358979323846 ? -1 : 1) / size);
  const int steps = int(std::ceil(points_of_a_turn * angle / (2 * 3.14159265358979323846)));
  const Vec3<double> flat = cylinder ? Vec3<double>::make(a[0], a[1], 0) : a, across = cross(n, flat);
  for (int k = 1; k < steps; ++k) {
    const double t = double(k) / steps;
    Vec3<double> x = flat * math::cos(t * angle) + across * math::sin(t * angle);
    if (cylinder) x = x + Vec3<double>::make(0, 0, a[2] + t * rise);
    point(X.R * x + X.p);
  }
}

}  // namespace

template <>
dynTendon capi::defaults() {
  return default_tendon(DYN_TENDON_TYPE_FIXED);
}
template <>
dynTendonElement capi::defaults() {
  return default_element(DYN_TENDON_ELEMENT_TYPE_SITE);
}

extern "C" {

void(dyn_tendon_init)(dynTendon* tendon, uint32_t size, dynTendonType type) { initialize(tendon, size, default_tendon(type)); }
void(dyn_tendon_element_init)(dynTendonElement* element, uint32_t size, dynTendonElementType type) {
  initialize(element, size, default_element(type));
}

int dyn_model_ntendons(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.tendons) : -1; }

const char* dyn_model_tendon_name(const dynModel* model, int tendon) {
  if (check(model) != DYN_OK || check_index("dyn_model_tendon_name", "tendon", tendon, model->m->n.tendons) != DYN_OK)
    return nullptr;
  return model->m->string(model->m->tendons()[tendon].name);
}

int dyn_model_tendon_id(const dynModel* model, const char* name) {
  if (check(model) != DYN_OK) return -1;
  const Model& m = *model->m;
  for (Index k = 0; name && k < m.n.tendons; ++k)
    if (std::strcmp(m.string(m.tendons()[k].name), name) == 0) return int(k);
  fail(DYN_ERROR_NAME, "there is no tendon '%.200s': the model has %d, see dyn_model_tendon_name", name ? name : "(NULL)",
       int(m.n.tendons));
  return -1;
}

dynStatus dyn_model_tendon_info(const dynModel* model, int tendon, dynTendon* out) {
  if (const dynStatus s = check(model)) return s;
  if (const dynStatus s = check_struct("dyn_model_tendon_info", "out", out)) return s;
  if (const dynStatus s = check_index("dyn_model_tendon_info", "tendon", tendon, model->m->n.tendons)) return s;
  write_struct(model->m->tendons()[tendon].spec, out);
  return DYN_OK;
}

dynStatus dyn_model_tendon_element(const dynModel* model, int tendon, int element, dynTendonElement* out) {
  if (const dynStatus s = check(model)) return s;
  if (const dynStatus s = check_struct("dyn_model_tendon_element", "out", out)) return s;
  const Model& m = *model->m;
  if (const dynStatus s = check_index("dyn_model_tendon_element", "tendon", tendon, m.n.tendons)) return s;
  const PathRecord& p = m.paths()[tendon];
  if (element < 0 || element >= p.elements)
    return fail(DYN_ERROR_ARGUMENT, "dyn_model_tendon_element: element %d does not exist: tendon '%s' has %d", element,
                m.string(m.tendons()[tendon].name), int(p.elements));
  const PathElement& e = m.path_elements()[p.first + element];
  dynTendonElement x = default_element(e.type);
  x.value = e.value, x.id = e.id, x.side_id = e.side_id;
  if (e.type == DYN_TENDON_ELEMENT_TYPE_JOINT) x.name = m.string(m.joints()[e.id].name);
  else if (e.type != DYN_TENDON_ELEMENT_TYPE_PULLEY) x.name = m.string(m.frames()[e.id].name);
  if (e.side_id >= 0) x.side = m.string(m.frames()[e.side_id].name);
  write_struct(x, out);
  return DYN_OK;
}

dynStatus dyn_tendons(const dynModel* model, dynData* data, const double* q, const double* v, double* length, double* velocity,
                      double* J) {
  Call call(model, data, 0, "dyn_tendons");
  if (!call || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  ensure_position(m, d);
  measure_paths(m, d);
  const Index n = m.n.tendons;
  std::copy_n(d.path_length, n, d.tendon_length), std::copy_n(d.path_velocity, n, d.tendon_velocity);
  d.mark_fresh(Stage::Tendons);
  if (length) std::copy_n(d.path_length, n, length);
  if (velocity) std::copy_n(d.path_velocity, n, velocity);
  if (!J) return DYN_OK;
  std::fill_n(J, std::ptrdiff_t(n) * m.n.nv, 0.0);
  for (Index t = 0; t < n; ++t)
    for (Index k = m.paths()[t].first_dof, end = k + m.paths()[t].dofs; k < end; ++k)
      J[t + std::ptrdiff_t(n) * m.path_dofs()[k]] = d.path_moment[k];
  return DYN_OK;
}

int dyn_tendon_path(const dynModel* model, dynData* data, int tendon, int capacity, double* points, int32_t* begins) {
  Call call(model, data, 0, "dyn_tendon_path");
  if (!call || check_index(call.function, "tendon", tendon, call.m().n.tendons) != DYN_OK) return -1;
  const Model& m = call.m();
  Data<double>& d = call.d();
  if (capacity < 0 || (capacity > 0 && !points)) {
    fail(DYN_ERROR_ARGUMENT, "%s: capacity is %d and points is %s", call.function, capacity, points ? "given" : "NULL");
    return -1;
  }
  if (!d.fresh(Stage::Tendons)) {
    fail(DYN_ERROR_STALE, "%s: call dyn_tendons first", call.function);
    return -1;
  }
  const PathRecord& p = m.paths()[tendon];
  int count = 0;
  const auto point = [&](const Vec3<double>& x, bool first) {
    if (count < capacity) {
      store3(x, points + 3 * count);
      if (begins) begins[count] = first;
    }
    ++count;
  };
  if (p.kind != PathKind::Spatial) return 0;
  const PathPieces<double> pieces{m, d};
  pieces.walk(
      p, [&](const PathPoint<double>& a) { point(a.x, true); },
      [&](const PathPoint<double>&, const PathPoint<double>& b, double) { point(b.x, false); },
      [&](const Wrap<double>& w, const PathElement& e, double) {
        arc_points(w, e, {d.R[e.place] * e.X.R, pieces.position(e.place, e.X.p)},
                   [&](const Vec3<double>& x) { point(x, false); });
        point(w.last, false);
      });
  return count;
}

}  // extern "C"
