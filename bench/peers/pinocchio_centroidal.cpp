// Part of pinocchio_bench: centroidal quantities.
#include "pinocchio_bench.hpp"

#include <pinocchio/algorithm/centroidal.hpp>
#include <pinocchio/algorithm/centroidal-derivatives.hpp>

void addCentroidalRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  b.add("centroidal_map", true, [&](S s, S) {
    pin::ccrba(model, data, s.q, s.v);
    keep(data);
  });
  b.add("centroidal_map_time_variation", b.noMimic, [&](S s, S) {
    pin::dccrba(model, data, s.q, s.v);
    keep(data);
  });
  b.add("centroidal_momentum", true, [&](S s, S) {
    pin::computeCentroidalMomentum(model, data, s.q, s.v);
    keep(data);
  });
  b.add("centroidal_momentum_time_variation", true, [&](S s, S) {
    pin::computeCentroidalMomentumTimeVariation(model, data, s.q, s.v, s.a);
    keep(data);
  });
  Data::Matrix6x dh_dq(6, model.nv), dhdot_dq(dh_dq), dhdot_dv(dh_dq), dhdot_da(dh_dq);
  b.add("centroidal_derivatives", b.noMimic, [&, dh_dq, dhdot_dq, dhdot_dv, dhdot_da](S s, S) {
    pin::computeCentroidalDynamicsDerivatives(
      model, data, s.q, s.v, s.a, dh_dq, dhdot_dq, dhdot_dv, dhdot_da);
    keep(data);
  });
}
