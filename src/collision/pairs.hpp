// Distances between a robot's collision shapes, pair by pair.
#pragma once

#include "model/data.hpp"

namespace dyn::collision {

// d.geom_poses of d.q, kinematics included.
void place_geoms(const Model& m, Data<double>& d);

// d.results and d.distances of all pairs.
void distances(const Model& m, Data<double>& d);

// Pairs at a distance of at most margin, in ascending order: the first `capacity` of them into `pairs`. Answers how many there are.
Index collisions(const Model& m, Data<double>& d, double margin, int* pairs, Index capacity);

// Adds weight times how the gap between two points of a pair's shapes grows along the normal, by q on the tangent space.
void add_gradient(const Model& m, const Data<double>& d, Index pair, const Result& r, double weight, double* out, std::ptrdiff_t stride);

// Derivative of a pair's distance by q on the tangent space (gradient.hpp), nv numbers `stride` apart; zero where it has none. Bodies
// that carry both shapes turn both witness points about the same axis, and these lie along n: they add nothing.
void distance_gradient(const Model& m, const Data<double>& d, Index pair, double* out, std::ptrdiff_t stride);

}  // namespace dyn::collision
