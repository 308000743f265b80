/* Control of a quadruped that stands, a cycle at a time: the torques and the forces of the feet that give the wanted acceleration,
   by inverse dynamics with the feet held, and what happens when a cycle fails. */
#ifndef STANCE_H
#define STANCE_H

#include "watchdog.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { STANCE_FEET = 4, STANCE_NQ = 19, STANCE_NV = 18, STANCE_MOTORS = 12, STANCE_ROWS = 3 * STANCE_FEET };

typedef struct Stance {
  const dynModel* model;
  dynData* data;
  double stiffness, damping;   /* of the error: 1/s^2, 1/s */
  double hold[STANCE_MOTORS];  /* torques of the last good cycle */
  double forces[STANCE_ROWS];  /* on the feet, N, world axes */
  Watchdog watchdog;
} Stance;

/* A configuration, and its velocity and acceleration on the tangent space. */
typedef struct StanceTarget {
  double q[STANCE_NQ], v[STANCE_NV], a[STANCE_NV];
} StanceTarget;

/* Holds the feet (frames FL_foot, FR_foot, RL_foot, RR_foot) of data where they are at q. */
dynStatus stance_hold_feet(const dynModel* model, dynData* data, const double* q);

/* Makes the data in memory, with the feet where they are at q. */
dynStatus stance_begin(Stance* s, const dynModel* model, const double* q, void* memory, size_t memory_size);

/* One cycle: torques of the motors for measured q and v (of the trunk from an estimator). A cycle that fails gives those of the
   last good one. */
void stance_cycle(Stance* s, const double* q, const double* v, const StanceTarget* target, double* tau);

/* The last cycle failed for a reason that dyn.h does not know, as a missed deadline. */
void stance_failed(Stance* s, double* tau);

#ifdef __cplusplus
}
#endif
#endif
