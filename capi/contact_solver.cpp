// The contact problem alone: what a caller's problem may be, handles, and the calls.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <new>
#include <tuple>

#include "deadline.hpp"
#include "solver/list.hpp"
#include "solver/qp.hpp"
#include "in_memory.hpp"
#include "reflection.hpp"

using namespace dyn;
using namespace dyn::capi;
using solver::Workspace;

namespace {

constexpr int max_problem_rows = 1 << 14;
constexpr std::size_t head = (sizeof(dynContactSolver) + sizeof(Workspace) + 127) / 64 * 64;

// Checks of a problem, with the caller's function in every message.
struct Reader {
  const char* function;
  const dynContactProblem& p;
  dynStatus status = DYN_OK;

  template <class... Args>
  bool refuse(dynStatus s, const char* format, Args... args) {
    status = fail(s, format, function, args...);
    return false;
  }
  bool required(const char* name, const void* x, Index n) {
    return x || n == 0 || refuse(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", name);
  }
  bool finite(const char* name, const double* x, Index n) {
    const Index k = x ? finite_count(x, n) : n;
    return k == n ||
           refuse(DYN_ERROR_NONFINITE, "%s: %s[%d] is %s: give a finite number", name, int(k), x[k] != x[k] ? "NaN" : "infinite");
  }
  bool within(const char* name, const double* x, Index n, double most) {
    if (!finite(name, x, n)) return false;
    for (Index k = 0; x && k < n; ++k)
      if (!(x[k] >= 0 && x[k] <= most))
        return refuse(DYN_ERROR_ARGUMENT,
                      std::isinf(most) ? "%s: %s[%d] is %g: give zero or more" : "%s: %s[%d] is %g: give a number from 0 to 1",
                      name, int(k), x[k]);
    return true;
  }
  bool sizes(Index max_rows);
  bool pair(Index i, Index j, double upper, double lower, double Gii, double Gjj);
  bool matrix();
  bool bounds();
  bool vectors();
  bool read(Index max_rows) { return sizes(max_rows) && matrix() && vectors(); }
};

bool Reader::sizes(Index max_rows) {
  for (const auto& [name, n] :
       {std::pair("equalities", p.equalities), std::pair("boxes", p.boxes), std::pair("contacts", p.contacts)})
    if (n < 0 || n > max_rows)
      return refuse(
          n < 0 ? DYN_ERROR_ARGUMENT : DYN_ERROR_LIMIT,
          n < 0 ? "%s: %s is %d: it can't be negative" : "%s: %s is %d, more than the solver has rows (%d): make it larger", name,
          int(n), int(max_rows));
  for (Index k = 0; p.contact_rows && k < p.contacts; ++k)
    if (const int r = p.contact_rows[k]; r != 1 && r != 3 && r != 4 && r != 6)
      return refuse(DYN_ERROR_ARGUMENT, "%s: contact_rows[%d] is %d: give 1, 3, 4 or 6", int(k), r);
  const std::ptrdiff_t rows = solver::row_count(p);
  if (rows > max_rows)
    return refuse(DYN_ERROR_LIMIT, "%s: the problem has %lld rows, the solver room for %d: make it larger",
                  static_cast<long long>(rows), int(max_rows));
  if (p.G_stride != 0 && p.G_stride < rows)
    return refuse(DYN_ERROR_SIZE, "%s: G_stride is %d, less than the %d rows", int(p.G_stride), int(rows));
  return true;
}

// Symmetric, and no 2 x 2 minor below zero, to round-off of whoever computed it.
bool Reader::pair(Index i, Index j, double upper, double lower, double Gii, double Gjj) {
  constexpr double slack = 1e-8;
  const double square = upper * upper;
  if (upper == lower && square <= Gii * Gjj && (square > 1e-250 || upper == 0)) return true;  // the usual case, without roots
  const double bound = std::sqrt(Gii) * std::sqrt(Gjj);
  if (!(std::fabs(upper - lower) <= slack * bound))
    return refuse(DYN_ERROR_INVALID, "%s: G(%d, %d) is %.17g and G(%d, %d) is %.17g: G must be symmetric", int(i), int(j), upper,
                  int(j), int(i), lower);
  if (!(std::fabs(upper) <= (1 + slack) * bound))
    return refuse(
        DYN_ERROR_INVALID,
        "%s: |G(%d, %d)| = %g is more than the geometric mean %g of G's diagonal there: G must be positive semi-definite", int(i),
        int(j), std::fabs(upper), bound);
  return true;
}

bool Reader::matrix() {
  const Index n = Index(solver::row_count(p));
  const std::ptrdiff_t stride = p.G_stride ? p.G_stride : n;
  if (!required("G", p.G, n)) return false;
  for (Index j = 0; j < n; ++j) {
    const double* column = p.G + j * stride;
    if (const Index i = finite_count(column, n); i < n)
      return refuse(DYN_ERROR_NONFINITE, "%s: G(%d, %d) is %s: give a finite number", int(i), int(j),
                    column[i] != column[i] ? "NaN" : "infinite");
    if (column[j] < 0)
      return refuse(DYN_ERROR_INVALID, "%s: G(%d, %d) is %g: a Delassus matrix has no negative diagonal", int(j), int(j),
                    column[j]);
    for (Index i = 0; i < j; ++i)
      if (!pair(i, j, column[i], p.G[j + i * stride], p.G[i + i * stride], column[j])) return false;
  }
  return true;
}

bool Reader::bounds() {
  if (!required("lower", p.lower, p.boxes) || !required("upper", p.upper, p.boxes)) return false;
  for (Index k = 0; k < p.boxes; ++k) {
    if (std::isnan(p.lower[k]) || std::isnan(p.upper[k]))
      return refuse(DYN_ERROR_NONFINITE, "%s: %s[%d] is not a number", std::isnan(p.lower[k]) ? "lower" : "upper", int(k));
    if (!(p.lower[k] <= p.upper[k]) || p.lower[k] == HUGE_VAL || p.upper[k] == -HUGE_VAL)
      return refuse(DYN_ERROR_ARGUMENT, "%s: lower[%d] is %g and upper[%d] is %g: give lower <= upper", int(k), p.lower[k],
                    int(k), p.upper[k]);
  }
  return true;
}

bool Reader::vectors() {
  const Index n = Index(solver::row_count(p));
  return required("g", p.g, n) && finite("g", p.g, n) && bounds() && within("friction", p.friction, p.contacts, HUGE_VAL) &&
         within("torsion", p.torsion, p.contacts, HUGE_VAL) && within("rolling", p.rolling, p.contacts, HUGE_VAL) &&
         within("compliance", p.compliance, n, HUGE_VAL) && finite("bias", p.bias, n) &&
         within("restitution", p.restitution, p.contacts, 1) && finite("v_minus", p.v_minus, n);
}

dynStatus check_options(const char* function, const dynContactOptions& o) {
  if (const dynStatus s = check_value(o.solver, function, "solver")) return s;
  if (o.max_iterations < 0)
    return fail(DYN_ERROR_ARGUMENT, "%s: max_iterations is %d: it can't be negative", function, int(o.max_iterations));
  for (const auto& [name, x, most] :
       {std::tuple("tolerance", o.tolerance, HUGE_VAL), std::tuple("time_budget", o.time_budget, HUGE_VAL),
        std::tuple("relaxation", o.relaxation, 2.0)})
    if (!(x >= 0) || !(x < most))
      return fail(std::isnan(x) ? DYN_ERROR_NONFINITE : DYN_ERROR_ARGUMENT, "%s: %s is %g: give a number from 0%s", function,
                  name, x, std::isinf(most) ? "" : ", below 2");
  return check_clock(function, o.time_budget);
}

}  // namespace

dynStatus dyn::capi::check_max_rows(const char* function, int max_rows) {
  if (max_rows >= 1 && max_rows <= max_problem_rows) return DYN_OK;
  return fail(DYN_ERROR_LIMIT, "%s: max_rows is %d: give a number from 1 to %d", function, max_rows, max_problem_rows);
}

template <>
dynContactProblem capi::defaults() {
  return {};
}

template <>
dynContactOptions capi::defaults() {
  dynContactOptions o{};
  o.solver = DYN_CONTACT_SOLVER_TYPE_ADMM;
  o.max_iterations = 1000;
  o.tolerance = 1e-10;
  o.newton = 1;
  return o;
}

template <>
dynQp capi::defaults() {
  return {};
}

extern "C" {

size_t dyn_contact_solver_size(int max_rows) {
  if (check_max_rows("dyn_contact_solver_size", max_rows) != DYN_OK) return 0;
  return head + solver::workspace_bytes(max_rows);
}

dynStatus dyn_contact_solver_init(int max_rows, void* memory, size_t size, dynContactSolver** solver) {
  constexpr const char* function = "dyn_contact_solver_init";
  if (const dynStatus s = check_max_rows(function, max_rows)) return s;
  if (!memory || !solver)
    return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, memory ? "solver" : "memory");
  if (reinterpret_cast<std::uintptr_t>(memory) % 64 != 0)
    return fail(DYN_ERROR_ARGUMENT, "%s: memory is not aligned to 64 bytes", function);
  const std::size_t needed = head + solver::workspace_bytes(max_rows);
  if (size < needed)
    return fail(DYN_ERROR_SIZE, "%s: memory has %zu bytes, needs %zu (dyn_contact_solver_size)", function, size, needed);
  char* const at = static_cast<char*>(memory);
  std::memset(at, 0, needed);
  Workspace* const w = new (at + (sizeof(dynContactSolver) + 63) / 64 * 64) Workspace;
  solver::place(*w, max_rows, at + head);
  *solver = new (memory) dynContactSolver{live_contact_solver, w, nullptr};
  return DYN_OK;
}

void dyn_contact_solver_free(dynContactSolver* solver) {
  if (!solver || solver->magic != live_contact_solver) return;
#if !DYN_NO_HOST
  if (solver->memory) return free_heap(solver);
#endif
  solver->magic = freed;
}

dynStatus dyn_contact_solver_solve(dynContactSolver* solver, const dynContactProblem* given_problem,
                                   const dynContactOptions* options, double* lambda, double* velocity, dynContactReport* report) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_contact_solver_solve";
  if (const dynStatus s = check(solver)) return s;
  if (!given_problem) return fail(DYN_ERROR_ARGUMENT, "%s: problem is NULL: it is required", function);
  const Given<dynContactProblem> problem(function, given_problem);
  if (problem.status != DYN_OK) return problem.status;
  const Given<dynContactOptions> given_options(function, options);
  if (given_options.status != DYN_OK) return given_options.status;
  const dynContactOptions& o = *given_options;
  if (const dynStatus s = check_options(function, o)) return s;
  if (const dynStatus s = check_struct(function, "report", report)) return s;
  Workspace& w = *solver->w;
  Reader reader{function, *problem};
  if (!reader.read(w.max_rows)) return reader.status;
  const Index rows = Index(solver::row_count(*problem));
  if (!reader.required("lambda", lambda, rows) || (o.warm_start && !reader.finite("lambda", lambda, rows))) return reader.status;

