#include "base/portable.hpp"
#include "simulation/ledger.hpp"

#include "algorithm/energy.hpp"
#include "algorithm/constrained/constrained_dynamics.hpp"
#include "algorithm/external_forces.hpp"
#include "simulation/implicit_actuators.hpp"
#include "simulation/island.hpp"

namespace dyn::simulation {

namespace {

struct Energies {
  double kinetic, potential;
  double sum() const { return kinetic + potential; }
};
// The caller changed d.q and d.v directly, so cached stages are invalid before and after.
Energies energies(const Model& m, Data<double>& d) {
  d.invalidate(Stage::Position), d.invalidate(Stage::Velocity);
  kinetic_energy(m, d), potential_energy(m, d);
  const Energies out{d.kinetic[0], d.potential[0]};
  d.invalidate(Stage::Kinetic), d.invalidate(Stage::Potential), d.invalidate(Stage::Position), d.invalidate(Stage::Velocity);
  return out;
}

// Power and sum of the forces on bodies by the given effects alone.
double power_on_bodies(const Model& m, Data<double>& d, std::uint32_t effects, Vec3<double>& sum) {
  const std::uint32_t acting = d.acting;
  if (!(acting & effects)) return 0;
  d.acting &= effects;
  const double* const fext = forces_on_bodies(m, d);
  d.acting = acting;
  forward_kinematics<1>(m, d);
  double power = 0;
  for (Index j = 1; fext && j < m.n.joints; ++j) {
    const Index body = m.joints()[j].last_body;
    const Mat3<double> R = d.R[body] * m.joints()[j].C;
    const Vec3<double> force = R * load3(fext + 6 * j);
    sum = sum + force;
    power += dot(force, d.vel[body]) + dot(R * load3(fext + 6 * j + 3), d.omega[body]);
  }
  return power;
}

bool has_free_roots(const Model& m) {
  for (Index i = 1; i < m.n.bodies; ++i)
    if (m.bodies()[i].parent == 0 && m.bodies()[i].type != BodyType::FreeFlyer) return false;
  return true;
}

LedgerState state_of(const Model& m, Data<double>& d) {
  LedgerState x{};
  const std::uint32_t acting = d.acting;
  if (has_friction_rows(d)) d.acting &= ~std::uint32_t(DYN_EFFECT_FRICTION);  // its work is that of rows
  x.energy = energies(m, d).sum();
  Vec3<double> force = Vec3<double>::zero();
  x.power.wrenches = power_on_bodies(m, d, acting_wrenches, force);
  for_each_effect([&]<class E>() {
    if constexpr (effect::OnLinks<E>) E::work(x.power) += power_on_bodies(m, d, E::bit, force);
  });
  forward_kinematics<1>(m, d);
  double* const t = d.step->ledger.tau;  // total torque at joints
  std::copy_n(d.tau_applied, m.n.nv, t);
  if (m.n.paths > 0) {
    measure_paths(m, d), take_limits(m, d);
    std::copy_n(t, m.n.nv, d.step_tau);
    add_beyond_limits(m, d, t);
    for (Index k = 0; k < m.n.nv; ++k) x.power.actuators += (t[k] - d.step_tau[k]) * d.v[k];
  }
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index) {
    const double force = actuator_force(r, d);
    add_actuator_force(m, d, r, force, t), x.power.actuators += r.spec.gear * force * stroke_of(r, d).v;
  });
  for_each_tendon(m, d, [&](const dynTendon& s, Index k, double length, double rate) {
    add_path_force(m, d, k, effect::Tendons::force(s, length, rate), t);
    x.power.damping -= s.damping * rate * rate;
  });
  for (Index k = 0; k < m.n.nv; ++k) x.power.applied += d.tau_applied[k] * d.v[k];
  for_each_velocity_law(d, [&]<class E>(const double* c) {
    for (Index k = 0; k < m.n.nv; ++k) {
      const double force = E::force(c[k], d.v[k]);
      E::work(x.power) -= force * d.v[k];
      t[k] -= force;
    }
  });
  double mass = 0;
  Vec3<double> momentum = Vec3<double>::zero();
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    mass += b.m;
    momentum = momentum + d.vel[i] * b.m + cross(d.omega[i], d.R[i] * b.h);
    if (b.parent == 0 && b.type == BodyType::FreeFlyer) force = force + d.R[i] * load3(t + b.user_v);
  }
  d.acting = acting;
  store3(momentum, x.momentum), store3(force + load3(d.world_gravity) * mass, x.force);
  return x;
}

}  // namespace

