/* A program of 1.0: compiled with that header (dyn.h.gz), it must run with every later library and print what consumer.txt says. */
#define _POSIX_C_SOURCE 200112L
#include <dyn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void check(dynStatus status) {
  if (status == DYN_OK) return;
  fprintf(stderr, "%s: %s\n", dyn_status_name(status), dyn_last_error());
  exit(1);
}
static void show(const char* what, const double* x, int n) {
  int i;
  printf("%s", what);
  for (i = 0; i < n; ++i) printf(" %.12g", x[i]);
  printf("\n");
}

static dynModel* arm(void) {
  static const double inertia[9] = {0.02, 0, 0, 0, 0.02, 0, 0, 0, 0.01}, com[3] = {0, 0, 0.2}, lower[1] = {-1}, upper[1] = {2},
                      damping[1] = {0.1};
  dynBuilder* builder = NULL;
  dynModel* model = NULL;
  dynJointSpec joint;
  dynShapeSpec shape;
  dynActuator motor;
  dynConstraint limit;
  int k;
  check(dyn_builder_new("arm", &builder));
  for (k = 0; k < 2; ++k) {
    dyn_joint_spec_init(&joint);
    joint.name = k ? "elbow" : "shoulder", joint.parent = k ? "shoulder" : NULL;
    joint.axis[2] = 0, joint.axis[1] = 1, joint.placement[11] = k ? 0.4 : 1.0, joint.lower = lower, joint.upper = upper,
    joint.damping = damping;
    check(dyn_builder_add_joint(builder, &joint));
    check(dyn_builder_add_body(builder, k ? "forearm" : "upper_arm", joint.name, NULL, 1.5, com, inertia));
  }
  dyn_shape_spec_init(&shape);
  shape.name = "hand", shape.body = "forearm", shape.type = DYN_SHAPE_TYPE_SPHERE, shape.size[0] = 0.05,
  shape.placement[11] = 0.4;
  check(dyn_builder_add_shape(builder, &shape));
  dyn_shape_spec_init(&shape);
  shape.name = "floor", shape.body = "universe", shape.type = DYN_SHAPE_TYPE_HALF_SPACE;
  check(dyn_builder_add_shape(builder, &shape));
  dyn_actuator_init(&motor, DYN_ACTUATOR_TYPE_PD);
  motor.kp = 20, motor.kv = 2;
  check(dyn_builder_add_actuator(builder, "motor", &motor, "elbow"));
  dyn_constraint_init(&limit, DYN_CONSTRAINT_TYPE_COUPLING);
  limit.enabled = 0;
  check(dyn_builder_add_constraint(builder, "coupling", &limit, "shoulder", "elbow"));
  check(dyn_builder_finish(builder, &model));
  dyn_builder_free(builder);
  return model;
}

