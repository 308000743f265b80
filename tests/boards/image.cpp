// On the board: computes the results of the PC for the same model and compares. DYN_IMAGE: results and robot, as in rnea, arm.
#include "board.hpp"
#include "boards/figures.hpp"
#include "model/dynb.hpp"
#include DYN_TABLES

namespace {

alignas(64)
#ifdef DYN_SLOW_MEMORY
    __attribute__((section(".slow")))
#endif
    char memory[data_bytes];

// Difference relative to the larger of 1 and the result.
double worst = 0;
int next = 0;

void compare(double x) {
  const double want = figures[next++], off = std::abs(x - want) / std::max(1.0, std::abs(want));
  if (!(off <= worst)) worst = off;
}

// Instructions of one call, averaged over many.
template <class Call>
void clock(const char* name, int calls, Call&& call) {
  const board::Instructions count;
  for (int k = 0; k < calls; ++k) call();
  const std::uint64_t instructions = count() / std::uint64_t(calls);
  board::print("  "), board::print(name), board::print(": "), board::print(instructions), board::print(" instructions\n");
}

}  // namespace

int board::program() {
  if (const dyn::Damage damage = dyn::check_header(image, sizeof image)) return board::print(damage.what), board::print("\n"), 1;
  const dyn::Model& m = *reinterpret_cast<const dyn::DynbHeader*>(image)->handle.m;
  if (boards::DYN_WORK::bytes(m) > sizeof memory) return board::print("the data has no room\n"), 1;
  boards::DYN_FIGURES(m, memory, compare, [](const char* name, int calls, auto&& call) { clock(name, calls, call); });
  constexpr int count = sizeof figures / sizeof *figures;
#if DYN_REPRODUCIBLE
  const bool good = next == count && worst == 0;
#else
  const bool good = next == count && worst <= 1e-12;
#endif
  board::print("  data "), board::print(std::uint64_t(boards::DYN_WORK::bytes(m))), board::print(" bytes, stack "),
      board::print(board::stack_used());
  board::print("\n  "), board::print(std::uint64_t(next)), board::print(" of "), board::print(std::uint64_t(count));
  board::print(" figures, largest difference "), board::print(std::uint64_t(worst * 1e18)), board::print("e-18\n");
  return good ? 0 : 1;
}
