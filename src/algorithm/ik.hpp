// Inverse kinematics by Levenberg-Marquardt on the manifold, in the box of the joint limits.
// Damping in proportion to the squared error (Sugihara 2011, "Solvability-unconcerned inverse kinematics by the
// Levenberg-Marquardt method", IEEE T-RO 27(5)), times a factor that follows the gain ratio (Nielsen 1999; Madsen, Nielsen,
// Tingleff 2004, 3.2). Each step is the exact minimiser of the damped model within the limits. Random restarts from a seed.
#pragma once

#include "algorithm/box_step.hpp"
#include "algorithm/ik_restarts.hpp"

namespace dyn {

template <class T>
class IkSolver : IkRestarts<T> {
  using P = IkProblem<T>;
  using P::m, P::d, P::tasks, P::o, P::random, P::x, P::best, P::start, P::lower, P::upper, P::step, P::z, P::work, P::low,
      P::high, P::g;
  using P::state, P::coordinate, P::rows, P::iterations, P::met, P::copy, P::clamp, P::place, P::cost, P::linearise, P::set_box,
      P::move;

 public:
  using IkRestarts<T>::IkRestarts;

  // From d.q; false when its cost is not finite. d is then at the solution.
  bool solve(dynIkResult& result) {
    using std::isfinite;
    copy(d.q, x), clamp(x), copy(x, start);
    place(x);
    T least = cost(false);
    if (!isfinite(least) || !isfinite(cost(true))) return false;
    copy(x, best);
    result = {result.struct_size, DYN_IK_REASON_CONVERGED, 0, 0, -1, 0, 0, 0, 0};
    Outcome outcome = attempt(o.restarts == 0);
    for (Index k = 0; outcome != Outcome::met; ++k) {
      place(x);
      if (const T E = cost(false); E < least) least = E, copy(x, best);
      if (k == o.restarts) break;
      ++result.restarts;
      this->draw(k % 3 != 2);
      outcome = attempt(k + 1 == o.restarts);
    }
    if (outcome != Outcome::met) {
      copy(best, x);
      outcome = descend(false, T(1e-13), o.max_iterations);
    }
    result.iterations = iterations;
    explain(outcome, result);
    return true;
  }

 private:
  enum class Outcome { met, stationary, exhausted };

  // From x, to where the tasks are met (unless all of them count) or where a step would lower the cost by less than
  // tolerance times it.
  Outcome descend(bool all, T tolerance, Index most) {
    using std::isfinite;
    place(x);
    T E = cost(all), mu = T(0.3), growth = T(2);
    while (all || !met) {
      LeastSquares<T> s = linearise(all);
      const T floor = T(1e-12) * s.trace() / T(s.n);
      set_box();
      for (bool accepted = false; !accepted;) {
        if (most-- == 0) return Outcome::exhausted;
        ++iterations;
        const T lambda = mu * (E + floor);
        const T decrease = BoxStep<T>{s, low, high, step, z, work, state}(lambda);
        if (decrease >= T(0) && decrease <= tolerance * E && mu <= T(1)) return Outcome::stationary;
        move(d.q), place(d.q);
        const T trial = decrease > T(0) ? cost(all) : E, gain = (E - trial) / decrease;
        accepted = decrease > T(0) && isfinite(trial) && gain > T(1e-4);
        if (accepted) {
          copy(d.q, x), E = trial;
          const T bend = T(2) * gain - T(1);
          mu *= std::max(T(1) / T(3), T(1) - bend * bend * bend), growth = T(2);
        } else {
          mu *= growth, growth *= T(2);
          if (mu > T(1e20)) return Outcome::stationary;
        }
      }
    }
    return Outcome::met;
  }
  // All tasks, then those of priority 0 alone, which moves q by the little that the others held them back.
  // While there are more starts to come, slow progress is not worth its time.
  Outcome attempt(bool last) {
    const Index before = iterations;
    Index most = o.max_iterations;
    Outcome outcome = Outcome::stationary;
    for (bool again = true; again;) {
      outcome = Outcome::stationary;
      if (rows[1]) outcome = descend(true, T(1e-10), most), most = o.max_iterations - (iterations - before);
      if (outcome == Outcome::stationary || !rows[1]) outcome = descend(false, last ? T(1e-6) : T(1e-2), most);
      // a start where no first-order motion helps, such as a stretched arm
      again = outcome == Outcome::stationary && iterations - before == (rows[1] ? 2 : 1);
      most = o.max_iterations - (iterations - before);
      if (again) {
        for (Index k = 0; k < m.n.nv; ++k) step[k] = T(random.uniform(-0.1, 0.1));
        move(x);
      }
    }
    return outcome;
  }
  void explain(Outcome outcome, dynIkResult& result) {
    using std::abs;
    place(x);
    result.cost = double(cost(false));
    for (Index k = 0; k < tasks.count; ++k) {
      if (tasks[k].priority) continue;
      IkResidual e;
      ik_cost(m, d, tasks[k], e);
      result.residual_linear = std::max(result.residual_linear, e.linear);
      result.residual_angular = std::max(result.residual_angular, e.angular);
    }
    const LeastSquares<T> s = linearise(false);
    T pressure = T(0);
    Index pressed = -1;
    for (Index k = 0; k < m.n.nv; ++k) {
      const Index c = coordinate[k];
      const bool held = c >= 0 && ((x[c] <= lower[c] && g[k] > T(0)) || (x[c] >= upper[c] && g[k] < T(0)));
      if (!held) result.optimality = std::max(result.optimality, double(abs(g[k])));
      else if (abs(g[k]) > pressure) pressure = abs(g[k]), pressed = k;
    }
    if (outcome == Outcome::met) return;
    if (outcome == Outcome::exhausted) {
      result.reason = DYN_IK_REASON_MAX_ITERATIONS;
    } else if (double(pressure) > 100 * result.optimality) {
      result.reason = DYN_IK_REASON_LIMITS;
      for_each_leader(m, [&]<class J>(const Body& b) {
        if (b.user_v <= pressed && pressed < b.user_v + J::nv) result.joint = b.joint;
      });
    } else {
      const Index here = rank(s);
      this->sample(best, false), place(best);
      const Index elsewhere = rank(linearise(false));
      result.reason = here < elsewhere ? DYN_IK_REASON_SINGULAR : DYN_IK_REASON_LOCAL_MINIMUM;
      place(x);
    }
  }
};

// d.q becomes the solution; false (d.q undefined) when the cost at the start is not finite.
template <class T>
bool inverse_kinematics(const Model& m, Data<T>& d, const IkTasks& tasks, const dynIkOptions& options, dynIkResult& result) {
  return IkSolver<T>(m, d, tasks, options).solve(result);
}

}  // namespace dyn
