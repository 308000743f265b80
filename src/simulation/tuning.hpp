// Tuning constants of steps with contacts. "Radius" is that of the smaller shape's bounding sphere,
// "length" the model's length scale.
#pragma once

#include <limits>

#include "base/types.hpp"

namespace dyn::simulation::tuning {

// Limits and contacts that become rows (step.hpp, find_constraints.cpp).
inline constexpr double slop = 1e-9;           // of the length, or rad: errors and motion below are rounding
inline constexpr double limit_margin = 1e-4;   // of the length, or rad: limits nearer than this are always rows
inline constexpr double speed_growth = 3;      // a joint may end a step this much faster than its free velocity, by impulses
inline constexpr double slow_fall = 0.32;      // of sqrt(g length): speed after a fall over length / 20, sqrt(2 / 20)
inline constexpr double slow_shift = 1e-3;     // of the length per step: slower motion is not resolved by the step
inline constexpr double max_displacement = 0.1;  // of the length, or rad: no correction moves a coordinate further in a step
inline constexpr double reopen_factor = 3;     // of closed_gap: gap at which active contacts open again
inline constexpr double free_closing = 10;     // of the island's largest rate: bound on the closing speed of open gaps

// Contact search (contact_points.cpp).
namespace search {
inline constexpr double near = 0.02;            // of the radius: nearer shapes are always tested
inline constexpr double speed_margin = 1.5;     // of the motion in the step: impulses may speed shapes up
inline constexpr double same_normal = 0.9;      // cosine: below it the contact turned within the step
inline constexpr double graze = 0.05;           // of the relative motion in the step: deeper overlap at its end is a hit
inline constexpr Index sweep_steps = 50;        // bound of conservative advancement; beyond it the pair counts as met
inline constexpr double same_place = near;      // of the radius: a point whose features change keeps the force of one as near
inline constexpr double touching = 1e-4;        // of the radius: smaller gaps count as touching
inline constexpr double min_pass = 0.2;         // of the radius: least motion in which shapes pass each other
}  // namespace search

// Contacts that need no impulse (contact_rows.cpp).
namespace idle {
inline constexpr double closing = 1e-12;        // of the radius per step: what tolerances leave of earlier impulses
inline constexpr double fall = 1e-6;            // of g h^2: far below what gravity closes in a step
}  // namespace idle

// Conservative advancement cache (conservative_advancement.cpp).
namespace advancement {
inline constexpr double min_steps_saved = 4;    // the search must save this many steps to be worth its levers
}  // namespace advancement

// Contacts whose normal nothing moves (contact_rows.cpp).
inline constexpr double immovable_normal = 1e-16;  // of the largest translation's own G: less is rounding

// Batched free bodies (free_bodies.cpp).
// least squared norm of quaternions whose products keep all digits: those of smaller ones underflow, of 1 / min_norm2 overflow
inline constexpr double min_norm2 = std::numeric_limits<double>::min();

// Islands (island.cpp, solve_constraints.cpp, workspace.hpp).
namespace island {
inline constexpr double impact_speed = 0.05;    // of slow_speed: a faster approach rebounds however long the step
inline constexpr double correction = 0.5;       // of the position error that a step removes
// of a row's own G: bounds displacements of contradictory rows; and of the displacement, the solver's tolerance
inline constexpr double correction_softness = 1e-6;
// of the constraint's largest G, where equalities are further off than a step corrects, perhaps out of reach: mechanisms settle
// where they are nearest
inline constexpr double far_softness = 1e-2;
inline constexpr Index dense_rows = 240;        // rows of the largest dense Delassus matrix (460 kB)
inline constexpr int relaxed_every = 64;        // steps of dt: the smallest impulses cost a Newton step
inline constexpr int rounds = 3;                // of method_iterations for all methods together; once more for fixed corrections
inline constexpr double tolerance = 1e-4, fine = 1e-9;  // default of the residual: in steps of dt; with an accuracy, at impacts
inline constexpr Index exact_rows = 24;         // islands up to these rows are solved to the fine residual by default
inline constexpr double standing = 0.01;        // of the residual as a speed: slower bodies stand while their impulses do not fit
inline constexpr double gain = 0.1;             // of the residual, that ends the solve then
inline constexpr double slack = 0.05;           // of g h^2, what gravity closes in a step: gap that pressed contacts keep
inline constexpr Index iterations = 100, methods = 12, fine_iterations = iterations * methods;  // default of max_iterations
}  // namespace island

// Room of a step's arrays (workspace.hpp). What exceeds it is solved by other methods, or made anew where it is read.
namespace capacity {
inline constexpr Index more_contact_rows = 24;   // beside three a contact
inline constexpr Index dense_rows = 40;          // of the dense matrix, at least: for each body that flies
inline constexpr Index few = 42;                 // constraints of a small model
inline constexpr Index least_columns = 256, own_columns = 12;  // of propagated rows: in small models; of a constraint beyond few
inline constexpr Index short_support = 18, wide_rows = 64;     // rows on all degrees of freedom beyond short_support
inline constexpr Index cones = 16;               // in small models
inline constexpr Index row_lanes_of_runs = 8;    // of a constraint, rows by segments
inline constexpr Index least_row_lanes = 240;    // the same of small models
inline constexpr Index entries = 240;            // blocks of the Newton matrix that small models do not have
}  // namespace capacity

// Sweeps (sweeps.cpp, exact_solve.cpp).
namespace sweeps {
inline constexpr double progress = 0.8;         // of the change, from check to check: more is no progress
inline constexpr int depth = 5;                 // sweeps that Anderson's acceleration combines
inline constexpr double growth = 2;             // of a sweep's change over the last: above it the combination starts anew
inline constexpr int guess_sweeps = 4;          // over a nearly good guess: cheaper than a matrix
inline constexpr Index first_sweeps = 5, max_small = 10;  // before Newton; small islands have a matrix after max_small
inline constexpr int correction_sweeps = 20;    // bound for position corrections
inline constexpr double correction_change = 0.02;  // of the first sweep's change: the next steps correct the rest
// Rows that contradict each other push ever further: the change of the last sweep is at least this share of the first one, and of
// the one before. They then give way by a share of their own G.
inline constexpr double contradictory_progress = 0.99;
inline constexpr double contradictory_softness = 0.1;
}  // namespace sweeps

// The solve by default (default_solve.cpp).
namespace default_solve {
inline constexpr double near_guess = 0.02;      // residual of the guess up to which large islands try Newton's method first
inline constexpr Index small_steps = 8, large_steps = 4;  // of Newton's method, in small islands and in large ones
inline constexpr Index fine_steps = 2;          // after the smoothing method, which is followed where guesses are far
inline constexpr Index few_sweeps = 10, smoothing_steps = 50;  // sweeps where other methods follow
inline constexpr Index small_rows = 64;         // up to which the dense matrix is tried last: beyond, it takes a millisecond
}  // namespace default_solve

// Elimination order (elimination.hpp).
namespace elimination {
inline constexpr Index entries_a_segment = 16;  // room for fill-in; islands that need more use other methods
inline constexpr Index runs_a_constraint = 8;   // room for segments of a constraint, on average
}  // namespace elimination

// Newton's method on segments (newton.cpp).
namespace newton {
inline constexpr double min_compliance = 1e-6;  // of the unit diagonal: steps are unique for redundant contacts
inline constexpr double damping = 1e-2;         // of the unit diagonal: Levenberg-Marquardt, after a step that failed
inline constexpr int refinements = 1;           // iterative refinements of a step, which remove the effect of min_compliance
inline constexpr double sliding = 0.1;          // contacts that slide, over those that stick: beyond, steps from afar are damped
inline constexpr int relaxations = 3;           // tries to find which contacts press in the smallest impulses
inline constexpr double jammed = 100;           // of the impulses that stop all motion: larger ones are stress locked by friction
inline constexpr double above_guess = 1.1;      // of the guess's impulses: heavy bodies press through light ones
inline constexpr Index max_steps = 15;          // of one attempt
inline constexpr double block_price = 4000;     // of a segment, in dense rows^3: measured
}  // namespace newton

// Springs (semi_implicit_euler.hpp).
inline constexpr double stiff_spring = 0.25;    // h^2 k over the inertia, half a radian a step; explicit steps need less than 4

// Energy guard (energy_guard.hpp).
namespace guard {
inline constexpr double motion = 0.1;           // rad, or of the length, in a step: slower motion gains little by explicit terms
inline constexpr double turn = 2.1;             // rad in a step, a third of a turn: slower free bodies do not gain energy
inline constexpr double usual_ratio = 1e4;      // of the mass beyond a joint over its link's: larger ones lower `motion`
inline constexpr double share = 0.02;           // of the kinetic energy that a step may gain: order 1 errs by about motion^2
inline constexpr double high_order_share = 1e-3;  // the same by methods of order 2 and more: beyond, an oscillation is unresolved
inline constexpr double part_share = 0.1;       // the same of all parts so far, and of the finest parts
// Of the kinetic energy, in all steps so far: above `growth` steps are made in parts, and it fades by this factor in each;
// above the other they are refused.
inline constexpr double growth = 0.15, fading = 0.99, most_growth = 0.3;
inline constexpr double rounding = 1e-9;        // of the potential energy
inline constexpr int halvings = 5;              // of a step that gained energy
inline constexpr double amplification = 1.01;   // of oscillations in an explicit step: above it the method is unstable
}  // namespace guard

// Derivatives of a step (step_derivatives.hpp).
namespace derivatives {
inline constexpr double tolerance = 1e-12;   // of the solve in the step that is differentiated
inline constexpr double still = 1e-9;        // m/s: slower contacts do not slide
inline constexpr double independent = 1e-9;  // pivot of the scaled rows: smaller ones are redundant
inline constexpr double consistent = 1e-6;   // of the largest: what is equal but for the rounding of such a solve
inline constexpr double drift = 1e-5;        // m, rad: larger errors of equalities are corrected in ways that are not covered
}  // namespace derivatives

// Sleep (sleep.cpp).
inline constexpr double same_force = 1e-6;  // of the largest on the island: difference of forces of one problem solved twice

}  // namespace dyn::simulation::tuning
