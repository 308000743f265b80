#include "dyn/simulation/clearance.hpp"

#include <cmath>

#include "dyn/simulation/step.hpp"

namespace dyn::simulation {

namespace {

constexpr double worth = 20;  // steps, that a search in vain should spare

bool one_coordinate_each(const Model& m) {
  for (Index i = 1; i < m.n.bodies; ++i)
    if (m.bodies()[i].type != BodyType::Revolute && m.bodies()[i].type != BodyType::Prismatic) return false;
  return !m.has_mimic;
}

// lever |x| summed, x = q - q0 + what h v adds to it
double motion(const Model& m, const Clearance& c, const double* q, const double* v, double h) {
  using P = Pack<double, 8>;
  auto size = [](auto x) { return x * x; };
  double sum = 0;
  Index k = 0;
  P sums = P::zero();
  // |a| + |b| <= sqrt(2 (a^2 + b^2)), and a sum of n sizes <= sqrt(n sum of squares)
  for (; k + 8 <= m.n.nv; k += 8) {
    const P l = P::load(c.lever + k);
    sums = sums + size((P::load(q + k) - P::load(c.q + k)) * l) + size(P::load(v + k) * l * h);
  }
  for (; k < m.n.nv; ++k) sum += size((q[k] - c.q[k]) * c.lever[k]) + size(v[k] * c.lever[k] * h);
  for (int i = 0; i < 8; ++i) sum += sums[i];
  return 2 * m.n.nv * sum;
}

bool limits_near(const LimitRun& r, const double* lower, const double* upper, const double* q, const double* v, double h) {
  std::int64_t near = 0;
  for (Index k = 0; k < r.count; ++k) {
    const double reach = 3 * h * std::abs(v[k]) + 1e-4;
    near += (q[k] - lower[k] <= reach) | (upper[k] - q[k] <= reach);
  }
  return near != 0;
}

}  // namespace

bool all_clear(const Model& m, const Data<double>& d, const double* v, double h) {
  const Workspace& w = *d.step;
  const Clearance& c = w.clearance;
  if (m.n.contacts > 0 && !(c.between > 0 && w.contact_count == 0 && motion(m, c, d.q, v, h) < c.between * c.between)) return false;
  if (d.acting & DYN_EFFECT_LIMITS)
    for (Index k = 0; k < c.runs; ++k) {
      const LimitRun& r = c.limit_runs[k];
      if (limits_near(r, m.lower_limit() + r.q, m.upper_limit() + r.q, d.q + r.q, v + r.dof, h)) return false;
    }
  return true;
}

void note_clearance(const Model& m, Data<double>& d, const double* v, double h, double between) {
  Clearance& c = d.step->clearance;
  c.between = 0;
  if (!c.possible || !(between > 0)) return;
  between = std::min(between, 1e3);  // levers may grow by as much
  std::fill_n(c.lever, m.n.nv, 0.0);
  for (Index k = 0; k < m.n.geoms; ++k) {
    const collision::Geom& g = d.geoms[k];
    if (g.body == 0) continue;
    if (!(g.reach < shape::infinity)) return;
    for (Index i = g.body; i; i = m.bodies()[i].parent) {
      const Body& b = m.bodies()[i];
      const double far = shape::norm(d.geom_poses[k].p - d.p[i]) + g.reach + between;
      c.lever[b.idx_v] = b.type == BodyType::Prismatic ? 1 : std::max(c.lever[b.idx_v], far);
    }
  }
  std::copy_n(d.q, m.n.nq, c.q);
  if (worth * worth * motion(m, c, d.q, v, h) < between * between) c.between = between;
}

void place_clearance(const Model& m, Clearance& c) {
  c.between = 0, c.runs = 0, c.possible = one_coordinate_each(m);
  for (Index k = 0; k < m.n.limits; ++k) {
    const LimitRecord& r = m.limits()[k];
    LimitRun* last = c.runs ? c.limit_runs + c.runs - 1 : nullptr;
    if (last && r.q == last->q + last->count && r.dof == last->dof + last->count) ++last->count;
    else c.limit_runs[c.runs++] = {r.q, r.dof, 1};
  }
}

}  // namespace dyn::simulation
