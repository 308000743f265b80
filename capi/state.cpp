// The state of a simulation, kept and brought back bit for bit.
#include "simulation/mocap.hpp"
#include "simulation/workspace.hpp"
#include "guard.hpp"

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

// f(array of the data, numbers) for q, v, a, tau, controls and their filters, forces of limits, placements of mocap
// bodies, forces between frames, and how long trees have been slow
template <class F>
void for_each_input(const Model& m, Data<double>& d, F&& f) {
  f(d.q, m.n.nq), f(d.v, m.n.nv), f(d.a, m.n.nv), f(d.tau_applied, m.n.nv), f(d.ctrl, m.n.nu), f(d.act, m.n.na);
  f(d.step->limit_forces, simulation::remembered_rows(m));
  f(d.mocap, 12 * m.n.mocaps);
  f(d.step->frame_forces, Index(simulation::frame_force_numbers(m)));
  f(d.step->sleep.slow_time, d.step->sleep.count);
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
  const auto put = [&](const void* x, std::size_t n) { n ? std::memcpy(at, x, n) : nullptr, at += n; };
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
    n ? std::memcpy(x, at, std::size_t(n) * sizeof(double)) : nullptr, at += std::size_t(n) * sizeof(double);
  });
  for (std::uint64_t& version : d.version) version = ++data->body->counter;
  for (Index k = 0; k < m.n.mocaps; ++k) {
    place_mocap(m, d, k, d.mocap + 12 * k);
    simulation::mocap_moved(m, d, k, false);
  }
  d.time[0] = header.time, d.step->growth = header.growth, d.step->ends_fast = true;
  d.step->contact_count = Index(header.contacts), d.step->advancement_cache.square = 0;
  if (header.contacts) std::memcpy(d.step->contacts, at, std::size_t(header.contacts) * sizeof(dynContactForce));
  return DYN_OK;
}

}  // extern "C"
