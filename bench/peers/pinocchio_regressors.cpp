// Part of pinocchio_bench: regressors.
#include "pinocchio_bench.hpp"

#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/regressor.hpp>

void addRegressorRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  // of the last joint's body, kinematics included
  b.add("joint_body_regressor", b.noMimic, [&](S s, S) {
    pin::forwardKinematics(model, data, s.q, s.v, s.a);
    pin::jointBodyRegressor(model, data, b.last);
    keep(data);
  });
  b.add("joint_torque_regressor", b.noMimic, [&](S s, S) {
    pin::computeJointTorqueRegressor(model, data, s.q, s.v, s.a);
    keep(data);
  });
  b.add("static_regressor", b.noMimic, [&](S s, S) {
    pin::computeStaticRegressor(model, data, s.q);
    keep(data);
  });
  b.add("kinetic_energy_regressor", b.noMimic, [&](S s, S) {
    pin::computeKineticEnergyRegressor(model, data, s.q, s.v);
    keep(data);
  });
  b.add("potential_energy_regressor", b.noMimic, [&](S s, S) {
    pin::computePotentialEnergyRegressor(model, data, s.q);
    keep(data);
  });
}
