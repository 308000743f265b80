#include "table/sensors.hpp"
#include "budget.hpp"
#include "dynb.hpp"

#include <array>
#include <cstddef>
#include <cstring>

#include "constraint/list.hpp"
#include "model/block.hpp"
#include "model/builder_impl.hpp"
#include "model/builder_surface.hpp"

namespace dyn {

namespace load {

void seal_dynb(std::string& file, std::uint64_t tag) {
  constexpr std::size_t summed = offsetof(DynbHeader, handle);
  DynbHeader h{};
  std::memcpy(h.magic, dynb_magic, sizeof h.magic);
  h.version = dynb_version, h.byte_order = dynb_byte_order, h.tag = tag, h.bytes = file.size() - sizeof h;
  h.handle.magic = live_model, h.handle.in_place = 1;
  h.handle.m.distance = sizeof h - summed - offsetof(dynModel, m);
  std::memcpy(file.data(), &h, sizeof h);
  const std::uint64_t sum = tag ^ dynb_checksum(file.data() + summed, file.size() - summed);
  std::memcpy(file.data() + offsetof(DynbHeader, checksum), &sum, sizeof sum);
}

void fail_of_damage(const std::string& what) {
  throw Error(DYN_ERROR_PARSE, "the file is damaged: " + what + ": write it again from the robot file");
}

namespace {

void refuse(const Damage& d) {
  if (!d) return;
  const std::string what = d.what + (d.count >= 0 ? " is " + std::to_string(d.value) + " of " + std::to_string(d.count) : "");
  if (d.status == DYN_ERROR_UNSUPPORTED)
    throw Error(d.status, "the .dynb cannot be read: " + what + ": write it again from the robot file");
  fail_of_damage(what);
}

// Adds the whole model to a builder as a user would, so the builder checks names and numbers.
void check_by_building(const Model& m) {
  Builder b(m.string(m.model_name));
  b.allow_massless_joints();
  b.gravity({m.gravity[0], m.gravity[1], m.gravity[2]});
  b.medium(m.density, m.viscosity, {m.wind[0], m.wind[1], m.wind[2]});
  b.constraint_slots(m.n.slots - m.n.constraints), b.contact_capacity(m.contact_capacity);
  const auto placement = [](const double* x) {
    Placement out;
    std::copy(x, x + 12, out.begin());
    return out;
  };
  const auto on = [&](Index joint) {
    return joint ? Parent{m.string(m.joints()[joint].name), DYN_FRAME_TYPE_JOINT} : Parent{"", 0};
  };
  Index joints = 0;
  for (Index f = 1; f < m.n.frames; ++f) {
    const FrameRecord& r = m.frames()[f];
    const std::string name = m.string(r.name);
    if (r.type == DYN_FRAME_TYPE_JOINT) {
      if (name != m.string(m.joints()[r.joint].name)) fail_of_damage("joint '" + name + "' and its frame have different names");
      JointSpec s = spec_of(m, m.joints()[r.joint]);
      s.parent = on(m.joints()[r.joint].parent);
      b.joint(s), ++joints;
    } else if (r.type == DYN_FRAME_TYPE_BODY) {
      const LinkRecord& l = m.links()[r.link];
      std::array<double, 9> inertia;
      std::copy(l.inertia, l.inertia + 9, inertia.begin());
      b.body(name, on(r.joint), placement(r.placement), l.mass, {l.com[0], l.com[1], l.com[2]}, inertia);
      b.gravity_compensation(name, m.compensation(r.link));
    } else if (r.type == DYN_FRAME_TYPE_FIXED_JOINT) {
      JointSpec s;
      s.name = name, s.type = DYN_JOINT_TYPE_FIXED, s.parent = on(r.joint), s.placement = placement(r.placement);
      b.joint(s);
    } else {
      b.frame(name, on(r.joint), placement(r.placement), r.type);
    }
  }
  if (joints != m.n.joints - 1)
    fail_of_damage("it has " + std::to_string(m.n.joints - 1) + " joints, and frames of " + std::to_string(joints));
  for (Index k = 0; k < m.n.mocaps; ++k) b.mocap(m.string(m.frames()[m.mocaps()[k]].name));
  for (Index k = 0; k < m.n.shapes; ++k) {
    const ShapeRecord& r = m.shapes()[k];
    Shape s{m.string(r.name),       r.type, dynShapeRole(r.role), m.string(m.frames()[r.frame].name),
            placement(r.placement), {},     m.string(r.mesh)};
    std::copy(r.size, r.size + 3, s.size.begin());
    s.radius = r.radius, s.contype = r.contype, s.conaffinity = r.conaffinity, s.material = material_of(m, r),
    s.surface = surface_of(m, k), s.colour = r.colour, s.filter = PairFilter(r.filter);
    b.shape(s);
    for (const FluidEllipsoid *e = m.fluid_ellipsoids(), *end = e + m.n.fluid_shapes; e != end; ++e) {
      if (e->shape != k) continue;
      FluidShape x;
      std::copy(e->coefficients, e->coefficients + 5, x.coefficients.begin());
      std::copy(e->half, e->half + 3, x.semiaxes.begin());
      b.fluid(x, placement(e->placement));
    }
  }
  for (Index k = 0; k < m.n.constraints; ++k) {
    const ConstraintRecord& r = m.constraints()[k];
    const auto end = [&](int at) {
      if (at <= 0) return Parent{"universe", 0};
      return between_joints(r.spec.type) ? Parent{m.string(m.joints()[at].name), DYN_FRAME_TYPE_JOINT}
                                         : Parent{m.string(m.frames()[at].name), int(m.frames()[at].type)};
    };
    b.constraint(m.string(r.name), r.spec, end(r.spec.first), end(r.spec.second));
  }
  const auto frame = [&](Index f) { return std::string(f >= 0 ? m.string(m.frames()[f].name) : ""); };
  for (Index k = 0; k < m.n.tendons; ++k) {
    const PathRecord& p = m.paths()[k];
    std::vector<TendonElement> elements;
    for (const PathElement *e = m.path_elements() + p.first, *end = e + p.elements; e != end; ++e)
      elements.push_back({e->type, e->type == DYN_TENDON_ELEMENT_TYPE_JOINT ? m.string(m.joints()[e->id].name) : frame(e->id),
                          frame(e->side_id), e->value});
    b.tendon(m.string(m.tendons()[k].name), m.tendons()[k].spec, elements);
  }
  const auto tendon = [&](Index t) { return std::string(t >= 0 ? m.string(m.tendons()[t].name) : ""); };
  for (const PathRecord *p = m.paths() + m.n.tendons, *end = p + m.n.couplings; p != end; ++p)
    b.couple_tendons(m.string(p->name), tendon(p->first), tendon(p->elements), std::to_array(p->polynomial));
  for (Index k = 0; k < m.n.actuators; ++k) {
    const dynActuator& a = m.actuators()[k].spec;
    b.actuator(m.string(m.actuators()[k].name), a,
               a.transmission == DYN_TRANSMISSION_JOINT || a.transmission == DYN_TRANSMISSION_AXES
                   ? std::string(m.string(m.joints()[a.joint].name))
               : a.transmission == DYN_TRANSMISSION_TENDON ? tendon(a.tendon)
                                                           : frame(a.frame),
               frame(a.reference));
  }
  for (const ForceLimitRecord *x = m.force_limits(), *end = x + m.n.force_limits; x != end; ++x)
    b.limit_actuators(x->tendon >= 0, x->tendon >= 0 ? tendon(x->tendon) : m.string(m.joints()[x->joint].name), x->range[0],
                      x->range[1], x->with_weight != 0);
  for (Index k = 0; k < m.n.sensors; ++k) {
    dynSensor s = m.sensors()[k].spec;
    std::string object;
    const auto side = [&](dynSide kind, int x) {
      return kind == DYN_SIDE_SHAPE ? std::string(m.string(m.shapes()[x].name)) : frame(x);
    };
    switch (sensor_row(s.quantity).object) {
      case SensorObject::None: break;
      case SensorObject::Joint: object = m.string(m.joints()[s.object].name); break;
      case SensorObject::Tendon: object = tendon(s.object); break;
      case SensorObject::Actuator: object = m.string(m.actuators()[s.object].name); break;
      case SensorObject::Frame: object = frame(s.object), s.object = m.frames()[s.object].type; break;
      case SensorObject::Sides: object = side(s.side, s.object); break;
    }
    const std::string reference = side(s.other_side, s.reference);
    if (s.reference >= 0 && s.other_side == DYN_SIDE_ANY) s.reference = m.frames()[s.reference].type;
    b.sensor(m.string(m.sensors()[k].name), s, object, reference);
  }
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

// Charges the account for all of a model that is about to be built again.
void charge(const Model& m, std::int64_t bytes, Budget& budget) {
  const Report report("", false);  // the caller names the file
  budget.add_bytes(4 * bytes, report, 0);
  budget.add_bodies(m.n.links, report, 0), budget.add_joints(m.n.joints, report, 0), budget.add_shapes(m.n.shapes, report, 0);
  budget.add_keys(m.n.configurations - 1, report, 0);
  for (Index k = 0; k < m.n.constraints; ++k) {
    Constraint c{};
    c.type = m.constraints()[k].spec.type, c.joint_type = m.constraints()[k].spec.joint_type;
    budget.add_rows(constraint_rows(c), report, 0);
  }
}

struct Free {
  void operator()(void* block) const { free_aligned(block); }
};

}  // namespace

}  // namespace load

ModelPtr load_dynb(const std::string& given, const std::string& file, const LoadOptions& options) {
  const std::string where = file.empty() ? "" : load::printable(file) + ": ";
  try {
    const std::string translated = load::translate_dynb(given);
    const std::string& bytes = translated.empty() ? given : translated;
    load::refuse(check_header(bytes.data(), bytes.size()));
    if (options.base != DYN_BASE_UNSPECIFIED || options.cos_sin || !options.srdf.empty() ||
        options.meshes != LoadOptions().meshes)
      throw Error(DYN_ERROR_ARGUMENT,
                  "a .dynb holds a model as it was loaded: omit base, cos_sin, srdf and meshes, or load the robot file");
    const std::size_t size = bytes.size() - sizeof(DynbHeader);
    const std::unique_ptr<void, load::Free> block(allocate_block(size));
    if (!block) throw std::bad_alloc();
    std::memcpy(block.get(), bytes.data() + sizeof(DynbHeader), size);
    const Model& m = *static_cast<const Model*>(block.get());
    load::refuse(check_block(m, size));
    if (m.n.joints > 1 && *m.string(m.joints()[1].name) == '\0')
      throw Error(DYN_ERROR_UNSUPPORTED, "the .dynb has no names: use it in place as a buffer, or write it again with names");
    if (options.budget) load::charge(m, std::int64_t(size), *options.budget);
    load::check_by_building(m);
    Builder builder(m);
    const auto is_drawn = [&](Index k) { return std::strcmp(m.string(m.configuration_names()[k]), "qpos0") == 0; };
    const bool is_version_2 = given[offsetof(DynbHeader, version)] == 2;  // which has no initial configuration
    for (Index k = 1; is_version_2 && k < m.n.configurations; ++k)
      if (is_drawn(k)) builder.initial_configuration("qpos0");
    if (options.gravity != LoadOptions().gravity) builder.gravity(options.gravity);
    if (options.constraint_slots != LoadOptions().constraint_slots) builder.constraint_slots(options.constraint_slots);
    if (options.contact_capacity != 0) builder.contact_capacity(options.contact_capacity);
    return builder.finish();
  } catch (const Error& e) {
    throw Error(e.status, where + e.what());
  }
}

}  // namespace dyn
