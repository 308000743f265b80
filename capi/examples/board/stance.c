#include "stance.h"

#include <string.h>

dynStatus stance_hold_feet(const dynModel* model, dynData* data, const double* q) {
  static const char* const feet[STANCE_FEET] = {"FL_foot", "FR_foot", "RL_foot", "RR_foot"};
  for (int k = 0; k < STANCE_FEET; ++k) {
    dynConstraint foot;
    dyn_constraint_init(&foot, DYN_CONSTRAINT_TYPE_POINT);
    foot.first = dyn_model_frame_id(model, feet[k]);
    foot.stiffness = 2500, foot.damping = 100; /* of the plant: what rounding moves comes back in 20 ms */
    dynStatus s = dyn_data_set_constraint(model, data, k, &foot);
    if (!s) s = dyn_data_anchor_constraint(model, data, k, q);
    if (s) return s;
  }
  return DYN_OK;
}

dynStatus stance_begin(Stance* s, const dynModel* model, const double* q, void* memory, size_t memory_size) {
  memset(s, 0, sizeof *s);
  s->model = model, s->stiffness = 400, s->damping = 40; /* critically damped, 20 rad/s */
  dynStatus status = DYN_OK;
  if (dyn_model_nq(model) != STANCE_NQ || dyn_model_nv(model) != STANCE_NV) status = DYN_ERROR_SIZE;
  if (!status) status = dyn_data_init(model, DYN_PART_CONSTRAINTS | DYN_PART_INVERSE, memory, memory_size, &s->data);
  if (!status) status = stance_hold_feet(model, s->data, q);
  s->watchdog.status = status, s->watchdog.stopped = status != DYN_OK;
  return status;
}

void stance_failed(Stance* s, double* tau) { watchdog_failed(&s->watchdog, s->hold, tau, STANCE_MOTORS); }

void stance_cycle(Stance* s, const double* q, const double* v, const StanceTarget* target, double* tau) {
  if (s->watchdog.stopped) {
    stance_failed(s, tau);
    return;
  }
  double a[STANCE_NV], forces[STANCE_ROWS], torques[STANCE_NV];
  /* the way from q to the target, and the acceleration that closes it */
  dynStatus status = dyn_difference(s->model, q, target->q, a);
  for (int k = 0; k < STANCE_NV; ++k) a[k] = target->a[k] + s->stiffness * a[k] + s->damping * (target->v[k] - v[k]);
  dynConstrainedOutput out;
  dyn_constrained_output_init(&out);
  out.tau = torques, out.lambda = forces;
  /* what is not finite is refused; the trunk has no motor */
  if (!status) status = dyn_constrained_inverse_dynamics(s->model, s->data, q, v, a, NULL, NULL, &out);
  s->watchdog.status = status;
  if (status) {
    stance_failed(s, tau);
    return;
  }
  s->watchdog.failures = 0;
  memcpy(s->forces, forces, sizeof forces);
  memcpy(s->hold, torques + STANCE_NV - STANCE_MOTORS, sizeof s->hold);
  memcpy(tau, s->hold, sizeof s->hold);
}
