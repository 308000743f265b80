// MJCF to model: reads all files, computes the masses of bodies, builds.
#include <algorithm>
#include <set>
#include <tuple>

#include "model/load.hpp"
#include "mjcf_robot.hpp"

namespace dyn {

namespace load {

namespace {

// Reads an attached model: all its bodies, or one by name.
void read_world(MjcfFile& file, Element& world, const MjcfContext& context, const char* body) {
  if (!body) return read_mjcf_content(file, world, context);
  if (!read_mjcf_named(file, world, context, "body", body))
    file.source.report(world).fail(DYN_ERROR_NAME, line(world),
                                   "there is no body " + load::in_quotes(body) + " in the model that is attached");
}

// Drops contacts and equalities that refer to parts of an attached model that were not attached.
void drop_unresolved_references(MjcfRobot& robot, size_t excludes, size_t pairs, size_t equalities) {
  std::set<std::string> bodies, joints, sites, geoms, tendons;
  for (const MjcfBody& b : robot.bodies) {
    bodies.insert(b.name);
    for (const MjcfJoint& j : b.joints) joints.insert(j.spec.name);
    for (const MjcfSite& s : b.sites) sites.insert(s.name);
    for (const MjcfGeom& g : b.geoms) geoms.insert(g.shape.name);
  }
  for (const MjcfTendon& t : robot.tendons) tendons.insert(t.name);
  const auto keep_known = [](auto& list, size_t first, auto&& names_of) {
    list.erase(std::remove_if(list.begin() + std::ptrdiff_t(first), list.end(), [&](const auto& x) {
      const auto [all, a, b] = names_of(x);
      if (all->count(a) && (b.empty() || all->count(b))) return false;
      x.place.info("it refers to a part that was not attached: left out");
      return true;
    }), list.end());
  };
  using Named = std::tuple<const std::set<std::string>*, std::string, std::string>;
  keep_known(robot.excludes, excludes, [&](const MjcfExclude& x) { return Named(&bodies, x.bodies[0], x.bodies[1]); });
  keep_known(robot.pairs, pairs, [&](const MjcfPair& x) { return Named(&geoms, x.geoms[0], x.geoms[1]); });
  keep_known(robot.equalities, equalities, [&](const MjcfEquality& x) {
    return Named(x.kind == "joint" ? &joints : x.kind == "tendon" ? &tendons : x.sites ? &sites : &bodies, x.first, x.second);
  });
}

}  // namespace

void read_mjcf_file(MjcfFile& file, Element& root, const MjcfContext& context, const char* body) {
  MjcfSource& source = file.source;
  const auto sections = source.children(root);
  const auto each = [&](std::string_view name, const auto& f) {
    for (Element* e : sections)
      if (e->Name() == name) f(*e);
  };
  const bool main = &root == &source.root();
  const size_t excludes = file.robot.excludes.size(), pairs = file.robot.pairs.size(), equalities = file.robot.equalities.size();
  file.part = body;
  each("compiler", [&](Element& e) { read_compiler(source, e, file.compiler); });
  if (main) file.robot.compiler = file.compiler;
  each("default", [&](Element& e) { file.defaults.read(source, e); });
  each("option", [&](Element& e) {
    if (main) read_mjcf_option(file, e);
    else source.report(e).info(line(e), "<option> of an attached model: not used");
  });
  each("asset", [&](Element& e) { file.assets.add(e, file.defaults); });
  each("worldbody", [&](Element& e) { read_world(file, e, context, body); });
  each("contact", [&](Element& e) { file.copies.read_section(file, e, context, read_mjcf_contact); });
  each("tendon", [&](Element& e) { file.copies.read_section(file, e, context, read_mjcf_tendon); });
  each("actuator", [&](Element& e) { file.copies.read_section(file, e, context, read_mjcf_actuator); });
  each("sensor", [&](Element& e) { file.copies.read_section(file, e, context, read_mjcf_sensor); });
  each("equality", [&](Element& e) { file.copies.read_section(file, e, context, read_mjcf_equality); });
  if (file.part) drop_unresolved_references(file.robot, excludes, pairs, equalities);
  each("keyframe", [&](Element& e) {
    if (main) read_mjcf_keys(file, e, context);
    else source.report(e).info(line(e), "<keyframe> of an attached model: not used");
  });
  for (Element* e : sections) {
    const std::string_view name = e->Name();
    if (name != "compiler" && name != "default" && name != "option" && name != "asset" && name != "worldbody" &&
        name != "contact" && name != "keyframe" && name != "tendon" && name != "actuator" && name != "equality" &&
        name != "sensor")
      report_mjcf_section(file, *e);
  }
}

}  // namespace load

ModelPtr load_mjcf(const std::string& text, const std::string& file, const LoadOptions& options) {
  using namespace load;
  MjcfSource source(text, file, options);
  load::Element& root = source.root();
  const Reader reader = source.reader(root, "the model");
  reader.unread(root, {"model"},
                {"compiler", "option", "size", "visual", "statistic", "default", "custom", "asset", "worldbody", "deformable",
                 "contact", "equality", "tendon", "actuator", "sensor", "keyframe", "extension", "include", "statistics"});
  MjcfRobot robot;
  robot.name = root.Attribute("model") && *root.Attribute("model") ? root.Attribute("model") : "MuJoCo Model";
  if (options.base != DYN_BASE_UNSPECIFIED) reader.report.info(0, "the option base is not used: an MJCF model has free joints");
  if (options.cos_sin) reader.report.info(0, "the option cos_sin is not used: it is for URDF");
  if (!options.srdf.empty()) reader.fail(DYN_ERROR_UNSUPPORTED, root, "the option srdf is for URDF: omit it");
  robot.budget = options.budget;
  MjcfBody world;
  world.name = "world", world.place = {&reader.report, line(root), "the world"}, world.X = SE3<double>::identity();
  robot.bodies.push_back(std::move(world));
  MjcfFile main(source, robot, options);
  read_mjcf_file(main, root, MjcfContext());
  if (options.gravity != LoadOptions().gravity) robot.gravity = options.gravity;
  return build_mjcf(robot, source, options);
}

}  // namespace dyn
