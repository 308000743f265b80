// Derivatives of the correction of positions: q' = q (+) (h v' + N^-1 J^T mu). Its mu are those of a few sweeps of Gauss and
// Seidel over the normal rows (Sweeps::frictionless), which end before they converge. So the sweeps themselves are
// differentiated:
//   mu_i = max(0, mu_i - (b_i + sum_j G_ij mu_j) / G_ii)
// with b the share of the gap at the end of the step that is removed. G and N^-1 J^T change by q, too. Where that matters, each
// row takes derivatives of inverse dynamics at the acceleration N^-1 J_j^T.
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

namespace {

struct Correction {
  StepJacobian& s;
  const Model& m = s.m;
  Data<double>& d = s.d;
  StepDerivatives& x = s.x;
  JacobianArrays& y = s.y;
  const Workspace& w = s.w;
  const std::ptrdiff_t nv = s.nv, columns = s.columns, room = jacobian_rows(m), most_exact = exact_corrections(m);
  const double h = s.h;
  Index& count = s.corrections;
  Index rows = s.rows, contacts = s.contacts;  // with those that do not press

  CorrectionRow& row(Index i) const { return y.corrections[i]; }
  double* J(Index i) const { return s.J(row(i).row); }
  double* Z(Index i) const { return y.Z + nv * row(i).row; }
  double& G(Index i, Index j) const { return y.G[room * i + j]; }
  std::ptrdiff_t pair(Index i, Index j) const { return most_exact * row(i).exact + row(j).exact; }
  double* dG(Index i, Index j) const { return y.dG + nv * pair(i, j); }
  double& mu(int sweep, Index i) const { return y.mu[room * sweep + i]; }  // after a sweep
  double* by(Index i) const { return y.lambda + columns * i; }     // of mu
  double* wrong(Index i) const { return y.wanted + columns * i; }  // of b

  // As Island::correct.
  void ask(CorrectionRow& r, double gap, double unit, bool soft) const {
    const double most = correction_speed(d, h) * h / w.length, share = tuning::island::correction * gap;
    if (soft)
      r.wrong = std::max(gap, most * w.length), r.slope = gap > most * w.length;
    else if (gap >= 0)
      r.wrong = gap, r.slope = 1;
    else
      r.wrong = std::max(share, -most * unit), r.slope = share > -most * unit ? tuning::island::correction : 0;
  }
  // Adds a row of J for a contact or limit that does not press.
  const char* add_open(const ActiveConstraint& a, CorrectionRow& r) {
    if (rows == room || contacts == room) return "too many rows";
    r.row = rows++;
    std::fill_n(s.J(r.row), nv, 0.0), std::fill_n(y.rate + nv * r.row, nv, 0.0), std::fill_n(y.Z + nv * r.row, nv, 0.0);
    y.rows[r.row] = {a.kind == RowKind::Contact ? JacobianRowKind::Normal : JacobianRowKind::Limit, a.index, 2, 0};
    if (a.kind == RowKind::Contact) {
      const ContactLaw& law = w.laws[a.index];
      JacobianContact& c = y.contacts[r.contact = contacts++];
      c = {}, c.contact = a.index, c.body_a = d.geoms[law.geom_a].body, c.body_b = d.geoms[law.geom_b].body, c.first = r.row;
      c.position = load3(x.modes.contacts[a.index].contact.position);
      if (!contact_geometry(m, d, x.modes.contacts[a.index].contact, law, c.geometry))
        return "a contact point has no counterpart where its shapes move";
      s.add_normal_rate(c, y.twists, 1, y.rate + nv * r.row, s.J(r.row));
    } else {
      const LimitRecord& limit = m.limits()[a.index];
      s.J(r.row)[user_dof(m, limit.dof)] = is_low(limit) ? 1 : -1;
    }
    for (Index k = 0; k < nv; ++k)
      if (const double j = s.J(r.row)[k]; j != 0) add_row(y.Z + nv * r.row, d.Minv + nv * k, j, nv);
    return nullptr;
  }
  bool is_low(const LimitRecord& r) const { return x.q[r.q] - m.lower_limit()[r.q] <= m.upper_limit()[r.q] - x.q[r.q]; }

