#include <cstring>

#include "dynb.hpp"

namespace dyn {

std::string save_dynb(const Model& m) {
  std::string out(sizeof(load::DynbHeader) + m.bytes, '\0');
  char* block = out.data() + sizeof(load::DynbHeader);
  std::memcpy(block, &m, m.bytes);
  const std::uint64_t none = 0;  // the number of a model in its process
  std::memcpy(block + offsetof(Model, id), &none, sizeof none);
  load::seal_dynb(out);
  return out;
}

}  // namespace dyn
