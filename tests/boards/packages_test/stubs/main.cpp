// Runs main of a program for Zephyr under QEMU: its printk, of %d and %s.
#include <cstdarg>

#include "board.hpp"

extern "C" {
int program_main(void);
void printk(const char* format, ...) {
  va_list args;
  va_start(args, format);
  for (; *format; ++format) {
    if (*format != '%') {
      const char letter[2] = {*format, 0};
      board::print(letter);
    } else if (*++format == 's') {
      board::print(va_arg(args, const char*));
    } else {
      const int n = va_arg(args, int);
      board::print(n < 0 ? "-" : ""), board::print(std::uint64_t(n < 0 ? -n : n));
    }
  }
  va_end(args);
}
}

int board::program() { return program_main(); }
