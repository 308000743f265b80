// <link>: mass properties and shapes.
#include <cmath>

#include "reader.hpp"
#include "shape_form.hpp"
#include "urdf_robot.hpp"

namespace dyn::load {

namespace {

// R I R^T, 3 x 3, column-major.
std::array<double, 9> rotated(const std::array<double, 9>& I, const Placement& X) {
  std::array<double, 9> RI{}, out{};
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k) RI[r + 3 * c] += X[r + 3 * k] * I[k + 3 * c];
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r <= c; ++r) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += RI[r + 3 * k] * X[c + 3 * k];
      out[r + 3 * c] = out[c + 3 * r] = sum;
    }
  return out;
}

bool has_rotation(const Placement& X) {
  for (int i = 0; i < 9; ++i)
    if (X[i] != identity_placement[i]) return true;
  return false;
}

void read_inertial(const Element& e, const Reader& reader, UrdfLink& link) {
  const Element* i = reader.only(e, "inertial");
  if (!i) {
    reader.report.info(line(e), reader.owner + " has no <inertial>: it has no mass");
    return;
  }
  link.inertial_line = line(*i);
  reader.unread(*i, {}, {"origin", "mass", "inertia"});
  const Placement X = reader.origin(*i);
  link.com = {X[9], X[10], X[11]};

  const Element* mass = reader.only(*i, "mass");
  if (!mass)
    reader.fail(DYN_ERROR_INVALID, *i, "<inertial> has no <mass>: add <mass value=\"...\"/> in kg, or remove <inertial>");
  reader.unread(*mass, {"value"}, {});
  link.mass = reader.number(*mass, "value");
  if (link.mass < 0) reader.fail(DYN_ERROR_INVALID, *mass, "the mass is negative: " + text(link.mass) + " kg");

  const Element* inertia = reader.only(*i, "inertia");
  if (!inertia) {
    if (link.mass > 0)
      reader.fail(DYN_ERROR_INVALID, *i,
                  "<inertial> has mass but no <inertia>: add ixx, iyy, izz in kg m^2 (zeros for a point mass)");
    return;
  }
  reader.unread(*inertia, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}, {});
  const auto off_diagonal = [&](const char* name) {
    const auto value = reader.optional_number(*inertia, name);
    if (!value) reader.report.warning(line(*inertia), reader.at(*inertia) + " has no attribute " + name + ": taken as 0");
    return value.value_or(0);
  };
  const double xx = reader.number(*inertia, "ixx"), yy = reader.number(*inertia, "iyy"), zz = reader.number(*inertia, "izz");
  const double xy = off_diagonal("ixy"), xz = off_diagonal("ixz"), yz = off_diagonal("iyz");
  link.inertia = {xx, xy, xz, xy, yy, yz, xz, yz, zz};
  if (has_rotation(X)) link.inertia = rotated(link.inertia, X);
}

void positive(const Reader& reader, const Element& e, const char* attribute, double value) {
  if (!(value > 0))
    reader.fail(DYN_ERROR_INVALID, e,
                "<" + std::string(e.Name()) + "> " + attribute + " is " + text(value) + ": sizes are positive metres");
}

void read_mesh(const Element& e, const Reader& reader, Shape& shape, MeshPaths& meshes) {
  reader.unread(e, {"filename", "scale"}, {}, false);
  shape.type = DYN_SHAPE_TYPE_MESH;
  const std::string name = reader.name(e, "filename");
  shape.size = reader.vector3(e, "scale").value_or(std::array<double, 3>{1, 1, 1});
  for (double s : shape.size)
    if (s == 0) reader.fail(DYN_ERROR_INVALID, e, "<mesh scale> has a zero: give numbers other than 0");
  const MeshPaths::Found& found = meshes.find(name);
  shape.mesh = found.path.empty() ? name : found.path;
  if (!found.path.empty() || !found.first_time) return;
  std::string tried;
  for (const std::string& path : found.tried) tried += (tried.empty() ? ": tried " : ", ") + in_quotes(path);
  if (name.starts_with("package://") || name.starts_with("model://"))
    tried += tried.empty() ? ": give package_dirs" : "; give the folder above the package in package_dirs";
  reader.report.physics(line(e), reader.owner + ": mesh " + in_quotes(name) + " is not found" + tried);
}

