// Conservative advancement cache: after a search without contacts and limits it bounds the motion that keeps it so.
// A joint moves what it carries by at most its lever times its change. Steps within the bound skip placements, pairs and rows;
// their results are the same to the last bit. Only for trees of joints with one coordinate.
#pragma once

#include "model/data.hpp"

namespace dyn::simulation {

struct AdvancementCache {
  double square;      // bound of the motion: squared remaining distance over 2 nv; 0: unknown
  // configuration of the search; metres of approach per unit of each coordinate. Padded to whole SIMD registers
  double *q, *lever;
  bool enabled;
};

// Returns whether nothing can act in a step of h that ends with the velocities of d.
bool cache_excludes_contact(const Model& m, const Data<double>& d, double h);

// Stores the result of a search at velocities v that found nothing. min_distance: lower bound of all distances; not positive:
// unknown.
void update_advancement_cache(const Model& m, Data<double>& d, const double* v, double h, double min_distance);

bool can_cache_advancement(const Model& m);

// Returns whether all limits are beyond reach.
bool limits_inactive(const Model& m, const Data<double>& d, const double* v, double h);

}  // namespace dyn::simulation
