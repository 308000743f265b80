#include "guard.hpp"

#include <bit>
#include <cstring>

#include "model/effects.hpp"
#include "parts.hpp"
#include "reflection.hpp"
#include "simulation/workspace.hpp"

namespace dyn::capi {

namespace {

template <class H>
dynStatus check_magic(const H* handle, std::uint64_t live, const char* what, const char* maker) {
  if (!handle) return fail(DYN_ERROR_HANDLE, "the %s is NULL: make one with %s", what, maker);
  if (handle->magic == live) return DYN_OK;
  if (handle->magic == freed) return fail(DYN_ERROR_HANDLE, "the %s has been freed", what);
  return fail(DYN_ERROR_HANDLE, "the %s is no handle of this library: make one with %s", what, maker);
}

}  // namespace

dynStatus no_model(const dynModel* model) {
  return check_magic(model, live_model, "model", "dyn_model_load, dyn_model_from_buffer or dyn_builder_finish");
}
dynStatus check(const dynBuilder* builder) { return check_magic(builder, live_builder, "builder", "dyn_builder_new"); }
dynStatus check(const dynBatch* batch) { return check_magic(batch, live_batch, "batch", "dyn_batch_new"); }
dynStatus check(const dynMesh* mesh) { return check_magic(mesh, live_mesh, "mesh", "dyn_mesh_load or dyn_mesh_from_arrays"); }
dynStatus check(const dynBroadPhase* broad_phase) {
  return check_magic(broad_phase, live_broad_phase, "broad phase", "dyn_broad_phase_new");
}
dynStatus check(const dynContactSolver* solver) {
  return check_magic(solver, live_contact_solver, "contact solver", "dyn_contact_solver_new");
}

dynStatus check(const dynPlanner* planner) { return check_magic(planner, live_planner, "planner", "dyn_planner_new"); }

const char* name_of_part(dynParts part) {
  static constexpr const char* names[] = {
      "KINEMATICS", "JACOBIANS", "COM", "INVERSE", "FORWARD", "MASS", "CHOLESKY", "MINV", "CORIOLIS", "ENERGY", "FRAMES",
      "CENTROIDAL", "INVERSE_DERIVATIVES", "FORWARD_DERIVATIVES", "REGRESSOR", "IK", "SECOND_ORDER", "COLLISION", "CONSTRAINTS",
      "CONSTRAINT_DERIVATIVES", "SIMULATION", "STEP_DERIVATIVES"};
  const char* name = "?";
  for (std::size_t k = 0; k < sizeof names / sizeof *names; ++k)
    if (part >> k & 1u) name = names[k];
  return name;
}

void Call::enter(const dynModel* model, dynData* data, dynParts part) {
  if ((status = check(model)) != DYN_OK) return;
  if ((status = check_magic(data, live_data, "data", "dyn_data_new")) != DYN_OK) return;
  if (data->body->model_id != model->m->id) {
    status =
        fail(DYN_ERROR_MODEL,
             "%s: the data belongs to another model (or to one that was freed): make data from the model you pass", function);
    return;
  }
  model_ = model->m.get();
  body = data->body;
#if DYN_CHECKED
  int idle = 0;
  if (!body->busy.compare_exchange_strong(idle, 1, std::memory_order_acquire)) {
    status = fail(DYN_ERROR_BUSY, "%s: another thread is using this data: give each thread its own", function);
    return;
  }
  entered = true;
#endif
  if ((d().parts & part) != part) {
    const dynParts missing = part & ~d().parts;
    status = fail(DYN_ERROR_PART, "%s needs part DYN_PART_%s, which this data was made without: name it in dyn_data_new",
                  function, name_of_part(missing));
    return;
  }
  if (part & ~dynParts(DYN_PART_SIMULATION)) have_effects_of(false);
}

bool Call::not_finite(const char* name, const double* x, Index k) {
  status = fail(DYN_ERROR_NONFINITE, "%s: %s[%d] is %s: give a finite number", function, name, int(k),
                x[k] != x[k] ? "NaN" : "infinite");
  return false;
}

dynStatus check_index(const char* function, const char* what, int index, Index count) {
  if (index >= 0 && index < count) return DYN_OK;
  return fail(DYN_ERROR_ARGUMENT, "%s: %s %d does not exist: the model has %d", function, what, index, int(count));
}

bool Call::missing(const char* name) {
  status = fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, name);
  return false;
}

bool Call::frame(int id) {
  if (status == DYN_OK && (id < 0 || id >= m().n.frames))
    status = fail(DYN_ERROR_ARGUMENT, "%s: frame %d does not exist: the model has frames 0 to %d; see dyn_model_frame_id",
                  function, id, int(m().n.frames) - 1);
  return status == DYN_OK;
}

