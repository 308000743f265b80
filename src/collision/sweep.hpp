// Time of impact by conservative advancement. Let d be the gap of two convex shapes, n the normal, mu a bound of their approach
// speed along n. No point can pass the plane before d / mu, so time advances by that. It is never overestimated, however thin a
// wall is. Sources: Mirtich, PhD thesis, Berkeley 1996, 2.3; bound on rotation: Zhang, Lee, Kim, Symp. Solid and Physical
// Modeling 2006.
#pragma once

#include "collision/distance.hpp"

namespace dyn::collision {

// A shape with constant velocity v of its frame's origin (m/s) and angular velocity w (rad/s), world axes.
struct Moving {
  shape::Shape shape;
  Pose X;  // at time 0
  Vec v, w;

  Pose at(double t) const;
};

struct Impact {
  enum class Status : Index { None, Hit, Undecided };  // Undecided: still apart after max_steps
  Status status;
  double time;    // s
  Index steps;
  Result result;  // at that time
};

struct SweepOptions {
  double margin = 0;        // m: distance that counts as contact
  double tolerance = 1e-7;  // of the margin, relative to the size of the smaller shape
  Index max_steps = 1000;
};

// Searches [0, duration]. A half-space must not turn.
Impact sweep(const Moving& a, const Moving& b, double duration, Workspace& workspace,
             const SweepOptions& options = SweepOptions());

}  // namespace dyn::collision
