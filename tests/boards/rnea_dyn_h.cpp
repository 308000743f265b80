// On the board, through dyn.h alone: RNEA of the arm from a model in flash and data in this program's memory, and the PC's
// results.
#include <cstring>

#include "board.hpp"
#include "boards/dice.hpp"
#include "dyn.h"
#include DYN_TABLES

namespace {

alignas(64) char memory[data_bytes + 2048];  // and a handle
double q[32], v[32], a[32], tau[32];

int failed(const char* what) {
  board::print(what), board::print(": "), board::print(dyn_last_error()), board::print("\n");
  return 1;
}

}  // namespace

int board::program() {
  const dynModel* m = nullptr;
  dynData* d = nullptr;
  if (dyn_model_from_buffer(image, sizeof image, &m)) return failed("dyn_model_from_buffer");
  if (dyn_data_init(m, DYN_PART_INVERSE, memory, sizeof memory, &d)) return failed("dyn_data_init");
  const int nv = dyn_model_nv(m);
  boards::Dice dice;
  for (int k = 0; k < nv; ++k) q[k] = 0.5 * dice();
  for (int k = 0; k < nv; ++k) v[k] = dice(), a[k] = dice(), dice();
  constexpr int calls = 100;
  const board::Instructions count;
  for (int k = 0; k < calls; ++k)
    if (dyn_rnea(m, d, q, v, a, nullptr, tau)) return failed("dyn_rnea");
  const std::uint64_t instructions = count() / calls;
  double worst = 0;
  for (int k = 0; k < nv; ++k) {
    const double want = figures[k], off = __builtin_fabs(tau[k] - want) / __builtin_fmax(1, __builtin_fabs(want));
    if (!(off <= worst)) worst = off;
  }
  // what is refused: each with its status, and tau as it was
  q[2] = __builtin_nan("");
  const double before = tau[2];
  const bool refused = dyn_rnea(m, d, q, v, a, nullptr, tau) == DYN_ERROR_NONFINITE && tau[2] == before;
  board::print("  RNEA: "), board::print(instructions), board::print(" instructions\n  refused: ");
  board::print(dyn_last_error());
  board::print("\n  data "), board::print(std::uint64_t(dyn_data_size(m, DYN_PART_INVERSE))), board::print(" bytes, stack ");
  board::print(board::stack_used()), board::print("\n  "), board::print(std::uint64_t(nv)), board::print(" of ");
  board::print(std::uint64_t(sizeof figures / sizeof *figures)), board::print(" figures, largest difference ");
  board::print(std::uint64_t(worst * 1e18)), board::print("e-18\n");
  return refused && worst <= 1e-15 ? 0 : 1;
}
