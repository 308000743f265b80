// Buffers of the solvers in one block of memory, for a number of rows.
#pragma once

#include "solver/block_state.hpp"
#include "solver/problem.hpp"

namespace dyn::solver {

struct Workspace {
  Index max_rows = 0;
  Problem problem;
  double* free_g = nullptr;                // g without restitution
  double *y = nullptr, *c = nullptr;       // best feasible iterate, and G y + g
  // of a solver
  double *x = nullptr, *z = nullptr, *s = nullptr, *r = nullptr, *v = nullptr, *u = nullptr;
  // of Newton's method
  double *newton = nullptr, *newton_c = nullptr, *trial = nullptr, *trial_c = nullptr;
  double *step = nullptr, *step_c = nullptr, *t = nullptr, *exact = nullptr;
  Matrix factor, active;
  bool places_active = true;  // false: the caller gives the memory of `active`
  Index* pivots = nullptr;
  BlockState* state = nullptr;
  LawMatrix* laws = nullptr;

  // Calls f(array, numbers) for each array of the workspace.
  template <class F>
  void arrays(F&& f) {
    const std::ptrdiff_t n = padded(max_rows), square = n * n;
    Problem& p = problem;
    for (double** a : {&p.G.x, &factor.x}) f(*a, square);
    if (places_active) f(active.x, square);
    for (double** a : {&p.g, &p.d, &p.unit, &p.per_unit, &p.approach, &free_g,  &y,    &c,      &x, &z,
                       &s,   &r,       &v,       &u,   &newton, &newton_c,   &trial,      &trial_c, &step, &step_c, &t, &exact})
      f(*a, n);
    f(p.block, n), f(p.local, n / 2), f(p.source, n), f(pivots, n), f(state, n), f(laws, n);
  }
};

inline std::size_t workspace_bytes(Index max_rows) {
  Workspace w;
  w.max_rows = max_rows;
  std::size_t bytes = 0;
  w.arrays([&](auto* array, std::ptrdiff_t n) { bytes += (std::size_t(n) * sizeof *array + 63) / 64 * 64; });
  return bytes;
}

// memory: workspace_bytes(max_rows) zeros, aligned to 64. Rows beyond the last one are read.
inline void place(Workspace& w, Index max_rows, void* memory) {
  w.max_rows = max_rows;
  char* next = static_cast<char*>(memory);
  w.arrays([&](auto*& array, std::ptrdiff_t n) {
    array = reinterpret_cast<std::remove_reference_t<decltype(array)>>(next);
    next += (std::size_t(n) * sizeof *array + 63) / 64 * 64;
  });
}

}  // namespace dyn::solver
