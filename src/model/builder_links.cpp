// Links of a model: frames with what they carry, shapes and their pairs, the load report, constraints, named configurations.
#include <cstring>
#include <limits>
#include <set>

#include "builder_compile.hpp"
#include "builder_surface.hpp"

namespace dyn {

namespace {

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

}  // namespace

// A mocap body carries what hangs on it.
void Compiler::place_on_mocap(const FrameEntry& f, FrameRecord& r) {
  const Index carrier = f.parent > 0 ? a.frames[std::size_t(f.parent)].place : 0;
  const bool carried = carrier >= Index(a.bodies.size());
  const std::string who = "'" + f.name + "'";
  if ((f.mocap || carried) && f.joint >= 0)
    throw Error(DYN_ERROR_UNSUPPORTED,
                f.mocap ? "mocap body " + who + ": a joint moves it: only a link that is fixed to the world can be a mocap body"
                        : who + " hangs on mocap body '" +
                              in.frames[std::size_t(a.mocaps[std::size_t(carrier) - a.bodies.size()])].name +
                              "': only what is fixed to a mocap body can be carried by it");
  if (carried) r.place = carrier;
  if (f.mocap && carried) throw Error(DYN_ERROR_INVALID, "mocap body " + who + " hangs on another mocap body");
  if (!f.mocap) return;
  r.place = Index(a.bodies.size() + a.mocaps.size());
  a.mocaps.push_back(Index(a.frames.size()));
}

void Compiler::add_frames() {
  std::set<int> fluid;  // frames whose links have ellipsoids of their own
  for (const ShapeEntry& s : in.shapes)
    if (s.shape.fluid) fluid.insert(s.frame);
  for (const FrameEntry& f : in.frames) {
    const JointRecord& joint = a.joints[f.joint < 0 ? 0 : std::size_t(id[std::size_t(f.joint)])];
    FrameRecord r{};
    r.X = rotation_only(joint.C) * f.X;
    r.name = text.add(f.name);
    r.type = f.type;
    r.joint = f.joint < 0 ? 0 : id[std::size_t(f.joint)], r.parent = Index(f.parent);
    r.body = r.place = joint.last_body;
    place_on_mocap(f, r);
    store_se3(f.X, r.placement);
    r.link = -1;
    if (f.type == DYN_FRAME_TYPE_BODY) {
      LinkRecord link{f.mass, {}, {}};
      std::copy(f.com.begin(), f.com.end(), link.com);
      std::copy(f.inertia.begin(), f.inertia.end(), link.inertia);
      r.link = n.links++;
      a.links.push_back(link);
    }
    if (f.mass > 0 && f.compensation != 0 && r.joint > 0)
      a.gravity_compensations.push_back({r.X.act(load3(f.com.data())), f.mass * f.compensation, r.joint, r.body, r.link});
    if (has_medium() && r.joint > 0 && !fluid.count(int(a.frames.size())))
      if (std::optional<DragBox> box = drag_box(f, r.X)) box->joint = r.joint, box->body = r.body, a.drag_boxes.push_back(*box);
    a.frames.push_back(r);
    Body& b = a.bodies[std::size_t(r.body)];
    const Inertia<double> Y = f.Y.rotated(joint.C);
    b.m += Y.m, b.h += Y.h, b.I = b.I + Y.I.full();
  }
  n.mocaps = Index(a.mocaps.size());
  n.frames = Index(a.frames.size()), n.gravity_compensations = Index(a.gravity_compensations.size()),
  n.drag_boxes = Index(a.drag_boxes.size());
}

// Where x is, one of them if it is new.
std::uint16_t Compiler::number_of(const dynMaterial& x, const Compliance* own) {
  std::string bytes(reinterpret_cast<const char*>(&x), sizeof x);
  if (own && in.compliant) bytes.append(reinterpret_cast<const char*>(own), sizeof *own);
  const auto [at, added] = materials.try_emplace(bytes, a.materials.size());
  if (at->second > UINT16_MAX) throw Error(DYN_ERROR_LIMIT, "more than 65536 different materials");
  if (added) a.materials.push_back(x), material_compliances.push_back(own ? *own : Compliance());
  return std::uint16_t(at->second);
}

void Compiler::add_wanted_pairs() {
  for (const PairEntry& p : in.pairs)
    wanted[std::minmax(Index(p.shape1), Index(p.shape2))] = p.material ? 1 + number_of(*p.material, &p.compliance) : 0;
  if (a.materials.size() > std::size_t(PairRecord::max_own))
    throw Error(DYN_ERROR_LIMIT, "more than 253 different materials of wanted pairs");
}

// Those that the medium acts on come first.
void Compiler::add_ellipsoids() {
  for (const bool acting : {true, false})
    for (std::size_t k = 0; k < in.shapes.size(); ++k) {
      const ShapeEntry& s = in.shapes[k];
      const FrameRecord& frame = a.frames[std::size_t(s.frame)];
      if (!s.shape.fluid || acting != (has_medium() && frame.joint > 0 && in.frames[std::size_t(s.frame)].mass > 0)) continue;
      FluidEllipsoid x = fluid_ellipsoid(*s.shape.fluid, frame.X);
      x.joint = frame.joint, x.body = frame.body, x.shape = Index(k);
      a.fluid_ellipsoids.push_back(x);
      n.fluid_ellipsoids += acting;
    }
  n.fluid_shapes = Index(a.fluid_ellipsoids.size());
}

void Compiler::add_shapes() {
  Surfaces surfaces{a};
  for (const ShapeEntry& s : in.shapes) {
    ShapeRecord r{};
    r.name = text.add(s.shape.name), r.mesh = text.add(s.shape.mesh);
    r.type = s.shape.type, r.role = std::uint8_t(s.shape.role) & 0xFu, r.filter = std::uint8_t(s.shape.filter) & 0x3u,
    r.colour = s.shape.colour;
    r.frame = Index(s.frame), r.surface = surfaces.add(s.shape.surface);
    std::copy(s.shape.placement.begin(), s.shape.placement.end(), r.placement);
    std::copy(s.shape.size.begin(), s.shape.size.end(), r.size);
    r.radius = s.shape.radius, r.contype = s.shape.contype, r.conaffinity = s.shape.conaffinity,
    r.material = number_of(s.shape.material), r.latent = s.shape.material.latent & 0x3u,
    r.priority = std::uint32_t(s.shape.material.priority) & 0x7u;
    if (r.role == DYN_SHAPE_ROLE_COLLISION) a.geoms.push_back({Index(a.shapes.size())});
    a.shapes.push_back(r);
  }
  n.shapes = Index(a.shapes.size()), n.geoms = Index(a.geoms.size()), n.materials = Index(a.materials.size());
  n.hulls = Index(a.hulls.size()), n.trees = Index(a.trees.size()), n.grids = Index(a.grids.size());
  n.surface_numbers = Index(a.surface_numbers.size()), n.surface_indices = Index(a.surface_indices.size());
}

void Compiler::add_pairs() {
  for (const DisabledEntry& p : in.disabled) a.disabled_pairs.push_back({Index(p.frame1), Index(p.frame2), text.add(p.reason)});
  n.disabled = Index(a.disabled_pairs.size());
  a.pairs = pairs_of(a.joints, a.bodies, a.frames, a.shapes, a.geoms, a.disabled_pairs, wanted, known.overlapping);
  n.pairs = Index(a.pairs.size());
}

void Compiler::add_reports() {
  for (const ReportEntry& r : in.reports)
    if (r.message != nothing_tested && !r.message.starts_with(overlap_report) && !r.message.starts_with(massless_report))
      a.reports.push_back({r.level, Index(r.line), text.add(r.message)});
  for (const std::string& message : known.massless)
    a.reports.push_back({DYN_REPORT_LEVEL_DROPPED, 0, text.add(massless_report + message)});
  std::map<std::pair<Index, Index>, int> overlaps;  // by links
  for (const auto& [g, h] : known.overlapping) {
    const auto frame = [&](Index geom) { return a.shapes[std::size_t(a.geoms[std::size_t(geom)].shape)].frame; };
    ++overlaps[std::minmax({frame(g), frame(h)})];
  }
  if (!known.all_looked_at)
    a.reports.push_back({DYN_REPORT_LEVEL_WARNING, 0,
                         text.add(std::string(overlap_report) + "the search ended after " + std::to_string(max_overlaps) +
                                  " pairs, or " + std::to_string(max_looks) +
                                  " with overlapping boxes: others that overlap are tested")});
  for (const auto& [links, count] : overlaps) {
    const auto name = [&](Index frame) { return "'" + in.frames[std::size_t(frame)].name + "'"; };
    a.reports.push_back({DYN_REPORT_LEVEL_INFO, 0,
                         text.add(overlap_report + ("links " + name(links.first) + " and " + name(links.second)) + ", " +
                                  std::to_string(count) + (count == 1 ? " pair" : " pairs") + " of shapes")});
  }
  const bool tests_nothing =
      std::none_of(a.pairs.begin(), a.pairs.end(), [](const PairRecord& p) { return p.reason == DYN_PAIR_REASON_TESTED; });
  if (n.geoms >= 2 && n.geoms <= max_geoms && tests_nothing)
    a.reports.push_back({DYN_REPORT_LEVEL_WARNING, 0, text.add(nothing_tested)});
  n.reports = Index(a.reports.size());
}

void Compiler::add_constraints() {
  for (const dynConstraint& c : constraints_of(in.constraints, id))
    a.constraints.push_back({c, text.add(in.constraints[a.constraints.size()].name)});
  n.constraints = Index(a.constraints.size()), n.slots = n.constraints + Index(in.constraint_slots);
  n.constraint_rows = room_for_rows(in.constraints, in.constraint_slots) + Index(in.couplings.size());
}

// "neutral" is the first.
void Compiler::add_configurations() {
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
      throw Error(DYN_ERROR_SIZE, "configuration '" + c.name + "' has " + std::to_string(q.size()) +
                                      " numbers, the model needs nq = " + std::to_string(n.nq));
    a.configuration_names.push_back(text.add(c.name));
    a.configurations.insert(a.configurations.end(), q.begin(), q.end());
  }
  n.configurations = Index(a.configuration_names.size());
}

