// Models: sizes, names, and what they say of themselves.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "effect/list.hpp"
#include "model/colour.hpp"
#include "guard.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// Binary search in ids sorted by name; f(id) is the name. The first of equals, or count.
template <class Name>
Index lower_bound(const Index* ids, Index count, const char* name, Name f) {
  Index low = 0, high = count;
  while (low < high) {
    const Index mid = low + (high - low) / 2;
    if (std::strcmp(f(ids[mid]), name) < 0) low = mid + 1;
    else high = mid;
  }
  return low;
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }

// b holds a, but for case
bool holds(const char* b, const char* a) {
  for (; *b; ++b) {
    std::size_t k = 0;
    while (a[k] && lower(a[k]) == lower(b[k])) ++k;
    if (!a[k]) return true;
  }
  return !*a;
}

// The same but for case, one (of at least three letters) within the other, or at most two edits apart (Levenshtein 1966).
bool similar(const char* x, const char* y) {
  const std::size_t nx = std::strlen(x), ny = std::strlen(y);
  if (nx == ny ? holds(y, x) : (nx > 2 && holds(y, x)) || (ny > 2 && holds(x, y))) return true;
  if (nx > 64 || ny > 64 || nx < 4) return false;
  std::size_t row[65];
  for (std::size_t j = 0; j <= ny; ++j) row[j] = j;
  for (std::size_t i = 1; i <= nx; ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= ny; ++j) {
      const std::size_t change = diagonal + (lower(x[i - 1]) != lower(y[j - 1]));
      diagonal = row[j];
      row[j] = std::min({change, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[ny] <= 2;
}

// An error that names up to three near misses. No heap.
template <class Name>
int unknown(const char* kind, const char* name, Index count, Name f) {
  const char* near[3] = {"", "", ""};
  int found = 0;
  for (Index k = 0; k < count && found < 3; ++k)
    if (similar(name, f(k))) near[found++] = f(k);
  const char *open = ", '", *close = "'";
  fail(DYN_ERROR_NAME, "there is no %s '%.200s'%s%.200s%s%s%.200s%s%s%.200s%s%s", kind, name, found > 0 ? ": did you mean '" : "",
       near[0], found > 0 ? close : "", found > 1 ? open : "", near[1], found > 1 ? close : "", found > 2 ? open : "", near[2],
       found > 2 ? close : "", found ? "?" : "");
  return -1;
}

}  // namespace

Index capi::find_configuration(const Model& m, const char* name) {
  const auto at = [&](Index k) { return m.string(m.configuration_names()[k]); };
  for (Index k = 0; k < m.n.configurations; ++k)
    if (std::strcmp(at(k), name) == 0) return k;
  return unknown("configuration", name, m.n.configurations, at);
}

extern "C" {

int dyn_model_report_count(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.reports) : -1; }

dynStatus dyn_model_report_entry(const dynModel* model, int index, dynReportEntry* entry) {
  if (const dynStatus s = check(model)) return s;
  const Model& m = *model->m;
  if (const dynStatus s = check_struct("dyn_model_report_entry", "entry", entry)) return s;
  if (const dynStatus s = check_index("dyn_model_report_entry", "report entry", index, m.n.reports)) return s;
  const ReportRecord& r = m.reports()[index];
  write_struct({0, r.level, r.line, m.string(r.message)}, entry);
  return DYN_OK;
}

int dyn_model_nq(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.nq) : -1; }
int dyn_model_nv(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.nv) : -1; }
int dyn_model_njoints(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.joints) : -1; }
int dyn_model_nframes(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.frames) : -1; }
int dyn_model_nbodies(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.links) : -1; }
size_t dyn_model_size(const dynModel* model) { return check(model) == DYN_OK ? size_t(model->m->bytes) : 0; }

const char* dyn_model_name(const dynModel* model) {
  return check(model) == DYN_OK ? model->m->string(model->m->model_name) : nullptr;
}

