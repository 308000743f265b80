// Which pairs of collision shapes there are, and which of them a new data tests.
#include <algorithm>
#include <cmath>
#include <new>
#include <map>
#include <set>

#include "algorithm/configuration.hpp"
#include "collision/pair_search.hpp"
#include "model/block.hpp"
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
  std::set<std::pair<Index, Index>> off = {};  // links
  std::vector<PairRecord> pairs = {};

  const ShapeRecord& shape(Index geom) const { return shapes[std::size_t(geoms[std::size_t(geom)].shape)]; }
  Index joint(Index geom) const { return frames[std::size_t(shape(geom).frame)].joint; }

  void add(Index a, Index b, bool overlaps) {
    const auto special = wanted.find(std::minmax(geoms[std::size_t(a)].shape, geoms[std::size_t(b)].shape));
    const bool is_wanted = special != wanted.end();
    if (joint(a) == joint(b) ||
        (!is_wanted && collision::adjacent(joints.data(), bodies.data(), frames.data(), shape(a), shape(b))))
      return;
    const bool mesh = shape(a).type == DYN_SHAPE_TYPE_MESH || shape(b).type == DYN_SHAPE_TYPE_MESH;
    const bool masked =
        !collision::masks_allow({shape(a).contype, shape(a).conaffinity}, {shape(b).contype, shape(b).conaffinity});
    const dynPairReason reason = mesh                                                    ? DYN_PAIR_REASON_MESH
                                 : is_wanted                                             ? DYN_PAIR_REASON_TESTED
                                 : off.count(std::minmax(shape(a).frame, shape(b).frame)) ? DYN_PAIR_REASON_DISABLED
                                 : masked                                                ? DYN_PAIR_REASON_MASK
                                 : overlaps                                              ? DYN_PAIR_REASON_OVERLAPS
                                                                                         : DYN_PAIR_REASON_TESTED;
    pairs.push_back(
        {std::uint16_t(a), std::uint16_t(b), std::uint8_t(reason), std::uint8_t(is_wanted ? 1 + special->second : 0)});
  }
  // Of so many that they are not listed.
  void add_special(const std::vector<DisabledRecord>& disabled, const GeomPairs& overlapping) {
    std::map<Index, std::vector<Index>> carried;  // geoms by links
    std::map<Index, Index> geom_of;               // by shapes
    for (std::size_t k = 0; k < geoms.size(); ++k)
      carried[shape(Index(k)).frame].push_back(Index(k)), geom_of[geoms[k].shape] = Index(k);
    std::set<std::pair<Index, Index>> special(overlapping.begin(), overlapping.end());
    for (const DisabledRecord& d : disabled)
      for (const Index a : carried[d.frame1])
        for (const Index b : carried[d.frame2]) special.insert(std::minmax(a, b));
    for (const auto& [two, material] : wanted) special.insert(std::minmax(geom_of[two.first], geom_of[two.second]));
    if (!special.empty() && geoms.size() > UINT16_MAX)
      throw Error(DYN_ERROR_LIMIT, std::to_string(geoms.size()) +
                                       " collision shapes: pairs that are wanted, disabled or overlap are known up to " +
                                       std::to_string(UINT16_MAX));
    for (const auto& p : special) add(p.first, p.second, std::binary_search(overlapping.begin(), overlapping.end(), p));
  }
};

// The first body of the tree of each body; 0: the world.
std::vector<Index> trees_of(const Model& m) {
  std::vector<Index> out(std::size_t(m.n.bodies));
  for (Index i = 1; i < m.n.bodies; ++i) out[std::size_t(i)] = m.bodies()[i].parent ? out[std::size_t(m.bodies()[i].parent)] : i;
  return out;
}
bool flies(const Model& m, Index root) { return root && m.bodies()[root].type == BodyType::FreeFlyer; }

// Two trees of which one flies: where it flies says nothing of what it may touch.
bool apart(const Model& m, const Data<double>& d, const std::vector<Index>& trees, Index geom_a, Index geom_b) {
  const Index a = trees[std::size_t(d.geoms[geom_a].body)], b = trees[std::size_t(d.geoms[geom_b].body)];
  return a != b && (flies(m, a) || flies(m, b));
}

struct Enough {};  // ends a search

