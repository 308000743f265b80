// Sections beside the bodies: <option>, <contact>, and sections that are not used.
#include <algorithm>
#include <cmath>

#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

constexpr std::uint32_t passive = DYN_EFFECT_SPRINGS | DYN_EFFECT_DAMPING | DYN_EFFECT_FLUID | DYN_EFFECT_FLUID_ELLIPSOIDS |
                                  DYN_EFFECT_GRAVITY_COMPENSATION;
constexpr std::pair<std::string_view, std::uint32_t> effects_of_flags[] = {
    {"limit", DYN_EFFECT_LIMITS},
    {"frictionloss", DYN_EFFECT_FRICTION},
    {"spring", DYN_EFFECT_SPRINGS},
    {"damper", DYN_EFFECT_DAMPING},
    {"passive", passive},
    {"actuation", DYN_EFFECT_ACTUATORS},
    {"constraint", DYN_EFFECT_LIMITS | DYN_EFFECT_FRICTION}};

void read_flags(const Reader& reader, MjcfRobot& robot, const Element& flags) {
  for (const tinyxml2::XMLAttribute* a = flags.FirstAttribute(); a; a = a->Next()) {
    const std::string name = a->Name();
    const std::string_view value = a->Value();
    const bool off = value == "disable";
    if (!off && value != "enable")
      reader.fail(DYN_ERROR_PARSE, flags,
                  "<flag " + name + "> is " + load::in_quotes(a->Value()) + ": enable or disable is expected");
    const auto effect =
        std::find_if(std::begin(effects_of_flags), std::end(effects_of_flags), [&](const auto& x) { return x.first == name; });
    if (off && effect != std::end(effects_of_flags)) robot.effects &= ~effect->second;
    if (off && (name == "contact" || name == "constraint")) robot.contacts = false;
    if (off && (name == "equality" || name == "constraint")) robot.closed = false;
    if (name == "filterparent") robot.filter = off ? PairFilter::SameBody : PairFilter::Mujoco;
    if (off && name == "clampctrl") robot.control_ranges = false;
    if (off && name == "gravity") robot.gravity = {0, 0, 0};
    if (effect != std::end(effects_of_flags) || name == "contact" || name == "override" || name == "equality" ||
        name == "clampctrl" || name == "gravity" || name == "filterparent")
      continue;
    reader.report.info(a->GetLineNum(), "<flag " + name + ">: not used");
  }
}

// <flag override>: numbers that all contacts have.
void read_override(const Reader& reader, MjcfRobot& robot, const Element& e) {
  MjcfOverride x{read_mjcf_compliance(reader, e, "o_solref", "o_solimp"), mjcf_rebound(reader, e, "o_solref"), {1, 0.005, 0.0001},
                 reader.optional_number(e, "o_margin").value_or(0)};
  if (const auto given = reader.numbers(e, "o_friction")) {
    constexpr size_t places[] = {0, 2, 3};  // of sliding, torsion and rolling among five
    for (size_t k = 0; k < 3; ++k)
      if (places[k] < given->size()) x.friction[k] = (*given)[places[k]];
  }
  for (const double c : x.friction)
    if (c < 0) reader.bad_numbers(e, "o_friction", "coefficients are not negative");
  if (x.margin < 0) reader.bad_numbers(e, "o_margin", "it is negative");
  robot.override_ = x;
}

void read_integrator(const Reader& reader, MjcfRobot& robot, const Element& e) {
  const char* given = e.Attribute("integrator");
  if (!given) return;
  const std::string_view name = given;
  const char* ours = "semi_implicit_euler";
  if (name == "RK4") robot.integrator = DYN_INTEGRATOR_RK4, ours = "rk4";
  else if (name == "implicit" || name == "implicitfast" || name == "discrete")
    robot.integrator = DYN_INTEGRATOR_IMPLICIT_FAST, ours = "implicit_fast";
  else if (name != "Euler")
    reader.fail(DYN_ERROR_PARSE, e,
                "<option integrator> is " + load::in_quotes(given) +
                    ": Euler, RK4, implicit, implicitfast or discrete is expected");
  reader.report.info(line(e),
                     "<option integrator> is " + std::string(name) + ": steps are those of " + ours + ", the nearest integrator");
}

}  // namespace