const char* dyn_model_joint_name(const dynModel* model, int joint) {
  if (check(model) != DYN_OK || check_index("dyn_model_joint_name", "joint", joint, model->m->n.joints) != DYN_OK)
    return nullptr;
  return model->m->string(model->m->joints()[joint].name);
}

const char* dyn_model_frame_name(const dynModel* model, int frame) {
  if (check(model) != DYN_OK || check_index("dyn_model_frame_name", "frame", frame, model->m->n.frames) != DYN_OK)
    return nullptr;
  return model->m->string(model->m->frames()[frame].name);
}

int dyn_model_joint_id(const dynModel* model, const char* name) {
  if (check(model) != DYN_OK) return -1;
  if (!name) return fail(DYN_ERROR_ARGUMENT, "dyn_model_joint_id: name is NULL"), -1;
  const Model& m = *model->m;
  auto at = [&](Index k) { return m.string(m.joints()[k].name); };
  const Index k = lower_bound(m.joints_by_name(), m.n.joints, name, at);
  if (k < m.n.joints && std::strcmp(at(m.joints_by_name()[k]), name) == 0) return int(m.joints_by_name()[k]);
  return unknown("joint", name, m.n.joints, at);
}

static const char* frame_type_name(int type) {
  switch (type) {
    case DYN_FRAME_TYPE_OP_FRAME: return "OP_FRAME";
    case DYN_FRAME_TYPE_JOINT: return "JOINT";
    case DYN_FRAME_TYPE_FIXED_JOINT: return "FIXED_JOINT";
    case DYN_FRAME_TYPE_BODY: return "BODY";
    case DYN_FRAME_TYPE_SENSOR: return "SENSOR";
  }
  return nullptr;
}

static int frame_id(const dynModel* model, const char* name, int type, const char* function) {
  if (check(model) != DYN_OK) return -1;
  if (!name) return fail(DYN_ERROR_ARGUMENT, "%s: name is NULL", function), -1;
  const Model& m = *model->m;
  auto at = [&](Index k) { return m.string(m.frames()[k].name); };
  int other = 0;
  for (Index k = lower_bound(m.frames_by_name(), m.n.frames, name, at); k < m.n.frames; ++k) {
    const Index id = m.frames_by_name()[k];
    if (std::strcmp(at(id), name) != 0) break;
    if (!type || m.frames()[id].type == type) return int(id);
    other = m.frames()[id].type;
  }
  if (other)
    return fail(DYN_ERROR_NAME,
                "%s: frame '%.200s' is no %s frame, it is a %s frame: ask for that type, or use dyn_model_frame_id", function,
                name, frame_type_name(type), frame_type_name(other)),
           -1;
  return unknown("frame", name, m.n.frames, at);
}

int dyn_model_frame_id(const dynModel* model, const char* name) { return frame_id(model, name, 0, "dyn_model_frame_id"); }
int dyn_model_frame_id_of_type(const dynModel* model, const char* name, dynFrameType type) {
  if (check(model) == DYN_OK && !frame_type_name(int(type)))
    return fail(DYN_ERROR_ARGUMENT, "dyn_model_frame_id_of_type: %d is no dynFrameType: use a DYN_FRAME_TYPE_... value",
                int(type)),
           -1;
  return frame_id(model, name, int(type), "dyn_model_frame_id_of_type");
}

dynStatus dyn_model_joint_info(const dynModel* model, int joint, dynJointInfo* info) {
  if (const dynStatus s = check(model)) return s;
  const Model& m = *model->m;
  if (const dynStatus s = check_struct("dyn_model_joint_info", "info", info)) return s;
  if (const dynStatus s = check_index("dyn_model_joint_info", "joint", joint, m.n.joints)) return s;
  const JointRecord& r = m.joints()[joint];
  dynJointInfo out{};
  out.name = m.string(r.name), out.type = r.type, out.parent = r.parent;
  out.idx_q = r.idx_q, out.idx_v = r.idx_v, out.nq = r.nq, out.nv = r.nv;
  out.mimic_leader = r.leader, out.mimic_ratio = r.ratio, out.mimic_offset = r.offset, out.pitch = r.pitch;
  std::memcpy(out.axis, r.axis, sizeof r.axis), std::memcpy(out.axis2, r.axis2, sizeof r.axis2);
  std::memcpy(out.placement, r.placement, sizeof r.placement);
  write_struct(out, info);
  return DYN_OK;
}

