// A distance without kinks where faces or edges lie along each other: the soft minimum of the gaps g_i of the contact points,
//   d_s = -s log sum_i exp(-g_i / s),   grad d_s = sum_i w_i grad g_i,   w_i = exp(-g_i / s) / sum_k exp(-g_k / s).
// It is below the distance by at most s log 8. Source: Boyd, Vandenberghe, Convex Optimization, 2004, 3.1.5.
// Each g_i changes as the gap between two points that move with the shapes: exact where the features are parallel or one point counts
// alone; in between the error of the gradient is of the order of s over the features' size.
#pragma once

#include "model/data.hpp"

namespace dyn::collision {

// Of a tested pair: the number of points that count (more than one: smoothed). gradient: nv numbers `stride` apart, or nullptr.
// d.geom_poses and placements of d.q are there.
int smooth_distance(const Model& m, Data<double>& d, Index pair, double smoothing, double& distance, double* gradient, std::ptrdiff_t stride);

}  // namespace dyn::collision
