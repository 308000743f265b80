// <asset>: meshes, height fields, and models to attach.
#include <cmath>
#include <cstring>

#include "collision_mesh.hpp"
#include "file.hpp"
#include "mjcf_robot.hpp"
#include "model/builder_surface.hpp"

namespace dyn::load {

namespace {

// Vertices in the geom's frame: moved by refpos and refquat, then scaled.
meshes::Mesh in_frame(meshes::Mesh mesh, const SE3<double>& reference, const std::array<double, 3>& scale,
                      const std::string& who) {
  const bool mirrored = scale[0] * scale[1] * scale[2] < 0;
  for (size_t i = 0; i < mesh.vertices.size(); i += 3) {
    const Vec3<double> p = reference.act_inverse(load3(&mesh.vertices[i]));
    for (size_t k = 0; k < 3; ++k) mesh.vertices[i + k] = scale[k] * p[int(k)];
  }
  if (mirrored)
    for (size_t t = 0; t < mesh.triangles.size(); t += 3) std::swap(mesh.triangles[t], mesh.triangles[t + 1]);
  if (mesh.triangles.empty()) return mesh;
  return meshes::make_mesh(mesh.vertices.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(), 0, who);
}

constexpr std::uint64_t max_binary_bytes = std::uint64_t(1) << 30;

// Numbers of a binary file, one after the other.
template <class T>
std::vector<T> take(std::string_view& bytes, std::int64_t count) {
  std::vector<T> out(static_cast<size_t>(count));
  if (count > 0) std::memcpy(out.data(), bytes.data(), out.size() * sizeof(T));
  bytes.remove_prefix(out.size() * sizeof(T));
  return out;
}

// MuJoCo's own mesh format: four counts (vertices, normals, texture coordinates, faces), then the numbers.
meshes::Mesh read_msh(const std::string& path, Budget* budget) {
  const std::string content = read_file(path, "a mesh file", FileKind::Regular, max_binary_bytes);
  const Report report(path, false);
  if (budget) budget->add_bytes(8 * std::int64_t(content.size()), report, 0);
  std::string_view bytes = content;
  if (bytes.size() < 16) report.fail(DYN_ERROR_FILE, 0, "is not of MuJoCo's format: it ends early");
  const std::vector<std::int32_t> counts = take<std::int32_t>(bytes, 4);
  for (const std::int32_t n : counts)
    if (n < 0 || n > meshes::max_triangles)
      report.fail(DYN_ERROR_PARSE, 0, "is not of MuJoCo's format: " + std::to_string(n) + " vertices or faces");
  const std::int64_t points = counts[0], normals = counts[1], texture = counts[2], triangles = counts[3];
  if (std::int64_t(bytes.size()) < 4 * (3 * points + 3 * normals + 2 * texture + 3 * triangles))
    report.fail(DYN_ERROR_FILE, 0, "states more numbers than it has, and ends early");
  const std::vector<float> vertices = take<float>(bytes, 3 * points);
  bytes.remove_prefix(size_t(4 * (3 * normals + 2 * texture)));
  const std::vector<std::int32_t> faces = take<std::int32_t>(bytes, 3 * triangles);
  for (const std::int32_t f : faces)
    if (f < 0 || f >= counts[0])
      report.fail(DYN_ERROR_PARSE, 0, "vertex " + std::to_string(f) + " does not exist");
  for (const float v : vertices)
    if (!std::isfinite(v)) report.fail(DYN_ERROR_NONFINITE, 0, "has a vertex that is not finite");
  const std::vector<double> numbers(vertices.begin(), vertices.end());
  const std::vector<Index> corners(faces.begin(), faces.end());
  if (corners.empty()) {
    meshes::Mesh cloud;
    cloud.vertices = numbers;
    return cloud;
  }
  return meshes::make_mesh(numbers.data(), counts[0], corners.data(), counts[3], 0, "file " + load::in_quotes(path));
}

struct Grid {
  std::vector<double> heights;  // from 0 to 1
  Index columns, rows;
};

Grid read_grid(const MjcfSource& source, const Reader& reader, const Element& e) {
  Grid g{{}, 0, 0};
  const std::string file = attribute(e, "file");
  if (!file.empty()) {
    const std::string content = read_file(source.path(e, file).string(), "a height field", FileKind::Regular, max_binary_bytes);
    std::string_view bytes = content;
    if (bytes.size() < 8) reader.fail(DYN_ERROR_FILE, e, "file " + load::in_quotes(file) + " ends early");
    const std::vector<std::int32_t> size = take<std::int32_t>(bytes, 2);
    if (size[0] < 2 || size[1] < 2 || std::int64_t(size[0]) * size[1] > max_heights)
      reader.fail(DYN_ERROR_LIMIT, e,
                  "file " + load::in_quotes(file) + " has " + std::to_string(size[0]) + " rows of " + std::to_string(size[1]));
    g.rows = size[0], g.columns = size[1];
    const std::int64_t count = std::int64_t(g.rows) * g.columns;
    if (std::int64_t(bytes.size()) < 4 * count) reader.fail(DYN_ERROR_FILE, e, "file " + load::in_quotes(file) + " ends early");
    source.charge(&Budget::add_bytes, bytes_of_height * count, e);
    const std::vector<float> data = take<float>(bytes, count);
    for (const float x : data)
      if (!std::isfinite(x))
        reader.fail(DYN_ERROR_NONFINITE, e, "file " + load::in_quotes(file) + " has a height that is not finite");
    g.heights.assign(data.begin(), data.end());
  } else {
    const double rows = reader.number(e, "nrow"), columns = reader.number(e, "ncol");
    if (!(rows >= 2 && columns >= 2 && rows * columns <= double(max_heights)))
      reader.fail(DYN_ERROR_INVALID, e, "nrow and ncol are at least 2, and their product at most " + std::to_string(max_heights));
    g.rows = Index(rows), g.columns = Index(columns);
    source.charge(&Budget::add_bytes, bytes_of_height * std::int64_t(g.rows) * g.columns, e);
    g.heights.assign(size_t(g.rows) * size_t(g.columns), 0);
    if (const auto text = reader.numbers(e, "elevation", g.heights.size()))  // the text begins with the farthest row
      for (Index r = 0; r < g.rows; ++r)
        std::copy_n(text->begin() + std::ptrdiff_t(r) * g.columns, g.columns,
                    g.heights.begin() + std::ptrdiff_t(g.rows - 1 - r) * g.columns);
  }
  const auto [low, high] = std::minmax_element(g.heights.begin(), g.heights.end());
  const double least = *low, range = *high - *low;
  for (double& h : g.heights) h = range > 0 ? (h - least) / range : 0;
  return g;
}

}  // namespace

void MjcfAssets::add(Element& asset, const MjcfDefaults& defaults) {
  for (Element* c : source_.children(asset)) {
    const std::string_view kind = c->Name();
    if (kind == "mesh" || kind == "hfield" || kind == "model") {
      std::string name = attribute(*c, "name");
      if (name.empty() && kind == "model" && c->Attribute("file")) {  // the name the attached model gives itself
        name = attribute(source_.open_model(*c, attribute(*c, "file")), "model");
        source_.close_model();
      }
      if (name.empty()) name = std::filesystem::path(attribute(*c, "file")).stem().string();
      const Reader reader = source_.reader(*c, "<" + std::string(kind) + "> " + load::in_quotes(name));
      if (name.empty()) reader.fail(DYN_ERROR_PARSE, *c, "it has neither name nor file");
      if (kind == "mesh") defaults.apply(source_, *c, "mesh", "");
      auto& all = kind == "mesh" ? meshes_ : kind == "hfield" ? fields_ : models_;
      if (!all.emplace(name, Entry{c, nullptr, ""}).second) reader.fail(DYN_ERROR_NAME, *c, "there are two of this name");
    } else if (kind == "material") {
      defaults.apply(source_, *c, "material", "");
      materials_.emplace(attribute(*c, "name"), colour_of(*c));
      if (c->Attribute("texture")) source_.report(*c).count("<material texture>: not used", line(*c));
    } else if (kind == "texture") {
      source_.report(*c).count("<" + std::string(kind) + ">: not used", line(*c));
    } else {
      source_.report(*c).physics(line(*c), "<asset>: element <" + std::string(kind.substr(0, 60)) + "> is not used");
    }
  }
}

std::uint32_t MjcfAssets::colour(const Element& geom) const {
  if (const std::uint32_t own = colour_of(geom)) return own;
  const auto material = materials_.find(attribute(geom, "material"));
  return material == materials_.end() ? 0 : material->second;
}

MjcfAssets::Entry& MjcfAssets::find(std::map<std::string, Entry>& all, const char* kind, const Element& e,
                                    const std::string& name) const {
  if (const auto at = all.find(name); at != all.end()) return at->second;
  std::vector<const std::string*> names;
  for (const auto& entry : all) names.push_back(&entry.first);
  source_.report(e).fail(
      DYN_ERROR_NAME, line(e),
      std::string("there is no ") + kind + " " + load::in_quotes(name) + " among the assets" + did_you_mean(name, names));
}

const Element& MjcfAssets::model(const Element& e, const std::string& name) const {
  return *find(const_cast<MjcfAssets*>(this)->models_, "model", e, name).element;
}

void MjcfAssets::read(Entry& entry) const {
  const Element& e = *entry.element;
  const Reader reader = source_.reader(e, "mesh " + load::in_quotes(entry.path));
  reader.unread(e,
                {"name", "class", "file", "scale", "refpos", "refquat", "vertex", "face", "normal", "texcoord", "smoothnormal",
                 "maxhullvert", "inertia", "content_type", "material", "builtin", "params"},
                {});
  const auto scale = reader.vector3(e, "scale").value_or(std::array<double, 3>{1, 1, 1});
  SE3<double> reference = SE3<double>::identity();
  if (const auto p = reader.vector3(e, "refpos")) reference.p = load3(p->data());
  if (const auto q = reader.numbers(e, "refquat", 4)) {
    const double n = (*q)[0] * (*q)[0] + (*q)[1] * (*q)[1] + (*q)[2] * (*q)[2] + (*q)[3] * (*q)[3];
    if (!(n > 0)) reader.bad_numbers(e, "refquat", "this is no rotation: it is zero");
    reference.R = from_quaternion((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
  }
  try {
    meshes::Mesh mesh;
    if (const auto vertices = reader.numbers(e, "vertex")) {
      if (vertices->size() % 3) reader.bad_numbers(e, "vertex", "three numbers a vertex are expected");
      std::vector<Index> faces;
      for (double f : reader.numbers(e, "face").value_or(std::vector<double>())) {
        if (f < 0 || f >= double(vertices->size() / 3)) reader.bad_numbers(e, "face", "vertex " + text(f) + " does not exist");
        faces.push_back(Index(f));
      }
      if (faces.size() % 3) reader.bad_numbers(e, "face", "three vertices a face are expected");
      if (faces.empty())
        mesh.vertices = *vertices;
      else
        mesh = meshes::make_mesh(vertices->data(), std::int64_t(vertices->size() / 3), faces.data(),
                                 std::int64_t(faces.size() / 3), 0, reader.owner);
    } else if (e.Attribute("builtin") && e.Attribute("builtin") != std::string_view("none")) {
      mesh = mjcf_builtin_mesh(reader, e);
    } else if (entry.path.ends_with(".msh")) {
      mesh = read_msh(entry.path, options_.budget);
    } else {
      meshes::MeshOptions how;
      how.package_dirs = options_.package_dirs;  // source.path has checked that it may be read
      how.points = true, how.budget = options_.budget;
      mesh = meshes::read_mesh(entry.path, how);
    }
    for (double& x : mesh.vertices) x = double(float(x));  // MuJoCo's vertices have single precision, and masses follow from them
    mesh = in_frame(std::move(mesh), reference, scale, reader.owner);
    if (mesh.triangles.empty()) mesh = meshes::hull_of(mesh);
    entry.mesh = std::make_shared<meshes::Mesh>(std::move(mesh));
  } catch (const Error& error) {
    const std::string what = error.what();
    if (what.starts_with(reader.report.where(line(e)))) throw;
    if (what.starts_with(reader.owner)) reader.report.fail(error.status, line(e), what);
    reader.fail(error.status, e, what);
  }
}

// A mass, or a fit, takes the time of all triangles for each geom.
void MjcfAssets::charge_work(const meshes::Mesh& mesh, const Element& e) const {
  source_.charge(&Budget::add_bytes, 10 * (std::int64_t(mesh.triangle_count()) + mesh.vertex_count()), e);
}

MjcfAssets::Entry& MjcfAssets::mesh_entry(const Element& e, const std::string& name) {
  Entry& entry = find(meshes_, "mesh", e, name);
  if (!entry.path.empty()) return entry;
  std::string file = attribute(*entry.element, "file");
  if (compiler_.strip_path) file = std::filesystem::path(file).filename().string();
  entry.path =
      file.empty() ? name : source_.path(*entry.element, (std::filesystem::path(compiler_.mesh_folder) / file).string()).string();
  return entry;
}

const meshes::Mesh& MjcfAssets::mesh(const Element& e, const std::string& name) {
  Entry& entry = mesh_entry(e, name);
  if (!entry.mesh) read(entry);
  charge_work(*entry.mesh, e);
  return *entry.mesh;
}

void MjcfAssets::mesh(const Element& e, const std::string& name, bool needed, MjcfGeom& geom) {
  Entry& entry = mesh_entry(e, name);
  const bool touches = options_.meshes != DYN_MESH_USE_NONE && geom.shape.role == DYN_SHAPE_ROLE_COLLISION;
  geom.shape.mesh = entry.path;
  geom.shape.size = {1, 1, 1};
  if (!needed && !touches) return;
  try {
    if (!entry.mesh) read(entry);
    if (touches && !entry.collision) entry.collision = collision_mesh_of(*entry.mesh, options_.meshes);
  } catch (const Error& error) {
    if (needed || options_.meshes != DYN_MESH_USE_AUTO) throw;
    return geom.place.physics("mesh " + load::in_quotes(name) + " is left out of collisions: " + error.what());
  }
  if (needed) charge_work(*entry.mesh, e);
  geom.mesh = entry.mesh;
  geom.rule = attribute(*entry.element, "builtin") == "plate" ? "shell" : attribute(*entry.element, "inertia");
  if (!touches) return;
  const CollisionMesh& collision = *entry.collision;
  const std::string message = "mesh " + load::in_quotes(name) + collision.message;
  if (collision.warning)
    geom.place.warning(message);
  else
    geom.place.info(message);
  geom.shape.type = collision.type;
  geom.shape.surface = collision.surface;
}

bool MjcfAssets::height_field(const Element& e, const std::string& name, MjcfGeom& geom) {
  Entry& entry = find(fields_, "height field", e, name);
  const Element& asset = *entry.element;
  geom.shape.size = {1, 1, 1};
  if ((geom.shape.surface = entry.grid)) return true;
  const Reader reader = source_.reader(asset, "height field " + load::in_quotes(name));
  reader.unread(asset, {"name", "file", "nrow", "ncol", "elevation", "size", "content_type"}, {});
  if (const std::string file = attribute(asset, "file"); file.ends_with(".png") || file.ends_with(".PNG")) {
    geom.place.physics("the height field " + load::in_quotes(name) + " is a picture (" + load::in_quotes(file) +
                       "), which is not supported: the geom is left out; give elevation, or a binary file");
    return false;
  }
  const Grid g = read_grid(source_, reader, asset);
  const auto size = reader.numbers(asset, "size", 4);
  if (!size)
    reader.fail(DYN_ERROR_PARSE, asset, "it has no attribute size: half lengths along x and y, height, depth below zero");
  for (double s : *size)
    if (!(s > 0)) reader.bad_numbers(asset, "size", "sizes are positive metres");
  std::vector<double> heights = g.heights;
  for (double& h : heights) h *= (*size)[2];
  try {
    geom.shape.surface = entry.grid = height_grid(heights.data(), g.columns, g.rows, 2 * (*size)[0] / (g.columns - 1),
                                     2 * (*size)[1] / (g.rows - 1), -(*size)[3]);
  } catch (const Error& error) {
    reader.fail(error.status, asset, error.what());
  }
  return true;
}

}  // namespace dyn::load
