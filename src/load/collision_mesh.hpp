// What stands for a mesh in collision tests, and what the load report says of it: dynMeshUse.
#pragma once

#include "mesh.hpp"

namespace dyn::load {

struct CollisionMesh {
  std::shared_ptr<const SurfaceData> surface;
  bool warning;
  std::string message;  // after "mesh 'name'"
};
CollisionMesh collision_mesh_of(const meshes::Mesh& mesh, dynMeshUse use);

}  // namespace dyn::load
