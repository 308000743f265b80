#include "constraint.hpp"
extern "C" {
dynStatus dyn_constrained_dynamics_derivatives(const dynModel*, dynData*, const double*, const double*, const double*, const double*, const dynConstraintOptions*, const dynConstraintDerivatives*, dynConstraintResult*) { return DYN_ERROR_UNSUPPORTED; }
dynStatus dyn_constraint_impulse_derivatives(const dynModel*, dynData*, const double*, const double*, const dynConstraintOptions*, const dynConstraintDerivatives*, dynConstraintResult*) { return DYN_ERROR_UNSUPPORTED; }
}
