// .dynb files as given, and with a valid checksum so that the rest is reached; loaded and in place.
#include <cstring>

#include "fuzz/fuzz.hpp"
#include "load/dynb.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  std::string file(reinterpret_cast<const char*>(bytes), size);
  if (size >= sizeof(dyn::DynbHeader) && size % 8 == 0) dyn::load::seal_dynb(file);
  const std::unique_ptr<void, void (*)(void*)> memory(std::aligned_alloc(64, (file.size() + 63) / 64 * 64), std::free);
  std::memcpy(memory.get(), file.data(), file.size());
  const dynModel* placed = nullptr;
  if (dyn_model_from_buffer(memory.get(), file.size(), &placed) == DYN_OK) fuzz::use(placed);
  const std::string path = fuzz::file("model.dynb", file.data(), file.size());
  dynModel* m = nullptr;
  if (dyn_model_load(path.c_str(), nullptr, &m) == DYN_OK) fuzz::use(m);
  dyn_model_free(m);
  return 0;
}
