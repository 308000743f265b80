#include "simulation/workspace.hpp"

#include "model/length.hpp"
#include "simulation/block_factor.hpp"

#include <new>

namespace dyn::simulation {

namespace {

// Sleep is not offered to models with mimic joints (all trees move together) or without contacts.
bool may_rest(const Model& m) { return m.n.contacts > 0 && !m.has_mimic; }

template <class F>
void for_each_array(const Model& m, Sleep& z, F&& f) {
  f(z.number, m.n.bodies), f(z.trees, m.n.bodies), f(z.slow_time, m.n.bodies), f(z.max_force, m.n.bodies);
  f(z.rest_steps, m.n.bodies), f(z.state, m.n.bodies), f(z.flags, m.n.bodies);
  f(z.next, m.n.bodies), f(z.island, m.n.bodies), f(z.awake_trees, m.n.bodies), f(z.tau, m.n.nv), f(z.ctrl, m.n.nu);
  for_each_array(m, z.buffers, f);
  f(z.sleeping_contacts, m.n.contacts);
}

template <class F>
void for_each_array(const Model& m, FreeBodies& l, F&& f) {
  const std::ptrdiff_t count =
      m.n.manifold_joints;  // upper bound of the number of free bodies; plan.cpp needs sizes that follow from counts alone
  if (count == 0) return;
  const std::ptrdiff_t sets = (count + Double4::lanes - 1) / Double4::lanes;
  f(l.sets, sets), f(l.active_sets, sets);
  f(l.columns, count), f(l.has_columns, count), f(l.touched, count);
  f(l.number, m.n.bodies), f(l.trees, m.n.bodies);
  for_each_array(m, l.buffers, f);
}

template <class F>
void for_each_array(const Model& m, Workspace& w, F&& f) {
  const std::ptrdiff_t slots = step_constraints(m), own = m.n.contacts + m.n.limits + m.n.path_rows, carriers = m.n.carriers,
                       room = padded_rows(island_rows(m));
  f(w.ledger.q, m.n.nq), f(w.ledger.tau, m.n.nv);
  for_each_array(m, w.free_bodies, f);
  if (slots == 0) return;
  f(w.materials, m.n.geoms), f(w.speeds, geom_capacity(m)), f(w.centers, 4 * geom_capacity(m));
  w.clearances.for_each_array(m, f);
  f(w.pairs, pair_capacity(m)), f(w.rows, pair_capacity(m)), f(w.geoms, m.n.geoms), f(w.awake_pairs, pair_capacity(m)),
      f(w.awake_geoms, m.n.geoms);
  f(w.tree_of, m.n.bodies), f(w.tree_links, m.n.bodies), f(w.root_velocity, m.n.bodies);
  f(w.instances, own), f(w.support, own * carriers), f(w.Y, row_lanes * own * carriers), f(w.active, slots), f(w.order, slots);
  f(w.contacts, m.n.contacts), f(w.previous, m.n.contacts), f(w.saved, m.n.contacts), f(w.laws, m.n.contacts);
  f(w.limit_forces, remembered_rows(m)), f(w.previous_limit_forces, remembered_rows(m)), f(w.saved_limit_forces,
      remembered_rows(m));
  f(w.path_rows, m.n.path_rows);
  f(w.vectors, island_vectors * padded_rows(step_rows(m))), f(w.contact_rows, padded_rows(step_rows(m)));
  f(w.blocks, slots), f(w.cones, slots), f(w.by_dof, m.n.nv), f(w.tree_speeds, 2 * m.n.bodies);
  f(w.advancement_cache.q, m.n.nq), f(w.advancement_cache.lever, m.n.nv);
  const std::ptrdiff_t segments = segment_capacity(m), entries = Elimination::entry_capacity(segment_capacity(m));
  f(w.segments.of, m.n.nv), f(w.segments.first, segments + 1);
  w.elimination.arrays(m, Index(slots), f);
  f(w.newton, slots), f(w.newton_vectors, newton_vectors * padded_rows(step_rows(m)));
  f(w.run_rows, segment_lanes * max_rows * std::ptrdiff_t(w.elimination.max_runs));
  f(w.by_segment, segment_lanes * segments);
  f(w.diagonal, BlockFactor::size * segments), f(w.blocks_above, 2 * BlockFactor::size * entries);
  f(w.where, segments), f(w.newton_acts, segments), f(w.newton_filled, entries);
  if (may_rest(m)) for_each_array(m, w.sleep, f);
  f(w.matrix, room * room);
  f(w.solver_memory, std::ptrdiff_t(solver::workspace_bytes(island_rows(m))));
}

std::size_t rounded(std::size_t bytes) { return (bytes + 63) / 64 * 64; }

// Finds the first body of each body's tree. Mimic joints merge trees.
void find_trees(const Model& m, Index* tree_of) {
  tree_of[0] = -1;
  for (Index i = 1; i < m.n.bodies; ++i) tree_of[i] = m.bodies()[i].parent ? tree_of[m.bodies()[i].parent] : i;
  if (!m.has_mimic) return;
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body* const leader =
        std::find_if(m.bodies() + 1, m.bodies() + i, [&](const Body& b) { return b.user_v == m.bodies()[i].user_v; });
    const Index one = tree_of[leader - m.bodies()], other = tree_of[i];
    if (one != other) std::replace(tree_of + 1, tree_of + m.n.bodies, other, one);
  }
}

}  // namespace

