// Inverse kinematics by Levenberg-Marquardt on the manifold, in the box of the joint limits.
// Damping in proportion to the squared error (Sugihara 2011, "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt
// method", IEEE T-RO 27(5)), times a factor that follows the gain ratio (Nielsen 1999; Madsen, Nielsen, Tingleff 2004, 3.2). Each
// step is the exact minimiser of the damped model within the limits. Random restarts from a seed.
#pragma once

#include "dyn/algorithm/ik_tasks.hpp"

namespace dyn {

template <class T>
class IkSolver {
 public:
  IkSolver(const Model& model, Data<T>& data, const IkTasks& list, const dynIkOptions& options)
      : m(model), d(data), tasks(list), o(options), random{options.seed} {
    const Index nq = m.n.nq, nv = m.n.nv;
    T* at = d.ik_vectors;
    for (T** a : {&x, &best, &start, &lower, &upper}) *a = at, at += nq;
    for (T** a : {&step, &z, &work, &low, &high, &r, &g}) *a = at, at += nv;
    state = d.ik_indices + 2 * std::ptrdiff_t(nv);
    coordinate = d.ik_indices + 4 * std::ptrdiff_t(nv);
    for (Index k = 0; k < tasks.count; ++k) {
      rows[tasks[k].priority ? 1 : 0] += row_count(m, tasks[k].type);
      has_com |= tasks[k].type == DYN_IK_COM;
    }
    set_limits();
  }