  solver::Budget b;
  b.tolerance = o.tolerance, b.max_iterations = o.max_iterations, b.relaxation = o.relaxation, b.newton = o.newton,
  b.warm = o.warm_start;
  solver::TimeLimit limit{};
  if (o.time_budget > 0) {
    limit.start(clock_seconds, o.time_budget);
    limit.expect(solver::TimeLimit::Unit::Matrix, double(rows) * rows);
    b.limit = &limit;
  }
  dynContactReport answer{};
  solver::solve(*problem, solver::solvers[o.solver], w, b, lambda, answer);
  // before anything is written
  double *impulse = w.x, *c = w.z;
  solver::unscale(*problem, w.problem, w.y, impulse);
  solver::velocity(*problem, impulse, c);
  if (finite_count(impulse, rows) < rows || finite_count(c, rows) < rows || !std::isfinite(answer.residual))
    return fail(DYN_ERROR_NUMERIC, "%s: the problem overflows double precision: its numbers differ too much in size", function);
  copy_out(impulse, rows, lambda);
  copy_out(c, rows, velocity);
  write_struct(answer, report);
  return DYN_OK;
}

dynStatus dyn_contact_solver_residuals(dynContactSolver* solver, const dynContactProblem* given_problem, const double* lambda,
                                       dynContactReport* report) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_contact_solver_residuals";
  if (const dynStatus s = check(solver)) return s;
  if (!given_problem) return fail(DYN_ERROR_ARGUMENT, "%s: problem is NULL: it is required", function);
  const Given<dynContactProblem> problem(function, given_problem);
  if (problem.status != DYN_OK) return problem.status;
  if (const dynStatus s = check_struct(function, "report", report)) return s;
  Workspace& w = *solver->w;
  Reader reader{function, *problem};
  if (!reader.read(w.max_rows)) return reader.status;
  const Index rows = Index(solver::row_count(*problem));
  if (!reader.required("lambda", lambda, rows) || !reader.finite("lambda", lambda, rows)) return reader.status;
  dynContactReport answer{};
  solver::evaluate(*problem, w, lambda, answer);
  if (!std::isfinite(answer.residual) || !std::isfinite(answer.energy))
    return fail(DYN_ERROR_NUMERIC, "%s: the problem overflows double precision: its numbers are too large", function);
  write_struct(answer, report);
  return DYN_OK;
}

