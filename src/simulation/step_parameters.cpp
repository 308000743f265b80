// The linearised step (step_linearisation.hpp): what parameters change in it. At fixed v' and impulses the forces change by
// -(dM a + dnle); N^-1 J^T of corrections by -N^-1 dN N^-1 J^T; free flyers also by their centre of mass.
#include "algorithm/regressor.hpp"
#include "model/length.hpp"
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

// Returns why a parameter has no derivative of two sides, or nullptr.
const char* StepJacobian::find_parameters(const StepProducts& p) const {
  const char* reason = nullptr;
  p.for_each_parameter([&](const StepParameter& a, Index) {
    if (a.type != DYN_STEP_PARAMETER_TYPE_CONTACT_FRICTION) return;
    for_each_contact_of(a.index, [&](const JacobianContact&, const ContactLaw& law) {
      if (law.rows == 1) reason = "a contact has no friction";
    });
  });
  return reason;
}

// y.a of bodies that fly alone: their forces are not linear in v' - v.
void StepJacobian::find_free_acceleration() const {
  integrator::for_each_free_flyer<double>(m, WholeModel{}, [&](const Body& b, Index i, const Vec3<double>&) {
    if (!is_free(i)) return;
    const Index at = b.user_v;
    double lacking[6];
    for (int k = 0; k < 6; ++k) lacking[k] = d.tau_applied[at + k] - d.tau[at + k] - y.diagonal[at + k] * y.a[at + k];
    for (int k = 0; k < 6; ++k)
      for (int l = 0; l < 6; ++l) y.a[at + k] += d.Minv[at + k + nv * (at + l)] * lacking[l];
  });
}

// to += factor times what the degrees of freedom that move the body feel of F, which is at the root of its tree.
void StepJacobian::add_body_force(Index body, const Force<double>& F, double factor, double* to) const {
  for (Index i = body; i != 0; i = m.bodies()[i].parent)
    for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k)
      to[user_dof(m, k)] += factor * ratio(k) * dot(d.S[k], F);
}

// Of the force that moves the body of a joint, at the root of its tree, by an inertial parameter.
Force<double> StepJacobian::body_regressor_column(Index joint, Index component, const double* v, const double* a,
                                                  bool gravity) const {
  const FramePose<double> P = joint_pose(m, d, joint);
  v = d.expand(m, v, d.vx), a = d.expand(m, a, d.ax);
  Motion<double> V = Motion<double>::zero(), A = V;
  const auto add = [&](auto&& self, Index i) -> void {
    if (i == 0) return;
    self(self, m.bodies()[i].parent);
    const Index first = m.bodies()[i].idx_v, end = first_dof(m, i + 1);
    const Motion<double> before = V;
    for (Index k = first; k < end; ++k) V = V + d.S[k] * v[k];
    for (Index k = first; k < end; ++k) A = A + d.S[k] * a[k] + cross(before, d.S[k]) * v[k];
  };
  add(add, P.body);
  const Vec3<double> arm = d.rel[P.body];
  const Motion<double> u = shift(V, arm), s = shift(A, arm);
  const Vec3<double> g = gravity ? load3(static_cast<const double*>(d.world_gravity)) : Vec3<double>::zero();
  Force<double> F[10];
  body_regressor(P.R, u.angular, s.angular, s.linear + cross(u.angular, u.linear) - g, F);
  return shift(F[component], arm);
}

// A parameter of N. force(z, to): to += dN z.
template <class F>
void StepJacobian::add_mass(double factor, F&& force) const {
  double *const z = x.plus, *const t = x.minus;
  // impulses of bodies that fly alone act after free_flight
  integrator::for_each_free_flyer<double>(m, WholeModel{}, [&](const Body& b, Index i, const Vec3<double>&) {
    if (!is_free(i)) return;
    const Index at = b.user_v;
    std::fill_n(z, nv, 0.0), std::fill_n(t, nv, 0.0);
    for (int k = 0; k < 6; ++k)
      for (int l = 0; l < 6; ++l) z[at + k] += d.Minv[at + k + nv * (at + l)] * y.impulse[at + l];
    force(z, t);
    for (Index row = at; row < at + 6; ++row)
      y.given.velocity[row] += factor * inner(y.flight + flight_columns * row + 12, t + at, 6);
  });
  for (Index j = 0; exact && j < corrections; ++j) {
    const CorrectionRow& r = y.corrections[j];
    if (r.exact < 0) continue;
    std::fill_n(t, nv, 0.0);
    force(static_cast<const double*>(y.Z + nv * r.row), t);
    for (Index k = 0; k < nv; ++k) y.given.displacement[k] -= factor * r.mu * inner(d.Minv + nv * k, t, nv);
    for (Index i = 0; i < corrections; ++i) {
      const CorrectionRow& s = y.corrections[i];
      if (s.exact >= 0) y.given.G[exact_corrections(m) * s.exact + r.exact] -= factor * inner(y.Z + nv * s.row, t, nv);
    }
  }
}

