#include "collision/pair_contacts.hpp"

#include "collision/pair_search.hpp"

namespace dyn::collision {

Index contacts(const Model& m, Data<double>& d, double margin, dynContact* out, Index capacity) {
  place_geoms(m, d);
  Index count = 0;
  Manifold found;
  const auto look = [&](Index ia, Index ib, Index pair) {
    const Geom &a = d.geoms[ia], &b = d.geoms[ib];
    const Pose &A = d.geom_poses[ia], &B = d.geom_poses[ib];
    if (distance_lower_bound(a, A, b, B) > margin) return;
    contacts(a.shape, A, b.shape, B, margin, *d.collision_workspace, found);
    for (int i = 0; i < found.count; ++i, ++count) {
      if (count >= capacity) continue;
      out[count] = contact_of(found, i);
      out[count].pair = int(pair), out[count].shape_a = int(m.geoms()[ia].shape), out[count].shape_b = int(m.geoms()[ib].shape);
    }
  };
  if (lists_pairs(m)) {
    for (Index k = 0; k < m.n.pairs; ++k)
      if (d.pair_states[k] == DYN_PAIR_REASON_TESTED) look(m.pairs()[k].a, m.pairs()[k].b, k);
    return count;
  }
  PairSearch& search = *PairSearch::of(d);
  search.set_up(m, d);
  search.place_all(d, margin);
  const bool ascending = search.for_each(d, [&](Index a, Index b) {
    if (Index pair; is_tested(m, d, a, b, pair)) look(a, b, pair);
  });
  search.ready = false;  // steps keep other bounds
  if (!ascending) std::sort(out, out + std::min(count, capacity), comes_before);
  return count;
}

}  // namespace dyn::collision
