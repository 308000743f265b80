/* Control of an arm, a cycle at a time: gravity compensation or computed torque, and what happens when a cycle fails. No heap, no
   operating system. */
#ifndef CONTROL_H
#define CONTROL_H

#include "watchdog.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CONTROL_JOINTS = 8 };

typedef struct Control {
  const dynModel* model;
  dynData* data;
  double stiffness, damping;     /* of the error: 1/s^2, 1/s */
  double hold[CONTROL_JOINTS];   /* torque against gravity in the last good cycle */
  Watchdog watchdog;
} Control;

typedef struct Target {
  double q[CONTROL_JOINTS], v[CONTROL_JOINTS], a[CONTROL_JOINTS];
} Target;

/* Opens the model (in flash) and makes its data in memory. Anything but DYN_OK: dyn_last_error() says why. */
dynStatus control_begin(Control* c, const void* model, size_t model_size, void* memory, size_t memory_size);

/* One cycle: torques for measured q and v. target NULL: gravity compensation, the arm can be moved by hand.
   A cycle that fails (a reading is no number, a cycle took too long) gives the torque that holds the arm. */
void control_cycle(Control* c, const double* q, const double* v, const Target* target, double* tau);

/* The last cycle failed for a reason that dyn.h does not know, as a missed deadline. */
void control_failed(Control* c, double* tau);

#ifdef __cplusplus
}
#endif
#endif
