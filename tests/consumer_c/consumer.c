/* A C99 user of the installed library: loads a robot and computes the torques that hold it at rest. */
#include <dyn.h>
#include <stdio.h>
#include <stdlib.h>

static void check(dynStatus status) {
  if (status == DYN_OK) return;
  fprintf(stderr, "%s: %s\n", dyn_status_name(status), dyn_last_error());
  exit(1);
}

int main(int argc, char** argv) {
  dynLoadOptions options;
  dynModel* model = NULL;
  dynData* data = NULL;
  double tau[64], norm = 0;
  int i;
  if (argc != 2) return 2;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  check(dyn_model_load(argv[1], &options, &model));
  check(dyn_data_new(model, 0, &data));
  if (dyn_model_nv(model) > 64) return 2;
  check(dyn_gravity_torque(model, data, NULL, tau));
  for (i = 0; i < dyn_model_nv(model); ++i) norm += tau[i] * tau[i];
  printf("libdyn %s, nq %d, nv %d, |g|^2 %.6g\n", dyn_version(), dyn_model_nq(model), dyn_model_nv(model), norm);
  dyn_data_free(data);
  dyn_model_free(model);
  return 0;
}
