// In which order the slots of an island leave its Newton matrix, and what that fills. Trees are the vertices of a graph and slots its edges:
// slots are coupled where they share a tree, and to eliminate one is to contract its edge, after which all slots of both trees are coupled.
// Least degree first (George and Liu 1989, "The evolution of the minimum degree ordering algorithm"), ties by the slots' order.
#pragma once

#include <algorithm>
#include <cstddef>

#include "dyn/base/types.hpp"

namespace dyn::simulation {

struct Island;

// Where nothing is said of positions, slots are numbered within the island. entries: pairs of positions that are coupled, the earlier one's
// in a row, ascending.
struct Elimination {
  Index *order, *position;         // slots by position, and the inverse
  Index *first;                    // entries of a position: first[p] .. first[p + 1] - 1
  Index *later, *earlier;          // positions of an entry
  Index *first_in, *in;            // entries by the later position
  Index *degree, *next, *shared;   // of contraction: links of lists by trees, two for each slot; the lists as they were
  Index *head, *first_head, *tail, *links, *count;  // of trees
  Index most_entries;

  static Index entry_room(Index slots) { return Index(std::min<std::ptrdiff_t>(std::ptrdiff_t(slots) * (slots - 1) / 2, 12 * std::ptrdiff_t(slots)) + 1); }

  template <class F>
  void arrays(Index slots, Index trees, F&& f) {
    most_entries = entry_room(slots);
    for (Index** a : {&order, &position, &first, &first_in, &degree}) f(*a, slots + 2);
    for (Index** a : {&next, &shared}) f(*a, 2 * std::ptrdiff_t(slots));
    for (Index** a : {&later, &earlier, &in}) f(*a, most_entries);
    for (Index** a : {&head, &first_head, &tail, &links, &count}) f(*a, trees);
  }

  // false: there is no room for what it fills
  bool operator()(const Island& x);

  // f(slot) for slots that act on the tree
  template <class F>
  void for_each_of(Index tree, F&& f) const {
    for (Index k = first_head[tree]; k >= 0; k = shared[k]) f(k / 2);
  }
  Index entries(const Index slots) const { return first[slots]; }

 private:
  Index find(Index tree) const {
    while (links[tree] != tree) tree = links[tree] = links[links[tree]];
    return tree;
  }
  bool contract(const Island& x, Index step);
  void sort(Index slots);
};

}  // namespace dyn::simulation
