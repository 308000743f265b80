// Effects by name: which of them a robot calls for, and switching them.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cmath>

#include "effect_choice.hpp"

namespace cli {

namespace {

constexpr std::uint32_t of_joints = DYN_EFFECT_ALL & ~DYN_EFFECT_SLEEPING;  // which is asked for by name

struct Name {
  std::string name;
  std::uint32_t bits;
};

// The bits of dyn.h, what is of the whole, and sets of them.
const std::vector<Name>& names() {
  static const std::vector<Name> list = [] {
    std::vector<Name> out;
    for (const Choice& c : choices("dynEffects"))
      if (const auto bits = static_cast<std::uint32_t>(c.value); std::has_single_bit(bits) && (bits & DYN_EFFECT_ALL))
        out.push_back({c.name, static_cast<std::uint32_t>(c.value)});
    for (const Name& n : {Name{"gravity", has_gravity}, Name{"contact", has_contact}, Name{"constraints", has_constraints},
                          Name{"stated", DYN_EFFECT_AS_STATED}, Name{"all", of_joints | of_the_whole}, Name{"none", 0}})
      out.push_back(n);
    return out;
  }();
  return list;
}

std::uint32_t bits_of(const std::string& list, const char* option) {
  std::uint32_t bits = 0;
  const std::vector<std::string> words = list_of(option, list);
  if (words.empty() && !list.empty()) bad_usage(std::string(option) + ": the list is empty.");
  for (const std::string& word : words) {
    if (word == "none" && words.size() > 1)
      bad_usage(std::string(option) + ": \"none\" stands alone, not in \"" + shown(list) + "\".");
    const auto found = std::find_if(names().begin(), names().end(), [&](const auto& e) { return word == e.name; });
    if (found == names().end()) {
      std::string known;
      for (const auto& e : names()) known += (known.empty() ? "" : ", ") + std::string(e.name);
      bad_usage(std::string(option) + ": \"" + shown(word) + "\" is none of " + known + ".");
    }
    bits |= found->bits;
  }
  return bits;
}

// Effects of steps of new data: those of the file that it has and does not switch off.
std::uint32_t stated(const Robot& robot) {
  dynData* handle = nullptr;
  check(dyn_data_new(robot, DYN_PART_SIMULATION, &handle));
  const std::unique_ptr<dynData, Deleter<dyn_data_free>> data(handle);
  std::uint32_t bits = 0;
  check(dyn_data_effects(robot, data.get(), 0, &bits));
  return bits;
}

// Tendons with a spring, damping, friction, armature or limits.
int tendons_with_forces(const Robot& robot) {
  int n = 0;
  for (int k = 0; k < dyn_model_ntendons(robot); ++k) {
    dynTendon t{};
    t.struct_size = sizeof t;
    check(dyn_model_tendon_info(robot, k, &t));
    n += t.stiffness > 0 || t.damping > 0 || t.friction > 0 || t.armature > 0 || std::isfinite(t.range[0]) ||
         std::isfinite(t.range[1]);
  }
  return n;
}

}  // namespace

void add_effects_option(CLI::App& command, EffectOptions& options) {
  std::vector<std::string> of_joints_and_links;
  for (const auto& e : names())
    if (std::has_single_bit(e.bits) && e.bits & DYN_EFFECT_ALL) of_joints_and_links.push_back(e.name);
  CLI::Option* const with = command
                                .add_option("--effects", options.with,
                                            "Effects of joints and links: " + join(of_joints_and_links) +
                                                ", separated by commas; stated: those of the file that its flags do not switch off; "
                                                "all (without sleeping), or none")
                                ->check(not_empty)
                                ->type_name("LIST")
                                ->capture_default_str();
  CLI::Option* const without =
      command.add_option("--without", options.without, "Effects to leave out: any of those, gravity, contact, constraints")
          ->check(not_empty)
          ->type_name("LIST");
  Values list{of_joints_and_links, true};
  list.names.insert(list.names.end(), {"stated", "all", "none"});
  complete(with, list);
  list.names = of_joints_and_links;
  list.names.insert(list.names.end(), {"gravity", "contact", "constraints"});
  complete(without, list);
}

std::uint32_t parse_effects(const EffectOptions& options) {
  return (bits_of(options.with, "--effects") | of_the_whole) & ~bits_of(options.without, "--without");
}

std::uint32_t effects_on(const Robot& robot, const EffectOptions& options) {
  std::uint32_t on = parse_effects(options);
  if (on & DYN_EFFECT_AS_STATED) on = (on & ~std::uint32_t(DYN_EFFECT_AS_STATED)) | stated(robot);
  return on & ~bits_of(options.without, "--without");
}

std::uint32_t effect_bits(const std::string& name) { return bits_of(name, "--without"); }

void apply_effects(const Robot& robot, dynData* data, std::uint32_t effects) {
  check(dyn_data_set_effects(robot, data, 0, effects & (of_joints | DYN_EFFECT_SLEEPING)));
  const double none[3] = {};
  if (!(effects & has_gravity)) check(dyn_data_set_gravity(robot, data, none));
  if (effects & has_contact && effects & has_constraints) return;
  if (!(effects & has_contact))
    for (int k = 0; k < dyn_model_npairs(robot); ++k)
      if (dyn_data_set_pair(robot, data, k, 0) == DYN_ERROR_PART) break;  // data that knows no pairs
  if (!(effects & has_contact)) dyn_data_set_shape_masks(robot, data, -1, 0, 0);  // of pairs that are not listed
  if (!(effects & has_constraints))
    for (int k = 0; k < dyn_model_nconstraints(robot); ++k)
      if (dyn_data_set_constraint_enabled(robot, data, k, 0) == DYN_ERROR_PART) break;
}

json effects(const Robot& robot, std::uint32_t on) {
  const Data data(robot, DYN_PART_SIMULATION, on);
  json list = json::array();
  const auto add = [&](const char* name, bool active, const std::string& reason) {
    std::uint64_t bytes = 0;
    for (int k = 0; k < dyn_effect_count(); ++k) {
      dynEffectInfo info{};
      info.struct_size = sizeof info;
      check(dyn_data_effect_info(robot, data, k, &info));
      if (std::string(name) == info.name) bytes = info.bytes;
    }
    list.push_back({{"name", name}, {"active", active}, {"reason", reason}, {"bytes", bytes}});
  };
  const auto count = [&](dynModelArray which, int n, auto&& present) {
    const double* x = dyn_model_array(robot, which);
    return x ? static_cast<int>(std::count_if(x, x + n, present)) : 0;
  };
  const auto nonzero = [](double x) { return x != 0; };
  const auto off = [&](std::uint32_t bit) { return on & bit ? "" : "; switched off"; };
  // the table's row of a bit
  const auto type = [](std::uint32_t bit) {
    dynEffectTypeInfo info{};
    info.struct_size = sizeof info;
    check(dyn_effect_type_info(bit, &info));
    return info;
  };
  // found: how many there are, and what they do
  const auto effect = [&](std::uint32_t bit, int n, const std::string& found) {
    add(type(bit).name, n && on & bit, n ? found + off(bit) : std::string(type(bit).absent));
  };
  const auto several = [](int n, const char* one, const char* more) { return std::to_string(n) + (n == 1 ? one : more); };
  const auto effect_info = [&](const char* name) {
    dynEffectInfo info{};
    for (int k = 0; k < dyn_effect_count() && !(info.name && std::string(name) == info.name); ++k) {
      info.struct_size = sizeof info;
      check(dyn_data_effect_info(robot, data, k, &info));
    }
    return info;
  };
  const auto present = [&](const char* name) { return int(effect_info(name).present); };
  const double* g = dyn_model_array(robot, DYN_MODEL_ARRAY_GRAVITY);
  const bool falls = g && (g[0] != 0 || g[1] != 0 || g[2] != 0);
  add("gravity", falls && on & has_gravity,
      falls ? "gravity is (" + short_number(g[0]) + ", " + short_number(g[1]) + ", " + short_number(g[2]) + ") m/s^2" +
                  off(has_gravity)
            : "gravity is zero");
  for (std::uint32_t bit = 1; bit <= DYN_EFFECT_ALL; bit <<= 1) {
    if (!(bit & DYN_EFFECT_ALL)) continue;  // AS_STATED
    if (const dynEffectTypeInfo info = type(bit); info.array >= 0) {
      const int n = count(static_cast<dynModelArray>(info.array), robot.nv, nonzero);
      effect(bit, n, std::to_string(n) + " of " + std::to_string(robot.nv) + " degrees of freedom have " + info.quantity);
    }
  }
  const auto finite = [](double x) { return std::isfinite(x); };
  const int limits =
      std::max(count(DYN_MODEL_ARRAY_LOWER_LIMIT, robot.nq, finite), count(DYN_MODEL_ARRAY_UPPER_LIMIT, robot.nq, finite));
  effect(DYN_EFFECT_LIMITS, limits, std::to_string(limits) + " of " + std::to_string(robot.nq) + " coordinates have limits");
  const int tested = present("contact");
  add("contact", tested && on & has_contact,
      tested ? several(tested, " pair", " pairs") + " of shapes may touch" + off(has_contact) : "no pair of shapes is tested");
  const int constraints = dyn_model_nconstraints(robot), enabled = effect_info("constraints").acting;
  const std::string none_enabled = on & has_constraints && !enabled ? ", none of them enabled" : "";
  add("constraints", enabled > 0,
      constraints ? "the file has " + several(constraints, " constraint", " constraints") + none_enabled + off(has_constraints)
                  : "the file has none");
  const int actuators = dyn_model_nactuators(robot);
  effect(DYN_EFFECT_ACTUATORS, actuators,
         several(actuators, " actuator", " actuators") + " with " + several(dyn_model_nu(robot), " control", " controls"));
  const int tendons = dyn_model_ntendons(robot), couplings = present("tendons") - tendons, own = tendons_with_forces(robot);
  effect(DYN_EFFECT_TENDONS, own + couplings,
         std::to_string(own) + " of " + several(tendons, " tendon has", " tendons have") + " forces of their own" +
             (couplings ? ", " + several(couplings, " coupling joins", " couplings join") + " lengths" : ""));
  const int drag = present("fluid"), ellipsoids = present("fluid_ellipsoids"), held = present("gravity_compensation");
  effect(DYN_EFFECT_FLUID, drag, "a medium drags on " + several(drag, " link", " links"));
  effect(DYN_EFFECT_FLUID_ELLIPSOIDS, ellipsoids, "a medium acts on " + several(ellipsoids, " ellipsoid", " ellipsoids"));
  effect(DYN_EFFECT_GRAVITY_COMPENSATION, held, "the weight of " + several(held, " link is", " links is") + " held");
  int followers = 0;
  for (int i = 1; i < robot.njoints; ++i) followers += robot.joint(i).mimic_leader >= 0;
  add("mimic", followers > 0,
      followers ? several(followers, " joint follows", " joints follow") + " another" : "no joint follows another");
  const int trees = present("sleeping");
  add("sleeping", trees && on & DYN_EFFECT_SLEEPING,
      !trees ? type(DYN_EFFECT_SLEEPING).absent
             : several(trees, " tree of bodies", " trees of bodies") + " may sleep" +
                   (on & DYN_EFFECT_SLEEPING ? "" : "; not asked for"));
  return list;
}

}  // namespace cli