void open_ledger(const Model& m, Data<double>& d) {
  Ledger& l = d.step->ledger;
  l = {d.step->options.ledger != 0, {}, {}, {}, l.q, l.tau};
  if (l.open) l.before = state_of(m, d);
}

void record_step(const Model& m, Data<double>& d, double h) {
  Ledger& l = d.step->ledger;
  dynErrorLedger& out = l.report;
  const LedgerState after = state_of(m, d);
  using Power = LedgerState::Power;
  const auto work_of = [&](double Power::*p, bool recorded) {
    return recorded ? l.rows.work.*p : h / 2 * (l.before.power.*p + after.power.*p);
  };
  const bool all = l.rows.all, joints = all || l.rows.at_joints;
  const double change = after.energy - l.before.energy;
  const double work[] = {work_of(&Power::applied, joints), work_of(&Power::actuators, joints), work_of(&Power::wrenches, all),
                         work_of(&Power::damping, joints), work_of(&Power::friction, joints), work_of(&Power::fluid, all),
                         l.rows.normal, l.rows.sliding, l.rows.limits, l.rows.constraints, l.rows.correction};
  double* const entries[] = {&out.applied, &out.actuators, &out.wrenches, &out.damping, &out.friction, &out.fluid,
                             &out.contact_normal, &out.contact_friction, &out.limits, &out.constraints, &out.correction};
  double sum = 0;
  for (int k = 0; k < 11; ++k) *entries[k] += work[k], sum += work[k];
  out.energy_change += change, out.energy_defect += change - sum;
  const bool free = has_free_roots(m);
  for (int i = 0; free && i < 3; ++i)
    out.momentum_defect[i] +=
        after.momentum[i] - l.before.momentum[i] - h / 2 * (l.before.force[i] + after.force[i]) - l.rows.impulse[i];
  out.constraint_drift = std::max(out.constraint_drift, l.rows.drift), out.cone = std::max(out.cone, l.rows.cone);
  out.complementarity = std::max(out.complementarity, l.rows.complementarity);
  ++out.steps;
  l.before = after, l.rows = {};
}

void record_powers(const Model& m, Data<double>& d, double share) {
  using Power = LedgerState::Power;
  const Power now = state_of(m, d).power;
  LedgerRows& l = d.step->ledger.rows;
  for (const auto p : {&Power::applied, &Power::actuators, &Power::wrenches, &Power::damping, &Power::friction, &Power::fluid})
    l.work.*p += share * (now.*p);
  l.all = true;
}

// The step takes resistance as r = D(v0) v.
void record_joint_work(Data<double>& d, const double* v0, double h, Index first, Index end) {
  LedgerState::Power& work = d.step->ledger.rows.work;
  const std::uint32_t acting = d.acting;
  if (has_friction_rows(d)) d.acting &= ~std::uint32_t(DYN_EFFECT_FRICTION);
  for (Index k = first; k < end; ++k) work.applied += h * d.tau_applied[k] * (v0[k] + d.v[k]) / 2;
  for_each_velocity_law(d, [&]<class E>(const double* c) {
    for (Index k = first; k < end; ++k) E::work(work) -= h * E::secant(c[k], v0[k]) * d.v[k] * (v0[k] + d.v[k]) / 2;
  });
  d.acting = acting;
}

void record_drive_work(const Model& m, Data<double>& d, const double* v0, double h) {
  LedgerRows& l = d.step->ledger.rows;
  l.at_joints = true;
  const auto rate = [&](Index path, const double* v) { return rate_along(m, d, path, v); };
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index k) {
    if (sleeps(m, d, r)) return;
    const double before = r.v >= 0 ? v0[r.v] : rate(r.path, v0), after = r.v >= 0 ? d.v[r.v] : rate(r.path, d.v);
    double force = 0;
    if (r.v >= 0) {
      force = d.actuator_force[k];
      if (!d.saturated[k]) force = force_at_end(r, force, before, (after - before) / h, h);
      force *= r.spec.gear;
    } else {
      const PathForce<double>& x = d.path_forces[actuator_row(m, r)];
      force = std::clamp(x.acts ? x.force - h * x.stiffness * after - x.damping * (after - before) : x.force, x.lower, x.upper);
    }
    l.work.actuators += h * force * (before + after) / 2;
  });
  for_each_tendon(m, d, [&](const dynTendon& s, Index k, double, double) {
    const double before = rate(k, v0), after = rate(k, d.v);
    l.work.damping -= h * s.damping * (d.path_forces[spring_row(k)].acts ? after : before) * (before + after) / 2;
  });
}

