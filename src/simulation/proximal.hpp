// Proximal point method (Rockafellar 1976) on an island: it converges from far away and in jams, where Newton's method on the
// exact law fails. A proximal step adds eps (y - y_k) to the velocities c and holds de Saxce's correction mu |c_t| of the normal
// velocities (de Saxce and Feng 1998) at its value before the step. What is left is convex:
//   y = P(y_k - (c + correction) / eps),  c = Y^T z + g,  z = Y y      P: projection onto cones and bounds
// with z the minimum of |z|^2 / 2 + eps / 2 sum |P(y_k - (c + correction) / eps)|^2 (Castro et al. 2022 for eps given by
// compliance), which Newton's method with exact line search finds:
//   (1 + Y K Y^T) dz = Y y - z,  K = P' / eps
// Where proximal steps end, y obeys Coulomb's law. z is held as z = Y a.
#pragma once

#include "simulation/newton.hpp"

namespace dyn::simulation {

class Proximal : Newton {
 public:
  explicit Proximal(const Island& island) : Newton(island) {}
  // Starts from the island's lambda. At most max_steps Newton steps. Sets lambda to the best impulses found, in their cones.
  void run(Index max_steps, dynContactReport& report);

 private:
  double *const center = g + room, *const a = center + room, *const left = a + room, *const da = left + room;
  double eps = tuning::proximal::first_compliance;

  template <int rows>
  double aim(const Block& b, const State& s, double t, double* at) const;
  void set_law(const Block& b, State& s, double compliance, const double* at) const;
  void hold_correction();
  double prepare();
  double step();
  void end_step();
  double slope(double t) const;
  double line_search(double first) const;
};

}  // namespace dyn::simulation
