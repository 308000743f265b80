// Compiles what a builder has collected into a model: depth-first order, internal frames with z along each axis, merged
// inertias, the expanded coordinates of mimic joints, and one block of memory.
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <numeric>
#include <unordered_map>

#include "builder_impl.hpp"
#include "builder_surface.hpp"
#include "base/sincos.hpp"
#include "joint/list.hpp"
#include "model/block.hpp"
#include "model/data.hpp"
#include "model/unit_norms.hpp"

namespace dyn {

namespace {

// Where x is, one of them if it is new.
std::uint16_t number_of(std::vector<dynMaterial>& materials, const dynMaterial& x) {
  std::size_t k = 0;
  while (k < materials.size() && std::memcmp(&materials[k], &x, sizeof x) != 0) ++k;
  if (k > UINT16_MAX) throw Error(DYN_ERROR_LIMIT, "more than 65536 different materials");
  if (k == materials.size()) materials.push_back(x);
  return std::uint16_t(k);
}

// All strings of the model, at its end, each once: a joint and its frame share their name.
struct Text {
  std::string pool = std::string(1, '\0');
  std::unordered_map<std::string, Index> known = {{"", 0}};
  Index add(const std::string& s) {
    const auto [at, added] = known.try_emplace(s, Index(pool.size()));
    if (added) pool.append(s.c_str(), s.size() + 1);
    return at->second;
  }
};

// The model's arrays on their way into one block.
struct Arrays {
#define FIELD(type, name, count, sentence) std::vector<type> name;
#include "model/model_fields.def"
#undef FIELD
};

// Puts each surface once into the arrays; its number there.
struct Surfaces {
  Arrays& a;
  std::unordered_map<const SurfaceData*, Index> known = {};

  Index add(const SurfacePtr& surface) {
    if (!surface) return -1;
    const auto found = known.find(surface.get());
    return found != known.end() ? found->second : known[surface.get()] = put(*surface);
  }

