#include "plant.h"

#include <string.h>

dynStatus plant_begin(Plant* p, const dynModel* model, void* memory, size_t memory_size) {
  memset(p, 0, sizeof *p);
  p->model = model;
  return dyn_data_init(model, DYN_PART_FORWARD | DYN_PART_CHOLESKY, memory, memory_size, &p->data);
}

dynStatus plant_step(Plant* p, const double* tau, double h) {
  double a[CONTROL_JOINTS];
  const dynStatus s = dyn_aba(p->model, p->data, p->q, p->v, tau, NULL, a);
  for (int k = 0; !s && k < CONTROL_JOINTS; ++k) p->v[k] += h * a[k], p->q[k] += h * p->v[k];
  return s;
}
