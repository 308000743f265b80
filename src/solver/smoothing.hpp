// Smoothing Newton method: the natural map with a smoothed projection and a smoothed correction,
//   y - P(y - rho (c + Gamma(c)))  with  P(z) = sum g(z_i) e_i,  g(z) = (z + sqrt(z^2 + 4 eps^2)) / 2
// over the spectral decomposition of z in the second-order cone (Chen and Harker 1993; Kanzow 1996; Fukushima, Luo and Tseng
// 2002), and |c_t| smoothed to sqrt(|c_t|^2 + eps^2); eps falls to zero along the way. It needs no guess, and where contacts jam
// and slide it finds solutions that other methods miss. Each step takes a dense factorization.
#pragma once

#include "solver/budget.hpp"

namespace dyn::solver {

// Starts from zero impulses. Returns true when the tolerance is met.
bool smoothing_newton(Workspace& w, Budget& b);

}  // namespace dyn::solver
