// The linearised step (step_linearisation.hpp): forces along FIXED tendons, whose moment arms J are constant. A force is
//   f = f_0 + by_length J dq + by_rate J dv - inertia J (v' - v) / h        (path_forces.hpp)
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

namespace {

struct PathTerm {
  Index path;
  double force, by_length, by_rate, inertia;
  const ActuatorRecord* actuator;  // whose controls change the force, or nullptr
};

// f(term) for each force. One at the end of its range is constant.
template <class F>
void for_each_path_term(const StepJacobian& s, F&& f) {
  const Model& m = s.m;
  const Data<double>& d = s.d;
  const auto term = [&](Index row, Index path, double by_length, double by_rate, const ActuatorRecord* actuator) {
    const PathForce<double>& p = d.path_forces[row];
    const double before = rate_along(m, d, path, s.x.v), after = rate_along(m, d, path, s.x.v_end),
                 implicit = p.acts ? s.h * p.stiffness : 0;
    const double end = p.acts ? p.force - implicit * after - p.damping * (after - before) : p.force;
    if (end <= p.lower || end >= p.upper) return f(PathTerm{path, std::clamp(end, p.lower, p.upper), 0, 0, 0, nullptr});
    f(PathTerm{path, p.force - implicit * before, by_length, by_rate - implicit,
               p.acts ? s.h * (implicit + p.damping) + p.armature : 0, actuator});
  };
  for_each_tendon(m, d, [&](const dynTendon& t, Index k, double, double) {
    if (effect::Tendons::is_sprung(t)) term(spring_row(k), k, -d.path_forces[spring_row(k)].stiffness, -t.damping, nullptr);
  });
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index) {
    const double gear = r.spec.gear * r.spec.gear;
    if (r.path >= 0) term(actuator_row(m, r), r.path, gear * r.bias[1], gear * r.bias[2], &r);
  });
}

}  // namespace

const char* StepJacobian::find_path_reason(const Model& m, const Data<double>& d) {
  if (m.n.paths == 0) return nullptr;
  const char* reason = nullptr;
  if ((d.acting & DYN_EFFECT_TENDONS) && m.n.couplings > 0) reason = "tendons are coupled";
  for_each_tendon(m, d, [&](const dynTendon& t, Index k, double, double) {
    if (m.paths()[k].kind != PathKind::Fixed && effect::Tendons::is_sprung(t)) reason = "a spatial tendon acts";
    if (t.friction > 0 || effect::Tendons::is_limited(t)) reason = "a tendon has friction or a range";
  });
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index) {
    if (r.path < 0) return;
    const double* const slope = r.spec.gain_slope;
    if (m.paths()[r.path].kind != PathKind::Fixed) reason = "an actuator acts on a path whose moment arms change";
    else if (is_muscle(r) || has_driver(r.spec) || r.period > 0 || slope[0] != 0 || slope[1] != 0)
      reason = "an actuator on a tendon is not affine";
  });
  return reason;
}

// d.Minv of M + inertia J J^T (Sherman and Morrison).
void StepJacobian::add_path_inertia() const {
  for_each_path_term(*this, [&](const PathTerm& t) {
    if (t.inertia == 0) return;
    const PathRecord& p = m.paths()[t.path];
    double* const z = x.plus;
    std::fill_n(z, nv, 0.0);
    for (Index k = p.first_dof; k < p.first_dof + p.dofs; ++k)
      add_row(z, d.Minv + nv * m.path_dofs()[k], d.path_moment[k], nv);
    const double moved = rate_along(m, d, t.path, z);
    for (Index k = 0; k < nv; ++k) add_row(d.Minv + nv * k, z, -t.inertia / (1 + t.inertia * moved) * z[k], nv);
  });
}

void StepJacobian::differentiate_path_forces() const {
  for_each_path_term(*this, [&](const PathTerm& t) {
    const PathRecord& p = m.paths()[t.path];
    for (Index i = p.first_dof; i < p.first_dof + p.dofs; ++i) {
      double* const to = force(m.path_dofs()[i]);
      const double by = h * d.path_moment[i];
      for (Index k = p.first_dof; k < p.first_dof + p.dofs; ++k) {
        const Index j = m.path_dofs()[k];
        to[j] += by * t.by_length * d.path_moment[k], to[nv + j] += by * t.by_rate * d.path_moment[k];
      }
      if (!t.actuator) continue;
      const ActuatorRecord& r = *t.actuator;
      double* const u = to + 2 * nv + r.spec.idx_u;
      if (r.spec.controls > 0) u[0] += by * r.spec.gear * r.gain[0] * command_slope(r);
      if (r.spec.controls == 3) u[1] += by * r.spec.gear * r.gain[1], u[2] += by * r.spec.gear * r.gain[2];
    }
  });
}

void StepJacobian::subtract_path_impulses(double* from) const {
  for_each_path_term(*this, [&](const PathTerm& t) {
    const PathRecord& p = m.paths()[t.path];
    const double impulse = h * (t.force - t.inertia * rate_along(m, d, t.path, y.a));
    for (Index k = p.first_dof; k < p.first_dof + p.dofs; ++k) from[m.path_dofs()[k]] -= d.path_moment[k] * impulse;
  });
}

}  // namespace dyn::simulation