dynStatus dyn_model_frame_info(const dynModel* model, int frame, dynFrameInfo* info) {
  if (const dynStatus s = check(model)) return s;
  const Model& m = *model->m;
  if (const dynStatus s = check_struct("dyn_model_frame_info", "info", info)) return s;
  if (const dynStatus s = check_index("dyn_model_frame_info", "frame", frame, m.n.frames)) return s;
  const FrameRecord& r = m.frames()[frame];
  dynFrameInfo out{};
  out.name = m.string(r.name), out.type = r.type, out.joint = r.joint;
  std::memcpy(out.placement, r.placement, sizeof r.placement);
  const LinkRecord link = r.link >= 0 ? m.links()[r.link] : LinkRecord{};
  out.mass = link.mass;
  std::memcpy(out.com, link.com, sizeof link.com), std::memcpy(out.inertia, link.inertia, sizeof link.inertia);
  write_struct(out, info);
  return DYN_OK;
}

int dyn_model_nshapes(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.shapes) : -1; }

dynStatus dyn_model_shape_info(const dynModel* model, int shape, dynShapeInfo* info) {
  if (const dynStatus s = check(model)) return s;
  const Model& m = *model->m;
  if (const dynStatus s = check_struct("dyn_model_shape_info", "info", info)) return s;
  if (const dynStatus s = check_index("dyn_model_shape_info", "shape", shape, m.n.shapes)) return s;
  const ShapeRecord& r = m.shapes()[shape];
  dynShapeInfo out{};
  out.name = m.string(r.name), out.mesh = m.string(r.mesh), out.type = r.type, out.role = dynShapeRole(r.role),
  out.frame = r.frame;
  std::memcpy(out.placement, r.placement, sizeof r.placement), std::memcpy(out.size, r.size, sizeof r.size);
  out.radius = r.radius, out.contype = r.contype, out.conaffinity = r.conaffinity, out.material = shape::acting(m.materials()[r.material], r.latent);
  write_struct(out, info);
  return DYN_OK;
}

dynStatus dyn_model_shape_rgba(const dynModel* model, int shape, double rgba[4]) {
  if (const dynStatus s = check(model)) return s;
  if (!rgba) return fail(DYN_ERROR_ARGUMENT, "dyn_model_shape_rgba: rgba is NULL");
  if (const dynStatus s = check_index("dyn_model_shape_rgba", "shape", shape, model->m->n.shapes)) return s;
  const std::array<double, 4> x = rgba_of(model->m->shapes()[shape].colour);
  std::copy(x.begin(), x.end(), rgba);
  return DYN_OK;
}

int dyn_model_ndisabled_pairs(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.disabled) : -1; }

dynStatus dyn_model_disabled_pair(const dynModel* model, int pair, int* frame1, int* frame2, const char** reason) {
  if (const dynStatus s = check(model)) return s;
  const Model& m = *model->m;
  if (const dynStatus s = check_index("dyn_model_disabled_pair", "pair", pair, m.n.disabled)) return s;
  const DisabledRecord& r = m.disabled_pairs()[pair];
  if (frame1) *frame1 = r.frame1;
  if (frame2) *frame2 = r.frame2;
  if (reason) *reason = m.string(r.reason);
  return DYN_OK;
}

