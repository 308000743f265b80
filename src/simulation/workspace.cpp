#include "simulation/workspace.hpp"

#include "algorithm/constrained/dependence.hpp"
#include "collision/result.hpp"
#include "collision/workspace.hpp"
#include "model/length.hpp"
#include "simulation/block_factor.hpp"
#include "simulation/energy_guard.hpp"

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

std::size_t rounded(std::size_t bytes) { return (bytes + 63) / 64 * 64; }

// What an array may share memory with.
enum class Use {
  Own,
  Matrix,   // a matrix between the rows of constraint slots
  Rows,     // rows of an island: what steps do not use of constraint slots, and what contact searches use
  Solve,    // of one solver: this too, and what systems of equalities use before and after
  Step,     // from the contact search on: distances of pairs, which are those of another configuration
};

// Buffers of other parts that lie idle while a step solves its constraints (fields.def of algorithm/constrained and collision).
class SharedMemory {
 public:
  explicit SharedMemory(const Model& m) {
    const std::ptrdiff_t rows = padded_rows(m.n.constraint_rows);
    const std::size_t square = rounded(sizeof(double) * std::size_t(rows * rows));
    piece(Matrix).left = square, piece(Free).left = square, piece(Systems).left = 3 * square;
    piece(Dependence).left = square - rounded(dependence_bytes(m));
    if (m.n.contacts > 0 && (m.n.pairs || !lists_pairs(m))) piece(Epa).left = rounded(sizeof(collision::EpaWorkspace));
    if (m.n.contacts > 0) piece(Results).left = rounded(sizeof(collision::Result) * std::size_t(m.n.pairs));
  }
  void locate(const Model& m, const Data<double>& d) {
    const auto at = [](auto* buffer) { return reinterpret_cast<char*>(buffer); };
    piece(Matrix).at = at(d.row_matrix), piece(Free).at = at(d.row_free);
    piece(Systems).at = at(d.row_factor);  // row_scaled and row_range follow
    piece(Epa).at = at(d.collision_workspace), piece(Results).at = at(d.results);
    piece(Dependence).at = at(d.row_dependence) + rounded(dependence_bytes(m));
  }
  // Returns whether the bytes fit; then `at` is their place.
  bool take(Use use, std::size_t bytes, char*& at) {
    static constexpr Name of_matrix[] = {Matrix}, of_rows[] = {Epa, Free}, of_solve[] = {Systems, Matrix, Free, Epa},
                          of_step[] = {Results, Dependence};
    const auto first = [&](const auto& names) {
      for (const Name name : names) {
        Piece& p = piece(name);
        if (bytes > p.left) continue;
        at = p.at, p.left -= bytes, p.at += p.at ? bytes : 0;
        return true;
      }
      return false;
    };
    switch (use) {
      case Use::Matrix: return first(of_matrix);
      case Use::Rows: return first(of_rows);
      case Use::Solve: return first(of_solve);
      case Use::Step: return first(of_step);
      default: return false;
    }
  }

 private:
  enum Name { Matrix, Free, Systems, Epa, Results, Dependence, count };
  struct Piece {
    std::size_t left = 0;
    char* at = nullptr;
  };
  Piece pieces_[count];
  Piece& piece(Name name) { return pieces_[name]; }
};

// Places arrays one after the other. Without memory it counts their bytes.
struct Layout {
  SharedMemory shared;
  char* memory = nullptr;
  std::size_t bytes = rounded(sizeof(Workspace));

  template <class T>
  void operator()(T*& array, std::ptrdiff_t n, Use use = Use::Own) {
    const std::size_t size = rounded(std::size_t(n) * sizeof *array);
    char* at = nullptr;
    if (!shared.take(use, size, at)) at = memory ? memory + bytes : nullptr, bytes += size;
    array = reinterpret_cast<T*>(at);
  }
  // Arrays that are never in use together.
  template <class F, class G>
  void either(F&& one, G&& other) {
    const Layout before = *this;
    one();
    const std::size_t end = bytes;
    *this = before;
    other();
    bytes = std::max(bytes, end);
  }
};

