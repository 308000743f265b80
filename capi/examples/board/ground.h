/* The quadruped itself on ground that holds its feet, where there is none: constrained forward dynamics in steps of a cycle. On
   hardware, encoders, an estimator of the trunk's motion, and drives take its place. */
#ifndef GROUND_H
#define GROUND_H

#include "stance.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct Ground {
  const dynModel* model;
  dynData* data;
  double q[STANCE_NQ], v[STANCE_NV];
  double forces[STANCE_ROWS]; /* on the feet, N, world axes */
} Ground;

dynStatus ground_begin(Ground* g, const dynModel* model, const double* q, void* memory, size_t memory_size);
/* Holds the torques of the motors, and a force on the trunk (N, trunk's axes), for h seconds. */
dynStatus ground_step(Ground* g, const double* tau, const double* push, double h);

#ifdef __cplusplus
}
#endif
#endif
