// Part of pinocchio_bench: derivatives of the velocity and acceleration of the last joint's frame and of the velocity of
// the centre of mass, kinematic Hessian of that frame; kinematics included.
#include "pinocchio_bench.hpp"

#include <pinocchio/algorithm/center-of-mass-derivatives.hpp>
#include <pinocchio/algorithm/center-of-mass.hpp>
#include <pinocchio/algorithm/frames-derivatives.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics-derivatives.hpp>

void addFrameRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  Data::Matrix6x dv = Data::Matrix6x::Zero(6, model.nv), aq(dv), av(dv), aa(dv);
  b.add("frame_velocity_derivatives", b.noMimic, [&, dv, av](S s, S) mutable {
    pin::computeForwardKinematicsDerivatives(model, data, s.q, s.v, s.a);
    pin::getJointVelocityDerivatives(model, data, b.last, pin::LOCAL, dv, av);
    keep(dv);
    keep(av);
  });
  // J and its rate bring all that the derivatives of the velocity read
  b.add("frame_velocity_derivatives_dj", b.noMimic, [&, dv, av](S s, S) mutable {
    pin::computeJointJacobiansTimeVariation(model, data, s.q, s.v);
    pin::getJointVelocityDerivatives(model, data, b.last, pin::LOCAL, dv, av);
    keep(dv);
    keep(av);
  });
  b.add("frame_acceleration_derivatives", b.noMimic, [&, dv, aq, av, aa](S s, S) mutable {
    pin::computeForwardKinematicsDerivatives(model, data, s.q, s.v, s.a);
    pin::getJointAccelerationDerivatives(model, data, b.last, pin::LOCAL, dv, aq, av, aa);
    keep(aq);
    keep(av);
    keep(aa);
  });
  Data::Matrix3x dcom = Data::Matrix3x::Zero(3, model.nv);
  b.add("vcom_derivatives", b.noMimic, [&, dcom](S s, S) mutable {
    pin::computeForwardKinematicsDerivatives(model, data, s.q, s.v, s.a);
    pin::centerOfMass(model, data, s.q, s.v, true);
    pin::getCenterOfMassVelocityDerivatives(model, data, dcom);
    keep(dcom);
  });
  if (model.nv > kTensorColumns) return;
  Data::Tensor3x H(6, model.nv, model.nv);
  H.setZero();
  b.add("frame_kinematic_hessian", b.noMimic, [&, H](S s, S) mutable {
    pin::computeJointKinematicHessians(model, data, s.q);
    pin::getJointKinematicHessian(model, data, b.last, pin::LOCAL, H);
    keep(H);
  });
}
