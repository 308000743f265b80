// The linearised step (step_jacobian.hpp): its terms, the equations of its rows, and its end.
#pragma once

#include "algorithm/constrained/instance_derivatives.hpp"
#include "algorithm/external_forces.hpp"
#include "integrator/free_flight_derivatives.hpp"
#include "simulation/semi_implicit_euler.hpp"
#include "simulation/step_derivatives.hpp"

namespace dyn::simulation {

// to += factor from
inline void add_row(double* __restrict to, const double* __restrict from, double factor, std::ptrdiff_t n) {
  for (std::ptrdiff_t c = 0; c < n; ++c) to[c] += factor * from[c];
}

// to += sum of factors[stride l] from[l], rows of n numbers each `room` apart; rows with the factor 0 are left out.
inline void add_rows(double* __restrict to, const double* __restrict from, std::ptrdiff_t room, const double* factors,
                     std::ptrdiff_t stride, Index count, std::ptrdiff_t n) {
  const double* row[4];
  double by[4];
  int kept = 0;
  const auto flush = [&] {
    for (; kept < 4; ++kept) row[kept] = row[0], by[kept] = 0;
    const double *const a = row[0], *const b = row[1], *const c = row[2], *const e = row[3];
    for (std::ptrdiff_t k = 0; k < n; ++k) to[k] += by[0] * a[k] + by[1] * b[k] + by[2] * c[k] + by[3] * e[k];
    kept = 0;
  };
  for (Index l = 0; l < count; ++l) {
    if (factors[stride * l] == 0) continue;
    row[kept] = from + room * l, by[kept++] = factors[stride * l];
    if (kept == 4) flush();
  }
  if (kept) flush();
}

struct StepJacobian {
  const Model& m;
  Data<double>& d;
  StepDerivatives& x;
  JacobianArrays& y = x.jacobian;
  const Workspace& w = *d.step;
  const double h = w.options.dt;
  const std::ptrdiff_t nv = m.n.nv, mixed = 2 * nv + m.n.nu, columns = derivative_count(m);  // q, v, controls, then tau
  Index rows = 0, contacts = 0, equality0 = 0, equalities = 0;  // equality0: first row of the equalities

  double* state(Index k) const { return y.state + columns * k; }
  double* displacement(Index k) const { return y.displacement + columns * k; }
  double ratio(Index k) const { return user_ratio<double>(m, k); }  // of an expanded degree of freedom in the user's
  void columns_at(const double* v, const double* a) const {
    derivative_columns(m, d, d.expand(m, v, d.vx), d.expand(m, a, d.ax));
  }
  Vec3<double> root(Index body) const { return d.p[body] - d.rel[body]; }  // of the body's tree

  // Calls f(degree of freedom, its motion at the point, twist of the parent, whether it moves B) for those that move one of the
  // two bodies alone.
  template <class F>
  void for_each_dof(const JacobianContact& c, const Motion<double>* twists, F&& f) const {
    const Index common = common_body(m, c.body_a, c.body_b);
    for (const bool of_b : {true, false})
      for (Index i = of_b ? c.body_b : c.body_a; i != common; i = m.bodies()[i].parent)
        for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k)
          f(k, shift(d.S[k], c.position - root(i)), twists[m.bodies()[i].parent], of_b);
  }
  // How the contact turns and moves with a motion at its point.
  static Motion<double> moved(const JacobianContact& c, const Motion<double>& S, bool of_b) {
    const ContactGeometry& g = c.geometry;
    const Vec3<double> turn = g.by_step.turn * S.linear + g.by_turn.turn * S.angular,
                       move = g.by_step.move * S.linear + g.by_turn.move * S.angular;
    return of_b ? Motion<double>{move, turn} : Motion<double>{S.linear - move, S.angular - turn};
  }

