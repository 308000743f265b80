#include "dynb.hpp"

#include <cstring>

#include "dyn/constraint/list.hpp"
#include "dyn/model/block.hpp"
#include "model/builder_impl.hpp"
#include "model/builder_surface.hpp"
#include "report.hpp"

namespace dyn {

namespace load {

namespace {

constexpr std::uint64_t fnv_basis = 0xcbf29ce484222325u, fnv_prime = 0x100000001b3u;

}  // namespace

std::uint64_t dynb_checksum(const char* block, std::size_t bytes) {
  std::uint64_t sum = fnv_basis;
  for (std::size_t k = 0; k < bytes; k += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, block + k, std::min<std::size_t>(8, bytes - k));
    sum = (sum ^ word) * fnv_prime;
    sum ^= sum >> 32;  // so that high bits of a word reach low ones of the sum
  }
  return sum;
}

std::uint64_t dynb_tag() {
  std::uint64_t sum = fnv_basis;
  const auto add = [&](std::uint64_t x) { sum = (sum ^ x) * fnv_prime; };
  for (const std::size_t size : {sizeof(Model), sizeof(ModelSizes), sizeof(void*), sizeof(Index), alignof(Vec3<double>), offsetof(Model, offset)}) add(size);
#define FIELD(type, name, count, sentence) \
  add(sizeof(type)), add(alignof(type));   \
  for (const char c : std::string_view(#name)) add(std::uint64_t(c));
#include "dyn/model/model_fields.def"
#undef FIELD
  return sum;
}

void seal_dynb(std::string& file) {
  DynbHeader h{};
  std::memcpy(h.magic, dynb_magic, sizeof h.magic);
  h.version = dynb_version, h.byte_order = dynb_byte_order, h.tag = dynb_tag(), h.bytes = file.size() - sizeof h;
  h.checksum = dynb_checksum(file.data() + sizeof h, file.size() - sizeof h);
  std::memcpy(file.data(), &h, sizeof h);
}

void damaged(const std::string& what) { throw Error(DYN_ERROR_PARSE, "the file is damaged: " + what + ": make it anew from the robot file"); }

namespace {

void check_header(const std::string& file) {
  DynbHeader h;
  if (file.size() < sizeof h) damaged("it ends within its header");
  std::memcpy(&h, file.data(), sizeof h);
  if (std::memcmp(h.magic, dynb_magic, sizeof h.magic) != 0) damaged("its first eight bytes are not those of a .dynb");
  const auto other = [](const std::string& what) { throw Error(DYN_ERROR_UNSUPPORTED, "the .dynb is " + what + ": make it anew from the robot file"); };
  if (h.byte_order != dynb_byte_order) other("of a machine with another order of bytes");
  if (h.version != dynb_version) other("of version " + std::to_string(h.version) + ", and this library reads version " + std::to_string(dynb_version));
  if (h.tag != dynb_tag()) other("of a build whose models lie in memory in another way");
  if (h.bytes != file.size() - sizeof h) damaged("it should have " + std::to_string(h.bytes) + " bytes after its header, and has " + std::to_string(file.size() - sizeof h));
  if (h.checksum != dynb_checksum(file.data() + sizeof h, h.bytes)) damaged("its checksum is wrong");
  if (h.bytes < sizeof(Model)) damaged("it is too short for a model");
}

// Adds all of the model to a builder as a user would, for what the builder says of names and numbers.
void check_by_building(const Model& m) {
  Builder b(m.string(m.model_name));
  b.gravity({m.gravity[0], m.gravity[1], m.gravity[2]});
  b.medium(m.density, m.viscosity, {m.wind[0], m.wind[1], m.wind[2]});
  b.constraint_slots(m.n.slots - m.n.constraints);
  const auto placement = [](const double* x) {
    Placement out;
    std::copy(x, x + 12, out.begin());
    return out;
  };
  const auto on = [&](Index joint) { return joint ? Parent{m.string(m.joints()[joint].name), DYN_FRAME_JOINT} : Parent{"", 0}; };
  Index joints = 0;
  for (Index f = 1; f < m.n.frames; ++f) {
    const FrameRecord& r = m.frames()[f];
    const std::string name = m.string(r.name);
    if (r.type == DYN_FRAME_JOINT) {
      if (name != m.string(m.joints()[r.joint].name)) damaged("joint '" + name + "' and its frame have different names");
      JointSpec s = spec_of(m, m.joints()[r.joint]);
      s.parent = on(m.joints()[r.joint].parent);
      b.joint(s), ++joints;
    } else if (r.type == DYN_FRAME_BODY) {
      const LinkRecord& l = m.links()[r.link];
      std::array<double, 9> inertia;
      std::copy(l.inertia, l.inertia + 9, inertia.begin());
      b.body(name, on(r.joint), placement(r.placement), l.mass, {l.com[0], l.com[1], l.com[2]}, inertia);
      b.gravity_compensation(name, m.compensation(r.link));
    } else if (r.type == DYN_FRAME_FIXED_JOINT) {
      JointSpec s;
      s.name = name, s.type = DYN_JOINT_FIXED, s.parent = on(r.joint), s.placement = placement(r.placement);
      b.joint(s);
    } else {
      b.frame(name, on(r.joint), placement(r.placement), r.type);
    }
  }
  if (joints != m.n.joints - 1) damaged("it has " + std::to_string(m.n.joints - 1) + " joints, and frames of " + std::to_string(joints));
  for (Index k = 0; k < m.n.shapes; ++k) {
    const ShapeRecord& r = m.shapes()[k];
    Shape s{m.string(r.name), r.type, dynShapeRole(r.role), m.string(m.frames()[r.frame].name), placement(r.placement), {}, m.string(r.mesh)};
    std::copy(r.size, r.size + 3, s.size.begin());
    s.radius = r.radius, s.contype = r.contype, s.conaffinity = r.conaffinity, s.material = m.materials()[r.material], s.surface = surface_of(m, k);
    b.shape(s);
  }
  for (Index k = 0; k < m.n.constraints; ++k) {
    const ConstraintRecord& r = m.constraints()[k];
    const auto end = [&](int at) {
      if (at <= 0) return Parent{"", 0};
      return between_joints(r.spec.type) ? Parent{m.string(m.joints()[at].name), DYN_FRAME_JOINT} : Parent{m.string(m.frames()[at].name), int(m.frames()[at].type)};
    };
    b.constraint(m.string(r.name), r.spec, end(r.spec.first), end(r.spec.second));
  }
  for (Index k = 0; k < m.n.actuators; ++k) b.actuator(m.string(m.actuators()[k].name), m.actuators()[k].spec, m.string(m.joints()[m.actuators()[k].spec.joint].name));
  for (Index k = 0; k < m.n.pairs; ++k) {
    const PairRecord& p = m.pairs()[k];
    const auto name = [&](Index geom) { return std::string(m.string(m.shapes()[m.geoms()[geom].shape].name)); };
    if (p.wanted()) b.pair(name(p.a), name(p.b), p.material() ? &m.materials()[p.material() - 1] : nullptr);
  }
  for (Index k = 1; k < m.n.configurations; ++k) {
    const double* q = m.configurations() + std::ptrdiff_t(k) * m.n.nq;
    b.configuration(m.string(m.configuration_names()[k]), {q, q + m.n.nq});
  }
}

struct Free {
  void operator()(void* block) const { std::free(block); }
};

}  // namespace

}  // namespace load

ModelPtr load_dynb(const std::string& bytes, const std::string& file, const LoadOptions& options) {
  const std::string where = file.empty() ? "" : load::printable(file) + ": ";
  try {
    load::check_header(bytes);
    if (options.base != DYN_BASE_UNSPECIFIED || options.cos_sin || !options.srdf.empty() || options.meshes != DYN_MESH_NONE)
      throw Error(DYN_ERROR_ARGUMENT, "a .dynb holds the model as it was loaded: leave out base, cos_sin, srdf and meshes, or load the robot file");
    const std::size_t size = bytes.size() - sizeof(load::DynbHeader);
    const std::unique_ptr<void, load::Free> block(allocate_block(size));
    if (!block) throw std::bad_alloc();
    std::memcpy(block.get(), bytes.data() + sizeof(load::DynbHeader), size);
    const Model& m = *static_cast<const Model*>(block.get());
    load::check_dynb_block(m, size);
    load::check_by_building(m);
    Builder builder(m);
    if (options.gravity != LoadOptions().gravity) builder.gravity(options.gravity);
    if (options.constraint_slots != LoadOptions().constraint_slots) builder.constraint_slots(options.constraint_slots);
    return builder.finish();
  } catch (const Error& e) {
    throw Error(e.status, where + e.what());
  }
}

}  // namespace dyn
