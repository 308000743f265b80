// Block Gauss-Seidel (solver/sweep.hpp) on an island, alone and with Anderson's acceleration (Walker and Ni 2011).
#pragma once

#include "simulation/delassus_operator.hpp"

namespace dyn::simulation {

template <class Operator>
class Sweeps {
 public:
  // Starts from the island's lambda.
  explicit Sweeps(Island& island);
  // Largest |y - P_K(y - u)| as a velocity (solver/residuals.hpp), over the speed.
  double residual() const;
  // Returns the largest change of a row's velocity by its own impulse.
  double sweep() const;
  // Improves y until the residual meets the tolerance, no longer falls, or `most` sweeps are made.
  void run(Index most, dynContactReport& report);
  // Smallest normal impulses, without friction and compliance, from y = 0, to a share of the first sweep's change. Rows give way
  // by `softness` (Island::free_share). Returns false if softness is 0 and changes grow, as of rows that contradict each other.
  bool frictionless(int most, double share, double softness);
  // The island's lambda from y.
  void write() const;
  // Sets the island's c and by_dof. Returns the residual.
  double settle() const;
  // Projects y, then writes and settles it.
  double finish();
  // y from the island's lambda.
  void load();

 private:
  static constexpr int depth = tuning::sweeps::depth;
  static_assert(6 + 2 * depth <= newton_vectors, "vectors below: results and changes, and six others");
  using Block = solver::Block;

  Island& x;
  Workspace& w;
  Operator G;
  std::ptrdiff_t room;
  double *y = w.newton_vectors, *wanted = y + room, *from = wanted + room, *best = from + room;
  // of the last sweeps: their results and changes, and differences between consecutive ones
  double *result = best + room, *change = result + room, *results = change + room, *changes = results + depth * room;
  double gram[depth][depth];
  int kept = 0, next = 0;
  bool has_last = false;

  void accelerate(bool grew);
  void project() const;
  template <class F>
  double residual(F&& f) const;
};

extern template class Sweeps<ByDofs>;
extern template class Sweeps<BySegments>;

}  // namespace dyn::simulation