  // From d.q; false when its cost is not finite. d is then at the solution.
  bool solve(dynIkResult& result) {
    using std::isfinite;
    copy(d.q, x), clamp(x), copy(x, start);
    place(x);
    T least = cost(false);
    if (!isfinite(least) || !isfinite(cost(true))) return false;
    copy(x, best);
    result = {result.struct_size, DYN_IK_CONVERGED, 0, 0, -1, 0, 0, 0, 0};
    Outcome outcome = attempt(o.restarts == 0);
    for (Index k = 0; outcome != Outcome::met; ++k) {
      place(x);
      if (const T E = cost(false); E < least) least = E, copy(x, best);
      if (k == o.restarts) break;
      ++result.restarts;
      draw(k % 3 != 2);
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

  const Model& m;
  Data<T>& d;
  const IkTasks& tasks;
  const dynIkOptions& o;
  Random random;
  T *x, *best, *start, *lower, *upper;           // configurations
  T *step, *z, *work, *low, *high, *r, *g;       // tangent vectors
  Index *state, *coordinate;                     // of each degree of freedom: its q that has limits, or -1
  Index rows[2] = {0, 0}, iterations = 0;
  bool has_com = false, met = false;

  enum : Index { other_task = 1, failing_task = 2 };
  // What tasks of priority 1 count for while those of priority 0 are not met: less than these by the square.
  static constexpr double secondary = 1e-3;

  void copy(const T* from, T* to) const { std::copy_n(from, m.n.nq, to); }

  void set_limits() {
    for (Index k = 0; k < m.n.nq; ++k) {
      lower[k] = o.limits ? T(o.lower ? o.lower[k] : m.lower_limit()[k]) : -std::numeric_limits<T>::infinity();
      upper[k] = o.limits ? T(o.upper ? o.upper[k] : m.upper_limit()[k]) : std::numeric_limits<T>::infinity();
    }
    for_each_leader(m, [&]<class J>(const Body& b) {
      const int moved = J::nv == 6 ? 3 : J::nq == J::nv ? J::nv : 0;  // what a step is added to
      for (int k = 0; k < J::nv; ++k) coordinate[b.user_v + k] = k < moved ? b.user_q + k : -1;
    });
  }
  void clamp(T* q) const {
    for (Index k = 0; k < m.n.nv; ++k)
      if (const Index c = coordinate[k]; c >= 0) q[c] = std::min(std::max(q[c], lower[c]), upper[c]);
  }
  void place(const T* q) {
    if (q != d.q) copy(q, d.q);
    forward_kinematics<0>(m, d);
    if (has_com) center_of_mass(m, d, 0);
  }
  bool within(const IkResidual& e) const { return e.linear <= o.tolerance_linear && e.angular <= o.tolerance_angular; }
  // At d.q; and whether the tasks of priority 0 are met.
  T cost(bool all) {
    T sum = T(0);
    met = true;
    for (Index k = 0; k < tasks.count; ++k) {
      const dynIkTask& t = tasks[k];
      if (t.priority && !all) continue;
      IkResidual e;
      const T E = ik_cost(m, d, t, e);
      sum += t.priority ? T(secondary * secondary) * E : E;
      if (!t.priority) met = met && within(e);
    }
    return sum;
  }
  LeastSquares<T> linearise(bool all) {
    LeastSquares<T> s{m.n.nv, rows[0] + (all ? rows[1] : 0), d.ik_matrix, d.ik_factor, r, g, 0};
    s.clear();
    for (Index k = 0; k < tasks.count; ++k)
      if (all || !tasks[k].priority) ik_linearise(m, d, tasks[k], tasks[k].priority ? T(secondary) : T(1), s);
    s.finish();
    return s;
  }
  void set_box() {
    for (Index k = 0; k < m.n.nv; ++k) {
      const Index c = coordinate[k];
      low[k] = c < 0 ? -std::numeric_limits<T>::infinity() : lower[c] - x[c];
      high[k] = c < 0 ? std::numeric_limits<T>::infinity() : upper[c] - x[c];
    }
  }
  void move(T* q) {
    ik_retract(m, x, step, q);
    clamp(q);
  }

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
  // Marks the degrees of freedom that move no task but those that fail most at d.q; false when there are none.
  bool mark_failing() {
    auto failure = [&](Index k) {
      IkResidual e;
      ik_cost(m, d, tasks[k], e);
      return tasks[k].priority ? 0 : std::hypot(e.linear, e.angular);
    };
    double worst = 0;
    for (Index k = 0; k < tasks.count; ++k) worst = std::max(worst, failure(k));
    std::fill_n(state, m.n.nv, Index(0));
    for (Index k = 0; k < tasks.count; ++k) {
      const dynIkTask& t = tasks[k];
      if (t.priority) continue;
      const Index mark = failure(k) < 0.5 * worst ? other_task : failing_task;
      if (t.type == DYN_IK_COM || t.type == DYN_IK_POSTURE)
        for (Index c = 0; c < m.n.nv; ++c) state[c] |= mark;
      else
        for (Index i = m.frames()[t.frame].body; i != 0; i = m.bodies()[i].parent) {
          const Body& b = m.bodies()[i];
          visit(b.type, [&]<class J>() {
            for (int c = 0; c < J::nv; ++c) state[b.user_v + c] |= mark;
          });
        }
    }
    return std::find(state, state + m.n.nv, failing_task) != state + m.n.nv;
  }
  // Uniform within the limits; a free flyer and displacements without limits stay where they were at the start. Of the
  // marked ones alone: the others as in the best so far, so that a leg in place stays there when another fails.
  void sample(T* q, bool marked) {
    if (marked) copy(best, q);
    for_each_leader(m, [&]<class J>(const Body& b) {
      if (marked && state[b.user_v] != failing_task) return;
      double from[J::nq], to[J::nq], drawn[J::nq];
      bool bounded = true;
      for (int k = 0; k < J::nq; ++k) {
        from[k] = double(lower[b.user_q + k]), to[k] = double(upper[b.user_q + k]);
        bounded = bounded && std::isfinite(from[k]) && std::isfinite(to[k]);
      }
      J::random(random, from, to, drawn);
      const bool stays = J::nv == 6 || (!J::rotates && !bounded);
      for (int k = 0; k < J::nq; ++k) q[b.user_q + k] = stays ? start[b.user_q + k] : T(drawn[k]);
    });
  }
  // The most promising of some samples.
  void draw(bool partial) {
    place(best);
    const bool marked = partial && mark_failing();
    T least = std::numeric_limits<T>::infinity();
    for (int k = 0; k < 8; ++k) {
      sample(d.q, marked), place(d.q);
      if (const T E = cost(false); k == 0 || E < least) least = E, copy(d.q, x);
    }
  }
  // Number of independent rows of J, by Cholesky with pivots.
  Index rank(const LeastSquares<T>& s) {
    const Index n = s.wide() ? s.rows : s.n;
    T* A = s.factor;
    std::copy_n(s.matrix, s.wide() ? 0 : std::ptrdiff_t(n) * n, A);
    if (s.wide()) {
      std::fill_n(A, std::ptrdiff_t(n) * n, T(0));
      for (Index k = 0; k < s.n; ++k)
        for (Index j = 0; j < n; ++j)
          for (Index i = 0; i < n; ++i) A[i + std::ptrdiff_t(n) * j] += s.column(k)[i] * s.column(k)[j];
    }
    auto at = [&](Index i, Index j) -> T& { return A[i + std::ptrdiff_t(n) * j]; };
    T largest = T(0);
    for (Index k = 0; k < n; ++k) {
      Index p = 0;
      for (Index i = 1; i < n; ++i)
        if (at(i, i) > at(p, p)) p = i;
      const T pivot = at(p, p);
      largest = std::max(largest, pivot);
      if (!(pivot > T(1e-9) * largest)) return k;
      for (Index j = 0; j < n; ++j)
        if (j != p)
          for (Index i = 0; i < n; ++i)
            if (i != p) at(i, j) -= at(i, p) * at(p, j) / pivot;
      for (Index i = 0; i < n; ++i) at(i, p) = at(p, i) = T(0);
    }
    return n;
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
      result.reason = DYN_IK_ITERATIONS;
    } else if (double(pressure) > 100 * result.optimality) {
      result.reason = DYN_IK_LIMITS;
      for_each_leader(m, [&]<class J>(const Body& b) {
        if (b.user_v <= pressed && pressed < b.user_v + J::nv) result.joint = b.joint;
      });
    } else {
      const Index here = rank(s);
      sample(best, false), place(best);
      const Index elsewhere = rank(linearise(false));
      result.reason = here < elsewhere ? DYN_IK_SINGULAR : DYN_IK_LOCAL_MINIMUM;
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
