// Projection onto constraints, constrained inverse dynamics, constraint diagnostics: thin wrappers.
#include <algorithm>

#include "constraint.hpp"
#include "algorithm/constrained/report.hpp"

using namespace dyn;
using namespace dyn::capi;

template <>
dynProjectOptions capi::defaults() {
  return {0, 100, 1, 1e-12};
}

extern "C" {

dynStatus dyn_project(const dynModel* model, dynData* data, const double* q, const double* v, const dynProjectOptions* options,
                      double* q_out, double* v_out, dynConstraintResult* result) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_project");
  const Given<dynProjectOptions> given(call.function, options);
  if (!call || !good_result(call, result)) return call.status;
  if (given.status != DYN_OK) return given.status;
  if (given->max_iterations < 1)
    return fail(DYN_ERROR_ARGUMENT, "dyn_project: max_iterations is %d: give 1 or more", int(given->max_iterations));
  if (!(given->tolerance > 0 && given->tolerance <= 1))
    return fail(DYN_ERROR_ARGUMENT, "dyn_project: tolerance is %g: give more than 0, at most 1", given->tolerance);
  if (!call.inputs(q, v, nullptr, nullptr)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  d.invalidate(Stage::ConstrainedDdq);
  dynConstraintResult found{};
  // the search moves q and v; what they were is kept where a and tau, which are no inputs here, would be
  double *start_q = d.constraint_q + m.n.nq, *start_v = d.backup + m.n.nq + m.n.nv;
  copy_out(d.q, m.n.nq, start_q), copy_out(d.v, m.n.nv, start_v);
  auto go_back = [&] {
    copy_out(start_q, m.n.nq, d.q), copy_out(start_v, m.n.nv, d.v);
    for (Stage s : {Stage::Position, Stage::Velocity, Stage::Acceleration}) d.invalidate(s);
    call.drop_results();
  };
  const Index failed = project(m, d, given->max_iterations, given->weigh != 0, given->tolerance, v_out ? d.v : nullptr, found,
                               misalignment_tolerance);
  forget_mass(call);
  if (failed) {
    go_back();
    return singular(call, failed, Stage::ConstrainedDdq);
  }
  if (finite_count(d.q, m.n.nq) != m.n.nq || finite_count(d.v, m.n.nv) != m.n.nv || !(found.residual < HUGE_VAL)) {
    go_back();
    call.rollback();
    return fail(DYN_ERROR_NUMERIC,
                "dyn_project: the error of the constraints overflows: the inputs are too large for double precision");
  }
  if (!std::equal(start_q, start_q + m.n.nq, d.q) || !std::equal(start_v, start_v + m.n.nv, d.v)) call.end_step();
  forward_kinematics<0>(m, d);
  copy_out(d.q, m.n.nq, q_out), copy_out(d.v, m.n.nv, v_out);
  write_struct(found, result);
  return DYN_OK;
}

dynStatus dyn_constrained_inverse_dynamics(const dynModel* model, dynData* data, const double* q, const double* v,
                                           const double* a, const double* fext, const int32_t* actuated,
                                           const dynConstrainedOutput* output) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_constrained_inverse_dynamics");
  const Given<dynConstrainedOutput> wanted(call.function, output);
  if (!call || !good_output(call, wanted) || !check_fext(call, fext) || !call.inputs(q, v, a, nullptr)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  d.invalidate(Stage::ConstrainedDdq);
  dynConstraintResult found{};
  double* out = d.constraint_ddq;
  const Index failed = constrained_inverse_dynamics(m, d, d.v, d.a, fext, actuated, out, found);
  forget_mass(call);
  if (failed) return singular(call, failed, Stage::ConstrainedDdq);
  if (!call.numeric(out, m.n.nv, "tau", Stage::ConstrainedDdq) ||
      !call.numeric(d.lambda, found.rows, "lambda", Stage::ConstrainedDdq))
    return call.status;
  copy_out(out, m.n.nv, wanted->tau), copy_out(d.lambda, found.rows, wanted->lambda);
  write_struct(found, wanted->result);
  return DYN_OK;
}

dynStatus dyn_constraint_report(const dynModel* model, dynData* data, const double* q, dynConstraintReport* report,
                                dynRowReport* rows_out, int capacity) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_constraint_report");
  if (!call) return call.status;
  if (const dynStatus s = check_struct(call.function, "report", report)) return s;
  if (!call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  d.invalidate(Stage::ConstrainedDdq);
  dynConstraintReport found{};
  const Index failed = constraint_report(m, d, found, [&](Index row, dynRowVerdict verdict, double share, double error) {
    if (!rows_out || row >= capacity) return;
    Index slot = 0;
    while (!(d.slots[slot].rows && row < d.slots[slot].first + d.slots[slot].rows)) ++slot;
    rows_out[row] = {int32_t(slot), int32_t(row - d.slots[slot].first), verdict, share, error};
  });
  forget_mass(call);
  if (failed) return singular(call, failed, Stage::ConstrainedDdq);
  if (!no_overflow(call, 0) || !(found.error < HUGE_VAL)) {
    call.rollback();
    return fail(DYN_ERROR_NUMERIC,
                "dyn_constraint_report: the error of a row overflows: the inputs are too large for double precision");
  }
  write_struct(found, report);
  return DYN_OK;
}

}  // extern "C"