int main(int argc, char** argv) {
  static const double q[2] = {0.3, -0.4}, v[2] = {0.5, 0.2}, a[2] = {-1, 2}, u[3] = {0.5, 0, 0};
  dynModel *model = arm(), *loaded = NULL;
  const dynModel* placed = NULL;
  dynData* data = NULL;
  dynLoadOptions options;
  dynJointInfo joint;
  dynFrameInfo frame;
  dynShapeInfo shape;
  dynFieldInfo field;
  dynStepOptions step;
  dynStepReport report;
  dynIkTask task;
  dynIkResult found;
  dynIkOutput solved;
  dynConstraintResult constrained;
  dynConstrainedOutput motion;
  dynDistance distance;
  dynGeometry ball;
  dynArray array;
  double x[4], M[4], X[12], J[12], lambda[64], energy[2];
  void *bytes = NULL, *memory = NULL;
  size_t size = 0;
  int k;
  if (argc != 2) return 2;

  printf("sizes %d %d %d %d %d %d\n", dyn_model_nq(model), dyn_model_nv(model), dyn_model_njoints(model),
         dyn_model_nframes(model), dyn_model_nshapes(model), dyn_model_nactuators(model));
  joint.struct_size = sizeof joint, frame.struct_size = sizeof frame, shape.struct_size = sizeof shape,
  field.struct_size = sizeof field;
  check(dyn_model_joint_info(model, dyn_model_joint_id(model, "elbow"), &joint));
  printf("joint %s %d %d %d %d %d\n", joint.name, (int)joint.type, joint.parent, joint.idx_q, joint.nq, joint.nv);
  show("placement", joint.placement, 12);
  check(dyn_model_frame_info(model, dyn_model_frame_id(model, "forearm"), &frame));
  printf("frame %s %d %d\n", frame.name, (int)frame.type, frame.joint);
  show("mass", &frame.mass, 1), show("com", frame.com, 3), show("inertia", frame.inertia, 9);
  check(dyn_model_shape_info(model, 0, &shape));
  printf("shape %s %d %d %d %u\n", shape.name, (int)shape.type, (int)shape.role, shape.frame, (unsigned)shape.contype);
  show("size", shape.size, 3), show("friction", &shape.material.friction, 1);
  check(dyn_field_info(dyn_field_id("M"), &field));
  printf("field %s %s %u\n", field.name, field.shape, (unsigned)field.part);

  check(dyn_data_new(model, DYN_PART_ALL, &data));
  check(dyn_rnea(model, data, q, v, a, NULL, x)), show("rnea", x, 2);
  check(dyn_aba(model, data, q, v, a, NULL, x)), show("aba", x, 2);
  check(dyn_crba(model, data, q, M)), show("crba", M, 4);
  check(dyn_energy(model, data, q, v, energy, energy + 1)), show("energy", energy, 2);
  check(dyn_forward_kinematics(model, data, q, v, NULL));
  check(dyn_frame_placement(model, data, dyn_model_frame_id(model, "forearm"), X)), show("frame placement", X, 12);
  check(dyn_joint_jacobians(model, data, q, NULL));
  check(dyn_frame_jacobian(model, data, dyn_model_frame_id(model, "forearm"), DYN_REFERENCE_LOCAL_WORLD_ALIGNED, J)),
      show("frame jacobian", J, 12);
  dyn_ik_task_init(&task);
  task.type = DYN_IK_TASK_TYPE_POSITION, task.frame = dyn_model_frame_id(model, "forearm"), task.target[9] = 0.2,
  task.target[11] = 1.3;
  found.struct_size = sizeof found;
  dyn_ik_output_init(&solved);
  solved.solution = x, solved.result = &found;
  check(dyn_ik(model, data, q, &task, 1, NULL, &solved));
  printf("ik reason %d\n", (int)found.reason);
  constrained.struct_size = sizeof constrained;
  dyn_constrained_output_init(&motion);
  motion.ddq = x, motion.lambda = lambda, motion.result = &constrained;
  check(dyn_data_set_constraint_enabled(model, data, 0, 1));
  check(dyn_constrained_dynamics(model, data, q, v, a, NULL, NULL, &motion));
  show("constrained", x, 2), show("lambda", lambda, 1);
  printf("rows %d %d\n", constrained.rows, constrained.rank);
  check(dyn_data_set_constraint_enabled(model, data, 0, 0));
  dyn_geometry_init(&ball);
  ball.type = DYN_SHAPE_TYPE_SPHERE, ball.size[0] = 0.1;
  memset(X, 0, sizeof X), X[0] = X[4] = X[8] = 1, memcpy(J, X, sizeof X), J[9] = 0.5;
  distance.struct_size = sizeof distance;
  check(dyn_geometry_distance(&ball, X, &ball, J, NULL, &distance));
  show("distance", &distance.distance, 1), show("normal", distance.normal, 3);

  dyn_step_options_init(&step);
  step.dt = 2e-3, step.integrator = DYN_INTEGRATOR_IMPLICIT_FAST;
  check(dyn_data_set_step_options(model, data, &step));
  check(dyn_data_set_state(model, data, q, v, NULL, NULL));
  check(dyn_data_set_control(model, data, u));
  memory = malloc(dyn_model_state_size(model));
  check(dyn_data_save_state(model, data, memory, dyn_model_state_size(model)));
  for (k = 0; k < 100; ++k) check(dyn_step(model, data));
  report.struct_size = sizeof report;
  check(dyn_data_step_report(model, data, &report));
  printf("steps %d\n", (int)report.steps);
  array.struct_size = sizeof array;
  check(dyn_data_array(model, data, dyn_field_id("q"), &array)), show("q", array.data, array.rows);
  check(dyn_data_restore_state(model, data, memory, dyn_model_state_size(model)));
  check(dyn_data_array(model, data, dyn_field_id("q"), &array)), show("q before", array.data, array.rows);

  check(dyn_model_image(model, 0, NULL, 0, &size));
  if (posix_memalign(&bytes, 64, size)) return 1;
  check(dyn_model_image(model, 0, bytes, size, &size));
  check(dyn_model_from_buffer(bytes, size, &placed));
  printf("in place %s %d\n", dyn_model_name(placed), dyn_model_nv(placed));

  dyn_load_options_init(&options);
  options.base = DYN_BASE_FLOATING;
  check(dyn_model_load(argv[1], &options, &loaded));
  printf("loaded %s %d %d\n", dyn_model_name(loaded), dyn_model_nq(loaded), dyn_model_nv(loaded));
  options.struct_size = 4;
  printf("too small %s\n", dyn_status_name(dyn_model_load(argv[1], &options, &loaded)));
  printf("unknown %d\n", dyn_model_joint_id(model, "wrist"));
  dyn_data_free(data), dyn_model_free(model), dyn_model_free(loaded), free(bytes), free(memory);
  return 0;
}
