#include "mesh_module.hpp"

#ifdef DYN_MESH_LINKED

extern "C" const dyn::mesh::Module* dyn_mesh_module(std::uint32_t version);

const dyn::mesh::Module& dyn::load::mesh_module() { return *dyn_mesh_module(mesh::module_version); }

#else

#include <dlfcn.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "model/builder.hpp"

namespace dyn::load {

namespace {

namespace fs = std::filesystem;
constexpr const char* file_name = "libdyn_mesh.so";

std::vector<std::string> candidates() {
  std::vector<std::string> files;
  Dl_info here{};
  if (dladdr(reinterpret_cast<const void*>(&mesh_module), &here) && here.dli_fname) {
    std::error_code ignored;
    const fs::path library = fs::absolute(here.dli_fname, ignored);
    for (const fs::path& file : {library, fs::canonical(library, ignored)}) files.push_back((file.parent_path() / file_name).string());
    if (files[0] == files[1]) files.pop_back();
  }
  files.push_back(file_name);  // searched by the dynamic loader
  return files;
}

const mesh::Module* open(const std::string& file, std::string& why) {
  std::error_code ignored;
  if (file.find('/') != file.npos && !fs::exists(file, ignored)) {
    why = "no such file";
    return nullptr;
  }
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    const char* error = dlerror();
    why = error ? error : "cannot be opened";
    return nullptr;
  }
  const auto get = reinterpret_cast<mesh::GetModule>(dlsym(library, mesh::module_function));
  const mesh::Module* module = get ? get(mesh::module_version) : nullptr;
  if (module && module->size >= sizeof(mesh::Module)) return module;
  why = "another version than this libdyn";
  dlclose(library);
  return nullptr;
}

}  // namespace

const mesh::Module& mesh_module() {
  static std::mutex mutex;
  static const mesh::Module* module = nullptr;
  const std::lock_guard lock(mutex);
  if (module) return *module;
  std::string tried;
  for (const std::string& file : candidates()) {
    std::string why;
    if ((module = open(file, why))) return *module;
    tried += (tried.empty() ? "" : ", ") + file + " (" + why + ")";
  }
  throw Error(DYN_ERROR_UNSUPPORTED,
              "hulls need libdyn's module " + std::string(file_name) +
                  ", which cannot be opened: install it beside libdyn.so with the package of qhull, or build libdyn "
                  "with libqhull-dev installed; tried " +
                  tried);
}

}  // namespace dyn::load

#endif
