// Enabled equalities in derivatives of a step: their impulses, which the step does not keep; how their forces turn with the
// bodies (algorithm/constrained/instance_derivatives.hpp); and the correction of their drift,
//   N^-1 J^T mu with (G + softness) mu = -C / 2
// whose derivative is taken at fixed G: the drift of a step is far below the geometry. It counts where the drift is rounding,
// too: changes of the state that matter are larger, and are corrected.
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

const char* StepJacobian::find_equalities() {
  equality0 = rows;
  const char* reason = nullptr;
  for_each_constraint(m, d, [&](ConstraintInstance<double>& s, Index) {
    if (one_sided(s.c.type))
      reason = "a limit or friction constraint is enabled";
    else if (s.c.stiffness > 0 || s.c.damping > 0)
      reason = "a constraint with stiffness or damping is enabled";
    else if (rows + s.rows > jacobian_rows(m))
      reason = "too many rows";
    if (reason) return;
    s.first = equalities, equalities += s.rows;
    for (Index r = 0; r < s.rows; ++r) y.rows[rows++] = {JacobianRowKind::Equality, -1, r, 0};
  });
  if (reason || equalities == 0) return reason;
  integrator::for_each_free_flyer<double>(m, WholeModel{}, [&](const Body&, Index i, const Vec3<double>&) {
    if (is_free(i)) reason = "a constraint is enabled beside bodies without joints of their own";
  });
  return reason;
}

void StepJacobian::add_equality_rows() const {
  for_each_constraint(m, d, [&](ConstraintInstance<double>& s, Index) {
    double* const at = J(equality0 + s.first);
    if (between_joints(s.c.type)) {
      at[user_dof(m, s.c.v1)] += s.g1;
      if (s.c.body2) at[user_dof(m, s.c.v2)] += s.g2;
      return;
    }
    const auto along = [&](Index body, const double* F) {
      for (Index i = body; i != 0; i = m.bodies()[i].parent)
        for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k)
          for (Index r = 0; r < s.rows; ++r) {
            double wrench[6];
            for (int c = 0; c < 6; ++c) wrench[c] = F[row_lanes * c + r];
            at[nv * r + user_dof(m, k)] += ratio(k) * dot(d.S[k], load_force(static_cast<const double*>(wrench)));
          }
    };
    if (s.c.body1) along(s.c.body1, s.F1);
    if (s.c.body2) along(s.c.body2, s.F2);
  });
}

// G of the equalities, with a softness of its diagonal, factored.
solver::RankedLu StepJacobian::factor_equalities(double softness) const {
  const Index n = equalities;
  double most = 0;
  for (Index r = 0; r < n; ++r) {
    double* const z = y.Z + nv * (equality0 + r);
    std::fill_n(z, nv, 0.0);
    add_rows(z, d.Minv, nv, J(equality0 + r), 1, Index(nv), nv);
  }
  for (Index r = 0; r < n; ++r)
    for (Index s = 0; s < n; ++s) {
      double sum = 0;
      for (Index k = 0; k < nv; ++k) sum += J(equality0 + r)[k] * y.Z[nv * (equality0 + s) + k];
      y.K[n * r + s] = sum, most = std::max(most, r == s ? sum : 0);
    }
  std::copy_n(y.K, n * n, y.drift_factor);
  for (Index r = 0; r < n; ++r) y.drift_factor[(n + 1) * r] += softness * y.K[(n + 1) * r] + solver::tuning::pgs::tiny * most;
  solver::RankedLu lu{y.drift_factor, n, y.drift_pivots, y.drift_unknowns};
  lu.factor(0);
  return lu;
}