void Compiler::add_configuration_states() {
  for (Index k = 0; k < n.configurations; ++k)
    for (const Index f : a.mocaps) {
      const double* X = a.frames[std::size_t(f)].placement;
      if (k > 0) {
        const auto& given = in.configurations[std::size_t(k) - 1].mocaps;
        if (const auto at = given.find(in.frames[std::size_t(f)].name); at != given.end()) X = at->second.data();
      }
      a.configuration_mocaps.insert(a.configuration_mocaps.end(), X, X + 12);
    }
  const std::size_t size = std::size_t(n.nv + n.nu + n.na + 1);
  a.configuration_states.assign(size * std::size_t(n.configurations), 0.0);
  double* v = a.configuration_states.data();
  for (const ConfigurationEntry& c : in.configurations) {
    v += size;  // that of "neutral" is zero
    double *u = v + n.nv, *act = u + n.nu;
    for (std::size_t j = 0; j < c.v_by_joint.size(); ++j)
      std::copy(c.v_by_joint[j].begin(), c.v_by_joint[j].end(), v + idx_v[j]);
    for (std::size_t k = 0; k < a.actuators.size(); ++k)
      if (const auto given = c.actuators.find(in.actuators[k].name); given != c.actuators.end()) {
        const ActuatorRecord& r = a.actuators[k];
        std::copy_n(given->second.control.begin(), r.spec.controls, u + r.spec.idx_u);
        if (r.act >= 0) std::copy_n(given->second.activation.begin(), r.spec.activations, act + r.act);
      }
    act[n.na] = c.time;
  }
  SimulationRecord r = in.simulation;
  r.initial = 0;
  for (Index k = 0; k < n.configurations; ++k)
    if (k > 0 && in.configurations[std::size_t(k) - 1].name == in.initial) r.initial = k;
  a.simulation.push_back(r);
}

}  // namespace dyn
