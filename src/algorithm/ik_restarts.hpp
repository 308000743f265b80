// Where inverse kinematics starts again.
#pragma once

#include "algorithm/ik_problem.hpp"
#include "base/portable.hpp"

namespace dyn {

template <class T>
struct IkRestarts : IkProblem<T> {
  using P = IkProblem<T>;
  using P::P, P::m, P::d, P::tasks, P::x, P::best, P::start, P::lower, P::upper, P::state, P::random;
  enum : Index { other_task = 1, failing_task = 2 };

  // Marks the degrees of freedom that move no task but those that fail most at d.q; false when there are none.
  bool mark_failing() {
    auto failure = [&](Index k) {
      IkResidual e;
      ik_cost(m, d, tasks[k], e);
      return tasks[k].priority ? 0 : math::hypot(e.linear, e.angular);
    };
    double worst = 0;
    for (Index k = 0; k < tasks.count; ++k) worst = std::max(worst, failure(k));
    std::fill_n(state, m.n.nv, Index(0));
    for (Index k = 0; k < tasks.count; ++k) {
      const dynIkTask& t = tasks[k];
      if (t.priority) continue;
      const Index mark = failure(k) < 0.5 * worst ? other_task : failing_task;
      if (t.type == DYN_IK_TASK_TYPE_COM || t.type == DYN_IK_TASK_TYPE_POSTURE)
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
    if (marked) this->copy(best, q);
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
    this->place(best);
    const bool marked = partial && mark_failing();
    T least = std::numeric_limits<T>::infinity();
    for (int k = 0; k < 8; ++k) {
      sample(d.q, marked), this->place(d.q);
      if (const T E = this->cost(false); k == 0 || E < least) least = E, this->copy(d.q, x);
    }
  }
};

}  // namespace dyn
