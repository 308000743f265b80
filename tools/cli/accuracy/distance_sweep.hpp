// What accuracy of distances costs: both methods at every tolerance on a robot's tested pairs of shapes.
#pragma once

#include "cli.hpp"

namespace cli {

// Of the pairs of one kind ("box-cylinder"), or of all ("all").
struct DistanceCost {
  std::string kind;
  dynDistanceMethod method;
  double tolerance;                // relative to the size of the smaller shape
  double max_error, median_error;  // m, of what did not fail, against GJK at distance_reference
  double wall_s;                   // of a query: the median over runs of the mean over queries
  int queries, failed;             // failed: by status, or not a number
  int by_method;                   // answered by this method itself: closed forms and shapes apart are never libccd's
};
inline constexpr double distance_reference = 1e-15;

// Tolerances from 1e-2 down to 1e-12 by tens, kind by kind, "all" last. libccd is left out where it is not installed.
std::vector<DistanceCost> distance_sweep(const Robot& robot, const std::vector<Vector>& states, int runs = 5);

// A list of objects, one a DistanceCost; and as a table, without what a method answered nothing of.
json sweep_json(const std::vector<DistanceCost>& sweep);
std::string sweep_text(const std::vector<DistanceCost>& sweep);

}  // namespace cli
