// MJCF to model: read all files, give the bodies their masses, build.
#include "dyn/model/load.hpp"
#include "mjcf_robot.hpp"

namespace dyn {

namespace load {

namespace {

// Of a model that is attached: its bodies, or one of them by name.
void read_world(MjcfFile& file, Element& world, const MjcfContext& context, const char* body) {
  if (!body) return read_mjcf_content(file, world, context);
  for (Element* c : file.source.children(world, "body"))
    if (c->Attribute("name") && std::string_view(c->Attribute("name")) == body) return read_mjcf_body(file, *c, context);
  file.source.report(world).fail(DYN_ERROR_NAME, line(world), "there is no body " + load::quoted(body) + " in the world of the model that is attached");
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
  each("compiler", [&](Element& e) { read_compiler(source, e, file.compiler); });
  if (main) file.robot.compiler = file.compiler;
  each("default", [&](Element& e) { file.defaults.read(source, e); });
  each("option", [&](Element& e) {
    if (main) read_mjcf_option(file, e);
    else source.report(e).info(line(e), "<option> of an attached model: not used");
  });
  each("asset", [&](Element& e) { file.assets.add(e, file.defaults); });
  each("worldbody", [&](Element& e) { read_world(file, e, context, body); });
  each("contact", [&](Element& e) { read_mjcf_contact(file, e, context); });
  each("actuator", [&](Element& e) { read_mjcf_actuators(file, e, context); });
  each("equality", [&](Element& e) { read_mjcf_equalities(file, e, context); });
  each("keyframe", [&](Element& e) {
    if (main) read_mjcf_keys(file, e, context);
    else source.report(e).info(line(e), "<keyframe> of an attached model: not used");
  });
  for (Element* e : sections) {
    const std::string_view name = e->Name();
    if (name != "compiler" && name != "default" && name != "option" && name != "asset" && name != "worldbody" && name != "contact" && name != "keyframe" && name != "actuator" &&
        name != "equality")
      report_mjcf_section(file, *e);
  }
}

}  // namespace load

ModelPtr load_mjcf(const std::string& text, const std::string& file, const LoadOptions& options) {
  using namespace load;
  MjcfSource source(text, file, options);
  Element& root = source.root();
  const Reader reader = source.reader(root, "the model");
  reader.unread(root, {"model"}, {"compiler", "option", "size", "visual", "statistic", "default", "custom", "asset", "worldbody", "deformable", "contact", "equality",
                                  "tendon", "actuator", "sensor", "keyframe", "extension", "include", "statistics"});
  MjcfRobot robot;
  robot.name = root.Attribute("model") && *root.Attribute("model") ? root.Attribute("model") : "MuJoCo Model";
  if (options.base != DYN_BASE_UNSPECIFIED) reader.report.info(0, "the base is as the file says: an MJCF model has free joints");
  if (options.cos_sin) reader.report.info(0, "joints have angles: (cos, sin) is an option for URDF");
  if (!options.srdf.empty()) reader.fail(DYN_ERROR_UNSUPPORTED, root, "an SRDF belongs to a URDF");
  MjcfBody world;
  world.name = "world", world.place = {&reader.report, line(root), "the world"}, world.X = SE3<double>::identity();
  robot.bodies.push_back(std::move(world));
  MjcfFile main(source, robot, options);
  read_mjcf_file(main, root, MjcfContext());
  if (options.gravity != LoadOptions().gravity) robot.gravity = options.gravity;
  return build_mjcf(robot, source, options);
}

}  // namespace dyn
