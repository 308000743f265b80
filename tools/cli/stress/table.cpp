// The table of the cases.
#include "cases.hpp"

namespace cli::stress {

const std::vector<Case>& cases() {
  static const std::vector<Case> table = {
      {"pendulum", "pendulums", "position at 2000 s, m", "elliptic functions (IFToMM A01)", 1e-9, "845 periods: a phase error of 1e-10 s shows", false, pendulum_2000s},
      {"pendulum-energy", "pendulums", "energy over 2000 s / (m g L)", "conserved", 1e-12, "what drifts would show in 845 periods", false, pendulum_energy},
      {"double-pendulum-10s", "pendulums", "angles and rates at 10 s, rad", "extrapolation in 113 bits", 1e-10, "chaotic: an error grows by 2.4 a second", false,
       double_pendulum_10s},
      {"double-pendulum-20s", "pendulums", "angles and rates at 20 s, rad", "extrapolation in 113 bits", 1e-6, "rounding alone has grown 4e7 times", false,
       double_pendulum_20s},
      {"double-pendulum-energy", "pendulums", "energy over 100 s / (3 m g L)", "conserved", 1e-12, "beyond 34 s no trajectory can be compared, energy can", false,
       double_pendulum_energy},

      {"four-bars", "mechanisms", "place and velocity of B0 at 20 s, m", "elliptic functions (IFToMM A02, N = 40)", 1e-8,
       "20 times the mobility jumps from 1 to 41", false, four_bars_place},
      {"four-bars-angles", "mechanisms", "difference of two uprights' angles, rad", "parallel", 1e-6, "no window may leave its branch where all are flat", false,
       four_bars_angles},
      {"bricard-5-rows", "mechanisms", "P3 at 10 s, m", "closed form of the closure, 113 bits (IFToMM A04)", 1e-6, "rigid by count, and it moves: five closure rows, one redundant", false,
       bricard_five_rows},
      {"bricard-6-rows", "mechanisms", "P3 at 10 s, m", "closed form of the closure, 113 bits (IFToMM A04)", 1e-6, "the same closed by six rows, two of them redundant", false,
       bricard_six_rows},
      {"bricard-energy", "mechanisms", "energy over 10 s / 29.43 J", "conserved", 1e-9, "rods without inertia about their axes", false, bricard_energy},
      {"andrews-squeezer", "mechanisms", "angles at 0.03 s, rad", "extrapolation in 113 bits (IVP test set 3)", 1e-10, "seven bodies, a stiff spring, 1140 rad/s", false,
       andrews_squeezer},

      {"box-simple", "tops", "place and attitude at 10 s, m", "closed form (Peters and Hsu)", 1e-12, "turns about a principal axis", false, box_simple},
      {"box-complex", "tops", "place, attitude, rates at 10 s", "elliptic functions, 113 bits", 1e-9, "tumbles about its middle axis", false, box_complex},
      {"box-1000s", "tops", "attitude and rates at 1000 s", "elliptic functions, 113 bits", 1e-7, "165 periods of tumbling", false, box_1000s},
      {"box-invariants", "tops", "energy and momentum over 1000 s, relative", "conserved", 1e-13, "rotations without drift", false, box_invariants},
      {"box-near-unstable", "tops", "rates at 10 s, x and z by 1e-6", "40 digits", 1e-6, "one flip, whose time a perturbation of 1e-16 moves by 3e-8 s", false,
       box_near_unstable},
      {"heavy-top-0.1s", "tops", "centre of mass and rates at 0.1 s", "extrapolation in 113 bits (Bruels and Cardona)", 1e-10, "150 rad/s", false, heavy_top_100ms},
      {"heavy-top-2s", "tops", "centre of mass and rates at 2 s", "extrapolation in 113 bits (Bruels and Cardona)", 1e-8, "150 rad/s", false, heavy_top_2s},
      {"sleeping-top-above", "tops", "tilt over 10 s, relative", "linear solution", 1e-6, "1 % faster than it needs: the tilt stays within seven times", false,
       sleeping_top_stable},
      {"sleeping-top-below", "tops", "tilt over 3 s, relative", "linear solution", 1e-6, "1 % slower: the tilt grows as it must", false, sleeping_top_unstable},
  };
  return table;
}

}  // namespace cli::stress