  // The row of a constraint. largest: error, over its unit.
  const char* add(const ActiveConstraint& a, double& largest) {
    CorrectionRow r{-1, -1, -1, 0, 0, 0, 0, 0};
    const bool contact = a.kind == RowKind::Contact;
    for (Index k = 0; contact && k < s.contacts; ++k)
      if (y.contacts[k].contact == a.index) r.contact = k, r.row = y.contacts[k].first;
    for (Index k = 0; !contact && k < s.rows; ++k)
      if (y.rows[k].kind == JacobianRowKind::Limit && y.rows[k].of == a.index) r.row = k;
    if (r.row < 0)
      if (const char* const reason = add_open(a, r)) return reason;
    const bool soft = contact && is_soft(w.laws[a.index].material);
    double gap, unit = w.length;
    if (contact) {
      gap = x.modes.contacts[a.index].contact.distance;
    } else {
      const LimitRecord& limit = m.limits()[a.index];
      gap = is_low(limit) ? x.q[limit.q] - m.lower_limit()[limit.q] : m.upper_limit()[limit.q] - x.q[limit.q];
      unit = unit_of(m, w, limit);
    }
    for (Index k = 0; k < nv; ++k) gap += h * s.J(r.row)[k] * x.v_end[k];
    if (!soft && gap < 0) largest = std::max(largest, -gap / unit);
    ask(r, gap, unit, soft);
    if (contact) r.compliance = s.compliance(w.laws[a.index]);
    if (count == room) return "too many rows";
    row(count++) = r;
    return nullptr;
  }

  // As Sweeps::frictionless, of the rows of one island. Returns the number of sweeps.
  int sweep(Index begin, Index end, int most, bool differentiate) const {
    double first = 0;
    for (Index i = begin; i < end; ++i) row(i).mu = 0;
    for (int n = 0; n < most; ++n) {
      double changed = 0;
      for (Index i = begin; i < end; ++i) {
        CorrectionRow& r = row(i);
        const double own = G(i, i);
        if (!(own > 0)) continue;
        double rate = r.wrong;
        for (Index j = begin; j < end; ++j) rate += G(i, j) * row(j).mu;
        const double to = std::max(0.0, r.mu - rate / own);
        if (differentiate) change(begin, end, i, to > 0, rate);
        changed = std::max(changed, std::abs(to - r.mu) * (own + r.compliance));
        r.mu = mu(n, i) = to;
        if (to > 0 && r.exact < 0) r.exact = s.pushed++;
      }
      if (n == 0)
        first = changed;
      else if (!differentiate && changed <= tuning::sweeps::correction_change * first)
        return n + 1;
    }
    return most;
  }
  // dmu_i, of which its own part of the rate takes away what it was.
  void change(Index begin, Index end, Index i, bool pushes, double rate) const {
    double* const to = by(i);
    std::fill_n(to, columns, 0.0);
    if (!pushes) return;
    const double own = 1 / G(i, i);
    const auto add_matrix = [&](Index j, double factor) {
      s.add_by_state(to, dG(i, j), factor, nv);
      if (s.along) to[0] += factor * y.given.G[pair(i, j)];
    };
    add_row(to, wrong(i), -own, columns);
    if (s.exact) add_matrix(i, own * own * rate);
    for (Index j = begin; j < end; ++j) {
      if (row(j).mu == 0) continue;
      if (s.exact) add_matrix(j, -own * row(j).mu);
      if (j != i) add_row(to, by(j), -own * G(i, j), columns);
    }
  }
  // The sweeps backwards: from the gradients by mu, in by(i)[0], those by `wrong` and by G.
  void transpose_sweeps(Index begin, Index end) const {
    for (Index i = begin; i < end; ++i) row(i).wrong_adjoint = 0;
    for (int n = row(begin).sweeps - 1; n >= 0; --n)
      for (Index i = end - 1; i >= begin; --i) {
        CorrectionRow& r = row(i);
        if (!(G(i, i) > 0)) continue;
        const double own = 1 / G(i, i), gradient = std::exchange(by(i)[0], 0.0);
        const bool pushes = r.mu > 0;
        r.mu = n > 0 ? mu(n - 1, i) : 0;
        if (!pushes || gradient == 0) continue;
        r.wrong_adjoint -= own * gradient;
        double rate = r.wrong;
        for (Index j = begin; j < end; ++j) {
          rate += G(i, j) * row(j).mu;
          if (row(j).mu == 0) continue;
          if (s.exact) y.gradient.G[pair(i, j)] -= own * row(j).mu * gradient;
          if (j != i) by(j)[0] -= own * G(i, j) * gradient;
        }
        if (s.exact) y.gradient.G[pair(i, i)] += own * own * rate * gradient;
      }
    for (Index i = begin; i < end; ++i) row(i).mu = mu(row(begin).sweeps - 1, i);
  }

