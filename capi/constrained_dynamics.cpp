// Dynamics under constraints: thin wrappers.
#include <algorithm>

#include "constraint.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

dynStatus not_finite(Call& call, const char* what) {
  call.drop_results();
  call.rollback();
  return fail(DYN_ERROR_NUMERIC, "%s: %s overflows: the inputs are too large for double precision", call.function, what);
}

void clear_rows(Data<double>& d, Index rows, Index room) { std::fill(d.lambda + rows, d.lambda + room, 0.0); }

}  // namespace

template <>
dynConstraintOptions capi::defaults() {
  const ProximalOptions o;
  return {0, std::int32_t(o.max_iterations), o.regularisation, o.tolerance};
}

template <>
dynConstrainedOutput capi::defaults() {
  return {};
}

extern "C" {

dynStatus dyn_constrained_dynamics(const dynModel* model, dynData* data, const double* q, const double* v, const double* tau,
                                   const double* fext, const dynConstraintOptions* options, const dynConstrainedOutput* output) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_constrained_dynamics");
  const Given<dynConstrainedOutput> out(call.function, output);
  ProximalOptions given;
  if (!call || !good_output(call, out) || !read_options(call, options, given) || !check_fext(call, fext) ||
      !call.inputs(q, v, nullptr, tau))
    return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  d.invalidate(Stage::ConstrainedDdq);  // being written
  dynConstraintResult found{};
  const Index failed = constrained_dynamics(m, d, d.v, d.tau_applied, fext, given, d.constraint_ddq, found);
  forget_mass(call);
  if (failed) return singular(call, failed, Stage::ConstrainedDdq);
  const Index rows = found.rows;
  if (finite_count(d.constraint_ddq, m.n.nv) != m.n.nv) return not_finite(call, "ddq");
  if (finite_count(d.lambda, rows) != rows) return not_finite(call, "lambda");
  clear_rows(d, rows, m.n.constraint_rows);
  copy_out(d.constraint_ddq, m.n.nv, d.constrained_ddq);
  d.mark_fresh(Stage::ConstrainedDdq);
  copy_out(d.constrained_ddq, m.n.nv, out->ddq), copy_out(d.lambda, rows, out->lambda);
  write_struct(found, out->result);
  return DYN_OK;
}

dynStatus dyn_constraint_impulse(const dynModel* model, dynData* data, const double* q, const double* v,
                                 const dynConstraintOptions* options, double* v_plus, double* lambda,
                                 dynConstraintResult* result) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_constraint_impulse");
  ProximalOptions given;
  if (!call || !good_result(call, result) || !read_options(call, options, given) || !call.inputs(q, v, nullptr, nullptr))
    return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  d.invalidate(Stage::ConstrainedDdq);  // lambda is this call's
  dynConstraintResult found{};
  const Index failed = constraint_impulse(m, d, d.v, given, d.constraint_ddq, found);
  forget_mass(call);
  if (failed) return singular(call, failed, Stage::ConstrainedDdq);
  if (finite_count(d.constraint_ddq, m.n.nv) != m.n.nv) return not_finite(call, "v_plus");
  if (finite_count(d.lambda, found.rows) != found.rows) return not_finite(call, "lambda");
  copy_out(d.constraint_ddq, m.n.nv, v_plus), copy_out(d.lambda, found.rows, lambda);
  write_struct(found, result);
  return DYN_OK;
}

dynStatus dyn_constraint_terms(const dynModel* model, dynData* data, const double* q, const double* v, double* C, double* J,
                               double* Jv, double* drift) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_constraint_terms");
  if (!call || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  d.invalidate(Stage::ConstrainedDdq);
  const Index failed = constraint_factor(m, d);
  forget_mass(call);
  if (failed) return singular(call, failed, Stage::ConstrainedDdq);
  if (!no_overflow(call, 0)) return call.status;
  evaluate_rows(m, d, d.expand(m, static_cast<const double*>(d.v), d.vx), static_cast<const double*>(nullptr));
  bool good = true;
  for_each_constraint(m, d, [&](const ConstraintInstance<double>& s, Index) {
    good = good && finite_count(s.error, s.rows) == s.rows && finite_count(s.rate, s.rows) == s.rows &&
           finite_count(s.acceleration, s.rows) == s.rows;
  });
  if (!good) return not_finite(call, "a row");
  for_each_constraint(m, d, [&](const ConstraintInstance<double>& s, Index) {
    if (C) copy_out(s.error, s.rows, C + s.first);
    if (Jv) copy_out(s.rate, s.rows, Jv + s.first);
    if (drift) copy_out(s.acceleration, s.rows, drift + s.first);
  });
  if (J) constraint_jacobian(m, d, J, active_rows(m, d));
  return DYN_OK;
}

