// The state of a simulation, kept and brought back bit for bit, and copied with all settings.
#include "constraint.hpp"
#include "model/effects.hpp"
#include "simulation/mocap.hpp"
#include "simulation/workspace.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

constexpr std::uint64_t magic_of_states = 0x3445544154534e59u;  // "YNSTATE4"

struct Header {
  std::uint64_t magic, model_id;
  std::int64_t contacts;
  double time, growth;
};

std::size_t numbers(const Model& m) {
  return std::size_t(m.n.nq) + 3 * std::size_t(m.n.nv) + std::size_t(m.n.nu) + std::size_t(m.n.na) +
         std::size_t(simulation::remembered_rows(m)) + 12 * std::size_t(m.n.mocaps) +
         std::size_t(simulation::frame_force_numbers(m));
}
std::size_t bytes(const Model& m) {
  return sizeof(Header) + (numbers(m) + std::size_t(simulation::resting_trees(m))) * sizeof(double) +
         std::size_t(m.n.contacts) * sizeof(dynContactForce);
}

// f(array of the data, numbers) for q, v, a, tau and placements of mocap bodies, and of data that make steps controls and their
// filters, forces of limits, forces between frames, and how long trees have been slow
constexpr int inputs = 10;
template <class F>
void for_each_input(const Model& m, Data<double>& d, F&& f) {
  f(d.q, m.n.nq), f(d.v, m.n.nv), f(d.a, m.n.nv), f(d.tau_applied, m.n.nv), f(d.mocap, 12 * m.n.mocaps);
  if (!d.step) return;
  f(d.ctrl, m.n.nu), f(d.act, m.n.na), f(d.step->limit_forces, simulation::remembered_rows(m));
  f(d.step->frame_forces, Index(simulation::frame_force_numbers(m)));
  f(d.step->sleep.slow_time, d.step->sleep.count);
}

void copy_bytes(const void* from, std::size_t bytes, void* to) { bytes ? std::memcpy(to, from, bytes) : nullptr; }

// The inputs were replaced.
void begin_anew(const Model& m, dynData* data, double time, double growth, Index contacts) {
  Data<double>& d = data->body->d;
  for (std::uint64_t& version : d.version) version = ++data->body->counter;
  for (Index k = 0; k < m.n.mocaps; ++k) {
    place_mocap(m, d, k, d.mocap + 12 * k);
    simulation::mocap_moved(m, d, k, false);
  }
  d.time[0] = time;
  if (!d.step) return;
  d.step->growth = growth, d.step->ends_fast = true;
  d.step->contact_count = contacts, d.step->advancement_cache.square = 0;
}

// Everything that is set in a data and is no part of its state.
void copy_settings(const Model& m, const Data<double>& from, Data<double>& to, bool stepping) {
  std::copy_n(from.chosen_effects, m.n.joints, to.chosen_effects);
  std::copy_n(from.world_gravity, 3, to.world_gravity);
  to.pushed = from.pushed;
  switch_effects(m, to, stepping);
  apply_effects(m, to);  // pushed may have changed
  if (to.geoms) {
    std::copy_n(from.pair_states, m.n.pairs, to.pair_states);
    std::copy_n(from.geom_masks, m.n.geoms, to.geom_masks);
  }
  if (to.slots) {
    for (Index s = 0; s < m.n.slots; ++s) set_constraint(m, to, s, from.constraint_specs[s]);
    number_rows(m, to);
    drop_constraints(to);
  }
  if (!to.step) return;
  std::copy_n(from.wrenches, m.n.joints, to.wrenches);
  if (to.step->materials) std::copy_n(from.step->materials, m.n.geoms, to.step->materials);
  to.step->options = from.step->options;
  to.step->pair_count = -1;
}

bool is_geom(const Model& m, Index shape) {
  return shape >= 0 && shape < m.n.shapes && m.shapes()[shape].role == DYN_SHAPE_ROLE_COLLISION;
}

bool room(Call& call, const void* memory, std::size_t size) {
  if (!call.required("memory", memory)) return false;
  if (size >= bytes(call.m())) return true;
  call.status =
      fail(DYN_ERROR_SIZE, "%s: memory has %zu bytes, needs %zu (dyn_model_state_size)", call.function, size, bytes(call.m()));
  return false;
}

}  // namespace

