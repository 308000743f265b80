// The module with assimp and qhull in it.
#pragma once

#include "mesh/module.hpp"

namespace dyn::load {

// Opens it when it is first asked for. Throws DYN_ERROR_UNSUPPORTED, saying where it was looked for.
const mesh::Module& mesh_module();

}  // namespace dyn::load
