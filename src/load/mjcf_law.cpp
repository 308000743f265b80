// Converts <motor>, <position>, <velocity>, <intvelocity>, <damper>, <cylinder>, <muscle> and <adhesion> to <general>.
// In MuJoCo all actuators share
// one set of parameters and defaults, of which each kind writes a part. A shortcut continues from <general> or its own kind, and
// starts anew after another kind.
#include <algorithm>
#include <utility>

#include "mjcf_settings.hpp"

namespace dyn::load {

namespace {

constexpr std::string_view law_kinds[] = {"general", "motor", "position", "velocity", "intvelocity",
                                         "damper",  "cylinder", "muscle", "adhesion", "pid", "dcmotor"};
constexpr const char* shortcuts[] = {"kp",   "kv",    "dampratio", "timeconst", "area", "diameter", "bias", "tausmooth", "range",
                                     "force", "scale", "lmin",      "lmax",      "vmax", "fpmax",    "fvmax", "gain"};
// Parameters of a muscle behind its range, and their defaults.
constexpr std::pair<const char*, double> muscle_gains[] = {{"force", -1}, {"scale", 200}, {"lmin", 0.5}, {"lmax", 1.6},
                                                           {"vmax", 1.5}, {"fpmax", 1.3}, {"fvmax", 1.2}};

// Numbers of an attribute, to be modified and written back.
struct Parameters {
  Element& e;
  const char* attribute;
  std::vector<double> x;

  Parameters(const Reader& reader, Element& element, const char* name, double first, size_t count)
      : e(element), attribute(name), x(reader.numbers(e, name).value_or(std::vector<double>())) {
    for (size_t k = x.size(); k < count; ++k) x.push_back(k == 0 ? first : 0);
  }
  void write() {
    std::string all;
    for (const double number : x) all += (all.empty() ? "" : " ") + text(number);
    e.SetAttribute(attribute, all.c_str());
  }
};

// Sets the parameters of a muscle. Numbers that are those of a plain <general> become a muscle's defaults.
void set_muscle(const Reader& reader, const Element& e, std::vector<double>& gain, std::vector<double>& dynamics) {
  const auto settle = [](double& x, double unset, double standard, double given) {
    if (x == unset) x = standard;
    if (given >= 0) x = given;
  };
  const std::vector<double> none = {-1, -1}, range = reader.numbers(e, "range", 2).value_or(none),
                            times = reader.numbers(e, "timeconst", 2).value_or(none);
  settle(dynamics[0], 1, 0.01, times[0]), settle(dynamics[1], 0, 0.04, times[1]);
  dynamics[2] = reader.optional_number(e, "tausmooth").value_or(dynamics[2]);
  settle(gain[0], 1, 0.75, range[0]), settle(gain[1], 0, 1.05, range[1]);
  for (size_t k = 0; k < std::size(muscle_gains); ++k) {
    const auto& [attribute, standard] = muscle_gains[k];
    settle(gain[2 + k], 0, standard, reader.optional_number(e, attribute).value_or(-1));
  }
}

}  // namespace

bool is_actuator(const Element& e) {
  return std::find(std::begin(law_kinds), std::end(law_kinds), e.Name()) != std::end(law_kinds);
}

void as_general(const Reader& reader, Element& e) {
  const std::string_view kind = e.Name();
  const std::string before = e.Attribute(converted_from) ? e.Attribute(converted_from) : "general";
  e.SetAttribute(converted_from, e.Name());
  if (kind == "general") return;
  if (before != kind && before != "general") e.DeleteAttribute("gainprm"), e.DeleteAttribute("biasprm");
  if (kind == "pid" || kind == "dcmotor") return;  // mjcf_driver.cpp
  const bool muscle = kind == "muscle",
             keeps_dynamics = before == kind || (before == "general" && (muscle || kind == "cylinder"));
  if (!keeps_dynamics) e.DeleteAttribute("dyntype"), e.DeleteAttribute("dynprm");
  const size_t count = muscle ? 9 : 3;
  Parameters gain(reader, e, "gainprm", 1, count), bias(reader, e, "biasprm", 0, count), dynamics(reader, e, "dynprm", 1, 3);
  const auto number = [&](const char* attribute) { return reader.optional_number(e, attribute); };
  const auto activation = [&](const char* type) { e.SetAttribute("dyntype", type); };
  if (!muscle && kind != "damper") std::fill(gain.x.begin() + 1, gain.x.end(), 0.0);
  if (muscle) {
    set_muscle(reader, e, gain.x, dynamics.x);
    bias.x = gain.x;
    activation("muscle");
  } else if (kind == "motor") {
    gain.x[0] = 1;
    activation("none");
  } else if (kind == "velocity") {
    bias.x[0] = bias.x[1] = 0;
    gain.x[0] = number("kv").value_or(gain.x[0]), bias.x[2] = -gain.x[0];
    activation("none");
  } else if (kind == "damper") {
    gain.x[0] = gain.x[1] = 0, gain.x[2] = -number("kv").value_or(before == kind ? -gain.x[2] : 0);
    if (gain.x[2] > 0) reader.bad_numbers(e, "kv", "it is negative");
    activation("none"), e.SetAttribute("ctrllimited", "true");
  } else if (kind == "adhesion") {
    gain.x[0] = number("gain").value_or(gain.x[0]);
    if (gain.x[0] < 0) reader.bad_numbers(e, "gain", "it is negative");
    e.SetAttribute("ctrllimited", "true");
  } else if (kind == "cylinder") {
    const auto diameter = number("diameter");
    gain.x[0] = diameter ? 0.78539816339744831 * *diameter * *diameter : number("area").value_or(gain.x[0]);
    if (const auto given = reader.numbers(e, "bias", 3)) std::copy(given->begin(), given->end(), bias.x.begin());
    dynamics.x[0] = number("timeconst").value_or(dynamics.x[0]);
    activation("filter");
  } else {
    gain.x[0] = number("kp").value_or(gain.x[0]), bias.x[0] = 0, bias.x[1] = -gain.x[0];
    const auto kv = number("kv"), ratio = number("dampratio");
    if (kv && ratio) reader.fail(DYN_ERROR_INVALID, e, "it has kv and dampratio: give one of them");
    if (kv && !(*kv >= 0)) reader.bad_numbers(e, "kv", "it is negative");
    if (ratio && !(*ratio >= 0)) reader.bad_numbers(e, "dampratio", "it is negative");
    if (kv || ratio) bias.x[2] = kv ? -*kv : *ratio;  // a positive number stands for a ratio
    if (kind == "intvelocity") {
      activation("integrator");
    } else if (const auto time = number("timeconst")) {
      dynamics.x[0] = *time;
      activation(*time == 0 ? "none" : "filterexact");
    }
  }
  const bool no_bias = kind == "motor" || kind == "damper" || kind == "adhesion";
  e.SetAttribute("gaintype", muscle ? "muscle" : kind == "damper" ? "affine" : "fixed"),
      e.SetAttribute("biastype", muscle ? "muscle" : no_bias ? "none" : "affine");
  gain.write(), bias.write(), dynamics.write();
  for (const char* s : shortcuts) e.DeleteAttribute(s);
}

}  // namespace dyn::load
