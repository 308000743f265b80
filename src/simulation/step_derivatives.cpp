// What both methods of derivatives share: memory, the step itself, and the modes of its contacts.
#include "simulation/step_derivatives.hpp"

#include "algorithm/constrained/constrained_dynamics.hpp"
#include "algorithm/rnea_derivatives.hpp"
#include "integrator/free_flight.hpp"
#include "integrator/stepping.hpp"

namespace dyn::simulation {

namespace {

// Calls f(array, numbers) for each.
template <class F>
void for_each_array(const Model& m, StepDerivatives& x, F&& f) {
  const std::ptrdiff_t nq = m.n.nq, nv = m.n.nv, contacts = m.n.contacts;
  f(x.q, nq), f(x.v, nv), f(x.act, m.n.na), f(x.limit_forces, remembered_rows(m)), f(x.actuator_force, m.n.actuators),
      f(x.contacts, contacts);
  f(x.q_next, nq), f(x.v_next, nv), f(x.v_end, nv);
  f(x.modes.contacts, contacts), f(x.modes.modes, contacts), f(x.modes.degenerate, contacts);
  f(x.by, 2 * nv * derivative_count(m));
  f(x.direction, nv), f(x.plus, 2 * nv), f(x.minus, 2 * nv);
  jacobian_arrays(m, derivative_count(m), x.jacobian, f);
}

std::size_t rounded(std::size_t bytes) { return (bytes + 63) / 64 * 64; }

bool is_finite(const double* x, Index n) {
  double sum = 0;
  for (Index k = 0; k < n; ++k) sum += 0 * x[k];
  return sum == 0;
}

// The velocity of a free flyer before end_flight turned it: v_c = R0^T R v_c'.
void velocity_at_end(const Model& m, const StepDerivatives& x, bool plain, double* v) {
  std::copy_n(x.v_next, m.n.nv, v);
  integrator::for_each_free_flyer<double>(m, WholeModel{}, [&](const Body& b, Index, const Vec3<double>& center) {
    const Vec3<double> c = plain ? Vec3<double>::zero() : center, w = load3(v + b.user_v + 3);
    const Mat3<double> R0 = rotation(load_quaternion(x.q + b.user_q + 3)), R = rotation(load_quaternion(x.q_next + b.user_q + 3));
    store3(transpose_times(R0, R * (load3(v + b.user_v) + cross(w, c))) - cross(w, c), v + b.user_v);
  });
}

}  // namespace

std::size_t derivative_bytes(const Model& m) {
  StepDerivatives x;
  std::size_t bytes = rounded(sizeof x);
  for_each_array(m, x, [&](auto* array, std::ptrdiff_t n) { bytes += rounded(std::size_t(n) * sizeof *array); });
  return bytes;
}

StepDerivatives* place_derivatives(const Model& m, void* memory) {
  StepDerivatives& x = *new (memory) StepDerivatives{};
  char* at = static_cast<char*>(memory) + rounded(sizeof x);
  for_each_array(m, x, [&](auto*& array, std::ptrdiff_t n) {
    array = reinterpret_cast<std::remove_reference_t<decltype(array)>>(at);
    at += rounded(std::size_t(n) * sizeof *array);
  });
  return &x;
}

Index step_once(const Model& m, Data<double>& d) {
  Workspace& w = *d.step;
  std::copy_n(d.q, m.n.nq, d.backup), std::copy_n(d.v, m.n.nv, d.backup + m.n.nq);
  std::copy_n(d.act, m.n.na, d.backup + m.n.nq + 3 * m.n.nv);
  const Index failed = integrator::step(m, d, w.options.integrator, w.options.dt, w.report, static_cast<const double*>(d.backup));
  if (failed) return failed;
  return is_finite(d.q, m.n.nq) && is_finite(d.v, m.n.nv) ? 0 : not_finite;
}

void solve_exactly(Workspace& w) {
  using tuning::derivatives::tolerance;
  w.options.tolerance = w.options.tolerance > 0 ? std::min(w.options.tolerance, tolerance) : tolerance;
  w.options.time_budget = 0, w.options.ledger = 0, w.options.accuracy = 0, w.ledger.open = false;
  w.report = {};
}

Index begin_derivatives(const Model& m, Data<double>& d, StepDerivatives& x) {
  Workspace& w = *d.step;
  wake_all(m, d);
  std::copy_n(d.q, m.n.nq, x.q), std::copy_n(d.v, m.n.nv, x.v), std::copy_n(d.act, m.n.na, x.act);
  if (w.limit_forces) std::copy_n(w.limit_forces, remembered_rows(m), x.limit_forces);
  std::copy_n(d.actuator_force, m.n.actuators, x.actuator_force);
  std::copy_n(w.contacts, w.contact_count, x.contacts), x.contact_count = w.contact_count;
  x.growth = w.growth, x.options = w.options, x.report = w.report, x.ledger = w.ledger.open;
  x.steps = 1, x.degenerate = 0, x.reason = nullptr, x.refused = false;
  solve_exactly(w);
  if (const Index failed = step_once(m, d)) return failed;
  std::copy_n(d.q, m.n.nq, x.q_next), std::copy_n(d.v, m.n.nv, x.v_next);
  velocity_at_end(m, x, has_file_rows(d), x.v_end);
  x.modes.count = w.contact_count;
  std::copy_n(w.contacts, w.contact_count, x.modes.contacts);
  return 0;
}

void start_from(const Model& m, Data<double>& d, const StepDerivatives& x) {
  std::copy_n(x.q, m.n.nq, d.q), std::copy_n(x.v, m.n.nv, d.v), std::copy_n(x.act, m.n.na, d.act);
  d.step->growth = x.growth, d.step->advancement_cache.square = 0;
}

void restore_state(const Model& m, Data<double>& d, const StepDerivatives& x) {
  Workspace& w = *d.step;
  start_from(m, d, x);
  if (w.limit_forces) std::copy_n(x.limit_forces, remembered_rows(m), w.limit_forces);
  std::copy_n(x.actuator_force, m.n.actuators, d.actuator_force);
  std::copy_n(x.contacts, x.contact_count, w.contacts), w.contact_count = x.contact_count;
  w.options = x.options, w.report = x.report, w.ledger.open = x.ledger, w.ends_fast = true;
}

namespace {

// What decides the mode of a contact.
struct ContactState {
  double gap, opening, before;  // normal velocity at the end of the step and at its beginning
  double normal, tangential, sliding;
};

struct ModeFinder {
  const Model& m;
  Data<double>& d;
  StepDerivatives& x;
  const double *v, *v_before;  // expanded

