// Steps for an accuracy where velocities may jump: h in one step of order 1, in two and in three, extrapolated
// (Aitken-Neville; Hairer and Wanner 1996, IV.9). Order 3 where no contact begins or ends.
// Each step moves first and changes the velocity at the new position (as MEXX: Lubich et al. 1992), so velocities satisfy the
// constraint rows there; the other order lags one step and makes near-limit friction slip:
//   q' = q (+) h v      v' = v + h ddq(q', v') + M^-1 J^T lambda, all at q'
#pragma once

#include "simulation/semi_implicit_euler.hpp"

namespace dyn::integrator {

// Calls f(body, centre of mass, inertia about it) for free flyers without children, which keep their own momentum.
template <class F>
void for_each_single_flyer(const Model& m, F&& f) {
  for_each_free_flyer<double>(m, AllTrees{}, [&](const Body& b, Index i, const Vec3<double>& c) {
    if (m.subtree_end()[i] == i + 1 && b.m > 0) f(b, c, central_inertia(b, c));
  });
}

// q' = q (+) h v. Free flyers keep their momentum, expressed in the axes at the end.
inline void drift(const Model& m, Data<double>& d, const Stages<double>& s, double h) {
  s.begin(m, d);
  for (Index k = 0; k < m.n.nv; ++k) s.y[k] = h * d.v[k];
  integrate(m, static_cast<const double*>(s.q0), static_cast<const double*>(s.y), d.q);
  end_flight<false>(m, AllTrees{}, s.q0, h, static_cast<const double*>(nullptr), d.q, d.v);
  for_each_single_flyer(m, [&](const Body& b, const Vec3<double>& c, const Mat3<double>& I) {
    const Vec3<double> w = load3(d.v + b.user_v + 3), turned = solve3(I, exp3(w * -h) * (I * w));
    store3(load3(d.v + b.user_v) + cross(w - turned, c), d.v + b.user_v), store3(turned, d.v + b.user_v + 3);
  });
}

// v' at the position in d. Returns 0, or the joint whose forward dynamics failed.
inline Index kick(const Model& m, Data<double>& d, const Stages<double>& s, double h) {
  if (const Index joint = implicit_dynamics(m, d, s, h, true, AllTrees{})) return joint;
  s.begin(m, d);
  const double* const v0 = s.y0 + m.n.nv;
  for (Index k = 0; k < m.n.nv; ++k) d.v[k] += h * d.ddq[k];
  for_each_single_flyer(m,
                        [&](const Body& b, const Vec3<double>&, const Mat3<double>& I) {  // drift integrated the gyroscopic term
                          const Vec3<double> w = load3(v0 + b.user_v + 3);
                          store3(load3(d.v + b.user_v + 3) + solve3(I, cross(w, I * w)) * h, d.v + b.user_v + 3);
                        });
  for_each_free_flyer<double>(m, AllTrees{}, [&](const Body& b, Index, const Vec3<double>& c) {
    const Vec3<double> u = load3(v0 + b.user_v), w = load3(v0 + b.user_v + 3), dw = load3(d.ddq + b.user_v + 3);
    const Vec3<double> a = load3(d.ddq + b.user_v) + cross(w, u) + cross(dw, c) + cross(w, cross(w, c));
    store3(u + cross(w, c) + a * h - cross(load3(d.v + b.user_v + 3), c), d.v + b.user_v);
  });
  if (apply_constraints(m, d, s, h) == ConstraintOutcome::Correction) {
    integrate(m, static_cast<const double*>(s.q0), static_cast<const double*>(s.f), d.q);
    end_flight<false>(m, AllTrees{}, s.q0, 0.0, static_cast<const double*>(s.f), d.q, d.v);
    if (simulation::has_open_ledger(d)) simulation::record_correction(m, d, s.q0, s.f, s.f);
  }
  advance_activations(m, d, s.y0 + 2 * m.n.nv, h);
  return 0;
}

// Gaps below Workspace::closed_gap count as closed, so velocities do not depend on gaps that are errors.
class Extrapolated {
 public:
  static constexpr int order = 3, evaluations = 6;
  // reopen: gap at which an active contact opens. least: that the solver's tolerance is set to
  Extrapolated(const Model& m_, Data<double>& d_, const Stages<double>& s_, double closed_, double reopen_,
               double least_ = integrator::tuning::solver_floor)
      : m(m_), d(d_), s(s_), closed(closed_), reopen(reopen_), least(least_) {
    double* next = s.stage(1);
    for (State& x : kept) x.q = next, x.v = x.q + m.n.nq, x.act = x.v + m.n.nv, next = x.act + m.n.na;
    for (double*& x : by_three) x = next, next += m.n.nv;
  }

