// The functions of the table, by theme.
#pragma once

#include "case.hpp"

namespace cli::stress {

// pendulums.cpp
Outcome pendulum_2000s();
Outcome pendulum_energy();
Outcome double_pendulum_10s();
Outcome double_pendulum_20s();
Outcome double_pendulum_energy();
// mechanisms.cpp
Outcome four_bars_place();
Outcome four_bars_angles();
Outcome bricard_five_rows();
Outcome bricard_six_rows();
Outcome bricard_energy();
Outcome andrews_squeezer();
// tops.cpp
Outcome box_simple();
Outcome box_complex();
Outcome box_1000s();
Outcome box_invariants();
Outcome box_near_unstable();
Outcome heavy_top_100ms();
Outcome heavy_top_2s();
Outcome sleeping_top_stable();
Outcome sleeping_top_unstable();

// rows.cpp
Outcome duplicate_rows();
Outcome four_bar_in_space();
Outcome contradictory_rows();
Outcome slider_crank();
// chains.cpp
Outcome chain_condition();
Outcome chain_round_trip();
Outcome chain_factor();
Outcome heavy_tip();
// stacks.cpp
Outcome stack_penetration();
Outcome stack_residual();
Outcome stack_iterations();
Outcome stack_forces();
Outcome table_sums();
Outcome table_least_forces();
// friction.cpp
Outcome incline_sticks();
Outcome incline_slides();
Outcome sphere_rolls();
Outcome sphere_final_speed();
Outcome block_stops();
Outcome isotropy();
Outcome drag();
Outcome painleve();
Outcome cards();
// impacts.cpp
Outcome zeno();
Outcome zeno_energy();
Outcome cradle();
Outcome euler_disk();
Outcome rolling_disc_above();
Outcome rolling_disc_below();
// representation.cpp
Outcome rotations_round_trip();
Outcome rotations_values();
Outcome gimbal();
Outcome quaternion_sign();
Outcome quaternion_norm();
Outcome quaternion_norm_long();
Outcome inertias();
Outcome units_pendulum();
Outcome units_mechanism();
Outcome units_contact();
// collision.cpp
Outcome fcl_poses();
Outcome kissing_cubes();
Outcome touching_cubes();

}  // namespace cli::stress
