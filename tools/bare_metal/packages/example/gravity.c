#include "gravity.h"

extern const unsigned char arm[]; /* arm.c, by `dyn convert` */
extern const size_t arm_size;

static char memory[8192];
static const dynModel* model;
static dynData* data;

dynStatus gravity_begin(void) {
  dynStatus s = dyn_model_from_buffer(arm, arm_size, &model);
  if (!s && dyn_model_nv(model) != GRAVITY_JOINTS) s = DYN_ERROR_SIZE;
  return s ? s : dyn_data_init(model, DYN_PART_INVERSE, memory, sizeof memory, &data);
}

dynStatus gravity_torques(const double q[GRAVITY_JOINTS], double tau[GRAVITY_JOINTS]) {
  return dyn_gravity_torque(model, data, q, tau);
}