 private:
  template <class T>
  Index append(const Held<T>& h, std::vector<Stored<T>>& list) {
    list.push_back({h.header, a.surface_numbers.size(), a.surface_indices.size()});
    a.surface_numbers.insert(a.surface_numbers.end(), h.numbers.begin(), h.numbers.end());
    a.surface_indices.insert(a.surface_indices.end(), h.indices.begin(), h.indices.end());
    if (std::max(a.surface_numbers.size(), a.surface_indices.size()) > std::size_t(std::numeric_limits<Index>::max()))
      throw Error(DYN_ERROR_LIMIT, "the meshes of the model have more than 2^31 numbers: simplify them");
    return Index(list.size() - 1);
  }
  Index put(const SurfaceData& s) {
    if (const auto* hull = std::get_if<Held<shape::Hull>>(&s.held)) return append(*hull, a.hulls);
    if (const auto* tree = std::get_if<Held<shape::TriangleTree>>(&s.held)) return append(*tree, a.trees);
    return append(std::get<Held<shape::Grid>>(s.held), a.grids);
  }
};

SE3<double> rotation_only(const Mat3<double>& R) { return {R, Vec3<double>::zero()}; }

// Named configurations are points of the configuration space: quaternions and (cos, sin) pairs of norm 1.
void settle_configurations(const Model& m, double* q) {
  for (Index k = 0; k < m.n.configurations; ++k, q += m.n.nq) {
    if (const Index j = zero_norm_joint(m, q))
      throw Error(DYN_ERROR_QUATERNION, "configuration '" + std::string(m.string(m.configuration_names()[k])) + "': the quaternion or (cos, sin) of joint '" +
                                            m.string(m.joints()[j].name) + "' is zero: give one of norm 1, such as that of 'neutral'");
    if (norm_error(m, q) > 1e-15) normalize(m, q);  // so that it changes nothing when done again
  }
}

std::atomic<std::uint64_t> next_id{1};

}  // namespace

void ModelDeleter::operator()(Model* m) const { std::free(m); }

ModelPtr Builder::finish() const {
  const Impl& in = *impl;
  const std::vector<int> order = depth_first(in.joints);
  const std::vector<Leader> leaders = resolve_mimic(in.joints);
  std::vector<Index> id(in.joints.size());  // of each added joint in the model
  for (std::size_t k = 0; k < order.size(); ++k) id[std::size_t(order[k])] = Index(k + 1);

  Arrays a;
  Text text;
  ModelSizes n{};
  n.joints = Index(order.size() + 1);

  // the universe
  Body world{};
  world.h = Vec3<double>::zero();
  world.I = Mat3<double>::zero();
  world.ratio = 1;
  a.bodies.push_back(world);
  a.joint_placement.push_back(SE3<double>::identity());
  JointRecord universe{};
  universe.C = Mat3<double>::identity();
  universe.name = text.add("universe");
  universe.type = DYN_JOINT_TYPE_FIXED;
  universe.leader = -1, universe.ratio = 1;
  store_se3(SE3<double>::identity(), universe.placement);
  a.joints.push_back(universe);

  // coordinates of the user: followers have none
  std::vector<Index> idx_q(in.joints.size()), idx_v(in.joints.size());
  for (int j : order)
    if (leaders[std::size_t(j)].joint < 0) {
      idx_q[std::size_t(j)] = n.nq, idx_v[std::size_t(j)] = n.nv;
      n.nq += spec_nq(in.joints[std::size_t(j)].spec), n.nv += spec_nv(in.joints[std::size_t(j)].spec);
    }
  for (int j : order)
    if (leaders[std::size_t(j)].joint >= 0) {
      idx_q[std::size_t(j)] = idx_q[std::size_t(leaders[std::size_t(j)].joint)];
      idx_v[std::size_t(j)] = idx_v[std::size_t(leaders[std::size_t(j)].joint)];
    }
  if (std::size_t(n.nv) > 1000000) throw Error(DYN_ERROR_LIMIT, "the model has more than 1,000,000 degrees of freedom");
  constexpr double inf = std::numeric_limits<double>::infinity();
  a.armature.assign(std::size_t(n.nv), 0), a.damping = a.friction = a.stiffness = a.armature;
  a.velocity_limit.assign(std::size_t(n.nv), inf), a.effort_limit = a.velocity_limit;
  a.lower_limit.assign(std::size_t(n.nq), -inf), a.upper_limit.assign(std::size_t(n.nq), inf);
  a.neutral.assign(std::size_t(n.nq), 0), a.spring_reference = a.neutral;
  a.own_v.assign(std::size_t(n.nv), 0);

  bool mimic = false;
  for (int j : order) {
    const JointEntry& e = in.joints[std::size_t(j)];
    const Leader& l = leaders[std::size_t(j)];
    const bool follower = l.joint >= 0;
    mimic |= follower;
    JointRecord r{};
    r.name = text.add(e.spec.name);
    r.type = e.spec.type;
    r.parent = e.parent < 0 ? 0 : id[std::size_t(e.parent)];
    r.idx_q = idx_q[std::size_t(j)], r.idx_v = idx_v[std::size_t(j)];
    r.nq = follower ? 0 : spec_nq(e.spec), r.nv = follower ? 0 : spec_nv(e.spec);
    r.leader = follower ? id[std::size_t(l.joint)] : -1;
    r.ratio = l.ratio, r.offset = l.offset;
    std::copy(e.spec.axis.begin(), e.spec.axis.end(), r.axis);
    std::copy(e.spec.axis2.begin(), e.spec.axis2.end(), r.axis2);
    r.pitch = e.spec.pitch;
    store_se3(e.placement, r.placement);
    r.first_body = Index(a.bodies.size());

    // the chain of primitives, each with its axis turned to z; C: axes of the user's frame in the internal one
    const JointRecord& parent = a.joints[std::size_t(r.parent)];
    SE3<double> before = rotation_only(parent.C) * e.placement;
    Index body_parent = parent.last_body, user_q = r.idx_q, user_v = r.idx_v;
    for (const PlacedElement& part : e.elements) {
      const Mat3<double> Z = z_to(part.element.axis);
      const SE3<double> X = before * part.before * rotation_only(Z);
      Body b{};
      b.h = Vec3<double>::zero(), b.I = Mat3<double>::zero();
      b.pitch = part.element.pitch, b.wraps = part.element.wraps;
      b.ratio = l.ratio, b.follower = follower;
      b.type = part.element.type;
      b.parent = body_parent;
      b.idx_q = n.nqx, b.idx_v = n.nvx;
      b.user_q = user_q, b.user_v = user_v;
      b.joint = Index(a.joints.size());
      visit(b.type, [&]<class J>() {
        if (!follower) J::neutral(a.neutral.data() + user_q), J::neutral(a.spring_reference.data() + user_q);
      });
      const Index nq = primitive_nq(b.type), nv = primitive_nv(b.type);
      for (Index k = 0; k < nq; ++k) a.expand_q.push_back(user_q + k), a.ratio_q.push_back(l.ratio), a.offset_q.push_back(l.offset);
      for (Index k = 0; k < nv; ++k) {
        a.expand_v.push_back(user_v + k), a.ratio_v.push_back(l.ratio);
        if (follower) a.followers.push_back(n.nvx + k);
        else a.own_v[std::size_t(user_v + k)] = n.nvx + k;
      }
      n.nqx += nq, n.nvx += nv, user_q += nq, user_v += nv;
      body_parent = Index(a.bodies.size());
      before = rotation_only(transpose(Z));
      a.bodies.push_back(b);
      a.joint_placement.push_back(X);
    }
    r.last_body = body_parent;
    r.C = before.R;
    if (e.spec.type == DYN_JOINT_TYPE_COMPOSITE) {
      r.first_part = Index(a.parts.size()), r.parts = Index(e.parts.size());
      for (const JointPart& p : e.parts) {
        PartRecord part{};
        part.type = p.type, part.pitch = p.pitch;
        std::copy(p.axis.begin(), p.axis.end(), part.axis);
        std::copy(p.axis2.begin(), p.axis2.end(), part.axis2);
        store_se3(p.before, part.placement);
        a.parts.push_back(part);
      }
    }

    // per degree of freedom; a follower's rotor turns with its leader
    const JointSpec& s = e.spec;
    auto put = [](const std::vector<double>& from, std::vector<double>& to, Index at) {
      std::copy(from.begin(), from.end(), to.begin() + at);
    };
    const double rotor = s.rotor_inertia * s.gear_ratio * s.gear_ratio;
    if (spec_nv(s) == 1) {
      r.armature = rotor + (s.armature.empty() ? 0 : s.armature[0]);
      r.damping = s.damping.empty() ? 0 : s.damping[0];
      r.friction = s.friction.empty() ? 0 : s.friction[0];
      a.armature[std::size_t(r.idx_v)] += l.ratio * l.ratio * r.armature;
      a.damping[std::size_t(r.idx_v)] += l.ratio * l.ratio * r.damping;
      a.friction[std::size_t(r.idx_v)] += std::abs(l.ratio) * r.friction;
      r.stiffness = s.stiffness.empty() ? 0 : s.stiffness[0];
    } else {
      put(s.armature, a.armature, r.idx_v), put(s.damping, a.damping, r.idx_v), put(s.friction, a.friction, r.idx_v);
      put(s.stiffness, a.stiffness, r.idx_v);
    }
    if (spec_nq(s) == 1) {
      r.spring_reference = s.spring_reference.empty() ? 0 : s.spring_reference[0];
      // two springs are one: stiffness and moment about q = 0 add up
      double &k = a.stiffness[std::size_t(r.idx_v)], &at = a.spring_reference[std::size_t(r.idx_q)];
      const double added = l.ratio * l.ratio * r.stiffness, rest = (r.spring_reference - l.offset) / l.ratio;
      if (added > 0) at = k > 0 ? (k * at + added * rest) / (k + added) : rest, k += added;
    } else {
      put(s.spring_reference, a.spring_reference, r.idx_q);
      if (spec_nv(s) == 1) a.stiffness[std::size_t(r.idx_v)] = r.stiffness;
    }
    if (!follower) {
      put(s.lower, a.lower_limit, r.idx_q), put(s.upper, a.upper_limit, r.idx_q);
      put(s.velocity, a.velocity_limit, r.idx_v), put(s.effort, a.effort_limit, r.idx_v);
    }
    a.joints.push_back(r);
  }
  n.bodies = Index(a.bodies.size()), n.parts = Index(a.parts.size());
  if (mimic) {
    n.mimic_q = n.nqx, n.mimic_v = n.nvx;
  } else {
    a.expand_q.clear(), a.ratio_q.clear(), a.offset_q.clear(), a.expand_v.clear(), a.ratio_v.clear(), a.own_v.clear();
  }

  // frames, and the inertia of what they carry
  for (const FrameEntry& f : in.frames) {
    const JointRecord& joint = a.joints[f.joint < 0 ? 0 : std::size_t(id[std::size_t(f.joint)])];
    FrameRecord r{};
    r.X = rotation_only(joint.C) * f.X;
    r.name = text.add(f.name);
    r.type = f.type;
    r.joint = f.joint < 0 ? 0 : id[std::size_t(f.joint)], r.parent = Index(f.parent);
    r.body = joint.last_body;
    store_se3(f.X, r.placement);
    r.link = -1;
    if (f.type == DYN_FRAME_TYPE_BODY) {
      LinkRecord link{f.mass, {}, {}};
      std::copy(f.com.begin(), f.com.end(), link.com);
      std::copy(f.inertia.begin(), f.inertia.end(), link.inertia);
      r.link = n.links++;
      a.links.push_back(link);
    }
    if (f.mass > 0 && f.compensation != 0 && r.joint > 0) a.gravity_compensations.push_back({r.X.act(load3(f.com.data())), f.mass * f.compensation, r.joint, r.body, r.link});
    if ((in.density > 0 || in.viscosity > 0) && r.joint > 0)
      if (std::optional<DragBox> box = drag_box(f, r.X)) box->joint = r.joint, box->body = r.body, a.drag_boxes.push_back(*box);
    a.frames.push_back(r);
    Body& b = a.bodies[std::size_t(r.body)];
    const Inertia<double> Y = f.Y.rotated(joint.C);
    b.m += Y.m, b.h += Y.h, b.I = b.I + Y.I.full();
  }
  n.frames = Index(a.frames.size()), n.gravity_compensations = Index(a.gravity_compensations.size()), n.drag_boxes = Index(a.drag_boxes.size());
  WantedPairs wanted;
  for (const PairEntry& p : in.pairs) wanted[std::minmax(Index(p.shape1), Index(p.shape2))] = p.material ? 1 + number_of(a.materials, *p.material) : 0;
  if (a.materials.size() > std::size_t(PairRecord::max_own)) throw Error(DYN_ERROR_LIMIT, "more than 253 different materials of wanted pairs");
  Surfaces surfaces{a};
  for (const ShapeEntry& s : in.shapes) {
    ShapeRecord r{};
    r.name = text.add(s.shape.name), r.mesh = text.add(s.shape.mesh);
    r.type = s.shape.type, r.role = std::uint8_t(s.shape.role), r.colour = s.shape.colour;
    r.frame = Index(s.frame), r.surface = surfaces.add(s.shape.surface);
    std::copy(s.shape.placement.begin(), s.shape.placement.end(), r.placement);
    std::copy(s.shape.size.begin(), s.shape.size.end(), r.size);
    r.radius = s.shape.radius, r.contype = s.shape.contype, r.conaffinity = s.shape.conaffinity, r.material = number_of(a.materials, s.shape.material);
    if (r.role == DYN_SHAPE_ROLE_COLLISION) a.geoms.push_back({Index(a.shapes.size())});
    a.shapes.push_back(r);
  }
  n.shapes = Index(a.shapes.size()), n.geoms = Index(a.geoms.size()), n.materials = Index(a.materials.size());
  n.hulls = Index(a.hulls.size()), n.trees = Index(a.trees.size()), n.grids = Index(a.grids.size());
  n.surface_numbers = Index(a.surface_numbers.size()), n.surface_indices = Index(a.surface_indices.size());
  for (const DisabledEntry& p : in.disabled) a.disabled_pairs.push_back({Index(p.frame1), Index(p.frame2), text.add(p.reason)});
  n.disabled = Index(a.disabled_pairs.size());
  a.pairs = pairs_of(a.joints, a.bodies, a.frames, a.shapes, a.geoms, a.disabled_pairs, wanted, in.overlapping);
  n.pairs = Index(a.pairs.size());
  for (const ReportEntry& r : in.reports)
    if (r.message != nothing_tested) a.reports.push_back({r.level, Index(r.line), text.add(r.message)});
  // room for it: it goes again when the pairs have been judged, which takes the finished model
  const bool several = n.geoms >= 2 && n.geoms <= max_geoms;
  if (several) a.reports.push_back({DYN_REPORT_LEVEL_WARNING, 0, text.add(nothing_tested)});
  n.reports = Index(a.reports.size());

  for (const dynConstraint& c : constraints_of(in.constraints, id)) a.constraints.push_back({c, text.add(in.constraints[a.constraints.size()].name)});
  n.constraints = Index(a.constraints.size()), n.slots = n.constraints + Index(in.constraint_slots);
  n.constraint_rows = room_for_rows(in.constraints, in.constraint_slots);

  // configurations; "neutral" is the first
  a.configuration_names.push_back(text.add("neutral"));
  a.configurations = a.neutral;
  for (const ConfigurationEntry& c : in.configurations) {
    std::vector<double> q = c.whole;
    if (c.split)
      for (int j : order) {
        if (own_nq(in.joints[std::size_t(j)]) == 0) continue;
        const bool given = std::size_t(j) < c.by_joint.size() && !c.by_joint[std::size_t(j)].empty();
        const std::vector<double> own = given ? c.by_joint[std::size_t(j)] : neutral_of(in.joints[std::size_t(j)]);
        q.insert(q.end(), own.begin(), own.end());
      }
    if (Index(q.size()) != n.nq)
      throw Error(DYN_ERROR_SIZE, "configuration '" + c.name + "' has " + std::to_string(q.size()) + " numbers, the model needs nq = " + std::to_string(n.nq));
    a.configuration_names.push_back(text.add(c.name));
    a.configurations.insert(a.configurations.end(), q.begin(), q.end());
  }
  n.configurations = Index(a.configuration_names.size());

  make_runs(a.bodies, a.runs, a.chunks);
  n.runs = Index(a.runs.size()), n.chunks = Index(a.chunks.size());
  make_spans(a.bodies, a.spans, a.curved);
  n.spans = Index(a.spans.size()), n.curved = Index(a.curved.size());
  for (const ActuatorRecord& r : actuators_of(in.actuators, id, a.joints, a.spans, n)) {
    a.actuators.push_back(r);
    a.actuators.back().name = text.add(in.actuators[a.actuators.size() - 1].name);
  }
  for (const EuclideanSpan& s : a.spans)
    for (Index k = 0; k < s.count; ++k) {
      const Index q = s.first_q + k, v = s.first_v + k;
      if (!std::isfinite(a.lower_limit[std::size_t(q)]) && !std::isfinite(a.upper_limit[std::size_t(q)])) continue;
      const Index dof = n.mimic_v ? a.own_v[std::size_t(v)] : v;
      const auto after = std::find_if(a.bodies.begin() + 1, a.bodies.end(), [&](const Body& b) { return b.idx_v > dof; });
      a.limits.push_back({q, Index(after - a.bodies.begin()) - 1, dof});
    }
  for (Index i = 1; i < n.bodies; ++i)
    if (const Body& b = a.bodies[std::size_t(i)]; b.type == BodyType::Spherical && a.lower_limit[std::size_t(b.user_q) + 3] >= 0) a.limits.push_back({b.user_q + 3, i, b.idx_v});
  n.limits = Index(a.limits.size());
  for (const CacheBlock& c : a.chunks) n.sweep = std::max(n.sweep, padded_sweep(c.last_q - c.first_q));

  // subtrees
  a.subtree_end.assign(std::size_t(n.bodies), 0);
  for (Index i = n.bodies - 1; i >= 0; --i) {
    Index& end = a.subtree_end[std::size_t(i)];
    end = std::max(end, i + 1);
    if (i) {
      Index& up = a.subtree_end[std::size_t(a.bodies[std::size_t(i)].parent)];
      up = std::max(up, end);
    }
  }
  a.dof_end.assign(std::size_t(n.nvx + 3) / 4 * 4, 0);
  for (Index i = 1; i < n.bodies; ++i) {
    const Body& b = a.bodies[std::size_t(i)];
    const Index next = a.subtree_end[std::size_t(i)];
    for (int k = 0; k < primitive_nv(b.type); ++k)
      a.dof_end[std::size_t(b.idx_v + k)] = next < n.bodies ? a.bodies[std::size_t(next)].idx_v : n.nvx;
  }
  for (auto e = a.dof_end.begin(); e != a.dof_end.end(); e += 4)
    a.band_full.push_back(*std::min_element(e, e + 4)), a.band_end.push_back(*std::max_element(e, e + 4));

  // ids by name
  auto precedence = [&](Index k) { return a.frames[std::size_t(k)].type == DYN_FRAME_TYPE_BODY ? 1 : 0; };
  a.joints_by_name.resize(std::size_t(n.joints)), a.frames_by_name.resize(std::size_t(n.frames));
  std::iota(a.joints_by_name.begin(), a.joints_by_name.end(), 0);
  std::iota(a.frames_by_name.begin(), a.frames_by_name.end(), 0);
  const char* pool = text.pool.data();
  std::sort(a.joints_by_name.begin(), a.joints_by_name.end(),
            [&](Index x, Index y) { return std::strcmp(pool + a.joints[std::size_t(x)].name, pool + a.joints[std::size_t(y)].name) < 0; });
  std::sort(a.frames_by_name.begin(), a.frames_by_name.end(), [&](Index x, Index y) {
    const int c = std::strcmp(pool + a.frames[std::size_t(x)].name, pool + a.frames[std::size_t(y)].name);
    return c != 0 ? c < 0 : precedence(x) < precedence(y);
  });
  const Index name = text.add(in.name);
  a.text.assign(text.pool.begin(), text.pool.end());
  n.text = Index(a.text.size());
  a.dof_parent.assign(std::size_t(n.nv), -1), a.dof_depth = a.dof_descendants_end = a.dof_run = a.dof_parent, a.dof_forks.assign(std::size_t(n.nv), 0), a.dof_groups.resize(std::size_t(n.nv));  // filled in below

  // one block
  auto round_up = [](std::uint64_t x, std::uint64_t boundary) { return (x + boundary - 1) / boundary * boundary; };  // vectors on lines of the cache
  std::uint64_t bytes = sizeof(Model);
  std::uint64_t offset[std::size_t(Model::Field::count_)];
#define FIELD(type, field, count, sentence)                                                  \
  if (a.field.size() != std::size_t(count)) throw Error(DYN_ERROR_INTERNAL, "model field " #field " has a wrong size"); \
  offset[std::size_t(Model::Field::field)] = bytes = round_up(bytes, alignof(type) > alignof(double) ? 64 : alignof(double)); \
  bytes += a.field.size() * sizeof(type);
#include "model/model_fields.def"
#undef FIELD
  bytes = round_up(bytes, 64);
  ModelPtr model(static_cast<Model*>(allocate_block(bytes)));
  if (!model) throw std::bad_alloc();
  std::memset(static_cast<void*>(model.get()), 0, bytes);
  model->magic = Model::magic_value;
  model->bytes = bytes;
  model->id = next_id++;
  model->n = n;
  model->model_name = name;
  model->has_mimic = mimic;
  const auto if_some = [](std::uint32_t effect, const std::vector<double>& x) {
    return std::any_of(x.begin(), x.end(), [](double e) { return e != 0; }) ? effect : 0u;
  };
  model->effects = if_some(DYN_EFFECT_ARMATURE, a.armature) | if_some(DYN_EFFECT_DAMPING, a.damping) | if_some(DYN_EFFECT_SPRINGS, a.stiffness) |
                   if_some(DYN_EFFECT_FRICTION, a.friction) | (n.limits > 0 ? std::uint32_t(DYN_EFFECT_LIMITS) : 0u) |
                   (n.actuators > 0 ? std::uint32_t(DYN_EFFECT_ACTUATORS) : 0u) | (n.drag_boxes > 0 ? std::uint32_t(DYN_EFFECT_FLUID) : 0u) |
                   (n.gravity_compensations > 0 ? std::uint32_t(DYN_EFFECT_GRAVITY_COMPENSATION) : 0u);
  auto small = [](double x) { return std::abs(x) < 1e25; };
  auto all_small = [&](const Vec3<double>& x) { return small(x[0]) && small(x[1]) && small(x[2]); };
  model->no_overflow = std::all_of(a.armature.begin(), a.armature.end(), small) && std::all_of(a.bodies.begin(), a.bodies.end(), [&](const Body& b) {
                      return small(b.m) && small(b.pitch) && small(b.ratio) && all_small(b.h) && all_small(b.I.x) && all_small(b.I.y) && all_small(b.I.z);
                    });
  std::copy(in.gravity.begin(), in.gravity.end(), model->gravity);
  model->contact_capacity = in.contact_capacity;
  model->density = in.density, model->viscosity = in.viscosity;
  std::copy(in.wind.begin(), in.wind.end(), model->wind);
  for (Index i = 1; i < n.bodies; ++i) model->total_mass += a.bodies[std::size_t(i)].m;
  if (bytes / 8 > UINT32_MAX) throw Error(DYN_ERROR_LIMIT, "the model has more than 2^35 bytes: simplify its meshes");
  std::transform(std::begin(offset), std::end(offset), model->offset, [](std::uint64_t x) { return std::uint32_t(x / 8); });
  char* base = reinterpret_cast<char*>(model.get());
#define FIELD(type, field, count, sentence) \
  if (!a.field.empty()) std::memcpy(base + offset[std::size_t(Model::Field::field)], a.field.data(), a.field.size() * sizeof(type));
#include "model/model_fields.def"
#undef FIELD
  settle_configurations(*model, reinterpret_cast<double*>(base + offset[std::size_t(Model::Field::configurations)]));
  elimination_tree(*model, a.dof_parent);
  for (std::size_t k = 0; k < std::size_t(n.nv); ++k) {
    const Index p = a.dof_parent[k];
    a.dof_depth[k] = p >= 0 ? a.dof_depth[std::size_t(p)] + 1 : 0;
    a.dof_run[k] = k > 0 && p == Index(k) - 1 ? a.dof_run[k - 1] : Index(k);
    if (p >= 0 && p != Index(k) - 1) a.dof_forks[std::size_t(p)] = 1;
    a.dof_descendants_end[k] = Index(k) + 1;
  }
  for (std::size_t k = std::size_t(n.nv); k-- > 0;)
    if (a.dof_parent[k] >= 0) {
      Index& up = a.dof_descendants_end[std::size_t(a.dof_parent[k])];
      up = std::max(up, a.dof_descendants_end[k]);
    }
  DofGroup* groups = reinterpret_cast<DofGroup*>(base + offset[std::size_t(Model::Field::dof_groups)]);
  model->groups = make_dof_groups(a.dof_parent, a.dof_depth, a.dof_descendants_end, groups);
  auto fill_in = [&](Model::Field field, const std::vector<Index>& x) {
    std::copy(x.begin(), x.end(), reinterpret_cast<Index*>(base + offset[std::size_t(field)]));
  };
  fill_in(Model::Field::dof_parent, a.dof_parent), fill_in(Model::Field::dof_depth, a.dof_depth), fill_in(Model::Field::dof_run, a.dof_run);
  fill_in(Model::Field::dof_descendants_end, a.dof_descendants_end), fill_in(Model::Field::dof_forks, a.dof_forks);
  check_dynamics(*model, order, in.joints, in.frames);
  check_constraints(*model);
  for (std::size_t k = 0; k < std::size_t(n.nv); ++k) model->n.carriers = std::max(model->n.carriers, std::min(n.nv, 2 * (a.dof_depth[k] + 1)));
  if (!lists_pairs(*model)) {
    // what overlaps is listed: once more, with them
    if (GeomPairs found = dyn::overlapping(*model); !found.empty()) {
      found.insert(found.end(), in.overlapping.begin(), in.overlapping.end());
      impl->overlapping = std::move(found);
      ModelPtr again = finish();
      impl->overlapping.clear();
      return again;
    }
    const auto moving = std::count_if(a.geoms.begin(), a.geoms.end(), [&](const GeomRecord& g) { return a.frames[std::size_t(a.shapes[std::size_t(g.shape)].frame)].joint > 0; });
    model->n.contacts = Index(contact_capacity_of(*model, moving));
    return model;
  }
  judge_pairs(*model, reinterpret_cast<PairRecord*>(base + offset[std::size_t(Model::Field::pairs)]));
  if (several && !tests_nothing(*model)) --model->n.reports;
  model->n.contacts = Index(contact_capacity_of(*model, 0));
  return model;
}

}  // namespace dyn
