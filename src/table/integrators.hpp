// The integrators: one row for each value of dynIntegrator.
#pragma once

#include "dyn.h"

namespace dyn {

struct IntegratorRow {
  dynIntegrator id;
  int order;
  int evaluations;  // of forward dynamics a step; 0: as many as it takes
  bool implicit, estimates;
};

inline constexpr IntegratorRow integrator_rows[] = {
    {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1, 1, false, false},
    {DYN_INTEGRATOR_RK4, 4, 4, false, false},
    {DYN_INTEGRATOR_IMPLICIT_FAST, 1, 1, true, false},
    {DYN_INTEGRATOR_IMPLICIT_MIDPOINT, 2, 0, true, false},
    {DYN_INTEGRATOR_RK45, 5, 7, false, true},
    {DYN_INTEGRATOR_REFERENCE, 8, 0, false, true},
};

}  // namespace dyn
