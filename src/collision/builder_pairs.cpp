// Which pairs of collision shapes there are, and which of them a new data tests.
#include <algorithm>
#include <cstdlib>
#include <memory>
#include <new>
#include <map>
#include <set>

#include "algorithm/configuration.hpp"
#include "collision/pair_search.hpp"
#include "model/builder_impl.hpp"

namespace dyn {

namespace {

// Which of two geoms make a pair, and which of these a new data tests.
struct Judge {
  const std::vector<JointRecord>& joints;
  const std::vector<Body>& bodies;
  const std::vector<FrameRecord>& frames;
  const std::vector<ShapeRecord>& shapes;
  const std::vector<GeomRecord>& geoms;
  const WantedPairs& wanted;
  PairRule rule;
  std::set<std::pair<Index, Index>> off = {};  // links
  std::vector<PairRecord> pairs = {};

  const ShapeRecord& shape(Index geom) const { return shapes[std::size_t(geoms[std::size_t(geom)].shape)]; }
  Index joint(Index geom) const { return frames[std::size_t(shape(geom).frame)].joint; }

  void add(Index a, Index b, bool overlaps) {
    const auto special = wanted.find(std::minmax(geoms[std::size_t(a)].shape, geoms[std::size_t(b)].shape));
    const bool is_wanted = special != wanted.end();
    if (joint(a) == joint(b) || (!is_wanted && collision::adjacent(joints.data(), bodies.data(), frames.data(), shape(a).frame, shape(b).frame, rule))) return;
    const bool mesh = shape(a).type == DYN_SHAPE_TYPE_MESH || shape(b).type == DYN_SHAPE_TYPE_MESH;
    const bool masked = !collision::masks_allow({shape(a).contype, shape(a).conaffinity}, {shape(b).contype, shape(b).conaffinity});
    const dynPairReason reason = mesh                                                    ? DYN_PAIR_REASON_MESH
                                 : is_wanted                                             ? DYN_PAIR_REASON_TESTED
                                 : off.count(std::minmax(shape(a).frame, shape(b).frame)) ? DYN_PAIR_REASON_DISABLED
                                 : masked                                                ? DYN_PAIR_REASON_MASK
                                 : overlaps                                              ? DYN_PAIR_REASON_OVERLAPS
                                                                                         : DYN_PAIR_REASON_TESTED;
    pairs.push_back({std::uint16_t(a), std::uint16_t(b), std::uint8_t(reason), std::uint8_t(is_wanted ? 1 + special->second : 0)});
  }
  // Of so many that they are not listed.
  void add_special(const std::vector<DisabledRecord>& disabled, const GeomPairs& overlapping) {
    std::map<Index, std::vector<Index>> carried;  // geoms by links
    std::map<Index, Index> geom_of;               // by shapes
    for (std::size_t k = 0; k < geoms.size(); ++k) carried[shape(Index(k)).frame].push_back(Index(k)), geom_of[geoms[k].shape] = Index(k);
    std::set<std::pair<Index, Index>> special(overlapping.begin(), overlapping.end());
    for (const DisabledRecord& d : disabled)
      for (const Index a : carried[d.frame1])
        for (const Index b : carried[d.frame2]) special.insert(std::minmax(a, b));
    for (const auto& [two, material] : wanted) special.insert(std::minmax(geom_of[two.first], geom_of[two.second]));
    if (!special.empty() && geoms.size() > UINT16_MAX)
      throw Error(DYN_ERROR_LIMIT, std::to_string(geoms.size()) + " collision shapes: pairs that are wanted, disabled or overlap are known up to " + std::to_string(UINT16_MAX));
    const std::set<std::pair<Index, Index>> overlap(overlapping.begin(), overlapping.end());
    for (const auto& p : special) add(p.first, p.second, overlap.count(p) > 0);
  }
};

Index tree(const Model& m, Index i) {
  while (m.bodies()[i].parent) i = m.bodies()[i].parent;
  return i;
}
bool flies(const Model& m, Index root) { return root && m.bodies()[root].type == BodyType::FreeFlyer; }

// The neutral configuration and others within the limits, seeded. Pairs that overlap in more than half of them belong together.
constexpr int configurations = 33;

// f(a, b, ...) of each tested pair that overlaps in a configuration and that nothing separates: where something flies says nothing of what it may touch.
template <class Pairs, class F>
void judge(const Model& m, Pairs&& for_each_tested, F&& f) {
  const std::unique_ptr<void, void (*)(void*)> memory(std::aligned_alloc(64, data_bytes<double>(m, DYN_PART_COLLISION)), std::free);
  if (!memory) throw std::bad_alloc();
  Data<double> d;
  data_layout(m, DYN_PART_COLLISION, memory.get(), d);
  auto apart = [&](Index geom_a, Index geom_b) {
    const Index a = tree(m, d.geoms[geom_a].body), b = tree(m, d.geoms[geom_b].body);
    return a != b && (flies(m, a) || flies(m, b));
  };
  for (int c = 0; c < configurations; ++c) {
    if (c == 0) std::copy_n(m.neutral(), m.n.nq, d.q);
    else random_configuration(m, std::uint64_t(c), m.lower_limit(), m.upper_limit(), d.q);
    d.changed(input_q);
    collision::place_geoms(m, d);
    for (Index k = 0; k < m.n.geoms; ++k)
      if (!(sizes(d.geom_poses[k].p)[0] + sizes(d.geom_poses[k].p)[1] + sizes(d.geom_poses[k].p)[2] <= shape::max_length)) return;
    for_each_tested(d, [&](Index a, Index b, auto&&... which) {
      if (apart(a, b) || collision::distance_lower_bound(d.geoms[a], d.geom_poses[a], d.geoms[b], d.geom_poses[b]) > 0) return;
      const collision::Result r = collision::distance(d.geoms[a].shape, d.geom_poses[a], d.geoms[b].shape, d.geom_poses[b], *d.collision_workspace);
      if (r.status == collision::Status::Penetrating) f(a, b, which...);
    });
  }
}

}  // namespace

std::vector<PairRecord> pairs_of(const std::vector<JointRecord>& joints, const std::vector<Body>& bodies, const std::vector<FrameRecord>& frames,
                                 const std::vector<ShapeRecord>& shapes, const std::vector<GeomRecord>& geoms, const std::vector<DisabledRecord>& disabled, const WantedPairs& wanted,
                                 const GeomPairs& overlapping, PairRule rule) {
  Judge judge{joints, bodies, frames, shapes, geoms, wanted, rule};
  for (const DisabledRecord& d : disabled) judge.off.insert(std::minmax(d.frame1, d.frame2));
  if (geoms.size() > std::size_t(max_geoms)) return judge.add_special(disabled, overlapping), judge.pairs;
  for (Index a = 0; a < Index(geoms.size()); ++a)
    for (Index b = a + 1; b < Index(geoms.size()); ++b) judge.add(a, b, false);
  return judge.pairs;
}

bool tests_nothing(const Model& m) {
  return std::none_of(m.pairs(), m.pairs() + m.n.pairs, [](const PairRecord& p) { return p.reason == DYN_PAIR_REASON_TESTED; });
}

void judge_pairs(const Model& m, PairRecord* pairs) {
  if (m.n.pairs == 0 || m.simulation()->as_written) return;
  std::vector<int> times(std::size_t(m.n.pairs));
  judge(m, [&](Data<double>&, auto&& f) {
    for (Index k = 0; k < m.n.pairs; ++k)
      if (pairs[k].reason == DYN_PAIR_REASON_TESTED && !pairs[k].wanted()) f(pairs[k].a, pairs[k].b, k);
  }, [&](Index, Index, Index k) { ++times[std::size_t(k)]; });
  for (Index k = 0; k < m.n.pairs; ++k)
    if (2 * times[std::size_t(k)] > configurations) pairs[k].reason = DYN_PAIR_REASON_OVERLAPS;
}

GeomPairs overlapping(const Model& m) {
  GeomPairs out;
  if (m.simulation()->as_written) return out;
  std::map<std::pair<Index, Index>, int> times;
  judge(m, [&](Data<double>& d, auto&& f) {
    collision::PairSearch& search = *collision::PairSearch::of(d);
    search.set_up(m, d), search.place_all(d, 0);
    const auto look = [&](Index a, Index b) {
      if (Index pair; collision::is_tested(m, d, a, b, pair) && (pair < 0 || !m.pairs()[pair].wanted())) f(a, b);
    };
    // shapes of what flies meet those of the same tree alone: many may be in one place
    std::map<Index, std::vector<Index>> flying;
    for (Index k = 0; k < search.moving_count; ++k) {
      const Index geom = search.moving_geoms[k], root = tree(m, d.geoms[geom].body);
      if (!flies(m, root)) continue;
      flying[root].push_back(geom);
      search.moving->update(k, {shape::Vec::make(1e30, 1e30, 1e30), shape::Vec::make(-1e30, -1e30, -1e30)});
    }
    search.for_each(d, look);
    for (const auto& [root, geoms] : flying)
      for (std::size_t i = 0; i < geoms.size(); ++i)
        for (std::size_t j = i + 1; j < geoms.size(); ++j)
          if (!(collision::distance_lower_bound(d.geoms[geoms[i]], d.geom_poses[geoms[i]], d.geoms[geoms[j]], d.geom_poses[geoms[j]]) > 0)) look(geoms[i], geoms[j]);
  }, [&](Index a, Index b) { ++times[std::minmax(a, b)]; });
  for (const auto& [two, n] : times)
    if (2 * n > configurations) out.push_back(two);
  return out;
}

}  // namespace dyn
