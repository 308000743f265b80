// Sections beside the bodies: <option>, <contact>, <keyframe>, and sections that are not used.
#include <algorithm>
#include <cmath>

#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

std::string attribute(const Element& e, const char* name) { return e.Attribute(name) ? e.Attribute(name) : ""; }

}  // namespace

void read_mjcf_option(MjcfFile& file, Element& e) {
  const Reader reader = file.source.reader(e, "the model");
  reader.unread(e, {"gravity", "timestep", "integrator", "cone", "solver", "iterations", "tolerance", "jacobian", "ls_iterations", "ls_tolerance", "noslip_iterations",
                    "noslip_tolerance", "ccd_iterations", "ccd_tolerance", "sdf_iterations", "sdf_initpoints", "impratio", "apirate", "actuatorgroupdisable", "magnetic",
                    "o_margin", "o_solref", "o_solimp", "o_friction", "wind", "density", "viscosity", "sleep_tolerance"}, {"flag"});
  if (const auto g = reader.vector3(e, "gravity")) file.robot.gravity = *g;
  if (const auto x = reader.optional_number(e, "density")) file.robot.density = *x;
  if (const auto x = reader.optional_number(e, "viscosity")) file.robot.viscosity = *x;
  if (const auto x = reader.vector3(e, "wind")) file.robot.wind = *x;
  for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next()) {
    const std::string_view name = a->Name();
    if (name == "actuatorgroupdisable") reader.report.physics(a->GetLineNum(), "<option actuatorgroupdisable>: not used: all actuators act; switch them off in the data");
    else if (name != "gravity" && name != "density" && name != "viscosity" && name != "wind")
      reader.report.info(a->GetLineNum(), "<option " + std::string(name) + ">: not used: steps and solvers are the caller's choice");
  }
  for (const Element* flag : file.source.children(e, "flag"))
    for (const tinyxml2::XMLAttribute* a = flag->FirstAttribute(); a; a = a->Next()) {
      const std::string name = a->Name();
      const std::string_view value = a->Value();
      const bool off = value == "disable";
      if (!off && value != "enable") reader.fail(DYN_ERROR_PARSE, *flag, "<flag " + name + "> is " + load::quoted(a->Value()) + ": enable or disable is expected");
      const auto is = [&](std::initializer_list<std::string_view> names) { return std::find(names.begin(), names.end(), name) != names.end(); };
      if (name == "gravity") {
        if (off) file.robot.gravity = {0, 0, 0};
      } else if (off && is({"contact", "limit", "constraint", "frictionloss", "spring", "damper", "passive", "actuation", "equality"})) {
        reader.report.physics(a->GetLineNum(), "<flag " + name + "=\"disable\">: not used: switch effects off in the data");
      } else if (name == "filterparent") {
        file.robot.filter = off ? PairFilter::SameBody : PairFilter::Mujoco;
      } else if (off && is({"clampctrl"})) {
        reader.report.physics(a->GetLineNum(), "<flag " + name + "=\"disable\">: not used");
      } else {
        reader.report.info(a->GetLineNum(), "<flag " + name + ">: not used");
      }
    }
}

void read_mjcf_contact(MjcfFile& file, Element& e, const MjcfContext& context) {
  for (Element* c : file.source.children(e)) {
    const std::string_view kind = c->Name();
    const Reader reader = file.source.reader(*c, "<" + std::string(kind) + ">");
    if (kind == "exclude") {
      reader.unread(*c, {"name", "class", "body1", "body2"}, {});
      file.robot.excludes.push_back({{&reader.report, line(*c), reader.owner}, {context.name(reader.name(*c, "body1")), context.name(reader.name(*c, "body2"))}});
    } else if (kind == "pair") {
      read_mjcf_pair(file, *c, context);
    } else {
      reader.report.physics(line(*c), "<contact>: element <" + std::string(kind.substr(0, 60)) + "> is not used");
    }
  }
}

void read_mjcf_keys(MjcfFile& file, Element& e, const MjcfContext& context) {
  for (Element* c : file.source.children(e, "key")) {
    std::string name = attribute(*c, "name");
    if (name.empty()) name = "key_" + std::to_string(file.robot.keys.size());
    name = context.name(name);
    const Reader reader = file.source.reader(*c, "key " + load::quoted(name));
    reader.unread(*c, {"name", "class", "qpos", "time", "qvel", "act", "ctrl", "mpos", "mquat"}, {});
    for (const char* unused : {"qvel", "act", "ctrl", "mpos", "mquat"})
      if (c->Attribute(unused)) reader.report.info(line(*c), reader.owner + ": " + unused + " is not used: a configuration holds q alone");
    MjcfKey key{{&reader.report, line(*c), reader.owner}, name, {}};
    if (const auto q = reader.numbers(*c, "qpos")) key.qpos = *q;
    if (!key.qpos.empty()) file.robot.keys.push_back(std::move(key));
  }
}

void report_mjcf_section(MjcfFile& file, Element& e) {
  const std::string kind = e.Name();
  Report& report = file.source.report(e);
  if (kind == "visual" || kind == "statistic" || kind == "size" || kind == "custom") return report.count("<" + kind + ">: not used", line(e));
  for (Element* c : file.source.children(e)) {
    const std::string name = attribute(*c, "name");
    const std::string what = "<" + kind + ">: " + c->Name() + (name.empty() ? "" : " " + load::quoted(name));
    if (kind == "sensor") report.count("<sensor>: not used", line(*c));
    else if (kind == "tendon") report.physics(line(*c), what + " is not used");
    else report.physics(line(*c), what + " is not used");
  }
}

}  // namespace dyn::load
