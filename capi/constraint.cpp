// Constraints: of the model, in the builder, and in the slots of a data.
#include <algorithm>
#include <cstring>

#include "constraint.hpp"
#include "model/constraints.hpp"

using namespace dyn;
using namespace dyn::capi;

template <>
dynConstraint capi::defaults() {
  return default_constraint(DYN_CONSTRAINT_TYPE_NONE);
}

extern "C" {

void(dyn_constraint_init)(dynConstraint* constraint, uint32_t size, dynConstraintType type) {
  initialize(constraint, size, default_constraint(type));
}

int dyn_model_contact_capacity(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.contacts) : -1; }
int dyn_model_nconstraints(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.constraints) : -1; }
int dyn_model_nconstraint_slots(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.slots) : -1; }

const char* dyn_model_constraint_name(const dynModel* model, int constraint) {
  if (check(model) != DYN_OK) return nullptr;
  const Model& m = *model->m;
  if (check_index("dyn_model_constraint_name", "constraint", constraint, m.n.constraints) != DYN_OK) return nullptr;
  return m.string(m.constraints()[constraint].name);
}

int dyn_model_constraint_id(const dynModel* model, const char* name) {
  if (check(model) != DYN_OK) return -1;
  const Model& m = *model->m;
  for (Index k = 0; name && k < m.n.constraints; ++k)
    if (std::strcmp(m.string(m.constraints()[k].name), name) == 0) return int(k);
  fail(DYN_ERROR_NAME, "there is no constraint '%.200s': the model has %d, see dyn_model_constraint_name", name ? name : "(NULL)",
       int(m.n.constraints));
  return -1;
}

dynStatus dyn_model_constraint_info(const dynModel* model, int constraint, dynConstraint* out) {
  if (const dynStatus s = check(model)) return s;
  if (const dynStatus s = check_struct("dyn_model_constraint_info", "out", out)) return s;
  const Model& m = *model->m;
  if (const dynStatus s = check_index("dyn_model_constraint_info", "constraint", constraint, m.n.constraints)) return s;
  write_struct(m.constraints()[constraint].spec, out);
  return DYN_OK;
}

dynStatus dyn_data_set_constraint(const dynModel* model, dynData* data, int slot, const dynConstraint* constraint) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_data_set_constraint");
  if (!call || !valid_slot(call, slot)) return call.status;
  const Given<dynConstraint> given(call.function, constraint);
  if (given.status != DYN_OK) return given.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  const dynConstraint spec = constraint ? *given : dynConstraint{};
  char message[256];
  if (const dynStatus s = check_constraint(m, spec, message, sizeof message))
    return fail(s, "dyn_data_set_constraint: slot %d: %s", slot, message);
  Index rows = constraint_rows(resolve_constraint(m, spec));
  for (Index s = 0; s < m.n.slots; ++s)
    if (s != slot) rows += constraint_rows(d.slots[s].c);
  if (rows > m.n.constraint_rows)
    return fail(
        DYN_ERROR_LIMIT,
        "dyn_data_set_constraint: slot %d: all slots together would have %d rows, and there is room for %d: give the model more "
        "constraint_slots",
        slot, int(rows), int(m.n.constraint_rows));
  set_constraint(m, d, slot, spec);
  number_rows(m, d);
  drop_constraints(d);
  return DYN_OK;
}

dynStatus dyn_data_constraint(const dynModel* model, dynData* data, int slot, dynConstraint* constraint) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_data_constraint");
  if (!call || !valid_slot(call, slot)) return call.status;
  if (const dynStatus s = check_struct(call.function, "constraint", constraint)) return s;
  write_struct(call.d().constraint_specs[slot], constraint);
  return DYN_OK;
}

dynStatus dyn_data_set_constraint_enabled(const dynModel* model, dynData* data, int slot, int enabled) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_data_set_constraint_enabled");
  if (!call || !valid_slot(call, slot)) return call.status;
  Data<double>& d = call.d();
  d.slots[slot].enabled = d.constraint_specs[slot].enabled = enabled != 0;
  number_rows(call.m(), d);
  drop_constraints(d);
  return DYN_OK;
}

dynStatus dyn_data_anchor_constraint(const dynModel* model, dynData* data, int slot, const double* q) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_data_anchor_constraint");
  if (!call || !valid_slot(call, slot)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  dynConstraint spec = d.constraint_specs[slot];
  if (spec.type == DYN_CONSTRAINT_TYPE_NONE || between_joints(spec.type))
    return fail(DYN_ERROR_ARGUMENT, "dyn_data_anchor_constraint: slot %d holds no constraint between frames", slot);
  if (!call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  forward_kinematics<0>(m, d);
  if (!no_overflow(call, 0)) return call.status;
  const Constraint& c = d.slots[slot].c;
  const SE3<double> W1 = SE3<double>{d.R[c.body1], d.p[c.body1]} * c.X1, W2 = SE3<double>{d.R[c.body2], d.p[c.body2]} * c.X2;
  const SE3<double> to = W2.inverse() * W1;
  SE3<double> X = load_se3(spec.placement2);
  if (spec.type == DYN_CONSTRAINT_TYPE_DISTANCE) {
    spec.length = std::sqrt(dot(to.p, to.p));
    if (!(spec.length > 0)) {
      call.rollback();
      return fail(DYN_ERROR_INVALID, "dyn_data_anchor_constraint: slot %d: the two points are one at q: use CONNECT", slot);
    }
  } else if (spec.type == DYN_CONSTRAINT_TYPE_POINT || spec.type == DYN_CONSTRAINT_TYPE_CONNECT) {
    X.p = X.p + X.R * to.p;  // the axes stay
  } else {
    X = X * to;
  }
  store_se3(X, spec.placement2);
  const int enabled = d.slots[slot].enabled;
  set_constraint(m, d, slot, spec);
  d.slots[slot].enabled = d.constraint_specs[slot].enabled = enabled;
  number_rows(m, d);
  drop_constraints(d);
  return DYN_OK;
}

dynStatus dyn_data_constraint_rows(const dynModel* model, dynData* data, int slot, int* first, int* rows) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_data_constraint_rows");
  if (!call || (slot >= 0 && !valid_slot(call, slot))) return call.status;
  const Data<double>& d = call.d();
  if (first) *first = slot < 0 ? 0 : int(d.slots[slot].first);
  if (rows) *rows = slot < 0 ? int(active_rows(call.m(), d)) : int(d.slots[slot].rows);
  return DYN_OK;
}

}  // extern "C"
