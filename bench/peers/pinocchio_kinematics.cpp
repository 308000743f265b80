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
  b.add("fk_qv", true, [&](S s, S) {
    pin::forwardKinematics(model, data, s.q, s.v);
    keep(data);
  });
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
  b.add("integrate", true, [&](S s, S) {
    pin::integrate(model, s.q, s.v, b.qOut);
    keep(b.qOut);
  });
  b.add("difference", true, [&](S s, S t) {
    pin::difference(model, s.q, t.q, b.vOut);
    keep(b.vOut);
  });
  b.add("interpolate", true, [&](S s, S t) {
    pin::interpolate(model, s.q, t.q, 0.3, b.qOut);
    keep(b.qOut);
  });
  b.add("distance", true, [&](S s, S t) {
    const double d = pin::distance(model, s.q, t.q);
    keep(d);
  });
  MatrixXd j0 = MatrixXd::Zero(model.nv, model.nv), j1 = j0;
  b.add("integrate_jacobians", b.noMimic, [&, j0, j1](S s, S) mutable {
    pin::dIntegrate(model, s.q, s.v, j0, pin::ARG0);
    pin::dIntegrate(model, s.q, s.v, j1, pin::ARG1);
    keep(j0);
    keep(j1);
  });
  b.add("difference_jacobians", b.noMimic, [&, j0, j1](S s, S t) mutable {
    pin::dDifference(model, s.q, t.q, j0, pin::ARG0);
    pin::dDifference(model, s.q, t.q, j1, pin::ARG1);
    keep(j0);
    keep(j1);
  });
}
