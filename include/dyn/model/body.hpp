// One moving body of the compiled model: everything that the recursions read of it, in one run of memory.
#pragma once

#include "dyn/spatial/inertia.hpp"

namespace dyn {

// Primitive joints (joint/list.hpp).
enum class BodyType : Index { Revolute, Prismatic, Helical, RevoluteUnbounded, Spherical, FreeFlyer };

struct Body {
  Mat3<double> F;  // joint frame at q = 0 in the parent body's frame: axes
  Vec3<double> r;  //   and origin
  Vec3<double> h;  // first moment m c in the body's frame, kg m
  Mat3<double> I;  // inertia about the body's origin, kg m^2
  Mat3<double> P;  // tr(I) 1 / 2 - I, the integral of x x^T dm
  double m;        // mass, kg
  double pitch;    // helical: m/rad
  double ratio, offset;  // follower of a mimic: q = ratio q_leader + offset; otherwise 1 and 0
  BodyType type;
  Index parent;        // body index; 0 is the world
  Index idx_q, idx_v;  // in the expanded coordinates (followers have their own)
  Index user_q, user_v;  // in the user's coordinates (a follower's are its leader's)
  Index angle;         // index of its angle in the sweep, or -1
  Index wraps;         // continuous: differences are wrapped
  Index follower;      // 1: follows a leader
  Index joint;         // the user's joint it belongs to
};

}  // namespace dyn
