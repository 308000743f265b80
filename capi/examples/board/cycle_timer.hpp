// A control cycle each millisecond by SysTick, the timer of Cortex-M, and how long the longest one took.
#pragma once

#include <cstdint>

class CycleTimer {
 public:
  bool late = false;  // the timer came round: the cycle took longer than a millisecond

  static void start() {
    registers()[reload] = DYN_TICKS / 1000 - 1;
    registers()[value] = 0;
    registers()[control] = 7;  // from the processor's clock, with interrupts
  }
  // First of all in an interrupt: clears the flag of the turn that it begins with.
  static void enter() { [[maybe_unused]] const std::uint32_t flag = registers()[control]; }
  void begin() { began = registers()[value]; }
  void end() {
    const std::uint32_t ended = registers()[value];
    late = registers()[control] >> 16 & 1;
    if (!late && began - ended > worst) worst = began - ended;
  }
  std::uint64_t worst_instructions() const { return std::uint64_t(worst) * 1000 / (DYN_TICKS / 1000000); }

 private:
  enum { control, reload, value };
  static volatile std::uint32_t* registers() { return reinterpret_cast<volatile std::uint32_t*>(0xe000e010); }
  std::uint32_t began = 0, worst = 0;  // ticks; they count down
};
