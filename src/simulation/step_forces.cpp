// The linearised step (step_linearisation.hpp): derivatives of its forces at fixed impulses of rows.
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

void StepJacobian::find_acceleration() const {
  for (Index k = 0; k < nv; ++k) y.a[k] = (x.v_end[k] - x.v[k]) / h;
  integrator::for_each_free_flyer<double>(m, WholeModel{}, [&](const Body& b, Index i, const Vec3<double>& c) {
    if (is_free(i)) return;
    store3(load3(static_cast<const double*>(y.a + b.user_v)) - flight(b, c).value() * (1 / h), y.a + b.user_v);
  });
}

// A force on B, and the opposite on A.
void StepJacobian::subtract_force(const JacobianContact& c, const Vec3<double>& force) const {
  const auto subtract = [&](Index body, const Vec3<double>& f) {
    if (body) d.composite[body].f = d.composite[body].f - shift(Force<double>{f, Vec3<double>::zero()}, c.position - root(body));
  };
  subtract(c.body_b, force), subtract(c.body_a, force * -1.0);
}

// The implicit part of the inertia, and its derivative by v.
integrator::Springs StepJacobian::implicit_springs() const {
  using integrator::Springs;
  return !(d.acting & DYN_EFFECT_SPRINGS)                       ? Springs::None
         : w.options.integrator == DYN_INTEGRATOR_IMPLICIT_FAST ? Springs::All
                                                                : Springs::Stiff;
}

void StepJacobian::find_diagonal() const {
  std::fill_n(y.diagonal, nv, 0.0), std::fill_n(y.diagonal_by_v, nv, 0.0);
  for_each_velocity_law(d, [&]<class E>(const double* c) {
    for (Index k = 0; k < nv; ++k)
      y.diagonal[k] += E::secant(h * c[k], x.v[k]), y.diagonal_by_v[k] += E::secant_slope(h * c[k], x.v[k]);
  });
  integrator::implicit_springs(m, d, h, implicit_springs(),
                               [&](Index k, double stiffness) { y.diagonal[k] += h * h * stiffness; });
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index k) {
    if (r.v >= 0 && !d.saturated[k]) y.diagonal[r.v] += square(r.spec.gear) * (h * damping_of(r) + h * h * stiffness_of(r));
  });
}

// force = h times the derivatives of the forces at fixed impulses
void StepJacobian::differentiate_forces() const {
  std::fill_n(y.force, nv * mixed, 0.0);
  for (Index k = 0; k < nv; ++k) {
    double* const to = force(k);
    for (Index j = 0; j < nv; ++j) to[j] = -h * d.dtau_dq[k + nv * j], to[nv + j] = -h * d.dtau_dv[k + nv * j];
    to[nv + k] -= h * y.diagonal_by_v[k] * y.a[k];
  }
  integrator::implicit_springs(m, d, h, implicit_springs(),
                               [&](Index k, double stiffness) { force(k)[nv + k] -= h * h * stiffness; });
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index k) {
    if (r.v < 0 || d.saturated[k]) return;
    const double by = h * r.spec.gear;
    double* const to = force(r.v);
    if (r.q >= 0) to[r.v] += by * r.bias[1] * r.spec.gear;
    to[nv + r.v] += by * r.spec.gear * (r.bias[2] - h * stiffness_of(r));
    double* const u = to + 2 * nv + r.spec.idx_u;
    if (r.spec.controls > 0) u[0] += by * r.gain[0] * command_slope(r);
    if (r.spec.controls == 3) u[1] += by * r.gain[1], u[2] += by * r.gain[2];
  });
  differentiate_path_forces();
}

// Of what drives an actuator, by its control.
double StepJacobian::command_slope(const ActuatorRecord& r) const {
  const double u = d.ctrl[r.spec.idx_u], held = clamp_to(u, r.spec.control_range);
  if (held != u) return 0;
  if (r.act < 0) return 1;
  if (acts_late(r, d)) return 0;
  const double slope = r.spec.integrates ? h : 1 - math::exp(-h / r.spec.time_constant);
  const double next = activation_after(r, d, d.act[r.act], h);
  return next > r.spec.act_range[0] && next < r.spec.act_range[1] ? slope : 0;
}

