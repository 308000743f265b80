// On the board, through dyn.h alone: a quadruped that lands on its feet, with data in this program's memory and bounded
// iterations of the contact solver, and the PC's results.
#include "boards/through_dyn_h.hpp"
#include DYN_TABLES

namespace {

using boards::failed;

constexpr dynParts parts = DYN_PART_SIMULATION | DYN_PART_CHOLESKY;
alignas(64) __attribute__((section(".slow"))) char memory[data_bytes + 4096];  // and a handle

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
  boards::Comparison compare(figures);
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
  compare.print(dyn_data_size(m, parts));
  const bool good = compare.worst() <= 1e-12 && report.unsolved == 0 && iterations <= 50 && sizeof memory <= 512 * 1024;
  // what is refused: a result of another state, data that is gone
  const bool stale = dyn_cholesky(m, d) == DYN_ERROR_STALE;
  dyn_data_free(d);
  return good && stale && dyn_step(m, d) == DYN_ERROR_HANDLE ? 0 : 1;
}
