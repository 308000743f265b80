// Files of other libraries: of version 2, which is without the states of configurations and without the steps of the file
// (Model::simulation), of version 3, whose tag was made in another way, of version 4, which is without tendons, and of this version
// with another number of coefficients.
#include <algorithm>
#include <cstddef>
#include <cstring>

#include "algorithm/actuators.hpp"
#include "dynb.hpp"
#include "effect/list.hpp"

namespace dyn::load {

namespace {

constexpr std::size_t round_up(std::size_t x, std::size_t boundary) { return (x + boundary - 1) / boundary * boundary; }

// Numbers of the coefficients, as members of their names.
struct Numbers {
#define COEFFICIENT(name, has, sentence) std::size_t name = std::size_t(Model::Field::name) - first_coefficient;
#include "effect/coefficients.def"
};

// What came with version 5: arrays of paths, of mocap bodies and of ellipsoids in a medium, and the ends of dynActuator and of
// ActuatorRecord.
constexpr bool is_path_field(Model::Field field) {
  using F = Model::Field;
  return field == F::tendons || field == F::paths || field == F::path_elements || field == F::path_dofs ||
         field == F::path_parents || field == F::mocaps || field == F::configuration_mocaps || field == F::sensors || field == F::force_limits ||
         field == F::compliances || field == F::fluid_ellipsoids;
}
constexpr std::size_t path_fields = 11;
constexpr std::size_t old_actuator_spec_size = offsetof(dynActuator, transmission);
constexpr std::size_t old_actuator_size =
    old_actuator_spec_size + offsetof(ActuatorRecord, path) - offsetof(ActuatorRecord, gain);

// What a file holds.
struct Written {
  std::uint32_t version = 0;
  std::size_t coefficients = 4;

