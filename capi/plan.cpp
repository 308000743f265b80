// The plan of a step: which effects a data has, and what they take of its memory.
#include <algorithm>
#include <array>
#include <type_traits>

#include "effect/list.hpp"
#include "simulation/workspace.hpp"
#include "reflection.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

int count(const double* x, Index n) { return int(std::count_if(x, x + n, [](double y) { return y != 0; })); }
// Bytes that the data of a model without the effect would not have.
template <class F>
std::size_t bytes_of(const Model& m, dynParts parts, F&& take_away) {
  Model without = m;  // its sizes alone are asked
  take_away(without);
  return data_bytes<double>(m, parts) - std::min(data_bytes<double>(m, parts), data_bytes<double>(without, parts));
}

template <std::uint32_t bit>
std::size_t joint_bytes(const Model& m, dynParts parts) {
  return bytes_of(m, parts, [](Model& x) { x.effects &= ~bit; });
}

struct Row {
  std::uint32_t bit;  // 0: what is no DYN_EFFECT_... has a name
  const char* name;
  int (*present)(const Model&);
  int (*acting)(const Model&, const Data<double>&);  // of those
  std::size_t (*bytes)(const Model&, dynParts);
};

template <std::uint32_t bit>
int acts(const Model&, const Data<double>& d) { return (d.acting & bit) != 0; }

// An effect with a coefficient for each degree of freedom.
template <class E>
constexpr Row of_coefficients() {
  return {E::bit, "", [](const Model& m) { return count(E::of(m), m.n.nv); }, acts<E::bit>, [](const Model& m, dynParts parts) {
            constexpr bool in_all_data = std::is_same_v<E, effect::Armature>;
            return in_all_data ? sizeof(double) * std::size_t(m.n.nv) : joint_bytes<E::bit>(m, parts);
          }};
}

