// Broad phase: which of many boxes overlap. Boxes are enlarged by a margin; one that stays in its fat box costs one comparison.
// Overlaps of fat boxes are kept as candidates between queries. Boxes that left theirs move to overflow blocks beside the tree.
// When these are many, the tree is packed anew. The caller owns the memory; nothing allocates.
#pragma once

#include "collision/broad/tree.hpp"

namespace dyn::collision {

using shape::Bounds;

// Ids of two boxes, the smaller one in the high half.
using IdPair = std::uint64_t;
inline IdPair id_pair(Index a, Index b) { return std::uint64_t(std::min(a, b)) << 32 | std::uint32_t(std::max(a, b)); }
inline Index first_of(IdPair p) { return Index(p >> 32); }
inline Index second_of(IdPair p) { return Index(p & 0xffffffff); }

class BroadPhase {
 public:
  // capacity in boxes and in candidates; margin of fat boxes, m
  BroadPhase(Index capacity, std::ptrdiff_t pair_capacity, double margin, void* memory);
  static std::size_t bytes(Index capacity, std::ptrdiff_t pair_capacity);

  // Returns the smallest free id, or -1 if full.
  Index insert(const Bounds& b);
  void update(Index id, const Bounds& b);
  void remove(Index id);
  // Inserts at a removed id.
  void insert_at(Index id, const Bounds& b);
  bool has(Index id) const { return id >= 0 && id < used_ && state_[id] != free_slot; }
  Index count() const { return count_; }
  const Bounds& bounds(Index id) const { return tight_[id]; }

  // take(a, b) of all pairs whose boxes overlap, ascending. Returns false if candidates exceed the capacity.
  template <class F>
  bool pairs(F&& take) {
    if (!refresh()) return false;
    for (std::ptrdiff_t k = 0; k < candidates_; ++k) {
      const Index a = first_of(candidate_[k]), b = second_of(candidate_[k]);
      if (overlap(tight_[a], tight_[b])) take(a, b);
    }
    return true;
  }
  // take(id) of boxes that overlap b, or that meet the segment from o to o + t d, t in [0, far]. In no order.
  template <class F>
  void query(const Bounds& b, F&& take);
  template <class F>
  void ray(const shape::Vec& o, const shape::Vec& d, double far, F&& take);

  std::ptrdiff_t pair_capacity() const { return pair_capacity_; }
  std::ptrdiff_t candidates() const { return candidates_; }

  static bool overlap(const Bounds& a, const Bounds& b) {
#if DYN_LANES == 4
    return all((a.lower.v <= b.upper.v) & (b.lower.v <= a.upper.v));
#else
    bool yes = true;
    for (int i = 0; i < 3; ++i) yes &= (a.lower[i] <= b.upper[i]) & (b.lower[i] <= a.upper[i]);
    return yes;
#endif
  }

 private:
  static constexpr Index free_slot = -1, nowhere = -2, overflow_bit = 1 << 30;
  enum : std::uint8_t { stale = 1, unplaced = 2 };  // not in the candidates; not in a block, or not where its box is

  std::size_t lay_out(char* memory);
  void mark(Index id);
  void release(Index id);
  void place_moved();
  void pack();
  bool refit();
  bool refresh();
  void join();
  void replace_stale();
  void sort_fresh();
  Box fat(Index id) const;
  void found(IdPair p) {
    if (found_ < pair_capacity_) fresh_[found_] = p;
    ++found_;
  }
  template <class F>
  void for_each_overlap(const Box& b, F&& take);

  Index capacity_, count_ = 0, used_ = 0, lowest_free_ = 0;  // ids below used_ have been given
  std::ptrdiff_t pair_capacity_, candidates_ = 0, found_ = 0;
  bool candidates_valid_ = true;
  double margin_;
  PackedTree tree_;
  bool same_boxes_ = false;  // no box was added or removed since packing
  double spread_ = 0;        // sum of log widths at packing (build_levels)
  Bounds* tight_;
  Index* state_;  // by id: position 8 block + lane in the tree or, with overflow_bit, in overflow blocks; free_slot; nowhere
  Index* id_;     // by lane of the tree
  Block* overflow_;
  Index* overflow_id_;
  Index overflow_count_ = 0;  // lanes in use
  std::uint8_t* flags_;
  Index *stale_, *unplaced_;
  Index stale_count_ = 0, unplaced_count_ = 0;
  IdPair *candidate_, *fresh_;
  Index* counts_;  // of counting sorts
  std::uint64_t* key_;  // Hilbert index, id
};

template <class F>
void BroadPhase::for_each_overlap(const Box& b, F&& take) {
  tree_.descend(
      [&](const Block& x) { return x.overlaps(b); }, 0,
      [&](Index k) { for_each_bit(tree_.block[0][k].overlaps(b), [&](Index lane) { take(id_[k * Block::lanes + lane]); }); });
  for (Index k = 0; k < PackedTree::blocks_for(overflow_count_); ++k)
    for_each_bit(overflow_[k].overlaps(b), [&](Index lane) { take(overflow_id_[k * Block::lanes + lane]); });
}

template <class F>
void BroadPhase::query(const Bounds& b, F&& take) {
  place_moved();
  for_each_overlap(Box::of(b, 0), [&](Index id) {
    if (overlap(tight_[id], b)) take(id);
  });
}

template <class F>
void BroadPhase::ray(const shape::Vec& o, const shape::Vec& d, double far, F&& take) {
  place_moved();
  // slab test (Kay, Kajiya 1986); a zero component stays between its two planes or misses
  auto meets = [&](const double* lower, const double* upper) {
    double enter = 0, leave = far;
    for (int i = 0; i < 3; ++i) {
      if (d[i] == 0) {
        if (o[i] < lower[i] || o[i] > upper[i]) return false;
        continue;
      }
      const double s = (lower[i] - o[i]) / d[i], t = (upper[i] - o[i]) / d[i];
      enter = std::max(enter, std::min(s, t)), leave = std::min(leave, std::max(s, t));
    }
    return enter <= leave;
  };
  auto lanes = [&](const Block& x) {
    unsigned bits = 0;
    for (Index k = 0; k < Block::lanes; ++k) {
      if (!(x.lower[0][k] <= x.upper[0][k])) continue;
      const double lower[3] = {x.lower[0][k], x.lower[1][k], x.lower[2][k]},
                   upper[3] = {x.upper[0][k], x.upper[1][k], x.upper[2][k]};
      bits |= unsigned(meets(lower, upper)) << k;
    }
    return bits;
  };
  auto leaf = [&](const Block& x, const Index* ids) {
    for_each_bit(lanes(x), [&](Index k) {
      const Bounds& b = tight_[ids[k]];
      const double lower[3] = {b.lower[0], b.lower[1], b.lower[2]}, upper[3] = {b.upper[0], b.upper[1], b.upper[2]};
      if (meets(lower, upper)) take(ids[k]);
    });
  };
  tree_.descend(lanes, 0, [&](Index k) { leaf(tree_.block[0][k], id_ + k * Block::lanes); });
  for (Index k = 0; k < PackedTree::blocks_for(overflow_count_); ++k) leaf(overflow_[k], overflow_id_ + k * Block::lanes);
}

}  // namespace dyn::collision
