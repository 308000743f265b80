// Distances of every pair of convex shapes but hulls through dyn.h, in random poses: the same source on boards and on a PC.
#pragma once

#include <cmath>

#include "boards/dice.hpp"
#include "dyn.h"

namespace boards {

constexpr dynParts parts_of_distances = DYN_PART_COLLISION;
constexpr int distance_poses = 20;

// Of a model of free bodies. clock(call) runs call and returns its status.
template <class Out, class Clock>
dynStatus distance_figures(const dynModel* m, dynData* d, Out&& out, Clock&& clock) {
  constexpr int most = 64;
  static double q[most], distances[most];
  const int nq = dyn_model_nq(m), pairs = dyn_model_npairs(m);
  if (nq > most || pairs > most) return DYN_ERROR_LIMIT;
  Dice dice;
  for (int k = 0; k < distance_poses; ++k) {
    for (int body = 0; body < nq; body += 7) {
      double square = 0;
      for (int i = 0; i < 3; ++i) q[body + i] = 0.15 * dice();
      for (int i = 3; i < 7; ++i) q[body + i] = dice(), square += q[body + i] * q[body + i];
      for (int i = 3; i < 7; ++i) q[body + i] /= std::sqrt(square);
    }
    const dynStatus status = clock([&] { return dyn_distances(m, d, q, distances); });
    if (status) return status;
    for (int i = 0; i < pairs; ++i) out(distances[i]);
  }
  return DYN_OK;
}

}  // namespace boards