  // Contacts and limits that press. Returns why they are not covered, or nullptr.
  const char* find_rows() {
    for (Index k = 0; k < x.modes.count; ++k) {
      if (x.modes.modes[k] == DYN_CONTACT_MODE_OPEN) continue;
      const ContactLaw& law = w.laws[k];
      if (law.rows > 3) return "a contact has torsion or rolling friction";
      const collision::Geom &a = d.geoms[law.geom_a], &b = d.geoms[law.geom_b];
      const auto flat = [](const collision::Geom& g) { return g.shape.type == shape::Type::HalfSpace; };
      if (!flat(a) && !flat(b) &&
          x.modes.contacts[k].contact.distance > tuning::search::touching * std::min(a.bounding_radius, b.bounding_radius))
        return "shapes that were apart at the beginning of the step meet";
      const bool friction = law.rows == 3 && law.material.friction > 0;
      if (rows + 3 > jacobian_rows(m)) return "too many rows";
      JacobianContact& c = y.contacts[contacts++];
      c.contact = k, c.body_a = a.body, c.body_b = b.body, c.first = rows;
      c.position = load3(x.modes.contacts[k].contact.position), c.force = load3(x.modes.contacts[k].force_on_b) * h;
      c.slip_a = surface_velocity(d, law.geom_a), c.slip_b = surface_velocity(d, law.geom_b);
      if (!contact_geometry(m, d, x.modes.contacts[k].contact, law, c.geometry))
        return "a contact point has no counterpart where its shapes move";
      const auto add = [&](Index axis) {
        y.rows[rows++] = {axis == 2 ? JacobianRowKind::Normal : JacobianRowKind::Stick, contacts - 1, axis,
                          dot(c.force, law.axes[axis])};
      };
      add(2);
      if (friction) add(0), add(1);
    }
    for (Index k = 0; k < m.n.limits; ++k) {
      if (w.limit_forces[k] == 0) continue;
      if (rows == jacobian_rows(m)) return "too many rows";
      y.rows[rows++] = {JacobianRowKind::Limit, k, 0, std::abs(w.limit_forces[k]) * h};
    }
    return find_equalities();
  }
  // step_equalities.cpp
  const char* find_equalities();
  void add_equality_rows() const;
  void factor_equalities(double softness) const;
  const char* find_equality_impulses() const;
  void differentiate_equality_forces() const;
  KktSystem<double> equality_system() const;
  void differentiate_equality_rates() const;
  const char* correct_drift() const;

  // What free_flight adds to the velocity of bodies with children.
  integrator::FlightCorrection<double> flight(const Body& b, const Vec3<double>& c) const {
    return {load3(x.v + b.user_v), load3(x.v + b.user_v + 3), c, h};
  }
  bool is_free(Index body) const { return m.subtree_end()[body] == body + 1 && m.bodies()[body].m > 0; }
  void find_acceleration() const {
    for (Index k = 0; k < nv; ++k) y.a[k] = (x.v_end[k] - x.v[k]) / h;
    integrator::for_each_free_flyer<double>(m, WholeModel{}, [&](const Body& b, Index i, const Vec3<double>& c) {
      if (is_free(i)) return;
      store3(load3(static_cast<const double*>(y.a + b.user_v)) - flight(b, c).value() * (1 / h), y.a + b.user_v);
    });
  }

  // A force on B, and the opposite on A.
  void subtract_force(const JacobianContact& c, const Vec3<double>& force) const {
    const auto subtract = [&](Index body, const Vec3<double>& f) {
      if (body)
        d.composite[body].f = d.composite[body].f - shift(Force<double>{f, Vec3<double>::zero()}, c.position - root(body));
    };
    subtract(c.body_b, force), subtract(c.body_a, force * -1.0);
  }

  // The implicit part of the inertia, and its derivative by v.
  integrator::Springs implicit_springs() const {
    using integrator::Springs;
    return !(d.acting & DYN_EFFECT_SPRINGS)                       ? Springs::None
           : w.options.integrator == DYN_INTEGRATOR_IMPLICIT_FAST ? Springs::All
                                                                  : Springs::Stiff;
  }
  void find_diagonal() const {
    std::fill_n(y.diagonal, nv, 0.0), std::fill_n(y.diagonal_by_v, nv, 0.0);
    for_each_velocity_law(d, [&]<class E>(const double* c) {
      for (Index k = 0; k < nv; ++k)
        y.diagonal[k] += E::secant(h * c[k], x.v[k]), y.diagonal_by_v[k] += E::secant_slope(h * c[k], x.v[k]);
    });
    integrator::implicit_springs(m, d, h, implicit_springs(),
                                 [&](Index k, double stiffness) { y.diagonal[k] += h * h * stiffness; });
    for_each_actuator(m, d, [&](const ActuatorRecord& r, Index k) {
      if (!d.saturated[k]) y.diagonal[r.v] += square(r.spec.gear) * (h * damping(r) + h * h * stiffness(r));
    });
  }
  static double square(double a) { return a * a; }
  static double stiffness(const ActuatorRecord& r) { return r.q >= 0 ? std::max(0.0, -r.bias[1]) : 0; }
  static double damping(const ActuatorRecord& r) { return std::max(0.0, -r.bias[2]); }

