/* A quadruped in C: its sizes, the places of its feet, and their Jacobians. quadruped.cpp continues from here.
 *   feet ROBOT.urdf */
#include <dyn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { nq = 19, nv = 18, njoints = 14 };

static void check(dynStatus status) {
  if (status == DYN_OK) return;
  fprintf(stderr, "%s\n", dyn_last_error());
  exit(1);
}
static void claim(int holds, const char* what) {
  if (holds) return;
  fprintf(stderr, "this does not hold: %s\n", what);
  exit(1);
}

int main(int argc, char** argv) {
  static const char* const feet[] = {"FL_foot", "FR_foot", "RL_foot", "RR_foot"};
  dynLoadOptions options;
  dynModel* m = NULL;
  dynData* d = NULL;
  double q[nq], v[nv];
  if (argc != 2) {
    fprintf(stderr, "usage: %s ROBOT.urdf\n", argv[0]);
    return 2;
  }
  dyn_load_options_init(&options);
  claim(dyn_model_load(argv[1], &options, &m) == DYN_ERROR_BASE, "a base is never guessed");
  options.base = DYN_BASE_FLOATING;
  check(dyn_model_load(argv[1], &options, &m));
  claim(dyn_model_nq(m) == nq && dyn_model_nv(m) == nv && dyn_model_njoints(m) == njoints,
        "position and quaternion, twelve angles; the universe is joint 0");
  printf("%s: nq %d, nv %d, %d joints, %d frames, %.4g kg\n", dyn_model_name(m), nq, nv, njoints, dyn_model_nframes(m),
         dyn_model_total_mass(m));

  check(dyn_data_new(m, DYN_PART_JACOBIANS, &d));
  check(dyn_configuration_neutral(m, q));
  for (int leg = 0; leg < 4; ++leg) {
    q[7 + 3 * leg + 1] = 0.8;  /* thigh */
    q[7 + 3 * leg + 2] = -1.6; /* calf */
  }
  for (int k = 0; k < nv; ++k) v[k] = 0.1 * (k + 1);
  check(dyn_forward_kinematics(m, d, q, v, NULL));
  for (int foot = 0; foot < 4; ++foot) {
    const int id = dyn_model_frame_id(m, feet[foot]);
    double X[12], J[6 * nv], twist[6]; /* column-major */
    check(dyn_frame_placement(m, d, id, X));
    check(dyn_frame_jacobian(m, d, id, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, J));
    check(dyn_frame_velocity(m, d, id, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, twist));
    for (int i = 0; i < 6; ++i) {
      double sum = 0;
      for (int k = 0; k < nv; ++k) sum += J[6 * k + i] * v[k];
      claim(fabs(sum - twist[i]) < 1e-13, "J v is the foot's twist");
    }
    printf("%s at %.3f %.3f %.3f m\n", feet[foot], X[9], X[10], X[11]);
  }
  dyn_data_free(d);
  dyn_model_free(m);
  return 0;
}
