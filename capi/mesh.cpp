// Meshes: C structs to the loader's own.
#include "load/mesh.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include "model/colour.hpp"
#include "host.hpp"
#include "handles.hpp"
#include "model/builder_surface.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

meshes::MeshOptions read_options(const Given<dynMeshOptions>& o) {
  meshes::MeshOptions out;
  if (o->package_dirs_count && !o->package_dirs)
    throw Error(DYN_ERROR_ARGUMENT, "dynMeshOptions: package_dirs is NULL but package_dirs_count is not 0");
  if (o->package_dirs_count > max_package_dirs)
    throw Error(DYN_ERROR_LIMIT, "dynMeshOptions: package_dirs_count is " + std::to_string(o->package_dirs_count) +
                                     ": give at most " + std::to_string(max_package_dirs));
  for (std::size_t k = 0; k < o->package_dirs_count; ++k) {
    if (!o->package_dirs[k]) throw Error(DYN_ERROR_ARGUMENT, "dynMeshOptions: package_dirs[" + std::to_string(k) + "] is NULL");
    out.package_dirs.push_back(o->package_dirs[k]);
  }
  std::copy(o->scale, o->scale + 3, out.scale.begin());
  out.weld_tolerance = o->weld_tolerance;
  out.up_z = o->up_z != 0;
  if (o->relative_to) out.relative_to = o->relative_to;
  return out;
}

template <class Make>
dynStatus make(dynMesh** out, const char* function, Make f) {
  if (!out) return fail(DYN_ERROR_ARGUMENT, "%s: the output is NULL", function);
  return guarded([&] {
    auto mesh = std::make_unique<meshes::Mesh>(f());
    meshes::prepare(*mesh);
    dynMesh* handle = new_handle<dynMesh>();
    if (!handle) throw std::bad_alloc();
    handle->m = mesh.release();
    handle->magic = live_mesh;
    *out = handle;
    return DYN_OK;
  });
}

// Volume, centre of mass and inertia of the solid within the triangles.
void describe_solid(const meshes::Mesh& mesh, dynMeshInfo& info) {
  info.volume = nan;
  std::fill_n(info.com, 3, nan), std::fill_n(info.inertia, 9, nan);
  if (!mesh.topology.closed) return;
  const meshes::Solid solid = meshes::solid_of(mesh);
  info.orientation = solid.volume > 0 ? 1 : solid.volume < 0 ? -1 : 0;
  if (info.orientation == 0) return;
  info.volume = std::fabs(solid.volume);
  store3(solid.com, info.com);
  const Mat3<double> I = (solid.inertia * double(info.orientation)).full();
  store3(I.x, info.inertia), store3(I.y, info.inertia + 3), store3(I.z, info.inertia + 6);
}

// How it compares with its hull.
void describe_hull(const meshes::Mesh& mesh, double diagonal, dynMeshInfo& info) {
  info.hull_volume = info.hull_volume_ratio = info.hull_depth = nan;
  info.hull_status = guarded([&] {
    const meshes::Mesh hull = meshes::hull_of(mesh);
    info.hull_volume = meshes::solid_of(hull).volume;
    info.hull_volume_ratio = info.hull_volume / info.volume;
    info.hull_depth = meshes::depth_under(mesh, *hull.polytope);
    return DYN_OK;
  });
  if (info.orientation == 0 || info.components != 1) info.convex = 0;
  else info.convex = info.hull_status == DYN_ERROR_UNSUPPORTED ? -1 : info.hull_depth <= meshes::convex_tolerance * diagonal;
}

}  // namespace

template <>
dynHeightField capi::defaults() {
  return {};
}

template <>
dynMeshOptions capi::defaults() {
  dynMeshOptions o{};
  std::fill_n(o.scale, 3, 1.0);
  return o;
}

