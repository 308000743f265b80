// Part of pinocchio_bench: placements, Jacobians, centre of mass, configurations.
#include "pinocchio_bench.hpp"

#include <pinocchio/algorithm/center-of-mass.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

void addKinematicsRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  b.add("fk", true, [&](S s, S) { pin::forwardKinematics(model, data, s.q); keep(data); });
  b.add("fk_qva", true, [&](S s, S) {
    pin::forwardKinematics(model, data, s.q, s.v, s.a);
    keep(data);
  });
  b.add("jacobians", true, [&](S s, S) {
    pin::computeJointJacobians(model, data, s.q);
    keep(data);
  });
  b.add("djacobians", true, [&](S s, S) {
    pin::computeJointJacobiansTimeVariation(model, data, s.q, s.v);
    keep(data);
  });
  b.add("com", true, [&](S s, S) { pin::centerOfMass(model, data, s.q, false); keep(data); });
  b.add("com_subtrees", true, [&](S s, S) {
    pin::centerOfMass(model, data, s.q, true);
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
  b.add("integrate", true, [&](S s, S) {
    pin::integrate(model, s.q, s.v, b.qOut);
    keep(b.qOut);
  });
  b.add("difference", true, [&](S s, S t) {
    pin::difference(model, s.q, t.q, b.vOut);
    keep(b.vOut);
  });
}
