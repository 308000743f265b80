// Error control of steps: rounding floor, first step, retries at singular configurations, step size.
#pragma once

#include "base/portable.hpp"
#include "integrator/chart.hpp"
#include "integrator/tuning.hpp"

namespace dyn::integrator {

// Error level (rad, m and their rates) below which shorter steps gain nothing: rounding of the state, or of the accelerations.
template <class T>
struct RoundingFloor {
  bool held;         // constraint rows are active
  T max_noise;      // noise of errors per second: more is not rounding
  T noise = T(0);    // of errors, per second
  T rejected = T(0), tried = T(0);  // error and length of the last rejected step
  int tries = 0;

  static T of(T size) { return tuning::ulps * std::numeric_limits<T>::epsilon() * std::max(T(tuning::min_size), size); }
  static T of_state(const Model& m, const Data<T>& d) { return of(std::max(largest(d.q, m.n.nq), largest(d.v, m.n.nv))); }
  // The same without position and linear velocity of free bodies: without contacts no acceleration depends on them.
  static T of_motion(const Model& m, const Data<T>& d) {
    T size = T(0);
    Index q = 0, v = 0;
    const auto look_until = [&](Index end_q, Index end_v) {
      size = std::max(size, std::max(largest(d.q + q, end_q - q), largest(d.v + v, end_v - v)));
    };
    for (Index i = 1; i < m.n.bodies; ++i) {
      const Body& b = m.bodies()[i];
      if (b.type != BodyType::FreeFlyer || b.parent != 0) continue;
      look_until(b.user_q, b.user_v);
      q = b.user_q + 3, v = b.user_v + 3;
    }
    look_until(m.n.nq, m.n.nv);
    return of(size);
  }
  T operator()(const Model& m, const Data<T>& d, const Stages<T>& s, T h) const {
    const T state = of_motion(m, d),
            least = std::max(std::numeric_limits<T>::epsilon() * h * largest(s.stage(0), s.n), state / tuning::motion_share);
    return std::min(held ? std::numeric_limits<T>::infinity() : state, std::max(least, 2 * noise * h));
  }
  void accept() { tries = 0, noise /= 2; }
  void reject(T error, T h) {
    const T ratio = h / tried;
    if (tries++ > 0 && error > rejected * ratio * ratio * ratio) noise = std::max(noise, std::min(error / h, max_noise));
    rejected = error, tried = h;
  }
};

// Error that the contact solver's tolerance leaves in velocities: shorter steps do not lower it, and would never end.
struct SolverNoise {
  double level = 0;
  double rejected = 0, tried = 0;  // error and length of the last step, if it was rejected

  void accept() { level /= 2, tried = 0; }
  // most: above it an error is no noise.
  void reject(double error, double h, double most) {
    if (h < tried && error <= most && error * tried > rejected * h) level = std::max(level, error);
    rejected = error, tried = h;
  }
};

// First step: 1/100 of the time scale of y, corrected by the second derivative (same book, II.4).
template <class T>
Index first_step(const Model& m, Data<T>& d, const Stages<T>& s, int order, T tolerance, T longest, T& h) {
  s.begin(m, d);
  const ChartMotion<T> motion{m, d, s.q0};
  T *f = s.stage(0), *g = s.stage(1);
  if (const Index joint = motion(s.y0, f)) return s.undo(m, d), joint;
  const T size = std::max(T(1), largest(s.y0, s.n)), rate = largest(f, s.n);
  const T scale = rate > T(0) ? size / rate : longest, h0 = std::min(longest, T(tuning::first_change) * scale);
  for (Index k = 0; k < s.n; ++k) s.y[k] = s.y0[k] + h0 * f[k];
  const Index joint = motion(s.y, g);
  for (Index k = 0; k < s.n; ++k) g[k] -= f[k];
  const T second = std::max(largest(g, s.n) / h0, rate);
  s.undo(m, d);
  if (joint || !(second < std::numeric_limits<T>::infinity())) return h = h0, 0;  // the first step will tell
  const T by_second = math::pow(T(tuning::first_change) * tolerance / second, T(1) / order) * tuning::first_gain;
  h = std::min(longest, second > T(0) ? std::min(scale, by_second) : longest);
  return 0;
}

// Retry near a singular configuration of a mechanism, where stage accelerations are inaccurate or projection changes v much.
// The step is tried in several lengths, up to those of earlier steps; a step across the singularity is smooth. The best one
// counts. If none is good shorter steps follow, and if they lead into the singularity the best one counts after all.
template <class T>
struct SingularityRetry {
  static constexpr int most = sizeof tuning::retry_lengths / sizeof *tuning::retry_lengths;
  T max_noise, usual;  // noise: of errors per second; usual: length of ordinary steps
  T first = T(0), best = T(0), least = T(0), over = T(0);  // over: error of the best, of its limit
  int tries = 0;  // beside the first
  bool spent = false, forced = false;  // no length was good: shorter steps follow, then the best