bool Call::joint(int id) {
  if (status == DYN_OK && (id < 0 || id >= m().n.joints))
    status = fail(DYN_ERROR_ARGUMENT, "%s: joint %d does not exist: the model has joints 0 to %d; see dyn_model_joint_id",
                  function, id, int(m().n.joints) - 1);
  return status == DYN_OK;
}

bool Call::joint_or_all(int id) {
  if (!joint(id) || id == 0 || m().joints()[id].leader < 0) return status == DYN_OK;
  const JointRecord& j = m().joints()[id];
  status = fail(DYN_ERROR_ARGUMENT, "%s: joint '%s' mimics '%s': set effects on that joint", function, m().string(j.name),
                m().string(m().joints()[j.leader].name));
  return false;
}

bool Call::reference(dynReference r) {
  if (status == DYN_OK) status = check_value(r, function, "reference");
  return status == DYN_OK;
}

bool Call::stale(const char* what, const char* producer) {
  status = fail(DYN_ERROR_STALE, "%s: %s was not computed for the current state: call %s first", function, what, producer);
  return false;
}

namespace {

// to = from, kept = what to was. Whether all of from is finite, and whether anything changed.
struct Exchange {
  bool finite, changed;
};
Exchange exchange(const double* from, double* to, double* kept, Index n) {
#if !DYN_SIMD
  Exchange e{true, false};
  for (Index i = 0; i < n; ++i) {
    const double x = from[i], y = to[i];
    const auto bits = std::bit_cast<std::uint64_t>(x);
    e.finite = e.finite && (bits >> 52 & 0x7ff) != 0x7ff, e.changed = e.changed || bits != std::bit_cast<std::uint64_t>(y);
    kept[i] = y, to[i] = x;
  }
  return e;
#else
  using P = Double4;
  using Bits = Simd<std::int64_t, 4>;
  Bits bad = Bits::zero(), difference = bad;
  auto look = [&](const P& from, const P& to) {
    const Bits x = reinterpret<std::int64_t>(from), y = reinterpret<std::int64_t>(to), exponent = 0x7ff0000000000000;
    bad |= (x & exponent) == exponent;
    difference |= x ^ y;
  };
  Index i = 0;
  for (; i + 4 <= n; i += 4) {
    const P x = P::load(from + i), y = P::load(to + i);
    look(x, y);
    y.store(kept + i), x.store(to + i);
  }
  if (const int rest = int(n - i)) {
    const P x = load_partial(from + i, rest), y = load_partial(to + i, rest);
    look(x, y);
    store_partial(y, kept + i, rest), store_partial(x, to + i, rest);
  }
  return {!any(bad), any(difference != 0)};
#endif
}

}  // namespace

// Rollback compares them with the versions that it restores.
void Call::remember_stamps() {
  static_assert(std::size_t(Stage::Acceleration) == std::size_t(Stage::Position) + 2);
  std::memcpy(kinematic_stamps, d().stamp + std::size_t(Stage::Position), sizeof kinematic_stamps);
}

bool Call::inputs(const double* q, const double* v, const double* a, const double* tau) {
  const Model& m = this->m();
  Data<double>& x = d();
  const Index nq = m.n.nq, nv = m.n.nv;
  remember_stamps();
  double *const kept_q = x.backup, *const kept_v = kept_q + nq, *const kept_a = kept_v + nv, *const kept_tau = kept_a + nv;
  bool good = true;
  unsigned replaced = 0;
  auto take = [&](Input which, const double* from, double* to, double* kept, Index n) {
    if (!from || n == 0) return;
    if (from == to) {
      good = good && finite_count(from, n) == n;
      return;
    }
    const Exchange e = exchange(from, to, kept, n);
    good = good && e.finite;
    replaced |= unsigned(e.changed) << which;
  };
  // an input may be an array of the data itself: what was replaced is in the backup
  auto before_it = [&](const double* from, Input which, const double* to, const double* kept, Index n) {
    return replaced >> which & 1u && from >= to && from < to + n ? kept + (from - to) : from;
  };
  take(input_q, q, x.q, kept_q, nq);
  if (v) take(input_v, before_it(v, input_q, x.q, kept_q, nq), x.v, kept_v, nv);
  if (a) take(input_a, before_it(before_it(a, input_q, x.q, kept_q, nq), input_v, x.v, kept_v, nv), x.a, kept_a, nv);
  if (tau)
    take(input_tau,
         before_it(before_it(before_it(tau, input_q, x.q, kept_q, nq), input_v, x.v, kept_v, nv), input_a, x.a, kept_a, nv),
         x.tau_applied, kept_tau, nv);
  if (good && q && nq != nv) good = zero_norm_joint(m, x.q) == 0;
  if (!good) [[unlikely]] {
    if (replaced >> input_q & 1u) copy_out(kept_q, nq, x.q);
    if (replaced >> input_v & 1u) copy_out(kept_v, nv, x.v);
    if (replaced >> input_a & 1u) copy_out(kept_a, nv, x.a);
    if (replaced >> input_tau & 1u) copy_out(kept_tau, nv, x.tau_applied);
    return finite("q", q, nq) && finite("v", v, nv) && finite("a", a, nv) && finite("tau", tau, nv) && nonzero(q);
  }
  for (int k = 0; k < input_count; ++k)
    if (replaced >> k & 1u) {
      before[k] = x.version[k];
      x.version[k] = ++body->counter;
    }
  changed |= replaced;
  return true;
}

