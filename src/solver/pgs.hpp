// Projected block Gauss-Seidel: each block is solved exactly for the current impulses of the others.
// One cone, b its velocity without its own impulse (Preclik, Eibl and Ruede 2018; Hwangbo, Lee and Hutter 2018 by bisection):
//   b_n >= 0            open: 0
//   -G_kk^-1 b in K     stick
//   otherwise slip:     c_n = 0 and c_t = -a lambda_t for an a > 0, so lambda_t(a) = -(S + a I)^-1 b~,
//                       S = G_tt - G_tn G_nt / G_nn, b~ = b_t - G_tn b_n / G_nn;
//                       with S = Q E Q' one scalar equation mu lambda_n(a) = |lambda_t(a)|
#pragma once

#include "solver/budget.hpp"

namespace dyn::solver {

// Eigenvectors of the cone's own block of p.G. Its rows are consecutive, the normal first.
LocalCone local_cone(const Problem& p, const Cone& cone);
// The cone's impulse for the velocity b without it. Gnn: diagonal of the normal.
void solve_cone(const Cone& cone, LocalCone& l, double Gnn, const double* b, double* y);

// Prepares w.local.
void prepare_sweeps(Workspace& w);
// One sweep over y; c = G y + g is updated.
void sweep(const Workspace& w, double relaxation, double* y, double* c);

// Starts from w.y and leaves the result there.
void pgs(Workspace& w, Budget& b);

}  // namespace dyn::solver
