// Steps.
#include <numeric>

#include "collision.hpp"
#include "deadline.hpp"
#include "algorithm/actuators.hpp"
#include "algorithm/configuration.hpp"
#include "integrator/stepping.hpp"
#include "integrator/tuning.hpp"
#include "shape/material.hpp"
#include "simulation/ledger.hpp"
#include "simulation/step.hpp"
#include "simulation/workspace.hpp"
#include "reflection.hpp"
#include "steps.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// A step that failed leaves no contacts and no forces of limits: they may be infinite.
void drop_forces(simulation::Workspace& w) {
  w.contact_count = 0;
  std::fill_n(w.limit_forces, w.limits, 0.0);
}

const char* joint_at(const Model& m, Index k, bool in_v) {
  const char* name = "?";
  for (Index j = 1; j < m.n.joints; ++j)
    if ((in_v ? m.joints()[j].idx_v : m.joints()[j].idx_q) <= k) name = m.string(m.joints()[j].name);
  return name;
}

// Whether the state that steps left is finite, where trees are awake. Velocities that do not end fast are.
bool has_finite_state(const Model& m, const Data<double>& d) {
  const bool fast = d.step->ends_fast;
  Simd<double, 4> sum = Simd<double, 4>::zero();
  simulation::with_active_trees(d, [&](const auto& part) {
    part.for_each_group(m, [&](const Trees& t) {
      if (fast) sum = sum + zero_times(d.v + t.v, t.v_end - t.v);
      sum = sum + zero_times(d.q + t.q, t.q_end - t.q);
    });
  });
  return all_zero(sum);
}

void begin(Call& call) {
  call.have_effects_of(true);
  call.d().step->report = {};
  if (const simulation::Workspace& w = *call.d().step; w.options.ledger || w.ledger.open)
    simulation::open_ledger(call.m(), call.d());
}

// Apart, so that steps without a deadline have no part in it.
[[gnu::cold, gnu::noinline]] void start_limit(simulation::Workspace& w) { w.limit.start(clock_seconds, w.options.time_budget); }
[[gnu::cold, gnu::noinline]] void finish_limit(simulation::Workspace& w) { w.limit.finish(); }

// One step of h; the state is as before after an error.
DYN_INLINE dynStatus make_step(Call& call, const char* function, double h) {
  const Model& m = call.m();
  Data<double>& d = call.d();
  simulation::Workspace& w = *d.step;
  if (w.options.time_budget > 0) [[unlikely]] start_limit(w);
  if (w.sleep.count > 0) simulation::begin_sleep(m, d, h);  // otherwise no tree can rest
  call.begin_step();
  const Index answer = integrator::step(m, d, w.options.integrator, h, w.report, d.backup);
  if (answer || !has_finite_state(m, d)) [[unlikely]] {
    const dynStatus status = explain_step(m, d, answer, function, d.time[0]);
    finish_limit(w), call.rollback(), drop_forces(w), simulation::invalidate_sleep(d), record_forces(m, d);
    return status;
  }
  call.end_step();
  if (w.sleep.enabled) simulation::end_sleep(m, d, h);
  record_forces(m, d);
  d.time[0] += h;
  if (w.limit.seconds) [[unlikely]] finish_limit(w);
  return DYN_OK;
}

dynStatus advance_to_accuracy(Call& call, const char* function, double duration) {
  const Model& m = call.m();
  Data<double>& d = call.d();
  simulation::wake_all(m, d);
  d.step->ends_fast = true;
  call.begin_step();
  const Index answer = integrator::advance(m, d, d.step->options.integrator, duration, d.step->options.accuracy, d.step->report);
  d.time[0] += d.step->report.time;
  if (d.step->report.steps == 0) call.rollback(), drop_forces(*d.step);
  else call.end_step();
  record_forces(m, d);
  return answer || !has_finite_state(m, d) ? explain_step(m, d, answer, function, d.time[0]) : DYN_OK;
}

dynStatus check_contact_model(const Model& m, const dynStepOptions& options) {
  constexpr const char* function = "dyn_data_set_step_options";
  if (const dynStatus s = check_value(options.contact_model, function, "contact_model")) return s;
  if (options.contact_model == DYN_CONTACT_MODEL_RIGID) return DYN_OK;
  if (m.has_mimic)
    return fail(DYN_ERROR_UNSUPPORTED, "%s: contact_model AS_FILE is for models without mimic joints", function);
  if (m.n.compliances == 0 && m.n.nv + m.n.geoms > 0)  // of an MJCF file there would be some
    return fail(DYN_ERROR_UNSUPPORTED,
                "%s: contact_model AS_FILE needs the solref and solimp of an MJCF file, and the model is not of one: use RIGID",
                function);
  if (options.integrator != DYN_INTEGRATOR_SEMI_IMPLICIT_EULER && options.integrator != DYN_INTEGRATOR_IMPLICIT_FAST)
    return fail(DYN_ERROR_UNSUPPORTED,
                "%s: contact_model AS_FILE needs the integrator SEMI_IMPLICIT_EULER or IMPLICIT_FAST", function);
  if (options.accuracy > 0)
    return fail(DYN_ERROR_UNSUPPORTED, "%s: contact_model AS_FILE needs steps of dt: set accuracy to 0", function);
  return DYN_OK;
}

}  // namespace

