#include "chain.hpp"

#include <array>
#include <cmath>

namespace cli::page {

namespace {

using Placement = std::array<double, 12>;  // rotation by columns, then translation
using Vec3 = std::array<double, 3>;

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// a^-1 b
Placement between(const Placement& a, const Placement& b) {
  Placement out;
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t i = 0; i < 3; ++i) {
      out[3 * j + i] = 0;
      for (std::size_t k = 0; k < 3; ++k) out[3 * j + i] += a[3 * i + k] * (b[3 * j + k] - (j == 3 ? a[9 + k] : 0));
    }
  return out;
}

// The twist [linear; angular] whose exponential this is; its angle below pi (Murray, Li, Sastry 1994, A.2).
Vector logarithm(const Placement& X) {
  const Vec3 p = {X[9], X[10], X[11]}, w = {(X[5] - X[7]) / 2, (X[6] - X[2]) / 2, (X[1] - X[3]) / 2};
  const double sine = std::hypot(w[0], w[1], w[2]), angle = std::atan2(sine, (X[0] + X[4] + X[8] - 1) / 2);
  if (angle < 1e-9) return {p[0], p[1], p[2], 0, 0, 0};
  const Vec3 axis = {w[0] / sine, w[1] / sine, w[2] / sine}, once = cross(axis, p), twice = cross(axis, once);
  const double half = angle / 2;
  Vector out(6);
  for (std::size_t i = 0; i < 3; ++i)
    out[i] = p[i] - half * once[i] + (1 - half / std::tan(half)) * twice[i], out[3 + i] = angle * axis[i];
  return out;
}

}  // namespace

json chain_json(const Robot& robot, const dynJointInfo& joint) {
  const Data data(robot, DYN_PART_KINEMATICS);
  const auto world = [&](int id) {
    Placement X;
    check(dyn_frame_placement(robot, data, dyn_model_frame_id_of_type(robot, robot.joint(id).name, DYN_FRAME_TYPE_JOINT),
                              X.data()));
    return X;
  };
  const int id = dyn_model_joint_id(robot, joint.name);
  const auto from_parent = [&](const Vector& q) {
    check(dyn_forward_kinematics(robot, data, q.data(), nullptr, nullptr));
    return joint.parent ? between(world(joint.parent), world(id)) : world(id);
  };
  const Vector rest = robot.neutral();
  const Placement X = from_parent(rest);
  json parts = json::array();
  int at = joint.idx_q;
  for (int k = 0; k < joint.nv;) {
    const bool circle = rest[std::size_t(at)] == 1;
    bool ball = false;
    json twists = json::array();
    do {  // one radian or metre of each
      Vector v(std::size_t(robot.nv), 0.0), q(rest.size());
      v[std::size_t(joint.idx_v + k)] = 1;
      check(dyn_integrate(robot, rest.data(), v.data(), q.data()));
      ball = !circle && q[std::size_t(at) + twists.size()] < 0.9;  // a quaternion has the sine of the half
      twists.push_back(logarithm(between(X, from_parent(q))));
      ++k;
    } while (ball && twists.size() < 3);
    parts.push_back({{"kind", circle ? "circle" : ball ? "ball" : "screw"}, {"twists", twists}});
    at += circle ? 2 : ball ? 4 : 1;
  }
  return {{"rest", X}, {"parts", parts}};
}

}  // namespace cli::page
