// What a derivative of forward dynamics costs and what it is worth: analytic, and by differences of every step (the V-curve).
#pragma once

#include "run.hpp"

namespace cli::accuracy {

struct DerivativeCost {
  std::string method;  // analytic, forward, central, extrapolated
  double step;         // rad, m; 0: analytic
  double error;        // largest entry of the difference from the analytic one, relative to its largest entry
  double wall_s;       // of all of them, by q and v
};

std::vector<DerivativeCost> derivative_sweep(const Scene& scene);

}  // namespace cli::accuracy
