// .dynb files (model/dynb.hpp). A block is checked before use. Only what a builder needs is taken from it; the rest (runs,
// elimination tree, pairs, ...) is computed anew.
#pragma once

#include <string>

#include "model/builder.hpp"
#include "model/dynb.hpp"
#include "model/load.hpp"

namespace dyn::load {

// Writes the header of a file whose block is complete.
void seal_dynb(std::string& file, std::uint64_t tag = dynb_tag());

}  // namespace dyn::load