void read_mjcf_option(MjcfFile& file, Element& e) {
  const Reader reader = file.source.reader(e, "the model");
  reader.unread(e,
                {"gravity",
                 "timestep",
                 "integrator",
                 "cone",
                 "solver",
                 "iterations",
                 "tolerance",
                 "jacobian",
                 "ls_iterations",
                 "ls_tolerance",
                 "noslip_iterations",
                 "noslip_tolerance",
                 "ccd_iterations",
                 "ccd_tolerance",
                 "sdf_iterations",
                 "sdf_initpoints",
                 "impratio",
                 "apirate",
                 "actuatorgroupdisable",
                 "magnetic",
                 "o_margin",
                 "o_solref",
                 "o_solimp",
                 "o_friction",
                 "wind",
                 "density",
                 "viscosity",
                 "sleep_tolerance"},
                {"flag"});
  if (const auto g = reader.vector3(e, "gravity")) file.robot.gravity = *g;
  if (const auto x = reader.optional_number(e, "density")) file.robot.density = *x;
  if (const auto x = reader.optional_number(e, "viscosity")) file.robot.viscosity = *x;
  if (const auto x = reader.vector3(e, "wind")) file.robot.wind = *x;
  if (const auto x = reader.optional_number(e, "timestep")) {
    if (!(*x > 0)) reader.bad_numbers(e, "timestep", "a positive number of seconds is expected");
    file.robot.timestep = *x;
  }
  if (const auto x = reader.optional_number(e, "impratio")) {
    if (!(*x > 0)) reader.bad_numbers(e, "impratio", "a positive number is expected");
    file.robot.impratio = *x;
  }
  if (const char* cone = e.Attribute("cone")) file.robot.pyramidal = std::string_view(cone) != "elliptic";
  if (const auto magnetic = reader.vector3(e, "magnetic")) file.robot.magnetic = *magnetic;
  read_integrator(reader, file.robot, e);
  bool overrides = false;
  for (const Element* flag : file.source.children(e, "flag")) {
    read_flags(reader, file.robot, *flag);
    if (const char* on = flag->Attribute("override")) overrides = std::string_view(on) == "enable";
  }
  if (overrides) read_override(reader, file.robot, e);
  for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next()) {
    const std::string_view name = a->Name();
    if (name == "actuatorgroupdisable")
      reader.report.physics(a->GetLineNum(),
                            "<option actuatorgroupdisable>: not used: all actuators act; switch them off in the data");
    else if (name != "gravity" && name != "density" && name != "viscosity" && name != "wind" && name != "timestep" &&
             name != "integrator" && name != "magnetic" && name != "impratio" && name != "cone" &&
             !(overrides && name.starts_with("o_")))
      reader.report.info(a->GetLineNum(), "<option " + std::string(name) + ">: not used: the solver is the caller's choice");
  }
}

void read_mjcf_contact(MjcfFile& file, Element& e, const MjcfContext& context) {
  const std::string_view kind = e.Name();
  const Reader reader = file.source.reader(e, "<" + std::string(kind) + ">");
  if (kind == "exclude") {
    reader.unread(e, {"name", "class", "body1", "body2"}, {});
    const auto body = [&](const char* end) { return file.copies.name(context, "body", reader.name(e, end)); };
    file.robot.excludes.push_back({{&reader.report, line(e), reader.owner}, {body("body1"), body("body2")}});
  } else if (kind == "pair") {
    read_mjcf_pair(file, e, context);
  } else {
    reader.report.physics(line(e), "<contact>: element <" + std::string(kind.substr(0, 60)) + "> is not used");
  }
}

void report_mjcf_section(MjcfFile& file, Element& e) {
  const std::string kind = e.Name();
  Report& report = file.source.report(e);
  if (kind == "visual" || kind == "statistic" || kind == "size" || kind == "custom")
    return report.count("<" + kind + ">: not used", line(e));
  for (Element* c : file.source.children(e)) {
    const std::string name = attribute(*c, "name");
    const std::string what = "<" + kind + ">: " + c->Name() + (name.empty() ? "" : " " + load::in_quotes(name));
    report.physics(line(*c), what + " is not used");
  }
}

}  // namespace dyn::load
