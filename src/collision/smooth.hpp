// Smooth distance for parallel faces and edges: the soft minimum of the gaps g_i of the contact points,
//   d_s = -s log sum_i exp(-g_i / s),   grad d_s = sum_i w_i grad g_i,   w_i = exp(-g_i / s) / sum_k exp(-g_k / s).
// It is at most s log 8 below the distance. Source: Boyd, Vandenberghe, Convex Optimization, 2004, 3.1.5. The gradient is exact
// for parallel features and for a single point. In between its error is of order s over the features' size.
#pragma once

#include "model/data.hpp"

namespace dyn::collision {

// Returns the number of contact points used (more than one: smoothed). gradient: nv numbers `stride` apart, or null. Needs
// d.geom_poses and kinematics of d.q.
int smooth_distance(const Model& m, Data<double>& d, Index pair, double smoothing, double& distance, double* gradient,
                    std::ptrdiff_t stride);

}  // namespace dyn::collision
