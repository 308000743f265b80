// <body>, <frame>, <replicate>, <attach>, <site>: the tree of an MJCF model.
#include <cmath>
#include <memory>

#include "mjcf_robot.hpp"
#include "shape_form.hpp"

namespace dyn::load {

namespace {

constexpr int most_replicas = 10000000, max_copies = 100;

// Type and sizes of a site, which sensors read. Sizes that are not given are 5 mm; half: of its length, where its ends are given.
void read_zone(const Reader& reader, const Element& e, const std::optional<double>& half, MjcfSite& site) {
  const std::string type = attribute(e, "type");
  const auto form = shape_form(RobotFormat::Mjcf, type.empty() ? "sphere" : type);
  if (!form) return;
  std::array<double, 3> size = {0.005, 0.005, 0.005};
  if (const auto given = reader.numbers(e, "size"))
    for (size_t k = 0; k < std::min<size_t>(given->size(), 3); ++k) size[k] = (*given)[k];
  if (half) form->sizes == 2 ? size[1] = *half : (size[1] = size[0], size[2] = *half);
  site.shape = form->type;
  for (size_t k = 0; k < 3; ++k) site.extent[k] = k < form->sizes ? std::max(0.0, size[k]) / form->factor[k] : 0;
}

void read_site(MjcfFile& file, Element& e, const MjcfContext& context) {
  MjcfBody& body = file.robot.bodies[size_t(context.body)];
  file.defaults.apply(file.source, e, "site", context.childclass);
  MjcfSite site;
  site.name = context.name(attribute(e, "name"));
  const Reader reader =
      file.source.reader(e, site.name.empty() ? body.place.owner + ": a site" : "site " + load::in_quotes(site.name));
  site.place = {&reader.report, line(e), reader.owner};
  SE3<double> X = read_pose(reader, e, file.compiler);
  std::optional<double> half;
  if (const auto ends = reader.numbers(e, "fromto", 6)) {
    const Vec3<double> from = load3(ends->data()), to = load3(ends->data() + 3), d = from - to;
    const double length = std::sqrt(dot(d, d));
    if (!(length > 1e-12)) reader.bad_numbers(e, "fromto", "both ends are the same point");
    X = {turn_z_to(d * (1 / length)), (from + to) * 0.5}, half = length / 2;
  }
  site.X = context.X * X;
  read_zone(reader, e, half, site);
  if (!site.name.empty()) body.sites.push_back(std::move(site)), file.robot.names.reset();
}

// Elements whose content is read next, each with its context; the last one comes first. A list, so that nesting needs no
// recursion.
struct Todo {
  Element* e;
  std::shared_ptr<const MjcfContext> context;
};
using TodoList = std::vector<Todo>;
void add_content(MjcfFile& file, Element& e, MjcfContext context, TodoList& todo) {
  const std::vector<Element*> children = file.source.children(e);
  const std::int64_t names = std::int64_t(context.childclass.size() + 4 * (context.prefix.size() + context.suffix.size()));
  file.source.charge(&Budget::add_bytes, bytes_of_element + (bytes_of_part + names) * std::int64_t(children.size()), e);
  const auto shared = std::make_shared<const MjcfContext>(std::move(context));
  for (auto c = children.rbegin(); c != children.rend(); ++c) todo.push_back({*c, shared});
}

void read_frame(MjcfFile& file, Element& e, MjcfContext context, TodoList& todo) {
  const Reader reader = file.source.reader(e, "a <frame>");
  reader.unread(e, {"name", "childclass", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"},
                {"body", "geom", "site", "joint", "freejoint", "camera", "light", "frame", "replicate", "attach", "flexcomp",
                 "composite", "inertial", "plugin"});
  context.X = context.X * read_pose(reader, e, file.compiler);
  context.childclass = file.defaults.around(file.source, e, context.childclass);
  add_content(file, e, std::move(context), todo);
}

// Each replica is offset from the previous one and rotated by its number times the angles. Its number ends its names.
void read_replicate(MjcfFile& file, Element& e, MjcfContext context, TodoList& todo) {
  const Reader reader = file.source.reader(e, "a <replicate>");
  reader.unread(e, {"count", "sep", "offset", "euler", "childclass"},
                {"body", "geom", "site", "joint", "freejoint", "camera", "light", "frame", "replicate", "attach", "flexcomp",
                 "composite", "plugin"});
  const double count = reader.number(e, "count");
  if (!(count >= 1 && count <= most_replicas && count == std::floor(count)))
    reader.bad_numbers(e, "count", "an integer from 1 to " + std::to_string(most_replicas) + " is expected");
  context.replicas *= count;
  const LoadLimits& limits = file.options.limits;
  if (context.replicas > double(limits.bodies + limits.shapes))
    reader.fail(DYN_ERROR_LIMIT, e,
                "it asks for " + text(context.replicas) + " copies, and the limits are " + std::to_string(limits.bodies) +
                    " bodies and " + std::to_string(limits.shapes) + " shapes: raise max_bodies if the file is trusted");
  const auto offset = reader.vector3(e, "offset").value_or(std::array<double, 3>{0, 0, 0}),
             angles = reader.vector3(e, "euler").value_or(std::array<double, 3>{0, 0, 0});
  const SE3<double> first = context.X;
  SE3<double> place = SE3<double>::identity();
  context.childclass = file.defaults.around(file.source, e, context.childclass);
  const std::string separator = attribute(e, "sep"), outer = context.suffix;
  context.replicate = &e;
  const size_t digits = std::to_string(int(count) - 1).size();
  const std::int64_t names = std::int64_t(separator.size() + context.prefix.size() + outer.size() + context.childclass.size());
  file.source.charge(&Budget::add_bytes, (bytes_of_element + 2 * names) * std::int64_t(count), e);
  std::vector<MjcfContext> replicas;
  for (int k = 0; k < int(count); ++k) {
    const std::string number = std::to_string(k);
    context.suffix = separator + std::string(digits - number.size(), '0') + number + outer;
    context.X = first * place;
    replicas.push_back(context);
    place.p = place.act(load3(offset.data()));
    place.R = from_euler({angles[0] * (k + 1), angles[1] * (k + 1), angles[2] * (k + 1)}, file.compiler);
  }
  for (auto replica = replicas.rbegin(); replica != replicas.rend(); ++replica) add_content(file, e, std::move(*replica), todo);
}

bool has_joint(const Element& e) {
  for (const Element* c = first(e); c; c = next(*c))
    if (std::string_view(c->Name()).ends_with("joint") || has_joint(*c)) return true;
  return false;
}

// Another copy of a body or frame of the same model.
void attach_own(MjcfFile& file, Element& e, MjcfContext context) {
  const Reader reader = file.source.reader(e, "an <attach>");
  const char* kind = e.Attribute("body") ? "body" : "frame";
  const std::string name = reader.name(e, kind);
  if (++context.copies > max_copies) reader.fail(DYN_ERROR_LIMIT, e, "it attaches itself");
  context.prefix += attribute(e, "prefix");
  for (Element* world : file.source.children(file.source.root(), "worldbody"))
    if (const Element* copied = read_mjcf_named(file, *world, context, kind, name)) {
      if (has_joint(*copied))
        reader.report.physics(line(e), reader.owner + ": tendons, actuators and constraints of the copy are not used");
      return;
    }
  reader.fail(DYN_ERROR_NAME, e, "there is no " + std::string(kind) + " " + load::in_quotes(name) + " in the model");
}

void read_attach(MjcfFile& file, Element& e, MjcfContext context) {
  const Reader reader = file.source.reader(e, "an <attach>");
  reader.unread(e, {"model", "body", "frame", "prefix"}, {});
  if (!e.Attribute("model")) return attach_own(file, e, std::move(context));
  if (e.Attribute("frame")) reader.fail(DYN_ERROR_UNSUPPORTED, e, "a frame of another model is not supported: attach a body");
  const Element& asset = file.assets.model(e, reader.name(e, "model"));
  Element& root = file.source.open_model(asset, reader.name(asset, "file"));
  MjcfFile child(file.source, file.robot, file.options);
  context.prefix += attribute(e, "prefix");
  context.childclass.clear();
  read_mjcf_file(child, root, context, e.Attribute("body"));
  file.source.close_model();
}

// Adds the body, and its content to what comes next.
void read_body(MjcfFile& file, Element& e, const MjcfContext& context, TodoList& todo) {
  MjcfRobot& robot = file.robot;
  const int at = int(robot.bodies.size());
  MjcfBody body;
  body.name = context.name(attribute(e, "name"));
  if (body.name.empty()) body.name = "body_" + std::to_string(at);
  body.parent = context.body;
  const Reader reader = file.source.reader(e, "body " + load::in_quotes(body.name));
  body.place = {&reader.report, line(e), reader.owner};
  file.source.charge(&Budget::add_bodies, 1, e);
  reader.unread(
      e, {"name", "childclass", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "user", "mocap", "sleep", "gravcomp"},
      {"inertial", "joint", "freejoint", "geom", "site", "camera", "light", "body", "frame", "replicate", "attach", "composite",
       "flexcomp", "plugin"});
  if (read_switch(reader, e, "mocap", false).value_or(false)) {
    if (context.body != 0) reader.fail(DYN_ERROR_INVALID, e, "a mocap body is a child of the world");
    if (!file.source.children(e, "joint").empty() || !file.source.children(e, "freejoint").empty())
      reader.fail(DYN_ERROR_INVALID, e, "a mocap body has no joints");
    body.mocap = true;
  }
  if (attribute(e, "sleep") == "init") body.place.physics("it does not begin asleep");
  if (body.name == "world" || body.name == "universe") reader.fail(DYN_ERROR_NAME, e, "the world has this name");
  body.X = context.X * read_pose(reader, e, file.compiler);
  body.rules = file.compiler.masses;
  body.compensation = reader.optional_number(e, "gravcomp").value_or(0);
  if (const auto inertials = file.source.children(e, "inertial"); !inertials.empty()) {
    if (inertials.size() > 1) reader.fail(DYN_ERROR_INVALID, *inertials[1], "a second <inertial>");
    body.inertial = read_mjcf_inertial(file, *inertials[0], reader.owner);
  }
  MjcfContext inside = context;
  inside.body = at, inside.X = SE3<double>::identity();
  inside.childclass = file.defaults.around(file.source, e, context.childclass);
  robot.bodies.push_back(std::move(body)), robot.names.reset();
  add_content(file, e, std::move(inside), todo);
}

void read_unsupported(MjcfFile& file, const Element& e, const MjcfContext& context) {
  const std::string kind = e.Name();
  file.source.report(e).physics(line(e), "<" + kind + "> is not used: what it would make is missing from the model");
  if (kind == "plugin") return;
  file.robot.lost_mass = true;
  const std::string begin = context.prefix + (kind == "flexcomp" ? attribute(e, "name") + "_" : attribute(e, "prefix"));
  file.robot.lost_names.insert(begin), file.robot.lost_lengths.insert(begin.size());
}

void read_all(MjcfFile& file, TodoList todo) {
  while (!todo.empty()) {
    const Todo next = std::move(todo.back());
    todo.pop_back();
    Element& e = *next.e;
    const MjcfContext& context = *next.context;
    const std::string_view kind = e.Name();
    if (!context.suffix.empty()) file.copies.add(e, context);
    if (kind == "body") read_body(file, e, context, todo);
    else if (kind == "joint" || kind == "freejoint") read_mjcf_joint(file, e, context);
    else if (kind == "geom") read_mjcf_geom(file, e, context);
    else if (kind == "site") read_site(file, e, context);
    else if (kind == "frame") read_frame(file, e, context, todo);
    else if (kind == "replicate") read_replicate(file, e, context, todo);
    else if (kind == "attach") read_attach(file, e, context);
    else if (kind == "camera" || kind == "light") file.source.report(e).count("<" + std::string(kind) + ">: not used", line(e));
    else if (kind == "composite" || kind == "flexcomp" || kind == "plugin") read_unsupported(file, e, context);
  }
}

}  // namespace

void read_mjcf_body(MjcfFile& file, Element& e, const MjcfContext& context) {
  read_all(file, {{&e, std::make_shared<const MjcfContext>(context)}});
}

const Element* read_mjcf_named(MjcfFile& file, Element& e, MjcfContext context, std::string_view kind, std::string_view name) {
  struct Level {
    Element* e;
    std::string childclass;
  };
  std::vector<Level> todo;  // the next one last
  const auto add = [&](Element& of, const std::string& around) {
    const std::vector<Element*> children = file.source.children(of);
    file.source.charge(&Budget::add_bytes, bytes_of_visit * std::int64_t(children.size()) / 4, of);
    for (auto c = children.rbegin(); c != children.rend(); ++c) todo.push_back({*c, around});
  };
  add(e, file.defaults.around(file.source, e, context.childclass));
  while (!todo.empty()) {
    const Level at = std::move(todo.back());
    todo.pop_back();
    const std::string_view is = at.e->Name();
    if (is == kind && attribute(*at.e, "name") == name) {
      context.childclass = at.childclass;
      return read_mjcf_body(file, *at.e, context), at.e;
    }
    if (is == "body" || is == "frame") add(*at.e, file.defaults.around(file.source, *at.e, at.childclass));
  }
  return nullptr;
}

void read_mjcf_content(MjcfFile& file, Element& e, const MjcfContext& context) {
  TodoList todo;
  add_content(file, e, context, todo);
  read_all(file, std::move(todo));
}

}  // namespace dyn::load
