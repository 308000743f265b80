// Shared by the harnesses: a folder for files of this process, and work for models that were loaded.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "dyn.h"

namespace fuzz {

// In memory, for this process only.
inline const std::string& folder() {
  static const std::string path = [] {
    const std::string made = "/dev/shm/dyn_fuzz_" + std::to_string(getpid());
    std::filesystem::create_directories(made);
    std::atexit([] {
      std::error_code ignored;
      std::filesystem::remove_all("/dev/shm/dyn_fuzz_" + std::to_string(getpid()), ignored);
    });
    return made;
  }();
  return path;
}
inline std::string file(const std::string& name, const void* bytes, size_t size) {
  const std::string path = folder() + "/" + name;
  std::FILE* f = std::fopen(path.c_str(), "wb");
  if (!f || std::fwrite(bytes, 1, size, f) != size || std::fclose(f) != 0) std::abort();
  return path;
}

// All algorithms must run on a loaded model, and it can be saved.
inline void use(const dynModel* m) {
  const int nv = dyn_model_nv(m);
  if (nv > 200 || dyn_model_nshapes(m) > 200 || dyn_model_size(m) > (1 << 22) ||
      dyn_data_size(m, DYN_PART_ALL) > (size_t(1) << 26))
    return;
  dynData* d = nullptr;
  if (dyn_data_new(m, DYN_PART_ALL, &d) != DYN_OK) return;
  const std::vector<double> ones(size_t(nv) + 1, 1.0);
  dyn_rnea(m, d, nullptr, ones.data(), ones.data(), nullptr, nullptr);
  dyn_aba(m, d, nullptr, ones.data(), ones.data(), nullptr, nullptr);
  dyn_distances(m, d, nullptr, nullptr);
  dyn_constrained_dynamics(m, d, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr);
  for (int k = 0; k < 2; ++k) dyn_step(m, d);
  dyn_data_free(d);
}

// Loads a text, runs the model, and saves it in all formats.
inline void load(const uint8_t* bytes, size_t size, dynBase base, const char* srdf = nullptr) {
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = base, options.confined = 1, options.srdf = srdf;
  dynModel* m = nullptr;
  if (dyn_model_load_string(text.c_str(), &options, &m) != DYN_OK) return;
  use(m);
  for (const dynFormat format : {DYN_FORMAT_URDF, DYN_FORMAT_MJCF, DYN_FORMAT_DYNB}) {
    size_t written = 0;
    if (dyn_model_save_memory(m, format, nullptr, nullptr, 0, &written) != DYN_OK) continue;
  }
  dyn_model_free(m);
}

}  // namespace fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size);
