// The contact solvers.
#pragma once

#include "solver/admm.hpp"
#include "solver/newton.hpp"
#include "solver/pgs.hpp"

namespace dyn::solver {

using Solver = void (*)(Workspace&, Budget&);
inline constexpr Solver solvers[] = {pgs, admm, newton};  // by dynContactSolverType
inline constexpr bool refined[] = {false, true, true};    // whether Newton's method finishes what they find

// Reads the problem into w and solves it. Fills w.y and the report, except its size. With b.warm, lambda is a guess.
void solve(const dynContactProblem& x, Solver solver, Workspace& w, Budget& b, const double* lambda, dynContactReport& report);
// Fills the report on a given lambda.
void evaluate(const dynContactProblem& x, Workspace& w, const double* lambda, dynContactReport& report);

}  // namespace dyn::solver
