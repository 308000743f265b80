#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

#include "dyn/model/save.hpp"
#include "dynb.hpp"

namespace dyn {

namespace {

// Bytes between the members of a record hold anything: zeros, so that the same model is the same file.
template <class T>
void clear_padding([[maybe_unused]] T* x, [[maybe_unused]] std::size_t n) {
#if defined(__has_builtin)
#if __has_builtin(__builtin_clear_padding)
  for (std::size_t k = 0; k < n; ++k) __builtin_clear_padding(x + k);
#endif
#endif
}

}  // namespace

std::string save_dynb(const Model& m) {
  std::string out(sizeof(load::DynbHeader) + m.bytes, '\0');
  char* block = out.data() + sizeof(load::DynbHeader);
  std::memcpy(block, &m, m.bytes);
  const std::uint64_t none = 0;  // the number of a model in its process
  std::memcpy(block + offsetof(Model, id), &none, sizeof none);
  const ModelSizes& n = m.n;
#define FIELD(type, field, count, sentence)                                                                             \
  if (const std::size_t bytes = std::size_t(count) * sizeof(type)) {                                                    \
    std::unique_ptr<void, void (*)(void*)> aligned(std::aligned_alloc(64, (bytes + 63) / 64 * 64), std::free);          \
    if (!aligned) throw std::bad_alloc();                                                                               \
    std::memcpy(aligned.get(), m.field(), bytes);                                                                       \
    clear_padding(static_cast<type*>(aligned.get()), std::size_t(count));                                               \
    std::memcpy(block + 8 * std::size_t(m.offset[std::size_t(Model::Field::field)]), aligned.get(), bytes);                              \
  }
#include "dyn/model/model_fields.def"
#undef FIELD
  load::seal_dynb(out);
  return out;
}

}  // namespace dyn