  constexpr bool has(Model::Field field) const {
    if (is_coefficient_field(field)) return std::size_t(field) - first_coefficient < coefficients;
    if (is_path_field(field)) return has_paths();
    return version > 2 || (field != Model::Field::configuration_states && field != Model::Field::simulation);
  }
  constexpr bool has_paths() const { return version > 4; }
  // Of ModelSizes, of Model up to its offsets, and of Model.
  constexpr std::size_t sizes_size() const { return has_paths() ? sizeof(ModelSizes) : offsetof(ModelSizes, tendons); }
  constexpr std::size_t header_size() const { return offsetof(Model, offset) - sizeof(ModelSizes) + sizes_size(); }
  constexpr std::size_t model_size() const {
    const std::size_t fields = std::size_t(Model::Field::count_) - coefficient_count + coefficients - (version > 2 ? 0 : 2) -
                               (has_paths() ? 0 : path_fields);
    return round_up(header_size() + fields * sizeof(std::uint32_t), alignof(Model));
  }
  constexpr std::size_t element_size(Model::Field field, std::size_t size) const {
    return field == Model::Field::joints ? joint_size()
           : field == Model::Field::actuators && !has_paths() ? old_actuator_size : size;
  }
  constexpr std::size_t joint_size() const {
    return round_up(offsetof(JointRecord, armature) + (coefficients + 1) * sizeof(double), alignof(JointRecord));
  }
  // dynb_tag() of version 4.
  constexpr std::uint64_t tag4() const {
    std::uint64_t sum = 0xcbf29ce484222325u;
    const auto add = [&](std::uint64_t x) { sum = (sum ^ x) * 0x100000001b3u; };
    for (const std::size_t size : {sizeof(DynbHeader), sizes_size(), sizeof(Index), header_size(), sizeof(Vec3<double>),
                                   alignof(Vec3<double>), offsetof(JointRecord, armature) - sizeof(JointRecord::C)})
      add(size);
    const auto add_field = [&](Model::Field field, std::size_t size, std::size_t alignment, const char* name) {
      if (is_coefficient_field(field) || !has(field)) return;
      if (field != Model::Field::joints) add(element_size(field, size)), add(alignment);
      for (; *name; ++name) add(std::uint64_t(*name));
    };
#define FIELD(type, name, count, sentence) add_field(Model::Field::name, sizeof(type), alignof(type), #name);
#include "model/model_fields.def"
#undef FIELD
    return sum << 8;
  }
  // And of versions 2 and 3.
  constexpr std::uint64_t older_tag() const {
    std::uint64_t sum = 0xcbf29ce484222325u;
    const auto add = [&](std::uint64_t x) { sum = (sum ^ x) * 0x100000001b3u; };
    for (const std::size_t size :
         {sizeof(DynbHeader), model_size(), sizes_size(), sizeof(Index), alignof(Vec3<double>), header_size()})
      add(size);
    const auto add_field = [&](Model::Field field, std::size_t size, std::size_t alignment, const char* name) {
      if (!has(field)) return;
      add(element_size(field, size)), add(alignment);
      for (; *name; ++name) add(std::uint64_t(*name));
    };
#define FIELD(type, name, count, sentence) add_field(Model::Field::name, sizeof(type), alignof(type), #name);
#include "model/model_fields.def"
#undef FIELD
    return sum;
  }
};

// Version 0: this library's own, or no file with a right checksum. Only what is read here is checked; the result is checked as a
// file of this library.
Written written(const std::string& bytes) {
  DynbHeader h;
  if (bytes.size() < sizeof h || bytes.size() % 8) return {};
  std::memcpy(&h, bytes.data(), sizeof h);
  Written w{h.version};
  if (h.version == dynb_version) {
    w.coefficients = h.tag & 255;
    if (h.tag >> 8 != dynb_layout() >> 8 || w.coefficients == coefficient_count) return {};
  } else if (h.version == 4) {
    w.coefficients = h.tag & 255;
    if (h.tag >> 8 != w.tag4() >> 8) return {};
  } else if ((h.version != 2 && h.version != 3) || h.tag != w.older_tag()) {
    return {};
  }
  constexpr std::size_t summed = offsetof(DynbHeader, handle);
  const std::uint64_t seal = h.version >= 4 ? h.tag : 0;
  const bool sound = std::memcmp(h.magic, dynb_magic, sizeof h.magic) == 0 && h.byte_order == dynb_byte_order &&
                     h.bytes == bytes.size() - sizeof h && h.bytes >= w.model_size() &&
                     h.checksum == (seal ^ dynb_checksum(bytes.data() + summed, bytes.size() - summed));
  return sound ? w : Written{};
}

void require_zero(const char* from, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    double x;
    std::memcpy(&x, from + k * sizeof x, sizeof x);
    if (x != 0)
      throw Error(DYN_ERROR_UNSUPPORTED, "the .dynb is of a newer library, and a joint has an effect that this library lacks: "
                                         "read it with the newer one");
  }
}

// Effects that the file's library lacked are not among those that the file switches off.
std::uint32_t known_effects(std::uint32_t effects, const Written& w) {
  const Numbers numbers;
  for_each_coefficient([&]<class E>() {
    if (E::of(numbers) >= w.coefficients) effects |= E::bit;
  });
  if (!w.has_paths()) effects |= DYN_EFFECT_TENDONS | DYN_EFFECT_FLUID_ELLIPSOIDS;
  return effects & DYN_EFFECT_ALL;
}

class Translation {
 public:
  Translation(const std::string& bytes, const Written& w)
      : w_(w),
        block_(bytes.data() + sizeof(DynbHeader)),
        size_(bytes.size() - sizeof(DynbHeader)),
        offsets_(block_ + w.header_size()) {}

  std::string run() {
    constexpr std::size_t sizes = offsetof(Model, n);
    std::memcpy(memory_, block_, sizes + w_.sizes_size());
    std::memcpy(memory_ + sizes + sizeof(ModelSizes), block_ + sizes + w_.sizes_size(),
        w_.header_size() - sizes - w_.sizes_size());
    Model& m = *reinterpret_cast<Model*>(memory_);
    const ModelSizes& n = m.n;
    Index counts[sizeof(ModelSizes) / sizeof(Index)];
    std::memcpy(counts, &n, sizeof counts);
    for (const Index x : counts)
      if (x < 0 || std::size_t(x) > size_) fail_of_damage("a size is out of range");
    if (std::uint64_t(n.configurations) * std::uint64_t(n.nq) > size_)
      fail_of_damage("its configurations are larger than the file");
    out_.resize(sizeof(Model));
#define FIELD(type, name, count, sentence)                                               \
  m.offset[std::size_t(Model::Field::name)] = begin(alignof(type));                      \
  append(Model::Field::name, sizeof(type), count_of(std::int64_t(count), sizeof(type))); \
  if constexpr (Model::Field::name == last_coefficient) skip_unknown_coefficients(std::size_t(n.nv));
#include "model/model_fields.def"
#undef FIELD
    out_.resize(round_up(out_.size(), 64));
    m.bytes = out_.size();
    std::memcpy(out_.data(), memory_, sizeof memory_);
    out_.insert(0, sizeof(DynbHeader), '\0');
    seal_dynb(out_);
    return std::move(out_);
  }