[[gnu::cold, gnu::noinline]] dynStatus capi::explain_step(const Model& m, const Data<double>& d, Index answer,
                                                          const char* function, double t) {
  if (answer > 0)
    return fail(DYN_ERROR_NUMERIC,
                "%s: forward dynamics is singular at joint '%s' near t = %g s: what it moves has no inertia there, so give it mass, "
                "or the joint armature; the state is as before the step",
                function,
                m.string(m.joints()[answer].name), t);
  if (answer == integrator::not_converged)
    return fail(
        DYN_ERROR_NUMERIC,
        "%s: the implicit midpoint rule does not converge near t = %g s: the state is as before the step; use a smaller dt",
        function, t);
  if (answer == integrator::no_step_left)
    return fail(DYN_ERROR_NUMERIC,
                "%s: no step is short enough near t = %g s, or too many are needed: the motion is singular there, or the "
                "accuracy beyond what rounding "
                "allows; the state is as before the step",
                function, t);
  const simulation::Workspace& w = *d.step;
  if (answer == integrator::energy_gained)
    return fail(DYN_ERROR_NUMERIC,
                "%s: near t = %g s joint '%s' gains kinetic energy that nothing explains, also in parts of dt: the state is as "
                "before the step; "
                "use a smaller dt",
                function, t, m.string(m.joints()[w.failed_joint].name));
  if (answer == integrator::unstable)
    return fail(DYN_ERROR_NUMERIC,
                "%s: springs, damping or gains at joint '%s' are unstable in explicit steps near t = %g s: the state is as "
                "before the step; "
                "use implicit_fast, or a dt below %.2g s",
                function, m.string(m.joints()[w.failed_joint].name), t, w.stable_dt);
  Index bad_v = m.n.nv, bad_q = m.n.nq;
  simulation::with_active_trees(d, [&](const auto& part) {
    part.for_each_group(m, [&](const Trees& t) {
      if (const Index n = finite_count(d.v + t.v, t.v_end - t.v); t.v + n < t.v_end) bad_v = std::min(bad_v, t.v + n);
      if (const Index n = finite_count(d.q + t.q, t.q_end - t.q); t.q + n < t.q_end) bad_q = std::min(bad_q, t.q + n);
    });
  });
  return fail(DYN_ERROR_NUMERIC,
              "%s: the state of joint '%s' is no longer finite near t = %g s: the state is as before the step; use a smaller dt",
              function, joint_at(m, bad_v < m.n.nv ? bad_v : bad_q, bad_v < m.n.nv), t);
}

template <>
dynStepOptions capi::defaults() {
  return simulation::default_options();
}

