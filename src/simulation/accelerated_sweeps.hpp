// Block Gauss-Seidel on an island with Anderson's acceleration (Walker and Ni 2011), for a residual of about 1e-4.
// Rows are scaled by the square roots of the pivots, Y' = Y D^-1/2 and z' = D^-1/2 z: c = g + Y'^T z', z' += Y' change.
// They lie in lanes by degree of freedom, segment by segment (elimination.hpp), the normal first.
#pragma once

#include "simulation/island.hpp"

namespace dyn::simulation {

class AcceleratedSweeps {
 public:
  // Needs the island's blocks and the runs of its constraints (Elimination::find_runs).
  explicit AcceleratedSweeps(const Island& island);
  // Improves the island's lambda until the residual meets the tolerance, no longer falls, or `most` sweeps are made.
  // Returns true when the tolerance is met.
  bool run(Index most, dynContactReport& report);
  // Smallest normal impulses, without friction, from lambda = 0, to a share of the first sweep's change.
  void frictionless(int most, double share);

 private:
  static constexpr int W = segment_lanes, depth = tuning::acceleration::depth;
  using P = Simd<double, W>;

  const Island& x;
  Workspace& w;
  const Elimination& e;
  std::ptrdiff_t room;
  Index rows = 0;  // of lambda here: contacts without friction have one
  double *y = w.newton_vectors, *wanted = y + room, *weight = wanted + room, *from = weight + room, *best = from + room;
  // of the last sweeps: their results and changes (weighted), and differences between consecutive ones
  double *result = best + room, *change = result + room, *results = change + room, *changes = results + depth * room;
  double gram[depth][depth];
  int kept = 0, next = 0;
  bool has_last = false;

  template <class F>
  void for_each(F&& f) const {
    for (Index k = 0; k < x.constraint_count; ++k) f(x.constraint(k), w.sweep_blocks[k], k);
  }
  template <int rows_>
  DYN_INLINE void gather(Index constraint, double* c) const;
  template <int rows_>
  DYN_INLINE void scatter(Index constraint, const double* by) const;
  void start() const;
  double sweep() const;
  template <int rows_>
  DYN_INLINE double row(SweepBlock& s, Index k, Index r, double lower, double upper) const;
  template <int rows_>
  DYN_INLINE double cone(SweepBlock& s, Index k) const;
  void accelerate(bool grew);
  void project() const;
  void write(const double* from) const;
};

}  // namespace dyn::simulation
