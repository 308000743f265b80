// Work-precision diagrams: error to the right, work upwards, both logarithmic; one line a method, one mark a setting; what failed
// stands at the right edge.
#pragma once

#include "sweep.hpp"

namespace cli::accuracy {

enum class Work { Seconds, Evaluations };

std::string chart(const std::vector<Point>& points);  // for a terminal
std::string svg(const std::vector<Point>& points, Work work);

}  // namespace cli::accuracy
