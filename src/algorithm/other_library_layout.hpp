// One primitive joint's coordinates as other libraries store them. The peer's velocity is v' = B(q) v, so that
// a' = B a + dB/dt v and, by the power tau . v = tau' . v', tau = B^T tau'.
#pragma once

#include <cmath>

#include "base/portable.hpp"
#include "spatial/quaternion.hpp"
#include "spatial/rpy.hpp"
#include "spatial/se3.hpp"

namespace dyn::peer {

enum class Form {
  Same,        // vectors, and quaternions (x, y, z, w) with angular velocities in the body's axes
  CosSin,      // ours: an angle; the peer's: (cos, sin)
  Angle,       // ours: (cos, sin); the peer's: an angle
  Ball,        // the peer's quaternion is (w, x, y, z)
  RollPitchYaw,  // the peer's: R = Rz(y) Ry(p) Rx(r), angular velocity in the axes of what carries the joint
  BodyPlanar,  // ours: (x, y, angle) and its rates; the peer's: (x, y, cos, sin), velocity in the body's axes
  FreeBody,    // the peer's: as ours
  FreeMixed,   // the peer's: quaternion (w, x, y, z); v = [linear in the axes of the world; angular in the body's]
  FreeWorld    // the peer's: (quaternion (w, x, y, z), position); v = [angular; linear] in the axes of the world
};

// A joint's q, v, a and tau, ours or the peer's: at most those of a free flyer.
struct Coordinates {
  double q[7], v[6], a[6], tau[6];
};

struct Size {
  int nq, nv;
};
inline Size size(Form form, Size ours) {
  switch (form) {
    case Form::CosSin: return {2, 1};
    case Form::Angle: return {1, 1};
    case Form::RollPitchYaw: return {3, 3};
    case Form::BodyPlanar: return {4, 3};
    default: return ours;
  }
}

// Where a free flyer starts (in the world), and the frame on its body that the peer's pose and velocity are of.
struct Ends {
  SE3<double> start, frame;
  bool trivial;  // both are the identity
};

inline void pack(const Quaternion<double>& a, double* wxyz) { wxyz[0] = a.w, store3(a.v, wxyz + 1); }
inline Quaternion<double> unpack(const double* wxyz) { return {load3(wxyz + 1), wxyz[0]}; }

// The rates of a vector whose components are given in axes that turn: u = R v, du/dt = R (a + w x v).
inline Vec3<double> rate(const Vec3<double>& w, const Vec3<double>& v, const Vec3<double>& a) { return a + cross(w, v); }
inline Vec3<double> rate_inverse(const Vec3<double>& w, const Vec3<double>& v, const Vec3<double>& du) {
  return du - cross(w, v);
}

// --------------------------------------------------------------------------------------------- free flyers

struct Pose {
  Vec3<double> p;
  Quaternion<double> e;
  SE3<double> X() const { return {rotation(e), p}; }
};
inline Pose pose_of(const SE3<double>& X) { return {X.p, quaternion(X.R)}; }

inline void free_to_peer(Form form, const Ends& ends, const Coordinates& x, Coordinates& y) {
  Pose pose = {load3(x.q), load_quaternion(x.q + 3)};
  if (!ends.trivial) pose = pose_of(ends.start * pose.X() * ends.frame);
  const Mat3<double> R = rotation(pose.e);
  const Motion<double> v = ends.frame.act_inverse(load_motion(x.v)), a = ends.frame.act_inverse(load_motion(x.a));
  const Force<double> f = ends.frame.act_inverse(load_force(x.tau));
  const Vec3<double> a_world = R * rate(v.angular, v.linear, a.linear);
  switch (form) {
    case Form::FreeMixed:
      store3(pose.p, y.q), pack(pose.e, y.q + 3);
      store3(R * v.linear, y.v), store3(v.angular, y.v + 3);
      store3(a_world, y.a), store3(a.angular, y.a + 3);
      store3(R * f.linear, y.tau), store3(f.angular, y.tau + 3);
      break;
    case Form::FreeWorld:
      pack(pose.e, y.q), store3(pose.p, y.q + 4);
      store3(R * v.angular, y.v), store3(R * v.linear, y.v + 3);
      store3(R * a.angular, y.a), store3(a_world, y.a + 3);
      store3(R * f.angular, y.tau), store3(R * f.linear, y.tau + 3);
      break;
    default:
      store3(pose.p, y.q), store(pose.e, y.q + 3);
      store6(v, y.v), store6(a, y.a), store6(f, y.tau);
  }
}

inline void free_from_peer(Form form, const Ends& ends, const Coordinates& y, Coordinates& x) {
  Pose pose;
  if (form == Form::FreeWorld) pose = {load3(y.q + 4), unpack(y.q)};
  else pose = {load3(y.q), form == Form::FreeMixed ? unpack(y.q + 3) : load_quaternion(y.q + 3)};
  const Mat3<double> Rt = transpose(rotation(pose.e));
  Motion<double> v, a;
  Force<double> f;
  switch (form) {
    case Form::FreeMixed:
      v = {Rt * load3(y.v), load3(y.v + 3)};
      a = {rate_inverse(v.angular, v.linear, Rt * load3(y.a)), load3(y.a + 3)};
      f = {Rt * load3(y.tau), load3(y.tau + 3)};
      break;
    case Form::FreeWorld:
      v = {Rt * load3(y.v + 3), Rt * load3(y.v)};
      a = {rate_inverse(v.angular, v.linear, Rt * load3(y.a + 3)), Rt * load3(y.a)};
      f = {Rt * load3(y.tau + 3), Rt * load3(y.tau)};
      break;
    default: v = load_motion(y.v), a = load_motion(y.a), f = load_force(y.tau);
  }
  if (!ends.trivial) pose = pose_of(ends.start.inverse() * pose.X() * ends.frame.inverse());
  store3(pose.p, x.q), store(pose.e, x.q + 3);
  store6(ends.frame.act(v), x.v), store6(ends.frame.act(a), x.a), store6(ends.frame.act(f), x.tau);
}

// --------------------------------------------------------------------------------------------- planar, spherical

// The components of u in axes turned by the angle of (c, s), and back.
inline Vec3<double> turned(double c, double s, const Vec3<double>& u) {
  return Vec3<double>::make(c * u[0] + s * u[1], c * u[1] - s * u[0], u[2]);
}

inline void planar_to_peer(const Coordinates& x, Coordinates& y) {
  const double c = math::cos(x.q[2]), s = math::sin(x.q[2]);
  y.q[0] = x.q[0], y.q[1] = x.q[1], y.q[2] = c, y.q[3] = s;
  const Vec3<double> v = turned(c, s, load3(x.v)), w = Vec3<double>::make(0, 0, x.v[2]);
  store3(v, y.v), store3(rate_inverse(w, v, turned(c, s, load3(x.a))), y.a), store3(turned(c, s, load3(x.tau)), y.tau);
}
inline void planar_from_peer(const Coordinates& y, Coordinates& x) {
  const double n = math::hypot(y.q[2], y.q[3]), c = y.q[2] / n, s = y.q[3] / n;
  x.q[0] = y.q[0], x.q[1] = y.q[1], x.q[2] = math::atan2(y.q[3], y.q[2]);
  const Vec3<double> v = load3(y.v), w = Vec3<double>::make(0, 0, y.v[2]);
  store3(turned(c, -s, v), x.v), store3(turned(c, -s, rate(w, v, load3(y.a))), x.a), store3(turned(c, -s, load3(y.tau)), x.tau);
}

inline void ball_to_rpy(const Coordinates& x, Coordinates& y) {
  const Mat3<double> R = rotation(load_quaternion(x.q));
  store3(roll_pitch_yaw(R), y.q);
  store3(R * load3(x.v), y.v), store3(R * load3(x.a), y.a), store3(R * load3(x.tau), y.tau);
}
inline void ball_from_rpy(const Coordinates& y, Coordinates& x) {
  auto about = [](int axis, double angle) {
    const double s = math::sin(angle / 2);
    return Quaternion<double>{Vec3<double>::make(axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0), math::cos(angle / 2)};
  };
  const Quaternion<double> e = about(2, y.q[2]) * about(1, y.q[1]) * about(0, y.q[0]);
  const Mat3<double> Rt = transpose(rotation(e));
  store(e, x.q);
  store3(Rt * load3(y.v), x.v), store3(Rt * load3(y.a), x.a), store3(Rt * load3(y.tau), x.tau);
}

// --------------------------------------------------------------------------------------------- all forms

inline void to_peer(Form form, const Ends& ends, const Coordinates& x, Coordinates& y) {
  switch (form) {
    case Form::FreeBody: case Form::FreeMixed: case Form::FreeWorld: return free_to_peer(form, ends, x, y);
    case Form::BodyPlanar: return planar_to_peer(x, y);
    case Form::RollPitchYaw: return ball_to_rpy(x, y);
    default: y = x;
  }
  if (form == Form::CosSin) y.q[0] = math::cos(x.q[0]), y.q[1] = math::sin(x.q[0]);
  if (form == Form::Angle) y.q[0] = math::atan2(x.q[1], x.q[0]);
  if (form == Form::Ball) pack(load_quaternion(x.q), y.q);
}

inline void from_peer(Form form, const Ends& ends, const Coordinates& y, Coordinates& x) {
  switch (form) {
    case Form::FreeBody: case Form::FreeMixed: case Form::FreeWorld: return free_from_peer(form, ends, y, x);
    case Form::BodyPlanar: return planar_from_peer(y, x);
    case Form::RollPitchYaw: return ball_from_rpy(y, x);
    default: x = y;
  }
  if (form == Form::CosSin) x.q[0] = math::atan2(y.q[1], y.q[0]);
  if (form == Form::Angle) x.q[0] = math::cos(y.q[0]), x.q[1] = math::sin(y.q[0]);
  if (form == Form::Ball) store(unpack(y.q), x.q);
}

// Whether the peer's q has a quaternion or (cos, sin) of norm zero.
inline bool zero_norm(Form form, Size ours, const double* q) {
  auto zero = [&](int first, int n) {
    for (int k = first; k < first + n; ++k)
      if (q[k] != 0) return false;
    return true;
  };
  switch (form) {
    case Form::CosSin: return zero(0, 2);
    case Form::BodyPlanar: return zero(2, 2);
    case Form::FreeWorld: case Form::Ball: return zero(0, 4);
    case Form::FreeBody: case Form::FreeMixed: return zero(3, 4);
    case Form::Same: return ours.nq > ours.nv && zero(0, ours.nq);  // (cos, sin) and quaternions
    default: return false;
  }
}

}  // namespace dyn::peer
