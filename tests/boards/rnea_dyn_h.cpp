// On the board, through dyn.h alone: RNEA of the arm from a model in flash and data in this program's memory, and the PC's
// results.
#include "boards/dice.hpp"
#include "boards/through_dyn_h.hpp"
#include DYN_TABLES

namespace {

using boards::failed;

#if defined DYN_REFUSAL_none
constexpr const char refusal[] = "";
#elif defined DYN_REFUSAL_short
constexpr const char refusal[] = "dyn_rnea q 2 NaN";
#else
constexpr const char refusal[] = "dyn_rnea: q[2] is NaN: give a finite number";
#endif

// The C library's strcmp takes 700 bytes of flash.
bool same(const char* x, const char* y) {
  for (; *x && *x == *y; ++x) ++y;
  return *x == *y;
}

alignas(64) char memory[data_bytes + 2048];  // and a handle
double q[32], v[32], a[32], tau[32];

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
  boards::Comparison compare(figures);
  for (int k = 0; k < nv; ++k) compare(tau[k]);
  // what is refused: each with its status, and tau as it was
  q[2] = __builtin_nan("");
  const double before = tau[2];
  const bool refused =
      dyn_rnea(m, d, q, v, a, nullptr, tau) == DYN_ERROR_NONFINITE && tau[2] == before && same(dyn_last_error(), refusal);
  board::print("  RNEA: "), board::print(instructions), board::print(" instructions\n  refused: ");
  board::print(dyn_last_error());
  compare.print(dyn_data_size(m, DYN_PART_INVERSE));
  return refused && compare.worst() <= 1e-15 ? 0 : 1;
}
