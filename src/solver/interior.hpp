// Interior-point method: follows the path of the solutions of
//   cones   Y o U = sigma e,  Y = (mu y_n, y_t),  U = (c_n / mu + |c_t|, c_t),  o the Jordan product of the second-order cone
//   boxes   (y - lower) z_l = sigma,  (upper - y) z_u = sigma,  c = z_l - z_u
// to sigma = 0, with Newton steps in Nesterov-Todd scaling and de Saxce's correction |c_t|
// (nonsmooth interior point method: Acary, Armand, Nguyen and Shpakovych 2024).
// Extreme mass ratios and redundant contacts do not slow it down. Newton's method on the whole problem finishes.
// It can get stuck where friction decides a contact's state; it then returns false.
#pragma once

#include "solver/alart_curnier.hpp"

namespace dyn::solver {

// Starts with `factor` times the impulses that stop all motion; the result goes to w.y. Returns true when the tolerance is met.
bool interior(Workspace& w, Budget& b, double factor);

}  // namespace dyn::solver