void StepJacobian::add_inertia(Index joint, Index component, double factor) const {
  const Index body = m.joints()[joint].last_body;
  add_body_force(body, body_regressor_column(joint, component, x.v, y.a, true), -h * factor, y.given.force);
  add_mass(factor, [&](const double* z, double* to) {
    add_body_force(body, body_regressor_column(joint, component, d.zero, z, false), 1, to);
  });
  const Body& b = m.bodies()[body];
  if (!(b.m > 0)) return;
  double unit[10] = {};
  unit[component] = 1;
  const Inertia<double> change = load_parameters(static_cast<const double*>(unit));
  const double longer = factor * own_length_change(m, b, change.m, change.I(0, 0) + change.I(1, 1) + change.I(2, 2));
  add_largest_correction(correction_falls(d) ? 0.5 * longer : longer, longer);
  if (b.type != BodyType::FreeFlyer) return;
  const Mat3<double>& C = m.joints()[joint].C;
  const Vec3<double> c = b.h * (1 / b.m), dc = (C * change.h - c * change.m) * (1 / b.m);
  // I about the centre of mass: I - m (c^2 1 - c c^T)
  const auto outer = [](const Vec3<double>& p, const Vec3<double>& q) {
    return Mat3<double>{p * q[0], p * q[1], p * q[2]};
  };
  const Mat3<double> one = Mat3<double>::identity();
  const Mat3<double> dI = C * change.I.full() * transpose(C) - (one * dot(c, c) - outer(c, c)) * change.m -
                          (one * (2 * dot(c, dc)) - outer(c, dc) - outer(dc, c)) * b.m;
  add_centre(b, body, c, dc, dI, factor);
}

// What a free flyer's centre of mass and its inertia about it change in free_flight and end_flight.
void StepJacobian::add_centre(const Body& b, Index i, const Vec3<double>& c, const Vec3<double>& dc, const Mat3<double>& dI,
                              double factor) const {
  const Index at = b.user_v;
  const auto add = [&](double* to, const Vec3<double>& by) {
    for (int k = 0; k < 3; ++k) to[k] += factor * by[k];
  };
  if (is_free(i)) {
    const auto by = free_flight(b, c).by_inertia(dc, dI);
    add(y.given.velocity + at, by.linear), add(y.given.velocity + at + 3, by.angular);
  } else {
    add(y.given.velocity + at, flight(b, c).by_centre(dc));
  }
  const Motion<double> v = load_motion(static_cast<const double*>(x.v_end + at)),
                       correction = load_motion(static_cast<const double*>(y.correction + at));
  const auto end = integrator::FlightEnd<double>::of(c, v, correction, h);
  const auto by = end.by_centre(dc, v.angular, v.angular * h + correction.angular);
  add(y.given.end + at, by.q.linear), add(y.given.end + nv + at, by.v.linear);
}

// Of corrections that are at their largest speed. Relative changes of it, and of the model's length.
void StepJacobian::add_largest_correction(double speed, double length) const {
  for (Index i = 0; i < corrections; ++i) {
    const CorrectionRow& r = y.corrections[i];
    if (r.slope != 0) continue;
    const bool angle = r.contact < 0 && m.bodies()[m.limits()[y.rows[r.row].of].body].type != BodyType::Prismatic;
    y.given.wrong[i] += (speed - (angle ? length : 0)) * r.wrong;
  }
}

void StepJacobian::add_gravity(const Vec3<double>& along, double factor) const {
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    add_body_force(i, {along * b.m, cross(d.R[i] * b.h + d.rel[i] * b.m, along)}, factor * h, y.given.force);
  }
  if (correction_falls(d)) {
    const Vec3<double> g = load3(static_cast<const double*>(d.world_gravity));
    add_largest_correction(factor * 0.5 * dot(g, along) / dot(g, g), 0);
  }
  using effect::GravityCompensation;
  if (!(d.acting & GravityCompensation::bit)) return;
  double gravity[3];
  std::copy_n(d.world_gravity, 3, gravity), store3(along, d.world_gravity);
  for (const auto& r : GravityCompensation::records(m))
    if (d.effects[r.joint] & GravityCompensation::bit)
      add_body_force(r.body, shift(GravityCompensation::wrench<double>(m, d, r), d.rel[r.body]), factor * h, y.given.force);
  std::copy_n(gravity, 3, d.world_gravity);
}

// Adds factor times what a number of a parameter changes to y.given.
void StepJacobian::add_parameter(const StepParameter& p, Index component, double factor) const {
  const auto law = [&]<class E>() {
    const Index k = p.index;
    if (!acts(E::bit, k)) return;
    const double by = E::secant(h, x.v[k]);
    y.given.force[k] -= factor * h * (E::force(1.0, x.v[k]) + by * y.a[k]);
    add_mass(factor, [&](const double* z, double* to) { to[k] += by * z[k]; });
  };
  switch (p.type) {
    case DYN_STEP_PARAMETER_TYPE_INERTIA: return add_inertia(p.index, component, factor);
    case DYN_STEP_PARAMETER_TYPE_ARMATURE:
      if (!acts(DYN_EFFECT_ARMATURE, p.index)) return;
      y.given.force[p.index] -= factor * h * y.a[p.index];
      return add_mass(factor, [&](const double* z, double* to) { to[p.index] += z[p.index]; });
    case DYN_STEP_PARAMETER_TYPE_DAMPING: return law.template operator()<effect::Damping>();
    case DYN_STEP_PARAMETER_TYPE_FRICTION: return law.template operator()<effect::Friction>();
    case DYN_STEP_PARAMETER_TYPE_GRAVITY: return add_gravity(unit3<double>(int(component)), factor);
    case DYN_STEP_PARAMETER_TYPE_CONTACT_FRICTION:
      return for_each_contact_of(p.index, [&](const JacobianContact& c, const ContactLaw&) {
        if (c.first + 1 < rows && y.rows[c.first + 1].kind == JacobianRowKind::Slide)
          y.given.slide[c.first + 1] += factor * y.rows[c.first].lambda;
      });
    case DYN_STEP_PARAMETER_TYPE_RESTITUTION:
      return for_each_contact_of(p.index, [&](const JacobianContact& c, const ContactLaw&) {
        if (x.modes.modes[c.contact] == DYN_CONTACT_MODE_IMPACT) y.given.row[c.first] += factor * c.approach;
      });
    case DYN_STEP_PARAMETER_TYPE_TIME_STEP: return;  // parameter_columns
  }
}

}  // namespace dyn::simulation
