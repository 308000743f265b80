// Costs of a knot: l = weight / 2 sum_i w_i e_i^2, its gradient J^T W e, and the Gauss-Newton Hessian J^T W J.
#include "algorithm/center_of_mass.hpp"
#include "algorithm/configuration.hpp"
#include "plan/planner.hpp"
#include "spatial/explog.hpp"

namespace dyn::plan {

namespace {

// Of n errors: 1 where the caller gives no weights.
struct Weights {
  double scale;
  const double* each;
  double operator()(Index k) const { return each ? scale * each[k] : scale; }
};

struct CostSum {
  const Model& m;
  Data<double>& d;
  Planner& p;
  const dynPlanPoint& at;
  bool placed = false, weighed = false;

  bool differentiates() const { return at.l_x != nullptr; }
  void add(const dynPlanCost& c) {
    const bool last = at.knot == p.knots;
    const Weights w{(last ? c.terminal_weight : c.weight) * (c.knot_weights ? c.knot_weights[at.knot] : 1), c.weights};
    if (w.scale == 0 || (last && c.type == DYN_PLAN_COST_TYPE_INPUT)) return;
    const double* const reference = c.reference ? c.reference + std::ptrdiff_t(at.knot) * c.reference_stride : nullptr;
    switch (c.type) {
      case DYN_PLAN_COST_TYPE_STATE: return state(w, reference);
      case DYN_PLAN_COST_TYPE_INPUT: return inputs(w, reference);
      case DYN_PLAN_COST_TYPE_COM: return center_of_mass(w, reference);
      default: return frame(c, w, reference);
    }
  }

