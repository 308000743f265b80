// In which order the degrees of freedom of an island leave the matrix of Newton's method, and what that fills. They go by segments, up to six
// that follow one another in a tree without a fork: the vertices of a graph, of which each slot couples those that carry it. To eliminate one is
// to couple all those that shared a slot or an earlier one with it. Least degree first (George and Liu 1989, "The evolution of the minimum degree
// ordering algorithm"); what is coupled is kept as lists of vertices, that of an eliminated one in place of those it was on.
#pragma once

#include <algorithm>
#include <cstddef>

#include "model/model.hpp"

namespace dyn::simulation {

struct Island;

inline constexpr Index segment_size = 6, segment_lanes = 8;

// Of a model. They end after six degrees of freedom or between bodies.
struct Segments {
  Index count = 0;
  Index *of = nullptr, *first = nullptr;  // of degrees of freedom; first degrees of freedom of segments
};
inline Index segment_capacity(const Model& m) { return m.has_mimic ? m.n.nv : std::min(m.n.nv, m.n.bodies - 1 + m.n.nv / segment_size); }
void find_segments(const Model& m, Segments& s);

// The part of a slot that a segment carries: its rows in lanes by degree of freedom, in the units of newton.cpp.
struct ConstraintRun {
  Index segment, constraint;  // of the island
  double* rows;
};

// Segments and slots are numbered within the island. entries: pairs of positions that are coupled, the earlier one's in a row, ascending.
struct Elimination {
  Index size = 0;               // segments of the island
  Index *segment, *local;       // the model's segments of the island; the island's of the model's
  Index *order, *position;      // segments by position, and the inverse
  Index *first;                 // entries of a position: first[p] .. first[p + 1] - 1
  Index *later, *earlier;       // positions of an entry
  Index *first_in, *in;         // entries by the later position
  Index *first_run;             // of slots
  ConstraintRun* runs;
  Index *first_of, *next_of;    // runs of a segment, a list
  Index *degree, *mark, *of_degree, *before, *after;  // segments by degree, as lists
  Index *lists, *next_list;     // of segments: what couples them, runs and entries
  bool* merged;                   // slots and positions whose lists are in another's
  Index max_entries, max_runs;

  static std::ptrdiff_t entry_capacity(Index segments) { return std::min<std::ptrdiff_t>(std::ptrdiff_t(segments) * (segments - 1) / 2, 16 * std::ptrdiff_t(segments)) + 1; }
  // where slots are carried by more, on average, there is no room
  static std::ptrdiff_t run_capacity(const Model& m, Index constraints) { return std::min<std::ptrdiff_t>(m.n.carriers / segment_size + 2, 8) * constraints + m.n.nv; }

  template <class F>
  void arrays(const Model& m, Index constraints, F&& f) {
    const Index count = segment_capacity(m);
    max_entries = Index(entry_capacity(count)), max_runs = Index(run_capacity(m, constraints));
    for (Index** a : {&segment, &local, &order, &position, &first, &first_in, &first_of, &degree, &mark, &of_degree, &before, &after, &lists}) f(*a, count + 2);
    for (Index** a : {&later, &earlier, &in}) f(*a, max_entries);
    f(first_run, constraints + 1), f(runs, max_runs), f(next_of, max_runs);
    f(next_list, std::ptrdiff_t(max_runs) + max_entries), f(merged, std::ptrdiff_t(constraints) + count);
  }

  // What each slot is carried by, and how many segments there are. false: there is no room for it.
  bool find_runs(const Island& x);
  // behind that: the order. false: there is no room for what it fills
  bool find_order(const Island& x);

  Index entries() const { return first[size]; }
  // f(run)
  template <class F>
  void for_each_of(Index a_segment, F&& f) const {
    for (Index r = first_of[a_segment]; r >= 0; r = next_of[r]) f(runs[r]);
  }
  template <class F>
  void for_each_run(Index constraint, F&& f) const {
    for (Index r = first_run[constraint]; r < first_run[constraint + 1]; ++r) f(runs[r]);
  }

 private:
  void begin(Index constraints);
  void link(Index a_segment);
  void unlink(Index a_segment);
  bool eliminate(Index constraints, Index a_segment, Index step);
  Index count(Index constraints, Index a_segment, Index stamp);
  template <class F>
  void for_each_listed(Index constraints, Index list, F&& f) const;
  void sort();
};

}  // namespace dyn::simulation
