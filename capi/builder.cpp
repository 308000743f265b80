// The builder: C structs to the builder's own.
#include <cstring>

#include "model/colour.hpp"
#include "surfaces.hpp"
#include "handles.hpp"
#include "host.hpp"
#include "table/names.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// Throws when the caller's struct is refused.
template <class S>
const S& sound(const Given<S>& given) {
  if (given.status != DYN_OK) throw Error(given.status, dyn_last_error());
  return *given;
}

// depth bounds composites of composites
JointSpec read_spec(const char* function, const dynJointSpec& s, int depth) {
  if (depth > 16) throw Error(DYN_ERROR_LIMIT, "dynJointSpec: composites more than 16 deep");
  require_value(s.type, "dynJointSpec", "type");
  JointSpec out;
  if (s.name) out.name = s.name;
  out.type = s.type;
  if (s.parent) out.parent.name = s.parent;
  std::copy(s.placement, s.placement + 12, out.placement.begin());
  std::copy(s.axis, s.axis + 3, out.axis.begin());
  std::copy(s.axis2, s.axis2 + 3, out.axis2.begin());
  out.pitch = s.pitch;
  if (s.parts_count && !s.parts) throw Error(DYN_ERROR_ARGUMENT, "dynJointSpec: parts is NULL but parts_count is not 0");
  if (s.parts_count > 1000) throw Error(DYN_ERROR_LIMIT, "dynJointSpec: more than 1000 parts");
  if (s.type != DYN_JOINT_TYPE_COMPOSITE && (s.parts || s.parts_count))
    throw Error(DYN_ERROR_ARGUMENT, "joint '" + out.name + "': parts are given, but its type is " + name_of(s.type) +
                                        ": use DYN_JOINT_TYPE_COMPOSITE, or leave parts NULL");
  for (size_t k = 0; k < s.parts_count; ++k) {
    const auto* part = reinterpret_cast<const dynJointSpec*>(reinterpret_cast<const char*>(s.parts) + k * s.parts->struct_size);
    if (part->struct_size != s.parts->struct_size)
      throw Error(DYN_ERROR_SIZE, "dynJointSpec: struct_size is " + std::to_string(part->struct_size) + " of part " +
                                      std::to_string(k) + " and " + std::to_string(s.parts->struct_size) +
                                      " of the first: call dyn_joint_spec_init for each");
    out.parts.push_back(read_spec(function, sound(Given<dynJointSpec>(function, part)), depth + 1));
  }
  return out;
}

// With the numbers that only a whole joint has.
JointSpec read_joint(const char* function, const dynJointSpec* spec) {
  const Given<dynJointSpec> given(function, spec);
  const dynJointSpec& s = sound(given);
  JointSpec out = read_spec(function, s, 0);
  const int nq = spec_nq(out), nv = spec_nv(out);
  auto read = [](const double* x, int n) { return x ? std::vector<double>(x, x + n) : std::vector<double>(); };
  out.lower = read(s.lower, nq), out.upper = read(s.upper, nq);
  out.velocity = read(s.velocity, nv), out.effort = read(s.effort, nv);
#define COEFFICIENT(name, has, sentence) out.name = read(s.name, nv);
#include "effect/coefficients.def"
  out.spring_reference = read(s.spring_reference, nq);
  out.rotor_inertia = s.rotor_inertia, out.gear_ratio = s.gear_ratio;
  if (s.mimic) out.mimic = s.mimic;
  out.mimic_ratio = s.mimic_ratio, out.mimic_offset = s.mimic_offset;
  return out;
}

Placement read_placement(const double* x) {
  if (!x) return identity_placement;
  Placement p;
  std::copy(x, x + 12, p.begin());
  return p;
}

// No robot has more.
dynStatus check_array(const char* function, const char* name, const void* x, std::size_t n) {
  if (!x && n) return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL", function, name);
  return n <= std::size_t(INT32_MAX)
             ? DYN_OK
             : fail(DYN_ERROR_SIZE, "%s: %s has %zu elements: give at most %d", function, name, n, INT32_MAX);
}

dynStatus make_builder_handle(std::unique_ptr<Builder> b, dynBuilder** out) {
  dynBuilder* handle = new_handle<dynBuilder>();
  if (!handle) throw std::bad_alloc();
  handle->b = b.release();
  handle->magic = live_builder;
  *out = handle;
  return DYN_OK;
}

}  // namespace

