// What stands for a mesh in collision tests, and what the load report says of it: dynMeshUse.
#pragma once

#include "mesh.hpp"

namespace dyn::load {

struct MeshStand {
  std::shared_ptr<const SurfaceData> surface;
  bool warning;
  std::string said;  // after "mesh 'name'"
};
MeshStand stand_for(const meshes::Mesh& mesh, dynMeshUse use);

}  // namespace dyn::load
