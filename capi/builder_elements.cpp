// The builder: constraints, tendons, actuators, sensors, and what acts on bodies.
#include <algorithm>
#include <array>
#include <vector>

#include "host.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

dynStatus add_actuator(const char* function, dynBuilder* builder, const char* name, const dynActuator* actuator,
                       const char* target,
                       const char* reference) {
  if (const dynStatus s = check(builder)) return s;
  if (!actuator) return fail(DYN_ERROR_ARGUMENT, "%s: actuator is NULL: it is required", function);
  const Given<dynActuator> given(function, actuator);
  if (given.status != DYN_OK) return given.status;
  return with(builder, [&](Builder& b) { b.actuator(text(name), *given, text(target), text(reference)); });
}

}  // namespace

extern "C" {

dynStatus dyn_builder_add_constraint(dynBuilder* builder, const char* name, const dynConstraint* constraint, const char* first,
                                     const char* second) {
  if (const dynStatus s = check(builder)) return s;
  if (!constraint) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_add_constraint: constraint is NULL");
  const Given<dynConstraint> given("dyn_builder_add_constraint", constraint);
  if (given.status != DYN_OK) return given.status;
  return guarded([&] {
    builder->b->constraint(name ? name : "", *given, {first ? first : "", 0}, {second ? second : "", 0});
    return DYN_OK;
  });
}

dynStatus dyn_builder_set_constraint_slots(dynBuilder* builder, int slots) {
  if (const dynStatus s = check(builder)) return s;
  return guarded([&] {
    builder->b->constraint_slots(slots);
    return DYN_OK;
  });
}

dynStatus dyn_builder_set_contact_capacity(dynBuilder* builder, int contacts) {
  if (const dynStatus s = check(builder)) return s;
  return guarded([&] {
    builder->b->contact_capacity(contacts);
    return DYN_OK;
  });
}

dynStatus dyn_builder_add_tendon(dynBuilder* builder, const char* name, const dynTendon* tendon, const dynTendonElement* elements,
                                 int count) {
  if (const dynStatus s = check(builder)) return s;
  if (!tendon) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_add_tendon: tendon is NULL: it is required");
  const Given<dynTendon> given("dyn_builder_add_tendon", tendon);
  if (given.status != DYN_OK) return given.status;
  if (count < 0 || (count > 0 && !elements))
    return fail(DYN_ERROR_ARGUMENT, "dyn_builder_add_tendon: elements is %s and count is %d", elements ? "given" : "NULL", count);
  return with(builder, [&](Builder& b) {
    std::vector<TendonElement> parts;
    const char* next = reinterpret_cast<const char*>(elements);
    for (int k = 0; k < count; ++k) {
      const Given<dynTendonElement> e("dyn_builder_add_tendon", reinterpret_cast<const dynTendonElement*>(next));
      if (e.status != DYN_OK) throw Error(e.status, dyn_last_error());
      parts.push_back({e->type, e->name ? e->name : "", e->side ? e->side : "", e->value});
      next += reinterpret_cast<const dynTendonElement*>(next)->struct_size;
    }
    b.tendon(text(name), *given, parts);
  });
}

dynStatus dyn_builder_couple_tendons(dynBuilder* builder, const char* name, const char* tendon1, const char* tendon2,
                                     const double coefficients[5]) {
  if (const dynStatus s = check(builder)) return s;
  if (!coefficients) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_couple_tendons: coefficients is NULL: it is required");
  return with(builder, [&](Builder& b) {
    std::array<double, 5> c;
    std::copy_n(coefficients, 5, c.begin());
    b.couple_tendons(text(name), text(tendon1), text(tendon2), c);
  });
}

dynStatus dyn_builder_add_actuator(dynBuilder* builder, const char* name, const dynActuator* actuator, const char* target) {
  return add_actuator("dyn_builder_add_actuator", builder, name, actuator, target, "");
}

dynStatus dyn_builder_add_actuator_between(dynBuilder* builder, const char* name, const dynActuator* actuator, const char* frame,
                                           const char* reference) {
  return add_actuator("dyn_builder_add_actuator_between", builder, name, actuator, frame, reference);
}

dynStatus dyn_builder_set_gravity_compensation(dynBuilder* builder, const char* body, double share) {
  return with(builder, [&](Builder& b) { b.gravity_compensation(text(body), share); });
}

dynStatus dyn_builder_set_medium(dynBuilder* builder, double density, double viscosity, const double wind[3]) {
  const std::array<double, 3> still{};
  return with(builder,
              [&](Builder& b) { b.medium(density, viscosity, wind ? std::array<double, 3>{wind[0], wind[1], wind[2]} : still); });
}

dynStatus dyn_builder_add_pair(dynBuilder* builder, const char* shape1, const char* shape2, const dynMaterial* material) {
  return with(builder, [&](Builder& b) { b.pair(text(shape1), text(shape2), material); });
}

dynStatus dyn_builder_limit_actuators(dynBuilder* builder, const char* joint, double lower, double upper, int with_weight) {
  return with(builder, [&](Builder& b) { b.limit_actuators(false, text(joint), lower, upper, with_weight != 0); });
}

dynStatus dyn_builder_limit_tendon_actuators(dynBuilder* builder, const char* tendon, double lower, double upper) {
  return with(builder, [&](Builder& b) { b.limit_actuators(true, text(tendon), lower, upper, false); });
}

dynStatus dyn_builder_add_sensor(dynBuilder* builder, const char* name, const dynSensor* sensor, const char* object,
                                 const char* reference) {
  if (const dynStatus s = check(builder)) return s;
  if (!sensor) return fail(DYN_ERROR_ARGUMENT, "dyn_builder_add_sensor: sensor is NULL: it is required");
  const Given<dynSensor> given("dyn_builder_add_sensor", sensor);
  if (given.status != DYN_OK) return given.status;
  return with(builder, [&](Builder& b) { b.sensor(text(name), *given, text(object), text(reference)); });
}

dynStatus dyn_builder_set_mocap(dynBuilder* builder, const char* body) {
  return with(builder, [&](Builder& b) { b.mocap(text(body)); });
}

}  // extern "C"
