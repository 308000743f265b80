#include <algorithm>
#include <cstring>

#include "algorithm/constrained/rows.hpp"
#include "algorithm/actuators.hpp"
#include "simulation/mocap.hpp"
#include "simulation/step.hpp"

namespace dyn::simulation {

namespace {

using collision::PairSearch;

// of an island; deep: it may be left out
enum : std::uint8_t { slow = 1, ready = 2, steady = 4, still_before = 8, alike = 16, deep = 32 };
constexpr std::uint8_t at_rest = slow | ready | steady, stays = at_rest | still_before | alike;

Index body_of(const Model& m, const Data<double>& d, Index shape) {
  const GeomRecord* g =
      std::lower_bound(m.geoms(), m.geoms() + m.n.geoms, shape, [](const GeomRecord& x, Index s) { return x.shape < s; });
  return d.geoms[g - m.geoms()].body;
}
// Returns a tree of the contact's island.
Index tree_of(const Model& m, const Data<double>& d, const dynContact& c) {
  const Sleep& z = d.step->sleep;
  const Index a = z.number[body_of(m, d, c.shape_a)];
  return a >= 0 ? a : z.number[body_of(m, d, c.shape_b)];
}

// Lists the awake trees.
void list_awake(const Model& m, Workspace& w) {
  Sleep& z = w.sleep;
  z.awake_count = 0, w.awake_pair_count = w.row_count = -1;
  Index groups = 0;
  for (Index t = 0; t < z.count; ++t) {
    if (z.state[t] != Sleeper::Awake) continue;
    z.awake_trees[z.awake_count++] = t;
    append_tree(z.trees[t], z.buffers.groups, groups);
  }
  z.awake = choose_trees(m, z.buffers, groups);
  list_free_bodies(m, w);
}

// Moves the contacts of `from` that `asked` selects into `to`, both in order.
template <class F>
void move_contacts(dynContactForce* from, Index& from_count, dynContactForce* to, Index& to_count, F&& asked) {
  const Index before = to_count;
  Index kept = 0;
  for (Index k = 0; k < from_count; ++k) {
    if (asked(from[k].contact)) to[to_count++] = from[k];
    else if (kept++ != k) from[kept - 1] = from[k];
  }
  from_count = kept;
  // merge two ascending parts
  if (before < to_count && before > 0 && collision::comes_before(to[before].contact, to[before - 1].contact))
    std::sort(to, to + to_count,
              [](const dynContactForce& x, const dynContactForce& y) { return collision::comes_before(x.contact, y.contact); });
}

// Calls f(search, id, tree) for shapes of the broad phase: trees that fell asleep or woke move between its two halves.
template <class F>
void for_each_boxed_geom(Data<double>& d, F&& f) {
  if (!d.step->by_boxes || !PairSearch::of(d)->ready) return;
  PairSearch& search = *PairSearch::of(d);
  for (Index id = 0; id < search.moving_count; ++id) f(search, id, d.step->sleep.number[d.geoms[search.moving_geoms[id]].body]);
  search.list_active();
}

void wake_island(Sleep& z, Index tree) {
  Index t = tree;
  do z.state[t] = Sleeper::Awake, z.rest_steps[t] = 0, t = z.next[t];
  while (t != tree);
  --z.islands;
}

// Call after trees were marked awake.
void update_awake(const Model& m, Data<double>& d) {
  Workspace& w = *d.step;
  Sleep& z = w.sleep;
  const auto awake = [&](const dynContact& c) { return z.state[tree_of(m, d, c)] == Sleeper::Awake; };
  move_contacts(z.sleeping_contacts, z.sleeping_contact_count, w.contacts, w.contact_count, awake);
  for_each_boxed_geom(d, [&](PairSearch& search, Index id, Index tree) {
    if (z.state[tree] == Sleeper::Awake && search.sleeping->has(id)) search.wake(search.moving_geoms[id]);
  });
  list_awake(m, w);
  z.any_asleep = z.islands > 0;
}

// Returns whether sleep is enabled for all of its joints.
// What a path moves does not sleep.
bool may_sleep(const Model& m, const Data<double>& d, const Trees& t) {
  for (Index k = 0; k < m.n.paths; ++k)
    for (Index n = m.paths()[k].first_dof, end = n + m.paths()[k].dofs; n < end; ++n)
      if (m.path_dofs()[n] >= t.v && m.path_dofs()[n] < t.v_end) return false;
  const Index first = m.bodies()[t.first].joint, last = m.bodies()[t.end - 1].joint;
  for (Index j = first; j <= last; ++j)
    if (!(d.effects[j] & DYN_EFFECT_SLEEPING)) return false;
  return true;
}

// -1: it acts on a path.
Index tree_of(const Model& m, const Sleep& z, const ActuatorRecord& r) {
  return r.v < 0 ? -1 : z.number[m.joints()[r.spec.joint].last_body];
}

// Wakes trees whose tau or controls differ from the last step; awake ones start counting rest steps again.
void wake_driven(const Model& m, Data<double>& d, Sleep& z) {
  bool woke = false;
  const auto differ = [&](const double* now, double* before, Index n, Index tree) {
    if (std::memcmp(now, before, std::size_t(n) * sizeof(double)) == 0) return;
    std::copy_n(now, n, before), z.rest_steps[tree] = 0;
    if (z.state[tree] != Sleeper::Awake) wake_island(z, tree), woke = true;
  };
  for (Index t = 0; t < (z.version[input_tau] != d.version[input_tau] ? z.count : 0); ++t)
    differ(d.tau_applied + z.trees[t].v, z.tau + z.trees[t].v, z.trees[t].v_end - z.trees[t].v, t);
  for (Index k = 0; k < m.n.actuators; ++k)
    if (const ActuatorRecord& r = m.actuators()[k]; r.v >= 0)
      differ(d.ctrl + r.spec.idx_u, z.ctrl + r.spec.idx_u, r.spec.controls, tree_of(m, z, r));
  if (woke) update_awake(m, d);
}

}  // namespace

void set_up_sleep(const Model& m, Workspace& w) {
  Sleep& z = w.sleep;
  z.number[0] = -1;
  z.count = list_trees(m, z.trees);
  for (Index t = 0; t < z.count; ++t) std::fill(z.number + z.trees[t].first, z.number + z.trees[t].end, t);
}

void begin_sleep(const Model& m, Data<double>& d, double h) {
  Workspace& w = *d.step;
  Sleep& z = w.sleep;
  z.touched = z.contacts_full = false;
  const dynIntegrator i = w.options.integrator;
  if (z.count == 0 || !(d.acting & DYN_EFFECT_SLEEPING) ||
      (i != DYN_INTEGRATOR_SEMI_IMPLICIT_EULER && i != DYN_INTEGRATOR_IMPLICIT_FAST)) {
    if (z.enabled || z.any_asleep) wake_all(m, d);
    return;
  }
  z.unconstrained = active_rows(m, d) == 0;
  const bool same = z.enabled && z.inputs_known && z.h == h && z.version[input_q] == d.version[input_q] &&
                    z.version[input_v] == d.version[input_v];
  if (!same || !z.enabled || (z.any_asleep && (!z.unconstrained || w.options.visit_sleepers))) wake_all(m, d);
  if (!z.enabled) {
    list_awake(m, w);
    z.enabled = true;
  }
  if (!same) {
    std::fill_n(z.rest_steps, z.count, std::uint8_t(0));
    std::copy_n(d.tau_applied, m.n.nv, z.tau), std::copy_n(d.ctrl, m.n.nu, z.ctrl);
  } else {
    wake_driven(m, d, z);
  }
  z.inputs_known = true;
}

void wake_all(const Model& m, Data<double>& d) {
  Workspace& w = *d.step;
  Sleep& z = w.sleep;
  z.enabled = false;
  if (!z.any_asleep) return;
  for (Index t = 0; t < z.count; ++t)
    if (z.state[t] != Sleeper::Awake) wake_island(z, t);
  update_awake(m, d);
}

void mocap_moved(const Model& m, Data<double>& d, Index mocap, bool rouse) {
  if (!d.step) return;
  Workspace& w = *d.step;
  Sleep& z = w.sleep;
  wake_all(m, d);
  w.advancement_cache.square = 0, w.row_count = -1;
  const Index place = m.n.bodies + mocap;
  const auto carries = [&](Index shape) { return m.frames()[m.shapes()[shape].frame].place == place; };
  for (Index k = 0; m.n.contacts > 0 && k < m.n.geoms; ++k)
    if (carries(m.geoms()[k].shape)) w.clearances.move(k, d.geoms[k].X, d.geoms[k].bounding_radius);
  if (m.n.contacts > 0 && collision::uses_pair_search(m)) PairSearch::of(d)->ready = false;
  if (z.count == 0 || !rouse) return;
  for (Index k = 0; k < w.contact_count; ++k)
    if (const dynContact& c = w.contacts[k].contact; carries(c.shape_a) || carries(c.shape_b)) z.slow_time[tree_of(m, d, c)] = 0;
  for (Index s = 0; s < m.n.slots; ++s) {
    const ConstraintInstance<double>& x = d.slots[s];
    if (!x.rows || between_joints(x.c.type)) continue;
    const dynConstraint& spec = d.constraint_specs[s];
    if (m.frames()[spec.first].place == place && x.c.body2) z.slow_time[z.number[x.c.body2]] = 0;
    if (m.frames()[spec.second].place == place && x.c.body1) z.slow_time[z.number[x.c.body1]] = 0;
  }
}

// The search starts again from the contacts and forces of the last step.
void wake_touched(const Model& m, Data<double>& d) {
  Workspace& w = *d.step;
  Sleep& z = w.sleep;
  std::swap(w.contacts, w.previous), std::swap(w.limit_forces, w.previous_limit_forces);
  w.contact_count = w.previous_count;
  double *const q = d.backup, *const v = q + m.n.nq;
  for (Index t = 0; t < z.count; ++t)
    if (z.state[t] == Sleeper::Touched || (z.contacts_full && z.state[t] == Sleeper::Asleep)) wake_island(z, t);
  for (Index t = 0; t < z.count; ++t) {  // of all that woke
    const Trees& x = z.trees[t];
    if (z.state[t] != Sleeper::Awake || std::binary_search(z.awake_trees, z.awake_trees + z.awake_count, t)) continue;
    std::copy(d.q + x.q, d.q + x.q_end, q + x.q), std::copy(d.v + x.v, d.v + x.v_end, v + x.v);
  }
  z.touched = z.contacts_full = false;
  update_awake(m, d);
}

void detect_rest(const Model& m, Data<double>& d, const double* v0, const double* dq, double h) {
  Workspace& w = *d.step;
  Sleep& z = w.sleep;
  const double speed = w.options.sleep_speed, time = w.options.sleep_time, change = speed / time * h;
  for (Index k = 0; k < z.awake_count; ++k) {
    const Index t = z.awake_trees[k];
    z.island[t] = t, z.flags[t] = stays | deep, z.max_force[t] = 0;
  }
  for (Index k = 0; k < w.constraint_count; ++k) {
    const ActiveConstraint& s = w.active[k];
    for (const Index tree : {s.tree1, s.tree2})
      if (tree >= 0) z.island[z.number[tree]] = z.number[s.island];
    if (s.kind == RowKind::Contact) w.laws[s.index].island = z.number[s.island];
  }
  for (Index k = 0; k < z.awake_count; ++k) {
    const Index t = z.awake_trees[k];
    const Trees& x = z.trees[t];
    std::uint8_t is = alike | deep;
    Index fast = x.v;
    while (fast < x.v_end && std::abs(d.v[fast]) <= speed) ++fast;
    if (fast < x.v_end) {  // a fast tree is not at rest: the other flags do not matter
      z.flags[z.island[t]] &= is;
      continue;
    }
    double changed = 0, before = 0, corrected = 0;
    for (Index i = x.v; i < x.v_end; ++i) {
      changed = std::max(changed, std::abs(d.v[i] - v0[i])), before = std::max(before, std::abs(v0[i]));
      if (dq) corrected = std::max(corrected, std::abs(dq[i]));
    }
    if (corrected <= speed * h) is |= slow;
    if (changed <= change) is |= steady;
    if (before == 0) is |= still_before;
    if (z.slow_time[t] >= time && may_sleep(m, d, x)) is |= ready;
    z.flags[z.island[t]] &= is;
  }
  // an activation that still changes keeps its tree awake
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index) {
    if (const Index t = tree_of(m, z, r);
        t >= 0 && r.act >= 0 && z.state[t] == Sleeper::Awake && activation_after(r, d, d.act[r.act], h) != d.act[r.act])
      z.flags[z.island[t]] &= std::uint8_t(~alike);
  });
  // contact forces must be those of the previous step, if inputs have not changed
  const auto island = [&](const dynContactForce& f) { return w.laws[&f - w.contacts].island; };
  const auto stood = [&](const dynContactForce& f) {
    return (z.flags[island(f)] & (at_rest | still_before)) == (at_rest | still_before);
  };
  const auto force = [](const dynContactForce& f, int i) { return (i < 3 ? f.force_on_b : f.moment_on_b)[i % 3]; };
  bool some = false;
  for (Index k = 0; k < w.contact_count; ++k) {
    if (!stood(w.contacts[k])) continue;
    some = true;
    double& largest = z.max_force[island(w.contacts[k])];
    for (int i = 0; i < 6; ++i) largest = std::max(largest, std::abs(force(w.contacts[k], i)));
  }
  if (some) {
    for_each_with_previous(w, stood, [&](const dynContactForce& f, const dynContactForce* before) {
      const Index t = island(f);
      for (int i = 0; i < 6; ++i)
        if (std::abs(force(f, i) - (before ? force(*before, i) : 0)) > tuning::same_force * z.max_force[t])
          z.flags[t] &= std::uint8_t(~alike);
    });
    for_each_with_previous(w, [&](const dynContactForce& f) { return (z.flags[island(f)] & stays) == stays; }, copy_force);
  }
  w.report.sleeping = z.islands;
  for (Index k = 0; k < z.awake_count; ++k) {
    const Index t = z.awake_trees[k];
    const std::uint8_t is = z.flags[z.island[t]];
    if (!(is & slow)) z.slow_time[t] = 0;
    else if (z.slow_time[t] < time) z.slow_time[t] += h;
    z.rest_steps[t] = (is & stays) == stays ? std::uint8_t(std::min(2, z.rest_steps[t] + 1)) : std::uint8_t(0);
  }
  for (Index k = 0; k < z.awake_count; ++k)
    if (const Index t = z.awake_trees[k]; z.rest_steps[t] < 2) z.flags[z.island[t]] &= std::uint8_t(~deep);
  for (Index k = 0; k < z.awake_count; ++k)
    w.report.sleeping += z.island[z.awake_trees[k]] == z.awake_trees[k] && (z.flags[z.awake_trees[k]] & deep);
}

