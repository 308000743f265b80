// Proximal ADMM (Carpentier, Le Lidec and Montaut 2024): min 1/2 x'Gx + x'(g + Gamma) over x = y in K, Gamma the de Saxce correction of the
// velocity that the dual variable z is.
//   x  <- -(G + (eta + rho) I)^-1 (g + Gamma - eta x - rho y - z)
//   y  <- P_K(x^ - z / rho),  x^ = over-relaxed x
//   z  <- z - rho (x^ - y),   in K* and orthogonal to y
// What it finds roughly, which contacts are apart, stuck, sliding, Newton's method on the whole problem finishes.
#pragma once

#include "dyn/solver/alart_curnier.hpp"

namespace dyn::solver {

// From w.y to w.y.
void admm(Workspace& w, Budget& b);

}  // namespace dyn::solver
