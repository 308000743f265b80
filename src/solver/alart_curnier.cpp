#include "solver/alart_curnier.hpp"

#include <algorithm>

namespace dyn::solver {

namespace {

using namespace tuning::alart_curnier;

class Newton {
 public:
  Newton(Workspace& w, Budget& b) : w(w), p(w.problem), b(b) {}
  bool run(const double* y, const double* c, bool damped_steps);

 private:
  Workspace& w;
  const Problem& p;
  Budget& b;
  // active: rows that are not at a bound, boxes first
  Index active = 0, free_boxes = 0;
  Index m = 0;                       // unknowns: active rows without the slip directions
  bool symmetric = true;
  double damping = 0;

  double error(const double* y, const double* c) const;
  void states();
  template <class F>
  void each_active_cone(F&& f) const {  // f(cone, state, its first active row, its first unknown)
    Index row = free_boxes, unknown = free_boxes;
    for (Index k = 0; k < p.blocks; ++k) {
      const Block& s = p.block[k];
      if (!s.is_cone() || !w.state[k].acts) continue;
      f(s, w.state[k], row, unknown);
      row += s.rows, unknown += s.rows - (w.state[k].mode == BlockState::slip);
    }
  }
  void rotate(const Block& s, const BlockState& state, Index row);
  void compress();
  void matrix();
  bool direction();
};

// Length of the function, as a velocity.
double Newton::error(const double* y, const double* c) const {
  double sum = 0;
  p.for_each([&](const Block& s) {
    double e[Block::max_rows];
    s.alart_curnier(y + s.first, c + s.first, e);
    for (Index i = 0; i < s.rows; ++i) sum += e[i] * s.per_speed[i] * (e[i] * s.per_speed[i]);
  });
  return std::sqrt(sum);
}

// Finds the states of all blocks, the known part of the step, and the active rows.
void Newton::states() {
  active = free_boxes = m = 0, symmetric = true;
  for (Index k = 0; k < p.blocks; ++k) {
    const Block& s = p.block[k];
    BlockState& state = w.state[k];
    state.find(s, w.newton + s.first, w.newton_c + s.first, w.step + s.first);
    if (!state.acts) continue;
    const bool slips = state.mode == BlockState::slip;
    for (Index i = 0; i < s.rows; ++i) w.rows[active++] = s.first + i;
    free_boxes += !s.is_cone(), m += s.rows - slips, symmetric &= !slips;
  }
}

// Rotates rows and columns of a slipping cone into its own directions.
void Newton::rotate(const Block& s, const BlockState& state, Index row) {
  const Matrix& B = w.active;
  const Index t = row + 1, size = s.rows - 1;
  double own[5][5];
  basis(state.direction, size, own);
  const auto turn = [&](double* x, std::ptrdiff_t stride) {
    double turned[5];
    for (Index k = 0; k < size; ++k) {
      turned[k] = 0;
      for (Index l = 0; l < size; ++l) turned[k] += own[k][l] * x[l * stride];
    }
    for (Index k = 0; k < size; ++k) x[k * stride] = turned[k];
  };
  for (Index i = 0; i < active; ++i) turn(&B(i, t), B.ld);
  for (Index j = 0; j < active; ++j) turn(&B(t, j), 1);
}

// Removes slip directions from the matrix after adding their columns to those of the normals.
void Newton::compress() {
  Matrix& B = w.active;
  Index kept = free_boxes, *keep = w.pivots;
  for (Index i = 0; i < free_boxes; ++i) keep[i] = i;
  each_active_cone([&](const Block& cone, const BlockState& s, Index row, Index) {
    for (Index i = 0; i < cone.rows; ++i)
      if (i != 1 || s.mode == BlockState::stick) keep[kept++] = row + i;
    if (s.mode == BlockState::stick) return;
    axpy(cone.mu, B.column(row + 1), B.column(row), active);
    for (Index i = 2; i < cone.rows; ++i) B(row + i, row + i) += 1 / s.across - 1;
  });
  const Matrix from = B;
  B.ld = padded(m);
  for (Index j = 0; j < m; ++j) {
    const double* column = from.column(keep[j]);
    for (Index i = 0; i < m; ++i) B(i, j) = column[keep[i]];
  }
}

// Builds the matrix of the system in w.active.
void Newton::matrix() {
  Matrix& B = w.active;
  B.ld = padded(active);
  for (Index j = 0; j < active; ++j) {
    const double* column = p.G.column(w.rows[j]);
    for (Index i = 0; i < active; ++i) B(i, j) = column[w.rows[i]];
    B(j, j) += std::max(tuning::proximal, damping);
  }
  if (symmetric) return;
  each_active_cone([&](const Block& cone, const BlockState& s, Index row, Index) {
    if (s.mode == BlockState::slip) rotate(cone, s, row);
  });
  compress();
}

// Sets w.step and w.step_c = G w.step. Returns false if singular.
bool Newton::direction() {
  states();
  matrix();
  double *e = w.step_c, *x = w.t;
  times(p.G, w.step, w.newton_c, e, p.n);
  for (Index i = 0; i < free_boxes; ++i) x[i] = -e[w.rows[i]];
  each_active_cone([&](const Block& cone, const BlockState& s, Index, Index u) {
    const Index row = cone.first, size = cone.rows - 1;
    x[u] = -e[row];
    if (s.mode == BlockState::stick) {
      for (Index i = 1; i <= size; ++i) x[u + i] = -e[row + i];
      return;
    }
    double own[5][5];
    basis(s.direction, size, own);
    for (Index k = 1; k < size; ++k) {
      x[u + k] = 0;
      for (Index l = 0; l < size; ++l)
        x[u + k] -= own[k][l] * (e[row + 1 + l] + (1 / s.across - 1) * w.newton_c[row + 1 + l]);
    }
  });
  ++b.factorizations;
  if (symmetric) {
    if (!cholesky(w.active, m)) return false;
    cholesky_solve(w.active, m, x);
  } else {
    if (!lu(w.active, m, w.pivots)) return false;
    lu_solve(w.active, m, w.pivots, x);
  }
  for (Index i = 0; i < free_boxes; ++i) w.step[w.rows[i]] = x[i];
  each_active_cone([&](const Block& cone, const BlockState& s, Index, Index u) {
    double* step = w.step + cone.first;
    if (s.mode == BlockState::stick) return void(std::copy_n(x + u, cone.rows, step));
    const Index size = cone.rows - 1;
    double own[5][5];
    basis(s.direction, size, own);
    step[0] = x[u];
    for (Index l = 0; l < size; ++l) {
      step[1 + l] += cone.mu * x[u] * own[0][l];
      for (Index k = 1; k < size; ++k) step[1 + l] += x[u + k] * own[k][l];
    }
  });
  times(p.G, w.step, nullptr, w.step_c, p.n);
  return true;
}

bool Newton::run(const double* y, const double* c, bool damped_steps) {
  const Index n = p.n;
  std::copy_n(y, n, w.newton), std::copy_n(c, n, w.newton_c);
  double last = error(w.newton, w.newton_c), largest = last;
  bool strayed = false;
  const auto keep = [&] {
    project(p, w.newton, w.trial);
    times(p.G, w.trial, p.g, w.trial_c, n);  // anew: long steps leave the rounding of their own size in newton_c
    return keep_best(w, b, w.trial, w.trial_c);
  };
  for (Index k = 0; k < (damped_steps ? max_damped_steps : max_steps) && !b.spent(); ++k) {
    ++b.newton_steps;
    if (!direction()) break;
    // backtracking; nonmonotone after a failed step (Grippo, Lampariello and Lucidi 1986)
    const double most = strayed ? largest : last;
    double t = 1, next = HUGE_VAL;
    for (; t >= tuning::shortest_part; t /= 2) {
      for (Index i = 0; i < n; ++i) w.trial[i] = w.newton[i] + t * w.step[i], w.trial_c[i] = w.newton_c[i] + t * w.step_c[i];
      next = error(w.trial, w.trial_c);
      if (next < most) break;
    }
    if (!(next < most)) {
      if (!damped_steps || damping >= 1) break;
      damping = std::max(first_damping, damping_factor * damping), strayed = true;
      continue;
    }
    if (t < 1)  // states change along the step: redundant contacts make null directions too long
      damping = std::max(min_damping, damping_factor * damping);
    else
      damping = damping > tuning::proximal ? damping / damping_factor : 0;
    std::swap(w.trial, w.newton), std::swap(w.trial_c, w.newton_c);
    // project and recompute: a long step along a cone leaves it by a little
    if (next < tuning::accept::near_round_off * round_off(p, w.newton)) {
      exact_velocity(p, w.newton, w.newton_c);
      next = error(w.newton, w.newton_c);
    }
    if ((next < near * b.tolerance || strayed) && keep()) return true;
    last = next, largest = std::max(largest, next);
  }
  return keep();
}

}  // namespace

bool alart_curnier(Workspace& w, Budget& b, const double* y, const double* c, bool damped_steps) {
  return Newton(w, b).run(y, c, damped_steps);
}

}  // namespace dyn::solver
