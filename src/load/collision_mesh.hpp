// The collision shape of a mesh (dynMeshUse) and its entry in the load report.
#pragma once

#include "mesh.hpp"

namespace dyn::load {

struct CollisionMesh {
  dynShapeType type = DYN_SHAPE_TYPE_MESH;
  std::shared_ptr<const SurfaceData> surface = nullptr;
  bool warning = false;
  std::string message = "";  // after "mesh 'name'"
};
CollisionMesh collision_mesh_of(const meshes::Mesh& mesh, dynMeshUse use);

}  // namespace dyn::load
