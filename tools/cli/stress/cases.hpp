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

}  // namespace cli::stress
