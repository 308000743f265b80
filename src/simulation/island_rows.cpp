// Rows of an island by segments, and Newton's products with G by them.
#include "simulation/newton.hpp"

namespace dyn::simulation {

namespace {

constexpr Index as_they_are[6] = {0, 1, 2, 3, 4, 5};

double unit_of(double diagonal) { return diagonal > 0 ? 1 / std::sqrt(diagonal) : 1; }

// Units of a contact's rows: one for the normal, one for all others.
void set_cone(const Island& x, const ConstraintBlock& own, Index first, double mu, RowBlock& s) {
  double across = 0;
  for (Index i = 1; i < s.rows; ++i) across = std::max(across, own.G[i + row_lanes * i]);
  const double n = unit_of(own.G[0]), t = unit_of(across);
  s.speed[0] = n, s.speed[1] = t, s.mu = mu * n / t;
  for (Index i = 0; i < s.rows; ++i) {
    s.unit[i] = own.scale[i] * (i ? t : n);
    s.soft[i] = x.compliance[first + s.order[i]] * s.unit[i] * s.unit[i];
  }
  s.kind = RowBlock::Kind::cone;
  if (s.rows != 3) return;
  double G[9];
  for (Index j = 0; j < 3; ++j)
    for (Index i = 0; i < 3; ++i) G[i + 3 * j] = own.G[i + row_lanes * j] * (i ? t : n) * (j ? t : n);
  if (s.point.set(G, 3)) s.kind = RowBlock::Kind::point;
}

}  // namespace

// Y' = unit Y D^-1/2, D the pivots: G = Y'^T Y'.
void Island::build_rows() {
  if (has_rows) return;
  has_rows = true;
  const double* Dinv = inverse_pivots(m, d);
  const Elimination& e = w.elimination;
  double* to = w.run_rows;
  bool turned = false;  // cones that need their eigenvectors
  for (Index k = 0, in_boxes = 0, in_contacts = 0; k < constraint_count; ++k) {
    const ActiveConstraint& a = constraint(k);
    const ConstraintBlock& own = w.blocks[k];
    RowBlock& s = w.row_blocks[k];
    const Index rows_ = a.s->rows, first = a.s->first;
    s.kind = RowBlock::Kind::rows, s.order = as_they_are, s.rows = rows_, s.lower = -HUGE_VAL, s.upper = HUGE_VAL, s.mu = 0;
    if (a.kind == RowKind::Contact) {
      const double mu = friction[in_contacts++];
      s.lower = 0;
      if (rows_ > 1) s.order = order_of[rows_], set_cone(*this, own, first, mu, s);
      turned |= s.kind == RowBlock::Kind::cone;
    }
    if (!s.is_cone()) {
      for (Index i = 0; i < s.rows; ++i) {
        const Index at = s.order[i];
        s.unit[i] = unit_of(own.diagonal[at] + compliance[first + at]),
        s.soft[i] = compliance[first + at] * s.unit[i] * s.unit[i];
      }
      if (a.kind == RowKind::Box) s.lower = lower[in_boxes] / s.unit[0], s.upper = upper[in_boxes] / s.unit[0], ++in_boxes;
      s.speed[0] = s.unit[0];
    }
    Index n = 0;
    const double* Y = a.Y;
    for (Index r = e.first_run[k]; r < e.first_run[k + 1]; ++r) {
      ConstraintRun& run = e.runs[r];
      const Index of = e.segment[run.segment], begin = w.segments.first[of];
      run.rows = to;
      std::fill_n(to, segment_lanes * s.rows, 0.0);
      for (; n < a.s->support_count && w.segments.of[a.support[n]] == of; ++n, Y += row_lanes) {
        const double root = std::sqrt(Dinv[a.support[n]]);
        for (Index i = 0; i < s.rows; ++i) to[segment_lanes * i + a.support[n] - begin] = root * s.unit[i] * Y[s.order[i]];
      }
      to += segment_lanes * s.rows;
    }
  }
  if (turned) prepare_cones();
}

// Copies the blocks and the guess.
void Newton::load() {
  std::fill_n(before, x.rows, 0.0);
  for_each([&](const ActiveConstraint& a, State& s, Index k) {
    const RowBlock& own = w.row_blocks[k];
    s.order = own.order, s.rows = own.rows, s.cone = own.is_cone(), s.mu = own.mu, s.lower = own.lower, s.upper = own.upper;
    std::copy_n(own.unit, s.rows, s.unit), std::copy_n(own.soft, s.rows, s.soft), std::copy_n(own.speed, 2, s.speed);
    for (Index i = 0; i < s.rows; ++i) {
      const double l = x.lambda[a.s->first + s.order[i]];
      before[a.s->first + i] = s.unit[i] > 0 ? l / s.unit[i] : 0;
    }
  });
}

// G y in scaled units, compliance included.
void Newton::times(const double* of, double* G_of) const {
  clear();
  for_each([&](const ActiveConstraint& a, const State& s, Index k) {
    by_rows(s, [&]<int rows>() DYN_INLINE_LAMBDA { scatter<rows>(k, of + a.s->first); });
  });
  for_each([&](const ActiveConstraint& a, const State& s, Index k) {
    double* to = G_of + a.s->first;
    by_rows(s, [&]<int rows>() DYN_INLINE_LAMBDA {
      gather<rows>(k, w.by_segment, to);
      for (int i = 0; i < rows; ++i) to[i] += s.soft[i] * of[a.s->first + i];
    });
  });
}

void Newton::velocities() const {
  times(y, c);
  for_each([&](const ActiveConstraint& a, const State& s, Index) {
    for (Index i = 0; i < s.rows; ++i)
      c[a.s->first + i] += s.unit[i] * (x.g[a.s->first + s.order[i]] + x.bias[a.s->first + s.order[i]]);
  });
}

}  // namespace dyn::simulation
