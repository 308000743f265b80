// What the tests ask of a board: text, an end, a clock. Here by semihosting, which QEMU and debuggers answer; for a product, a
// UART's.
#pragma once

#include <cstdint>

namespace board {

inline std::uint32_t semihosting(std::uint32_t operation, const void* argument) {
  register std::uint32_t r0 __asm("r0") = operation;
  register const void* r1 __asm("r1") = argument;
  __asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}
inline void print(const char* text) { semihosting(4, text); }
[[noreturn]] inline void exit(int status) {
  const std::uint32_t block[2] = {0x20026, std::uint32_t(status)};
  for (;;) semihosting(0x20, block);
}
inline void print(std::uint64_t n) {
  char text[21], *p = text + 20;
  *p = 0;
  do *--p = char('0' + n % 10);
  while (n /= 10);
  print(p);
}

// What runs, in the place of main.
int program();

// Bytes of stack since reset.
std::uint32_t stack_used();

// SysTick counts down 24 bits at the processor's clock. Under QEMU's -icount shift=0 an instruction takes 1 ns, and a tick of the
// 25 MHz 40.
class Ticks {
 public:
  Ticks() {
    reload() = 0xffffff;
    value() = 0;
    control() = 5;
  }
  std::uint32_t operator()() const { return (0xffffff - value()) & 0xffffff; }

 private:
  static volatile std::uint32_t& control() { return *reinterpret_cast<volatile std::uint32_t*>(0xe000e010); }
  static volatile std::uint32_t& reload() { return *reinterpret_cast<volatile std::uint32_t*>(0xe000e014); }
  static volatile std::uint32_t& value() { return *reinterpret_cast<volatile std::uint32_t*>(0xe000e018); }
};
inline constexpr std::uint32_t instructions_a_tick = 40;

}  // namespace board
