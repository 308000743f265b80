// The linearised step (step_jacobian.hpp). Its parts: forces, rows and their equations, equalities, corrections, the end.
#pragma once

#include "algorithm/constrained/instance_derivatives.hpp"
#include "algorithm/external_forces.hpp"
#include "integrator/free_flight_derivatives.hpp"
#include "simulation/semi_implicit_euler.hpp"
#include "simulation/step_derivatives.hpp"
#include "solver/complete_pivoting.hpp"

namespace dyn::simulation {

using solver::add_row, solver::add_rows;

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

  // step_rows.cpp
  const char* find_rows();
  void find_twists(const double* of, Motion<double>* out) const;
  void differentiate_contact(JacobianContact& c) const;
  void add_bias(const JacobianContact& c, const ContactLaw& law) const;
  void add_gap(const JacobianContact& c, double factor, double* to) const;
  void add_restitution(const JacobianContact& c, const ContactLaw& law) const;
  void add_normal_rate(const JacobianContact& c, const Motion<double>* twists, double factor, double* rate, double* J) const;
  void differentiate_rows() const;
  void sum_impulses(double* impulse) const;

  // step_equalities.cpp
  const char* find_equalities();
  void add_equality_rows() const;
  solver::RankedLu factor_equalities(double softness) const;
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

  // step_forces.cpp
  void find_acceleration() const;
  void subtract_force(const JacobianContact& c, const Vec3<double>& force) const;
  integrator::Springs implicit_springs() const;
  void find_diagonal() const;
  void differentiate_forces() const;
  double command_slope(const ActuatorRecord& r) const;
  void add_force_change(Index body, Index j, const Force<double>& F) const;
  void differentiate_link_forces() const;
  void differentiate_impulse(const JacobianContact& c, const Vec3<double>& f) const;
  void solve_for_state() const;
  void add_flight(const double* impulse) const;

  static double square(double a) { return a * a; }
  static double stiffness(const ActuatorRecord& r) { return r.q >= 0 ? std::max(0.0, -r.bias[1]) : 0; }
  static double damping(const ActuatorRecord& r) { return std::max(0.0, -r.bias[2]); }

  // Calls f(degree of freedom, its motion at the body's origin) for those that move a body.
  template <class F>
  void for_each_mover(Index body, F&& f) const {
    for (Index i = body; i != 0; i = m.bodies()[i].parent)
      for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k) f(k, shift(d.S[k], d.rel[body]));
  }

  Motion<double> relative(const JacobianContact& c, const Motion<double>* twists) const {
    const auto at = [&](Index body) { return body ? shift(twists[body], c.position - root(body)) : Motion<double>::zero(); };
    return at(c.body_b) - at(c.body_a);
  }
  double* J(Index row) const { return y.J + nv * row; }
  double* E(Index row) const { return y.E + 2 * nv * row; }

  double compliance(const ContactLaw& law) const {
    const dynMaterial& material = law.material;
    return is_soft(material) ? 1 / (h * (h * material.stiffness + material.damping)) : 0;
  }

  // step_row_system.cpp
  void assemble() const;
  void slide(const JacobianContact& c) const;
  void flag_weak_rows(double margin) const;
  bool solve_rows() const;
  bool is_determined(const solver::RankedLu& lu) const;
  solver::RankedLu lu_of(Index n) const { return {y.factor, n, y.pivots, y.unknowns}; }

  bool with_equalities = false;  // their forces are known
  void differentiate_inverse_dynamics(const double* fext) const {
    columns_at(x.v, y.a);
    if (fext) subtract_external_at_root(m, d, fext);
    for (Index k = 0; k < contacts; ++k) subtract_force(y.contacts[k], y.contacts[k].force * (1 / h));
    if (with_equalities) subtract_constraint_forces(m, d);
    torque_derivatives(m, d, static_cast<const double*>(x.v), static_cast<const double*>(y.a));
  }

  // step_jacobian.cpp
  const char* differentiate(double margin);

  const char* correct();  // displacement with the correction of positions (step_correction.cpp)

  // displacement = d(h v')
  void displace() const {
    for (Index k = 0; k < nv * columns; ++k) y.displacement[k] = h * y.state[k];
  }

  // step_end.cpp
  void write() const;
  template <class J>
  void end_of_joint(const Body& b, std::ptrdiff_t c, double* out) const;

  Vec3<double> column_of(const double* rows, Index at, std::ptrdiff_t c) const {
    return Vec3<double>::make(rows[columns * at + c], rows[columns * (at + 1) + c], rows[columns * (at + 2) + c]);
  }
};

}  // namespace dyn::simulation
