// Central differences of a step: two steps for each column, from the state before. Contacts begin from the forces of the last
// one.
#include "algorithm/configuration.hpp"
#include "collision/pair_contacts.hpp"
#include "simulation/step_derivatives.hpp"

namespace dyn::simulation {

namespace {

struct Differences {
  const Model& m;
  Data<double>& d;
  StepDerivatives& x;
  double epsilon;
  Index failed = 0;
  double* to = x.by;

  // Marks contacts that press, or slide on their cone, in one step and not in the other.
  void compare_modes() const {
    const Workspace& w = *d.step;
    const auto mark = [&](Index k, bool active) {
      if ((x.modes.modes[k] != DYN_CONTACT_MODE_OPEN) != active) x.modes.degenerate[k] = 1;
    };
    Index k = 0;
    for (Index i = 0; i < w.contact_count; ++i) {
      const dynContactForce& f = w.contacts[i];
      while (k < x.modes.count && collision::comes_before(x.modes.contacts[k].contact, f.contact)) mark(k++, false);
      if (k < x.modes.count && !collision::comes_before(f.contact, x.modes.contacts[k].contact)) {
        mark(k, is_active(f));
        if (is_active(f) && w.laws[i].rows > 1) compare_friction(f, w.laws[i].material.friction, k);
        ++k;
      }
    }
    while (k < x.modes.count) mark(k++, false);
  }
  void compare_friction(const dynContactForce& f, double mu, Index k) const {
    const Vec3<double> n = load3(f.contact.normal), force = load3(f.force_on_b);
    const double normal = dot(force, n), across = shape::norm(force - n * normal);
    const bool sticks = across < (1 - tuning::derivatives::consistent) * mu * normal;
    if (x.modes.modes[k] == DYN_CONTACT_MODE_SLIDE && mu > 0 && sticks) x.modes.degenerate[k] = 1;
  }
  // The end of the step from the state in d, on the tangent space of that of the unchanged step.
  void end(double* out) {
    if (failed) return;
    d.step->advancement_cache.square = 0, ++x.steps;
    if ((failed = step_once(m, d))) return;
    difference(m, static_cast<const double*>(x.q_next), static_cast<const double*>(d.q), out);
    for (Index k = 0; k < m.n.nv; ++k) out[m.n.nv + k] = d.v[k] - x.v_next[k];
    compare_modes();
  }
  // One column. change(s): adds s to its coordinate, in a state that is that of the beginning otherwise.
  template <class F>
  void column(F&& change) {
    start_from(m, d, x), change(epsilon), end(x.plus);
    start_from(m, d, x), change(-epsilon), end(x.minus);
    for (Index k = 0; k < 2 * m.n.nv; ++k) to[k] = (x.plus[k] - x.minus[k]) / (2 * epsilon);
    to += 2 * std::ptrdiff_t(m.n.nv);
  }
  // Columns of an input that steps leave alone.
  void columns_of(double* input, Index n) {
    for (Index k = 0; k < n && !failed; ++k) {
      const double kept = input[k];
      column([&](double s) { input[k] = kept + s; });
      input[k] = kept;
    }
  }
};

// What central differences change for a number of a parameter, or nullptr.
double* parameter_place(Data<double>& d, const StepParameter& p, Index component) {
  const auto entry = [&](double* array) { return array ? array + p.index : nullptr; };
  switch (p.type) {
    case DYN_STEP_PARAMETER_TYPE_ARMATURE: return entry(d.armature);
    case DYN_STEP_PARAMETER_TYPE_DAMPING: return entry(d.damping);
    case DYN_STEP_PARAMETER_TYPE_FRICTION: return entry(d.friction);
    case DYN_STEP_PARAMETER_TYPE_GRAVITY: return d.world_gravity + component;
    case DYN_STEP_PARAMETER_TYPE_TIME_STEP: return &d.step->options.dt;
    default: return nullptr;  // in the model, or of pairs of shapes
  }
}

}  // namespace

Index parameter_columns(const Model& m, Data<double>& d, StepDerivatives& x, double epsilon, const StepProducts& p,
                        bool time_step_alone) {
  Index failed = 0;
  p.for_each_parameter([&](const StepParameter& a, Index first) {
    const bool time_step = a.type == DYN_STEP_PARAMETER_TYPE_TIME_STEP;
    if (time_step_alone && !time_step) return;
    constexpr double share = 1e-5;  // of dt
    for (Index c = 0; c < parameter_size(a.type) && !failed && !x.refused; ++c) {
      double *const place = parameter_place(d, a, c), *const column = x.jacobian.given.end;
      if (!place) return void(x.refused = true);
      Differences by{m, d, x, time_step ? share * d.step->options.dt : epsilon};
      by.to = column, by.columns_of(place, 1), failed = by.failed;
      if (!failed) add_column(m, p, first + c, column);
    }
  });
  return failed;
}

Index step_differences(const Model& m, Data<double>& d, StepDerivatives& x, double epsilon, const Wanted& wanted) {
  Differences by{m, d, x, epsilon};
  const Index nv = m.n.nv;
  std::fill_n(x.direction, nv, 0.0);
  for (Index k = 0; wanted.state && k < nv && !by.failed; ++k) {
    by.column([&](double s) {
      x.direction[k] = s;
      integrate(m, static_cast<const double*>(x.q), static_cast<const double*>(x.direction), d.q);
    });
    x.direction[k] = 0;
  }
  for (Index k = 0; wanted.state && k < nv && !by.failed; ++k) by.column([&](double s) { d.v[k] += s; });
  by.to = x.by + 4 * std::ptrdiff_t(nv) * nv;
  if (wanted.tau) by.columns_of(d.tau_applied, nv);
  by.to = x.by + 6 * std::ptrdiff_t(nv) * nv;
  if (wanted.control) by.columns_of(d.ctrl, m.n.nu);
  return by.failed;
}

}  // namespace dyn::simulation
