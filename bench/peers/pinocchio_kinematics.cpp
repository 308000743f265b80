// Part of pinocchio_bench: placements, Jacobians, centre of mass.
#include "pinocchio_bench.hpp"

#include <pinocchio/algorithm/center-of-mass.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

void addKinematicsRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  b.add("forward_kinematics", true, [&](S s, S) { pin::forwardKinematics(model, data, s.q); keep(data); });
  b.add("forward_kinematics_q_v", true, [&](S s, S) {
    pin::forwardKinematics(model, data, s.q, s.v);
    keep(data);
  });
  b.add("forward_kinematics_q_v_a", true, [&](S s, S) {
    pin::forwardKinematics(model, data, s.q, s.v, s.a);
    keep(data);
  });
  b.add("joint_jacobians", true, [&](S s, S) {
    pin::computeJointJacobians(model, data, s.q);
    keep(data);
  });
  b.add("joint_jacobians_time_variation", true, [&](S s, S) {
    pin::computeJointJacobiansTimeVariation(model, data, s.q, s.v);
    keep(data);
  });
  Data::Matrix6x J = Data::Matrix6x::Zero(6, model.nv);
  b.add("frame_jacobian", true, [&, J](S s, S) mutable {
    pin::computeJointJacobians(model, data, s.q);
    pin::getJointJacobian(model, data, b.last, pin::LOCAL, J);
    keep(J);
  });
  b.add("com", true, [&](S s, S) { pin::centerOfMass(model, data, s.q, false); keep(data); });
  b.add("com_subtrees", true, [&](S s, S) {
    pin::centerOfMass(model, data, s.q, true);
    keep(data);
  });
  b.add("com_qva", true, [&](S s, S) {
    pin::centerOfMass(model, data, s.q, s.v, s.a, false);
    keep(data);
  });
  b.add("jcom", true, [&](S s, S) {
    pin::jacobianCenterOfMass(model, data, s.q, false);
    keep(data);
  });
  b.add("jcom_subtrees", true, [&](S s, S) {
    pin::jacobianCenterOfMass(model, data, s.q, true);
    keep(data);
  });
}
