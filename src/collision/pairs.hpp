// Distances between a robot's collision shapes, pair by pair.
#pragma once

#include "collision/geom.hpp"
#include "model/data.hpp"

namespace dyn::collision {

// Sets d.geom_poses for d.q, kinematics included.
void place_geoms(const Model& m, Data<double>& d);

// Sets d.results and d.distances of all pairs.
void distances(const Model& m, Data<double>& d);

// Pairs within the margin, ascending. Writes the first `capacity` to `pairs` and returns their total number.
Index collisions(const Model& m, Data<double>& d, double margin, int* pairs, Index capacity);

// Adds weight times the derivative of the gap along the normal by q (tangent space).
void add_gradient(const Model& m, const Data<double>& d, Index pair, const Result& r, double weight, double* out,
                  std::ptrdiff_t stride);

// Derivative of a pair's distance by q on the tangent space (gradient.hpp), nv numbers `stride` apart; zero where it has none.
// Common ancestors of both bodies move the witness points alike and add nothing.
void distance_gradient(const Model& m, const Data<double>& d, Index pair, double* out, std::ptrdiff_t stride);

}  // namespace dyn::collision
