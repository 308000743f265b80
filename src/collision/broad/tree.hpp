// Packed bounding-volume tree with eight children a node. Boxes are in Hilbert order, eight to a block, blocks eight to a block
// of the next level. Only boxes are stored: children follow from the index.
// Source: Kamel, Faloutsos, "On packing R-trees", CIKM 1993.
#pragma once

#include "base/portable.hpp"
#include "collision/broad/block.hpp"

namespace dyn::collision {

struct PackedTree {
  static constexpr int max_levels = 11;  // 8^11 > 2^31 boxes
  int levels = 0;
  Index blocks[max_levels] = {};  // of each level; level 0 holds the boxes themselves
  Block* block[max_levels] = {};

  static Index blocks_for(Index n) { return (n + Block::lanes - 1) / Block::lanes; }
  // Sets the levels for n boxes. The caller fills level 0.
  void shape(Index n) {
    levels = 0;
    if (n == 0) return;
    do blocks[levels++] = n = blocks_for(n);
    while (n > 1);
  }
  // Builds the levels above the boxes. Returns the sum of log widths of the blocks; logarithms keep a few huge boxes from hiding
  // the rest.
  double build_levels() {
    double spread = 0;
    for (int l = 1; l < levels; ++l)
      for (Index b = 0; b < blocks[l]; ++b) {
        block[l][b].clear();
        const Index first = b * Block::lanes, end = std::min(first + Block::lanes, blocks[l - 1]);
        for (Index c = first; c < end; ++c) {
          const Box hull = block[l - 1][c].hull();
          block[l][b].set(c - first, hull);
          if (l > 1) continue;
          double width = 1e-300;
          for (int i = 0; i < 3; ++i) width += std::max(double(hull.upper[i]) - hull.lower[i], 0.0);
          spread += math::log(width);
        }
      }
    return spread;
  }

  // visit(leaf block) where test(block) has a bit for each lane to follow. Skips blocks before `from`.
  template <class Test, class Visit>
  DYN_INLINE void descend(Test&& test, Index from, Visit&& visit) const {
    if (levels == 0) return;
    struct Open {
      int level;
      Index block;
    } stack[max_levels * Block::lanes];
    int depth = 0;
    stack[depth++] = {levels - 1, 0};
    while (depth > 0) {
      const Open o = stack[--depth];
      if (o.level == 0) {
        visit(o.block);
        continue;
      }
      const Index first_child = o.block * Block::lanes, last_wanted = from >> 3 * (o.level - 1);
      for_each_bit(test(block[o.level][o.block]), [&](Index k) {
        if (first_child + k >= last_wanted) stack[depth++] = {o.level - 1, first_child + k};
      });
    }
  }
};

}  // namespace dyn::collision