// Returns false for a shape that is not there: of sizes 0, as robots have on links without form, or a flat visual.
bool read_sizes(const Element& g, const Reader& reader, const ShapeForm& form, bool physics, Shape& shape) {
  const auto& names = form.attribute;
  shape.type = form.type, shape.size = {0, 0, 0};
  if (!names[1]) {
    reader.unread(g, {names[0]}, {}, physics);
    const auto size = reader.numbers(g, names[0], form.sizes);
    if (!size) reader.fail(DYN_ERROR_PARSE, g, "<" + std::string(form.name) + "> has no attribute " + names[0]);
    std::copy(size->begin(), size->end(), shape.size.begin());
  } else {
    reader.unread(g, {names[0], names[1], names[2] ? names[2] : names[0]}, {}, physics);
    for (size_t k = 0; k < form.sizes; ++k) shape.size[k] = reader.number(g, names[k]);
  }
  const auto zeros = std::count(shape.size.begin(), shape.size.begin() + form.sizes, 0.0);
  if (zeros > 0 && (!physics || zeros == std::ptrdiff_t(form.sizes))) return false;
  for (size_t k = 0; k < form.sizes; ++k) positive(reader, g, names[names[1] ? k : 0], shape.size[k]);
  for (size_t k = 0; k < form.sizes; ++k) shape.size[k] /= form.factor[k];
  return true;
}

// Reads a <visual> or <collision>. Returns false if it holds no supported shape.
bool read_shape(const Element& e, const Reader& reader, Shape& shape, MeshPaths& meshes, const Colours& colours) {
  const bool physics = shape.role == DYN_SHAPE_ROLE_COLLISION;
  reader.unread(e, {"name", "group"}, {"origin", "geometry", "material"}, physics);
  if (const char* name = e.Attribute("name")) shape.name = name;
  if (const Element* m = first(e, "material")) {
    shape.colour = colour_of_material(*m, colours);
    if (shape.colour == 0) reader.report.count("<material> without a colour: not used", line(*m));
  }
  shape.placement = reader.origin(e, physics);

  const Element* geometry = reader.only(e, "geometry");
  const Element* g = geometry ? first(*geometry) : nullptr;
  const auto skip = [&](const Element& at, const std::string& message) {
    if (physics)
      reader.report.physics(line(at), reader.owner + ": " + message);
    else
      reader.report.warning(line(at), reader.owner + ": " + message);
    return false;
  };
  if (!g) return skip(e, "<" + std::string(e.Name()) + "> has no geometry: not used");
  if (const Element* more = next(*g)) skip(*more, "<geometry> holds more than one shape: only the first one is used");

  const std::string_view kind = g->Name();
  if (const auto form = shape_form(RobotFormat::Urdf, kind)) {
    if (!read_sizes(*g, reader, *form, physics, shape))
      return skip(*g, "the <" + std::string(kind) + "> has a size of 0: not used");
  } else if (kind == "mesh") {
    read_mesh(*g, reader, shape, meshes);
  } else {
    return skip(*g, "shape <" + std::string(kind.substr(0, 60)) + "> is not known (" + shape_names(RobotFormat::Urdf) +
                        ", mesh): not used");
  }
  return true;
}

}  // namespace

UrdfLink read_link(const Element& e, Report& report, MeshPaths& meshes, const Colours& colours) {
  UrdfLink link;
  link.line = line(e);
  link.name = Reader{report, "a link"}.name(e, "name");
  const Reader reader{report, "link " + in_quotes(link.name)};
  reader.unread(e, {"name", "type"}, {"inertial", "visual", "collision", "gazebo", "sensor", "material"});
  read_inertial(e, reader, link);
  for (const Element* c = first(e); c; c = next(*c)) {
    const std::string_view kind = c->Name();
    if (kind == "gazebo" || kind == "sensor" || kind == "material")
      report.count("<" + std::string(kind) + "> in a link: not used", line(*c));
    if (kind != "visual" && kind != "collision") continue;
    UrdfShape shape;
    shape.line = line(*c);
    shape.shape.role = kind == "visual" ? DYN_SHAPE_ROLE_VISUAL : DYN_SHAPE_ROLE_COLLISION;
    shape.shape.body = link.name;
    if (read_shape(*c, reader, shape.shape, meshes, colours)) link.shapes.push_back(std::move(shape));
  }
  return link;
}

}  // namespace dyn::load