extern "C" {

dynStatus dyn_mesh_load(const char* path, const dynMeshOptions* options, dynMesh** mesh) {
  if (!path) return fail(DYN_ERROR_ARGUMENT, "dyn_mesh_load: path is NULL");
  const Given<dynMeshOptions> given("dyn_mesh_load", options);
  if (given.status != DYN_OK) return given.status;
  return make(mesh, "dyn_mesh_load", [&] { return meshes::read_mesh(path, read_options(given)); });
}

dynStatus dyn_mesh_from_arrays(const double* vertices, size_t n, const int32_t* triangles, size_t m, dynMesh** mesh) {
  const char* function = "dyn_mesh_from_arrays";
  if (!vertices || n == 0) return fail(DYN_ERROR_ARGUMENT, "%s: there are no vertices", function);
  if (!triangles && m) return fail(DYN_ERROR_ARGUMENT, "%s: triangles is NULL but triangle_count is not 0", function);
  const auto at_most = [](std::uint64_t count) { return std::int64_t(std::min(count, std::uint64_t(1) << 40)); };
  return make(mesh, function, [&] { return meshes::make_mesh(vertices, at_most(n), triangles, at_most(m), 0, function); });
}

dynStatus dyn_mesh_from_height_field(const dynHeightField* field, dynMesh** mesh) {
  constexpr const char* function = "dyn_mesh_from_height_field";
  if (!field) return fail(DYN_ERROR_ARGUMENT, "%s: field is NULL: it is required", function);
  const Given<dynHeightField> f(function, field);
  if (f.status != DYN_OK) return f.status;
  if (!f->heights) return fail(DYN_ERROR_ARGUMENT, "%s: heights is NULL: it is required", function);
  return make(mesh, function,
              [&] { return meshes::height_field(f->heights, f->columns, f->rows, f->step_x, f->step_y, f->bottom); });
}

dynStatus dyn_model_shape_mesh(const dynModel* model, int shape, dynMesh** mesh) {
  if (const dynStatus s = check(model)) return s;
  const Model& m = *model->m;
  if (const dynStatus s = check_index("dyn_model_shape_mesh", "shape", shape, m.n.shapes)) return s;
  return make(mesh, "dyn_model_shape_mesh", [&] {
    const SurfacePtr surface = surface_of(m, shape);
    if (!surface)
      throw Error(DYN_ERROR_ARGUMENT, "dyn_model_shape_mesh: shape " + std::to_string(shape) + " is not made of triangles" +
                                          (m.shapes()[shape].type == DYN_SHAPE_TYPE_MESH
                                               ? ": load the robot with meshes, or give its file to dyn_mesh_load"
                                               : ""));
    return meshes::mesh_of(surface);
  });
}

void dyn_mesh_free(dynMesh* mesh) {
  if (!mesh || mesh->magic != live_mesh) return;
  delete mesh->m;
  mesh->m = nullptr;
  free_handle(mesh);
}

dynStatus dyn_mesh_info(const dynMesh* handle, dynMeshInfo* out) {
  if (const dynStatus s = check(handle)) return s;
  if (const dynStatus s = check_struct("dyn_mesh_info", "info", out)) return s;
  const meshes::Mesh& mesh = *handle->m;
  const meshes::Topology& t = mesh.topology;
  const meshes::Box box = meshes::box_of(mesh);
  dynMeshInfo info{};
  info.vertices = mesh.vertex_count(), info.triangles = mesh.triangle_count();
  info.welded = mesh.welded, info.degenerate = mesh.degenerate, info.duplicates = mesh.duplicates, info.skipped = mesh.skipped;
  store3(box.low, info.lower), store3(box.high, info.upper);
  info.area = meshes::area_of(mesh);
  info.components = t.components, info.open_edges = t.open, info.flipped_edges = t.flipped, info.nonmanifold_edges = t.crowded,
  info.closed = t.closed;
  describe_solid(mesh, info);
  describe_hull(mesh, box.diagonal(), info);
  if (info.hull_status == DYN_ERROR_MEMORY) return info.hull_status;
  write_struct(info, out);
  return DYN_OK;
}

dynStatus dyn_mesh_arrays(const dynMesh* handle, dynMeshArrays* out) {
  if (const dynStatus s = check(handle)) return s;
  if (const dynStatus s = check_struct("dyn_mesh_arrays", "arrays", out)) return s;
  const meshes::Mesh& mesh = *handle->m;
  dynMeshArrays a{};
  a.vertices = mesh.vertices.data(), a.vertex_count = std::size_t(mesh.vertex_count());
  a.triangles = mesh.triangles.data(), a.triangle_count = std::size_t(mesh.triangle_count());
  if (const auto& p = mesh.polytope) {
    a.face_count = p->face_start.size() - 1;
    a.planes = p->planes.data(), a.face_start = p->face_start.data(), a.face_corners = p->face_corners.data();
    a.neighbour_start = p->neighbour_start.data(), a.neighbours = p->neighbours.data();
  }
  write_struct(a, out);
  return DYN_OK;
}

dynStatus dyn_mesh_rgb(const dynMesh* handle, double* rgb) {
  if (const dynStatus s = check(handle)) return s;
  if (!rgb) return fail(DYN_ERROR_ARGUMENT, "dyn_mesh_rgb: rgb is NULL");
  const meshes::Mesh& mesh = *handle->m;
  for (std::size_t t = 0; t < std::size_t(mesh.triangle_count()); ++t)
    std::copy_n(rgba_of(mesh.colours.empty() ? 0 : mesh.colours[t]).begin(), 3, rgb + 3 * t);
  return DYN_OK;
}

dynStatus dyn_mesh_hull(const dynMesh* handle, dynMesh** hull) {
  if (const dynStatus s = check(handle)) return s;
  return make(hull, "dyn_mesh_hull", [&] { return meshes::hull_of(*handle->m); });
}

}  // extern "C"
