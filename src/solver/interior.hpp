// An interior point method: along the path of the solutions of
//   cones   Y o U = sigma e,  Y = (mu y_n, y_t),  U = (c_n / mu + |c_t|, c_t),  o the Jordan product of the second-order cone
//   boxes   (y - lower) z_l = sigma,  (upper - y) z_u = sigma,  c = z_l - z_u
// to sigma = 0, by Newton's method in Nesterov and Todd's scaling with de Saxce's correction |c_t| in it (Acary, Armand, Nguyen and
// Shpakovych 2024: nonsmooth interior point method). Extreme mass ratios and redundant contacts do not slow it down; near the end
// Newton's method on the whole problem takes over. Where friction decides what a contact does it can get stuck: it says so.
#pragma once

#include "solver/alart_curnier.hpp"

namespace dyn::solver {

// To w.y, from a start of its own: forces as a factor times what stops everything. true: it is good enough.
bool interior(Workspace& w, Budget& b, double factor);

}  // namespace dyn::solver