  // Calls f(first row, one past the last) for each island.
  template <class F>
  void for_each_island(F&& f) const {
    for (Index begin = 0; begin < count; begin = row(begin).end) f(begin, row(begin).end);
  }
  // A contact beside equalities: their drift is removed with it or without it, by the side to which it pushes.
  void flag(const CorrectionRow& r) const {
    if (!(y.rows[r.row].lambda > 0)) return;
    if (r.contact >= 0) x.modes.degenerate[y.contacts[r.contact].contact] = 1;
    else ++x.degenerate;
  }
  // Rows and mu of all islands that are corrected.
  const char* find() {
    for (Index n = 0, next; n < w.constraint_count; n = next) {
      const Index begin = count;
      double largest = 0;
      bool held = false;
      for (next = n; next < w.constraint_count && w.active[w.order[next]].island == w.active[w.order[n]].island; ++next) {
        const ActiveConstraint& a = w.active[w.order[next]];
        if (a.kind == RowKind::Equality) held = true;
        if (a.kind == RowKind::Equality || a.idle || (a.kind == RowKind::Contact && a.support_count == 0)) continue;
        if (const char* const reason = add(a, largest)) return reason;
      }
      if (held && largest > tuning::slop) return "overlaps and the drift of constraints are corrected together";
      if (held || !(largest > tuning::slop)) {
        for (; held && begin < count; --count) flag(row(count - 1));
        count = begin;
        continue;
      }
      for (Index i = begin; i < count; ++i)
        for (Index j = begin; j < count; ++j) {
          double sum = 0;
          for (Index k = 0; k < nv; ++k) sum += J(i)[k] * Z(j)[k];
          G(i, j) = sum;
        }
      row(begin).end = count, row(begin).sweeps = sweep(begin, count, tuning::sweeps::correction_sweeps, false);
    }
    for (Index i = 0; i < count; ++i) add_row(y.correction, Z(i), row(i).mu, nv);
    return nullptr;
  }
  // Whether the step ends where these mu take it.
  bool is_that_of_the_step() const {
    double* const hv = x.plus;
    for (Index k = 0; k < nv; ++k) hv[k] = h * x.v_end[k] + y.correction[k];
    std::copy_n(x.v_end, nv, x.minus);
    integrate(m, static_cast<const double*>(x.q), static_cast<const double*>(hv), d.q);
    integrator::end_flight<false>(m, WholeModel{}, static_cast<const double*>(x.q), h, static_cast<const double*>(y.correction),
                                  d.q, x.minus);
    difference(m, static_cast<const double*>(x.q_next), static_cast<const double*>(d.q), hv);
    std::copy_n(x.q, m.n.nq, d.q);
    double off = 0, most = 0;
    for (Index k = 0; k < nv; ++k) off = std::max(off, std::abs(hv[k])), most = std::max(most, std::abs(y.correction[k]));
    using tuning::derivatives::drift, tuning::derivatives::consistent;
    const double share = s.equalities > 0 ? std::sqrt(drift) : consistent;  // the second order of a drift is far less
    return off <= solver::tuning::pgs::tiny + share * most;
  }

