// The contact problem of an island: rows of equalities first, then of boxes (bounded rows), then of contacts.
#pragma once

#include "simulation/step.hpp"

namespace dyn::simulation {

// Permutation of a contact's rows that puts the normal first, by their number.
inline constexpr Index order_of[7][6] = {{}, {0}, {}, {2, 0, 1}, {2, 0, 1, 3}, {}, {2, 0, 1, 3, 4, 5}};

template <class Operator>
class Sweeps;
struct BySegments;

struct Island {
  const Model& m;
  Data<double>& d;
  Workspace& w;
  const Index* order;  // of its constraints
  Index constraint_count;
  double h;
  const double* v_before;
  Index rows = 0, equalities = 0, boxes = 0, contacts = 0, dropped = 0;  // dropped: redundant rows of equalities
  bool bounces = false, supported = false, has_matrix = false, has_cones = false, has_rows = false;  // supported: by the world
  double* by_dof = nullptr;  // z = Y^T lambda; zero at the beginning
  double inconsistency = 0;  // inconsistency of the equalities, relative to the speed
  double fastest = 0;  // speed() at the beginning
  double slack = 0;  // gap (m) that pressed contacts keep
  double fast = 0;     // largest rate of its rows (m/s), when closed_gap > 0
  enum class Eliminated { Not, Runs, NoRuns, Order, NoOrder };
  Eliminated eliminated = Eliminated::Not;
  double tolerance = w.tolerance();  // of the residual that ends the solve
  double enough = tolerance;  // residual with which no other method is tried
  Index allowance =
      std::min(w.max_iterations(), tuning::island::rounds* w.method_iterations());  // iterations, summed over all methods

  double* vector(int k) const { return w.vectors + k * padded_rows(step_rows(m)); }
  double *g = vector(0), *bias = vector(1), *lambda = vector(2), *c = vector(3), *compliance = vector(4), *v_minus = vector(5),
         *kept = vector(6);
  // of bounded rows; of contacts
  double *lower = w.bounds, *upper = lower + step_bounds(m);
  double *friction = w.coefficients, *torsion = friction + m.n.contacts, *rolling = torsion + m.n.contacts,
         *restitution = rolling + m.n.contacts;

  ActiveConstraint& constraint(Index k) const { return w.active[order[k]]; }
  DYN_INLINE PropagatedRows rows_of(const ActiveConstraint& a) const {
    if (a.kept.Y) [[likely]] return a.kept;
    return propagate_anew(m, d, a, 0);
  }
  DYN_INLINE PropagatedRows rows_of(Index k) const { return rows_of(constraint(k)); }
  std::ptrdiff_t stride() const { return padded_rows(rows); }
  bool large() const { return rows > tuning::default_solve::small_rows; }
  bool has_room_for_matrix() const { return rows <= w.solver.max_rows; }
  // small islands with restitution use the dense solver, which guards the energy
  bool uses_sweeps_only() const {
    return w.options.solver == DYN_CONTACT_SOLVER_TYPE_PGS && (!has_room_for_matrix() || !bounces);
  }

  // island.cpp: numbers rows, fills vectors
  void assign_rows();
  void fill();
  // rows as the file has them: compliant_rows.cpp, convex_solve.cpp
  void fill_as_file();
  bool solve_as_file(dynContactReport& report);  // returns false, and does nothing, where it has no room
  bool is_as_file() const { return w.options.contact_model == DYN_CONTACT_MODEL_AS_FILE; }
  double wanted(double residual, double usual) const;  // residual with which the solve from a guess of `residual` ends
  void drop_redundant();
  void keep_all();

  // dense Delassus matrix (island_solve.cpp)
  void matrix();
  bool dense_matrix();
  void solve(dynContactReport& best);
  void soften_far_equalities();
  void solve_displacement(bool far);
  void project_rhs_to_range();

