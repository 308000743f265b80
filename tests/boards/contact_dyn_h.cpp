// On the board, through dyn.h alone: a quadruped that lands on its feet, with data in this program's memory and bounded
// iterations of the contact solver, and the PC's results.
#include "board.hpp"
#include "dyn.h"
#include DYN_TABLES

namespace {

constexpr dynParts parts = DYN_PART_SIMULATION | DYN_PART_CHOLESKY;
alignas(64) __attribute__((section(".slow"))) char memory[data_bytes + 4096];  // and a handle
double worst = 0;
int next = 0;

void compare(double x) {
  const double want = figures[next++], off = __builtin_fabs(x - want) / __builtin_fmax(1, __builtin_fabs(want));
  if (!(off <= worst)) worst = off;
}

int failed(const char* what) {
  board::print(what), board::print(": "), board::print(dyn_last_error()), board::print("\n");
  return 1;
}

}  // namespace

int board::program() {
  const dynModel* m = nullptr;
  dynData* d = nullptr;
  if (dyn_model_from_buffer(image, sizeof image, &m)) return failed("dyn_model_from_buffer");
  if (dyn_data_init(m, parts, memory, sizeof memory, &d)) return failed("dyn_data_init");
  dynStepOptions options;
  dyn_step_options_init(&options);
  options.max_iterations = 50;
  if (dyn_data_set_step_options(m, d, &options)) return failed("dyn_data_set_step_options");
  // effects as algorithms have them, not as the file states them: the PC's step is that of internal headers
  if (dyn_data_set_effects(m, d, 0, DYN_EFFECT_DEFAULT & DYN_EFFECT_ALL)) return failed("dyn_data_set_effects");
  double q[19] = {0, 0, 0.331, 0, 0, 0, 1, 0, 0.8, -1.5, 0, 0.8, -1.5, 0, 0.8, -1.5, 0, 0.8, -1.5};
  if (dyn_data_set_state(m, d, q, nullptr, nullptr, nullptr)) return failed("dyn_data_set_state");
  constexpr int steps = 20;
  std::uint64_t all = 0, longest = 0;
  std::int64_t iterations = 0;
  dynStepReport report;
  report.struct_size = sizeof report;
  for (int k = 0; k < steps; ++k) {
    const board::Instructions count;
    if (dyn_step(m, d)) return failed("dyn_step");
    const std::uint64_t n = count();
    all += n, longest = n > longest ? n : longest;
    if (dyn_data_step_report(m, d, &report)) return failed("dyn_data_step_report");
    iterations = report.iterations > iterations ? report.iterations : iterations;
  }
  compare(report.contacts);
  dynArray x;
  x.struct_size = sizeof x;
  constexpr const char* names[] = {"q", "v"};
  for (const char* name : names) {
    if (dyn_data_array(m, d, dyn_field_id(name), &x)) return failed("dyn_data_array");
    for (int k = 0; k < x.rows; ++k) compare(x.data[k]);
  }
  board::print("  step with contacts: "), board::print(all / steps), board::print(" instructions\n  longest step: ");
  board::print(longest), board::print(" instructions\n  at most "), board::print(std::uint64_t(iterations));
  board::print(" iterations a step, unsolved "), board::print(std::uint64_t(report.unsolved));
  board::print("\n  data "), board::print(std::uint64_t(dyn_data_size(m, parts))), board::print(" bytes, stack ");
  board::print(board::stack_used()), board::print("\n  "), board::print(std::uint64_t(next)), board::print(" of ");
  board::print(std::uint64_t(sizeof figures / sizeof *figures)), board::print(" figures, largest difference ");
  board::print(std::uint64_t(worst * 1e18)), board::print("e-18\n");
  const bool good = worst <= 1e-12 && report.unsolved == 0 && iterations <= 50 && sizeof memory <= 512 * 1024;
  // what is refused: a result of another state, data that is gone
  const bool stale = dyn_cholesky(m, d) == DYN_ERROR_STALE;
  dyn_data_free(d);
  return good && stale && dyn_step(m, d) == DYN_ERROR_HANDLE ? 0 : 1;
}