  // displacement = h times the derivatives of the forces at fixed impulses
  void differentiate_forces() const {
    std::fill_n(y.displacement, nv * columns, 0.0);
    for (Index k = 0; k < nv; ++k) {
      double* const to = displacement(k);
      for (Index j = 0; j < nv; ++j) to[j] = -h * d.dtau_dq[k + nv * j], to[nv + j] = -h * d.dtau_dv[k + nv * j];
      to[nv + k] -= h * y.diagonal_by_v[k] * y.a[k];
    }
    integrator::implicit_springs(m, d, h, implicit_springs(),
                                 [&](Index k, double stiffness) { displacement(k)[nv + k] -= h * h * stiffness; });
    for_each_actuator(m, d, [&](const ActuatorRecord& r, Index k) {
      if (d.saturated[k]) return;
      const double by = h * r.spec.gear;
      double* const to = displacement(r.v);
      if (r.q >= 0) to[r.v] += by * r.bias[1] * r.spec.gear;
      to[nv + r.v] += by * r.spec.gear * (r.bias[2] - h * stiffness(r));
      double* const u = to + 2 * nv + r.spec.idx_u;
      if (r.spec.controls > 0) u[0] += by * r.gain[0] * command_slope(r);
      if (r.spec.controls == 3) u[1] += by * r.gain[1], u[2] += by * r.gain[2];
    });
  }
  // Of what drives an actuator, by its control.
  double command_slope(const ActuatorRecord& r) const {
    const double u = d.ctrl[r.spec.idx_u], held = clamp_to(u, r.spec.control_range);
    if (held != u) return 0;
    if (r.act < 0) return 1;
    if (acts_late(r, d)) return 0;
    const double slope = r.spec.integrates ? h : 1 - math::exp(-h / r.spec.time_constant);
    const double next = activation_after(r, d, d.act[r.act], h);
    return next > r.spec.act_range[0] && next < r.spec.act_range[1] ? slope : 0;
  }

