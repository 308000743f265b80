/* A control loop of 1 kHz on absolute deadlines: gravity compensation and a spring to the rest posture, applied to a simulated robot.
 * It reports how late the loop woke, how long its work took, and how many deadlines it missed.
 *   realtime robot.urdf [SECONDS]
 * As root, or with the right to real-time priority, it runs above everything else (SCHED_FIFO). */
#define _GNU_SOURCE
#include <dyn.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>

enum { period = 1000000, max_joints = 64 }; /* ns */

static void check(dynStatus status) {
  if (status == DYN_OK) return;
  fprintf(stderr, "%s: %s\n", dyn_status_name(status), dyn_last_error());
  exit(1);
}
static int64_t since(const struct timespec* a, const struct timespec* b) {
  return (b->tv_sec - a->tv_sec) * (int64_t)1000000000 + b->tv_nsec - a->tv_nsec;
}
static int ascending(const void* a, const void* b) {
  const int64_t x = *(const int64_t*)a, y = *(const int64_t*)b;
  return (x > y) - (x < y);
}
static void show(const char* what, int64_t* x, int n) {
  qsort(x, (size_t)n, sizeof *x, ascending);
  printf("%s  p50 %.1f  p99 %.1f  max %.1f us\n", what, x[n / 2] * 1e-3, x[(int)(n * 0.99)] * 1e-3, x[n - 1] * 1e-3);
}

int main(int argc, char** argv) {
  dynLoadOptions options;
  dynModel* model = NULL;
  dynData *controller = NULL, *robot = NULL;
  dynArray q, v;
  double home[max_joints + 1], tau[max_joints];
  const int cycles = argc > 2 ? (int)(atof(argv[2]) * 1e9 / period) : 1000;
  int64_t *late = NULL, *work = NULL;
  int k, i, nv, misses = 0;
  struct sched_param priority = {80};
  struct timespec next, woke, done;
  if (argc < 2 || cycles < 1) {
    fprintf(stderr, "usage: realtime robot.urdf [SECONDS]\n");
    return 2;
  }

  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  check(dyn_model_load(argv[1], &options, &model));
  nv = dyn_model_nv(model);
  if (nv > max_joints || dyn_model_nq(model) != nv) {
    fprintf(stderr, "the robot is not an arm of at most %d joints\n", max_joints);
    return 1;
  }
  check(dyn_data_new(model, DYN_PART_INVERSE, &controller));
  check(dyn_data_new(model, DYN_PART_SIMULATION, &robot));
  check(dyn_configuration_neutral(model, home));
  late = calloc((size_t)cycles, sizeof *late);
  work = calloc((size_t)cycles, sizeof *work);
  if (!late || !work) return 1;
  q.struct_size = v.struct_size = sizeof q;
  /* views, made once: they follow the data */
  check(dyn_data_array(model, robot, dyn_field_id("q"), &q));
  check(dyn_data_array(model, robot, dyn_field_id("v"), &v));

  /* no call in the loop may wait for memory */
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) perror("mlockall");
  if (sched_setscheduler(0, SCHED_FIFO, &priority) != 0) perror("sched_setscheduler");
  check(dyn_data_warm_up(model, controller));
  check(dyn_data_warm_up(model, robot));

  clock_gettime(CLOCK_MONOTONIC, &next);
  for (k = 0; k < cycles; ++k) {
    next.tv_nsec += period;
    if (next.tv_nsec >= 1000000000) {
      next.tv_nsec -= 1000000000;
      ++next.tv_sec;
    }
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL) != 0) continue;
    clock_gettime(CLOCK_MONOTONIC, &woke);

    check(dyn_nle(model, controller, q.data, v.data, tau));
    for (i = 0; i < nv; ++i) tau[i] += 20 * (home[i] - q.data[i]) - 2 * v.data[i];
    check(dyn_data_set_state(model, robot, NULL, NULL, NULL, tau));
    check(dyn_step(model, robot));

    clock_gettime(CLOCK_MONOTONIC, &done);
    late[k] = since(&next, &woke);
    work[k] = since(&woke, &done);
    misses += since(&next, &done) > period;
  }
  show("woke late ", late, cycles);
  show("work      ", work, cycles);
  printf("%d cycles of %.1f ms, %d deadlines missed\n", cycles, period * 1e-6, misses);
  dyn_data_free(controller);
  dyn_data_free(robot);
  dyn_model_free(model);
  free(late);
  free(work);
  return 0;
}
