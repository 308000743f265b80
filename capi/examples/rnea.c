#include <dyn.h>
#include <stdio.h>
int main(void) {
  const double q[] = {1.5707963267948966, 0}; /* two links, held out horizontally */
  dynLoadOptions options; dynModel* m = NULL; dynData* d = NULL; double tau[2];
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  int failed = dyn_model_load("models/robots/double_pendulum.urdf", &options, &m) || dyn_data_new(m, DYN_PART_INVERSE, &d) ||
               dyn_rnea(m, d, q, NULL, NULL, NULL, tau); /* v and a held in data: zero */
  failed ? fprintf(stderr, "%s\n", dyn_last_error()) : printf("tau = %.6g, %.6g N m\n", tau[0], tau[1]);
  dyn_data_free(d), dyn_model_free(m);
  return failed;
}