dynStatus dyn_contact_problem_qp(const dynContactProblem* given_problem, int facets, int inscribed, dynQp* given_qp) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_contact_problem_qp";
  if (!given_problem || !given_qp)
    return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, given_problem ? "qp" : "problem");
  const Given<dynContactProblem> problem(function, given_problem);
  if (problem.status != DYN_OK) return problem.status;
  const Given<dynQp> qp(function, given_qp);
  if (qp.status != DYN_OK) return qp.status;
  if (facets != 0 && (facets < 3 || facets > 1024))
    return fail(DYN_ERROR_ARGUMENT, "%s: facets is %d: give 0, or a number from 3 to 1024", function, facets);
  Reader reader{function, *problem};
  if (!reader.sizes(max_problem_rows) || (problem->G && !reader.matrix()) || !reader.vectors()) return reader.status;
  dynQp sizes{};
  solver::friction_cone_qp(*problem, facets, inscribed, sizes);
  const void* const arrays[] = {qp->H_columns, qp->H_rows, qp->A_columns, qp->A_rows, qp->H, qp->g, qp->A, qp->lower, qp->upper};
  if (std::all_of(std::begin(arrays), std::end(arrays), [](const void* a) { return !a; })) {
    write_struct(sizes, given_qp);
    return DYN_OK;
  }
  if ((qp->H && !qp->H_columns) || (qp->H_rows && !qp->H_columns) || (qp->A && !qp->A_columns) || (qp->A_rows && !qp->A_columns))
    return fail(DYN_ERROR_ARGUMENT, "%s: rows or values without columns: pass these as well", function);
  for (const auto& [name, given, needed] :
       {std::tuple("n", qp->n, sizes.n), std::tuple("m", qp->m, sizes.m),
        std::tuple("H_nonzeros", qp->H_nonzeros, sizes.H_nonzeros), std::tuple("A_nonzeros", qp->A_nonzeros, sizes.A_nonzeros)})
    if (given != needed)
      return fail(DYN_ERROR_SIZE, "%s: %s is %d, needs %d: ask for the sizes first, with all pointers NULL", function, name,
                  int(given), int(needed));
  dynQp filled = *qp;
  solver::friction_cone_qp(*problem, facets, inscribed, filled);
  return DYN_OK;
}