  Vec3<double> relative(const ContactLaw& law, const Vec3<double>& at, const double* v) const {
    const auto velocity = [&](Index geom) {
      const Index body = d.geoms[geom].body;
      return velocity_at(d, body, at, body_motion(m, d, body, v, static_cast<const double*>(nullptr)).V);
    };
    return velocity(law.geom_b) - velocity(law.geom_a);
  }
  ContactState state(Index k) const {
    const dynContactForce& f = x.modes.contacts[k];
    const ContactLaw& law = d.step->laws[k];
    const Vec3<double> n = load3(f.contact.normal), at = load3(f.contact.position), force = load3(f.force_on_b);
    const Vec3<double> u = relative(law, at, v);
    const Vec3<double> slip = u + surface_velocity(d, law.geom_b) - surface_velocity(d, law.geom_a);
    const double normal = dot(force, n);
    return {f.contact.distance,
            dot(u, n),
            dot(relative(law, at, v_before), n),
            normal,
            shape::norm(force - n * normal),
            shape::norm(slip - n * dot(slip, n))};
  }
  void find(Index k, double largest, double margin) const {
    using tuning::derivatives::consistent, tuning::derivatives::still;
    const ContactState s = state(k);
    const ContactLaw& law = d.step->laws[k];
    dynContactMode& mode = x.modes.modes[k];
    bool degenerate = std::abs(s.gap) < margin || s.normal < margin * largest;
    const double bound = law.material.friction * s.normal, e = law.material.restitution;
    if (!(s.normal > 0)) {
      mode = DYN_CONTACT_MODE_OPEN, degenerate = std::max(0.0, s.gap) + d.step->options.dt * s.opening < margin && is_movable(k);
    } else if (e > 0 && s.before < 0 && std::abs(s.opening + e * s.before) < consistent * -s.before) {
      mode = DYN_CONTACT_MODE_IMPACT, degenerate = degenerate && s.normal < margin * largest;
    } else if (law.rows == 1 || bound == 0) {
      mode = DYN_CONTACT_MODE_SLIDE;
    } else if (s.sliding > still) {
      mode = DYN_CONTACT_MODE_SLIDE, degenerate = degenerate || s.sliding < margin;
    } else {
      mode = DYN_CONTACT_MODE_STICK, degenerate = degenerate || s.tangential > bound * (1 - margin);
    }
    x.modes.degenerate[k] = degenerate;
  }
  // Whether an impulse along its normal would move anything (has_immovable_normal).
  bool is_movable(Index k) const {
    const Workspace& w = *d.step;
    return std::none_of(w.active, w.active + w.constraint_count, [&](const ActiveConstraint& a) {
      return a.kind == RowKind::Contact && a.index == k && !a.idle && a.support_count == 0;
    });
  }
};

// Limits that begin or end to press within the margin.
Index degenerate_limits(const Model& m, const Data<double>& d, const StepDerivatives& x, double margin) {
  if (!(d.acting & DYN_EFFECT_LIMITS)) return 0;
  Index count = 0;
  for (Index k = 0; k < m.n.limits; ++k) {
    const LimitRecord& r = m.limits()[k];
    if (is_ball(m, r) || !(d.effects[m.bodies()[r.body].joint] & DYN_EFFECT_LIMITS)) continue;
    count += d.step->limit_forces[k] != 0 ? std::abs(limit_gap(m, x.q, k)) < margin : limit_gap(m, x.q_next, k) < margin;
  }
  return count;
}

}  // namespace

void find_modes(const Model& m, Data<double>& d, StepDerivatives& x, double margin) {
  x.degenerate = degenerate_limits(m, d, x, margin);
  if (x.modes.count == 0) return;
  start_from(m, d, x);
  const double* const v_before = d.expand(m, static_cast<const double*>(x.v), d.vx);
  derivative_columns(m, d, v_before, static_cast<const double*>(d.zero));
  const ModeFinder find{m, d, x, d.expand(m, static_cast<const double*>(x.v_end), d.ax), v_before};
  double largest = 0;
  for (Index k = 0; k < x.modes.count; ++k) largest = std::max(largest, shape::norm(load3(x.modes.contacts[k].force_on_b)));
  for (Index k = 0; k < x.modes.count; ++k) find.find(k, largest, margin);
}

Index differentiate_step(const Model& m, Data<double>& d, StepDerivatives& x, const DerivativeSettings& settings,
                         const Wanted& wanted, dynDerivativeMethod& used) {
  if (const Index failed = begin_derivatives(m, d, x)) return failed;
  find_modes(m, d, x, settings.margin);
  used = DYN_DERIVATIVE_METHOD_ANALYTIC;
  if (settings.method != DYN_DERIVATIVE_METHOD_CENTRAL_DIFFERENCES) step_jacobian(m, d, x, settings.margin, wanted);
  const bool covered = settings.method != DYN_DERIVATIVE_METHOD_CENTRAL_DIFFERENCES && !x.reason;
  if (covered) return parameter_columns(m, d, x, settings.epsilon, wanted.products, true);
  if (settings.method == DYN_DERIVATIVE_METHOD_ANALYTIC) return 0;
  used = DYN_DERIVATIVE_METHOD_CENTRAL_DIFFERENCES;
  const bool multiplies = wanted.products.tangent_count + wanted.products.cotangent_count > 0;
  const Wanted by{wanted.state || multiplies, wanted.tau || multiplies, wanted.control || multiplies};
  if (const Index failed = step_differences(m, d, x, settings.epsilon, by)) return failed;
  multiply(m, x, wanted.products);
  return parameter_columns(m, d, x, settings.epsilon, wanted.products, false);
}

}  // namespace dyn::simulation
