// <tendon>: weighted sums of joint coordinates, and paths through sites and around geoms.
#include <algorithm>
#include <limits>

#include "mjcf_robot.hpp"
#include "mjcf_wrap.hpp"

namespace dyn::load {

namespace {

dynTendon plain_tendon(dynTendonType type) {
  constexpr double none = std::numeric_limits<double>::infinity(), of_the_file = std::numeric_limits<double>::quiet_NaN();
  dynTendon t{};
  t.struct_size = sizeof t, t.type = type;
  t.rest[0] = t.rest[1] = of_the_file, t.range[0] = -none, t.range[1] = none;
  return t;
}

// Reads the children of a tendon. A part that an element names may be missing because it is not supported, or not attached.
struct PathReader {
  MjcfFile& file;
  const Reader& reader;
  const MjcfContext& context;
  bool lost = false, not_attached = false;

  std::string name(const Element& e, const char* kind, const char* attribute) const {
    return file.copies.name(context, kind, reader.name(e, attribute));
  }
  void missing(const Element& e, const char* kind, const std::string& name) {
    if (file.robot.has_lost(name)) lost = true;
    else if (file.part) not_attached = true;
    else
      reader.fail(DYN_ERROR_NAME, e,
                  std::string("there is no ") + kind + " " + load::in_quotes(name) + suggestion(file.robot, kind, name));
  }
  std::string site(const Element& e, const char* attribute) {
    const std::string site = name(e, "site", attribute);
    if (!find_site(file.robot, site)) missing(e, "site", site);
    return site;
  }
  TendonElement joint(const Element& e) {
    const std::string joint = name(e, "joint", "joint");
    if (!find_joint(file.robot, joint)) missing(e, "joint", joint);
    return {DYN_TENDON_ELEMENT_TYPE_JOINT, joint, "", reader.number(e, "coef")};
  }
  TendonElement geom(const Element& e) {
    const std::string name_of_geom = name(e, "geom", "geom"), side = e.Attribute("sidesite") ? site(e, "sidesite") : "";
    MjcfGeom* const geom = find_geom(file.robot, name_of_geom);
    if (!geom) return missing(e, "geom", name_of_geom), TendonElement{};
    const bool sphere = geom->shape.type == DYN_SHAPE_TYPE_SPHERE;
    if (!sphere && geom->shape.type != DYN_SHAPE_TYPE_CYLINDER)
      reader.fail(DYN_ERROR_INVALID, e, "geom " + load::in_quotes(name_of_geom) + " is neither a sphere nor a cylinder");
    geom->wrapped = true, geom->discarded = false;
    return {sphere ? DYN_TENDON_ELEMENT_TYPE_SPHERE : DYN_TENDON_ELEMENT_TYPE_CYLINDER, name_of_geom, side, geom->shape.size[0]};
  }
  TendonElement element(const Element& e) {
    const std::string_view kind = e.Name();
    if (kind == "joint") return joint(e);
    if (kind == "geom") return geom(e);
    if (kind == "site") return {DYN_TENDON_ELEMENT_TYPE_SITE, site(e, "site")};
    return {DYN_TENDON_ELEMENT_TYPE_PULLEY, "", "", reader.number(e, "divisor")};
  }
};

void read_numbers(const MjcfFile& file, const Reader& reader, const Element& e, MjcfTendon& tendon) {
  dynTendon& t = tendon.spec;
  t.stiffness = read_coefficient(reader, e, "stiffness"), t.damping = read_coefficient(reader, e, "damping"),
  t.friction = read_coefficient(reader, e, "frictionloss"), t.armature = read_coefficient(reader, e, "armature");
  if (const auto rest = reader.numbers(e, "springlength")) {
    if (rest->empty() || rest->size() > 2) reader.bad_numbers(e, "springlength", "one or two numbers are expected");
    const double low = rest->front(), high = rest->back();
    if (low > high) reader.bad_numbers(e, "springlength", "the lower end is above the upper one");
    if (low != -1 || high != -1) t.rest[0] = low, t.rest[1] = high;  // two -1 stand for the length in the file
  }
  const double margin = reader.optional_number(e, "margin").value_or(0);  // the limit holds so far inside the range
  if (const auto range = read_limits(reader, e, "range", "limited", file.compiler.autolimits))
    t.range[0] = read_bound((*range)[0]) + margin, t.range[1] = read_bound((*range)[1]) - margin;
  if (t.range[0] > t.range[1]) {
    tendon.place.physics("the margin of its limits is more than half of the range: its length is held in the middle");
    t.range[0] = t.range[1] = (t.range[0] + t.range[1]) / 2;
  }
  tendon.force = read_limits(reader, e, "actuatorfrcrange", "actuatorfrclimited", file.compiler.autolimits);
}

std::string free_name(const std::string& wanted, std::set<std::string>& taken) {
  std::string name = wanted;
  for (int k = 2; !taken.insert(name).second; ++k) name = wanted + wrap_ending + (k > 2 ? std::to_string(k) : "");
  return name;
}

bool stands_for_frame(const MjcfGeom& g) {
  return g.group == group_of_wraps && g.shape.role == DYN_SHAPE_ROLE_VISUAL && g.mass.value_or(g.density) == 0;
}

// The body that moves with a body, which has joints or is the world, and the body's pose in it.
struct MovingPose {
  size_t body;
  SE3<double> X;
};
std::vector<MovingPose> moving_poses(const MjcfRobot& robot) {
  std::vector<MovingPose> out;
  for (size_t i = 0; i < robot.bodies.size(); ++i) {
    const MjcfBody& b = robot.bodies[i];
    if (b.parent < 0 || !b.joints.empty()) out.push_back({i, SE3<double>::identity()});
    else out.push_back({out[size_t(b.parent)].body, out[size_t(b.parent)].X * b.X});
  }
  return out;
}

// Sites by the body that they move with, in the file's order.
struct PlacedSite {
  const MjcfSite* site;
  SE3<double> X;
};
std::map<size_t, std::vector<PlacedSite>> placed_sites(const MjcfRobot& robot, const std::vector<MovingPose>& poses) {
  std::map<size_t, std::vector<PlacedSite>> out;
  for (size_t i = 0; i < robot.bodies.size(); ++i)
    for (const MjcfSite& s : robot.bodies[i].sites) out[poses[i].body].push_back({&s, poses[i].X * s.X});
  return out;
}

// Files that are written have a site for the frame of a wrapped geom. Where the model has no such shape, the geom is massless,
// out of view, and no shape either.
const MjcfSite* site_of_wrap(const std::vector<PlacedSite>& sites, const SE3<double>& X, const MjcfGeom& g) {
  const bool alone = stands_for_frame(g);
  for (const PlacedSite& s : sites)
    if ((alone || wraps_as(g.shape.name, s.site->name)) && is_same_pose(s.X, X * g.X)) return s.site;
  return nullptr;
}

}  // namespace

void read_mjcf_tendon(MjcfFile& file, Element& e, const MjcfContext& context) {
  const std::string_view kind = e.Name();
  const bool fixed = kind == "fixed";
  const std::string given = attribute(e, "name"),
                    name = context.name(given.empty() ? "tendon_" + std::to_string(file.robot.tendons.size()) : given);
  const Reader reader = file.source.reader(e, "tendon " + load::in_quotes(name));
  const MjcfPlace place{&reader.report, line(e), reader.owner};
  if (!fixed && kind != "spatial") return place.physics("<" + std::string(kind.substr(0, 60)) + "> is not supported");
  if (context.suffix != context.outer) file.copies.add(e, context);
  file.defaults.apply(file.source, e, "tendon", context.childclass);
  const std::initializer_list<std::string_view> attributes = {
      "name",        "class",       "group",          "limited",        "range",        "actuatorfrclimited", "actuatorfrcrange",
      "solreflimit", "solimplimit", "solreffriction", "solimpfriction", "frictionloss", "springlength",       "margin",
      "stiffness",   "damping",     "armature",       "user",           "width",        "material",           "rgba"};
  if (fixed) reader.unread(e, attributes, {"joint"});
  else reader.unread(e, attributes, {"site", "geom", "pulley"});
  MjcfTendon tendon{place, name, plain_tendon(fixed ? DYN_TENDON_TYPE_FIXED : DYN_TENDON_TYPE_SPATIAL), {}, {}};
  tendon.compliance = read_mjcf_compliance(reader, e, "solreflimit", "solimplimit");
  tendon.friction_compliance = read_mjcf_compliance(reader, e, "solreffriction", "solimpfriction");
  read_numbers(file, reader, e, tendon);
  PathReader path{file, reader, context};
  for (const Element* c : file.source.children(e))
    if (const std::string_view part = c->Name(); fixed ? part == "joint" : part == "site" || part == "geom" || part == "pulley")
      tendon.elements.push_back(path.element(*c));
  if (path.lost) {
    file.robot.lost_tendons.insert(name);
    return place.physics("it is left out: what it passes is missing from the model");
  }
  if (path.not_attached) return place.info("it refers to a part that was not attached: left out");
  file.robot.tendon_numbers.emplace(tendon.name, file.robot.tendons.size());
  file.robot.tendons.push_back(std::move(tendon));
}

void name_mjcf_frames(MjcfRobot& robot) {
  std::set<std::string> taken;
  for (const MjcfBody& b : robot.bodies)
    for (const MjcfJoint& j : b.joints) taken.insert(j.spec.name);
  const std::set<std::string> joints = taken;
  for (MjcfBody& b : robot.bodies)
    for (MjcfSite& s : b.sites) {
      s.frame = s.name;
      if (joints.count(s.name)) s.place.info("the frame is called " + load::in_quotes(s.frame += "_site"));
      taken.insert(s.frame);
    }
  const std::vector<MovingPose> poses = moving_poses(robot);
  std::map<size_t, std::vector<PlacedSite>> sites = placed_sites(robot, poses);
  for (size_t i = 0; i < robot.bodies.size(); ++i)
    for (MjcfGeom& g : robot.bodies[i].geoms)
      if (g.wrapped) {
        if (const MjcfSite* const s = site_of_wrap(sites[poses[i].body], poses[i].X, g)) {
          g.frame = s->frame, g.has_site = true, g.discarded |= stands_for_frame(g);
          continue;
        }
        g.frame = free_name(g.shape.name, taken);
        if (g.frame != g.shape.name) g.place.info("the frame that tendons wrap around is called " + load::in_quotes(g.frame));
      }
}

void add_mjcf_tendons(Builder& builder, const MjcfRobot& robot) {
  const auto off = [&](std::uint32_t effect) { return !(robot.effects & effect); };
  std::map<std::string, const std::string*> sites, geoms;
  for (const MjcfBody& b : robot.bodies) {
    for (const MjcfSite& s : b.sites) sites[s.name] = &s.frame;
    for (const MjcfGeom& g : b.geoms)
      if (g.wrapped) geoms[g.shape.name] = &g.frame;
  }
  constexpr double none = std::numeric_limits<double>::infinity();
  for (const MjcfTendon& t : robot.tendons) {
    dynTendon spec = t.spec;
    if (off(DYN_EFFECT_SPRINGS)) spec.stiffness = 0;
    if (off(DYN_EFFECT_DAMPING)) spec.damping = 0;
    if (off(DYN_EFFECT_FRICTION)) spec.friction = 0;
    if (off(DYN_EFFECT_LIMITS)) spec.range[0] = -none, spec.range[1] = none;
    std::vector<TendonElement> elements = t.elements;
    for (TendonElement& e : elements) {
      if (e.type == DYN_TENDON_ELEMENT_TYPE_SITE) e.name = *sites.at(e.name);
      if (e.type == DYN_TENDON_ELEMENT_TYPE_SPHERE || e.type == DYN_TENDON_ELEMENT_TYPE_CYLINDER) e.name = *geoms.at(e.name);
      if (!e.side.empty()) e.side = *sites.at(e.side);
    }
    with_location(t.place, [&] { builder.tendon(t.name, spec, elements, t.compliance, t.friction_compliance); });
  }
}

}  // namespace dyn::load
