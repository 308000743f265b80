// Sums over subtrees that derivatives collect.
#pragma once

#include "spatial/inertia_rate.hpp"
#include "spatial/moments.hpp"

namespace dyn {

// Sums over a subtree, at the tree's root in world axes.
template <class T>
struct Composite {
  Moments<T> Y;
  MomentRates<T> rates;
  Force<T> f;
};

// Sums over a subtree of what the motion with the velocities lambda of second derivatives adds, at the tree's root in world axes.
template <class T>
struct Contraction {
  MomentRates<T> rates;
  Vec3<T> Q;
};

// Four columns each of S, psi', psi'', W, by components.
template <class T>
struct SecondOrderRows {
  alignas(4 * sizeof(T)) T S[24], dS[24], ddS[24], W[24];
};

}  // namespace dyn
