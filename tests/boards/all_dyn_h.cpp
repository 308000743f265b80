// Every function of dyn.h that boards have, in one image.
#include <cstdint>

#include "board.hpp"

extern "C" {
#define FUNCTION(name) extern const char name[];
#include "functions_of_boards.inc"
#undef FUNCTION
}

namespace {

const char* const volatile functions[] = {
#define FUNCTION(name) name,
#include "functions_of_boards.inc"
#undef FUNCTION
};

}  // namespace

int board::program() {
  std::uint64_t count = 0;
  for (const char* const f : functions) count += f != nullptr;
  print("  functions of dyn.h: "), print(count), print(", stack "), print(std::uint64_t(stack_used())), print(" bytes\n");
  return count < 250;
}
