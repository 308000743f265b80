// An interior-point method for Coulomb's law. Y = (mu y_n, y_t) and U lie in the cone |.| <= ._0 and follow Y o U = sigma (1, 0)
// to sigma = 0, with
//   U_0 = c_n / mu - y_t . c_t / Y_0,   U_t = c_t
// De Saxce's correction is |c_t| in place of - y_t . c_t / Y_0. Both agree for stick (c_t = 0) and slip (y_t = - Y_0 c_t /
// |c_t|); this one has no kink at stick, and Y . U = y_n c_n. Steps use Nesterov-Todd scaling and the centring of Mehrotra
// (1992):
//   (B G + W^2 S + N) dy = sigma Y^-1 - U        S = dY/dy,  B = dU/dc,  N = dU/dy,  W^2 Y = U
// The start is the guess, moved inside by its error. Boxes y in [l, u]: z_l (y - l) = sigma, z_u (u - y) = sigma, z_l - z_u = c.
// With a fixed correction s, U_0 = c_n / mu + s: a convex problem (fixed_correction.cpp).
#pragma once

#include "simulation/newton.hpp"

namespace dyn::simulation {

class Interior : public Newton {
 public:
  using Newton::Newton;
  bool run(dynContactReport& report);
  bool run_fixed_correction(dynContactReport& report);

 private:
  bool fixed_correction = false;  // use State::correction
  Index short_steps = 0;
  // U of boxes: z_l; upper: z_u. y_here, c_here: the iterate from which Newton's method is tried
  double *rhs = before + room, *U = before + 6 * room, *upper = U + room, *dU = upper + room, *dupper = dU + room;
  double *y_here = dupper + room, *c_here = y_here + room;

  // Moves the iterate inside the cones by `shift`.
  void start_inside(double shift);
  double complementarity() const;
  void scale_cone(const Block& b, State& s) const;
  bool factorize_barrier();
  void direction_to(double sigma);
  double max_step_to_boundary() const;
  void update_correction();
  // Returns false if the path is stuck.
  bool step(dynContactReport& report);
  bool newton_refine(Index most, dynContactReport& report);
};

}  // namespace dyn::simulation
