// Part of pinocchio_bench: the four tensors of second derivatives of inverse dynamics.
#include "pinocchio_bench.hpp"

#include <pinocchio/algorithm/rnea-second-order-derivatives.hpp>

void addSecondOrderRows(Bench & b)
{
  if (b.model.nv > kTensorColumns) return;
  const Model & model = b.model;
  Data & data = b.data;
  Data::Tensor3x qq(model.nv, model.nv, model.nv), vv(qq), qv(qq), aq(qq);
  // Pinocchio asks for tensors of zeros and writes the rest; libdyn writes whole tensors. Here both do.
  b.add("rnea_second_order_derivatives", b.noMimic, [&, qq, vv, qv, aq](S s, S) mutable {
    qq.setZero(), vv.setZero(), qv.setZero(), aq.setZero();
    pin::ComputeRNEASecondOrderDerivatives(model, data, s.q, s.v, s.a, qq, vv, qv, aq);
    keep(qq);
    keep(vv);
    keep(qv);
    keep(aq);
  });
}
