// Steps of smooth dynamics.
#include "guard.hpp"

using namespace dyn;
using namespace dyn::capi;

extern "C" dynStatus dyn_step(const dynModel* model, dynData* data, dynIntegrator integrator, double dt) {
  Call call(model, data, DYN_PART_FORWARD, "dyn_step");
  if (!call || !call.finite("dt", &dt, 1)) return call.status;
  if (!(dt > 0)) return fail(DYN_ERROR_ARGUMENT, "dyn_step: dt is %g s: it must be positive", dt);
  if (integrator != DYN_SEMI_IMPLICIT_EULER && integrator != DYN_RK4)
    return fail(DYN_ERROR_ARGUMENT, "dyn_step: integrator %d does not exist: use DYN_SEMI_IMPLICIT_EULER or DYN_RK4", int(integrator));
  if (call.m().has_mimic && !call.d().has(DYN_PART_FACTOR))
    return fail(DYN_ERROR_PART, "dyn_step: the model has mimic joints, so that it needs part DYN_PART_FACTOR as well: name it in dyn_data_new");
  const Model& m = call.m();
  Data<double>& d = call.d();
  call.begin_step();
  const Index joint = integrator == DYN_RK4 ? step_rk4(m, d, dt) : step_semi_implicit_euler(m, d, dt);
  if (joint) {
    call.take_back();
    return fail(DYN_ERROR_NUMERIC, "dyn_step: forward dynamics is singular at joint '%s' near t = %g s: the state is as before the step",
                m.string(m.joints()[joint].name), d.time[0]);
  }
  Index bad = finite_count(d.v, m.n.nv);
  const bool in_v = bad < m.n.nv;
  if (!in_v) bad = finite_count(d.q, m.n.nq);
  if (in_v || bad < m.n.nq) {
    const char* name = "?";
    for (Index j = 1; j < m.n.joints; ++j)
      if ((in_v ? m.joints()[j].idx_v : m.joints()[j].idx_q) <= bad) name = m.string(m.joints()[j].name);
    call.take_back();
    return fail(DYN_ERROR_NUMERIC, "dyn_step: the state of joint '%s' is no longer finite near t = %g s: the state is as before the step; use a smaller dt", name, d.time[0]);
  }
  call.end_step();
  d.time[0] += dt;
  return DYN_OK;
}
