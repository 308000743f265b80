// Descriptions of the types of joints, shapes, constraints, effects and contact solvers, and of integrators.
#include "collision/geom.hpp"
#include "constraint/list.hpp"
#include "effect/list.hpp"
#include "joint/describe.hpp"
#include "reflection.hpp"
#include "shape/list.hpp"
#include "solver/list.hpp"
#include "table/integrators.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// The info of a value, or the refusal of what is none. S begins with struct_size and has name and sentence.
template <class S, class E, class F>
dynStatus describe(E id, S* info, const char* function, const char* argument, F&& fill_in) {
  if (const dynStatus s = check_struct(function, "info", info)) return s;
  if (const dynStatus s = check_value(id, function, argument)) return s;
  const EnumValue& value = *find_value(Members<E>::type, raw(id));
  S out = {};
  out.name = value.name, out.sentence = value.sentence;
  fill_in(out);
  write_struct(out, info);
  return DYN_OK;
}

}  // namespace

extern "C" {

dynStatus dyn_joint_type_info(dynJointType type, dynJointTypeInfo* info) {
  return describe(type, info, "dyn_joint_type_info", "type", [&](dynJointTypeInfo& out) {
    out.chain = "";
    visit_kind(type, [&]<class K>() {
      constexpr const KindText& text = kind_text<K>;
      out.nq = K::nq, out.nv = K::nv, out.axis = text.axis, out.axis2 = text.axis2, out.pitch = text.pitch,
      out.chain = text.chain;
    });
  });
}

dynStatus dyn_shape_type_info(dynShapeType type, dynShapeTypeInfo* info) {
  return describe(type, info, "dyn_shape_type_info", "type", [&](dynShapeTypeInfo& out) {
    for (const char*& size : out.size) size = "";
    shape::visit_type(type, [&]<class S>() {
      for (const char* size : S::size_names) out.size[out.sizes++] = size;
      out.convex = int(S::type) < shape::type_count, out.surface = S::from_surface;
    });
  });
}

dynStatus dyn_constraint_type_info(dynConstraintType type, dynConstraintTypeInfo* info) {
  return describe(type, info, "dyn_constraint_type_info", "type", [&](dynConstraintTypeInfo& out) {
    Constraint c = {};
    c.type = type;
    out.rows = type == DYN_CONSTRAINT_TYPE_LOOP ? 0 : constraint_rows(c);
    out.joints = between_joints(type), out.one_sided = one_sided(type);
  });
}

dynStatus dyn_integrator_info(dynIntegrator integrator, dynIntegratorInfo* info) {
  return describe(integrator, info, "dyn_integrator_info", "integrator", [&](dynIntegratorInfo& out) {
    for (const IntegratorRow& row : integrator_rows)
      if (row.id == integrator)
        out.order = row.order, out.evaluations = row.evaluations, out.implicit = row.implicit, out.estimates = row.estimates;
  });
}

dynStatus dyn_effect_type_info(uint32_t bit, dynEffectTypeInfo* info) {
  if (const dynStatus s = check_struct("dyn_effect_type_info", "info", info)) return s;
  const EnumValue* value = effect_value(bit);
  if (!value)
    return fail(DYN_ERROR_ARGUMENT, "dyn_effect_type_info: bit is 0x%x: give one DYN_EFFECT_... that is a single bit",
                unsigned(bit));
  dynEffectTypeInfo out = {};
  out.bit = bit, out.name = value->name, out.sentence = value->sentence, out.array = -1, out.quantity = "";
  for_each_effect([&]<class E>() {
    if (E::bit != bit) return;
    out.part = E::part, out.implicit = int(E::implicit), out.absent = E::absent;
    if constexpr (effect::HasCoefficient<E>) out.array = E::array, out.quantity = E::quantity;
  });
  write_struct(out, info);
  return DYN_OK;
}

dynStatus dyn_contact_solver_type_info(dynContactSolverType type, dynContactSolverTypeInfo* info) {
  return describe(type, info, "dyn_contact_solver_type_info", "type",
                  [&](dynContactSolverTypeInfo& out) { out.refined = solver::refined[type]; });
}

}  // extern "C"
