// Inverse kinematics as a problem of least squares in a box: its buffers, its cost, and where a step leads.
#pragma once

#include <limits>

#include "algorithm/ik_tasks.hpp"

namespace dyn {

template <class T>
struct IkProblem {
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

  // What tasks of priority 1 count for while those of priority 0 are not met: less than these by the square.
  static constexpr double secondary = 1e-3;

  IkProblem(const Model& model, Data<T>& data, const IkTasks& list, const dynIkOptions& options)
      : m(model), d(data), tasks(list), o(options), random{options.seed} {
    const Index nq = m.n.nq, nv = m.n.nv;
    T* at = d.ik_vectors;
    for (T** a : {&x, &best, &start, &lower, &upper}) *a = at, at += nq;
    for (T** a : {&step, &z, &work, &low, &high, &r, &g}) *a = at, at += nv;
    state = d.ik_indices + 2 * std::ptrdiff_t(nv);
    coordinate = d.ik_indices + 4 * std::ptrdiff_t(nv);
    for (Index k = 0; k < tasks.count; ++k) {
      rows[tasks[k].priority ? 1 : 0] += row_count(m, tasks[k].type);
      has_com |= tasks[k].type == DYN_IK_TASK_TYPE_COM;
    }
    set_limits();
  }

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
    LeastSquares<T> s{m.n.nv, rows[0] + (all ? rows[1] : 0), d.ik_matrix, d.ik_matrix + std::ptrdiff_t(m.n.nv) * m.n.nv, r, g, 0};
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
};

}  // namespace dyn