  // W = derivative of N^-1 J_i^T by q, at fixed q in it; and its parts of dG.
  void differentiate_row(Index i) const {
    const double *const z = Z(i), *const rest = d.zero;
    const std::uint32_t acting = d.acting;
    double gravity[3];
    std::copy_n(d.world_gravity, 3, gravity), std::fill_n(d.world_gravity, 3, 0.0);
    d.acting &= ~resisting_effects;
    s.columns_at(rest, z);
    const JacobianContact* const c = row(i).contact < 0 ? nullptr : y.contacts + row(i).contact;
    const Vec3<double> n = c ? load3(x.modes.contacts[c->contact].contact.normal) : Vec3<double>::zero();
    if (c) s.subtract_force(*c, n);
    torque_derivatives(m, d, rest, z);
    d.acting = acting, std::copy_n(gravity, 3, d.world_gravity);
    double* const kept = std::exchange(s.forces, y.displacement);
    for (Index k = 0; k < nv; ++k)
      for (Index j = 0; j < nv; ++j) s.forces[s.mixed * k + j] = -d.dtau_dq[k + nv * j];
    if (c) s.differentiate_impulse(*c, n);
    for (Index k = 0; k < nv; ++k) {
      double* const to = y.W + nv * k;
      std::fill_n(to, nv, 0.0);
      for (Index l = 0; l < nv; ++l)
        if (const double by = d.Minv[l + nv * k]; by != 0) add_row(to, s.forces + s.mixed * l, by, nv);
    }
    s.forces = kept;
    add_row(y.turned, y.W, row(i).mu, nv * nv);
    s.find_twists(z, y.twists_before);
    for (Index k = 0; k < count; ++k) {
      if (row(k).exact < 0) continue;
      double* const to = dG(k, i);
      std::fill_n(to, nv, 0.0);
      for (Index l = 0; l < nv; ++l)
        if (const double j = J(k)[l]; j != 0) add_row(to, y.W + nv * l, j, nv);
      if (row(k).contact >= 0) s.add_normal_rate(y.contacts[row(k).contact], y.twists_before, 1, to, nullptr);
    }
  }
  // By q at fixed v': over the slope.
  const double* error_row(Index i) const {
    const CorrectionRow& r = row(i);
    double* const e = y.moved;
    for (Index k = 0; k < nv; ++k) e[k] = h * y.rate[nv * r.row + k];
    if (r.contact >= 0) s.add_gap(y.contacts[r.contact], 1, e);
    else add_row(e, J(i), 1, nv);
    return e;
  }
  void differentiate_errors() const {
    for (Index i = 0; i < count; ++i) {
      const CorrectionRow& r = row(i);
      double* const to = wrong(i);
      std::fill_n(to, columns, 0.0), std::fill_n(by(i), columns, 0.0);
      if (s.along) to[0] = y.given.wrong[i];
      if (r.slope == 0) continue;
      s.add_by_state(to, error_row(i), r.slope, nv);
      for (Index k = 0; k < nv; ++k)
        if (const double j = J(i)[k]; j != 0) add_row(to, s.state(k), r.slope * h * j, columns);
    }
  }
  void transpose_errors() const {
    for (Index i = 0; i < count; ++i) {
      const double by = row(i).slope * (y.gradient.wrong[i] = row(i).wrong_adjoint);
      if (by == 0) continue;
      add_row(y.adjoint, error_row(i), by, nv), add_row(y.state_adjoint, J(i), h * by, nv);
    }
  }
};

}  // namespace

const char* StepJacobian::find_corrections() {
  Correction c{*this};
  if (const char* const reason = c.find()) return reason;
  double most = 0;  // m, rad, by contacts and limits
  for (Index k = 0; k < nv; ++k) most = std::max(most, std::abs(y.correction[k]));
  std::fill_n(y.turned, nv * nv, 0.0);
  if (equalities > 0)
    if (const char* const reason = correct_drift()) return reason;
  if (!c.is_that_of_the_step()) return "overlaps are corrected in another way";
  exact = most > tuning::slop;  // else derivatives of G change the result by less
  if (exact && pushed > exact_corrections(m)) return "too many overlaps are corrected";
  for (Index i = 0; i < (exact ? corrections : 0); ++i)
    if (c.row(i).exact >= 0) c.differentiate_row(i);
  return nullptr;
}

void StepJacobian::displace() {
  for (std::ptrdiff_t k = 0; k < nv * columns; ++k) y.displacement[k] = h * y.state[k];
  if (!corrects()) return;
  const Correction c{*this};
  c.differentiate_errors();
  c.for_each_island([&](Index begin, Index end) { c.sweep(begin, end, c.row(begin).sweeps, true); });
  for (Index k = 0; k < nv; ++k) {
    add_by_state(displacement(k), y.turned + nv * k, 1, nv);
    if (along) displacement(k)[0] += y.given.displacement[k];
    for (Index i = 0; i < corrections; ++i)
      if (const double z = c.Z(i)[k]; z != 0) add_row(displacement(k), c.by(i), z, columns);
  }
}

void StepJacobian::transpose_displacement() {
  const double* const from = y.displacement_adjoint;
  std::copy_n(from, nv, y.gradient.displacement);
  add_row(y.state_adjoint, from, h, nv);
  if (!corrects()) return;
  const Correction c{*this};
  for (Index k = 0; k < nv; ++k) add_row(y.adjoint, y.turned + nv * k, from[k], nv);
  std::fill_n(y.gradient.G, c.most_exact * c.most_exact, 0.0);
  for (Index i = 0; i < corrections; ++i) c.by(i)[0] = inner(c.Z(i), from, nv);
  c.for_each_island([&](Index begin, Index end) { c.transpose_sweeps(begin, end); });
  c.transpose_errors();
  for (Index i = 0; exact && i < corrections; ++i)
    for (Index j = 0; j < corrections; ++j)
      if (c.row(i).exact >= 0 && c.row(j).exact >= 0) add_row(y.adjoint, c.dG(i, j), y.gradient.G[c.pair(i, j)], nv);
}

}  // namespace dyn::simulation
