// The linearised step (step_jacobian.hpp). Its parts: forces, rows and their equations, equalities, corrections, the end.
#pragma once

#include "algorithm/constrained/instance_derivatives.hpp"
#include "algorithm/external_forces.hpp"
#include "integrator/free_flight_derivatives.hpp"
#include "simulation/semi_implicit_euler.hpp"
#include "simulation/step_derivatives.hpp"
#include "solver/complete_pivoting.hpp"

namespace dyn::simulation {

using solver::add_product, solver::add_row, solver::add_rows, solver::largest_of;

struct StepJacobian {
  const Model& m;
  Data<double>& d;
  StepDerivatives& x;
  JacobianArrays& y = x.jacobian;
  const Workspace& w = *d.step;
  const double h = w.options.dt;
  const std::ptrdiff_t nv = m.n.nv, mixed = 2 * nv + m.n.nu;
  bool along = false;                            // of one direction, y.direction and y.given
  std::ptrdiff_t columns = 3 * nv;               // q, v, tau; or 1
  Index rows = 0, contacts = 0, equality0 = 0, equalities = 0;  // equality0: first row of the equalities
  solver::RankedLu system{};                                    // of the rows
  Index corrections = 0, pushed = 0;  // rows of corrections, and those whose mu was positive
  bool exact = false;                 // their matrix is differentiated
  double* forces = y.force;           // to which add_force_change adds

  double* state(Index k) const { return y.state + columns * k; }
  void clear_given() const {
    const StepChange& x = y.given;
    for (double* array : {x.force, x.velocity, x.displacement, x.end, x.end + nv}) std::fill_n(array, nv, 0.0);
    for (double* array : {x.row, x.slide}) std::fill_n(array, rows, 0.0);
    std::fill_n(x.wrong, corrections, 0.0);
    if (exact) std::fill_n(x.G, exact_corrections(m) * exact_corrections(m), 0.0);
  }
  double* displacement(Index k) const { return y.displacement + columns * k; }
  double* force(Index k) const { return y.force + mixed * k; }
  static double inner(const double* a, const double* b, std::ptrdiff_t n) {
    double sum = 0;
    for (std::ptrdiff_t k = 0; k < n; ++k) sum += a[k] * b[k];
    return sum;
  }
  // to += factor times a row by (q, v, ..) of n entries.
  void add_by_state(double* to, const double* row, double factor, std::ptrdiff_t n) const {
    if (along) to[0] += factor * inner(row, y.direction, n);
    else add_row(to, row, factor, n);
  }
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
  void add_bias(JacobianContact& c, const ContactLaw& law) const;
  void add_gap(const JacobianContact& c, double factor, double* to) const;
  void add_restitution(JacobianContact& c, const ContactLaw& law) const;
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
  // Calls f(row, its derivatives of delta, column(c) of each in y.direction) for the degrees of freedom of free flyers.
  template <class F>
  void for_each_flight(F&& f) const {
    integrator::for_each_free_flyer<double>(m, WholeModel{}, [&](const Body& b, Index, const Vec3<double>&) {
      const Index at = b.user_v;
      const auto column = [&](int c) { return at + c % 6 + (c < 6 ? 0 : c < 12 ? nv : mixed); };
      for (Index row = at; row < at + 6; ++row) f(row, static_cast<const double*>(y.flight + flight_columns * row), column);
    });
  }

  // step_forces.cpp
  void find_acceleration() const;
  void subtract_force(const JacobianContact& c, const Vec3<double>& force) const;
  integrator::Springs implicit_springs() const;
  void find_diagonal() const;
  // step_paths.cpp
  static const char* find_path_reason(const Model& m, const Data<double>& d);
  void add_path_inertia() const;
  void differentiate_path_forces() const;
  void subtract_path_impulses(double* from) const;

  void differentiate_forces() const;
  double command_slope(const ActuatorRecord& r) const;
  void add_force_change(Index body, Index j, const Force<double>& F) const;
  void differentiate_link_forces() const;
  void differentiate_impulse(const JacobianContact& c, const Vec3<double>& f) const;
  void solve_for_state() const;
  void solve_along() const;
  void transpose_state() const;
  void find_flight() const;
  integrator::FreeBodyFlight<double> free_flight(const Body& b, const Vec3<double>& c) const;

  static double square(double a) { return a * a; }

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
  void find_wanted() const;
  void flag_weak_rows(double margin) const;
  void factor_rows();
  bool solve_rows() const;
  bool is_determined() const;
  void transpose_rows() const;
  static void turn_rows(double* first, double* second, const double* e, double by, std::ptrdiff_t n);
  // Calls f(contact, its first tangent row, sliding direction, mu lambda_n / |u|) for those that slide.
  template <class F>
  void for_each_sliding(F&& f) const {
    for (Index k = 0; k < contacts; ++k) {
      const JacobianContact& c = y.contacts[k];
      if (c.first + 1 >= rows || y.rows[c.first + 1].kind != JacobianRowKind::Slide) continue;
      f(c, c.first + 1, static_cast<const double*>(c.direction),
        w.laws[c.contact].material.friction * y.rows[c.first].lambda / c.sliding);
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

  // step_jacobian.cpp
  const char* linearise(double margin);
  bool apply();
  void apply_transposed(const double* gradient);
  void probe_rows();
  void flag_contacts() const;

  // step_products.cpp
  void multiply(const StepProducts& p);
  double product_with_given() const;

  // step_parameters.cpp
  const char* find_parameters(const StepProducts& p) const;
  void find_free_acceleration() const;
  void add_parameter(const StepParameter& p, Index component, double factor) const;
  void add_inertia(Index joint, Index component, double factor) const;
  void add_centre(const Body& b, Index i, const Vec3<double>& c, const Vec3<double>& dc, const Mat3<double>& dI,
                  double factor) const;
  void add_gravity(const Vec3<double>& along, double factor) const;
  void add_largest_correction(double speed, double length) const;
  void add_body_force(Index body, const Force<double>& F, double factor, double* to) const;
  Force<double> body_regressor_column(Index joint, Index component, const double* v, const double* a, bool gravity) const;
  template <class F>
  void add_mass(double factor, F&& force) const;
  template <class F>
  void for_each_contact_of(Index shape, F&& f) const {
    const Index geom = collision::geom_of_shape(m, shape);
    for (Index k = 0; k < contacts; ++k) {
      const ContactLaw& law = w.laws[y.contacts[k].contact];
      if (law.geom_a == geom || law.geom_b == geom) f(y.contacts[k], law);
    }
  }
  bool acts(std::uint32_t effect, Index dof) const {
    const JointRecord *const begin = m.joints(), *const end = begin + m.n.joints;
    const JointRecord* const of = std::find_if(
        begin + 1, end, [&](const JointRecord& r) { return r.leader < 0 && dof >= r.idx_v && dof < r.idx_v + r.nv; });
    return of != end && (d.effects[of - begin] & effect);
  }

  // step_correction.cpp
  const char* find_corrections();
  void displace();  // displacement = d(h v' + correction)
  void transpose_displacement();
  bool corrects() const { return w.corrected || equalities > 0; }

  // step_end.cpp
  void write(double* out) const;
  void transpose_end(const double* gradient) const;
};

}  // namespace dyn::simulation
