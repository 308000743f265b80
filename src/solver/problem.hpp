// The contact problem of dyn.h as the solvers use it: rows scaled to a unit diagonal, rows fixed at zero removed.
// Boxes come first, then cones with the normal first; the compliance is added to the diagonal of G.
//   lambda = d y, c = c' / d, G' = d G d: K stays a cone if its tangential rows share one d; mu' = mu d_n / d_t
// Torsion and rolling: lambda_r / rolling = (lambda_r friction / rolling) / friction, so that row's d is d_t rolling / friction.
#pragma once

#include "dyn.h"
#include "solver/block.hpp"
#include "solver/dense.hpp"

namespace dyn::solver {

struct Problem {
  Index n = 0, blocks = 0;
  Matrix G;
  double *g = nullptr, *d = nullptr;
  double* unit = nullptr;      // d without the lengths of torsion and rolling: c' / unit is a velocity in the caller's unit
  double* per_unit = nullptr;  // 1 / unit
  double* approach = nullptr;  // part of g due to full restitution
  Block* block = nullptr;      // boxes of one row each, then cones
  LocalCone* local = nullptr;  // memory of the cones
  Index* source = nullptr;     // the caller's row
  double speed = 0;            // largest velocity without impulses, in the caller's unit
  bool bounces = false;        // some approach is not zero

  // Calls f(block).
  template <class F>
  void for_each(F&& f) const {
    for (Index k = 0; k < blocks; ++k) f(block[k]);
  }
};

// y = P_K(w)
inline void project(const Problem& p, const double* w, double* y) {
  p.for_each([&](const Block& s) { s.project(w + s.first, y + s.first); });
}

// c = G y + g in extended precision, needed when impulses are large relative to the speeds they cause.
void exact_velocity(const Problem& p, const double* y, double* c);
// Bound on the round-off of c = G y + g, a velocity in the caller's unit.
double round_off(const Problem& p, const double* y);

// Rows of the caller's contact k.
inline Index rows_of(const dynContactProblem& x, Index k) { return x.contact_rows ? x.contact_rows[k] : 3; }
inline std::ptrdiff_t row_count(const dynContactProblem& x) {
  std::ptrdiff_t n = std::ptrdiff_t(x.equalities) + x.boxes;
  for (Index k = 0; k < x.contacts; ++k) n += rows_of(x, k);
  return n;
}

// Fills p, whose arrays have room for the caller's rows.
void scale(const dynContactProblem& x, Problem& p);
// c = (G + diag(compliance)) lambda + g + bias, for all of the caller's rows.
void velocity(const dynContactProblem& x, const double* lambda, double* c);
// The caller's lambda from y (removed rows: zero), and back, projected onto the cones.
void unscale(const dynContactProblem& x, const Problem& p, const double* y, double* lambda);
void scale_guess(const Problem& p, const double* lambda, double* y);

}  // namespace dyn::solver
