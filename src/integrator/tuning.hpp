// Tuning constants of step control. Errors are in rad, m and their rates.
#pragma once

namespace dyn::integrator::tuning {

// Length of the next step (step_control.hpp; PI control: Gustafsson 1991; Hairer, Norsett, Wanner 1993, II.4).
inline constexpr double safety = 0.9;                 // of the step length that would just meet the accuracy
inline constexpr double error_power = -0.8, history_power = 0.28;  // of this step's and the last's error ratio, over the order
inline constexpr double min_ratio = 1e-4;             // least error ratio that is remembered
inline constexpr double min_factor = 0.2, max_factor = 5;         // of one change,
inline constexpr double max_factor_rows = 2, max_factor_contacts = 3;  // smaller where rows or contacts hide errors
inline constexpr double first_change = 0.01;          // of the time scale of y: probe of the second derivative,
inline constexpr int first_gain = 4;                  // which bounds the first step: by first_change of the accuracy, times this

// Error bars (dyn_data_error_bar): measured on random scenes, bench/error_bars.py
inline constexpr double error_bar = 4;                // of what a run differs by from one that is exact
inline constexpr double rounding_bar = 1e-12;         // of the state, and m or rad: runs that agree may round alike
inline constexpr double lost = 0.1;                   // rad, or of the model's length: error at which no digit is left

// Rounding (step_control.hpp).
inline constexpr int ulps = 4;                        // units in the last place that a step adds to the state
inline constexpr double min_size = 1e-3;              // of the state, for its rounding
inline constexpr int motion_share = 256;              // of the state's rounding: floor of the error of one step
inline constexpr double shortest_step = 1e-13;        // of the duration: shorter ones are refused, or join the last step

inline constexpr int reference_steps = 100000;        // within one step of `reference`: what is too stiff is refused

// Singular configurations (step_control.hpp).
inline constexpr double projection_error = 1e-2;      // of the projection step, counted as error: the Jacobian changed
inline constexpr double retry_lengths[] = {0.85, 0.7, 1.2, 1.4, 1.6};  // of the last ordinary step
inline constexpr double retry_error = 30;             // of the allowed error, in the one step across the singularity
inline constexpr double retry_shrunk = 0.05;          // of the last ordinary step: shorter ones lead into the singularity,
inline constexpr double retry_forced = 100;           // and one across it may have this many times its error
inline constexpr double retry_move = 10;              // of the error: projection that suggests a singularity
inline constexpr int usual_share = 100;               // of the accuracy's share: ordinary change of v by the projection,
inline constexpr double usual_rounding = 2e4;         // or of the rounding

// Budget of errors (advance.hpp).
inline constexpr double growth = 4;                   // by which local errors may grow until the end, as phase errors do
inline constexpr int saved_shares = 3;                // of the error budget that one step may take from earlier ones

// Steps with contacts (advance.hpp, extrapolated.hpp).
inline constexpr double closed_share = 0.1;           // of the accuracy: gaps that count as closed,
inline constexpr double closed_rounding = 256;        // or of the rounding of the state
inline constexpr double deep = 100;                   // of the closed gap: steps that open deeper overlaps
inline constexpr double push_step = 1e-4;             // s, are no shorter
inline constexpr double first_step = 1e-2;            // s, first step with contacts, at accuracy 1 / accuracy_scale
inline constexpr double accuracy_scale = 1e3;         // per unit of accuracy
inline constexpr double smallest_share = 1e-3;        // of accuracy and duration (up to 1 s): shortest step with rows,
inline constexpr double smallest = 10 * shortest_step;  // or of the duration: time still tells such steps apart
inline constexpr double arrival = 0.02;               // of the closed gap: steps to an event end this much behind it
inline constexpr double closed_error = 0.2;           // of the closed gap: error that is allowed while rows act
inline constexpr double solver_share = 1e-3, solver_floor = 1e-14;  // of the closed gap over the speed: tolerance; its rounding

// Steps of dt through rows that last (fixed_step.hpp).
inline constexpr double lasting_gap = 2e-3;           // of g h^2 / 2, what gravity closes in the step: gaps that count as closed
inline constexpr double lasting_error = 0.1;          // of the largest speed: substeps that disagree by more met a jump
inline constexpr double jump_share = 1e-3;            // of the step: the part in which velocities jump, where something meets,
inline constexpr int jump_tries = 2;                  // to find when

// Constraints (constrained_motion.hpp).
inline constexpr double open_rows = 1e-3;             // of the rows' reach (m) or rad: larger errors close first, at order 1
inline constexpr double aligned_rows = 1e-14;         // of their terms: joints move redundant rows by rounding (settled_rows.hpp)
inline constexpr double projection_damping = 1e-9;    // least damping of the projection's Newton step

// Implicit midpoint (implicit_midpoint.hpp).
inline constexpr int midpoint_iterations = 200, midpoint_stalls = 3;  // bound; iterations in a row that do not halve the residual
inline constexpr int midpoint_rounding = 64;          // of the rounding: a stalled residual below it is accepted

}  // namespace dyn::integrator::tuning
