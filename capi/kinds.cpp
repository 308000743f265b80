// Descriptions of the types of joints, shapes and constraints, and of integrators.
#include "collision/geom.hpp"
#include "constraint/list.hpp"
#include "joint/describe.hpp"
#include "reflection.hpp"
#include "shape/list.hpp"
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
      out.nq = K::nq, out.nv = K::nv, out.axis = text.axis, out.axis2 = text.axis2, out.pitch = text.pitch, out.chain = text.chain;
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
      if (row.id == integrator) out.order = row.order, out.evaluations = row.evaluations, out.implicit = row.implicit, out.estimates = row.estimates;
  });
}

}  // extern "C"