  // F: change along q_j of an impulse on a body, at its tree's root, beyond what it carries along.
  void add_force_change(Index body, Index j, const Force<double>& F) const {
    for (Index i = body; i != 0; i = m.bodies()[i].parent)
      for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k)
        displacement(user_dof(m, k))[user_dof(m, j)] += ratio(k) * ratio(j) * dot(d.S[k], F);
  }
  // Calls f(degree of freedom, its motion at the body's origin) for those that move a body.
  template <class F>
  void for_each_mover(Index body, F&& f) const {
    for (Index i = body; i != 0; i = m.bodies()[i].parent)
      for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k) f(k, shift(d.S[k], d.rel[body]));
  }
  // Wrenches and gravity compensation: of forces in world axes inverse dynamics takes the axes for the body's.
  void differentiate_link_forces() const {
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
  void differentiate_impulse(const JacobianContact& c, const Vec3<double>& f) const {
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
  void solve_for_state() const {
    for (Index k = 0; k < nv; ++k) {
      double* const to = state(k);
      const double* const row = d.Minv + nv * k;
      std::fill_n(to, mixed, 0.0);
      add_rows(to, y.displacement, columns, row, 1, Index(nv), mixed);
      for (Index l = 0; l < nv; ++l) to[mixed + l] = h * row[l];
      to[nv + k] += 1;
    }
  }
  // Before solve_for_state: derivatives of ddq by the state and the forces of bodies that fly alone, of the angular part.
  // After it: delta of free flyers.
  void add_flight(const double* impulse) const {
    integrator::for_each_free_flyer<double>(m, WholeModel{}, [&](const Body& b, Index i, const Vec3<double>& c) {
      const Index at = b.user_v;
      const auto add = [&](const integrator::FreeBodyFlight<double>::Change& by, std::ptrdiff_t column) {
        for (int k = 0; k < 3; ++k) state(at + k)[column] += by.linear[k], state(at + 3 + k)[column] += by.angular[k];
      };
      const auto linear = flight(b, c);
      const Vec3<double> o = Vec3<double>::zero();
      if (!is_free(i)) {
        for (int k = 0; k < 6; ++k) {
          const Vec3<double> e = unit3<double>(k % 3);
          add({k < 3 ? linear.change(e, o) : linear.change(o, e), o}, nv + at + k);
        }
        return;
      }
      const auto block = [&](int r, int s) { return d.Minv[at + r + nv * (at + s)]; };
      double turned[3] = {};
      for (int r = 0; r < 3; ++r)
        for (int s = 0; s < 6; ++s) turned[r] += block(3 + r, s) * impulse[at + s];
      const integrator::FreeBodyFlight<double> free{
          linear, integrator::central_inertia<double>(b, c),
          load3(static_cast<const double*>(x.v_end + at + 3)) - load3(static_cast<const double*>(turned))};
      // columns of the body's own q, v and tau
      const auto by_column = [&](std::ptrdiff_t column, const double* force, std::ptrdiff_t stride, double scale, int of_v) {
        double a[3] = {};
        for (int r = 0; r < 3; ++r)
          for (int s = 0; s < 6; ++s) a[r] += block(3 + r, s) * force[stride * s] * scale;
        const Vec3<double> e = of_v < 0 ? o : unit3<double>(of_v % 3);
        add(free.change(of_v >= 0 && of_v < 3 ? e : o, of_v >= 3 ? e : o, load3(static_cast<const double*>(a))), column);
      };
      for (int k = 0; k < 6; ++k) {
        by_column(at + k, d.dtau_dq + at + nv * (at + k), 1, -1, -1);
        by_column(nv + at + k, d.dtau_dv + at + nv * (at + k), 1, -1, k);
        double unit[6] = {};
        unit[k] = 1;
        by_column(mixed + at + k, unit, 1, 1, -1);
      }
    });
  }

  void find_twists(const double* of, Motion<double>* out) const {
    const double* const v = d.expand(m, of, d.ax);
    out[0] = Motion<double>::zero();
    for (Index i = 1; i < m.n.bodies; ++i) {
      Motion<double> V = out[m.bodies()[i].parent];
      for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k) V = V + d.S[k] * v[k];
      out[i] = V;
    }
  }
  Motion<double> relative(const JacobianContact& c, const Motion<double>* twists) const {
    const auto at = [&](Index body) { return body ? shift(twists[body], c.position - root(body)) : Motion<double>::zero(); };
    return at(c.body_b) - at(c.body_a);
  }
  double* J(Index row) const { return y.J + nv * row; }
  double* E(Index row) const { return y.E + 2 * nv * row; }

  // J, and E: the derivative of the row's velocity and bias by q and v at fixed v'.
  void differentiate_contact(JacobianContact& c) const {
    const ContactLaw& law = w.laws[c.contact];
    const Index count = law.rows == 3 && law.material.friction > 0 ? 3 : 1;
    const Motion<double> U = relative(c, y.twists);
    c.relative = U;
    const Vec3<double> slip = c.slip_b - c.slip_a;
    for_each_dof(c, y.twists, [&](Index j, const Motion<double>& S, const Motion<double>& parent, bool of_b) {
      const Motion<double> by = moved(c, S, of_b);
      const Index body = of_b ? c.body_b : c.body_a;
      const double sign = of_b ? 1 : -1;
      const Motion<double> own = shift(parent - y.twists[body], c.position - root(body));
      const Vec3<double> change = cross(own, S).linear * sign + cross(U.angular, by.linear);
      for (Index r = 0; r < count; ++r) {
        const Index axis = y.rows[c.first + r].axis;
        const Vec3<double>& e = law.axes[axis];
        const Vec3<double> belt = axis == 2 ? Vec3<double>::zero() : slip,
                           turned = axis == 2 ? belt : cross(S.angular, of_b ? c.slip_b : c.slip_a) * sign;
        J(c.first + r)[user_dof(m, j)] += ratio(j) * sign * dot(e, S.linear);
        E(c.first + r)[user_dof(m, j)] += ratio(j) * (dot(e, change + turned) + dot(cross(by.angular, e), U.linear + belt));
      }
    });
    std::copy_n(E(c.first), nv, y.rate + nv * c.first);
    add_bias(c, law);
    if (count == 1) return;
    const double t[2] = {dot(law.axes[0], U.linear + slip), dot(law.axes[1], U.linear + slip)};
    c.sliding = std::sqrt(t[0] * t[0] + t[1] * t[1]);
    const JacobianRow* const row = y.rows + c.first;
    const double bound = law.material.friction * row[0].lambda,
                 held = std::sqrt(row[1].lambda * row[1].lambda + row[2].lambda * row[2].lambda);
    constexpr double rounding = 1e-7, still = 1e-9;
    if (!(held >= bound * (1 - rounding) && c.sliding > still)) return;
    for (int k = 0; k < 2; ++k) c.direction[k] = t[k] / c.sliding, y.rows[c.first + 1 + k].kind = JacobianRowKind::Slide;
  }
  // Of the normal row: see fill_contact (island.cpp).
  void add_bias(const JacobianContact& c, const ContactLaw& law) const {
    const double gap = x.modes.contacts[c.contact].contact.distance;
    if (x.modes.modes[c.contact] == DYN_CONTACT_MODE_IMPACT) return add_restitution(c, law);
    const dynMaterial& material = law.material;
    const double total = h * material.stiffness + material.damping;
    const double by_gap = gap > 0 ? 1 / h : is_soft(material) ? material.stiffness / total : 0;
    if (by_gap != 0) add_gap(c, by_gap, E(c.first));
  }
  // to += factor times the derivative of the gap by q.
  void add_gap(const JacobianContact& c, double factor, double* to) const {
    const ContactGeometry& g = c.geometry;
    for_each_dof(c, y.twists, [&](Index j, const Motion<double>& S, const Motion<double>&, bool of_b) {
      const double by = dot(g.by_step.gap, S.linear) + dot(g.by_turn.gap, S.angular);
      to[user_dof(m, j)] += (of_b ? factor : -factor) * ratio(j) * by;
    });
  }
  double compliance(const ContactLaw& law) const {
    const dynMaterial& material = law.material;
    return is_soft(material) ? 1 / (h * (h * material.stiffness + material.damping)) : 0;
  }
  void add_restitution(const JacobianContact& c, const ContactLaw& law) const {
    const double e = law.material.restitution;
    add_normal_rate(c, y.twists_before, e, E(c.first), nullptr);
    add_row(E(c.first) + nv, J(c.first), e, nv);
  }
  // rate += factor times the derivative by q of the normal velocity that the twists make; J += the normal row.
  void add_normal_rate(const JacobianContact& c, const Motion<double>* twists, double factor, double* rate, double* J) const {
    const Vec3<double> n = load3(x.modes.contacts[c.contact].contact.normal);
    const Motion<double> U = relative(c, twists);
    for_each_dof(c, twists, [&](Index j, const Motion<double>& S, const Motion<double>& parent, bool of_b) {
      const Motion<double> by = moved(c, S, of_b);
      const Index body = of_b ? c.body_b : c.body_a;
      const double sign = of_b ? 1 : -1;
      const Motion<double> own = shift(parent - twists[body], c.position - root(body));
      const Vec3<double> change = cross(own, S).linear * sign + cross(U.angular, by.linear);
      rate[user_dof(m, j)] += factor * ratio(j) * (dot(n, change) + dot(cross(by.angular, n), U.linear));
      if (J) J[user_dof(m, j)] += ratio(j) * sign * dot(n, S.linear);
    });
  }
  void differentiate_rows() const {
    std::fill_n(y.J, rows * nv, 0.0), std::fill_n(y.E, rows * 2 * nv, 0.0), std::fill_n(y.rate, rows * nv, 0.0);
    for (Index k = 0; k < contacts; ++k) differentiate_contact(y.contacts[k]);
    for (Index r = 0; r < rows; ++r) {
      if (y.rows[r].kind != JacobianRowKind::Limit) continue;
      const LimitRecord& limit = m.limits()[y.rows[r].of];
      const bool low = w.limit_forces[y.rows[r].of] > 0;
      const double gap = low ? x.q[limit.q] - m.lower_limit()[limit.q] : m.upper_limit()[limit.q] - x.q[limit.q];
      const Index dof = user_dof(m, limit.dof);
      J(r)[dof] = low ? 1 : -1;
      if (gap > 0) E(r)[dof] = J(r)[dof] / h;
    }
    if (equalities > 0) add_equality_rows(), differentiate_equality_rates();
  }

  // K dlambda = -(J dv' + E): sticking and pressed rows. Sliding ones follow.
  void assemble() const {
    for (Index r = 0; r < rows; ++r) {
      double *const z = y.Z + nv * r, *const b = y.wanted + columns * r;
      std::fill_n(z, nv, 0.0), std::fill_n(b, columns, 0.0);
      add_rows(z, d.Minv, nv, J(r), 1, Index(nv), nv);
      add_rows(b, y.state, columns, J(r), 1, Index(nv), columns);
      for (std::ptrdiff_t c = 0; c < 2 * nv; ++c) b[c] += E(r)[c];
      for (std::ptrdiff_t c = 0; c < columns; ++c) b[c] = -b[c];
    }
    for (Index r = 0; r < rows; ++r)
      for (Index s = 0; s < rows; ++s) {
        double sum = 0;
        for (Index k = 0; k < nv; ++k) sum += J(r)[k] * y.Z[nv * s + k];
        y.K[rows * r + s] = sum;
      }
    for (Index k = 0; k < contacts; ++k) {
      const JacobianContact& c = y.contacts[k];
      y.K[(rows + 1) * c.first] += compliance(w.laws[c.contact]);
      if (c.first + 1 < rows && y.rows[c.first + 1].kind == JacobianRowKind::Slide) slide(c);
    }
  }
  // dlambda_t + mu e dlambda_n + mu lambda_n / |u| (1 - e e^T) du = 0, with du = K dlambda - b
  void slide(const JacobianContact& c) const {
    const double mu = w.laws[c.contact].material.friction, by = mu * y.rows[c.first].lambda / c.sliding;
    double *const K0 = y.K + rows * (c.first + 1), *const K1 = K0 + rows;
    double *const b0 = y.wanted + columns * (c.first + 1), *const b1 = b0 + columns;
    const double p[2] = {-c.direction[1] * by, c.direction[0] * by};  // (1 - e e^T) = n n^T with n across e
    const double n[2] = {-c.direction[1], c.direction[0]};
    const auto combine = [&](double* a, double* b, std::ptrdiff_t count) {
      for (std::ptrdiff_t k = 0; k < count; ++k) {
        const double across = n[0] * a[k] + n[1] * b[k];
        a[k] = p[0] * across, b[k] = p[1] * across;
      }
    };
    combine(K0, K1, rows), combine(b0, b1, columns);
    K0[c.first + 1] += 1, K1[c.first + 2] += 1;
    K0[c.first] += mu * c.direction[0], K1[c.first] += mu * c.direction[1];
  }

  // lambda = K^-1 wanted. Where K is singular, with a little regularisation, refined. Returns whether the equations are
  // consistent and determine the motion.
  bool solve_rows() const {
    constexpr double softness = 1e-10, floor = 1e-14, independent = 1e-9, consistent = 1e-6;
    constexpr int refinements = 2;
    std::copy_n(y.K, rows * rows, y.factor);
    if (factor_rows(y.factor, rows) > independent) {
      std::copy_n(y.wanted, rows * columns, y.lambda);
      return substitute(y.factor, rows, y.lambda, columns), true;
    }
    double size = 0;
    for (Index r = 0; r < rows; ++r) size = std::max(size, std::abs(y.K[(rows + 1) * r]));
    std::copy_n(y.K, rows * rows, y.factor);
    for (Index r = 0; r < rows; ++r) y.factor[(rows + 1) * r] += softness * y.K[(rows + 1) * r] + floor * size;
    factor_rows(y.factor, rows);
    const auto largest = [&](const double* a) {
      double most = 0;
      for (Index k = 0; k < rows * columns; ++k) most = std::max(most, std::abs(a[k]));
      return most;
    };
    std::fill_n(y.lambda, rows * columns, 0.0);
    for (int n = 0;; ++n) {
      std::copy_n(y.wanted, rows * columns, y.rest);
      for (Index r = 0; r < rows; ++r)
        for (Index s = 0; s < (n ? rows : 0); ++s)
          add_row(y.rest + columns * r, y.lambda + columns * s, -y.K[rows * r + s], columns);
      if (n > refinements) return largest(y.rest) <= consistent * largest(y.wanted) && is_determined();
      substitute(y.factor, rows, y.rest, columns);
      for (Index k = 0; k < rows * columns; ++k) y.lambda[k] += y.rest[k];
    }
  }
  // Whether impulses that the rows leave open move nothing: sliding contacts may share a load in ways that turn a body
  // differently.
  bool is_determined() const {
    constexpr double open = 1e6, moves = 1e-4;
    double size = 0, impulses = 0, motion = 0, moved = 0;
    for (Index r = 0; r < rows; ++r) {
      size = std::max(size, std::abs(y.K[(rows + 1) * r]));
      y.rest[columns * r] = 1 + 0.37 * double((7 * r) % 11);  // of no symmetry
      std::fill_n(y.rest + columns * r + 1, columns - 1, 0.0);
    }
    substitute(y.factor, rows, y.rest, columns);
    for (Index r = 0; r < rows; ++r) impulses = std::max(impulses, std::abs(y.rest[columns * r]));
    if (!(impulses * size > open)) return true;
    for (Index k = 0; k < nv; ++k) {
      double sum = 0, all = 0;
      for (Index r = 0; r < rows; ++r) {
        const double by = y.Z[nv * r + k] * y.rest[columns * r];
        sum += by, all += std::abs(by);
      }
      motion = std::max(motion, std::abs(sum)), moved = std::max(moved, all);
    }
    return motion <= moves * moved;
  }
  // Gauss with row pivots, in place. Returns the least pivot over the largest.
  double factor_rows(double* F, Index rows) const {
    double least = HUGE_VAL, most = 0;
    for (Index k = 0; k < rows; ++k) {
      Index pivot = k;
      for (Index r = k + 1; r < rows; ++r)
        if (std::abs(F[rows * r + k]) > std::abs(F[rows * pivot + k])) pivot = r;
      y.pivots[k] = pivot;
      if (pivot != k) std::swap_ranges(F + rows * k, F + rows * (k + 1), F + rows * pivot);
      double& own = F[rows * k + k];
      least = std::min(least, std::abs(own)), most = std::max(most, std::abs(own));
      if (own == 0) own = 1;
      for (Index r = k + 1; r < rows; ++r)
        if (double& by = F[rows * r + k]; by != 0)
          by /= own, add_row(F + rows * r + k + 1, F + rows * k + k + 1, -by, rows - k - 1);
    }
    return most > 0 ? least / most : 0;
  }
  // b, rows x columns, becomes the solution of a factored matrix.
  void substitute(const double* F, Index rows, double* b, std::ptrdiff_t columns) const {
    for (Index k = 0; k < rows; ++k) {
      if (y.pivots[k] != k) std::swap_ranges(b + columns * k, b + columns * (k + 1), b + columns * y.pivots[k]);
      double* const to = b + columns * k;
      for (std::ptrdiff_t c = 0; c < columns; ++c) to[c] = -to[c];
      add_rows(to, b, columns, F + rows * k, 1, k, columns);
      for (std::ptrdiff_t c = 0; c < columns; ++c) to[c] = -to[c];
    }
    for (Index k = rows - 1; k >= 0; --k) {
      double* const to = b + columns * k;
      for (std::ptrdiff_t c = 0; c < columns; ++c) to[c] = -to[c];
      add_rows(to, b + columns * (k + 1), columns, F + rows * k + k + 1, 1, rows - k - 1, columns);
      const double by = -1 / F[rows * k + k];
      for (std::ptrdiff_t c = 0; c < columns; ++c) to[c] *= by;
    }
  }

  // impulse = J^T lambda, before J exists.
  void sum_impulses(double* impulse) const {
    std::fill_n(impulse, nv, 0.0);
    for (Index k = 0; k < contacts; ++k) {
      const JacobianContact& c = y.contacts[k];
      for_each_dof(c, y.twists, [&](Index j, const Motion<double>& S, const Motion<double>&, bool of_b) {
        impulse[user_dof(m, j)] += (of_b ? 1 : -1) * ratio(j) * dot(c.force, S.linear);
      });
    }
  }
  bool with_equalities = false;  // their forces are known
  void differentiate_inverse_dynamics(const double* fext) const {
    columns_at(x.v, y.a);
    if (fext) subtract_external_at_root(m, d, fext);
    for (Index k = 0; k < contacts; ++k) subtract_force(y.contacts[k], y.contacts[k].force * (1 / h));
    if (with_equalities) subtract_constraint_forces(m, d);
    torque_derivatives(m, d, static_cast<const double*>(x.v), static_cast<const double*>(y.a));
  }
  // All of it. Returns why it is not possible, or nullptr.
  const char* differentiate() {
    find_acceleration();
    const double* const fext = forces_on_bodies(m, d);
    differentiate_inverse_dynamics(fext);
    find_twists(x.v_end, y.twists), find_twists(x.v, y.twists_before);
    find_diagonal();
    for (Index k = 0; k < nv; ++k) d.M[(nv + 1) * k] += y.diagonal[k];
    if (factorize(m, d)) return "the inertia is singular";
    invert(m, d);
    if (equalities > 0) {
      if (const char* const reason = find_equality_impulses()) return reason;
      with_equalities = true, differentiate_inverse_dynamics(fext);
      differentiate_equality_forces();
    }
    differentiate_forces();
    if (equalities > 0) std::fill_n(d.dtau_dq, nv * nv, 0.0);  // inverse dynamics leaves entries of unrelated joints as they are
    if (fext) differentiate_link_forces();
    for (Index k = 0; k < contacts; ++k) differentiate_impulse(y.contacts[k], y.contacts[k].force);
    solve_for_state();
    sum_impulses(y.a), add_flight(y.a);
    if (rows > 0) {
      differentiate_rows(), assemble();
      if (!solve_rows())
        for (Index k = 0; k < contacts; ++k) x.modes.degenerate[y.contacts[k].contact] = 1;
      for (Index k = 0; k < nv; ++k) add_rows(state(k), y.lambda, columns, y.Z + k, nv, rows, columns);
    }
    if (w.corrected || equalities > 0) {
      if (const char* const reason = correct()) return reason;
    } else {
      displace();
    }
    write();
    return nullptr;
  }

  const char* correct();  // displacement with the correction of positions (step_correction.cpp)

  // displacement = d(h v')
  void displace() const {
    for (Index k = 0; k < nv * columns; ++k) y.displacement[k] = h * y.state[k];
  }
  // The end of the step, q' = q (+) displacement, into x.by.
  void write() const {
    const Index nu = m.n.nu;
    const auto to = [&](std::ptrdiff_t column) {  // of the result: q, v, tau, controls
      const std::ptrdiff_t at = column < 2 * nv ? column : column < mixed ? column + nv : column - nu;
      return x.by + 2 * nv * at;
    };
    const auto own = [&](Index at, Index k, std::ptrdiff_t column) { return column == at + k ? 1.0 : 0.0; };
    for (std::ptrdiff_t c = 0; c < columns; ++c) {
      double* const out = to(c);
      for (Index k = 0; k < nv; ++k) out[k] = displacement(k)[c] + own(0, k, c), out[nv + k] = state(k)[c];
    }
    for_each_factor(
        m, [](Index, Index, Index) {},
        [&]<class J>(const Body& b) {
          if constexpr (J::nv > 1)
            for (std::ptrdiff_t c = 0; c < columns; ++c) end_of_joint<J>(b, c, to(c));
        });
  }
  Vec3<double> column_of(const double* rows, Index at, std::ptrdiff_t c) const {
    return Vec3<double>::make(rows[columns * at + c], rows[columns * (at + 1) + c], rows[columns * (at + 2) + c]);
  }
  template <class J>
  void end_of_joint(const Body& b, std::ptrdiff_t c, double* out) const {
    const Index at = b.user_v;
    double own[J::nv] = {};
    if (c >= at && c < at + J::nv) own[c - at] = 1;
    const Vec3<double> turn = column_of(y.displacement, at + J::nv - 3, c);
    if constexpr (J::nv == 3) {
      const Vec3<double> w =
          load3(static_cast<const double*>(x.v_end + at)) * h + load3(static_cast<const double*>(y.correction + at));
      store3(exp3(w * -1.0) * load3(static_cast<const double*>(own)) + Jexp3(w) * turn, out + at);
    } else {
      const Motion<double> v = load_motion(static_cast<const double*>(x.v_end + at)),
                           correction = load_motion(static_cast<const double*>(y.correction + at));
      const auto end = integrator::FlightEnd<double>::of(b.m > 0 ? b.h * (1 / b.m) : Vec3<double>::zero(), v, correction, h);
      const Motion<double> dv{column_of(y.state, at, c), column_of(y.state, at + 3, c)},
          by = Motion<double>{column_of(y.displacement, at, c), turn} - dv * h;
      const auto change = end.change(load_motion(static_cast<const double*>(own)), dv, by);
      store6(change.q, out + at), store6(change.v, out + nv + at);
    }
  }
};

}  // namespace dyn::simulation
