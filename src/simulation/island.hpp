// The contact problem of an island: its rows one after another, equalities first, then boxes, then contacts.
#pragma once

#include "simulation/step.hpp"

namespace dyn::simulation {

// Rows of a contact, by how many they are: the normal first.
inline constexpr Index order_of[7][6] = {{}, {0}, {}, {2, 0, 1}, {2, 0, 1, 3}, {}, {2, 0, 1, 3, 4, 5}};

struct Island {
  const Model& m;
  Data<double>& d;
  Workspace& w;
  const Index* order;  // of its slots
  Index constraint_count;
  double h;
  const double* v_before;
  Index rows = 0, equalities = 0, boxes = 0, contacts = 0;
  bool bounces = false, supported = false, has_matrix = false, has_cones = false;  // supported: by the world
  double* by_dof = nullptr;  // z = Y^T lambda; zero at the beginning
  double inconsistency = 0;  // share of the speed that equalities contradict one another by
  double fastest = 0;  // speed() at the beginning
  double fast = 0;     // the largest rate of its rows, where steps follow from an accuracy
  enum class Eliminated { Not, Runs, Fits, DoesNotFit };
  Eliminated eliminated = Eliminated::Not;
  Index allowance = 3 * w.options.max_iterations;  // as with the whole matrix

  double* vector(int k) const { return w.vectors + k * padded_rows(step_rows(m)); }
  double *g = vector(0), *bias = vector(1), *lambda = vector(2), *c = vector(3), *compliance = vector(4), *v_minus = vector(5), *lower = vector(6),
         *upper = vector(7), *friction = vector(8), *torsion = vector(9), *rolling = vector(10), *restitution = vector(11), *kept = vector(12);

  ActiveConstraint& constraint(Index k) const { return w.active[order[k]]; }
  std::ptrdiff_t stride() const { return padded_rows(rows); }
  bool large() const { return rows > island_rows(m); }
  bool uses_gauss_seidel_only() const { return w.options.solver == DYN_CONTACT_SOLVER_TYPE_PGS && (large() || !bounces); }  // of small ones restitution's guard is the matrix's

  // numbers and their meaning (island.cpp)
  void assign_rows();
  void fill();

  // by the whole matrix (island_solve.cpp)
  void matrix();
  bool dense_matrix();
  void solve(dynContactReport& best);
  void solve_displacement();
  void project_rhs_to_range();

  // by segments (newton.cpp, interior.cpp): from lambda, to a better one. true: it is good enough
  bool newton(dynContactReport& report, bool from_inside);
  bool sparse();   // worth it: there are more rows than degrees of freedom, or many
  bool ordered();  // its segments for elimination; false: they do not fit

  // without (sweeps.cpp): Gauss-Seidel that knows what rows leave at degrees of freedom. Whether the guess will do; otherwise sweeps
  void prepare_blocks();
  void prepare_cones();
  bool accept_guess(dynContactReport& report);
  void scale_restitution(double factor);
  bool adds_energy(const dynContactReport& report) const;
  void solve_restitution(dynContactReport& report);
  void gauss_seidel(dynContactReport& report);
  void gauss_seidel_and_newton(dynContactReport& report);
  void gauss_seidel_while_improving(dynContactReport& report);  // as long as that makes the residual smaller
  void gauss_seidel_frictionless();
  bool within_budget(const dynContactReport& r) const { return r.iterations + r.newton_steps < allowance && !w.time_is_up(); }
  void solve_fixed_correction(dynContactReport& report);
  double residual() const;  // and by_dof and c of lambda
  double speed() const;  // largest velocity that is to change

  // lambda, c = G lambda + g; the corrections of position: bias is what is wrong, g zero, lambda the displacement (solve_constraints.cpp)
  void impulses(dynContactReport& report);
  void scatter_all(double* by_dof) const;
  // z = 0 where slots carry; z += Y^T by of a slot's rows; G lambda in lanes
  void clear_supporting_dofs(double* z) const;
  DYN_INLINE void scatter(const ActiveConstraint& a, const double* by, double* z) const {
    visit_rows(a.s->rows, [&]<int rows>() DYN_INLINE_LAMBDA {
      const double* y = a.Y;
      for (Index n = 0; n < a.s->support; ++n, y += row_lanes) {
        double sum = 0;
#pragma GCC unroll 6
        for (int r = 0; r < rows; ++r) sum += y[r] * by[r];
        z[a.support[n]] += sum;
      }
    });
  }
  DYN_INLINE Pack<double, row_lanes> gather(const ActiveConstraint& a, const double* Dinv, const double* z) const {
    using P = Pack<double, row_lanes>;
    P sum = P::zero();
    const double* y = a.Y;
    for (Index n = 0; n < a.s->support; ++n, y += row_lanes) sum = sum + P::load(y) * (Dinv[a.support[n]] * z[a.support[n]]);
    return sum;
  }
  bool is_angle(const ActiveConstraint& x, Index row) const;
  bool correct();
};

}  // namespace dyn::simulation
