/* What happens when a cycle fails: the torque that held the robot in the last good one. After too many in a row it is zero, until
   the control begins anew, and the brakes hold. */
#ifndef WATCHDOG_H
#define WATCHDOG_H

#include "dyn.h"

enum { WATCHDOG_MAX_FAILURES = 10 };

typedef struct Watchdog {
  dynStatus status; /* of the last cycle */
  int failures;     /* cycles in a row that failed */
  int stopped;      /* 1: too many did */
} Watchdog;

static inline void watchdog_failed(Watchdog* w, const double* hold, double* tau, int joints) {
  if (++w->failures > WATCHDOG_MAX_FAILURES) w->stopped = 1;
  for (int k = 0; k < joints; ++k) tau[k] = w->stopped ? 0 : hold[k];
}

#endif
