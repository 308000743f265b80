// The part of Arduino that examples/gravity uses, for QEMU (tests/boards/packages). Printed is the first line; then it ends.
#pragma once

#include "board.hpp"

struct Printer {
  void begin(int) {}
  void println(const char* text) { board::print(text), board::print("\n"), board::exit(1); }
  void println(double x, int) {
    board::print("tau[1] = "), board::print(x < 0 ? "-" : "");
    board::print(std::uint64_t(1000 * (x < 0 ? -x : x))), board::print(" mN m\n"), board::exit(0);
  }
};
inline Printer Serial;
inline void delay(int) {}
void setup();
void loop();
int board::program() {
  setup();
  for (;;) loop();
}