  // segments (newton.cpp, interior.cpp): start from lambda and improve it. They return true when the tolerance is met.
  bool newton(dynContactReport& report, bool from_inside);
  bool sparse();   // whether segments are cheaper than the dense matrix
  bool has_runs();  // finds the runs of its constraints; returns false if they do not fit
  bool ordered();  // finds the elimination order; returns false if it does not fit

  // blocks, and rows by segments (island_rows.cpp)
  void prepare_blocks();
  void prepare_sweeps();
  void scaled_block(Index k, double* G) const;
  void build_rows();  // needs prepare_blocks and has_runs

  // sweeps and what starts from them (exact_solve.cpp, restitution.cpp)
  template <class F>
  void with_sweeps(F&& f);
  bool accept_guess(dynContactReport& report);
  void accelerated_sweeps(Index most, dynContactReport& report);  // alone
  void solve_without_guess(dynContactReport& report);
  void sweeps_and_newton(dynContactReport& report);
  void sweep_while_improving(dynContactReport& report);
  struct PositionErrors {
    double largest = 0, over = 1;  // of the length, or rad; over what a step corrects
    bool far = false;              // an equality is further off than a step corrects
  };
  PositionErrors find_position_errors(double shared);
  bool correct_by_sweeps(double softness);
  double free_share(Index k) const;
  void scale_restitution(double factor);
  bool adds_energy(const dynContactReport& report) const;
  void solve_restitution(dynContactReport& report);
  bool within_budget(const dynContactReport& r) const { return r.iterations + r.newton_steps < allowance && !w.time_is_up(); }
  Index left(const dynContactReport& r) const { return w.max_iterations() - r.iterations - r.newton_steps; }
  // Whether the solve goes on to a fine residual: if asked for, and where that costs little.
  bool is_exact() const { return w.has_tolerance() || contacts == 0 || rows <= tuning::island::exact_rows; }
  void solve_to_default(dynContactReport& report);
  void solve_by_segments(double fine, Sweeps<BySegments>& sweeps, dynContactReport& report);
  bool solve_finely(Index most, double fine, dynContactReport& report);
  void solve_exactly(dynContactReport& report);
  bool relaxation_is_due() const;  // now and then
  bool relax(double tolerated);
  void solve_fixed_correction(dynContactReport& report);
  double residual();  // over the speed; also sets by_dof and c for lambda
  double speed() const;  // largest velocity that is to change

  // Impulses lambda and c = G lambda + g, then the position correction with bias the error and g = 0 (solve_constraints.cpp).
  void impulses(dynContactReport& report);
  void scatter_all() const;
  // clear: by_dof = 0 at supporting dofs. scatter: by_dof += Y^T by. gather: Y D^-1 by_dof = G lambda, rows in lanes.
  void clear_supporting_dofs() const;
  DYN_INLINE void scatter(const ActiveConstraint& a, const double* by) const {
    const PropagatedRows of = rows_of(a);
    with_row_count(a.rows, [&]<int rows>() DYN_INLINE_LAMBDA {
      const double* y = of.Y;
      for (Index n = 0; n < a.support_count; ++n, y += row_lanes) {
        double sum = 0;
#pragma GCC unroll 6
        for (int r = 0; r < rows; ++r) sum += y[r] * by[r];
        by_dof[of.support[n]] += sum;
      }
    });
  }
  DYN_INLINE Simd<double, row_lanes> gather(const ActiveConstraint& a, const double* Dinv) const {
    using P = Simd<double, row_lanes>;
    P sum = P::zero();
    const PropagatedRows of = rows_of(a);
    const double* y = of.Y;
    for (Index n = 0; n < a.support_count; ++n, y += row_lanes)
      sum = sum + P::load(y) * (Dinv[of.support[n]] * by_dof[of.support[n]]);
    return sum;
  }
  bool is_angle(const ActiveConstraint& x, Index row) const;
  bool correct();
};

}  // namespace dyn::simulation
