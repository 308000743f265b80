// The contact problem of an island: its rows one after another, equalities first, then boxes, then contacts.
#pragma once

#include "dyn/simulation/step.hpp"

namespace dyn::simulation {

struct Island {
  const Model& m;
  Data<double>& d;
  Workspace& w;
  const Index* order;  // of its slots
  Index slots;
  double h;
  const double* v_before;
  Index rows = 0, equalities = 0, boxes = 0, contacts = 0;
  bool bounces = false, has_matrix = false;

  double* vector(int k) const { return w.vectors + k * row_room(step_rows(m)); }
  double *g = vector(0), *bias = vector(1), *lambda = vector(2), *c = vector(3), *compliance = vector(4), *v_minus = vector(5), *lower = vector(6),
         *upper = vector(7), *friction = vector(8), *torsion = vector(9), *rolling = vector(10), *restitution = vector(11);

  ActiveSlot& slot(Index k) const { return w.active[order[k]]; }
  std::ptrdiff_t stride() const { return row_room(rows); }
  bool large() const { return rows > island_rows(m); }

  // numbers and their meaning (island.cpp)
  void number();
  void fill();

  // by the whole matrix (island_solve.cpp)
  void matrix();
  void solve(dynContactReport& best);
  void displace();

  // without (sweeps.cpp): Gauss-Seidel that knows what rows leave at degrees of freedom. Whether the guess will do; otherwise sweeps
  void prepare_blocks();
  bool stays(dynContactReport& report) const;
  void sweep_to_rest(dynContactReport& report);
  void sweep_apart();
  double speed() const;  // largest velocity that is to change
  void velocities() const;

  // lambda, c = G lambda + g; the corrections of position: bias is what is wrong, g zero, lambda the displacement (solve_slots.cpp)
  void impulses(dynContactReport& report);
  void add(double* by_dof) const;
  bool correct(double* by_dof);
};

}  // namespace dyn::simulation
