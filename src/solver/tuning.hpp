// Tuning constants of the contact solvers. Rows are scaled to a unit diagonal of G, so most of them have no unit.
#pragma once

#include "base/types.hpp"

namespace dyn::solver::tuning {

inline constexpr double epsilon = 2.2e-16;   // relative rounding of a double
inline constexpr double round_off = 1e-15;   // the same of a sum of several terms
inline constexpr int sweeps_a_check = 20;    // sweeps between looks at the best iterate, and at the progress
inline constexpr double proximal = 1e-11;    // of the unit diagonal: Newton steps are unique for redundant contacts
inline constexpr double shortest_part = 0.125;  // of a Newton step in the line search; shorter ones are damped, or the last
inline constexpr double time_fading = 0.9;   // of the longest duration seen, at each shorter one (time_limit.hpp)

// Acceptance of a solution (solve.cpp, budget.hpp, residuals.hpp, problem.cpp).
namespace accept {
inline constexpr double energy = 1e-10;           // relative work of impulses that counts as rounding
inline constexpr double energy_by_tolerance = 10;  // and, times the tolerance, as its consequence
inline constexpr double max_residual = 1e-2;      // above it impulses miss the velocities asked for: no restitution
inline constexpr double restitution_step = 1e-2;  // bisection of the restitution scale ends at this width
inline constexpr double near_round_off = 10;      // of the rounding of G y: errors below are computed in extended precision
inline constexpr double lost_speed = 1e-4;        // share of the speeds below which the rounding of an impulse must stay
inline constexpr double immovable = 1e-24;        // of the largest diagonal: rows below move by rounding only (squared 1e-12)
}  // namespace accept

// Start of admm and newton (start.hpp).
namespace start {
inline constexpr double close_guess = 1e-3;    // residual over speed from which Newton is tried before any sweep
inline constexpr Index sweep_steps = 30;       // damped Newton steps from a guess, and from what sweeps leave
inline constexpr double max_contraction = 0.7;  // sweeps go on while each reduces the error by this factor,
inline constexpr double rows_a_sweep = 12;      // or by exp(-this / rows): a sweep costs 1/n of a factorization
}  // namespace start

// Projected Gauss-Seidel (pgs.cpp).
namespace pgs {
inline constexpr double relaxation = 1.1;          // over-relaxation after the first sweep
inline constexpr double tiny = 1e-14;              // of the diagonal: stiffness that counts as none
inline constexpr int warm_steps = 4;               // Newton steps from the last resistance
inline constexpr double warm_enough = 1e-3;        // of the resistance: a smaller change ends; Newton then has twice the digits
inline constexpr double root_growth = 4;           // of the resistance while no upper bound is known
inline constexpr double slip_tolerance = 1e-9;     // the same of one contact in a sweep, which the next sweep repeats
inline constexpr double singular_block = 1e-10;    // of the product of the diagonal: such a determinant is none
}  // namespace pgs

// Multipliers: ADMM and augmented Lagrangian steps (multipliers.cpp).
namespace multipliers {
inline constexpr double relaxation = 1.6;            // over-relaxation of ADMM (OSQP: Stellato et al. 2020)
inline constexpr double first_rho = 0.1;             // penalty at the start (OSQP)
inline constexpr Index balance_interval = 5;         // steps between changes of rho: each costs a factorization
inline constexpr double balance_ratio = 3;           // of the errors; below it rho stays
inline constexpr double max_rho_factor = 30;         // of one change of rho, or its inverse
inline constexpr double subproblem_tolerance = 0.1;  // of the tolerance: gradient at which a subproblem counts as solved,
inline constexpr double subproblem_reduction = 1e-2;  // or of the primal error before it
inline constexpr double max_damping = 1e-5;          // Levenberg-Marquardt, of the unit diagonal; the least is proximal
inline constexpr double damping_by_gradient = 1e-4;  // damping over the relative gradient
inline constexpr double min_step = 1e-4;             // of the line search
inline constexpr double slow_primal = 0.1;           // reduction of the primal error below which the penalty grows
inline constexpr double penalty_growth = 3;          // of joint_rho
}  // namespace multipliers

inline constexpr Index growth = 2;  // after all methods failed, `first_steps` of the next two namespaces grow by this factor

// admm.cpp
namespace admm {
inline constexpr double newton_reduction = 0.3;  // of the error since the last Newton attempt, before the next
inline constexpr Index first_steps = 10;         // ADMM steps before the interior point method takes over
}  // namespace admm

// newton.cpp
namespace newton {
inline constexpr Index subproblem_steps = 20;  // Newton steps in one augmented Lagrangian subproblem
inline constexpr int admm_steps = 10;          // between subproblems
inline constexpr Index first_steps = 1;        // subproblems before interior points again
}  // namespace newton

// Interior point method (interior_point.hpp, interior.cpp, simulation/interior.cpp).
namespace interior {
inline constexpr double edge = 0.03;              // of sigma / Y_0, from a guess: the correction is rounded off below
inline constexpr double inside = 10;              // of a guess's error: distance of the start from the boundary
inline constexpr Index newton_steps = 10;         // of each Newton attempt on the path
inline constexpr double to_boundary = 0.99;       // of the step length to the boundary (Mehrotra 1992)
inline constexpr Index max_steps = 40;            // bound of one attempt
inline constexpr double regularisation = 1e-10;   // of the unit diagonal: initial impulses of redundant contacts are bounded
inline constexpr double short_step = 0.1;         // step length that counts as short
inline constexpr Index max_short_steps = 3;       // in a row: the path is stuck
// Of this and of the smoothing method: residual over speed below which Newton's method is tried,
inline constexpr double newton_error = 1e-3;
inline constexpr double newton_reduction = 0.1;   // if it fell by this since the last attempt
}  // namespace interior

// Newton's method on the exact law (newton_method.hpp).
namespace newton_method {
inline constexpr double damping_factor = 10;  // of one change of the damping
inline constexpr double progress = 0.9;       // of the residual: a step that reduces it by less ends a good enough solve
inline constexpr Index memory = 12;           // errors of the nonmonotone line search (Grippo, Lampariello and Lucidi 1986: 10)
}  // namespace newton_method

// The same on the whole problem (alart_curnier.cpp).
namespace alart_curnier {
// Levenberg-Marquardt, of the unit diagonal: after a short step, after a failed one
inline constexpr double short_damping = 1e-8, first_damping = 1e-3;
inline constexpr Index max_steps = 20;         // of one attempt without damping
}  // namespace alart_curnier

// Smoothing Newton method (smoothing_method.hpp): measured on heaps, dominoes and jams of 10 to 2,000 rows
namespace smoothing {
inline constexpr double rho = 1;                // of the natural map, over the mean diagonal of a block
inline constexpr double damping = 1e-2;         // of the unit diagonal, against too long steps: at first and at most,
// times so much after a whole step, after a half one, after one that is refused
inline constexpr double less_damping = 0.6, more_damping = 4, refused_damping = 10;
inline constexpr double closeness = 0.3;        // of eps: error of the map, on average, at which eps falls,
inline constexpr double reduction = 0.3, slow_reduction = 0.7;  // to this share of it, else to that,
inline constexpr int steps_each = 6;            // after these Newton steps
inline constexpr int memory = 4;                // errors, of which a whole step stays below the largest
inline constexpr Index max_steps = 80, max_rows = 240;  // of a dense matrix: a step factorizes all rows, without symmetry
inline constexpr double rough_share = 0.4;      // of the iterations left, in a rough solve
// A large island without a solution near: the residual falls by less than this in so many steps, at eps below a share of the first.
inline constexpr double stall_progress = 0.8, stall_eps = 0.05;
inline constexpr int stall_steps = 10;
}  // namespace smoothing

}  // namespace dyn::solver::tuning
