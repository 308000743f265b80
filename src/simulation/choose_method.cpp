// Chooses between the dense Delassus matrix and elimination by segments.
#include "simulation/newton.hpp"

namespace dyn::simulation {

// Compares the price of a factorization: dense rows^3 against blocks of segments, in the same unit.
bool Island::sparse() {
  has_runs();
  const double whole = double(rows) * rows * rows, block = tuning::newton::block_price;
  const bool dense = has_room_for_matrix();
  if (dense && whole <= block * w.elimination.size) return false;
  return ordered() && (!dense || whole > block * (w.elimination.size + w.elimination.entries()));
}

bool Island::has_runs() {
  if (eliminated == Eliminated::Not) eliminated = w.elimination.find_runs(*this) ? Eliminated::Runs : Eliminated::NoRuns;
  return eliminated != Eliminated::NoRuns;
}

bool Island::ordered() {
  if (eliminated == Eliminated::Runs) eliminated = w.elimination.find_order(*this) ? Eliminated::Order : Eliminated::NoOrder;
  return eliminated == Eliminated::Order;
}

bool Island::newton(dynContactReport& report, bool from_inside) {
  if (!sparse()) return false;
  build_rows();
  if (from_inside) return interior(*this, report);
  Newton method(*this);
  if (method.run(report)) return true;
  method.write_best(report);
  return false;
}

}  // namespace dyn::simulation
