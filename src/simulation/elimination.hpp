// Elimination order of the degrees of freedom of an island for the Newton matrix, and its fill-in.
// A vertex is a segment: up to six consecutive degrees of freedom of a tree without a fork. A constraint couples all segments
// that support it. Eliminating a segment couples its neighbours. The order is minimum degree (George and Liu 1989, "The evolution
// of the minimum degree ordering algorithm") on a quotient graph.
#pragma once

#include <algorithm>
#include <cstddef>

#include "constraint/constraint.hpp"
#include "model/model.hpp"
#include "simulation/tuning.hpp"

namespace dyn::simulation {

struct Island;

inline constexpr Index segment_size = 6, segment_lanes = 8;

// Segments of a model. They end after six degrees of freedom or between bodies.
struct Segments {
  Index count = 0;
  Index *of = nullptr, *first = nullptr;  // of: segment of a degree of freedom. first: first degree of freedom of a segment
};
inline Index segment_capacity(const Model& m) {
  return m.has_mimic ? m.n.nv : std::min(m.n.nv, m.n.bodies - 1 + m.n.nv / segment_size);
}
void find_segments(const Model& m, Segments& s);

// Rows of a constraint within one segment: in lanes by degree of freedom, in the units of island_rows.cpp.
struct ConstraintRun {
  Index segment, constraint;  // numbered within the island
  double* rows;
};

// Segments and constraints are numbered within the island, segments by position once the order is known. An entry is a pair of
// coupled positions; entries of a position are ascending.
struct Elimination {
  Index size = 0;               // segments of the island
  Index *segment, *local;       // the model's segments of the island, and the inverse map
  Index *order, *position;      // segments by position, and the inverse map
  Index *first;                 // entries of position p: first[p] .. first[p + 1] - 1
  Index *later, *earlier;       // positions of an entry
  Index *first_in, *in;         // entries by the later position
  Index *first_run;             // runs of constraint k: first_run[k] .. first_run[k + 1] - 1
  ConstraintRun* runs;
  Index *first_of, *next_of;    // linked list of the runs of a segment
  Index *degree, *mark, *of_degree, *before, *after;  // linked lists of segments by degree
  Index *lists, *next_list;     // linked lists of what couples a segment: runs and entries
  bool* merged;                   // constraints and positions whose list is part of another
  Index max_entries, max_runs, max_row_lanes;  // max_row_lanes: rows of all runs

  // Trees have fewer segments than the capacity, and small ones much less fill-in than pairs of segments.
  static std::ptrdiff_t entry_capacity(const Model& m) {
    const std::ptrdiff_t count = segment_capacity(m), nv = m.n.nv, each = tuning::elimination::entries_a_segment;
    const std::ptrdiff_t some =
        std::max(2 * nv - tuning::capacity::short_support, std::min(each * count, 6 * nv) - tuning::capacity::entries);
    return std::min(count * (count - 1) / 2, std::max<std::ptrdiff_t>(some, 1)) + 1;
  }
  // Room for eight segments a constraint on average; larger islands use another solver.
  static std::ptrdiff_t run_capacity(const Model& m, Index constraints) {
    return std::ptrdiff_t(std::min(m.n.carriers / segment_size + 2, tuning::elimination::runs_a_constraint)) * constraints +
           m.n.nv;
  }

  static std::ptrdiff_t row_lane_capacity(const Model& m, Index constraints) {
    using namespace tuning::capacity;
    const std::ptrdiff_t few_here = few - std::min(few, std::max<Index>(0, m.n.carriers - short_support));
    return std::min(max_rows * run_capacity(m, constraints),
                    std::max<std::ptrdiff_t>(least_row_lanes, row_lanes_of_runs * (constraints - few_here) + m.n.nv));
  }

  template <class F>
  void arrays(const Model& m, Index constraints, F&& f) {
    const Index count = segment_capacity(m);
    max_entries = Index(entry_capacity(m)), max_runs = Index(run_capacity(m, constraints)),
    max_row_lanes = Index(row_lane_capacity(m, constraints));
    for (Index** a :
         {&segment, &local, &order, &position, &first, &first_in, &first_of, &degree, &mark, &of_degree, &before, &after, &lists})
      f(*a, count + 2);
    for (Index** a : {&later, &earlier, &in}) f(*a, max_entries);
    f(first_run, constraints + 1), f(runs, max_runs), f(next_of, max_runs);
    f(next_list, std::ptrdiff_t(max_runs) + max_entries), f(merged, std::ptrdiff_t(constraints) + count);
  }

  // Finds the runs and the segments of the island. Returns false if there is no room.
  bool find_runs(const Island& x);
  // Finds the order after find_runs. Returns false if there is no room for the fill-in.
  bool find_order(const Island& x);

  Index entries() const { return first[size]; }
  // Calls f(run).
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
  void renumber(Index constraints);
};

}  // namespace dyn::simulation