// F: change along q_j of an impulse on a body, at its tree's root, beyond what it carries along.
void StepJacobian::add_force_change(Index body, Index j, const Force<double>& F) const {
  for (Index i = body; i != 0; i = m.bodies()[i].parent)
    for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k)
      forces[mixed * user_dof(m, k) + user_dof(m, j)] += ratio(k) * ratio(j) * dot(d.S[k], F);
}

// Wrenches and gravity compensation: of forces in world axes inverse dynamics takes the axes for the body's.
void StepJacobian::differentiate_link_forces() const {
  if (d.acting & acting_wrenches)
    for (Index j = 1; j < m.n.joints; ++j) {
      const AppliedWrench<double>& a = d.wrenches[j];
      const Index body = m.joints()[j].last_body;
      const Mat3<double>& R = d.R[body];
      const Force<double> all = a.at(R, d.p[body]);
      for_each_mover(body, [&](Index k, const Motion<double>& S) {
        const Mat3<double> B = cross(S.angular, R * a.arm);
        const Vec3<double> arm = Vec3<double>::make(B(1, 2) - B(2, 1), B(2, 0) - B(0, 2), B(0, 1) - B(1, 0));
        const Force<double> by{cross(S.angular, R * a.local.linear - all.linear),
                               cross(S.angular, R * a.local.angular - all.angular) + arm - cross(S.linear, a.world.linear)};
        add_force_change(body, k, shift(by, d.rel[body]) * h);
      });
    }
  using effect::GravityCompensation;
  for (const auto& r : GravityCompensation::records(m)) {
    if (!(d.acting & GravityCompensation::bit) || !(d.effects[r.joint] & GravityCompensation::bit)) continue;
    const Force<double> all = GravityCompensation::wrench<double>(m, d, r);
    const Vec3<double> arm = d.R[r.body] * r.at;
    for_each_mover(r.body, [&](Index k, const Motion<double>& S) {
      const Force<double> by{cross(all.linear, S.angular),
                             cross(cross(S.angular, arm), all.linear) - cross(S.angular, all.angular)};
      add_force_change(r.body, k, shift(by, d.rel[r.body]) * h);
    });
  }
}

// The impulse of a contact turns and moves with its shapes: what inverse dynamics takes for fixed to the bodies.
void StepJacobian::differentiate_impulse(const JacobianContact& c, const Vec3<double>& f) const {
  for_each_dof(c, y.twists, [&](Index j, const Motion<double>& S, const Motion<double>&, bool of_b) {
    const Motion<double> by = moved(c, S, of_b);
    const Force<double> change{cross(by.angular, f), cross(by.linear, f)};  // about the point
    const Force<double> carried{cross(S.angular, f), cross(S.linear, f)};
    const auto add = [&](Index body, const Force<double>& F) {
      if (body) add_force_change(body, j, shift(F, c.position - root(body)));
    };
    const Force<double> none = Force<double>::zero();
    add(c.body_b, of_b ? change - carried : change), add(c.body_a, none - (of_b ? change : change - carried));
  });
}

