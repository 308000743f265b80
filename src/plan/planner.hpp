// Optimal control of N steps: box-constrained differential dynamic programming (Tassa, Mansard, Todorov 2014) from states that
// need not be a motion (Mastalli et al. 2020). The step from knot k ends at x[k + 1] (+) gap[k]; x = (q, v), on tangent spaces.
#pragma once

#include "base/struct_array.hpp"
#include "model/data.hpp"
#include "solver/dense.hpp"

namespace dyn::plan {

// The caller's problem, checked.
struct Problem {
  StructArray<dynPlanCost> costs;
  // Adds the caller's own cost at a point. Returns non-zero to end. nullptr: none.
  int (*function)(void* context, const dynPlanPoint& point);
  void* context;
};

// Numbers of each knot side by side. The end of each padded column is zero.
struct Planner {
  std::uint64_t model_id;
  Index knots, nq, nv, n, inputs;  // n = 2 nv
  Index ld, input_ld;              // padded n and inputs
  dynPlanInput input;
  bool has_states;  // false: the guess is the motion by u
  // the plan, and the trial of a line search
  double *q, *v, *u, *gaps;
  double *trial_q, *trial_v, *trial_u;
  // bounds; the free inputs, whose bounds differ, in ascending order
  double *lower, *upper;
  Index* free;
  Index free_count;
  // the linear-quadratic problem: A n x n and B n x free_count, by padded columns; costs, not padded, with all inputs
  double *A, *B, *l_x, *l_u, *l_xx, *l_ux, *l_uu;
  double *k, *K;  // step of the inputs, and feedback inputs x n
  // of one knot: value function, Q, and products; padded columns
  double *V_x, *V_xx, *VA, *VB, *Q_x, *Q_u, *Q_xx, *Q_ux, *Q_uu, *gain, *product, *step;
  // of the box
  double *factor, *box_lower, *box_upper, *dual, *work;
  Index* box_state;
  double *dx, *next_dx, *du;
  // of costs: error and Jacobian of one
  double *error, *J;
  // of the data, kept
  double *tau, *ctrl, *actuator_force;
  char* state;

  double* A_of(Index k) const { return A + std::ptrdiff_t(k) * n * ld; }
  double* B_of(Index k) const { return B + std::ptrdiff_t(k) * inputs * ld; }
  double* K_of(Index k) const { return K + std::ptrdiff_t(k) * inputs * n; }
};

// state_bytes: of the state of a simulation, which the caller keeps in Planner::state.
std::size_t planner_bytes(const Model& m, Index knots, dynPlanInput input, std::size_t state_bytes);
Planner* place_planner(const Model& m, Index knots, dynPlanInput input, std::size_t state_bytes, void* memory);
void shift(Planner& p, Index knots);

// Bounds of the inputs where the caller gives none.
double default_bound(const Model& m, dynPlanInput input, Index k, bool upper);

// Adds the cost of a knot at the state (q, v) and input u (nullptr at the last knot), with derivatives in p if wanted. Returns
// non-zero when the caller's function does.
int add_cost(const Model& m, Data<double>& d, Planner& p, const Problem& problem, const dynPlanPoint& at);
Index reference_size(const Model& m, dynPlanCostType type, Index inputs);
Index error_size(const Model& m, dynPlanCostType type, Index inputs);
inline bool is_of_frame(dynPlanCostType type) {
  return type == DYN_PLAN_COST_TYPE_FRAME_POSITION || type == DYN_PLAN_COST_TYPE_FRAME_ORIENTATION ||
         type == DYN_PLAN_COST_TYPE_FRAME_PLACEMENT;
}

// Solves the linear-quadratic problem backwards: p.k and p.K. Returns false if a Hessian of the inputs is not positive definite.
bool solve_backward(Planner& p, double regularisation);
// Change of the cost along the solution: linear + quadratic / 2, of the whole step.
struct Expected {
  double linear, quadratic;
};
Expected expected_change(Planner& p);

enum class Failure { None, Cancelled, Unsupported, NotFinite };
struct Result {
  dynPlanReport report;
  Failure failure;
  const char* reason;  // of Unsupported
};
// Lowers the cost from the plan in p. The data's state is that of the plan's beginning, and is lost.
Result solve(const Model& m, Data<double>& d, Planner& p, const Problem& problem, const dynPlanOptions& options);

}  // namespace dyn::plan
