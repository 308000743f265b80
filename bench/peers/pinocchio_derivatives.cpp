// Part of pinocchio_bench: derivatives of inverse and forward dynamics, of gravity and static torque.
#include "pinocchio_bench.hpp"

#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>

void addDerivativeRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  b.add("rnea_derivatives", b.noMimic, [&](S s, S) {
    pin::computeRNEADerivatives(model, data, s.q, s.v, s.a);
    keep(data);
  });
  b.add("aba_derivatives", b.noMimic, [&](S s, S) {
    pin::computeABADerivatives(model, data, s.q, s.v, s.tau);
    keep(data);
  });
  MatrixXd dg = MatrixXd::Zero(model.nv, model.nv);
  b.add("gravity_torque_derivatives", b.noMimic, [&, dg](S s, S) mutable {
    pin::computeGeneralizedGravityDerivatives(model, data, s.q, dg);
    keep(dg);
  });
  const std::vector<pin::Force> fext(std::size_t(model.njoints), pin::Force::Zero());
  b.add("static_torque_derivatives", b.noMimic, [&, dg, fext](S s, S) mutable {
    pin::computeStaticTorqueDerivatives(model, data, s.q, fext, dg);
    keep(dg);
  });
}
