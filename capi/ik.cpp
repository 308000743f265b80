// Inverse kinematics: what a caller's tasks and options may be, and the call.
#include <cmath>

#include "base/format.hpp"
#include "checks.hpp"
#include "algorithm/ik_tasks.hpp"
#include "reflection.hpp"
#include "rotation.hpp"

namespace dyn {
extern template double ik_cost(const Model&, const Data<double>&, const dynIkTask&, IkResidual&);
}  // namespace dyn

using namespace dyn;
using namespace dyn::capi;

namespace {

bool refuse(Call& call, dynStatus status) {
  call.status = status;
  return false;
}

bool finite_numbers(Call& call, Index task, const char* name, const double* x, Index n) {
  const Index k = finite_count(x, n);
  if (k == n) return true;
  return refuse(call, fail(DYN_ERROR_NONFINITE, "dyn_ik: %s[%d] of task %d is %s: give a finite number", name, int(k), int(task),
                           x[k] != x[k] ? "NaN" : "infinite"));
}

bool weighted(Call& call, Index task, const char* name, const double* w, Index n) {
  if (!finite_numbers(call, task, name, w, n)) return false;
  for (Index k = 0; k < n; ++k)
    if (w[k] < 0)
      return refuse(
          call, fail(DYN_ERROR_ARGUMENT, "dyn_ik: %s[%d] of task %d is %g: give zero or more", name, int(k), int(task), w[k]));
  return true;
}

// The target must be a rotation to the digits that a file or a product of matrices leaves.
bool rotates(Call& call, Index task, const double* target) {
  const Mat3<double> R = load33(target);
  if (is_rotation(R)) return true;
  return refuse(call,
                fail(DYN_ERROR_ARGUMENT,
                     "dyn_ik: the target of task %d is no rotation%s: its first nine numbers are the axes, column by column",
                     int(task), mirrors(R) ? " (it mirrors)" : ""));
}

bool good_task(Call& call, const dynIkTask& t, Index k) {
  const Model& m = call.m();
  char name[40];
  write_text(name, sizeof name, "type of task %d", int(k));
  if (const dynStatus s = check_value(t.type, "dyn_ik", name)) return refuse(call, s);
  if (t.priority != 0 && t.priority != 1)
    return refuse(call, fail(DYN_ERROR_ARGUMENT, "dyn_ik: priority %d of task %d is neither 0 nor 1", int(t.priority), int(k)));
  if (!weighted(call, k, "weight", &t.weight, 1) || (t.weights && !weighted(call, k, "weights", t.weights, row_count(m, t.type))))
    return false;
  if (t.type == DYN_IK_TASK_TYPE_POSTURE) {
    if (!t.posture)
      return refuse(call, fail(DYN_ERROR_ARGUMENT, "dyn_ik: posture of task %d is NULL: it is required, nq numbers", int(k)));
    return finite_numbers(call, k, "posture", t.posture, m.n.nq) && call.nonzero(t.posture);
  }
  if (t.type != DYN_IK_TASK_TYPE_COM && !call.frame(t.frame)) return false;
  if (t.type != DYN_IK_TASK_TYPE_ORIENTATION && !finite_numbers(call, k, "target", t.target + 9, 3)) return false;
  if (t.type == DYN_IK_TASK_TYPE_POSE || t.type == DYN_IK_TASK_TYPE_ORIENTATION)
    return finite_numbers(call, k, "target", t.target, 9) && rotates(call, k, t.target);
  return true;
}

bool good_tasks(Call& call, const IkTasks& tasks) {
  if (!call.required("tasks", tasks.first)) return false;
  if (tasks.count < 1)
    return refuse(call, fail(DYN_ERROR_ARGUMENT, "dyn_ik: ntasks is %d: give one task at least", int(tasks.count)));
  std::int64_t rows = 0;
  for (Index k = 0; k < tasks.count; ++k) {
    if ((call.status = check_size(call.function, struct_name<dynIkTask>(), tasks.at(k)->struct_size))) return false;
    if (tasks.at(k)->struct_size != tasks.first->struct_size)
      return refuse(
          call, fail(DYN_ERROR_SIZE, "dyn_ik: struct_size of task %d is %u, that of the first %u: call dyn_ik_task_init for each",
                     int(k), tasks.at(k)->struct_size, tasks.first->struct_size));
    const Given<dynIkTask> task(call.function, tasks.at(k));
    if ((call.status = task.status) || !good_task(call, *task, k)) return false;
    rows += row_count(call.m(), task->type);
  }
  if (rows > INT32_MAX)
    return refuse(call, fail(DYN_ERROR_LIMIT, "dyn_ik: the tasks have %lld components: this library allows %d",
                             static_cast<long long>(rows), INT32_MAX));
  return true;
}

bool good_options(Call& call, const dynIkOptions& o) {
  if (o.max_iterations < 1 || o.restarts < 0)
    return refuse(call,
                  fail(DYN_ERROR_ARGUMENT, "dyn_ik: %s is %d: give %s or more", o.restarts < 0 ? "restarts" : "max_iterations",
                       int(o.restarts < 0 ? o.restarts : o.max_iterations), o.restarts < 0 ? "0" : "1"));
  for (const auto& [name, x] :
       {std::pair("tolerance_linear", o.tolerance_linear), std::pair("tolerance_angular", o.tolerance_angular)})
    if (!(x > 0) || !std::isfinite(x))
      return refuse(call, fail(DYN_ERROR_ARGUMENT, "dyn_ik: %s is %g: give a positive number", name, x));
  const Model& m = call.m();
  for (Index k = 0; k < m.n.nq && o.limits; ++k) {
    const double lower = o.lower ? o.lower[k] : m.lower_limit()[k], upper = o.upper ? o.upper[k] : m.upper_limit()[k];
    if (!(lower <= upper) || lower == HUGE_VAL || upper == -HUGE_VAL)
      return refuse(call, fail(DYN_ERROR_ARGUMENT, "dyn_ik: lower[%d] is %g and upper[%d] is %g: give lower <= upper", int(k),
                               lower, int(k), upper));
  }
  return true;
}

}  // namespace

