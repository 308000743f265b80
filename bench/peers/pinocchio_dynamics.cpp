// Part of pinocchio_bench: inverse dynamics, the mass matrix, energies.
#include "pinocchio_bench.hpp"

#include <pinocchio/algorithm/cholesky.hpp>
#include <pinocchio/algorithm/compute-all-terms.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/rnea.hpp>

void addDynamicsRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  b.add("rnea", true, [&](S s, S) { pin::rnea(model, data, s.q, s.v, s.a); keep(data); });
  b.add("nle", true, [&](S s, S) { pin::nonLinearEffects(model, data, s.q, s.v); keep(data); });
  b.add("gravity_torque", true, [&](S s, S) {
    pin::computeGeneralizedGravity(model, data, s.q);
    keep(data);
  });
  const pin::container::aligned_vector<pin::Force> fext(
    std::size_t(model.njoints), pin::Force::Zero());
  b.add("static_torque", true, [&, fext](S s, S) {
    pin::computeStaticTorque(model, data, s.q, fext);
    keep(data);
  });
  b.add("coriolis_matrix", b.noMimic, [&](S s, S) {
    pin::computeCoriolisMatrix(model, data, s.q, s.v);
    keep(data);
  });
  b.add("crba_local", true, [&](S s, S) {
    pin::crba(model, data, s.q, Convention::LOCAL);
    keep(data);
  });
  b.add("crba_world", true, [&](S s, S) {
    pin::crba(model, data, s.q, Convention::WORLD);
    keep(data);
  });
  b.add("cholesky", b.noMimic, [&](S, S) { pin::cholesky::decompose(model, data); keep(data); })
    .prepare = [&] { pin::crba(model, data, b.states[0].q, Convention::WORLD); };
  b.add("cholesky_solve", b.noMimic, [&](S s, S) {
    b.x = s.tau;
    pin::cholesky::solve(model, data, b.x);
    keep(b.x);
  }).prepare = [&] {
    pin::crba(model, data, b.states[0].q, Convention::WORLD);
    pin::cholesky::decompose(model, data);
  };
  b.add("all_terms", b.noMimic, [&](S s, S) {
    pin::computeAllTerms(model, data, s.q, s.v);
    keep(data);
  });
  b.add("kinetic_energy", b.noMimic, [&](S s, S) {
    const double e = pin::computeKineticEnergy(model, data, s.q, s.v);
    keep(e);
  });
  b.add("potential_energy", b.noMimic, [&](S s, S) {
    const double e = pin::computePotentialEnergy(model, data, s.q);
    keep(e);
  });
}