// The factor of G at q.
static bool factored(Call& call, const double* q) {
  if (!call || !call.inputs(q, nullptr, nullptr, nullptr)) return false;
  const Model& m = call.m();
  Data<double>& d = call.d();
  d.invalidate(Stage::ConstrainedDdq);
  const Index failed = constraint_factor(m, d);
  forget_mass(call);
  if (failed) {
    call.status = singular(call, failed, Stage::ConstrainedDdq);
    return false;
  }
  if (!no_overflow(call, 0)) return false;
  evaluate_rows(m, d, static_cast<const double*>(nullptr), static_cast<const double*>(nullptr));
  propagate_rows(m, d);
  return true;
}

static dynStatus write_if_finite(Call& call, const double* x, std::ptrdiff_t n, const char* what, double* out) {
  if (finite_count(x, Index(n)) != n) return not_finite(call, what);
  copy_out(x, n, out);
  return DYN_OK;
}

dynStatus dyn_delassus(const dynModel* model, dynData* data, const double* q, double* G) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_delassus");
  if (!factored(call, q)) return call.status;
  Data<double>& d = call.d();
  const Index rows = active_rows(call.m(), d);
  const std::ptrdiff_t ld = padded_rows(rows);
  delassus(call.m(), d, rows, d.row_matrix);
  for (Index c = 0; c < rows; ++c)
    if (finite_count(d.row_matrix + ld * c, rows) != rows) return not_finite(call, "G");
  for (Index c = 0; G && c < rows; ++c) copy_out(d.row_matrix + ld * c, rows, G + std::ptrdiff_t(rows) * c);
  return DYN_OK;
}

dynStatus dyn_delassus_factor(const dynModel* model, dynData* data, const double* q, double* Y, double* D) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_delassus_factor");
  if (!factored(call, q)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  const double* pivots = m.has_mimic ? d.D : d.Dinv;
  if (finite_count(pivots, m.n.nv) != m.n.nv) return not_finite(call, "D");
  if (Y) {
    std::fill_n(Y, std::ptrdiff_t(m.n.nv) * active_rows(m, d), 0.0);
    for_each_constraint(m, d, [&](const ConstraintInstance<double>& s, Index k) {
      const Index* dof = d.supporting_dofs + std::ptrdiff_t(k) * m.n.nvx;
      const double* y = d.propagated_jacobian + row_lanes * std::ptrdiff_t(k) * m.n.nvx;
      for (Index n = 0; n < s.support_count; ++n)
        for (Index r = 0; r < s.rows; ++r) Y[dof[n] + std::ptrdiff_t(m.n.nv) * (s.first + r)] = y[row_lanes * n + r];
    });
  }
  copy_out(pivots, m.n.nv, D);
  return DYN_OK;
}

dynStatus dyn_delassus_times(const dynModel* model, dynData* data, const double* q, const double* x, double* out) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_delassus_times");
  if (!call) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  const Index rows = active_rows(m, d);
  if (!call.required("x", x, rows) || !call.finite("x", x, rows) || !factored(call, q)) return call.status;
  double* y = d.row_vectors;
  delassus_times(m, d, x, d.constraint_step, y);
  return write_if_finite(call, y, rows, "G x", out);
}

dynStatus dyn_delassus_solve(const dynModel* model, dynData* data, const double* q, double mu, const double* x, double* out) {
  Call call(model, data, DYN_PART_CONSTRAINTS, "dyn_delassus_solve");
  if (!call) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  const Index rows = active_rows(m, d);
  if (!(mu >= 0 && mu < HUGE_VAL)) return fail(DYN_ERROR_ARGUMENT, "dyn_delassus_solve: mu is %g: give 0 or more", mu);
  if (!call.required("x", x, rows) || !call.finite("x", x, rows) || !factored(call, q)) return call.status;
  const std::ptrdiff_t ld = padded_rows(rows);
  delassus(m, d, rows, d.row_matrix);
  double *Dinv = d.row_vectors, *y = d.row_vectors + padded_rows(m.n.constraint_rows);
  const double smallest = factor_rows(d.row_matrix, ld, rows, mu, 0.0, d.row_factor, Dinv);
  if (!(smallest > 1e-13)) {
    call.rollback();
    return fail(DYN_ERROR_NUMERIC, "dyn_delassus_solve: the rows are dependent: give mu > 0, or look at dyn_constraint_report");
  }
  copy_out(x, rows, y);
  solve_factored(d.row_factor, Dinv, ld, rows, y);
  return write_if_finite(call, y, rows, "the solution", out);
}

}  // extern "C"
