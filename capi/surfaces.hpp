// The mesh handles that shapes are made of.
#pragma once

#include "guard.hpp"
#include "load/mesh.hpp"
#include "model/builder_surface.hpp"

namespace dyn::capi {

// The surface of a mesh handle, for a shape of this type. Types without surface need none.
inline dynStatus surface_argument(const char* function, const char* name, dynShapeType type, const dynMesh* mesh,
                                  SurfacePtr& out) {
  const bool convex = type == DYN_SHAPE_TYPE_CONVEX, triangles = type == DYN_SHAPE_TYPE_TRIANGLES,
             grid = type == DYN_SHAPE_TYPE_HEIGHT_FIELD;
  if (!convex && !triangles && !grid)
    return mesh ? fail(DYN_ERROR_ARGUMENT,
                       "%s: %s: a surface is given, but the type is %d: use DYN_SHAPE_TYPE_CONVEX, TRIANGLES or HEIGHT_FIELD, or "
                       "leave surface NULL",
                       function, name, raw(type))
                : DYN_OK;
  if (!mesh)
    return fail(DYN_ERROR_ARGUMENT, "%s: %s: surface is NULL: give %s", function, name,
                convex      ? "a hull (dyn_mesh_hull)"
                : triangles ? "a mesh (dyn_mesh_load, dyn_mesh_from_arrays)"
                            : "a height field (dyn_mesh_from_height_field)");
  if (const dynStatus s = check(mesh)) return s;
  out = convex ? mesh->m->convex : triangles ? mesh->m->tree : mesh->m->grid;
  if (out) return DYN_OK;
  if (convex && mesh->m->polytope)
    return fail(DYN_ERROR_LIMIT, "%s: %s: the hull has %d vertices, and the limit is %d: simplify the mesh", function, name,
                int(mesh->m->vertex_count()), int(meshes::max_hull_vertices));
  return fail(DYN_ERROR_ARGUMENT, "%s: %s: surface is %s", function, name,
              convex      ? "no hull: give what dyn_mesh_hull makes of it"
              : triangles ? "a hull or a cloud of points: use DYN_SHAPE_TYPE_CONVEX with a hull, or give a mesh with triangles"
                          : "no height field: give one of dyn_mesh_from_height_field");
}

}  // namespace dyn::capi
