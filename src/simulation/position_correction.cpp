// Position errors at the end of the step, and the displacement that removes a part of them, without friction.
#include <algorithm>

#include "algorithm/constrained/redundant_rows.hpp"
#include "simulation/island.hpp"

namespace dyn::simulation {

// Returns whether a row's error is an angle.
bool Island::is_angle(const ActiveConstraint& x, Index row) const {
  const ConstraintInstance<double>& s = *x.s;
  if (of_path(s.c)) return m.paths()[s.c.path - 1].angular;
  if (between_joints(s.c.type)) return m.bodies()[body_of_dof(m, s.c.v1)].type != BodyType::Prismatic;
  const auto pulls = [&](const double* F, Index body) {
    return body && (F[row] != 0 || F[row_lanes + row] != 0 || F[2 * row_lanes + row] != 0);
  };
  return !pulls(s.F1, s.c.body1) && !pulls(s.F2, s.c.body2);
}

// Sets the bias of all rows to the part of their errors that a step corrects: of each row by itself, or, if `shared` is over 1,
// of all errors divided by it, so that their ratios stay.
// In steps that follow from an accuracy: the error where the step ends (simulation/extrapolated.hpp), less half of h times
// the closing rate of rolling surfaces, once for each drift. That part is no error: it falls as h^2, and extrapolation
// over steps of different lengths would turn it into one.
// Rows as the file has them are springs: no error is theirs to correct.
Island::PositionErrors Island::find_position_errors(double shared) {
  const double most = correction_speed(d, h) * h / w.length;  // of the length scale, or rad
  const double ahead = w.closed_gap > 0 ? 0 : h, moved = w.closed_gap > 0 ? 0.5 * h * w.drift_count : 0;
  PositionErrors out;
  auto part = [&](double wrong, double unit) {
    const double half = tuning::island::correction * wrong;
    out.largest = std::max(out.largest, std::abs(wrong) / unit), out.over = std::max(out.over, std::abs(half) / (most * unit));
    return shared > 1 ? half / shared : std::clamp(half, -most * unit, most * unit);
  };
  auto one_sided = [&](double gap, double unit) { return gap < 0 ? part(gap, unit) : gap; };
  for (Index k = 0, in_boxes = 0; k < constraint_count; ++k) {
    ActiveConstraint& x = constraint(k);
    double over[2] = {1, 1};  // an equality's largest length and angle over what a step corrects: errors keep their directions
    for (Index r = 0; r < x.rows; ++r) {
      const Index i = x.first + r;
      double wrong = 0;
      if (x.kind == RowKind::Equality && !(x.s->c.stiffness > 0 || x.s->c.damping > 0)) {
        if (dropped > 0 || !(x.s->dropped >> r & 1)) {
          const bool angle = is_angle(x, r);
          wrong = x.s->error[r] + ahead * c[i];
          const double size = std::abs(wrong) / (angle ? 1 : w.length);
          wrong *= tuning::island::correction;
          out.largest = std::max(out.largest, size);
          over[angle] = std::max(over[angle], tuning::island::correction * size / most);
        }
      } else if (x.kind == RowKind::Box && x.s->c.type == DYN_CONSTRAINT_TYPE_LIMIT) {
        wrong = one_sided(x.s->error[0] + ahead * c[i] + w.closed_gap, is_angle(x, r) ? 1 : w.length);
      } else if (x.kind == RowKind::Box) {
        lower[in_boxes] = upper[in_boxes] = w.blocks[k].lower = w.blocks[k].upper = 0;
      } else if (x.kind == RowKind::Contact && r == normal_row(x.rows)) {
        const double rate = w.laws[x.index].rate[r];
        const double gap = w.contacts[x.index].contact.distance + ahead * c[i] + w.closed_gap + moved * std::max(0.0, -rate);
        wrong = is_soft(w.laws[x.index].material) ? std::max(gap, most * w.length) : one_sided(gap, w.length);
      }
      g[i] = compliance[i] = 0, bias[i] = wrong;
    }
    in_boxes += x.kind == RowKind::Box;
    x.far = over[0] > 1 || over[1] > 1, out.far |= x.far;
    if (!x.far) continue;
    for (Index r = 0; r < x.rows; ++r) bias[x.first + r] /= over[is_angle(x, r)];
  }
  if (out.largest > tuning::slop && dropped > 0) share_errors(m, d, bias);
  return out;
}

// What would move at a contact if its links flew, over what moves with their joints; at least 1. Joints that hardly open a
// contact have long ways to do so: rows that give way do it by this much more.
double Island::free_share(Index k) const {
  const ActiveConstraint& x = constraint(k);
  if (x.kind != RowKind::Contact) return 1;
  const ContactLaw& law = w.laws[x.index];
  double free = 0;
  for (const Index geom : {law.geom_a, law.geom_b})
    if (const double mass = m.bodies()[d.geoms[geom].body].m; mass > 0) free += 1 / mass;
  const double unit = w.blocks[k].unit[0];
  return std::max(1.0, unit * unit * free);
}

// A shape that overlaps where limits leave it no way out: rows that contradict each other give way in proportion to their errors.
bool Island::correct() {
  if (is_as_file()) [[unlikely]] return false;
  const PositionErrors errors = find_position_errors(1);
  if (!(errors.largest > tuning::slop)) return false;
  if (has_room_for_matrix() && equalities > 0) solve_displacement(errors.far), scatter_all();
  else if (!correct_by_sweeps(0))
    find_position_errors(errors.over), correct_by_sweeps(tuning::sweeps::contradictory_softness);
  return true;
}

}  // namespace dyn::simulation
