#include <numbers>

#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

namespace {

// Why the step is not covered, or nullptr.
const char* find_reason(const Model& m, const Data<double>& d) {
  const Workspace& w = *d.step;
  const dynIntegrator by = w.options.integrator;
  if (by != DYN_INTEGRATOR_SEMI_IMPLICIT_EULER && by != DYN_INTEGRATOR_IMPLICIT_FAST)
    return "the integrator is neither SEMI_IMPLICIT_EULER nor IMPLICIT_FAST";
  if (w.options.contact_model != DYN_CONTACT_MODEL_RIGID) return "contact_model is AS_FILE";
  if (const char* const reason = StepJacobian::find_path_reason(m, d)) return reason;
  if (m.n.force_limits > 0) return "the sum of several actuators is limited";
  if (d.acting & (DYN_EFFECT_FLUID | DYN_EFFECT_FLUID_ELLIPSOIDS)) return "a medium acts on a link";
  if (w.report.rejected > 0 || w.report.steps != 1) return "the step was made in parts";
  if (w.report.residual > tuning::island::fine) return "the contact solver did not reach a residual of 1e-9";
  for (Index k = 0; k < m.n.limits; ++k)
    if (is_ball(m, m.limits()[k]) && w.limit_forces[k] != 0) return "the limit of a ball joint presses";
  for (Index i = 1; i < m.n.bodies; ++i)
    if (m.bodies()[i].type == BodyType::FreeFlyer && m.bodies()[i].parent != 0) return "a link carries a free flyer";
  return nullptr;
}

}  // namespace

// All that is applied. Returns why it is not possible, or nullptr.
const char* StepJacobian::linearise(double margin) {
  find_acceleration();
  const double* const fext = forces_on_bodies(m, d);
  differentiate_inverse_dynamics(fext);
  find_twists(x.v_end, y.twists), find_twists(x.v, y.twists_before);
  find_diagonal();
  for (Index k = 0; k < nv; ++k) d.M[(nv + 1) * k] += y.diagonal[k];
  if (factorize(m, d)) return "the inertia is singular";
  invert(m, d), add_path_inertia();
  if (equalities > 0) {
    if (const char* const reason = find_equality_impulses()) return reason;
    with_equalities = true, differentiate_inverse_dynamics(fext);
    differentiate_equality_forces();
  }
  differentiate_forces();
  if (equalities > 0) std::fill_n(d.dtau_dq, nv * nv, 0.0);  // inverse dynamics leaves entries of unrelated joints as they are
  if (fext) differentiate_link_forces();
  sum_impulses(y.impulse), find_flight(), find_free_acceleration();
  for (Index k = 0; k < contacts; ++k) differentiate_impulse(y.contacts[k], y.contacts[k].force);
  if (rows > 0) {
    differentiate_rows(), assemble(), flag_weak_rows(margin), factor_rows();
    if (!is_determined()) flag_contacts();
  }
  return w.corrected || equalities > 0 ? find_corrections() : nullptr;
}

void StepJacobian::flag_contacts() const {
  for (Index k = 0; k < contacts; ++k) x.modes.degenerate[y.contacts[k].contact] = 1;
}

// Of all columns, or along y.direction. Returns whether the equations of the rows are consistent.
bool StepJacobian::apply() {
  solve_for_state();
  bool consistent = true;
  if (rows > 0) find_wanted(), consistent = solve_rows();
  displace();
  return consistent;
}

// y.adjoint and y.gradient, from the gradient by the next state.
void StepJacobian::apply_transposed(const double* gradient) {
  std::fill_n(y.adjoint, mixed + nv, 0.0);
  transpose_end(gradient), transpose_displacement();
  if (rows > 0) transpose_rows();
  transpose_state();
}

// Whether redundant equations are consistent, along a direction that no symmetry of the step has.
void StepJacobian::probe_rows() {
  if (system.rank == rows) return;
  for (std::ptrdiff_t k = 0; k < mixed + nv; ++k) {
    const double at = std::numbers::phi * double(k + 1);
    y.direction[k] = 0.5 + at - std::floor(at);
  }
  clear_given();
  if (!apply()) flag_contacts();
}

void step_jacobian(const Model& m, Data<double>& d, StepDerivatives& x, double margin, const Wanted& wanted) {
  start_from(m, d, x);
  StepJacobian s{m, d, x};
  if ((x.reason = find_reason(m, d)) || (x.reason = s.find_rows()) || (x.reason = s.find_parameters(wanted.products))) return;
  std::fill_n(x.jacobian.correction, m.n.nv, 0.0);
  if ((x.reason = s.linearise(margin))) return;
  if (wanted.matrices()) {
    if (!s.apply()) s.flag_contacts();
    s.write(x.by);
  }
  s.along = true, s.columns = 1;
  if (!wanted.matrices()) s.probe_rows();
  s.multiply(wanted.products);
}

}  // namespace dyn::simulation
