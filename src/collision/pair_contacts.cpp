#include "dyn/collision/pair_contacts.hpp"

#include "dyn/collision/cull.hpp"
#include "dyn/collision/pairs.hpp"

namespace dyn::collision {

Index contacts(const Model& m, Data<double>& d, double margin, dynContact* out, Index capacity) {
  place_geoms(m, d);
  Index count = 0;
  Manifold found;
  for (Index k = 0; k < m.n.pairs; ++k) {
    if (d.pair_states[k] != DYN_PAIR_TESTED) continue;
    const PairRecord& p = m.pairs()[k];
    const Geom &a = d.geoms[p.a], &b = d.geoms[p.b];
    const Pose &A = d.geom_poses[p.a], &B = d.geom_poses[p.b];
    if (distance_at_least(a, A, b, B) > margin) continue;
    contacts(a.shape, A, b.shape, B, margin, *d.collision_workspace, found);
    for (int i = 0; i < found.count; ++i, ++count) {
      if (count >= capacity) continue;
      out[count] = contact_of(found, i);
      out[count].pair = int(k), out[count].shape_a = int(m.geoms()[p.a].shape), out[count].shape_b = int(m.geoms()[p.b].shape);
    }
  }
  return count;
}

}  // namespace dyn::collision
