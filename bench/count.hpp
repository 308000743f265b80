// Instructions that a function executes, system calls aside: what callgrind counts as Ir, on any instruction set.
#pragma once

#include <functional>

namespace bench {
long instructions(const std::function<void()>& f);  // -1: the system does not let a process trace its child
}