extern "C" {

dynStatus dyn_data_set_step_options(const dynModel* model, dynData* data, const dynStepOptions* given) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_set_step_options");
  if (!call || !call.required("options", given)) return call.status;
  const Given<dynStepOptions> options(call.function, given);
  if (options.status != DYN_OK) return options.status;
  if (const dynStatus s = check_value(options->integrator, "dyn_data_set_step_options", "integrator")) return s;
  if (!call.finite("dt", &options->dt, 1) || !call.finite("accuracy", &options->accuracy, 1)) return call.status;
  if (!(options->dt > 0))
    return fail(DYN_ERROR_ARGUMENT, "dyn_data_set_step_options: dt is %g s: it must be positive", options->dt);
  if (!(options->accuracy >= 0))
    return fail(DYN_ERROR_ARGUMENT,
                "dyn_data_set_step_options: accuracy is %g: give what the errors may add up to, or 0 for steps of dt",
                options->accuracy);
  if (const dynStatus s = check_value(options->solver, "dyn_data_set_step_options", "solver")) return s;
  if (options->max_iterations < 0)
    return fail(DYN_ERROR_ARGUMENT, "dyn_data_set_step_options: max_iterations is %d: give 1 or more, or 0 for the default",
                int(options->max_iterations));
  if (!call.finite("tolerance", &options->tolerance, 1)) return call.status;
  if (!(options->tolerance >= 0))
    return fail(DYN_ERROR_ARGUMENT, "dyn_data_set_step_options: tolerance is %g: it can't be negative", options->tolerance);
  if (!call.finite("sleep_speed", &options->sleep_speed, 1) || !call.finite("sleep_time", &options->sleep_time, 1))
    return call.status;
  if (!(options->sleep_speed > 0 && options->sleep_time > 0))
    return fail(DYN_ERROR_ARGUMENT, "dyn_data_set_step_options: sleep_speed is %g and sleep_time %g s: both must be positive",
                options->sleep_speed, options->sleep_time);
  if (!call.finite("time_budget", &options->time_budget, 1)) return call.status;
  if (!(options->time_budget >= 0))
    return fail(DYN_ERROR_ARGUMENT,
                "dyn_data_set_step_options: time_budget is %g s: give what the solver may take, or 0 for no limit",
                options->time_budget);
  if (const dynStatus s = check_clock(call.function, options->time_budget)) return s;
  if (const dynStatus s = check_contact_model(call.m(), *options)) return s;
  if (options->reserved != 0)
    return fail(DYN_ERROR_ARGUMENT, "dyn_data_set_step_options: reserved is %d: it must be 0", options->reserved);
  if (options->ledger && !(call.d().parts & DYN_PART_ENERGY))
    return fail(DYN_ERROR_PART, "dyn_data_set_step_options: ledger needs data with DYN_PART_ENERGY");
  const dynStepOptions& now = call.d().step->options;  // a step knows its length
  if (now.integrator != options->integrator || now.solver != options->solver || now.max_iterations != options->max_iterations ||
      now.tolerance != options->tolerance || now.sleep_speed != options->sleep_speed || now.sleep_time != options->sleep_time ||
      now.time_budget != options->time_budget || now.contact_model != options->contact_model)
    simulation::invalidate_sleep(call.d());
  Data<double>& d = call.d();
  if (now.contact_model != options->contact_model) d.step->advancement_cache.square = 0;
  d.pushed &= ~acting_friction_rows, d.acting &= ~acting_friction_rows;
  if (options->contact_model == DYN_CONTACT_MODEL_AS_FILE && call.m().n.friction_rows > 0)
    d.pushed |= acting_friction_rows, d.acting |= acting_friction_rows;
  d.step->options = *options;
  d.step->options.struct_size = sizeof *options;
  return DYN_OK;
}

dynStatus dyn_model_step_options(const dynModel* model, dynStepOptions* options) {
  if (const dynStatus s = check(model)) return s;
  if (const dynStatus s = check_struct("dyn_model_step_options", "options", options)) return s;
  write_struct(simulation::default_options(*model->m), options);
  return DYN_OK;
}

dynStatus dyn_data_step_options(const dynModel* model, dynData* data, dynStepOptions* options) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_step_options");
  if (!call) return call.status;
  if (const dynStatus s = check_struct(call.function, "options", options)) return s;
  write_struct(call.d().step->options, options);
  return DYN_OK;
}

dynStatus dyn_step(const dynModel* model, dynData* data) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_step");
  if (!call) return call.status;
  begin(call);
  return make_step(call, "dyn_step", call.d().step->options.dt);
}

dynStatus dyn_advance(const dynModel* model, dynData* data, double duration) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_advance");
  if (!call || !call.finite("duration", &duration, 1)) return call.status;
  Data<double>& d = call.d();
  if (!(duration >= 0)) return fail(DYN_ERROR_ARGUMENT, "dyn_advance: duration is %g s: time does not run backwards", duration);
  begin(call);
  if (duration == 0) return DYN_OK;
  if (d.step->options.accuracy > 0) return advance_to_accuracy(call, "dyn_advance", duration);
  const double dt = d.step->options.dt, ratio = duration / dt;
  if (!(ratio <= 1e15))
    return fail(DYN_ERROR_ARGUMENT, "dyn_advance: %g s in steps of %g s are too many: take a larger dt", duration, dt);
  // a remainder of a billionth of a step is rounding of duration, not a step
  const std::int64_t whole = std::int64_t(std::floor(ratio * (1 + 1e-12) + 1e-9));
  for (std::int64_t k = 0; k < whole; ++k)
    if (const dynStatus status = make_step(call, "dyn_advance", dt)) return status;
  const double rest = duration - double(whole) * dt;
  return rest > 1e-9 * dt ? make_step(call, "dyn_advance", rest) : DYN_OK;
}

dynStatus dyn_data_step_report(const dynModel* model, dynData* data, dynStepReport* report) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_step_report");
  if (!call || !call.required("report", report)) return call.status;
  if (const dynStatus s = check_struct(call.function, "report", report)) return s;
  write_struct(call.d().step->report, report);
  return DYN_OK;
}

