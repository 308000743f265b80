#pragma once

#include <cstdint>

namespace boards {

// Random numbers in [-1, 1), the same on all machines.
class Dice {
 public:
  double operator()() {
    state_ ^= state_ << 13, state_ ^= state_ >> 7, state_ ^= state_ << 17;
    return double(std::int64_t(state_) >> 11) * 0x1p-52;
  }

 private:
  std::uint64_t state_ = 88172645463325252u;
};

}  // namespace boards
