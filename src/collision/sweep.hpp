// When two moving shapes meet: conservative advancement. Between two convex shapes with gap d and normal n no point of one can pass the
// plane before d / mu, where mu bounds how fast they near along n; from there again. Time is never overestimated, however thin a wall is.
// Sources: Mirtich, PhD thesis, Berkeley 1996, 2.3; the bound on turning: Zhang, Lee, Kim, Symp. Solid and Physical Modeling 2006.
#pragma once

#include "collision/distance.hpp"

namespace dyn::collision {

// A shape whose frame moves with constant velocity v (m/s, of its origin) and angular velocity w (rad/s), world axes.
struct Moving {
  shape::Shape shape;
  Pose X;  // at time 0
  Vec v, w;

  Pose at(double t) const;
};

struct Impact {
  enum class Status : Index { None, Hit, Undecided };  // undecided: still apart at `time` after max_steps
  Status status;
  double time;    // s
  Index steps;
  Result result;  // at that time
};

struct SweepOptions {
  double margin = 0;        // m: they meet at this distance
  double tolerance = 1e-7;  // of it, relative to the size of the smaller shape
  Index max_steps = 1000;
};

// In [0, duration]. A half-space must not turn.
Impact sweep(const Moving& a, const Moving& b, double duration, Workspace& workspace, const SweepOptions& options = SweepOptions());

}  // namespace dyn::collision
