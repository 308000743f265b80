// Which pairs of collision shapes there are, and which of them a new data tests.
#include <algorithm>
#include <cstdlib>
#include <memory>
#include <new>
#include <set>

#include "builder_impl.hpp"
#include "dyn/collision/pairs.hpp"

namespace dyn {

namespace {

// A body and its parent touch where their joint is; what flies freely is nobody's child.
bool parent_and_child(const std::vector<JointRecord>& joints, Index parent, Index child) {
  const JointRecord& j = joints[std::size_t(child)];
  return child != 0 && j.parent == parent && j.type != DYN_JOINT_FREE_FLYER;
}

}  // namespace

std::vector<PairRecord> pairs_of(const std::vector<JointRecord>& joints, const std::vector<FrameRecord>& frames, const std::vector<ShapeRecord>& shapes,
                                 const std::vector<GeomRecord>& geoms, const std::vector<DisabledRecord>& disabled, const WantedPairs& wanted) {
  std::vector<PairRecord> pairs;
  if (geoms.size() > std::size_t(most_geoms)) return pairs;
  std::set<std::pair<Index, Index>> off;  // links
  for (const DisabledRecord& d : disabled) off.insert(std::minmax(d.frame1, d.frame2));
  auto shape = [&](std::size_t geom) -> const ShapeRecord& { return shapes[std::size_t(geoms[geom].shape)]; };
  auto joint = [&](std::size_t geom) { return frames[std::size_t(shape(geom).frame)].joint; };
  for (std::size_t a = 0; a < geoms.size(); ++a)
    for (std::size_t b = a + 1; b < geoms.size(); ++b) {
      const Index i = joint(a), j = joint(b);
      const auto special = wanted.find(std::minmax(geoms[a].shape, geoms[b].shape));
      const bool is_wanted = special != wanted.end();
      if (i == j || (!is_wanted && (parent_and_child(joints, i, j) || parent_and_child(joints, j, i)))) continue;
      const bool mesh = shape(a).type == DYN_SHAPE_MESH || shape(b).type == DYN_SHAPE_MESH;
      const bool masked = !collision::masks_meet({shape(a).contype, shape(a).conaffinity}, {shape(b).contype, shape(b).conaffinity});
      const dynPairReason reason = mesh                                                    ? DYN_PAIR_MESH
                                   : is_wanted                                             ? DYN_PAIR_TESTED
                                   : off.count(std::minmax(shape(a).frame, shape(b).frame)) ? DYN_PAIR_DISABLED
                                   : masked                                                ? DYN_PAIR_MASK
                                                                                           : DYN_PAIR_TESTED;
      pairs.push_back({std::uint16_t(a), std::uint16_t(b), std::uint8_t(reason), std::uint8_t(is_wanted ? 1 + special->second : 0)});
    }
  return pairs;
}

bool tests_nothing(const Model& m) {
  return std::none_of(m.pairs(), m.pairs() + m.n.pairs, [](const PairRecord& p) { return p.reason == DYN_PAIR_TESTED; });
}

void judge_pairs(const Model& m, PairRecord* pairs) {
  if (m.n.pairs == 0) return;
  const std::unique_ptr<void, void (*)(void*)> memory(std::aligned_alloc(64, data_bytes<double>(m, DYN_PART_COLLISION)), std::free);
  if (!memory) throw std::bad_alloc();
  Data<double> d;
  data_layout(m, DYN_PART_COLLISION, memory.get(), d);
  collision::place_geoms(m, d);
  for (Index k = 0; k < m.n.geoms; ++k)
    if (!(sizes(d.geom_poses[k].p)[0] + sizes(d.geom_poses[k].p)[1] + sizes(d.geom_poses[k].p)[2] <= collision::largest)) return;
  collision::distances(m, d);
  auto tree = [&](Index i) {
    while (m.bodies()[i].parent) i = m.bodies()[i].parent;
    return i;
  };
  auto flies = [&](Index i) { return i && m.bodies()[i].type == BodyType::FreeFlyer; };
  auto apart = [&](const PairRecord& p) {  // where something flies says nothing of what it may touch
    const Index a = tree(d.geoms[p.a].body), b = tree(d.geoms[p.b].body);
    return a != b && (flies(a) || flies(b));
  };
  for (Index k = 0; k < m.n.pairs; ++k)
    if (pairs[k].reason == DYN_PAIR_TESTED && !pairs[k].wanted() && !apart(pairs[k]) && d.results[k].status == collision::Status::Penetrating) pairs[k].reason = DYN_PAIR_OVERLAPS;
}

}  // namespace dyn
