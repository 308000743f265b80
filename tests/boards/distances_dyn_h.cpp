// On the board, through dyn.h alone: distances and depths of every pair of convex shapes but hulls, and the PC's results.
#include "boards/distances.hpp"
#include "boards/through_dyn_h.hpp"
#include DYN_TABLES

namespace {

using boards::failed;

alignas(64) __attribute__((section(".slow"))) char memory[data_bytes + 4096];  // and a handle

}  // namespace

int board::program() {
  const dynModel* m = nullptr;
  dynData* d = nullptr;
  if (dyn_model_from_buffer(image, sizeof image, &m)) return failed("dyn_model_from_buffer");
  if (dyn_data_init(m, boards::parts_of_distances, memory, sizeof memory, &d)) return failed("dyn_data_init");
  boards::Comparison compare(figures);
  std::uint64_t all = 0;
  const auto clock = [&](auto&& call) {
    const board::Instructions count;
    const dynStatus status = call();
    all += count();
    return status;
  };
  if (boards::distance_figures(m, d, compare, clock)) return failed("dyn_distances");
  board::print("  distance of a pair: "), board::print(all / (sizeof figures / sizeof figures[0])), board::print(" instructions");
  compare.print(dyn_data_size(m, boards::parts_of_distances));
  return compare.worst() <= 1e-9 ? 0 : 1;
}
