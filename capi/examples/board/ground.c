#include "ground.h"

#include <string.h>

dynStatus ground_begin(Ground* g, const dynModel* model, const double* q, void* memory, size_t memory_size) {
  memset(g, 0, sizeof *g);
  g->model = model;
  memcpy(g->q, q, sizeof g->q);
  const dynStatus s = dyn_data_init(model, DYN_PART_CONSTRAINTS, memory, memory_size, &g->data);
  return s ? s : stance_hold_feet(model, g->data, q);
}

dynStatus ground_step(Ground* g, const double* tau, const double* push, double h) {
  double torques[STANCE_NV] = {0}, a[STANCE_NV], q[STANCE_NQ];
  for (int k = 0; k < 3; ++k) torques[k] = push[k];
  memcpy(torques + STANCE_NV - STANCE_MOTORS, tau, STANCE_MOTORS * sizeof *tau);
  dynConstrainedOutput out;
  dyn_constrained_output_init(&out);
  out.ddq = a, out.lambda = g->forces;
  dynStatus s = dyn_constrained_dynamics(g->model, g->data, g->q, g->v, torques, NULL, NULL, &out);
  if (s) return s;
  for (int k = 0; k < STANCE_NV; ++k) g->v[k] += h * a[k], a[k] = h * g->v[k];
  s = dyn_integrate(g->model, g->q, a, q);
  if (!s) memcpy(g->q, q, sizeof q);
  return s;
}
