// The contact solvers.
#pragma once

#include "dyn/solver/admm.hpp"
#include "dyn/solver/newton.hpp"
#include "dyn/solver/pgs.hpp"

namespace dyn::solver {

using Solver = void (*)(Workspace&, Budget&);
inline constexpr Solver solvers[] = {pgs, admm, newton};  // by dynContactSolverType

// Reads the problem into w, solves it, and fills the report but for its size. guess: lambda is one.
void solve(const dynContactProblem& x, Solver solver, Workspace& w, Budget& b, double* lambda, dynContactReport& report);

}  // namespace dyn::solver