const double* dyn_model_array(const dynModel* model, dynModelArray which) {
  if (check(model) != DYN_OK) return nullptr;
  const Model& m = *model->m;
  switch (which) {
    case DYN_MODEL_ARRAY_LOWER_LIMIT: return m.lower_limit();
    case DYN_MODEL_ARRAY_UPPER_LIMIT: return m.upper_limit();
    case DYN_MODEL_ARRAY_VELOCITY_LIMIT: return m.velocity_limit();
    case DYN_MODEL_ARRAY_EFFORT_LIMIT: return m.effort_limit();
    case DYN_MODEL_ARRAY_SPRING_REFERENCE: return m.spring_reference();
    case DYN_MODEL_ARRAY_GRAVITY: return m.gravity;
    default: break;
  }
  const double* coefficients = nullptr;
  for_each_coefficient([&]<class E>() {
    if (which == E::array) coefficients = E::of(m);
  });
  if (coefficients) return coefficients;
  fail(DYN_ERROR_ARGUMENT, "dyn_model_array: %d is no dynModelArray", int(which));
  return nullptr;
}

double dyn_model_total_mass(const dynModel* model) {
  return check(model) == DYN_OK ? model->m->total_mass : std::numeric_limits<double>::quiet_NaN();
}

int dyn_model_nconfigurations(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.configurations) : -1; }

const char* dyn_model_configuration_name(const dynModel* model, int index) {
  if (check(model) != DYN_OK ||
      check_index("dyn_model_configuration_name", "configuration", index, model->m->n.configurations) != DYN_OK)
    return nullptr;
  return model->m->string(model->m->configuration_names()[index]);
}

dynStatus dyn_model_configuration(const dynModel* model, const char* name, double* q) {
  if (const dynStatus s = check(model)) return s;
  const Model& m = *model->m;
  if (!name || (!q && m.n.nq)) return fail(DYN_ERROR_ARGUMENT, "dyn_model_configuration: %s is NULL", name ? "q" : "name");
  const Index k = find_configuration(m, name);
  if (k < 0) return DYN_ERROR_NAME;
  copy_out(m.configurations() + std::ptrdiff_t(k) * m.n.nq, m.n.nq, q);
  return DYN_OK;
}

int dyn_model_initial_configuration(const dynModel* model) {
  return check(model) == DYN_OK ? int(model->m->simulation()->initial) : -1;
}

dynStatus dyn_model_q_permutation(const dynModel* model, const char* const* names, size_t count, int32_t* idx_q, int32_t* idx_v) {
  if (const dynStatus s = check(model)) return s;
  if (!names && count) return fail(DYN_ERROR_ARGUMENT, "dyn_model_q_permutation: names is NULL");
  const Model& m = *model->m;
  auto id = [&](size_t k) { return dyn_model_joint_id(model, names[k]); };
  for (size_t k = 0; k < count; ++k) {
    if (!names[k]) return fail(DYN_ERROR_ARGUMENT, "dyn_model_q_permutation: names[%zu] is NULL", k);
    const int j = id(k);
    if (j < 0) return DYN_ERROR_NAME;
    if (j == 0) return fail(DYN_ERROR_NAME, "dyn_model_q_permutation: the universe has no coordinates: leave it out");
  }
  // repeated names, some joints at a time: no heap
  constexpr int some = 4096;
  for (int first = 0; first < int(m.n.joints); first += some) {
    bool seen[some] = {};
    for (size_t k = 0; k < count; ++k) {
      const int j = id(k) - first;
      if (j < 0 || j >= some) continue;
      if (seen[j])
        return fail(DYN_ERROR_NAME, "dyn_model_q_permutation: joint '%.200s' is named twice: name each joint once", names[k]);
      seen[j] = true;
    }
  }
  for (size_t k = 0; k < count; ++k) {
    const JointRecord& joint = m.joints()[id(k)];
    if (idx_q) idx_q[k] = joint.idx_q;
    if (idx_v) idx_v[k] = joint.idx_v;
  }
  return DYN_OK;
}

}  // extern "C"