// The impulses of the equalities: those that inverse dynamics at a lacks. d.tau: inverse dynamics without them.
const char* StepJacobian::find_equality_impulses() const {
  const Index n = equalities;
  double *const lacking = x.plus, *const b = y.rest, *const lambda = y.lambda;
  for (Index k = 0; k < nv; ++k) lacking[k] = h * (d.tau[k] + y.diagonal[k] * y.a[k] - d.tau_applied[k]);
  integrator::implicit_springs(m, d, h, implicit_springs(), [&](Index k, double by) { lacking[k] += h * h * by * x.v[k]; });
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index k) {
    if (r.v < 0) return;
    const double gear = r.spec.gear, gained = d.saturated[k] ? 0 : h * stiffness_of(r) * gear * x.v[r.v];
    lacking[r.v] -= h * gear * (d.actuator_force[k] - gained);
  });
  subtract_path_impulses(lacking);
  for (Index k = 0; k < m.n.limits; ++k) lacking[user_dof(m, m.limits()[k].dof)] -= h * w.limit_forces[k];
  std::fill_n(J(equality0), nv * n, 0.0);
  add_equality_rows();
  const solver::RankedLu lu = factor_equalities(solver::tuning::interior::regularisation);
  double* const more = y.wanted;
  std::fill_n(lambda, n, 0.0);
  for (int round = 0; round < 3; ++round) {
    for (Index r = 0; r < n; ++r) {
      b[r] = 0;
      for (Index k = 0; k < nv; ++k) b[r] += y.Z[nv * (equality0 + r) + k] * lacking[k];
      for (Index s = 0; s < n; ++s) b[r] -= y.K[n * r + s] * lambda[s];
    }
    lu.solve(b, 1, more);
    for (Index r = 0; r < n; ++r) lambda[r] += more[r];
  }
  double off = 0, most = 0;
  for (Index k = 0; k < nv; ++k) most = std::max(most, std::abs(lacking[k]));
  for (Index r = 0; r < n; ++r) {
    for (Index k = 0; k < nv; ++k) lacking[k] -= J(equality0 + r)[k] * lambda[r];
    d.lambda[r] = lambda[r] / h;
  }
  for (Index k = 0; k < nv; ++k) off = std::max(off, std::abs(lacking[k]));
  return off <= tuning::derivatives::consistent * most ? nullptr : "forces of constraints could not be found";
}

// After inverse dynamics with their forces: d.dtau_dq with forces that turn with the bodies.
void StepJacobian::differentiate_equality_forces() const {
  const KktSystem<double> K = equality_system();
  differentiate_constraints(m, d, d.expand(m, static_cast<const double*>(x.v), d.vx),
                            d.expand(m, static_cast<const double*>(y.a), d.ax), K, d.dtau_dq);
}
KktSystem<double> StepJacobian::equality_system() const {
  KktSystem<double> K{};
  K.rows = equalities, K.Dq = y.rest, K.Dv = y.wanted;
  return K;
}
// E: derivatives of J v' by q.
void StepJacobian::differentiate_equality_rates() const {
  const KktSystem<double> K = equality_system();
  const double* const v = d.expand(m, static_cast<const double*>(x.v_end), d.vx);
  derivative_columns(m, d, v, static_cast<const double*>(d.zero));
  std::fill_n(K.Dq, equalities * nv, 0.0);
  differentiate_rates(m, d, v, false, K, K.Dq);
  for (Index r = 0; r < equalities; ++r)
    for (Index k = 0; k < nv; ++k) E(equality0 + r)[k] = K.Dq[r + equalities * k];
}

// Adds the correction of drift to y.correction, and its derivative to y.turned.
const char* StepJacobian::correct_drift() const {
  const Index n = equalities;
  double size = 0;
  for_each_constraint(m, d, [&](ConstraintInstance<double>& s, Index) {
    for (Index r = 0; r < s.rows; ++r) {
      y.rest[s.first + r] = -tuning::island::correction * s.error[r];
      size = std::max(size, std::abs(s.error[r]));
    }
  });
  if (size > tuning::derivatives::drift) return "constraints drift by more than 1e-5";
  const solver::RankedLu lu = factor_equalities(tuning::island::correction_softness);
  lu.solve(y.rest, 1, y.lambda);
  const bool corrected = size > tuning::slop * std::min(1.0, w.length);  // else rounding: the step leaves it
  for (Index r = 0; r < (corrected ? n : 0); ++r) add_row(y.correction, y.Z + nv * (equality0 + r), y.lambda[r], nv);
  for (Index r = 0; r < n; ++r)
    for (Index k = 0; k < nv; ++k) y.rest[nv * r + k] = -tuning::island::correction * J(equality0 + r)[k];
  lu.solve(y.rest, nv, y.lambda);
  for (Index k = 0; k < nv; ++k) add_rows(y.turned + nv * k, y.lambda, nv, y.Z + nv * equality0 + k, nv, n, nv);
  return nullptr;
}

}  // namespace dyn::simulation
