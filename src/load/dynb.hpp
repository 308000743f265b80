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

// The same model as a file of this library, from one of version 2 or 3 or with another number of coefficients; empty if it is
// none of these. Coefficients that the file lacks are zero, and those that this library lacks must be.
std::string translate_dynb(const std::string& bytes);

[[noreturn]] void fail_of_damage(const std::string& what);

}  // namespace dyn::load
