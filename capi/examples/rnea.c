#include <dyn.h>
#include <stdio.h>

int main(void) {
  const double q[2] = {1.5707963267948966, 0}; /* both links straight out */
  double tau[2];
  dynModel* model = NULL;
  dynData* data = NULL;
  dynLoadOptions options;

  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  dynStatus status = dyn_model_load("models/robots/double_pendulum.urdf", &options, &model);
  if (status == DYN_OK) status = dyn_data_new(model, DYN_PART_INVERSE, &data);
  if (status == DYN_OK) status = dyn_rnea(model, data, q, NULL, NULL, NULL, tau); /* v and a held in data: zero */
  if (status == DYN_OK) {
    printf("tau = %.6g, %.6g N m\n", tau[0], tau[1]);
  } else {
    fprintf(stderr, "%s\n", dyn_last_error());
  }

  dyn_data_free(data);
  dyn_model_free(model);
  return status == DYN_OK ? 0 : 1;
}
