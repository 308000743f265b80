// Divergence over time, with both errors of integration, and what the causes that explain most leave of it.
#pragma once

#include "explain.hpp"

namespace cli::compare {

std::string picture(const Comparison& c);  // SVG

}  // namespace cli::compare
