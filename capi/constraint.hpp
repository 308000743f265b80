// Shared by the wrappers of constraints.
#pragma once

#include "simulation/workspace.hpp"
#include "checks.hpp"
#include "algorithm/constrained/algorithms.hpp"

namespace dyn::capi {

inline bool valid_slot(Call& call, int slot) {
  if (slot >= 0 && slot < call.m().n.slots) return true;
  call.status =
      fail(DYN_ERROR_ARGUMENT, "%s: slot %d does not exist: the model has slots 0 to %d; see dyn_model_nconstraint_slots",
           call.function, slot, int(call.m().n.slots) - 1);
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
  call.status = check_struct(call.function, "result", result);
  return bool(call);
}

// Output pointers in a struct, `result` among them.
template <class S>
bool good_output(Call& call, const Given<S>& out) {
  call.status = out.status;
  return call && good_result(call, out->result);
}

// NULL: the defaults.
inline bool read_options(Call& call, const dynConstraintOptions* options, ProximalOptions& out) {
  if (!options) return true;
  const Given<dynConstraintOptions> o(call.function, options);
  if ((call.status = o.status)) return false;
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
