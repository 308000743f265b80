#include <dyn.h>
#include <stdio.h>
int main(void) {
  const double q[] = {1.5707963267948966, 0}; /* two links, held out horizontally */
  dynLoadOptions options; dynModel* m = NULL; dynData* d = NULL; double tau[2];
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  if (dyn_model_load("models/robots/double_pendulum.urdf", &options, &m) != DYN_OK || dyn_data_new(m, DYN_PART_INVERSE, &d) != DYN_OK ||
      dyn_rnea(m, d, q, NULL, NULL, NULL, tau) != DYN_OK) /* v and a held in data: zero */
    return fprintf(stderr, "%s\n", dyn_last_error()), 1;
  return printf("tau = %.6g, %.6g N m\n", tau[0], tau[1]) < 0;
}
