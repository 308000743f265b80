/* Prints the level that the library uses, then numbers that it computes.   user ROBOT.urdf [libdyn.so]: opened by its path */
#include <dlfcn.h>
#include <dyn.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef BY_PATH
#define F(name) ((__typeof__(&(name)))dlsym(library, #name))
static void* library;
#undef dyn_load_options_init
#define DYN_INIT(x) F(dyn_load_options_init)(x, sizeof *(x))
#else
#define F(name) name
#define DYN_INIT(x) dyn_load_options_init(x)
#endif

static void check(dynStatus status) {
  if (status == DYN_OK) return;
  fprintf(stderr, "%s: %s\n", F(dyn_status_name)(status), F(dyn_last_error)());
  exit(1);
}

#ifdef STATIC
/* before the library itself is initialized */
static double early[64];
__attribute__((constructor(101))) static void call_early(void) {
  const double q0[3] = {0, 0, 0}, q1[1] = {1}, inertia[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  dynBuilder* builder = NULL;
  dynModel* model = NULL;
  dynJointSpec joint;
  dyn_joint_spec_init(&joint);
  check(dyn_builder_new("early", &builder));
  joint.name = "j", joint.type = DYN_JOINT_TYPE_PRISMATIC;
  check(dyn_builder_add_joint(builder, &joint));
  check(dyn_builder_add_body(builder, "b", "j", NULL, 1.0, q0, inertia));
  check(dyn_builder_finish(builder, &model));
  check(dyn_interpolate(model, q0, q1, 0.25, early));
  dyn_model_free(model);
  dyn_builder_free(builder);
}
#endif

int main(int argc, char** argv) {
  dynLoadOptions options;
  dynModel* model = NULL;
  dynData* data = NULL;
  double q[64], v[64], tau[64], a[64];
  int i, nv;
  if (argc < 2) return 2;
#ifdef BY_PATH
  library = dlopen(argv[2], RTLD_NOW);
  if (!library) return fprintf(stderr, "%s\n", dlerror()), 2;
#endif
#ifdef STATIC
  if (early[0] != 0.25) return fprintf(stderr, "called early: %g\n", early[0]), 1;
#endif
  printf("%s\n", F(dyn_build_info)());
  DYN_INIT(&options);
  options.base = DYN_BASE_FLOATING;
  check(F(dyn_model_load)(argv[1], &options, &model));
  check(F(dyn_data_new)(model, 0, &data));
  nv = F(dyn_model_nv)(model);
  check(F(dyn_configuration_neutral)(model, q));
  for (i = 0; i < nv; ++i) v[i] = 0.1 * (i + 1), tau[i] = 1.0 - 0.2 * i;
  check(F(dyn_integrate)(model, q, v, q));
  check(F(dyn_aba)(model, data, q, v, tau, NULL, a));
  check(F(dyn_rnea)(model, data, q, v, a, NULL, tau));
  for (i = 0; i < nv; ++i) printf("%.17g %.17g\n", a[i], tau[i]);
  F(dyn_data_free)(data);
  F(dyn_model_free)(model);
  return 0;
}
