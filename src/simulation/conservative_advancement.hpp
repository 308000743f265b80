// What need not be looked for again. After a search in which nothing was near, neither limits nor two shapes meet before the joints have moved
// by what was left: a joint moves what it carries by at most its lever times its change. Steps within that leave out placements, pairs and
// rows; their results are the same to the last bit. Of trees of joints with one coordinate.
#pragma once

#include "model/data.hpp"

namespace dyn::simulation {

struct AdvancementCache {
  double square;      // of what is left, over twice the number of joints; 0: unknown
  double *q, *lever;  // where that was; m of contact for each unit of the coordinate. Whole packs
  bool enabled;
};

// Nothing acts in a step of h that would end with the velocities of d.
bool cache_excludes_contact(const Model& m, const Data<double>& d, double h);

// After a search in vain, with the velocities v, in which no two shapes were nearer than `between`, if that is positive.
void update_advancement_cache(const Model& m, Data<double>& d, const double* v, double h, double min_distance);

bool can_cache_advancement(const Model& m);

// No limit is within reach.
bool limits_inactive(const Model& m, const Data<double>& d, const double* v, double h);

}  // namespace dyn::simulation
