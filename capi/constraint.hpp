// What the wrappers of constraints share.
#pragma once

#include "simulation/workspace.hpp"
#include "checks.hpp"
#include "algorithm/constrained/algorithms.hpp"

namespace dyn::capi {

// A struct that begins with its size.
template <class S>
dynStatus sized(const char* function, const char* name, const char* how, const S* s) {
  if (s->struct_size >= sizeof(S)) return DYN_OK;
  return fail(DYN_ERROR_SIZE, "%s: %s: struct_size is %u, needs %zu: %s", function, name, s->struct_size, sizeof(S), how);
}

inline bool valid_slot(Call& call, int slot) {
  if (slot >= 0 && slot < call.m().n.slots) return true;
  call.status = fail(DYN_ERROR_ARGUMENT, "%s: slot %d does not exist: the model has slots 0 to %d; see dyn_model_nconstraint_slots", call.function, slot, int(call.m().n.slots) - 1);
  return false;
}

// Nothing that was computed belongs to the slots any more.
inline void drop_constraints(Data<double>& d) {
  d.invalidate(Stage::ConstrainedDdq);
  simulation::invalidate_sleep(d);
  if (d.step) d.step->advancement_cache.square = 0;
}

// With mimic joints M and its factor were made on the way; nobody has looked whether they are finite.
inline void forget_mass(Call& call) {
  if (call.m().has_mimic) call.d().invalidate(Stage::Mass), call.d().invalidate(Stage::Factor);
}

inline bool good_result(Call& call, const dynConstraintResult* result) {
  if (!result) return true;
  call.status = sized(call.function, "dynConstraintResult", "set it to sizeof(dynConstraintResult)", result);
  return bool(call);
}
inline void copy_result(const dynConstraintResult& from, dynConstraintResult* to) {
  if (!to) return;
  const std::uint32_t size = to->struct_size;
  *to = from;
  to->struct_size = size;
}

// NULL: the defaults.
inline bool read_options(Call& call, const dynConstraintOptions* o, ProximalOptions& out) {
  if (!o) return true;
  if ((call.status = sized(call.function, "dynConstraintOptions", "call dyn_constraint_options_init first", o))) return false;
  auto refuse = [&](const char* name, double x, const char* what) {
    call.status = fail(DYN_ERROR_ARGUMENT, "%s: %s is %g: give %s", call.function, name, x, what);
    return false;
  };
  if (o->max_iterations < 1) return refuse("max_iterations", o->max_iterations, "1 or more");
  if (!(o->regularisation >= 0 && o->regularisation <= 1e6)) return refuse("regularisation", o->regularisation, "0 to 1e6");
  if (!(o->tolerance >= 0 && o->tolerance <= 1)) return refuse("tolerance", o->tolerance, "0 to 1");
  out.max_iterations = o->max_iterations, out.regularisation = o->regularisation, out.tolerance = o->tolerance;
  return true;
}

}  // namespace dyn::capi
