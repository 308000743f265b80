#include "collision/broad/broad_phase.hpp"

#include "collision/broad/hilbert.hpp"

namespace dyn::collision {

namespace {

// The tree is packed anew when more than 1/overflow_share of all boxes lie in overflow blocks. All pairs are searched again when
// more than 1/moved_share of the boxes moved.
constexpr Index overflow_share = 8, min_overflow = 64, moved_share = 16;
constexpr std::size_t radix = 1024;

// Counting sort by one digit. counts has digits + 1 entries.
template <class T, class Digit>
void counting_sort(const T* from, T* to, std::ptrdiff_t n, Index digits, Index* counts, Digit&& digit) {
  std::fill_n(counts, digits + 1, 0);
  for (std::ptrdiff_t k = 0; k < n; ++k) ++counts[digit(from[k]) + 1];
  for (Index k = 0; k < digits; ++k) counts[k + 1] += counts[k];
  for (std::ptrdiff_t k = 0; k < n; ++k) to[counts[digit(from[k])]++] = from[k];
}

}  // namespace

std::size_t BroadPhase::lay_out(char* memory) {
  std::size_t used = 0;
  // a null memory only counts the bytes
  auto take = [&]<class T>(T*& p, std::size_t n) {
    p = memory ? reinterpret_cast<T*>(memory + used) : nullptr;
    used += (n * sizeof(T) + 63) / 64 * 64;
  };
  const std::size_t n = std::size_t(capacity_), padded = std::max(n, std::size_t(min_overflow)) + 2 * Block::lanes,
                    pairs = std::size_t(pair_capacity_);
  Index blocks = PackedTree::blocks_for(capacity_);
  for (Block*& level : tree_.block) take(level, std::size_t(blocks)), blocks = PackedTree::blocks_for(blocks);
  take(overflow_, padded / Block::lanes);
  take(tight_, n), take(state_, n), take(id_, padded), take(overflow_id_, padded), take(stale_, n), take(unplaced_, n),
      take(flags_, n);
  take(candidate_, pairs), take(fresh_, pairs), take(counts_, std::max(n, radix) + 1), take(key_, 2 * n);
  return used;
}

BroadPhase::BroadPhase(Index capacity, std::ptrdiff_t pair_capacity, double margin, void* memory)
    : capacity_(capacity), pair_capacity_(pair_capacity), margin_(margin) {
  lay_out(static_cast<char*>(memory));
  if (memory) std::fill_n(flags_, capacity, std::uint8_t(0));
}

std::size_t BroadPhase::bytes(Index capacity, std::ptrdiff_t pair_capacity) {
  return BroadPhase(capacity, pair_capacity, 0, nullptr).lay_out(nullptr);
}

Index BroadPhase::insert(const Bounds& b) {
  if (count_ == capacity_) return -1;
  Index id = used_;
  if (count_ < used_) {
    for (id = lowest_free_; state_[id] != free_slot; ++id) {}
    lowest_free_ = id + 1;
  } else {
    ++used_;
  }
  ++count_;
  tight_[id] = b;
  state_[id] = nowhere;
  same_boxes_ = false;
  mark(id);
  return id;
}

void BroadPhase::update(Index id, const Bounds& b) {
  tight_[id] = b;
  if (!(flags_[id] & unplaced) && !fat(id).contains(Box::of(b, 0))) mark(id);
}

void BroadPhase::remove(Index id) {
  mark(id);
  release(id);
  state_[id] = free_slot;
  same_boxes_ = false;
  lowest_free_ = std::min(lowest_free_, id);
  --count_;
}

void BroadPhase::insert_at(Index id, const Bounds& b) {
  tight_[id] = b;
  state_[id] = nowhere;
  same_boxes_ = false;
  mark(id);
  ++count_;
}

void BroadPhase::mark(Index id) {
  if (!(flags_[id] & stale)) stale_[stale_count_++] = id;
  if (!(flags_[id] & unplaced)) unplaced_[unplaced_count_++] = id;
  flags_[id] = stale | unplaced;
}

Box BroadPhase::fat(Index id) const {
  const Index at = state_[id], lane = at & ~overflow_bit;
  return (at & overflow_bit ? overflow_ : tree_.block[0])[lane / Block::lanes].box(lane % Block::lanes);
}

// Removes a box from its block.
void BroadPhase::release(Index id) {
  const Index at = state_[id], lane = at & ~overflow_bit;
  if (at < 0) return;
  (at & overflow_bit ? overflow_ : tree_.block[0])[lane / Block::lanes].clear(lane % Block::lanes);
  state_[id] = nowhere;
}

// Places moved boxes in overflow blocks. Packs the tree anew when there are too many.
void BroadPhase::place_moved() {
  if (unplaced_count_ == 0) return;
  if (overflow_count_ + unplaced_count_ > std::max(min_overflow, count_ / overflow_share)) {
    pack();
  } else {
    for (Index k = 0; k < unplaced_count_; ++k) {
      const Index id = unplaced_[k];
      if (state_[id] == free_slot) continue;
      release(id);
      const Index lane = overflow_count_++;
      if (lane % Block::lanes == 0) overflow_[lane / Block::lanes].clear();
      overflow_[lane / Block::lanes].set(lane % Block::lanes, Box::of(tight_[id], margin_));
      overflow_id_[lane] = id, state_[id] = lane | overflow_bit;
    }
  }
  for (Index k = 0; k < unplaced_count_; ++k) flags_[unplaced_[k]] &= std::uint8_t(~unplaced);
  unplaced_count_ = 0;
}

// Keeps the order of the last packing and updates the boxes. Good while neighbours in that order stay neighbours in space.
bool BroadPhase::refit() {
  constexpr double wider = 0.1;  // bound on the mean growth of log(width)
  if (!same_boxes_) return false;
  for (Index k = 0; k < count_; ++k) {
    const Index id = id_[k];
    tree_.block[0][k / Block::lanes].set(k % Block::lanes, Box::of(tight_[id], margin_));
    state_[id] = k;
  }
  return tree_.build_levels() <= spread_ + wider * PackedTree::blocks_for(count_);
}

void BroadPhase::pack() {
  overflow_count_ = 0;
  candidates_valid_ = false;  // packing changes every fat box, also of boxes that did not leave theirs
  if (refit()) return;
  // cells of the cube that holds all centres
  auto center = [&](Index id, int i) { return std::clamp(tight_[id].lower[i] / 2 + tight_[id].upper[i] / 2, -1e30, 1e30); };
  double lower[3], extent = 0;
  for (int i = 0; i < 3; ++i) {
    double least = shape::infinity, most = -shape::infinity;
    for (Index id = 0; id < used_; ++id)
      if (state_[id] != free_slot) least = std::min(least, center(id, i)), most = std::max(most, center(id, i));
    lower[i] = least, extent = std::max(extent, most - least);
  }
  const double scale = extent > 0 ? 1023.99 / extent : 0;
  Index n = 0;
  for (Index id = 0; id < used_; ++id) {
    if (state_[id] == free_slot) continue;
    auto cell = [&](int i) { return std::uint32_t((center(id, i) - lower[i]) * scale); };
    key_[n++] = std::uint64_t(hilbert(cell(0), cell(1), cell(2))) << 32 | std::uint32_t(id);
  }
  std::uint64_t *from = key_, *to = key_ + capacity_;
  for (int shift = 32; shift < 62; shift += 10, std::swap(from, to))
    counting_sort(from, to, n, Index(radix), counts_, [&](std::uint64_t k) { return (k >> shift) & (radix - 1); });
  tree_.shape(n);
  for (Index k = 0; k < n; ++k) {
    Block& block = tree_.block[0][k / Block::lanes];
    if (k % Block::lanes == 0) block.clear();
    const Index id = Index(from[k] & 0xffffffff);
    block.set(k % Block::lanes, Box::of(tight_[id], margin_));
    id_[k] = id, state_[id] = k;
  }
  spread_ = tree_.build_levels();
  same_boxes_ = true;
}

bool BroadPhase::refresh() {
  place_moved();
  if (stale_count_ == 0 && candidates_valid_) return true;
  if (!candidates_valid_ || stale_count_ > std::max(min_overflow, count_ / moved_share))
    join();
  else
    replace_stale();
  for (Index k = 0; k < stale_count_; ++k) flags_[stale_[k]] = 0;
  stale_count_ = 0;
  return candidates_valid_;
}

// Finds all candidates: each block against itself and the later blocks.
void BroadPhase::join() {
  found_ = 0;
  for (Index i = 0; tree_.levels > 0 && i < tree_.blocks[0]; ++i) {
    const Block& p = tree_.block[0][i];
    const Index* ids = id_ + i * Block::lanes;
    const Box all = p.hull();
    tree_.descend([&](const Block& x) { return x.overlaps(all); }, i, [&](Index j) {
      const Block& q = tree_.block[0][j];
      const Index* other = id_ + j * Block::lanes;
      const unsigned near =
          i == j ? 0xff : p.overlaps(tree_.levels > 1 ? tree_.block[1][j / Block::lanes].box(j % Block::lanes) : q.hull());
      for_each_bit(near, [&](Index a) {
        const unsigned behind = i == j ? ~0u << (a + 1) : ~0u;
        for_each_bit(q.overlaps(p.box(a)) & behind, [&](Index b) { found(id_pair(ids[a], other[b])); });
      });
    });
  }
  for (Index k = 0; k < overflow_count_; ++k) {
    const Index id = overflow_id_[k];
    if (state_[id] != (k | overflow_bit)) continue;
    for_each_overlap(fat(id), [&](Index other) {
      if (!(state_[other] & overflow_bit) || other > id) found(id_pair(id, other));
    });
  }
  candidates_valid_ = found_ <= pair_capacity_;
  candidates_ = found_;
  if (!candidates_valid_) return;
  sort_fresh();
}

// radix sort: by the second id, then by the first
void BroadPhase::sort_fresh() {
  counting_sort(fresh_, candidate_, found_, used_, counts_, second_of);
  counting_sort(candidate_, fresh_, found_, used_, counts_, first_of);
  std::swap(candidate_, fresh_);
}

// Drops the candidates of moved boxes and finds their new ones.
void BroadPhase::replace_stale() {
  std::ptrdiff_t kept = 0;
  for (std::ptrdiff_t k = 0; k < candidates_; ++k) {
    const IdPair p = candidate_[k];
    candidate_[kept] = p;
    kept += !((flags_[first_of(p)] | flags_[second_of(p)]) & stale);
  }
  found_ = 0;
  for (Index k = 0; k < stale_count_; ++k) {
    const Index id = stale_[k];
    if (state_[id] == free_slot) continue;
    for_each_overlap(fat(id), [&](Index other) {
      if (other != id && (!(flags_[other] & stale) || other > id)) found(id_pair(id, other));
    });
  }
  candidates_ = kept + found_;
  candidates_valid_ = candidates_ <= pair_capacity_;
  if (!candidates_valid_) return;
  std::sort(fresh_, fresh_ + found_);
  for (std::ptrdiff_t i = kept - 1, j = found_ - 1, k = candidates_ - 1; j >= 0; --k)
    candidate_[k] = i >= 0 && candidate_[i] > fresh_[j] ? candidate_[i--] : fresh_[j--];
}

}  // namespace dyn::collision
