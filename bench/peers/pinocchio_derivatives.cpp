// Part of pinocchio_bench: derivatives of inverse and forward dynamics, into the data.
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
}
