/* The arm itself, where there is none: forward dynamics in steps of a cycle. On hardware, encoders and drives take its place. */
#ifndef PLANT_H
#define PLANT_H

#include "control.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct Plant {
  const dynModel* model;
  dynData* data;
  double q[CONTROL_JOINTS], v[CONTROL_JOINTS];
} Plant;

dynStatus plant_begin(Plant* p, const dynModel* model, void* memory, size_t memory_size);
/* Holds the torque for h seconds. */
dynStatus plant_step(Plant* p, const double* tau, double h);

#ifdef __cplusplus
}
#endif
#endif
