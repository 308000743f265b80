// The most instructions that a call takes of many, by algorithm, for a robot in flash; the results beside the PC's.
#include "boards/through_dyn_h.hpp"
#include "boards/worst.hpp"
#include DYN_TABLES

namespace {

using boards::failed;

constexpr bool steps = DYN_STEPS;
constexpr dynParts parts = steps ? boards::worst_parts_of_steps : boards::worst_parts;
#if DYN_STEPS
alignas(64) __attribute__((section(".slow"))) char memory[data_bytes + 4096];  // and a handle
#else
alignas(64) char memory[128 * 1024];
#endif

// Keeps the longest call of each algorithm, and prints it when the next one begins.
class Longest {
 public:
  template <class Call>
  dynStatus operator()(const char* name, Call&& call) {
    if (name != name_) print(), name_ = name;
    const board::Instructions count;
    const dynStatus status = call();
    const std::uint64_t n = count();
    longest_ = n > longest_ ? n : longest_;
    return status;
  }
  void print() {
    if (name_)
      board::print("  "), board::print(name_), board::print(": "), board::print(longest_), board::print(" instructions\n");
    longest_ = 0;
  }

 private:
  const char* name_ = nullptr;
  std::uint64_t longest_ = 0;
};

}  // namespace

int board::program() {
  const dynModel* m = nullptr;
  dynData* d = nullptr;
  if (dyn_model_from_buffer(image, sizeof image, &m)) return failed("dyn_model_from_buffer");
  if (dyn_data_init(m, parts, memory, sizeof memory, &d)) return failed("dyn_data_init");
  boards::Comparison compare(figures);
  Longest longest;
  if (boards::worst_figures(m, d, steps ? start : nullptr, compare, longest)) return failed("worst_figures");
  longest.print();
  compare.print(dyn_data_size(m, parts));
  // how many touch, the last figure, is compared too
  return compare.worst() <= 1e-10 ? 0 : 1;
}
