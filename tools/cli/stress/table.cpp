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
      {"governor-0.1s", "mechanisms", "height of the slider at 0.1 s, m", "extrapolation in 113 bits (IFToMM A05)", 1e-9, "dampers of 2.7e4 1/s", false, governor_100ms},
      {"governor", "mechanisms", "height of the slider at 1 s, m", "extrapolation in 113 bits (IFToMM A05)", 1e-9, "dampers of 2.7e4 1/s", false, governor_reference},
      {"governor-5s", "mechanisms", "height of the slider at 5 s, m", "extrapolation in 113 bits (IFToMM A05)", 1e-9, "dampers of 2.7e4 1/s", true, governor_5s},
      {"governor-rk4", "mechanisms", "height at 1 s in steps of 0.1 ms, m", "extrapolation in 113 bits (IFToMM A05)", 1e-6, "dampers of 2.7e4 1/s", false, governor_rk4},
      {"governor-1ms", "mechanisms", "height at 1 s in steps of 1 ms, m", "extrapolation in 113 bits (IFToMM A05)", 1e-3, "a step of 27 time constants", false, governor_implicit},

      {"box-simple", "tops", "place and attitude at 10 s, m", "closed form (Peters and Hsu)", 1e-12, "turns about a principal axis", false, box_simple},
      {"box-complex", "tops", "place, attitude, rates at 10 s", "elliptic functions, 113 bits", 1e-9, "tumbles about its middle axis", false, box_complex},
      {"box-1000s", "tops", "attitude and rates at 1000 s", "elliptic functions, 113 bits", 1e-6, "165 periods of tumbling", false, box_1000s},
      {"box-invariants", "tops", "energy and momentum over 1000 s, relative", "conserved", 1e-13, "rotations without drift", false, box_invariants},
      {"box-near-unstable", "tops", "time when it turns over, s", "quarter of a period, elliptic functions", 1e-5, "a perturbation of 1e-16 rad/s moves it by 3e-8 s", false,
       box_near_unstable},
      {"heavy-top-0.1s", "tops", "centre of mass and rates at 0.1 s", "extrapolation in 113 bits (Bruels and Cardona)", 1e-10, "150 rad/s", false, heavy_top_100ms},
      {"heavy-top-2s", "tops", "centre of mass and rates at 2 s", "extrapolation in 113 bits (Bruels and Cardona)", 1e-8, "150 rad/s", false, heavy_top_2s},
      {"sleeping-top-above", "tops", "tilt over 10 s, relative", "linear solution", 1e-6, "1 % faster than it needs: the tilt stays within seven times", false,
       sleeping_top_stable},
      {"sleeping-top-below", "tops", "tilt over 3 s, relative", "linear solution", 1e-6, "1 % slower: the tilt grows as it must", false, sleeping_top_unstable},

      {"duplicate-rows", "rows", "accelerations and joint forces, relative", "the rows given once", 1e-10, "a loop closed once, twice and ten times", false, duplicate_rows},
      {"four-bar-in-space", "rows", "accelerations of three free bodies", "the same as a tree", 1e-9, "20 rows of rank 17", false, four_bar_in_space},
      {"contradictory-rows", "rows", "place of the rod, m", "least squares", 1e-9, "1 m between points 1.001 m apart", false, contradictory_rows},
      {"slider-crank", "rows", "slider off 2 cos(crank), m; energy", "closed form", 1e-6, "passes where it may stand still, four times", false, slider_crank},

      {"chain-condition", "chains", "cond(M), relative", "symmetric eigenvalues", 1e-3, "grows with the fourth power of the links", false, chain_condition},
      {"chain-round-trip", "chains", "|ID(FD(tau)) - tau| / (eps cond M)", "0", 50, "8 to 1000 links, straight, at random, coiled", false, chain_round_trip},
      {"chain-factor", "chains", "articulated bodies - factor of M, relative / (eps cond M)", "0", 50, "8 to 1000 links, straight, at random, coiled", false, chain_factor},
      {"heavy-tip", "chains", "both / (eps cond M)", "0", 50, "10 and 20 links, the last up to 1e6 times as heavy", false, heavy_tip},

      {"stack-penetration", "stacks", "depth, m", "rigid", 1e-6, "up to 1e6 times the mass on top", false, stack_penetration},
      {"stack-residual", "stacks", "residual of the contact problem", "0", 1e-6, "up to 1e6 times the mass on top", false, stack_residual},
      {"stack-iterations", "stacks", "iterations of the solver in a step", "", 100, "Gauss-Seidel would take 1.4e7", false, stack_iterations},
      {"stack-forces", "stacks", "forces between boxes, relative", "weight above", 1e-6, "up to 1e6 times the mass on top", false, stack_forces},
      {"table-sums", "stacks", "sum and moments of forces / W", "statics", 1e-9, "four legs: forces are not unique, their sums are", false, table_sums},

      {"incline-sticks", "friction", "speed, m/s", "at rest", 1e-9, "up to 99.9 % of the friction angle", false, incline_sticks},
      {"incline-slides", "friction", "speed at 3 s, m/s", "g (sin - mu cos) t", 1e-9, "from 100.1 % of the friction angle on", false, incline_slides},
      {"sphere-rolls", "friction", "place at 0.5 s, m", "closed form", 3e-6, "from slipping to rolling, steps for an accuracy of 1e-6", false, sphere_rolls},
      {"sphere-final-speed", "friction", "speed, m/s", "5/7", 1e-9, "from slipping to rolling", false, sphere_final_speed},
      {"block-stops", "friction", "place, m", "v^2 / (2 mu g)", 3e-6, "from sliding to rest, steps for an accuracy of 1e-6", false, block_stops},
      {"isotropy", "friction", "distance and direction, relative", "closed form", 1e-8, "64 directions: the cone is round", false, isotropy},
      {"drag", "friction", "speed at 1 s, m/s", "closed form (Le Lidec et al. 2024)", 1e-3, "a growing force: stick, then slip", false, drag},
      {"painleve", "friction", "residual of the contact problem", "0", 1e-8, "1002 states for which rigid bodies have no acceleration or two", false, painleve},
      {"cards", "friction", "sunk in 3 s, m (those that must fall do)", "mu = tan(phi) / 2", 1e-6, "three angles, mu 0.1 % above and below what they need", false, cards},
      {"overhang", "blocks", "top moved in 3 s, m (it falls where it must)", "sum of 1 / (2 k)", 1e-6, "ten blocks over an edge, 0.1 % less and more than they can", false, overhang},
      {"arch-stands", "blocks", "crown sunk in 10 s, m", "limit analysis: t/R = 0.10746", 1e-4, "20 voussoirs, t/R = 0.110", false, arch_stands},
      {"arch-falls", "blocks", "it falls", "limit analysis: t/R = 0.10746", 0, "20 voussoirs, t/R = 0.104", true, arch_falls},

      {"zeno", "impacts", "time of rest, in steps of 1 ms", "sqrt(2 h / g) (1 + e) / (1 - e)", 1, "bounces without number in a finite time", false, zeno},
      {"zeno-energy", "impacts", "growth of the energy / m g h", "0", 1e-9, "no bounce adds any", false, zeno_energy},
      {"elastic-balls", "impacts", "energy and heights over 20 s, relative", "parabolas (Kang and Hwangbo)", 5.7e-6, "49 balls, 10 bounces each; the best published energy in steps of 1 ms", false,
       elastic_balls},
      {"cradle", "impacts", "velocities, m/s", "Moreau's law: -1/3, 2/3, 2/3", 1e-14, "all impacts at once", false, cradle},
      {"euler-disk", "impacts", "change of 30 deg over 100 turns, rad", "steady", 1e-6, "rolls on its rim, its centre at rest", true, euler_disk},
      {"rolling-disc-above", "impacts", "largest lean, relative", "linear solution", 0.05, "10 % faster than sqrt(g a / 3)", false, rolling_disc_above},
      {"rolling-disc-below", "impacts", "it falls", "unstable", 0, "10 % slower than sqrt(g a / 3)", false, rolling_disc_below},

      {"rotations-round-trip", "representation", "log(exp(v)) - v, ulp", "v", 4, "angles from 1e-300 to pi - 1e-15", false, rotations_round_trip},
      {"rotations-values", "representation", "quaternions, ulp", "40 digits", 4, "1e-160 and pi - 1e-15", false, rotations_values},
      {"gimbal", "representation", "|ID(FD(tau)) - tau| / (eps |ddq|), or refused", "0", 50, "an axis lost", false, gimbal},
      {"quaternion-sign", "representation", "difference of forces", "0", 0, "q and -q are one attitude", false, quaternion_sign},
      {"quaternion-norm", "representation", "| |q| - 1 |, 1e5 steps", "0", 4e-16, "rounding must not add up", false, quaternion_norm},
      {"quaternion-norm-long", "representation", "| |q| - 1 |, 1e7 steps", "0", 1e-15, "rounding must not add up", true, quaternion_norm_long},
      {"inertias", "representation", "wrong answers", "0", 0, "bodies that cannot be are refused by name", false, inertias},
      {"units-pendulum", "representation", "angles", "in metres", 1e-12, "lengths by 1e6, masses by 1e9, times by 1e3 either way", false, units_pendulum},
      {"units-mechanism", "representation", "angles", "in metres", 1e-12, "lengths by 1e6, masses by 1e9, times by 1e3 either way", false, units_mechanism},
      {"units-contact", "representation", "places / length", "in metres", 1e-12, "lengths by 1e6, masses by 1e9, times by 1e3 either way", false, units_contact},
      {"units-contact-exact", "representation", "places / length", "in metres", 0, "the same to rest, by powers of two: bit for bit", false, units_contact_exact},
      {"units-contact-to-rest", "representation", "places / length", "in metres", 1e-12, "the same for 500 steps instead of 100", true, units_contact_to_rest},

      {"fcl-poses", "collision", "worst / allowed", "tests of FCL", 1, "poses that threw or hung elsewhere", false, fcl_poses},
      {"kissing-cubes", "collision", "worst / allowed", "FCL 493", 1, "35 cubes that touch to rounding, 0.01 to 1000 m", false, kissing_cubes},
      {"touching-cubes", "collision", "worst / allowed", "closed forms (libccd 25, 49, 55)", 1, "faces, edges, corners, one in another", false, touching_cubes},
  };
  return table;
}

}  // namespace cli::stress