  // e = q (-) reference, joint by joint, and v - reference.
  void state(const Weights& w, const double* reference) {
    const double *const q0 = reference ? reference : m.neutral(), *const v0 = reference ? reference + p.nq : nullptr;
    for_each_factor(
        m,
        [&](Index iq, Index iv, Index n) {
          for (Index k = 0; k < n; ++k) scalar(iv + k, w(iv + k), at.q[iq + k] - q0[iq + k]);
        },
        [&]<class J>(const Body& b) {
          double e[6], by_0[36], by_q[36];
          J::difference(b, q0 + b.user_q, at.q + b.user_q, e);
          for (int k = 0; k < J::nv; ++k) *at.cost += 0.5 * w(b.user_v + k) * e[k] * e[k];
          if (!differentiates()) return;
          J::difference_jacobians(b, q0 + b.user_q, at.q + b.user_q, Block<double>{by_0, 6}, Block<double>{by_q, 6});
          derivatives(J::nv, e, Weights{w.scale, w.each ? w.each + b.user_v : nullptr}, by_q, 6, b.user_v, J::nv);
        });
    for (Index k = 0; k < p.nv; ++k) scalar(p.nv + k, w(p.nv + k), v0 ? at.v[k] - v0[k] : at.v[k]);
  }
  // An error of its own coordinate of x.
  void scalar(Index k, double w, double e) {
    *at.cost += 0.5 * w * e * e;
    if (differentiates()) at.l_x[k] += w * e, at.l_xx[k + std::ptrdiff_t(p.n) * k] += w;
  }
  void inputs(const Weights& w, const double* reference) {
    for (Index k = 0; k < p.inputs; ++k) {
      const double e = reference ? at.u[k] - reference[k] : at.u[k];
      *at.cost += 0.5 * w(k) * e * e;
      if (differentiates()) at.l_u[k] += w(k) * e, at.l_uu[k + std::ptrdiff_t(p.inputs) * k] += w(k);
    }
  }
  // Of h errors with the Jacobian J, `room` apart, by degrees of freedom from first on.
  void derivatives(Index h, const double* e, const Weights& w, const double* J, Index room, Index first, Index count) {
    for (Index c = 0; c < count; ++c) {
      const double* const column = J + std::ptrdiff_t(room) * c;
      double weighted[6];
      bool zero = true;
      for (Index i = 0; i < h; ++i) weighted[i] = w(i) * column[i], zero = zero && weighted[i] == 0;
      if (zero) continue;
      for (Index i = 0; i < h; ++i) at.l_x[first + c] += weighted[i] * e[i];
      double* const to = at.l_xx + std::ptrdiff_t(p.n) * (first + c);
      for (Index r = 0; r < count; ++r)
        for (Index i = 0; i < h; ++i) to[first + r] += J[i + std::ptrdiff_t(room) * r] * weighted[i];
    }
  }
  void place() {
    if (!placed) forward_kinematics<0>(m, d);
    placed = true;
  }
  void frame(const dynPlanCost& c, const Weights& w, const double* reference) {
    place();
    const FramePose<double> F = frame_pose(m, d, Index(c.frame));
    const bool position = c.type == DYN_PLAN_COST_TYPE_FRAME_POSITION;
    const Index h = error_size(m, c.type, p.inputs);
    double* const e = p.error;
    Mat6<double> D{};
    if (position) {
      store3(reference ? F.p - load3(reference) : F.p, e);
    } else if (c.type == DYN_PLAN_COST_TYPE_FRAME_ORIENTATION) {
      const Vec3<double> r = log3(reference ? transpose(load33(reference)) * F.R : F.R);
      store3(r, e);
      if (differentiates()) D.aa = Jlog3(r);
    } else {
      const SE3<double> X{F.R, F.p};
      const Motion<double> r = log6(reference ? load_se3(reference).inverse() * X : X);
      store6(r, e);
      if (differentiates()) D = Jlog6(r);
    }
    for (Index k = 0; k < h; ++k) *at.cost += 0.5 * w(k) * e[k] * e[k];
    if (!differentiates()) return;
    frame_jacobian(m, d, Index(c.frame), position ? DYN_REFERENCE_LOCAL_WORLD_ALIGNED : DYN_REFERENCE_LOCAL, p.J);
    for (Index k = 0; k < p.nv && !position; ++k) {
      double* const column = p.J + 6 * k;
      const Motion<double> s = load_motion(column);
      if (h == 3) store3(D.aa * s.angular, column);
      else store6(D * s, column);
    }
    derivatives(h, e, w, p.J, 6, 0, p.nv);
  }
  void center_of_mass(const Weights& w, const double* reference) {
    place();
    if (!weighed) dyn::center_of_mass(m, d, 0);
    weighed = true;
    double* const e = p.error;
    for (Index k = 0; k < 3; ++k) {
      e[k] = reference ? d.com[k] - reference[k] : d.com[k];
      *at.cost += 0.5 * w(k) * e[k] * e[k];
    }
    if (!differentiates()) return;
    center_of_mass_jacobian(m, d, Index(0), p.J);
    derivatives(3, e, w, p.J, 3, 0, p.nv);
  }
};

}  // namespace

Index error_size(const Model& m, dynPlanCostType type, Index inputs) {
  switch (type) {
    case DYN_PLAN_COST_TYPE_STATE: return 2 * m.n.nv;
    case DYN_PLAN_COST_TYPE_INPUT: return inputs;
    case DYN_PLAN_COST_TYPE_FRAME_PLACEMENT: return 6;
    default: return 3;
  }
}

Index reference_size(const Model& m, dynPlanCostType type, Index inputs) {
  switch (type) {
    case DYN_PLAN_COST_TYPE_STATE: return m.n.nq + m.n.nv;
    case DYN_PLAN_COST_TYPE_FRAME_ORIENTATION: return 9;
    case DYN_PLAN_COST_TYPE_FRAME_PLACEMENT: return 12;
    default: return error_size(m, type, inputs);
  }
}

int add_cost(const Model& m, Data<double>& d, Planner& p, const Problem& problem, const dynPlanPoint& at) {
  std::copy_n(at.q, p.nq, d.q), std::copy_n(at.v, p.nv, d.v);
  CostSum sum{m, d, p, at};
  for (Index k = 0; k < problem.costs.count; ++k) sum.add(problem.costs[k]);
  return problem.function ? problem.function(problem.context, at) : 0;
}

}  // namespace dyn::plan
