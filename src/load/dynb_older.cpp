// Files of version 2, which is without the states of configurations and without the steps of the file (Model::simulation).
#include <cstddef>
#include <cstring>

#include "dynb.hpp"

namespace dyn::load {

namespace {

constexpr bool is_new(Model::Field field) {
  return field == Model::Field::configuration_states || field == Model::Field::simulation;
}
constexpr std::size_t new_fields = 2, fields = std::size_t(Model::Field::count_);
constexpr std::size_t round_up(std::size_t x, std::size_t boundary) { return (x + boundary - 1) / boundary * boundary; }
constexpr std::size_t older_model =
    round_up(offsetof(Model, offset) + (fields - new_fields) * sizeof(std::uint32_t), alignof(Model));

// dynb_tag() of version 2.
constexpr std::uint64_t older_tag() {
  std::uint64_t sum = 0xcbf29ce484222325u;
  const auto add = [&](std::uint64_t x) { sum = (sum ^ x) * 0x100000001b3u; };
  for (const std::size_t size :
       {sizeof(DynbHeader), older_model, sizeof(ModelSizes), sizeof(Index), alignof(Vec3<double>), offsetof(Model, offset)})
    add(size);
#define FIELD(type, name, count, sentence)         \
  if (!is_new(Model::Field::name)) {               \
    add(sizeof(type)), add(alignof(type));         \
    for (const char* c = #name; *c; ++c) add(std::uint64_t(*c)); \
  }
#include "model/model_fields.def"
#undef FIELD
  return sum;
}

// Only what is read here is checked; the result is checked as a file of this version.
bool is_sound(const std::string& bytes) {
  DynbHeader h;
  if (bytes.size() < sizeof h + older_model || bytes.size() % 8) return false;
  std::memcpy(&h, bytes.data(), sizeof h);
  constexpr std::size_t summed = offsetof(DynbHeader, handle);
  return std::memcmp(h.magic, dynb_magic, sizeof h.magic) == 0 && h.version == 2 && h.byte_order == dynb_byte_order &&
         h.tag == older_tag() && h.bytes == bytes.size() - sizeof h &&
         h.checksum == dynb_checksum(bytes.data() + summed, bytes.size() - summed);
}

}  // namespace

std::string from_older_dynb(const std::string& bytes) {
  if (!is_sound(bytes)) return {};
  const char* const block = bytes.data() + sizeof(DynbHeader);
  const std::size_t size = bytes.size() - sizeof(DynbHeader);
  alignas(Model) char memory[sizeof(Model)] = {};
  std::memcpy(memory, block, offsetof(Model, offset));
  Model& m = *reinterpret_cast<Model*>(memory);
  const ModelSizes& n = m.n;
  Index sizes[sizeof(ModelSizes) / sizeof(Index)];
  std::memcpy(sizes, &n, sizeof sizes);
  for (const Index x : sizes)
    if (x < 0 || std::size_t(x) > size) return {};
  std::string out(sizeof(Model), '\0');
  const char* older_offset = block + offsetof(Model, offset);
  const SimulationRecord simulation;
  bool good = true;
  const auto append = [&](Model::Field field, std::size_t element, std::size_t boundary, std::int64_t count) {
    out.resize(round_up(out.size(), boundary));
    m.offset[std::size_t(field)] = std::uint32_t(out.size() / 8);
    if (is_new(field)) {
      good = good && count >= 0 && std::uint64_t(count) <= (std::uint64_t(1) << 31) / element;
      if (!good) return;
      if (field == Model::Field::simulation) out.append(reinterpret_cast<const char*>(&simulation), sizeof simulation);
      else out.append(std::size_t(count) * element, '\0');
      return;
    }
    std::uint32_t eighths;
    std::memcpy(&eighths, older_offset, sizeof eighths);
    older_offset += sizeof eighths;
    const std::uint64_t at = 8 * std::uint64_t(eighths);
    good = good && count >= 0 && at <= size && std::uint64_t(count) <= (size - at) / element;
    if (good) out.append(block + at, std::size_t(count) * element);
  };
#define FIELD(type, name, count, sentence) \
  append(Model::Field::name, sizeof(type), alignof(type) > alignof(double) ? 64 : alignof(double), std::int64_t(count));
#include "model/model_fields.def"
#undef FIELD
  if (!good) return {};
  out.resize(round_up(out.size(), 64));
  m.bytes = out.size();
  std::memcpy(out.data(), memory, sizeof memory);
  out.insert(0, sizeof(DynbHeader), '\0');
  seal_dynb(out);
  return out;
}

}  // namespace dyn::load
