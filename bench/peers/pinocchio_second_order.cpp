// Part of pinocchio_bench: the four tensors of second derivatives of inverse dynamics.
#include "pinocchio_bench.hpp"

#include <pinocchio/algorithm/rnea-second-order-derivatives.hpp>

void addSecondOrderRows(Bench & b)
{
  if (b.model.nv > kTensorColumns) return;
  const Model & model = b.model;
  Data & data = b.data;
  // into the data, whose tensors it clears first: libdyn writes whole tensors too
  b.add("second_order", b.noMimic, [&](S s, S) {
    pin::ComputeRNEASecondOrderDerivatives(model, data, s.q, s.v, s.a);
    keep(data.d2tau_dqdq);
    keep(data.d2tau_dvdv);
    keep(data.d2tau_dqdv);
    keep(data.d2tau_dadq);
  });
}
