#include "simulation/conservative_advancement.hpp"

#include <cmath>

#include "simulation/step.hpp"

namespace dyn::simulation {

namespace {

using namespace tuning::advancement;

// Bound of the motion so far (a) and in this step (b): |a| + |b| <= sqrt(2 (a^2 + b^2)), sum of n sizes <= sqrt(n sum of
// squares).
double squares(const Model& m, const AdvancementCache& c, const double* q, const double* v, double h) {
  using P = Simd<double, 4>;
  P sums = P::zero();
  for (Index k = 0; k < m.n.nv; k += 4) {
    const P l = P::load(c.lever + k), a = (P::load(q + k) - P::load(c.q + k)) * l,
            b = P::load(v + k) * (tuning::speed_growth * h) * l;
    sums = sums + a * a + b * b;
  }
  return sum(sums);
}

}  // namespace

bool can_cache_advancement(const Model& m) {
  for (Index i = 1; i < m.n.bodies; ++i)
    if (m.bodies()[i].type != BodyType::Revolute && m.bodies()[i].type != BodyType::Prismatic) return false;
  return !m.has_mimic && m.n.path_rows == 0;
}

bool cache_excludes_contact(const Model& m, const Data<double>& d, double h) {
  const AdvancementCache& c = d.step->advancement_cache;
  return c.square > 0 && squares(m, c, d.q, d.v, h) < c.square;
}

void update_advancement_cache(const Model& m, Data<double>& d, const double* v, double h, double min_distance) {
  AdvancementCache& c = d.step->advancement_cache;
  c.square = 0;
  if (!c.enabled || !(min_distance > 0)) return;
  if (!(min_distance < shape::infinity)) min_distance = d.step->length;  // limits alone: any unit
  std::fill_n(c.lever, m.n.nv, 0.0);
  for (Index k = 0; m.n.contacts > 0 && k < d.step->geom_count; ++k) {
    const Index geom = d.step->geoms[k];
    const collision::Geom& g = d.geoms[geom];
    if (g.body && !(g.bounding_radius < shape::infinity)) return;
    for (Index i = g.body; i; i = m.bodies()[i].parent) {
      const Body& b = m.bodies()[i];
      const double far = shape::norm(d.geom_poses[geom].p - d.p[i]) + g.bounding_radius + min_distance;
      c.lever[b.idx_v] = b.type == BodyType::Prismatic ? 1 : std::max(c.lever[b.idx_v], far);
    }
  }
  for (Index k = 0; k < m.n.limits; ++k) {
    const LimitRecord& r = m.limits()[k];
    const double gap = std::min(d.q[r.q] - m.lower_limit()[r.q], m.upper_limit()[r.q] - d.q[r.q]) -
                       tuning::limit_margin * unit_of(m, *d.step, r);
    if (!(gap > 0)) return;
    c.lever[r.dof] = std::max(c.lever[r.dof], min_distance / gap);
  }
  std::copy_n(d.q, m.n.nq, c.q);
  const double square = min_distance * min_distance / (2 * m.n.nv);
  double next = 0;
  for (Index k = 0; k < m.n.nv; ++k)
    next += tuning::speed_growth * tuning::speed_growth * h * h * v[k] * v[k] * c.lever[k] * c.lever[k];
  if (min_steps_saved * min_steps_saved * next < square) c.square = square;
}

bool limits_inactive(const Model& m, const Data<double>& d, const double* v, double h) {
  if (!(d.acting & DYN_EFFECT_LIMITS)) return true;
  for (Index k = 0; k < m.n.limits; ++k) {
    const LimitRecord& r = m.limits()[k];
    if (is_ball(m, r)) {
      if (ball_gap(m, d, r, v).gap <= tuning::speed_growth * h * ball_speed(r, v) + tuning::limit_margin) return false;
      continue;
    }
    const double q = d.q[r.q],
                 reach = tuning::speed_growth * h * std::abs(v[r.dof]) + tuning::limit_margin * unit_of(m, *d.step, r);
    if (q - m.lower_limit()[r.q] <= reach || m.upper_limit()[r.q] - q <= reach) return false;
  }
  return true;
}

}  // namespace dyn::simulation
