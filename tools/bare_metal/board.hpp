// What the tests ask of a board: text, an end, a clock. Here by semihosting, which QEMU and debuggers answer; for a product, a
// UART's.
#pragma once

#include <cstdint>

namespace board {

#ifdef __riscv
extern "C" std::uintptr_t semihosting(std::uintptr_t operation, const void* argument);  // start_riscv.cpp
#else
inline std::uintptr_t semihosting(std::uintptr_t operation, const void* argument) {
  register std::uintptr_t r0 __asm("r0") = operation;
  register const void* r1 __asm("r1") = argument;
  __asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}
#endif
inline void print(const char* text) { semihosting(4, text); }
[[noreturn]] inline void exit(int status) {
  const std::uintptr_t block[2] = {0x20026, std::uintptr_t(status)};
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

// Instructions since it was made. Under QEMU's -icount shift=0 an instruction takes 1 ns: a Cortex-M counts ticks of SysTick
// (24 bits, DYN_TICKS a second), RISC-V the instructions themselves.
class Instructions {
 public:
#ifdef __riscv
  std::uint64_t operator()() const { return read() - began; }

 private:
  static std::uint64_t read() {
    unsigned long n;
    __asm volatile(".option push\n .option arch, +zicsr\n csrr %0, minstret\n .option pop" : "=r"(n));
    return n;
  }
  const std::uint64_t began = read();
#else
  Instructions() {
    reload() = 0xffffff;
    value() = 0;
    control() = 5;
  }
  std::uint64_t operator()() const { return std::uint64_t((0xffffff - value()) & 0xffffff) * 1000 / (DYN_TICKS / 1000000); }

 private:
  static volatile std::uint32_t& control() { return *reinterpret_cast<volatile std::uint32_t*>(0xe000e010); }
  static volatile std::uint32_t& reload() { return *reinterpret_cast<volatile std::uint32_t*>(0xe000e014); }
  static volatile std::uint32_t& value() { return *reinterpret_cast<volatile std::uint32_t*>(0xe000e018); }
#endif
};

}  // namespace board