// Tested pairs that no one asked for, of filter Guess, by their bounding boxes where pairs are not listed: f(a, b), which may
// throw Enough.
template <class F>
void for_each_guess(const Model& m, Data<double>& d, F&& f) {
  const std::vector<Index> trees = trees_of(m);
  const auto look = [&](Index a, Index b) {
    const ShapeRecord &x = m.shapes()[m.geoms()[a].shape], &y = m.shapes()[m.geoms()[b].shape];
    if (collision::filter_of(x, y) == PairFilter::Guess && !apart(m, d, trees, a, b) && !collision::on_mocap(m, a) &&
        !collision::on_mocap(m, b))
      f(a, b);
  };
  if (lists_pairs(m)) {
    for (const PairRecord *p = m.pairs(), *end = p + m.n.pairs; p != end; ++p)
      if (p->reason == DYN_PAIR_REASON_TESTED && !p->wanted()) look(p->a, p->b);
    return;
  }
  collision::PairSearch& search = *collision::PairSearch::of(d);
  search.set_up(m, d), search.place_all(d, 0);
  const auto look_unlisted = [&](Index a, Index b) {
    if (Index pair; collision::is_tested(m, d, a, b, pair) && (pair < 0 || !m.pairs()[pair].wanted())) look(a, b);
  };
  // shapes of what flies meet those of the same tree alone: many may be in one place
  std::map<Index, std::vector<Index>> flying;
  for (Index k = 0; k < search.moving_count; ++k) {
    const Index geom = search.moving_geoms[k], root = trees[std::size_t(d.geoms[geom].body)];
    if (!flies(m, root)) continue;
    flying[root].push_back(geom);
    search.moving->update(k, {shape::Vec::make(1e30, 1e30, 1e30), shape::Vec::make(-1e30, -1e30, -1e30)});
  }
  search.for_each(d, look_unlisted);
  std::size_t bounds = 0;
  for (const auto& [root, geoms] : flying)
    for (std::size_t i = 0; i < geoms.size(); ++i)
      for (std::size_t j = i + 1; j < geoms.size(); ++j)
        if (++bounds > 10 * max_looks) throw Enough();
        else if (!(collision::distance_lower_bound(d.geoms[geoms[i]], d.geom_poses[geoms[i]], d.geoms[geoms[j]],
                                              d.geom_poses[geoms[j]]) > 0))
          look_unlisted(geoms[i], geoms[j]);
}

bool places_are_measurable(const Model& m, const Data<double>& d) {
  return std::all_of(d.geom_poses, d.geom_poses + m.n.geoms,
                     [](const shape::Pose& X) { return sizes(X.p)[0] + sizes(X.p)[1] + sizes(X.p)[2] <= shape::max_length; });
}

bool overlap(const Data<double>& d, Index a, Index b) {
  return collision::distance(d.geoms[a].shape, d.geom_poses[a], d.geoms[b].shape, d.geom_poses[b], *d.collision_workspace)
             .status == collision::Status::Penetrating;
}

// Uniform within the limits. Displacements without limits stay at 0, and what flies stays where it is.
void draw_configuration(const Model& m, Random& random, double* q) {
  for_each_leader(m, [&]<class J>(const Body& b) {
    const double *low = m.lower_limit() + b.user_q, *high = m.upper_limit() + b.user_q;
    const bool bounded = std::all_of(low, low + J::nq, [](double x) { return std::isfinite(x); }) &&
                         std::all_of(high, high + J::nq, [](double x) { return std::isfinite(x); });
    if (J::nv == 6 || (!J::rotates && !bounded)) return;
    J::random(random, low, high, q + b.user_q);
  });
}

}  // namespace

std::vector<PairRecord> pairs_of(const std::vector<JointRecord>& joints, const std::vector<Body>& bodies,
                                 const std::vector<FrameRecord>& frames, const std::vector<ShapeRecord>& shapes,
                                 const std::vector<GeomRecord>& geoms, const std::vector<DisabledRecord>& disabled,
                                 const WantedPairs& wanted, const GeomPairs& overlapping) {
  Judge judge{joints, bodies, frames, shapes, geoms, wanted};
  for (const DisabledRecord& d : disabled) judge.off.insert(std::minmax(d.frame1, d.frame2));
  if (geoms.size() > std::size_t(max_geoms)) return judge.add_special(disabled, overlapping), judge.pairs;
  for (Index a = 0; a < Index(geoms.size()); ++a)
    for (Index b = a + 1; b < Index(geoms.size()); ++b)
      judge.add(a, b, std::binary_search(overlapping.begin(), overlapping.end(), std::pair(a, b)));
  return judge.pairs;
}

GeomPairs overlapping(const Model& m, bool& all) {
  constexpr int samples = 32, max_apart = 1;
  constexpr std::uint64_t seed = 1;
  GeomPairs found;
  const Zeros zeros(data_bytes<double>(m, DYN_PART_COLLISION));
  if (!zeros.memory) throw std::bad_alloc();
  Data<double> d;
  data_layout(m, DYN_PART_COLLISION, zeros.memory, d);
  collision::place_geoms(m, d);
  if (!places_are_measurable(m, d)) return found;
  std::size_t looks = 0;
  all = true;
  try {
    for_each_guess(m, d, [&](Index a, Index b) {
      if (++looks > max_looks || found.size() == max_overlaps) throw Enough();
      if (overlap(d, a, b)) found.emplace_back(a, b);
    });
  } catch (const Enough&) {
    all = false;
  }
  std::vector<int> times_apart(found.size());
  Random random{seed};
  for (int k = 0; k < samples && !found.empty(); ++k) {
    draw_configuration(m, random, d.q), d.changed(input_q);
    collision::place_geoms(m, d);
    if (!places_are_measurable(m, d)) continue;
    for (std::size_t i = 0; i < found.size(); ++i)
      times_apart[i] += times_apart[i] <= max_apart && !overlap(d, found[i].first, found[i].second);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (times_apart[i] <= max_apart) found[kept++] = found[i];
  found.resize(kept);
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace dyn