 private:
  static constexpr auto last_coefficient = Model::Field(first_coefficient + coefficient_count - 1);

  std::uint32_t begin(std::size_t alignment) {
    out_.resize(round_up(out_.size(), alignment > alignof(double) ? 64 : alignof(double)));
    return std::uint32_t(out_.size() / 8);
  }

  static std::size_t count_of(std::int64_t count, std::size_t element) {
    if (count < 0 || std::uint64_t(count) > (std::uint64_t(1) << 31) / element) fail_of_damage("a size is out of range");
    return std::size_t(count);
  }

  // The file's next array.
  const char* next(std::size_t element, std::size_t count) {
    std::uint32_t eighths;
    std::memcpy(&eighths, offsets_, sizeof eighths);
    offsets_ += sizeof eighths;
    const std::uint64_t at = 8 * std::uint64_t(eighths);
    if (at > size_ || count > (size_ - at) / element) fail_of_damage("its arrays are larger than the file");
    return block_ + at;
  }

  void append(Model::Field field, std::size_t element, std::size_t count) {
    if (!w_.has(field)) return append_neutral(field, element, count);
    if (field == Model::Field::joints) return append_joints(next(w_.joint_size(), count), count);
    if (field == Model::Field::actuators && !w_.has_paths()) return append_actuators(next(old_actuator_size, count), count);
    out_.append(next(element, count), element * count);
    if (field == Model::Field::frames && !w_.has_paths()) set_places(count);
    if (field == Model::Field::simulation) {
      char* const to = out_.data() + out_.size() - sizeof(SimulationRecord) + offsetof(SimulationRecord, effects);
      std::uint32_t effects;
      std::memcpy(&effects, to, sizeof effects);
      effects = known_effects(effects, w_);
      std::memcpy(to, &effects, sizeof effects);
    }
  }

  // Of the frames at the end of out_.
  void set_places(std::size_t count) {
    char* at = out_.data() + out_.size() - count * sizeof(FrameRecord);
    for (std::size_t k = 0; k < count; ++k, at += sizeof(FrameRecord)) {
      std::memcpy(at + offsetof(FrameRecord, place), at + offsetof(FrameRecord, body), sizeof(Index));
      std::memset(at + offsetof(FrameRecord, padding), 0, sizeof(Index));
    }
  }

  void append_neutral(Model::Field field, std::size_t element, std::size_t count) {
    const SimulationRecord simulation;
    if (field == Model::Field::simulation) out_.append(reinterpret_cast<const char*>(&simulation), sizeof simulation);
    else out_.append(element * count, '\0');
  }

  void append_actuators(const char* from, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k, from += old_actuator_size) {
      ActuatorRecord r{};
      r.spec = default_actuator(DYN_ACTUATOR_TYPE_MOTOR);
      std::memcpy(&r.spec, from, old_actuator_spec_size);
      std::memcpy(r.gain, from + old_actuator_spec_size, old_actuator_size - old_actuator_spec_size);
      r.spec.struct_size = sizeof r.spec, r.path = r.row = r.limit = -1, r.spec.activations = activations_of(r.spec);
      out_.append(reinterpret_cast<const char*>(&r), sizeof r);
    }
  }

  void append_joints(const char* from, std::size_t count) {
    constexpr std::size_t first = offsetof(JointRecord, armature), spring_reference = offsetof(JointRecord, spring_reference);
    const std::size_t common = std::min(w_.coefficients, coefficient_count) * sizeof(double);
    for (std::size_t k = 0; k < count; ++k, from += w_.joint_size()) {
      char record[sizeof(JointRecord)] = {};
      std::memcpy(record, from, first + common);
      require_zero(from + first + common, w_.coefficients - common / sizeof(double));
      std::memcpy(record + spring_reference, from + first + w_.coefficients * sizeof(double), sizeof(double));
      out_.append(record, sizeof record);
    }
  }

  void skip_unknown_coefficients(std::size_t nv) {
    for (std::size_t k = coefficient_count; k < w_.coefficients; ++k) require_zero(next(sizeof(double), nv), nv);
  }

  const Written& w_;
  const char* const block_;
  const std::size_t size_;
  const char* offsets_;
  alignas(Model) char memory_[sizeof(Model)] = {};
  std::string out_;
};

}  // namespace

std::string translate_dynb(const std::string& bytes) {
  const Written w = written(bytes);
  return w.version ? Translation(bytes, w).run() : std::string();
}

}  // namespace dyn::load