  T limit(T allowed, T h) const { return std::max(T(tuning::retry_error) * allowed, max_noise * h); }
  T allowed(T error, T h) const { return tries > 0 ? limit(error, h) * (forced ? T(tuning::retry_forced) : T(1)) : error; }
  // Returns whether to try again with h. error, raw, moved: of this try (finish_step). usual_move: ordinary change of v by the
  // projection.
  bool again(T error, T raw, T moved, T allowed, T usual_move, T& h) {
    if (tries > most || forced) return spent = true, false;
    const bool near = T(tuning::projection_error) * raw > allowed || moved > usual_move;
    if (tries == 0 && !spent && !(near && moved > T(tuning::retry_move) * error)) return false;
    if (error <= T(tuning::retry_error) * allowed && !near) return false;
    if (tries == 0 && !spent) first = std::max(h, usual), least = over = std::numeric_limits<T>::infinity();
    const T off = std::max(error, T(tuning::projection_error) * moved), part = std::max(T(1), error / limit(allowed, h));
    if (part < over || (part == over && off < least)) least = off, best = h, over = part;
    if (spent) {
      forced = h < usual * T(tuning::retry_shrunk) && over <= T(tuning::retry_forced);
      if (forced) h = best, tries = most + 1;
      return forced;
    }
    if (tries < most) h = first * T(tuning::retry_lengths[tries]);
    else if (over <= T(1)) h = best;
    else return spent = true, false;
    return ++tries, true;
  }
  void accept(T h) {
    if (tries == 0) usual = h;
    tries = 0, spent = forced = false;
  }
};

// Step size control by this error and that of the step before (PI: Gustafsson 1991), which follows slow trends without
// rejections. Errors at rounding level say nothing of the next step: then this error alone counts.
template <class T>
struct StepSizeController {
  T power;          // 1 / (order of the error per unit step)
  bool alone;
  T longest;        // largest growth; with active rows errors are sometimes accidentally small
  T before = T(1);  // ratio of the step before
  bool tried = false;

  T accept(T ratio) {
    T factor = !(ratio > T(0)) ? T(tuning::max_factor)
               : alone         ? T(tuning::safety) * math::pow(ratio, -power)
                               : T(tuning::safety) * math::pow(ratio, T(tuning::error_power) * power) *
                                     math::pow(before, T(tuning::history_power) * power);
    if (tried && !alone) factor = std::min(factor, T(1));
    before = std::max(ratio, T(tuning::min_ratio)), tried = false;
    return std::clamp(factor, T(tuning::min_factor), longest);
  }
  T reject(T ratio) {
    tried = true;
    if (!(ratio < std::numeric_limits<T>::infinity())) return T(tuning::min_factor);
    return std::clamp(T(tuning::safety) * math::pow(ratio, -power), T(tuning::min_factor), T(tuning::safety));
  }
};

}  // namespace dyn::integrator