extern "C" {

size_t dyn_model_state_size(const dynModel* model) { return check(model) == DYN_OK ? bytes(*model->m) : 0; }

dynStatus dyn_data_save_state(const dynModel* model, dynData* data, void* memory, size_t size) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_save_state");
  if (!call || !room(call, memory, size)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  char* at = static_cast<char*>(memory);
  const auto put = [&](const void* x, std::size_t n) { copy_bytes(x, n, at), at += n; };
  const std::int64_t contacts = d.step->contact_count + d.step->sleep.sleeping_contact_count;
  const Header header{magic_of_states, m.id, contacts, d.time[0], d.step->growth};
  put(&header, sizeof header);
  for_each_input(m, d, [&](const double* x, Index n) { put(x, std::size_t(n) * sizeof(double)); });
  simulation::for_each_contact(*d.step, [&](const dynContactForce& f) { put(&f, sizeof f); });
  std::memset(at, 0, std::size_t(m.n.contacts - contacts) * sizeof(dynContactForce));
  return DYN_OK;
}

dynStatus dyn_data_restore_state(const dynModel* model, dynData* data, const void* memory, size_t size) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_restore_state");
  if (!call || !room(call, memory, size)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  const char* at = static_cast<const char*>(memory);
  Header header;
  std::memcpy(&header, at, sizeof header);
  at += sizeof header;
  if (header.magic != magic_of_states)
    return fail(DYN_ERROR_ARGUMENT, "%s: memory holds no state: dyn_data_save_state writes one", call.function);
  if (header.model_id != m.id) return fail(DYN_ERROR_ARGUMENT, "%s: the state is that of another model", call.function);
  bool sound = header.contacts >= 0 && header.contacts <= m.n.contacts && std::isfinite(header.time) && header.growth >= 0 && std::isfinite(header.growth);
  const char* next = at;
  for_each_input(m, d, [&](double*, Index n) {
    for (Index k = 0; k < n; ++k, next += sizeof(double)) {
      double x;
      std::memcpy(&x, next, sizeof x);
      sound = sound && std::isfinite(x);
    }
  });
  for (std::int64_t k = 0; sound && k < header.contacts; ++k) {
    dynContactForce f;
    std::memcpy(&f, next + std::size_t(k) * sizeof f, sizeof f);
    const Index pair = f.contact.pair;
    sound =
        finite_count(f.force_on_b, 3) == 3 && finite_count(f.moment_on_b, 3) == 3 && finite_count(f.contact.position, 3) == 3 &&
        finite_count(f.contact.normal, 3) == 3 && std::isfinite(f.contact.distance) && pair < m.n.pairs &&
        (pair >= 0
             ? m.geoms()[m.pairs()[pair].a].shape == f.contact.shape_a && m.geoms()[m.pairs()[pair].b].shape == f.contact.shape_b
             : (!lists_pairs(m) && is_geom(m, f.contact.shape_a) && is_geom(m, f.contact.shape_b)));
  }
  if (!sound) return fail(DYN_ERROR_NONFINITE, "%s: the state is damaged: it holds numbers that no step leaves", call.function);
  simulation::wake_all(m, d);
  for_each_input(m, d, [&](double* x, Index n) {
    copy_bytes(at, std::size_t(n) * sizeof(double), x), at += std::size_t(n) * sizeof(double);
  });
  begin_anew(m, data, header.time, header.growth, Index(header.contacts));
  copy_bytes(at, std::size_t(header.contacts) * sizeof(dynContactForce), d.step->contacts);
  return DYN_OK;
}

dynStatus dyn_data_copy(const dynModel* model, dynData* to, dynData* from) {
  Call call(model, to, 0, "dyn_data_copy");
  if (!call || to == from) return call.status;
  const Call source(model, from, 0, call.function);
  if (!source) return source.status;
  const Model& m = call.m();
  Data<double>&d = call.d(), &x = source.d();
  if (d.parts != x.parts)
    return fail(DYN_ERROR_PART, "%s: to has parts 0x%x and from 0x%x: make both with the same parts", call.function,
                unsigned(d.parts), unsigned(x.parts));
  if (d.step) simulation::wake_all(m, d);
  copy_settings(m, x, d, to->body->stepping);
  double* arrays[inputs] = {};
  int count = 0;
  for_each_input(m, d, [&](double* array, Index) { arrays[count++] = array; });
  count = 0;
  for_each_input(m, x, [&](const double* array, Index n) {
    copy_bytes(array, std::size_t(n) * sizeof(double), arrays[count++]);
  });
  begin_anew(m, to, x.time[0], x.step ? x.step->growth : 0, 0);
  if (d.step)
    simulation::for_each_contact(*x.step, [&](const dynContactForce& f) { d.step->contacts[d.step->contact_count++] = f; });
  return DYN_OK;
}

}  // extern "C"
