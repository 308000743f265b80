// Block Gauss-Seidel on an island with Anderson's acceleration (Walker and Ni 2011), for a residual of about 1e-4.
// In the units of island_rows.cpp, by z = Y'^T y at the degrees of freedom: c = wanted + Y' z + soft y, z += Y'^T change.
#pragma once

#include "simulation/island.hpp"

namespace dyn::simulation {

class AcceleratedSweeps {
 public:
  // Needs the island's rows (Island::build_rows). Starts from its lambda.
  explicit AcceleratedSweeps(const Island& island);
  // Largest |y - P_K(y - u)| as a velocity (solver/residuals.hpp).
  double residual() const;
  // Improves y until the residual meets the tolerance, no longer falls, or `most` sweeps are made.
  void run(Index most, dynContactReport& report);
  // Smallest normal impulses, without friction and compliance, from y = 0, to a share of the first sweep's change.
  void frictionless(int most, double share);
  // The island's lambda from y; finish also sets its c and by_dof, and returns the residual.
  void write() const;
  double finish();
  // y from the island's lambda.
  void load();

 private:
  static constexpr int W = segment_lanes, depth = tuning::acceleration::depth;
  using P = Simd<double, W>;

  const Island& x;
  Workspace& w;
  const Elimination& e;
  std::ptrdiff_t room;
  double *y = w.newton_vectors, *wanted = y + room, *from = wanted + room, *best = from + room;
  // of the last sweeps: their results and changes, and differences between consecutive ones
  double *result = best + room, *change = result + room, *results = change + room, *changes = results + depth * room;
  double gram[depth][depth];
  int kept = 0, next = 0;
  bool has_last = false;

  template <class F>
  void for_each(F&& f) const {
    for (Index k = 0; k < x.constraint_count; ++k) f(x.constraint(k), w.row_blocks[k], k);
  }
  // Calls f.template operator()<number of rows>().
  template <class F>
  static DYN_INLINE void by_rows(const RowBlock& s, F&& f);
  template <int rows_>
  DYN_INLINE void gather(Index constraint, double* c) const;
  template <int rows_>
  DYN_INLINE void scatter(Index constraint, const double* by) const;
  void start() const;
  double sweep() const;
  template <int rows_>
  DYN_INLINE double row(const RowBlock& s, Index k, double* l, const double* g, Index r) const;
  DYN_INLINE double point(RowBlock& s, Index k, double* l, const double* g) const;
  template <int rows_>
  DYN_INLINE double cone(const RowBlock& s, Index k, double* l, const double* g) const;
  void accelerate(bool grew);
  void project() const;
  template <class F>
  double residual(F&& f) const;
};

}  // namespace dyn::simulation
