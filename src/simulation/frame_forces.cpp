#include "simulation/frame_forces.hpp"

#include "simulation/island.hpp"

namespace dyn::simulation {

namespace {

// lambda: of the slot's rows. scale: a force for a unit of lambda.
void note(Data<double>& d, const ConstraintInstance<double>& s, const double* lambda, double scale) {
  if (between_joints(s.c.type) || of_path(s.c)) return;
  const auto on = [&](Index body, const double* F) {
    Force<double> sum = Force<double>::zero();
    for (Index r = 0; r < s.rows; ++r) {
      double f[6];
      for (int i = 0; i < 6; ++i) f[i] = F[row_lanes * i + r] * lambda[r] * scale;
      sum = sum + Force<double>{load3(f), load3(f + 3)};
    }
    return shift(sum, d.p[body] - d.rel[body]);  // from the root of its tree to the world's origin
  };
  const Force<double> zero = Force<double>::zero();
  const Force<double> first = s.c.body1 ? on(s.c.body1, s.F1) : zero - on(s.c.body2, s.F2),
                      second = s.c.body2 ? on(s.c.body2, s.F2) : zero - first;
  double* const out = d.step->frame_forces + 12 * (&s - d.slots);
  store3(first.linear, out), store3(first.angular, out + 3), store3(second.linear, out + 6), store3(second.angular, out + 9);
}

}  // namespace

std::ptrdiff_t frame_force_numbers(const Model& m) {
  for (Index k = 0; k < m.n.sensors; ++k)
    if (const dynQuantity q = m.sensors()[k].spec.quantity; q == DYN_QUANTITY_FORCE || q == DYN_QUANTITY_TORQUE)
      return 12 * std::ptrdiff_t(m.n.slots);
  return 0;
}

void note_frame_forces(const Island& x, const ActiveConstraint& a) { note(x.d, *a.s, x.lambda + a.first, 1 / x.h); }

void note_frame_forces(const Model& m, Data<double>& d) {
  for_each_constraint(m, d, [&](const ConstraintInstance<double>& s, Index) { note(d, s, d.lambda + s.first, 1); });
}

}  // namespace dyn::simulation