template <>
dynJointSpec capi::defaults() {
  dynJointSpec s{};
  s.type = DYN_JOINT_TYPE_REVOLUTE;
  s.placement[0] = s.placement[4] = s.placement[8] = 1;
  s.axis[2] = s.axis2[0] = 1;
  s.gear_ratio = s.mimic_ratio = 1;
  return s;
}

template <>
dynShapeSpec capi::defaults() {
  dynShapeSpec s{};
  s.type = DYN_SHAPE_TYPE_BOX, s.role = DYN_SHAPE_ROLE_COLLISION;
  s.contype = s.conaffinity = 1;
  s.material = shape::default_material();
  s.placement[0] = s.placement[4] = s.placement[8] = 1;
  return s;
}

extern "C" {

dynStatus dyn_builder_new(const char* model_name, dynBuilder** builder) {
  if (!builder) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_new: builder is NULL");
  return guarded([&] { return make_builder_handle(std::make_unique<Builder>(text(model_name)), builder); });
}

dynStatus dyn_builder_from_model(const dynModel* model, dynBuilder** builder) {
  if (const dynStatus s = check(model)) return s;
  if (!builder) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_from_model: builder is NULL");
  return guarded([&] { return make_builder_handle(std::make_unique<Builder>(*model->m), builder); });
}

void dyn_builder_free(dynBuilder* builder) {
  if (!builder || builder->magic != live_builder) return;
  delete builder->b;
  builder->b = nullptr;
  free_handle(builder);
}

dynStatus dyn_builder_set_gravity(dynBuilder* builder, const double gravity[3]) {
  if (!gravity) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_set_gravity: gravity is NULL");
  return with(builder, [&](Builder& b) { b.gravity({gravity[0], gravity[1], gravity[2]}); });
}

dynStatus dyn_builder_add_joint(dynBuilder* builder, const dynJointSpec* s) {
  if (!s) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_add_joint: spec is NULL");
  return with(builder, [&](Builder& b) { b.joint(read_joint("dyn_builder_add_joint", s)); });
}

dynStatus dyn_builder_add_body(dynBuilder* builder, const char* name, const char* parent, const double* placement, double mass,
                           const double com[3], const double inertia[9]) {
  if (!com || !inertia) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_add_body: %s is NULL", com ? "inertia" : "com");
  return with(builder, [&](Builder& b) {
    std::array<double, 9> I;
    std::copy(inertia, inertia + 9, I.begin());
    check_moments(std::string("body '") + text(name) + "'", mass, I);
    b.body(text(name), {text(parent), 0}, read_placement(placement), mass, {com[0], com[1], com[2]}, I);
  });
}

dynStatus dyn_builder_add_frame(dynBuilder* builder, const char* name, const char* parent, const double* placement,
                                dynFrameType type) {
  return with(builder, [&](Builder& b) { b.frame(text(name), {text(parent), 0}, read_placement(placement), type); });
}

dynStatus dyn_builder_add_shape(dynBuilder* builder, const dynShapeSpec* spec) {
  if (!spec) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_add_shape: spec is NULL");
  const Given<dynShapeSpec> s("dyn_builder_add_shape", spec);
  if (s.status != DYN_OK) return s.status;
  if (const dynStatus status = check_value(s->type, "dyn_builder_add_shape", "type")) return status;
  if (const dynStatus status = check_value(s->role, "dyn_builder_add_shape", "role")) return status;
  SurfacePtr surface;
  if (const dynStatus status = surface_argument("dyn_builder_add_shape", "spec", s->type, s->surface, surface)) return status;
  return with(builder, [&](Builder& b) {
    Shape shape{text(s->name), s->type, s->role, text(s->body), read_placement(s->placement), {}, text(s->mesh)};
    std::copy(s->size, s->size + 3, shape.size.begin());
    shape.surface = surface;
    shape.radius = s->radius, shape.contype = s->contype, shape.conaffinity = s->conaffinity, shape.material = {s->material};
    b.shape(shape);
  });
}

dynStatus dyn_builder_set_shape_rgba(dynBuilder* builder, const double rgba[4]) {
  for (int i = 0; i < 4; ++i)
    if (!rgba || !(rgba[i] >= 0 && rgba[i] <= 1))
      return fail(DYN_ERROR_ARGUMENT, "dyn_builder_set_shape_rgba: rgba is not four numbers from 0 to 1");
  return with(builder, [&](Builder& b) { b.colour(packed_colour(rgba)); });
}

dynStatus dyn_builder_set_shape_fluid(dynBuilder* builder, const double coefficients[5], const double semiaxes[3],
                                      const double placement[12]) {
  constexpr const char* function = "dyn_builder_set_shape_fluid";
  if (placement && !semiaxes) return fail(DYN_ERROR_ARGUMENT, "%s: semiaxes is NULL: placement needs it", function);
  for (int i = 0; semiaxes && i < 3; ++i)
    if (!(semiaxes[i] > 0))
      return fail(DYN_ERROR_ARGUMENT, "%s: semiaxes[%d] is %g: give metres above 0", function, i, semiaxes[i]);
  return with(builder, [&](Builder& b) {
    FluidShape x;
    if (coefficients) std::copy(coefficients, coefficients + 5, x.coefficients.begin());
    if (semiaxes) std::copy(semiaxes, semiaxes + 3, x.semiaxes.begin());
    b.fluid(x, placement ? std::optional(read_placement(placement)) : std::nullopt);
  });
}

dynStatus dyn_builder_add_configuration(dynBuilder* builder, const char* name, const double* q, size_t nq) {
  if (const dynStatus s = check_array("dyn_builder_add_configuration", "q", q, nq)) return s;
  return with(builder, [&](Builder& b) { b.configuration(text(name), std::vector<double>(q, q + nq)); });
}

dynStatus dyn_builder_lock(dynBuilder* builder, const char* const* joints, size_t count, const double* q, size_t nq) {
  if (const dynStatus s = check_array("dyn_builder_lock", "joints", joints, count)) return s;
  if (const dynStatus s = check_array("dyn_builder_lock", "q", q, nq)) return s;
  for (size_t k = 0; k < count; ++k)
    if (!joints[k]) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_lock: joints[%zu] is NULL", k);
  return with(builder, [&](Builder& b) { b.lock({joints, joints + count}, {q, q + nq}); });
}

dynStatus dyn_builder_attach(dynBuilder* builder, const dynModel* model, const char* prefix, const dynJointSpec* joint) {
  if (const dynStatus s = check(model)) return s;
  return with(builder, [&](Builder& b) {
    const JointSpec spec = joint ? read_joint("dyn_builder_attach", joint) : JointSpec();
    b.attach(*model->m, text(prefix), joint ? &spec : nullptr);
  });
}

dynStatus dyn_builder_keep_subtree(dynBuilder* builder, const char* joint) {
  if (!joint) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_keep_subtree: joint is NULL");
  return with(builder, [&](Builder& b) { b.subtree(joint); });
}

dynStatus dyn_builder_remove_subtree(dynBuilder* builder, const char* joint) {
  if (!joint) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_remove_subtree: joint is NULL");
  return with(builder, [&](Builder& b) { b.remove(joint); });
}

int dyn_builder_parameter_count(dynBuilder* builder) {
  if (check(builder)) return -1;
  int count = -1;
  (void)guarded([&] { return count = int(builder->b->parameters().size()), DYN_OK; });
  return count;
}

dynStatus dyn_builder_parameter(dynBuilder* builder, int index, dynParameter* out) {
  if (const dynStatus s = check(builder)) return s;
  if (const dynStatus s = check_struct("dyn_builder_parameter", "out", out)) return s;
  return guarded([&] {
    const std::vector<Parameter>& all = builder->b->parameters();
    if (index < 0 || std::size_t(index) >= all.size())
      return fail(DYN_ERROR_ARGUMENT, "dyn_builder_parameter: index is %d, and there are %zu", index, all.size());
    const Parameter& p = all[std::size_t(index)];
    write_struct({sizeof *out, p.group, p.object, p.name.c_str(), p.quantity, p.values.data(), p.values.size()}, out);
    return DYN_OK;
  });
}

dynStatus dyn_builder_set_parameter(dynBuilder* builder, int index, const double* values, size_t count) {
  if (const dynStatus s = check(builder)) return s;
  if (const dynStatus s = check_array("dyn_builder_set_parameter", "values", values, count)) return s;
  return guarded([&] {
    const std::size_t n = builder->b->parameters().size();
    if (index < 0 || std::size_t(index) >= n)
      return fail(DYN_ERROR_ARGUMENT, "dyn_builder_set_parameter: index is %d, and there are %zu", index, n);
    builder->b->set_parameter(std::size_t(index), {values, values + count});
    return DYN_OK;
  });
}

dynStatus dyn_builder_finish(dynBuilder* builder, dynModel** model) {
  if (!model) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_finish: model is NULL");
  if (const dynStatus s = check(builder)) return s;
  return guarded([&] { return make_handle(builder->b->finish(), model); });
}

}  // extern "C"
