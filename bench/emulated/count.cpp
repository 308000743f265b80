// count.hpp under qemu-user, where no process traces its child: the plugin tests/boards/linux/instructions.c counts.
#include "../count.hpp"

#include "../../tests/boards/linux/board.hpp"

namespace bench {
namespace {

long counted(const std::function<void()>& f) {
  const board::Instructions count;
  f();
  return static_cast<long>(count());
}

}  // namespace

long instructions(const std::function<void()>& f) { return counted(f) - counted([] {}); }

}  // namespace bench