void for_each_array(const Model& m, Workspace& w, Layout& f) {
  const std::ptrdiff_t slots = step_constraints(m), carriers = m.n.carriers, rows = padded_rows(step_rows(m)),
                       kept = columns(m) + 2 * carriers + 3 * std::ptrdiff_t(m.n.path_dofs),
                       room = padded_rows(dense_capacity(m));
  f(w.ledger.q, m.n.nq), f(w.ledger.tau, m.n.nv);
  for_each_array(m, w.free_bodies, f);
  if (slots == 0) return;
  f(w.materials, m.n.geoms), f(w.speeds, geom_capacity(m)), f(w.centers, 4 * geom_capacity(m));
  w.clearances.for_each_array(m, f);
  f(w.pairs, pair_capacity(m)), f(w.rows, pair_capacity(m)), f(w.geoms, m.n.geoms), f(w.awake_pairs, pair_capacity(m)),
      f(w.awake_geoms, m.n.geoms);
  f(w.tree_of, m.n.bodies), f(w.tree_links, m.n.bodies), f(w.root_velocity, m.n.bodies);
  f(w.instances, step_instances(m) + 1), f(w.active, slots), f(w.order, slots);
  f(w.Y, row_lanes * kept, Use::Step), f(w.support, kept, Use::Step), f(w.laws, m.n.contacts, Use::Step);
  f(w.contacts, m.n.contacts), f(w.previous, m.n.contacts), f(w.saved, m.n.contacts);
  f(w.limit_forces, remembered_rows(m)), f(w.previous_limit_forces, remembered_rows(m)), f(w.saved_limit_forces,
      remembered_rows(m));
  f(w.path_rows, m.n.path_rows);
  if (const std::ptrdiff_t numbers = frame_force_numbers(m)) f(w.frame_forces, numbers);
  f(w.blocks, slots, Use::Rows), f(w.vectors, island_vectors * rows, Use::Rows);
  w.elimination.arrays(m, Index(slots), f);
  f(w.run_rows, segment_lanes * std::ptrdiff_t(w.elimination.max_row_lanes), Use::Rows), f(w.cones, cone_capacity(m), Use::Rows);
  f(w.bounds, 2 * step_bounds(m)), f(w.coefficients, contact_vectors * m.n.contacts), f(w.contact_rows, m.n.contacts);
  f(w.by_dof, m.n.nv), f(w.tree_speeds, 2 * m.n.bodies);
  f(w.advancement_cache.q, m.n.nq), f(w.advancement_cache.lever, m.n.nv);
  const std::ptrdiff_t segments = segment_capacity(m), entries = Elimination::entry_capacity(m);
  f(w.segments.of, m.n.nv), f(w.segments.first, segments + 1);
  f(w.by_segment, segment_lanes * segments);
  f(w.where, segments), f(w.newton_acts, segments), f(w.newton_filled, entries);
  if (may_rest(m)) for_each_array(m, w.sleep, f);
  f(w.matrix, room * room, Use::Matrix);
  const auto by_segments = [&] {
    f(w.newton, slots, Use::Solve), f(w.newton_vectors, newton_vectors * rows, Use::Solve);
    f(w.blocks_above, 2 * BlockFactor::size * entries, Use::Solve), f(w.diagonal, BlockFactor::size * segments, Use::Solve);
  };
  const auto by_matrix = [&] {
    w.solver.max_rows = dense_capacity(m), w.solver.places_active = !matrix_is_shared(m);
    w.solver.arrays([&](auto*& array, std::ptrdiff_t n) { f(array, n, Use::Solve); });
    if (matrix_is_shared(m)) w.solver.active.x = w.matrix;
  };
  f.either(by_segments, by_matrix);
}

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
  Layout layout{SharedMemory(m)};
  for_each_array(m, w, layout);
  return layout.bytes;
}

Workspace* place(const Model& m, Data<double>& d, void* memory) {
  Workspace& w = *new (memory) Workspace{};
  Layout layout{SharedMemory(m), static_cast<char*>(memory)};
  layout.shared.locate(m, d);
  for_each_array(m, w, layout);
  w.options = default_options(m), w.length = own_length(m);
  w.guarded_motion = guarded_motion(m, w.tree_speeds);
  if (w.free_bodies.sets) set_up_free_bodies(m, w.free_bodies), list_free_bodies(m, w);
  if (step_constraints(m) == 0) return &w;
  w.limits = remembered_rows(m);
  find_segments(m, w.segments);
  w.pair_count = -1, find_trees(m, w.tree_of), w.advancement_cache.enabled = can_cache_advancement(m);
  for (Index k = 0; k < m.n.geoms; ++k) w.materials[k] = material_of(m, m.shapes()[m.geoms()[k].shape]);
  if (may_rest(m)) set_up_sleep(m, w);
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
