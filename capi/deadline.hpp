// When a call's time is used up. The clock is the monotonic one, which most machines read without a system call; without a budget
// nothing reads it.
#pragma once

#include <algorithm>
#include <chrono>

namespace dyn::capi {

class Deadline {
 public:
  explicit Deadline(double budget) {
    if (budget > 0)
      end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(budget, 1e9)));
  }
  static bool past(const void* deadline) { return Clock::now() >= static_cast<const Deadline*>(deadline)->end_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point end_;
};

}  // namespace dyn::capi
