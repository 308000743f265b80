// Changes collision groups at run time.
#pragma once

#include "model/data.hpp"

namespace dyn::collision {

// Sets a geom's groups and updates the states of its pairs.
inline void set_masks(const Model& m, Data<double>& d, Index geom, const Masks& masks) {
  d.geom_masks[geom] = masks;
  for (Index k = 0; k < m.n.pairs; ++k) {
    const PairRecord& p = m.pairs()[k];
    if (p.a != geom && p.b != geom) continue;
    dynPairReason& state = d.pair_states[k];
    const bool meet = masks_allow(d.geom_masks[p.a], d.geom_masks[p.b]);
    if (!meet && state == DYN_PAIR_REASON_TESTED) state = DYN_PAIR_REASON_MASK;
    if (meet && state == DYN_PAIR_REASON_MASK) state = DYN_PAIR_REASON_TESTED;
  }
  d.invalidate(Stage::Distances);
}

}  // namespace dyn::collision
