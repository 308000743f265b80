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

// The same model as a file of this version, from one of version 2; empty if it is not one.
std::string from_older_dynb(const std::string& bytes);

}  // namespace dyn::load
