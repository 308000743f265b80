#include "control.h"

#include <string.h>

dynStatus control_begin(Control* c, const void* model, size_t model_size, void* memory, size_t memory_size) {
  memset(c, 0, sizeof *c);
  c->stiffness = 400, c->damping = 40; /* critically damped, 20 rad/s */
  dynStatus s = dyn_model_from_buffer(model, model_size, &c->model);
  if (!s && (dyn_model_nq(c->model) != CONTROL_JOINTS || dyn_model_nv(c->model) != CONTROL_JOINTS)) s = DYN_ERROR_SIZE;
  if (!s) s = dyn_data_init(c->model, DYN_PART_INVERSE, memory, memory_size, &c->data);
  c->status = s, c->stopped = s != DYN_OK;
  return s;
}

void control_failed(Control* c, double* tau) {
  if (++c->failures > CONTROL_MAX_FAILURES) c->stopped = 1;
  for (int k = 0; k < CONTROL_JOINTS; ++k) tau[k] = c->stopped ? 0 : c->hold[k];
}

void control_cycle(Control* c, const double* q, const double* v, const Target* target, double* tau) {
  if (c->stopped) {
    control_failed(c, tau);
    return;
  }
  /* dyn.h checks q, v and a: what is not finite is refused, and data and hold stay as they were */
  c->status = dyn_gravity_torque(c->model, c->data, q, c->hold);
  if (!c->status && target) {
    double a[CONTROL_JOINTS];
    for (int k = 0; k < CONTROL_JOINTS; ++k)
      a[k] = target->a[k] + c->stiffness * (target->q[k] - q[k]) + c->damping * (target->v[k] - v[k]);
    c->status = dyn_rnea(c->model, c->data, NULL, v, a, NULL, tau);
  } else if (!c->status) {
    memcpy(tau, c->hold, sizeof c->hold);
  }
  if (c->status) control_failed(c, tau);
  else c->failures = 0;
}
