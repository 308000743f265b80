// Part of pinocchio_bench: operations on configurations.
#include "pinocchio_bench.hpp"

#include <pinocchio/algorithm/joint-configuration.hpp>

void addConfigurationRows(Bench & b)
{
  const Model & model = b.model;
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
  b.add("configuration_distance", true, [&](S s, S t) {
    const double d = pin::distance(model, s.q, t.q);
    keep(d);
  });
  // Pinocchio writes the blocks on the diagonal and leaves the rest to the caller; libdyn writes whole matrices. Here both do.
  MatrixXd j0 = MatrixXd::Zero(model.nv, model.nv), j1 = j0;
  b.add("integrate_jacobians", b.noMimic, [&, j0, j1](S s, S) mutable {
    j0.setZero(), j1.setZero();
    pin::dIntegrate(model, s.q, s.v, j0, pin::ARG0);
    pin::dIntegrate(model, s.q, s.v, j1, pin::ARG1);
    keep(j0);
    keep(j1);
  });
  b.add("difference_jacobians", b.noMimic, [&, j0, j1](S s, S t) mutable {
    j0.setZero(), j1.setZero();
    pin::dDifference(model, s.q, t.q, j0, pin::ARG0);
    pin::dDifference(model, s.q, t.q, j1, pin::ARG1);
    keep(j0);
    keep(j1);
  });
}