  // One extrapolated step and its error. d.ddq: free, at the beginning. Returns 0, or the joint whose forward dynamics failed
  // (state restored).
  Index step(double h, double& error) {
    keep(before), simulation::save_forces(*d.step);
    d.step->closed_gap = closed, d.step->reopen_gap = reopen;
    // the solver's residual does not extrapolate: it must be far below the error, or no step is short enough
    const double given = d.step->options.tolerance, asked = d.step->tolerance();
    const double fast = largest(static_cast<const double*>(d.v), m.n.nv) + h * largest(static_cast<const double*>(d.ddq), m.n.nv);
    if (fast > 0)
      d.step->options.tolerance =
          std::min(asked, std::max(least, integrator::tuning::solver_share * closed / fast));
    Index joint = substeps(h, 1);
    if (!joint) keep(one), restore(), joint = substeps(h, 2);
    if (!joint) keep(two), restore(), d.step->overshoot = 0, joint = substeps(h, 3);
    d.step->closed_gap = 0, d.step->options.tolerance = given;
    if (joint) return restore(), joint;
    // curvature of v: an event stopped by all three substeps alike shows in no difference (jumps at the end excepted)
    double of_place = 0, of_speed = 0;
    for (Index k = 0; k < m.n.nv; ++k) {
      const double first = by_three[0][k], second = by_three[1][k], third = by_three[2][k];
      of_place =
          std::max(of_place, std::max(bent(before.v[k], first, second), d.step->overshoot > 0 ? 0 : bent(first, second, third)));
    }
    of_place *= h / 6;
    // differences to the result of three steps
    const auto limit = [](double a, double b, double& e) { return e = std::max(e, std::abs(0.5 * a - 2 * b)), 0.5 * a - 4 * b; };
    double *a = s.y, *b = a + m.n.nv;
    difference(m, d.q, one.q, a), difference(m, d.q, two.q, b);
    for (Index k = 0; k < m.n.nv; ++k)
      a[k] = limit(a[k], b[k], of_place), b[k] = limit(one.v[k] - d.v[k], two.v[k] - d.v[k], of_speed);
    for (Index k = 0; k < m.n.na; ++k) two.act[k] = limit(one.act[k] - d.act[k], two.act[k] - d.act[k], of_speed);
    simulation::record_overshoot(m, d, a, closed);
    of_place = std::max(of_place, 2 * d.step->overshoot);  // an overshoot common to all: a rebound is off by twice that
    error = std::max(of_place, of_speed), error_in_time = of_place + h * of_speed;
    keep(three);
    integrate(m, static_cast<const double*>(three.q), static_cast<const double*>(a), d.q);
    for (Index k = 0; k < m.n.nv; ++k) d.v[k] += b[k];
    for (Index k = 0; k < m.n.na; ++k) d.act[k] += two.act[k];
    return 0;
  }
  void restore() { take(before), simulation::restore_forces(*d.step); }
  void three_steps() { take(three); }
  // The error where velocities differ because the substeps notice the same event at different times.
  double error_of_timing() const { return error_in_time; }

 private:
  struct State {
    double *q, *v, *act;
  };
  const Model& m;
  Data<double>& d;
  const Stages<double>& s;
  double closed, reopen, least, error_in_time = 0;
  State kept[3];
  double* by_three[3];  // velocities after each of three substeps, in the axes at the beginning
  State &before = kept[0], &one = kept[1], &two = kept[2], &three = one;

  static double bent(double a, double b, double c) { return std::abs(a - 2 * b + c); }
  void rotate_to_start_axes(double* v) const {
    std::copy_n(d.v, m.n.nv, v);
    for_each_free_flyer<double>(m, AllTrees{}, [&](const Body& b, Index, const Vec3<double>&) {
      const Mat3<double> R0 = rotation(load_quaternion(before.q + b.user_q + 3)),
                         R = rotation(load_quaternion(d.q + b.user_q + 3));
      for (double* part : {v + b.user_v, v + b.user_v + 3})
        store3(transpose_times(R0, R * load3(static_cast<const double*>(part))), part);
    });
  }
  void keep(const State& x) const {
    std::copy_n(d.q, m.n.nq, x.q), std::copy_n(d.v, m.n.nv, x.v), std::copy_n(d.act, m.n.na, x.act);
  }
  void take(const State& x) const {
    std::copy_n(x.q, m.n.nq, d.q), std::copy_n(x.v, m.n.nv, d.v), std::copy_n(x.act, m.n.na, d.act);
  }
  Index substeps(double h, int n) const {
    Index joint = 0;
    simulation::reset_impulse_work(d), d.step->rows_work = 0;
    for (int k = 0; k < n && !joint; ++k) {
      d.step->drift_count = k + 1;
      drift(m, d, s, h / n), joint = kick(m, d, s, h / n);
      rotate_to_start_axes(by_three[k]);
    }
    return joint;
  }
};

}  // namespace dyn::integrator
