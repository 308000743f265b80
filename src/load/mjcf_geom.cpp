// <geom>: collision shapes, visual shapes, and their masses.
#include <algorithm>
#include <cmath>
#include <set>

#include "mjcf_robot.hpp"
#include "shape_form.hpp"

namespace dyn::load {

namespace {

using Vec = Vec3<double>;

// Types that are not described by their sizes.
constexpr ShapeForm others[] = {
    {{"plane"}, DYN_SHAPE_TYPE_HALF_SPACE, 0}, {{"mesh"}, DYN_SHAPE_TYPE_MESH, 0}, {{"hfield"}, DYN_SHAPE_TYPE_HEIGHT_FIELD, 0}};

// Returns nullopt for signed distance fields, which are not supported.
std::optional<ShapeForm> type_of(const Reader& reader, const Element& e) {
  const std::string type = e.Attribute("type") ? e.Attribute("type") : "sphere";
  if (const auto form = shape_form(RobotFormat::Mjcf, type)) return form;
  for (const ShapeForm& other : others)
    if (other.name == type) return other;
  if (type == "sdf") return std::nullopt;
  reader.fail(
      DYN_ERROR_PARSE, e,
      "<geom type> is " + load::in_quotes(type) + ": plane, hfield, mesh, " + shape_names(RobotFormat::Mjcf) + " are supported");
}

// From the file's numbers to the sizes of dynShapeInfo.
std::array<double, 3> sizes_of(const ShapeForm& form, const std::array<double, 3>& s) {
  std::array<double, 3> out = {0, 0, 0};
  for (size_t k = 0; k < form.sizes; ++k) out[k] = s[k] / form.factor[k];
  return out;
}

std::uint32_t mask(const Reader& reader, const Element& e, const char* attribute) {
  const double value = reader.optional_number(e, attribute).value_or(1);
  if (value < 0 || value > 4294967295.0 || value != std::floor(value))
    reader.bad_numbers(e, attribute, "an integer of 32 bits is expected");
  return std::uint32_t(value);
}

shape::ShapeMaterial material_of(const Reader& reader, const Element& e) {
  std::array<double, 3> friction = {1, 0.005, 0.0001};
  if (const auto given = reader.numbers(e, "friction"))
    for (size_t k = 0; k < std::min<size_t>(given->size(), 3); ++k) friction[k] = (*given)[k];
  for (const double x : friction)
    if (x < 0) reader.bad_numbers(e, "friction", "coefficients are not negative");
  shape::ShapeMaterial x = {shape::default_material()};
  x.friction = friction[0], x.torsion = friction[1], x.rolling = friction[2];
  x.latent = mjcf_latent(reader, e), x.restitution = mjcf_rebound(reader, e);
  if (const auto v = reader.numbers(e, "surfacevel")) {
    std::copy_n(v->begin(), std::min<size_t>(v->size(), 3), x.surface_velocity);
    if (std::any_of(v->begin() + std::ptrdiff_t(std::min<size_t>(v->size(), 3)), v->end(), [](double turn) { return turn != 0; }))
      reader.report.physics(line(e), reader.owner + ": surfacevel: the rotation is not used, only the translation");
  }
  return x;
}

std::optional<FluidShape> fluid_of(const Reader& reader, const Element& e) {
  const std::string shape = e.Attribute("fluidshape") ? e.Attribute("fluidshape") : "none";
  if (shape != "none" && shape != "ellipsoid")
    reader.fail(DYN_ERROR_PARSE, e, "<geom fluidshape> is " + load::in_quotes(shape) + ": none or ellipsoid is expected");
  FluidShape out;
  if (const auto given = reader.numbers(e, "fluidcoef")) {
    if (given->size() > 5) reader.bad_numbers(e, "fluidcoef", "five numbers are expected");
    std::copy(given->begin(), given->end(), out.coefficients.begin());
    for (const double c : *given)
      if (c < 0) reader.bad_numbers(e, "fluidcoef", "coefficients are not negative");
  }
  return shape == "ellipsoid" ? std::optional(out) : std::nullopt;
}

}  // namespace

// MuJoCo's contact is a damped spring. Two negative numbers are its stiffness and damping of a unit mass, from which the ratio of
// velocities after half a period follows.
double mjcf_rebound(const Reader& reader, const Element& e, const char* solref) {
  const auto spring = reader.numbers(e, solref);
  if (!spring || spring->size() < 2 || !((*spring)[0] < 0)) return 0;
  const double ratio = -(*spring)[1] / (2 * std::sqrt(-(*spring)[0]));
  return ratio >= 0 && ratio < 1 ? std::exp(-3.14159265358979324 * ratio / std::sqrt(1 - ratio * ratio)) : 0;
}

// condim says which kinds of friction act: 1 none, 3 sliding, 4 torsion, too, 6 rolling, too.
std::uint32_t mjcf_latent(const Reader& reader, const Element& e) {
  const double condim = reader.optional_number(e, "condim").value_or(3);
  if (condim != 1 && condim != 3 && condim != 4 && condim != 6) reader.bad_numbers(e, "condim", "1, 3, 4 or 6 is expected");
  return condim == 1 ? 3 : condim == 3 ? 2 : condim == 4 ? 1 : 0;
}

void read_mjcf_geom(MjcfFile& file, Element& e, const MjcfContext& context) {
  file.source.charge(&Budget::add_shapes, 1, e);
  MjcfBody& body = file.robot.bodies[size_t(context.body)];
  file.defaults.apply(file.source, e, "geom", context.childclass);
  MjcfGeom geom;
  geom.shape.name = context.name(e.Attribute("name") ? e.Attribute("name") : "");
  const std::string owner = geom.shape.name.empty() ? body.place.owner + ": a geom" : "geom " + load::in_quotes(geom.shape.name);
  const Reader reader = file.source.reader(e, owner);
  geom.place = {&file.source.report(e), line(e), owner};
  reader.unread(e, {"name",     "class",  "type",    "contype", "conaffinity", "group", "size",      "material",
                    "rgba",     "mass",   "density", "fromto",  "pos",         "quat",  "axisangle", "euler",
                    "xyaxes",   "zaxis",  "hfield",  "mesh",    "fitscale",    "user",  "friction",  "condim",
                    "priority", "solmix", "solref",  "solimp",  "margin",      "gap",   "surfacevel",
                    "fluidshape", "fluidcoef"},
                {"plugin"});
  const std::optional<ShapeForm> type = type_of(reader, e);
  if (!type) {
    file.robot.lost_mass = true;
    return geom.place.physics("a geom of type sdf is not used");
  }

  geom.shape.type = type->type;
  geom.shape.contype = mask(reader, e, "contype"), geom.shape.conaffinity = mask(reader, e, "conaffinity");
  geom.shape.role = geom.shape.contype == 0 && geom.shape.conaffinity == 0 ? DYN_SHAPE_ROLE_VISUAL : DYN_SHAPE_ROLE_COLLISION;
  geom.shape.material = material_of(reader, e), geom.shape.colour = file.assets.colour(e);
  geom.group = int(reader.optional_number(e, "group").value_or(0));
  geom.priority = int(reader.optional_number(e, "priority").value_or(0));
  geom.margin = reader.optional_number(e, "margin").value_or(0);
  if (geom.margin < 0) {
    geom.place.physics("margin is negative, which is not supported: 0 is used");
    geom.margin = 0;
  }
  Compliance& law = geom.shape.compliance;
  law = read_mjcf_compliance(reader, e, "solref", "solimp");
  law.mix = reader.optional_number(e, "solmix").value_or(1), law.margin = geom.margin;
  if (!(law.mix >= 0)) reader.bad_numbers(e, "solmix", "it is negative");
  geom.mass = reader.optional_number(e, "mass");
  geom.density = reader.optional_number(e, "density").value_or(1000);
  if (geom.mass.value_or(0) < 0) reader.bad_numbers(e, "mass", "it is negative");
  if (geom.density < 0) reader.bad_numbers(e, "density", "it is negative");
  geom.X = read_pose(reader, e, file.compiler), geom.fluid = fluid_of(reader, e);

  std::array<double, 3> size = {0, 0, 0};
  size_t given = 0;
  if (const auto s = reader.numbers(e, "size")) {
    given = std::min<size_t>(s->size(), 3);
    for (size_t k = 0; k < given; ++k) size[k] = (*s)[k];
  }
  size_t needed = type->sizes;
  const auto ends = reader.numbers(e, "fromto", 6);
  if (ends && type->sizes > 1) {  // the ends of the axis
    const Vec from = load3(ends->data()), to = load3(ends->data() + 3), d = from - to;
    const double length = std::sqrt(dot(d, d));
    if (!(length > 1e-12)) reader.bad_numbers(e, "fromto", "both ends are the same point");
    const bool round = needed == 2;
    const double half = length / 2;
    if (round) size[1] = half, needed = 1;
    else size = {size[0], size[0], half}, needed = 1;
    geom.X = {turn_z_to(d * (1 / length)), (from + to) * 0.5};
  }
  const bool fitted = e.Attribute("mesh") && type->sizes > 0;
  if (fitted) {
    const double scale = reader.optional_number(e, "fitscale").value_or(1);
    if (!(scale > 0)) reader.bad_numbers(e, "fitscale", "it is not positive");
    fit_mjcf_geom(file.assets.mesh(e, reader.name(e, "mesh")), file.compiler.fit_bounds, scale, geom);
    std::copy(geom.shape.size.begin(), geom.shape.size.end(), size.begin());
    given = needed = type->sizes;
  }
  if (given < needed)
    reader.fail(DYN_ERROR_INVALID, e,
                "<geom size>: a " + std::string(type->name) + " needs " + std::to_string(needed) + " numbers");
  for (size_t k = 0; k < needed; ++k)
    if (!(size[k] > 0)) reader.bad_numbers(e, "size", "sizes are positive metres");
  geom.shape.size = sizes_of(*type, size);

  const bool counts = geom.mass.value_or(geom.density) > 0 && context.body != 0 && mass_from_geoms(body);
  if (type->type == DYN_SHAPE_TYPE_MESH) file.assets.mesh(e, reader.name(e, "mesh"), counts || geom.fluid, geom);
  if (geom.fluid && (type->type == DYN_SHAPE_TYPE_HALF_SPACE || type->type == DYN_SHAPE_TYPE_HEIGHT_FIELD)) {
    geom.place.physics("fluidshape: a " + std::string(type->name) + " is no ellipsoid: fluid forces on it are left out");
    geom.fluid.reset();
  }
  if (type->type == DYN_SHAPE_TYPE_HEIGHT_FIELD && !file.assets.height_field(e, reader.name(e, "hfield"), geom)) return;
  geom.X = context.X * geom.X;
  if (geom.fluid && geom.mesh && type->type == DYN_SHAPE_TYPE_MESH) fit_mjcf_fluid(*geom.mesh, geom);
  geom.discarded =
      file.compiler.discard_visual && geom.shape.role == DYN_SHAPE_ROLE_VISUAL && geom.mass.value_or(geom.density) == 0;
  geom.body = context.body;
  body.geoms.push_back(std::move(geom)), file.robot.names.reset();
}

void override_mjcf_contacts(MjcfRobot& robot) {
  if (!robot.override_) return;
  const MjcfOverride& x = *robot.override_;
  const auto set = [&](dynMaterial& material, Compliance& law, double& margin, double share) {
    material.restitution = x.restitution;
    material.friction = x.friction[0], material.torsion = x.friction[1], material.rolling = x.friction[2];
    std::copy(x.compliance.reference, x.compliance.reference + 2, law.reference);
    std::copy(x.compliance.impedance, x.compliance.impedance + 5, law.impedance);
    law.across[0] = law.across[1] = 0;
    margin = law.margin = share * x.margin;
  };
  for (MjcfBody& b : robot.bodies)
    for (MjcfGeom& g : b.geoms) set(g.shape.material, g.shape.compliance, g.margin, 0.5);  // margins of two geoms add up
  for (MjcfPair& p : robot.pairs) set(p.material, p.compliance, p.margin, 1), p.material = shape::acting(p.material, p.latent);
}

void set_mjcf_priorities(MjcfRobot& robot) {
  std::set<int> levels = {0};
  const auto each = [&](const auto& f) {
    for (MjcfBody& b : robot.bodies)
      for (MjcfGeom& g : b.geoms)
        if (g.shape.role == DYN_SHAPE_ROLE_COLLISION) f(g);
  };
  each([&](const MjcfGeom& g) { levels.insert(g.priority); });
  each([&](MjcfGeom& g) {
    const auto over_zero = std::distance(levels.begin(), levels.find(g.priority)) - std::distance(levels.begin(), levels.find(0));
    g.shape.material.priority = std::clamp(int(over_zero), shape::least_priority, shape::largest_priority);
    if (g.shape.material.priority != over_zero)
      g.place.physics("priority " + std::to_string(g.priority) +
                      " counts as its neighbour: a model has priorities for 3 levels above 0 and 4 below");
  });
}

}  // namespace dyn::load