bool Call::nonzero(const double* q) {
  if (const Index j = zero_norm_joint(m(), q))
    status = fail(DYN_ERROR_QUATERNION,
                  "%s: the %s of joint '%s' in q is zero: give one of norm 1, such as that of dyn_configuration_neutral",
                  function, m().joints()[j].type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED ? "(cos, sin)" : "quaternion",
                  m().string(m().joints()[j].name));
  return status == DYN_OK;
}

void Call::begin_step() {
  Data<double>& x = d();
  remember_stamps();
  x.invalidate(Stage::Ddq), x.invalidate(Stage::Factor);  // their buffers are the step's
  simulation::with_active_trees(x, [&](const auto& part) {
    part.for_each_group(m(), [&](const Trees& t) {
      copy_out(x.q + t.q, t.q_end - t.q, x.backup + t.q), copy_out(x.v + t.v, t.v_end - t.v, x.backup + m().n.nq + t.v);
    });
  });
  copy_out(x.act, m().n.na, x.backup + m().n.nq + 3 * m().n.nv);
  stepping = true;
  for (Input which : {input_q, input_v}) {
    before[which] = x.version[which];
    x.version[which] = ++body->counter;
    changed |= 1u << which;
  }
}

void Call::have_effects_of(bool steps) {
  if constexpr (possible_parts & DYN_PART_SIMULATION) {
    if (body->stepping == steps) return;
    switch_effects(m(), d(), steps);
    body->stepping = steps;
  }
}

void Call::end_step() {
  for (Input which : {input_q, input_v}) d().version[which] = ++body->counter;
}

void Call::suspend() {
  end_step();
#if DYN_CHECKED
  body->busy.store(0, std::memory_order_release);
#endif
}

void Call::resume() {
#if DYN_CHECKED
  body->busy.store(1, std::memory_order_release);
#endif
  have_effects_of(true);
}

void Call::end_search() {
  d().version[input_q] = ++body->counter;
  d().mark_fresh(Stage::Position);
}

void Call::rollback() {
  if (!changed) return;
  const bool stepped = (possible_parts & DYN_PART_SIMULATION) && stepping;
  Data<double>& x = d();
  const double* backup = x.backup;
  auto restore = [&](Input which, double* to, Index n) {
    if (changed >> which & 1u) {
      if (!stepped) copy_out(backup, n, to);
      x.version[which] = before[which];
    }
    backup += n;
  };
  if (stepped)
    simulation::with_active_trees(x, [&](const auto& part) {
      part.for_each_group(m(), [&](const Trees& t) {
        copy_out(backup + t.q, t.q_end - t.q, x.q + t.q), copy_out(backup + m().n.nq + t.v, t.v_end - t.v, x.v + t.v);
      });
    });
  restore(input_q, x.q, m().n.nq);
  restore(input_v, x.v, m().n.nv);
  restore(input_a, x.a, m().n.nv);
  restore(input_tau, x.tau_applied, m().n.nv);
  if (stepped) copy_out(backup, m().n.na, x.act);
  // the buffers behind the frame queries held the old state
  x.invalidate(Stage::Position), x.invalidate(Stage::Velocity), x.invalidate(Stage::Acceleration);
  if constexpr (possible_parts & DYN_PART_KINEMATICS) {
    const auto was_fresh = [&](Stage s) {
      return kinematic_stamps[std::size_t(s) - std::size_t(Stage::Position)] == x.newest(s);
    };
    if (was_fresh(Stage::Acceleration)) forward_kinematics<2>(m(), x);
    else if (was_fresh(Stage::Velocity)) forward_kinematics<1>(m(), x);
    else if (was_fresh(Stage::Position)) forward_kinematics<0>(m(), x);
  }
  changed = 0;
}

void Call::drop_results() {
  for (std::size_t s = std::size_t(Stage::Frames); s < std::size_t(Stage::count_); ++s)
    if (d().fresh(Stage(s))) d().invalidate(Stage(s));
}

bool Call::numeric(const double* x, std::ptrdiff_t n, const char* what, Stage stage) {
  if (status != DYN_OK) return false;
  const std::ptrdiff_t k = finite_count(x, n);
  if (k == n) return true;
  drop_results();
  d().invalidate(stage);
  rollback();
  status = fail(DYN_ERROR_NUMERIC, "%s: %s[%td] overflows: the inputs are too large for double precision", function, what, k);
  return false;
}

}  // namespace dyn::capi
