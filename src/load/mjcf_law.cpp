// Converts <motor>, <position>, <velocity>, <intvelocity> and <cylinder> to <general>. In MuJoCo all actuators share one set of
// parameters and defaults, of which each kind writes a part. A shortcut continues from <general> or its own kind, and starts anew
// after another kind.
#include <algorithm>

#include "mjcf_settings.hpp"

namespace dyn::load {

namespace {

constexpr std::string_view law_kinds[] = {"general", "motor", "position", "velocity", "intvelocity", "cylinder"};
constexpr const char* shortcuts[] = {"kp", "kv", "dampratio", "timeconst", "area", "diameter", "bias"};

// Numbers of an attribute, to be modified and written back.
struct Parameters {
  Element& e;
  const char* attribute;
  std::vector<double> x;

  Parameters(const Reader& reader, Element& element, const char* name, double first)
      : e(element), attribute(name), x(reader.numbers(e, name).value_or(std::vector<double>())) {
    for (size_t k = x.size(); k < 3; ++k) x.push_back(k == 0 ? first : 0);
  }
  void write() {
    std::string all;
    for (const double number : x) all += (all.empty() ? "" : " ") + text(number);
    e.SetAttribute(attribute, all.c_str());
  }
};

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
  if (before != kind && (before != "general" || kind != "cylinder")) e.DeleteAttribute("dyntype"), e.DeleteAttribute("dynprm");
  Parameters gain(reader, e, "gainprm", 1), bias(reader, e, "biasprm", 0), dynamics(reader, e, "dynprm", 1);
  const auto number = [&](const char* attribute) { return reader.optional_number(e, attribute); };
  const auto activation = [&](const char* type) { e.SetAttribute("dyntype", type); };
  std::fill(gain.x.begin() + 1, gain.x.end(), 0.0);
  if (kind == "motor") {
    gain.x[0] = 1;
    activation("none");
  } else if (kind == "velocity") {
    bias.x[0] = bias.x[1] = 0;
    gain.x[0] = number("kv").value_or(gain.x[0]), bias.x[2] = -gain.x[0];
    activation("none");
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
  e.SetAttribute("gaintype", "fixed"), e.SetAttribute("biastype", kind == "motor" ? "none" : "affine");
  gain.write(), bias.write(), dynamics.write();
  for (const char* s : shortcuts) e.DeleteAttribute(s);
}

}  // namespace dyn::load
