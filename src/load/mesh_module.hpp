// The module that holds qhull.
#pragma once

#include "mesh/module.hpp"

namespace dyn::load {

// Opens the module on first use. Throws DYN_ERROR_UNSUPPORTED with the paths tried.
const mesh::Module& mesh_module();

}  // namespace dyn::load
