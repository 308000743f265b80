#include "control.h"

#include <string.h>

dynStatus control_begin(Control* c, const void* model, size_t model_size, void* memory, size_t memory_size) {
  memset(c, 0, sizeof *c);
  c->stiffness = 400, c->damping = 40; /* critically damped, 20 rad/s */
  dynStatus s = dyn_model_from_buffer(model, model_size, &c->model);
  if (!s && (dyn_model_nq(c->model) != CONTROL_JOINTS || dyn_model_nv(c->model) != CONTROL_JOINTS)) s = DYN_ERROR_SIZE;
  if (!s) s = dyn_data_init(c->model, DYN_PART_INVERSE, memory, memory_size, &c->data);
  c->watchdog.status = s, c->watchdog.stopped = s != DYN_OK;
  return s;
}

void control_failed(Control* c, double* tau) { watchdog_failed(&c->watchdog, c->hold, tau, CONTROL_JOINTS); }

void control_cycle(Control* c, const double* q, const double* v, const Target* target, double* tau) {
  if (c->watchdog.stopped) {
    control_failed(c, tau);
    return;
  }
  /* dyn.h checks q, v and a: what is not finite is refused, and data and hold stay as they were */
  dynStatus s = dyn_gravity_torque(c->model, c->data, q, c->hold);
  if (!s && target) {
    double a[CONTROL_JOINTS];
    for (int k = 0; k < CONTROL_JOINTS; ++k)
      a[k] = target->a[k] + c->stiffness * (target->q[k] - q[k]) + c->damping * (target->v[k] - v[k]);
    s = dyn_rnea(c->model, c->data, NULL, v, a, NULL, tau);
  } else if (!s) {
    memcpy(tau, c->hold, sizeof c->hold);
  }
  c->watchdog.status = s;
  if (s) control_failed(c, tau);
  else c->watchdog.failures = 0;
}
