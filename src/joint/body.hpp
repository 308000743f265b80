// One moving body of the compiled model. Where its joint is comes first in every recursion and is an array of its own
// (Model::joint_placement): forward kinematics then reads nothing else.
#pragma once

#include "spatial/inertia.hpp"

namespace dyn {

// Primitive joints (joint/list.hpp).
enum class BodyType : Index { Revolute, Prismatic, Helical, RevoluteUnbounded, Spherical, FreeFlyer };

struct Body {
  Vec3<double> h;  // first moment m c in the body's frame, kg m
  Mat3<double> I;  // inertia about the body's origin, kg m^2
  double m;        // mass, kg
  double pitch;    // helical: m/rad
  double ratio;    // follower of a mimic: v = ratio v_leader; otherwise 1
  BodyType type;
  Index parent;        // body index; 0 is the world
  Index idx_q, idx_v;  // in the expanded coordinates (followers have their own)
  Index user_q, user_v;  // in the user's coordinates (a follower's are its leader's)
  Index wraps;         // continuous: differences are wrapped
  Index follower;      // 1: follows a leader
  Index joint;         // the user's joint it belongs to
};

}  // namespace dyn