void hold_at_rest(const Model&, Data<double>& d, const double* q0) {
  const Sleep& z = d.step->sleep;
  for (Index k = 0; k < z.awake_count; ++k) {
    const Index t = z.awake_trees[k];
    const std::uint8_t is = z.flags[z.island[t]];
    if ((is & at_rest) != at_rest) continue;
    const Trees& x = z.trees[t];
    std::copy(q0 + x.q, q0 + x.q_end, d.q + x.q), std::fill(d.v + x.v, d.v + x.v_end, 0.0);
  }
}

void end_sleep(const Model& m, Data<double>& d, double h) {
  Workspace& w = *d.step;
  Sleep& z = w.sleep;
  if (!z.enabled) return;
  z.h = h;
  std::copy_n(d.version, input_count, z.version);
  if (!z.unconstrained || w.options.visit_sleepers) return;
  bool some = false;
  for (Index k = 0; k < z.awake_count; ++k) {
    const Index t = z.awake_trees[k], first = z.island[t];
    if (!(z.flags[first] & deep)) continue;
    z.state[t] = Sleeper::Asleep, some = true;
    if (t == first) z.next[t] = t, ++z.islands;
    else z.next[t] = z.next[first], z.next[first] = t;
  }
  if (!some) return;
  z.any_asleep = true, w.advancement_cache.square = 0;
  const auto asleep = [&](const dynContact& c) { return z.state[tree_of(m, d, c)] == Sleeper::Asleep; };
  move_contacts(w.contacts, w.contact_count, z.sleeping_contacts, z.sleeping_contact_count, asleep);
  for_each_boxed_geom(d, [&](PairSearch& search, Index id, Index tree) {
    const Index geom = search.moving_geoms[id];
    if (z.state[tree] == Sleeper::Asleep && search.moving->has(id)) search.put_to_sleep(d, geom, box_margin(w, d, geom, h));
  });
  list_awake(m, w);
}

}  // namespace dyn::simulation
