// The collision shape of a mesh (dynMeshUse) and its entry in the load report.
#pragma once

#include "mesh.hpp"

namespace dyn::load {

struct CollisionMesh {
  std::shared_ptr<const SurfaceData> surface;
  bool warning;
  std::string message;  // after "mesh 'name'"; "": no entry
};
CollisionMesh collision_mesh_of(const meshes::Mesh& mesh, dynMeshUse use);
dynShapeType collision_type_of(dynMeshUse use);
// Behind the reason why a collision mesh has no shape.
inline constexpr const char* not_tested = ": it is not tested for collision";

}  // namespace dyn::load
