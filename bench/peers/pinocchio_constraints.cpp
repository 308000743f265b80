// Part of pinocchio_bench: dynamics with feet on the ground, its derivatives, the Delassus matrix.
//
// The Delassus matrix comes from articulated inertias ("efpa") or from the factor of the KKT matrix ("cholesky").
// Pinocchio's pv and constrainedABA are no rows: those of version 4.1.0 do not compile (they name a member that
// RigidConstraintData no longer has).
#include "pinocchio_model.hpp"

#include <memory>

#include <pinocchio/algorithm/constrained-dynamics-derivatives.hpp>
#include <pinocchio/algorithm/constrained-dynamics.hpp>
#include <pinocchio/algorithm/delassus.hpp>

namespace
{

// With a data of their own: initConstraintDynamics sets it up.
struct Contacts
{
  Data data;
  std::vector<pin::RigidConstraintModel> models;
  std::vector<pin::RigidConstraintData> datas;
  MatrixXd delassus, ddq_dq, ddq_dv, ddq_dtau, lambda_dq, lambda_dv, lambda_dtau;

  Contacts(const Model & model, const std::vector<Contact> & contacts)
  : data(model)
  {
    int rows = 0;
    for (const Contact & c : contacts)
    {
      const pin::ContactType type = c.point ? pin::CONTACT_3D : pin::CONTACT_6D;
      models.emplace_back(type, model, c.joint, c.placement, pin::LOCAL);
      rows += c.point ? 3 : 6;
    }
    for (const pin::RigidConstraintModel & m : models)
      datas.push_back(m.createData());
    delassus = MatrixXd::Zero(rows, rows);
    ddq_dq = ddq_dv = ddq_dtau = MatrixXd::Zero(model.nv, model.nv);
    lambda_dq = lambda_dv = lambda_dtau = MatrixXd::Zero(rows, model.nv);
  }
};

} // namespace

void addConstraintRows(Bench & b, const std::vector<Contact> & contacts)
{
  if (contacts.empty()) return;
  const Model & model = b.model;
  const auto make = [&] { return std::make_shared<Contacts>(model, contacts); };
  const pin::ProximalSettings exact(1e-12, 0, 1);

  auto kkt = make();
  pin::initConstraintDynamics(model, kkt->data, kkt->models, kkt->datas);
  b.add("constrained_dynamics", b.noMimic, [&, kkt, settings = exact](S s, S) mutable {
    pin::constraintDynamics(model, kkt->data, s.q, s.v, s.tau, kkt->models, kkt->datas, settings);
    keep(kkt->data);
  });
  b.add("constrained_dynamics_derivatives", b.noMimic, [&, kkt, settings = exact](S s, S) mutable {
    Contacts & c = *kkt;
    pin::constraintDynamics(model, c.data, s.q, s.v, s.tau, c.models, c.datas, settings);
    pin::computeConstraintDynamicsDerivatives(
      model, c.data, c.models, c.datas, settings, c.ddq_dq, c.ddq_dv, c.ddq_dtau, c.lambda_dq,
      c.lambda_dv, c.lambda_dtau);
    keep(c);
  });
  b.add("delassus_cholesky", b.noMimic, [&, kkt](S s, S) {
    Contacts & c = *kkt;
    pin::crba(model, c.data, s.q, Convention::WORLD);
    pin::calc(model, c.data, c.models, c.datas);
    c.data.constraint_chol.compute(model, c.data, c.models, c.datas, 0.);
    c.data.constraint_chol.getInverseOperationalSpaceInertiaMatrix(c.delassus);
    keep(c);
  });
  auto articulated = make();
  b.add("delassus_efpa", b.noMimic, [&, articulated](S s, S) {
    Contacts & c = *articulated;
    pin::computeDelassusMatrix(model, c.data, s.q, c.models, c.datas, c.delassus);
    keep(c);
  });
}