template <>
dynIkTask capi::defaults() {
  return default_ik_task();
}

template <>
dynIkOptions capi::defaults() {
  dynIkOptions o{};
  o.max_iterations = 500;
  o.restarts = 20;
  o.tolerance_linear = o.tolerance_angular = 1e-6;
  o.limits = 1;
  return o;
}

template <>
dynIkOutput capi::defaults() {
  return {};
}

extern "C" {

dynStatus dyn_ik(const dynModel* model, dynData* data, const double* q, const dynIkTask* tasks, int ntasks,
                 const dynIkOptions* options, const dynIkOutput* out) {
  Call call(model, data, DYN_PART_IK, "dyn_ik");
  const Given<dynIkOutput> output(call.function, out);
  const Given<dynIkOptions> given(call.function, options);
  const IkTasks list{tasks, ntasks};
  const bool placed = call && call.d().fresh(Stage::Position);
  if (!call || (call.status = output.status) || (call.status = check_struct(call.function, "result", output->result)) ||
      (call.status = given.status) || !good_tasks(call, list) || !good_options(call, *given) ||
      !call.inputs(q, nullptr, nullptr, nullptr))
    return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  forward_kinematics<0>(m, d);
  if (!no_overflow(call, 0)) return call.status;
  double* start = d.backup + m.n.nq;  // v and a are no inputs here, and nq <= 2 nv
  copy_out(d.q, m.n.nq, start);
  dynIkResult answer{};
  if (!inverse_kinematics(m, d, list, *given, answer)) {
    copy_out(start, m.n.nq, d.q);
    forward_kinematics<0>(m, d);
    d.invalidate(Stage::Com);
    if (!placed) d.invalidate(Stage::Position);
    call.rollback();
    return fail(DYN_ERROR_NUMERIC,
                "dyn_ik: the cost of the tasks overflows at the start: weights or targets are too large for double precision");
  }
  call.end_search();
  write_struct(answer, output->result);
  copy_out(d.q, m.n.nq, output->solution);
  for (Index k = 0; output->residuals && k < list.count; ++k) {
    IkResidual e;
    ik_cost(m, d, list[k], e);
    output->residuals[2 * k] = e.linear, output->residuals[2 * k + 1] = e.angular;
  }
  return DYN_OK;
}

}  // extern "C"
