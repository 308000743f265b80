/* Gravity compensation: the torques that hold an arm, from a model in flash and memory of the program. */
#ifndef GRAVITY_H
#define GRAVITY_H

#include "dyn.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { GRAVITY_JOINTS = 8 };

/* Anything but DYN_OK: dyn_last_error() says why. */
dynStatus gravity_begin(void);
dynStatus gravity_torques(const double q[GRAVITY_JOINTS], double tau[GRAVITY_JOINTS]);

#ifdef __cplusplus
}
#endif
#endif
