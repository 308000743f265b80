// .dynb files (dyn/model/dynb.hpp): nothing of a block is used before it has been checked; of what is in it, only what a builder needs is taken, and
// the rest (runs, elimination tree, pairs, ...) is made anew.
#pragma once

#include <string>

#include "model/builder.hpp"
#include "model/dynb.hpp"
#include "model/load.hpp"

namespace dyn::load {

// Writes the header of a file whose block is there.
void seal_dynb(std::string& file, std::uint64_t tag = dynb_tag());

}  // namespace dyn::load