void record_impulses(const Island& x) {
  using Six = SixEights<double>;
  LedgerRows& l = x.w.ledger.rows;
  const auto before = [&](Index body) { return body_motion(x.m, x.d, body, x.v_before, static_cast<const double*>(nullptr)).V; };
  for (Index k = 0; k < x.constraint_count; ++k) {
    const ActiveConstraint& a = x.constraint(k);
    const ConstraintInstance<double>& s = a.s ? *a.s : contact_wrenches(x.m, x.d, a);
    const bool joints = between_joints(s.c.type);
    double c0[max_rows] = {};
    if (is_path_row(a)) {
      c0[0] = path_rate(x.m, x.d, s, x.v_before);
    } else if (joints) {
      c0[0] = of_ball(s.c) ? box_rate(x.m, x.d, s, x.v_before) : s.g1 * x.v_before[s.c.v1] + (s.g2 != 0 ?
          s.g2 * x.v_before[s.c.v2] : 0);
    } else {
      const auto rate = Six::load(s.F1).dot(before(s.c.body1)) + Six::load(s.F2).dot(before(s.c.body2));
      for (Index r = 0; r < s.rows; ++r) c0[r] = rate[int(r)];
    }
    const Index normal = a.kind == RowKind::Contact ? normal_row(s.rows) : -1;
    double across = 0, pressed = 0;
    for (Index r = 0; r < s.rows; ++r) {
      const Index i = a.first + r;
      const double slip =
          a.kind == RowKind::Contact && r < 2 && s.rows > 1 ? x.w.laws[a.index].slip[r] : 0;  // velocity of a belt
      const double work = x.lambda[i] * (c0[r] + x.c[i] - slip) / 2;
      if (is_path_row(a) && x.compliance[i] > 0) continue;  // a force along a path: record_drive_work
      if (a.kind == RowKind::Equality) l.constraints += work, l.drift = std::max(l.drift, std::abs(s.error[r]));
      else if (a.kind == RowKind::Box) l.limits += work;
      else (r == normal ? l.normal : l.sliding) += work;
      if (r == normal) {
        const double velocity = x.c[i] + x.bias[i] + x.compliance[i] * x.lambda[i];
        pressed = x.lambda[i], l.complementarity = std::max(l.complementarity, std::abs(x.lambda[i] * velocity) / x.h);
      } else if (a.kind == RowKind::Contact && r < 3) across = math::hypot(across, x.lambda[i]);
    }
    if (a.kind == RowKind::Contact) {
      const ContactLaw& law = x.w.laws[a.index];
      l.cone = std::max(l.cone, (across - law.material.friction * pressed) / x.h);
      const dynContactForce& f = x.w.contacts[a.index];
      const bool one = s.c.body1 == 0, two = s.c.body2 == 0;
      for (int i = 0; one != two && i < 3; ++i) l.impulse[i] += (two ? 1 : -1) * x.h * f.force_on_b[i];
    } else if (!joints && a.kind == RowKind::Equality && (s.c.body1 == 0) != (s.c.body2 == 0)) {
      for (Index r = 0; r < s.rows; ++r)
        for (int i = 0; i < 3; ++i) l.impulse[i] += x.lambda[a.first + r] * (s.c.body1 ? s.F1 : s.F2)[row_lanes * i + r];
    }
  }
}

void record_correction(const Model& m, Data<double>& d, const double* q0, const double* hv, const double* dq) {
  double *const without = d.step->by_dof, *const q = d.q;
  double* const there = d.step->ledger.q;
  for (Index k = 0; k < m.n.nv; ++k) without[k] = hv[k] - dq[k];
  integrate(m, q0, without, there);
  const double corrected = energies(m, d).potential;
  d.q = there;
  d.step->ledger.rows.correction += corrected - energies(m, d).potential;
  d.q = q;
}

double ledger_potential(const Model& m, Data<double>& d) { return energies(m, d).potential; }

void record_projection(const Model& m, Data<double>& d, double before) {
  d.step->ledger.rows.correction += energies(m, d).potential - before;
}

}  // namespace dyn::simulation