dynStatus dyn_data_error_bar(const dynModel* model, dynData* data, dynData* finer, dynErrorBar* bar) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_error_bar");
  if (!call || !call.required("bar", bar)) return call.status;
  if (const dynStatus s = check_struct(call.function, "bar", bar)) return s;
  const Call second(model, finer, DYN_PART_SIMULATION, call.function);
  if (!second) return second.status;
  const Model& m = call.m();
  const Data<double>&d = call.d(), &x = second.d();
  const dynStepOptions &a = d.step->options, &b = x.step->options;
  const double ratio = b.accuracy > 0 ? (a.accuracy > 0 ? b.accuracy / a.accuracy : 0) : a.accuracy > 0 ? HUGE_VAL : b.dt / a.dt;
  if (!(ratio <= 0.5))
    return fail(DYN_ERROR_ARGUMENT,
                "%s: finer has dt %g s and accuracy %g, data %g s and %g: give finer at most half the dt, or half the accuracy",
                call.function, b.dt, b.accuracy, a.dt, a.accuracy);
  if (!(std::abs(d.time[0] - x.time[0]) <= 1e-9 * std::max(1.0, std::abs(d.time[0]))))
    return fail(DYN_ERROR_ARGUMENT, "%s: data is at %.9g s and finer at %.9g s: advance both by the same durations", call.function,
                d.time[0], x.time[0]);
  const double factor = integrator::tuning::error_bar / (1 - ratio), tenth = integrator::tuning::lost;
  double* const apart = call.d().backup;  // this call replaces no input
  difference(m, x.q, d.q, apart);
  const auto rounding = [](const double* of, Index n) {
    const auto larger = [](double most, double number) { return std::max(most, std::abs(number)); };
    return integrator::tuning::rounding_bar * std::accumulate(of, of + n, 1.0, larger);
  };
  dynErrorBar out{sizeof out, 0, rounding(d.q, m.n.nq), rounding(d.v, m.n.nv)};
  for (Index k = 0; k < m.n.nv; ++k) {
    const double q = factor * std::abs(apart[k]), v = factor * std::abs(d.v[k] - x.v[k]);
    out.q = std::max(out.q, q), out.v = std::max(out.v, v);
    out.lost |= !(q <= tenth * (simulation::is_length(m, k) ? d.step->length : 1));
  }
  write_struct(out, bar);
  return DYN_OK;
}

dynStatus dyn_data_ledger(const dynModel* model, dynData* data, dynErrorLedger* ledger) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_ledger");
  if (!call || !call.required("ledger", ledger)) return call.status;
  if (const dynStatus s = check_struct(call.function, "ledger", ledger)) return s;
  write_struct(call.d().step->ledger.report, ledger);
  return DYN_OK;
}

dynStatus dyn_data_step_contacts(const dynModel* model, dynData* data, dynContactForce* contacts, int capacity, int* count) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_step_contacts");
  if (!call) return call.status;
  if (const dynStatus s = check_capacity(call.function, capacity)) return s;
  if (!call.required("contacts", contacts, capacity) || !call.required("count", count)) return call.status;
  const Data<double>& d = call.d();
  int n = 0;
  simulation::for_each_contact(*d.step, [&](const dynContactForce& f) {
    if (n < capacity) contacts[n] = f;
    ++n;
  });
  *count = n;
  return DYN_OK;
}

dynStatus dyn_data_set_shape_material(const dynModel* model, dynData* data, int shape, const dynMaterial* material) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_set_shape_material");
  if (!call || !call.required("material", material)) return call.status;
  const Index geom = geom_of_shape(call, shape, -1);
  if (!call) return call.status;
  if (const shape::BadNumber bad = shape::bad_number(*material); bad.name)
    return fail(std::isfinite(bad.value) ? DYN_ERROR_ARGUMENT : DYN_ERROR_NONFINITE,
                "%s: %s is %g: give 0 or more, restitution up to 1, finite velocities", call.function, bad.name, bad.value);
  simulation::invalidate_sleep(call.d());
  shape::ShapeMaterial* const of = call.d().step->materials;
  const Index first = std::max<Index>(geom, 0), last = geom < 0 ? call.m().n.geoms : geom + 1;
  for (Index k = first; k < last; ++k) of[k] = {*material, of[k].priority, 0};
  return DYN_OK;
}

dynStatus dyn_data_shape_material(const dynModel* model, dynData* data, int shape, dynMaterial* material) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_shape_material");
  if (!call || !call.required("material", material)) return call.status;
  const Index geom = geom_of_shape(call, shape, 0);
  if (!call) return call.status;
  const shape::ShapeMaterial& x = call.d().step->materials[geom];
  *material = shape::acting(x, x.latent);
  return DYN_OK;
}

}  // extern "C"
