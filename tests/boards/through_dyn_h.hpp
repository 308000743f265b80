// What images through dyn.h share: errors, and results beside the PC's.
#pragma once

#include "board.hpp"
#include "dyn.h"

namespace boards {

inline int failed(const char* what) {
  board::print(what), board::print(": "), board::print(dyn_last_error()), board::print("\n");
  return 1;
}

// The PC's results, one after the other.
class Comparison {
 public:
  template <std::size_t n>
  explicit Comparison(const double (&figures)[n]) : figures_(figures), all_(n) {}
  void operator()(double x) {
    const double want = figures_[next_++], off = __builtin_fabs(x - want) / __builtin_fmax(1, __builtin_fabs(want));
    if (!(off <= worst_)) worst_ = off;
  }
  double worst() const { return worst_; }
  // After the data and stack that were used.
  void print(std::size_t data) const {
    board::print("\n  data "), board::print(std::uint64_t(data)), board::print(" bytes, stack ");
    board::print(board::stack_used()), board::print("\n  "), board::print(std::uint64_t(next_)), board::print(" of ");
    board::print(std::uint64_t(all_)), board::print(" figures, largest difference ");
    board::print(std::uint64_t(worst_ * 1e18)), board::print("e-18\n");
  }

 private:
  const double* figures_;
  std::size_t all_;
  int next_ = 0;
  double worst_ = 0;
};

}  // namespace boards
