// Mesh files. The first byte selects the format.
#include "fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  if (size < 1) return 0;
  static const char* const kinds[] = {"m.stl", "m.obj", "m.dae", "m.gltf", "m.glb"};
  const std::string path = fuzz::file(kinds[bytes[0] % 5], bytes + 1, size - 1);
  dynMesh *mesh = nullptr, *hull = nullptr;
  if (dyn_mesh_load(path.c_str(), nullptr, &mesh) == DYN_OK && dyn_mesh_hull(mesh, &hull) == DYN_OK) dyn_mesh_free(hull);
  dyn_mesh_free(mesh);
  return 0;
}
