// Rows of an island in the units of its Newton steps, and products with G by segments.
#include "simulation/newton.hpp"

namespace dyn::simulation {

namespace {

constexpr Index as_they_are[6] = {0, 1, 2, 3, 4, 5};

}  // namespace

// Sets the scaling (unit diagonals, round cones) and the guess.
void Newton::scale() {
  Index boxes = 0, contacts = 0;
  for_each([&](const ActiveConstraint& a, State& s, Index k) {
    const ConstraintBlock& own = w.blocks[k];
    const Index rows = a.s->rows;
    s.order = as_they_are, s.rows = rows, s.cone = false;
    auto unit = [](double diagonal) { return diagonal > 0 ? 1 / std::sqrt(diagonal) : 1; };
    for (Index i = 0; i < rows; ++i) s.unit[i] = unit(own.diagonal[i] + x.compliance[a.s->first + i]);
    s.lower = -HUGE_VAL, s.upper = HUGE_VAL;
    if (a.kind == RowKind::Box) {
      s.lower = x.lower[boxes] / s.unit[0], s.upper = x.upper[boxes] / s.unit[0], ++boxes;
    } else if (a.kind == RowKind::Contact) {
      const double mu = x.friction[contacts++];
      if (rows == 1 || mu == 0) {
        s.lower = 0;
      } else {
        s.order = order_of[rows], s.cone = true;
        double across = 0;
        for (Index i = 1; i < rows; ++i) across = std::max(across, own.G[i + row_lanes * i]);
        const double n = unit(own.G[0]), t = unit(across);
        s.mu = mu * n / t;
        for (Index i = 0; i < rows; ++i) s.unit[i] = own.scale[i] * (i ? t : n);
        s.speed[0] = n, s.speed[1] = t;
      }
    }
    if (!s.cone) s.speed[0] = s.unit[0];
    for (Index i = 0; i < rows; ++i) {
      const double l = x.lambda[a.s->first + s.order[i]];
      y[a.s->first + i] = s.unit[i] > 0 ? l / s.unit[i] : 0;
      before[a.s->first + i] = y[a.s->first + i];
    }
  });
}

// Collects rows by segments, and pivots.
void Newton::build_segment_rows() {
  const double* Dinv = inverse_pivots(x.m, x.d);
  const Segments& segments = w.segments;
  std::fill_n(w.pivots, W * std::ptrdiff_t(e.size), 0.0);
  for (Index i = 0; i < e.size; ++i) {
    const Index s = e.segment[e.order[i]], first = segments.first[s];
    for (Index k = first; k < segments.first[s + 1]; ++k) w.pivots[W * i + k - first] = Dinv[k];
  }
  double* to = w.run_rows;
  for_each([&](const ActiveConstraint& a, const State& s, Index k) {
    Index n = 0;
    const double* carried = a.Y;
    for (Index r = e.first_run[k]; r < e.first_run[k + 1]; ++r) {
      ConstraintRun& run = e.runs[r];
      const Index of = e.segment[run.segment], first = segments.first[of];
      run.rows = to;
      std::fill_n(to, W * s.rows, 0.0);
      for (; n < a.s->support_count && segments.of[a.support[n]] == of; ++n, carried += row_lanes)
        for (Index i = 0; i < s.rows; ++i) to[W * i + a.support[n] - first] = s.unit[i] * carried[s.order[i]];
      to += W * s.rows;
    }
  });
}

// G y in scaled units, compliance included.
void Newton::times(const double* of, double* G_of) const {
  clear();
  for_each([&](const ActiveConstraint& a, const State& s, Index k) { scatter(k, s.rows, of + a.s->first); });
  for (std::ptrdiff_t i = 0; i < W * std::ptrdiff_t(e.size); ++i) w.by_segment[i] *= w.pivots[i];
  for_each([&](const ActiveConstraint& a, const State& s, Index k) {
    double* to = G_of + a.s->first;
    gather(k, s.rows, w.by_segment, to);
    for (Index i = 0; i < s.rows; ++i) to[i] += soft(a, s, i) * of[a.s->first + i];
  });
}

void Newton::velocities() const {
  times(y, c);
  for_each([&](const ActiveConstraint& a, const State& s, Index) {
    for (Index i = 0; i < s.rows; ++i) c[a.s->first + i] += s.unit[i] * (x.g[a.s->first + s.order[i]] + x.bias[a.s->first + s.order[i]]);
  });
}

}  // namespace dyn::simulation
