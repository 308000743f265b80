// Blocks of an island in their units, and their rows by segments.
#include "algorithm/constrained/delassus.hpp"
#include "simulation/island.hpp"

namespace dyn::simulation {

namespace {

using solver::Block;

constexpr Index as_they_are[6] = {0, 1, 2, 3, 4, 5};

double unit_of(double diagonal) { return diagonal > 0 ? 1 / std::sqrt(diagonal) : 1; }

// Diagonal of a constraint's own block of G.
void own_diagonal(const ActiveConstraint& a, const PropagatedRows& of, const double* Dinv, double* diagonal) {
  using P = Simd<double, row_lanes>;
  P sum = P::zero();
  const double* y = of.Y;
  for (Index n = 0; n < a.support_count; ++n, y += row_lanes) sum = sum + P::load(y) * P::load(y) * Dinv[of.support[n]];
  sum.store(diagonal);
}

// The block itself, column by column.
void own_block(const ActiveConstraint& a, const PropagatedRows& of, const double* Dinv, double* block) {
  using P = Simd<double, row_lanes>;
  P G[max_rows];
  for (P& column : G) column = P::zero();
  const double* y = of.Y;
  for (Index n = 0; n < a.support_count; ++n, y += row_lanes) {
    const P e = P::load(y) * Dinv[of.support[n]];
    for (Index r = 0; r < a.rows; ++r) G[r] = G[r] + e * y[r];
  }
  for (Index r = 0; r < a.rows; ++r) G[r].store(block + row_lanes * r);
}

void set_rows(Block& s, const double* diagonal, const double* compliance) {
  s.kind = Block::Kind::rows, s.order = as_they_are;
  for (Index i = 0; i < s.rows; ++i) {
    const double own = diagonal[i] + compliance[i];
    s.unit[i] = unit_of(own), s.per_speed[i] = 1 / s.unit[i], s.response[i] = own > 0;
    s.soft[i] = compliance[i] * s.unit[i] * s.unit[i];
  }
}

// One unit for the normal, one for all other velocities; torsion and rolling are multiples of friction.
void set_cone(const Island& x, Index contact, const double* diagonal, const double* compliance, Block& s) {
  const double mu = x.friction[contact];
  double scale[max_rows], across = 0;
  s.kind = Block::Kind::cone, s.order = order_of[s.rows];
  const auto own = [&](Index i) { return diagonal[s.order[i]] + compliance[s.order[i]]; };
  for (Index i = 0; i < s.rows; ++i) scale[i] = i < 3 ? 1 : (i == s.rows - 1 ? x.torsion[contact] : x.rolling[contact]) / mu;
  for (Index i = 1; i < s.rows; ++i) across = std::max(across, scale[i] * scale[i] * own(i));
  const double n = unit_of(own(0)), t = unit_of(across), per_n = 1 / n, per_t = 1 / t;
  s.mu = mu * n * per_t;
  for (Index i = 0; i < s.rows; ++i) {
    s.per_speed[i] = i ? per_t : per_n, s.unit[i] = scale[i] * (i ? t : n);
    s.soft[i] = compliance[s.order[i]] * s.unit[i] * s.unit[i];
  }
}

}  // namespace

void Island::prepare_blocks() {
  fastest = speed();
  const double* Dinv = inverse_pivots(m, d);
  for (Index k = 0, in_boxes = 0, in_contacts = 0; k < constraint_count; ++k) {
    const ActiveConstraint& a = constraint(k);
    Block& s = w.blocks[k];
    double diagonal[row_lanes];
    own_diagonal(a, rows_of(a), Dinv, diagonal);
    s.first = a.first, s.rows = a.rows;
    const Index contact = a.kind == RowKind::Contact ? in_contacts++ : 0;
    if (a.kind == RowKind::Contact && s.rows > 1) {
      set_cone(*this, contact, diagonal, compliance + s.first, s);
      continue;
    }
    set_rows(s, diagonal, compliance + s.first);
    s.lower = a.kind == RowKind::Contact ? 0 : -HUGE_VAL, s.upper = HUGE_VAL;
    if (a.kind == RowKind::Box) s.lower = lower[in_boxes] / s.unit[0], s.upper = upper[in_boxes] / s.unit[0], ++in_boxes;
  }
}

// The blocks of friction cones, which sweeps solve.
void Island::prepare_sweeps() {
  if (has_cones) return;
  has_cones = true;
  Index cones = 0;
  const Index most = cone_capacity(m);
  for (Index k = 0; k < constraint_count; ++k) {
    Block& s = w.blocks[k];
    if (!s.is_cone()) continue;
    double G[max_rows * max_rows];
    scaled_block(k, G);
    if (s.rows == 3 && s.point.set(G, 3)) {
      s.kind = Block::Kind::point;
      continue;
    }
    s.cone = cones < most ? &w.cones[cones++] : nullptr;
    if (s.cone) s.cone->set(G, s.rows, s.rows);
  }
}

// A constraint's own block of G in the units of its rows, with its compliance, column by column.
void Island::scaled_block(Index k, double* G) const {
  const Block& s = w.blocks[k];
  double own[max_rows * row_lanes];
  own_block(constraint(k), rows_of(k), inverse_pivots(m, d), own);
  for (Index j = 0; j < s.rows; ++j) {
    for (Index i = 0; i < s.rows; ++i) G[i + s.rows * j] = s.unit[i] * s.unit[j] * own[s.order[i] + row_lanes * s.order[j]];
    G[j + s.rows * j] += s.soft[j];
  }
}

// Largest velocity that is to change. Torsion and rolling rows count by their lengths, rows without a coefficient not at all.
double Island::speed() const {
  double most = 0;
  for (Index k = 0, contact = 0; k < constraint_count; ++k) {
    const ActiveConstraint& a = constraint(k);
    const bool touches = a.kind == RowKind::Contact;
    for (Index r = 0; r < a.rows; ++r) {
      const double length = r < 3 || !touches ? 1
                            : friction[contact] > 0
                                ? (r == a.rows - 1 ? torsion[contact] : rolling[contact]) / friction[contact]
                                : 0;
      most = std::max(most, length * std::abs(g[a.first + r] + bias[a.first + r]));
    }
    contact += touches;
  }
  return most;
}

// Y' = unit Y D^-1/2, D the pivots: G = Y'^T Y'.
void Island::build_rows() {
  if (has_rows) return;
  has_rows = true;
  const double* Dinv = inverse_pivots(m, d);
  const Elimination& e = w.elimination;
  double* to = w.run_rows;
  for (Index k = 0; k < constraint_count; ++k) {
    const ActiveConstraint& a = constraint(k);
    const Block& s = w.blocks[k];
    Index n = 0;
    const auto [support, columns] = rows_of(a);
    const double* Y = columns;
    for (Index r = e.first_run[k]; r < e.first_run[k + 1]; ++r) {
      ConstraintRun& run = e.runs[r];
      const Index of = e.segment[run.segment], begin = w.segments.first[of];
      run.rows = to;
      std::fill_n(to, segment_lanes * s.rows, 0.0);
      for (; n < a.support_count && w.segments.of[support[n]] == of; ++n, Y += row_lanes) {
        const double root = std::sqrt(Dinv[support[n]]);
        for (Index i = 0; i < s.rows; ++i) to[segment_lanes * i + support[n] - begin] = root * s.unit[i] * Y[s.order[i]];
      }
      to += segment_lanes * s.rows;
    }
  }
}

}  // namespace dyn::simulation
