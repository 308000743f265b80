// The plan of a step: which effects a data has, and what they take of its memory.
#include <algorithm>

#include "simulation/workspace.hpp"
#include "guard.hpp"

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
  const char* name;
  int (*present)(const Model&);
  int (*acting)(const Model&, const Data<double>&);  // of those
  std::size_t (*bytes)(const Model&, dynParts);
};

template <std::uint32_t bit>
int acts(const Model&, const Data<double>& d) { return (d.acting & bit) != 0; }

constexpr Row rows[] = {
    {"gravity", [](const Model& m) { return int(count(m.gravity, 3) > 0); }, [](const Model&, const Data<double>& d) { return int(count(d.world_gravity, 3) > 0); },
     [](const Model&, dynParts) { return std::size_t(64); }},
    {"armature", [](const Model& m) { return count(m.armature(), m.n.nv); }, acts<DYN_EFFECT_ARMATURE>, [](const Model& m, dynParts) { return sizeof(double) * std::size_t(m.n.nv); }},
    {"damping", [](const Model& m) { return count(m.damping(), m.n.nv); }, acts<DYN_EFFECT_DAMPING>, joint_bytes<DYN_EFFECT_DAMPING>},
    {"springs", [](const Model& m) { return count(m.stiffness(), m.n.nv); }, acts<DYN_EFFECT_SPRINGS>, joint_bytes<DYN_EFFECT_SPRINGS>},
    {"friction", [](const Model& m) { return count(m.friction(), m.n.nv); }, acts<DYN_EFFECT_FRICTION>, joint_bytes<DYN_EFFECT_FRICTION>},
    {"limits", [](const Model& m) { return int(m.n.limits); }, acts<DYN_EFFECT_LIMITS>,
     [](const Model& m, dynParts parts) { return bytes_of(m, parts, [](Model& x) { x.effects &= ~std::uint32_t(DYN_EFFECT_LIMITS), x.n.limits = 0; }); }},
    {"mimic", [](const Model& m) { return int(m.n.nvx - m.n.nv); }, [](const Model& m, const Data<double>&) { return int(m.has_mimic); },
     [](const Model& m, dynParts parts) { return bytes_of(m, parts, [](Model& x) { x.has_mimic = 0, x.n.mimic_q = x.n.mimic_v = 0; }); }},
    {"contact", [](const Model& m) { return int(std::count_if(m.pairs(), m.pairs() + m.n.pairs, [](const PairRecord& p) { return p.reason == DYN_PAIR_REASON_TESTED; })); },
     [](const Model& m, const Data<double>& d) { return d.pair_states ? int(std::count(d.pair_states, d.pair_states + m.n.pairs, DYN_PAIR_REASON_TESTED)) : 0; },
     [](const Model& m, dynParts parts) { return bytes_of(m, parts, [](Model& x) { x.n.contacts = x.n.pairs = x.n.geoms = x.n.hulls = x.n.trees = x.n.grids = 0; }); }},
    {"constraints", [](const Model& m) { return int(m.n.constraints); },
     [](const Model& m, const Data<double>& d) { return d.slots ? int(std::count_if(d.slots, d.slots + m.n.slots, [](const ConstraintInstance<double>& s) { return s.rows > 0; })) : 0; },
     [](const Model& m, dynParts parts) { return bytes_of(m, parts, [](Model& x) { x.n.slots = x.n.constraint_rows = 0; }); }},
    {"actuators", [](const Model& m) { return int(m.n.actuators); }, acts<DYN_EFFECT_ACTUATORS>,
     [](const Model& m, dynParts parts) {
       return bytes_of(m, parts, [](Model& x) { x.effects &= ~std::uint32_t(DYN_EFFECT_ACTUATORS), x.n.actuators = x.n.nu = x.n.na = 0; });
     }},
    {"wrenches", [](const Model& m) { return int(m.n.joints - 1); }, acts<acting_wrenches>,
     [](const Model& m, dynParts parts) { return parts & DYN_PART_SIMULATION ? std::size_t(m.n.joints) * (sizeof(AppliedWrench<double>) + 6 * sizeof(double)) : 0; }},
    {"gravity_compensation", [](const Model& m) { return int(m.n.gravity_compensations); }, acts<DYN_EFFECT_GRAVITY_COMPENSATION>, [](const Model&, dynParts) { return std::size_t(0); }},
    {"fluid", [](const Model& m) { return int(m.n.drag_boxes); }, acts<DYN_EFFECT_FLUID>,
     [](const Model& m, dynParts parts) { return bytes_of(m, parts, [](Model& x) { x.n.drag_boxes = 0; }); }},
    {"sleeping", [](const Model& m) { return int(simulation::resting_trees(m)); },
     [](const Model& m, const Data<double>& d) { return d.acting & DYN_EFFECT_SLEEPING ? int(simulation::resting_trees(m)) : 0; },
     [](const Model& m, dynParts parts) { return parts & DYN_PART_SIMULATION ? simulation::sleep_bytes(m) : 0; }},
};
constexpr int row_count = int(sizeof rows / sizeof *rows);

}  // namespace

extern "C" {

int dyn_effect_count(void) { return row_count; }

dynStatus dyn_data_effect_info(const dynModel* model, dynData* data, int effect, dynEffectInfo* info) {
  Call call(model, data, 0, "dyn_data_effect_info");
  if (!call) return call.status;
  if (const dynStatus s = check_struct(call.function, "info", info)) return s;
  if (effect < 0 || effect >= row_count) return fail(DYN_ERROR_ARGUMENT, "dyn_data_effect_info: effect %d does not exist: there are %d", effect, row_count);
  call.have_effects_of(true);
  const Row& row = rows[effect];
  const Model& m = call.m();
  const int present = row.present(m);
  write_struct({0, row.name, present, row.acting(m, call.d()), present ? row.bytes(m, call.d().parts) : 0}, info);
  return DYN_OK;
}

}  // extern "C"
