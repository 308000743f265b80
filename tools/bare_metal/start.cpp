// From reset to board::program on any board: memory, constructors, the stack that is painted. No heap, no files, no exceptions.
// The processor's part is start_cortex_m.cpp or start_riscv.cpp.
#include <cstdint>

#include "board.hpp"

extern "C" {
extern char stack_top[], data_begin[], data_end[], data_image[], bss_begin[], bss_end[];
extern void (*init_begin[])();
extern void (*init_end[])();
void start();
void fault();
}

namespace {

// Everything below the stack's top is painted, so that what was used shows.
constexpr std::uint32_t paint = 0x57ac4a11;
std::uint32_t* stack_bottom() { return reinterpret_cast<std::uint32_t*>(bss_end); }

}  // namespace

void fault() {
  board::print("fault\n");
  board::exit(3);
}

std::uint32_t board::stack_used() {
  const std::uint32_t* p = stack_bottom();
  while (*p == paint) ++p;
  return std::uint32_t(stack_top - reinterpret_cast<const char*>(p));
}

void start() {
  // by words of their own: nothing is set up yet
  const std::uint32_t* from = reinterpret_cast<const std::uint32_t*>(data_image);
  for (volatile std::uint32_t* to = reinterpret_cast<std::uint32_t*>(data_begin); to < reinterpret_cast<std::uint32_t*>(data_end);
       ++to)
    *to = *from++;
  for (volatile std::uint32_t* to = reinterpret_cast<std::uint32_t*>(bss_begin); to < reinterpret_cast<std::uint32_t*>(bss_end);
       ++to)
    *to = 0;
  const char here = 0;
  for (volatile std::uint32_t* to = stack_bottom();
       reinterpret_cast<std::uintptr_t>(to) + 64 < reinterpret_cast<std::uintptr_t>(&here); ++to)
    *to = paint;
  for (void (**f)() = init_begin; f < init_end; ++f) (*f)();
  board::exit(board::program());
}