std::size_t workspace_bytes(const Model& m) {
  Workspace w;
  std::size_t bytes = rounded(sizeof w);
  for_each_array(m, w, [&](auto* array, std::ptrdiff_t n) { bytes += rounded(std::size_t(n) * sizeof *array); });
  return bytes;
}

Workspace* place(const Model& m, void* memory) {
  char* next = static_cast<char*>(memory);
  Workspace& w = *new (next) Workspace{};
  next += rounded(sizeof w);
  for_each_array(m, w, [&](auto*& array, std::ptrdiff_t n) {
    array = reinterpret_cast<std::remove_reference_t<decltype(array)>>(next);
    next += rounded(std::size_t(n) * sizeof *array);
  });
  w.options = default_options(m), w.length = own_length(m);
  if (w.free_bodies.sets) set_up_free_bodies(m, w.free_bodies), list_free_bodies(m, w);
  if (step_constraints(m) == 0) return &w;
  w.limits = remembered_rows(m);
  find_segments(m, w.segments);
  w.pair_count = -1, find_trees(m, w.tree_of), w.advancement_cache.enabled = can_cache_advancement(m);
  for (Index k = 0; k < m.n.geoms; ++k) w.materials[k] = material_of(m, m.shapes()[m.geoms()[k].shape]);
  if (may_rest(m)) set_up_sleep(m, w);
  solver::place(w.solver, island_rows(m), w.solver_memory);
  return &w;
}

Index resting_trees(const Model& m) {
  if (!may_rest(m)) return 0;
  return Index(std::count_if(m.bodies() + 1, m.bodies() + m.n.bodies, [](const Body& b) { return b.parent == 0; }));
}

std::size_t sleep_bytes(const Model& m) {
  Sleep z;
  std::size_t bytes = 0;
  for_each_array(m, z, [&](auto* array, std::ptrdiff_t n) { bytes += rounded(std::size_t(n) * sizeof *array); });
  return bytes;
}

dynStepOptions default_options() {
  dynStepOptions o{};
  o.struct_size = sizeof o, o.integrator = DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, o.dt = 1e-3;
  o.solver = DYN_CONTACT_SOLVER_TYPE_ADMM, o.max_iterations = 0, o.tolerance = 0;
  o.sleep_speed = 1e-4, o.sleep_time = 0.5;
  return o;
}

dynStepOptions default_options(const Model& m) {
  dynStepOptions o = default_options();
  o.dt = m.simulation()->dt, o.integrator = m.simulation()->integrator;
  return o;
}

}  // namespace dyn::simulation