constexpr Row others[] = {
    {0, "gravity", [](const Model& m) { return int(count(m.gravity, 3) > 0); },
     [](const Model&, const Data<double>& d) { return int(count(d.world_gravity, 3) > 0); },
     [](const Model&, dynParts) { return std::size_t(64); }},
    {DYN_EFFECT_LIMITS, "", [](const Model& m) { return int(m.n.limits); }, acts<DYN_EFFECT_LIMITS>,
     [](const Model& m, dynParts parts) {
       return bytes_of(m, parts, [](Model& x) { x.effects &= ~std::uint32_t(DYN_EFFECT_LIMITS), x.n.limits = 0; });
     }},
    {0, "mimic", [](const Model& m) { return int(m.n.nvx - m.n.nv); },
     [](const Model& m, const Data<double>&) { return int(m.has_mimic); },
     [](const Model& m, dynParts parts) {
       return bytes_of(m, parts, [](Model& x) { x.has_mimic = 0, x.n.mimic_q = x.n.mimic_v = 0; });
     }},
    {0, "contact",
     [](const Model& m) {
       return int(std::count_if(m.pairs(), m.pairs() + m.n.pairs,
                                [](const PairRecord& p) { return p.reason == DYN_PAIR_REASON_TESTED; }));
     },
     [](const Model& m, const Data<double>& d) {
       return d.pair_states ? int(std::count(d.pair_states, d.pair_states + m.n.pairs, DYN_PAIR_REASON_TESTED)) : 0;
     },
     [](const Model& m, dynParts parts) {
       return bytes_of(m, parts, [](Model& x) { x.n.contacts = x.n.pairs = x.n.geoms = x.n.hulls = x.n.trees = x.n.grids = 0; });
     }},
    {0, "constraints", [](const Model& m) { return int(m.n.constraints); },
     [](const Model& m, const Data<double>& d) {
       return d.slots ? int(std::count_if(d.slots, d.slots + m.n.slots,
                                          [](const ConstraintInstance<double>& s) { return s.rows > 0; }))
                      : 0;
     },
     [](const Model& m, dynParts parts) { return bytes_of(m, parts, [](Model& x) { x.n.slots = x.n.constraint_rows = 0; }); }},
    {DYN_EFFECT_ACTUATORS, "", [](const Model& m) { return int(m.n.actuators); }, acts<DYN_EFFECT_ACTUATORS>,
     [](const Model& m, dynParts parts) {
       return bytes_of(m, parts,
                       [](Model& x) { x.effects &= ~std::uint32_t(DYN_EFFECT_ACTUATORS), x.n.actuators = x.n.nu = x.n.na = 0; });
     }},
    {DYN_EFFECT_TENDONS, "", [](const Model& m) { return int(m.n.tendons + m.n.couplings); }, acts<DYN_EFFECT_TENDONS>,
     [](const Model& m, dynParts parts) {
       return bytes_of(m, parts, [](Model& x) {
         x.effects &= ~std::uint32_t(DYN_EFFECT_TENDONS), x.n.tendons = x.n.couplings = x.n.paths = x.n.path_dofs =
             x.n.path_rows = 0;
       });
     }},
    {0, "wrenches", [](const Model& m) { return int(m.n.joints - 1); }, acts<acting_wrenches>,
     [](const Model& m, dynParts parts) {
       return parts & DYN_PART_SIMULATION ? std::size_t(m.n.joints) * (sizeof(AppliedWrench<double>) + 6 * sizeof(double)) : 0;
     }},
    {DYN_EFFECT_GRAVITY_COMPENSATION, "", [](const Model& m) { return int(m.n.gravity_compensations); },
     acts<DYN_EFFECT_GRAVITY_COMPENSATION>, [](const Model&, dynParts) { return std::size_t(0); }},
    {DYN_EFFECT_FLUID, "", [](const Model& m) { return int(m.n.drag_boxes); }, acts<DYN_EFFECT_FLUID>,
     [](const Model& m, dynParts parts) { return bytes_of(m, parts, [](Model& x) { x.n.drag_boxes = 0; }); }},
    {DYN_EFFECT_FLUID_ELLIPSOIDS, "", [](const Model& m) { return int(m.n.fluid_ellipsoids); }, acts<DYN_EFFECT_FLUID_ELLIPSOIDS>,
     [](const Model& m, dynParts parts) { return bytes_of(m, parts, [](Model& x) { x.n.fluid_ellipsoids = 0; }); }},
    {DYN_EFFECT_SLEEPING, "", [](const Model& m) { return int(simulation::resting_trees(m)); },
     [](const Model& m, const Data<double>& d) { return d.acting & DYN_EFFECT_SLEEPING ? int(simulation::resting_trees(m)) : 0; },
     [](const Model& m, dynParts parts) { return parts & DYN_PART_SIMULATION ? simulation::sleep_bytes(m) : 0; }},
};

constexpr auto effect_rows = [] {
  constexpr int coefficients = [] {
    int n = 0;
    for_each_coefficient([&]<class E>() { ++n; });
    return n;
  }();
  std::array<Row, std::size(others) + coefficients> out{};
  std::size_t k = 0;
  for_each_coefficient([&]<class E>() { out[k++] = of_coefficients<E>(); });
  for (const Row& row : others) out[k++] = row;
  return out;
}();
constexpr int effect_count = int(effect_rows.size());

}  // namespace

extern "C" {

int dyn_effect_count(void) { return effect_count; }

dynStatus dyn_data_effect_info(const dynModel* model, dynData* data, int effect, dynEffectInfo* info) {
  Call call(model, data, 0, "dyn_data_effect_info");
  if (!call) return call.status;
  if (const dynStatus s = check_struct(call.function, "info", info)) return s;
  if (effect < 0 || effect >= effect_count)
    return fail(DYN_ERROR_ARGUMENT, "dyn_data_effect_info: effect %d does not exist: there are %d", effect, effect_count);
  call.have_effects_of(true);
  const Row& row = effect_rows[std::size_t(effect)];
  const Model& m = call.m();
  const int present = row.present(m);
  const char* name = row.bit ? effect_value(row.bit)->name : row.name;
  write_struct({0, name, present, row.acting(m, call.d()), present ? row.bytes(m, call.d().parts) : 0}, info);
  return DYN_OK;
}

}  // extern "C"