dynStatus dyn_contact_compliance(double stiffness, double damping, double dt, double gap, double* compliance, double* bias) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_contact_compliance";
  for (const auto& [name, x] :
       {std::pair("stiffness", stiffness), std::pair("damping", damping), std::pair("dt", dt), std::pair("gap", gap)})
    if (!std::isfinite(x))
      return fail(DYN_ERROR_NONFINITE, "%s: %s is %s: give a finite number", function, name, std::isnan(x) ? "NaN" : "infinite");
  if (stiffness < 0 || damping < 0)
    return fail(DYN_ERROR_ARGUMENT, "%s: %s is %g: give zero or more", function, stiffness < 0 ? "stiffness" : "damping",
                stiffness < 0 ? stiffness : damping);
  if (!(dt > 0)) return fail(DYN_ERROR_ARGUMENT, "%s: dt is %g s: it must be positive", function, dt);
  if (!compliance || !bias)
    return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, compliance ? "bias" : "compliance");
  const double total = dt * stiffness + damping;
  const double R = 1 / (dt * total), b = gap > 0 ? gap / dt : stiffness * gap / total;
  if (!std::isfinite(R) || !std::isfinite(stiffness * gap / total) || !std::isfinite(b))
    return fail(DYN_ERROR_ARGUMENT, "%s: stiffness %g and damping %g give no force: one must be positive", function, stiffness,
                damping);
  *compliance = R, *bias = b;
  return DYN_OK;
}

dynStatus dyn_contact_stiffness_hertz(double frequency, double damping_ratio, double mass, double* stiffness, double* damping) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_contact_stiffness_hertz";
  for (const auto& [name, x] :
       {std::pair("frequency", frequency), std::pair("damping_ratio", damping_ratio), std::pair("mass", mass)}) {
    if (!std::isfinite(x))
      return fail(DYN_ERROR_NONFINITE, "%s: %s is %s: give a finite number", function, name, std::isnan(x) ? "NaN" : "infinite");
    if (x < 0 || (x == 0 && name[0] != 'd'))
      return fail(DYN_ERROR_ARGUMENT, "%s: %s is %g: give a positive number", function, name, x);
  }
  const double omega = 2 * 3.14159265358979323846 * frequency;
  const double k = mass * omega * omega, d = 2 * damping_ratio * mass * omega;
  if (!stiffness || !damping)
    return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, stiffness ? "damping" : "stiffness");
  if (!std::isfinite(k) || !std::isfinite(d))
    return fail(DYN_ERROR_NUMERIC, "%s: the stiffness or the damping overflows: give a smaller frequency or mass", function);
  *stiffness = k, *damping = d;
  return DYN_OK;
}

}  // extern "C"