// state = dv' at fixed impulses
void StepJacobian::solve_for_state() const {
  if (along) return solve_along();
  for (Index k = 0; k < nv; ++k) {
    double* const to = state(k);
    std::fill_n(to, 2 * nv, 0.0);
    for (Index l = 0; l < nv; ++l) to[2 * nv + l] = h * d.Minv[nv * k + l];
    to[nv + k] = 1;
  }
  add_product(y.state, columns, nv, {d.Minv, nv, 1}, y.force, mixed, Index(nv), 2 * nv);
  for_each_flight([&](Index row, const double* by, const auto& column) {
    for (int c = 0; c < 12; ++c) state(row)[column(c)] += by[c];
    for (int c = 12; c < flight_columns; ++c) state(row)[column(c) - m.n.nu] += by[c] * h;
  });
}
void StepJacobian::solve_along() const {
  const double *const x = y.direction, *const tau = x + mixed;
  for (Index k = 0; k < nv; ++k) y.moved[k] = inner(force(k), x, mixed) + h * tau[k] + y.given.force[k];
  for (Index k = 0; k < nv; ++k) y.state[k] = inner(d.Minv + nv * k, y.moved, nv) + x[nv + k] + y.given.velocity[k];
  for_each_flight([&](Index row, const double* by, const auto& column) {
    for (int c = 0; c < 12; ++c) y.state[row] += by[c] * x[column(c)];
    for (int c = 12; c < flight_columns; ++c) {
      const std::ptrdiff_t k = column(c) - mixed;
      y.state[row] += by[c] * (h * tau[k] + y.given.force[k]);
    }
  });
}
// From the gradient by dv' at fixed impulses.
void StepJacobian::transpose_state() const {
  const double* const from = y.state_adjoint;
  double* const f = y.gradient.force;
  std::copy_n(from, nv, y.gradient.velocity);
  for (Index k = 0; k < nv; ++k) f[k] = inner(d.Minv + nv * k, from, nv);
  for (Index k = 0; k < nv; ++k) add_row(y.adjoint, force(k), f[k], mixed), y.adjoint[nv + k] += from[k];
  for_each_flight([&](Index row, const double* by, const auto& column) {
    for (int c = 0; c < 12; ++c) y.adjoint[column(c)] += by[c] * from[row];
    for (int c = 12; c < flight_columns; ++c) f[column(c) - mixed] += by[c] * from[row];
  });
  for (Index k = 0; k < nv; ++k) y.adjoint[mixed + k] += h * f[k];
}

// flight: the derivatives of delta of free flyers by their q, v and h times their forces. Of bodies that fly alone by the angular
// acceleration, too: before the impulses of contacts are differentiated.
void StepJacobian::find_flight() const {
  std::fill_n(y.flight, nv * flight_columns, 0.0);
  integrator::for_each_free_flyer<double>(m, WholeModel{}, [&](const Body& b, Index i, const Vec3<double>& c) {
    const Index at = b.user_v;
    const auto set = [&](int column, const integrator::FreeBodyFlight<double>::Change& by) {
      double* const to = y.flight + flight_columns * at + column;
      for (int k = 0; k < 3; ++k) to[flight_columns * k] = by.linear[k], to[flight_columns * (3 + k)] = by.angular[k];
    };
    const auto linear = flight(b, c);
    const Vec3<double> o = Vec3<double>::zero();
    if (!is_free(i)) {
      for (int k = 0; k < 6; ++k) {
        const Vec3<double> e = unit3<double>(k % 3);
        set(6 + k, {k < 3 ? linear.change(e, o) : linear.change(o, e), o});
      }
      return;
    }
    const auto free = free_flight(b, c);
    const auto by_column = [&](int column, const double* force, std::ptrdiff_t stride) {
      double a[3] = {};
      for (int r = 0; r < 3; ++r)
        for (int s = 0; s < 6; ++s) a[r] += d.Minv[at + 3 + r + nv * (at + s)] * force[stride * s] / h;
      const Vec3<double> e = unit3<double>(column % 3);
      const Vec3<double> of_a = load3(static_cast<const double*>(a));
      set(column, free.change(column / 3 == 2 ? e : o, column / 3 == 3 ? e : o, of_a));
    };
    for (int k = 0; k < 6; ++k) {
      by_column(k, force(at) + at + k, mixed), by_column(6 + k, force(at) + nv + at + k, mixed);
      double unit[6] = {};
      unit[k] = 1, by_column(12 + k, unit, 1);
    }
  });
}
// Impulses act after free_flight.
integrator::FreeBodyFlight<double> StepJacobian::free_flight(const Body& b, const Vec3<double>& c) const {
  const Index at = b.user_v;
  double turned[3] = {};
  for (int r = 0; r < 3; ++r)
    for (int s = 0; s < 6; ++s) turned[r] += d.Minv[at + 3 + r + nv * (at + s)] * y.impulse[at + s];
  return {flight(b, c), integrator::central_inertia<double>(b, c),
          load3(static_cast<const double*>(x.v_end + at + 3)) - load3(static_cast<const double*>(turned))};
}

}  // namespace dyn::simulation
