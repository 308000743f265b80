// Sizes and offsets first, then whatever is an index.
#include "block_check.hpp"

#include <algorithm>
#include <cstring>

#include "constraint/list.hpp"
#include "effect/list.hpp"
#include "model/constraints.hpp"
#include "model/unit_norms.hpp"
#include "table/enums.hpp"
#include "table/sensors.hpp"

namespace dyn {

namespace {

// The layout is a function of the sizes (builder_finish.cpp).
bool laid_out(const Model& m, const ModelSizes& n, std::size_t bytes) {
  const auto round_up = [](std::uint64_t x, std::uint64_t boundary) { return (x + boundary - 1) / boundary * boundary; };
  std::uint64_t end = sizeof(Model);
#define FIELD(type, field, count, sentence)                                               \
  end = round_up(end, alignof(type) > alignof(double) ? 64 : alignof(double));            \
  if (8 * std::uint64_t(m.offset[std::size_t(Model::Field::field)]) != end) return false; \
  end += std::uint64_t(count) * sizeof(type);                                             \
  if (end > bytes) return false;
#include "model/model_fields.def"
#undef FIELD
  return round_up(end, 64) == bytes;
}

}  // namespace

bool BlockChecker::layout(std::size_t bytes) {
  if (!require(m.magic == Model::magic_value && m.bytes == bytes, "the block's own header is wrong")) return false;
  Index sizes[sizeof(ModelSizes) / sizeof(Index)];
  static_assert(sizeof sizes == sizeof(ModelSizes));
  std::memcpy(sizes, &m.n, sizeof sizes);
  for (const Index size : sizes)
    if (!require(size >= 0 && size <= Index(1) << 30, "a size is out of range")) return false;
  if (!require(n.joints >= 1 && n.bodies >= 1 && n.frames >= 1 && n.configurations >= 1 && n.text >= 1, "it has no universe"))
    return false;
  if (!require(std::uint64_t(n.configurations) * std::uint64_t(n.nq) <= bytes, "its configurations are larger than the file"))
    return false;
  if (!require(std::uint64_t(n.configurations) * (std::uint64_t(n.nv) + std::uint64_t(n.nu) + std::uint64_t(n.na) + 1) <= bytes,
               "the states of its configurations are larger than the file"))
    return false;
  if (!require((n.mimic_v == 0 && n.mimic_q == 0 && n.nvx == n.nv && n.nqx == n.nq) ||
      (n.mimic_v == n.nvx && n.mimic_q == n.nqx && n.nvx >= n.nv && n.nqx >= n.nq),
               "sizes contradict each other"))
    return false;
  if (!require(m.has_mimic == 0 || m.has_mimic == 1, "sizes contradict each other")) return false;
  if (!require((n.mimic_v > 0) == (m.has_mimic == 1) && n.slots >= n.constraints &&
      n.slots - n.constraints <= 1000, "sizes contradict each other")) return false;
  // room for a line of the load report that came and went
  ModelSizes with_capacity = n;
  ++with_capacity.reports;
  return require(laid_out(m, n, bytes) || laid_out(m, with_capacity, bytes),
                 "its arrays are not where their sizes put them, or larger than the file");
}

bool BlockChecker::names() {
  if (!require(m.text()[0] == '\0' && m.text()[n.text - 1] == '\0', "the text has no end") || !text(m.model_name)) return false;
  return each(n.joints, [&](Index k) { return index(m.joints_by_name()[k], n.joints, "joint of a name"); }) &&
         each(n.frames, [&](Index k) { return index(m.frames_by_name()[k], n.frames, "frame of a name"); }) &&
         each(n.configurations, [&](Index k) { return text(m.configuration_names()[k]); });
}

bool BlockChecker::coefficients() {
  const auto known_range = [](double x) { return x >= 0; };
  bool coefficients = true;
  for_each_effect([&]<class E>() {
    if constexpr (effect::HasCoefficient<E>) coefficients = coefficients && numbers(E::of(m), n.nv, E::name, is_coefficient);
  });
  if (!coefficients || !numbers(m.spring_reference(), n.nq, "where a spring rests", [](double x) { return std::isfinite(x); }) ||
      !numbers(m.velocity_limit(), n.nv, "a limit of velocity", known_range) ||
      !numbers(m.effort_limit(), n.nv, "a limit of effort", known_range) ||
      !numbers(m.lower_limit(), n.nq, "a limit", is_known) || !numbers(m.upper_limit(), n.nq, "a limit", is_known) ||
      !numbers(m.neutral(), n.nq, "the neutral configuration", [](double x) { return std::isfinite(x); }) ||
      !numbers(m.configurations(), std::int64_t(n.configurations) * n.nq, "a configuration",
               [](double x) { return std::isfinite(x); }) ||
      !numbers(m.configuration_states(), std::int64_t(n.configurations) * (n.nv + n.nu + n.na + 1),
               "the state of a configuration", [](double x) { return std::isfinite(x); }))
    return false;
  const SimulationRecord& s = *m.simulation();
  if (!require(std::isfinite(s.dt) && s.dt > 0 && is_value(s.integrator) && (s.effects & ~std::uint32_t(DYN_EFFECT_ALL)) == 0,
               "what its steps are") ||
      !index(s.initial, n.configurations, "its initial configuration"))
    return false;
  for (Index k = 0; k < n.configurations; ++k)
    if (!require(zero_norm_joint(m, m.configurations() + std::ptrdiff_t(k) * n.nq) == 0, "the quaternion of a configuration"))
      return false;
  if (!require(zero_norm_joint(m, m.neutral()) == 0, "the quaternion of the neutral configuration")) return false;
  bool no_overflow = true;
  const auto small = [&](double x) { no_overflow &= std::abs(x) < 1e25; };
  for (Index k = 0; k < n.nv; ++k) small(m.armature()[k]);
  for (Index i = 0; i < n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    small(b.m), small(b.pitch), small(b.ratio);
    for (int k = 0; k < 3; ++k) small(b.h[k]), small(b.I.x[k]), small(b.I.y[k]), small(b.I.z[k]);
  }
  return require(m.effects == effects_of(m), "its effects") &&
         require(m.no_overflow == Index(no_overflow), "the sizes of its numbers") &&
         require(are_finite(m.gravity) && are_finite(m.wind), "gravity or wind") &&
         require(is_coefficient(m.density) && is_coefficient(m.viscosity), "the medium") &&
         require(is_coefficient(m.total_mass), "the mass");
}

bool BlockChecker::frames() {
  Index links = 0;
  const bool good = each(n.frames, [&](Index f) {
    const FrameRecord& r = m.frames()[f];
    if (!text(r.name) || !index(r.joint, n.joints, "joint of a frame") ||
        !index(r.parent, std::max(f, Index(1)), "parent of a frame"))
      return false;
    if (!require(r.type == DYN_FRAME_TYPE_OP_FRAME || r.type == DYN_FRAME_TYPE_JOINT || r.type == DYN_FRAME_TYPE_FIXED_JOINT ||
        r.type == DYN_FRAME_TYPE_BODY || r.type == DYN_FRAME_TYPE_SENSOR,
                 "type of a frame"))
      return false;
    return require(r.link == (r.type == DYN_FRAME_TYPE_BODY ? links++ : -1), "link of a frame") &&
           require(r.type != DYN_FRAME_TYPE_JOINT || r.joint > 0, "joint of a frame") &&
           require(r.body == m.joints()[r.joint].last_body, "body of a frame") &&
           require(r.place == r.body || (r.body == 0 && r.place >= n.bodies && r.place < n.bodies + n.mocaps),
                   "place of a frame") &&
           require(is_finite(r.X) && are_finite(r.placement), "placement of a frame");
  });
  if (!good || !require(m.frames()[0].joint == 0 && m.frames()[0].link == -1, "the frame of the universe") ||
      !require(links == n.links, "links of the frames")) return false;
  if (!each(n.mocaps, [&](Index k) {
        const Index f = m.mocaps()[k];
        return index(f, n.frames, "frame of a mocap body") &&
               require(m.frames()[f].link >= 0 && m.frames()[f].place == n.bodies + k, "a mocap body");
      }))
    return false;
  for (std::ptrdiff_t k = 0; k < 12 * std::ptrdiff_t(n.configurations) * n.mocaps; ++k)
    if (!require(std::isfinite(m.configuration_mocaps()[k]), "placement of a mocap body")) return false;
  const auto on_a_body = [&](const auto& r) {
    return require(r.joint > 0, "a joint of a weight") && index(r.joint, n.joints, "joint of a weight") &&
        require(r.body == m.joints()[r.joint].last_body, "body of a weight");
  };
  return each(n.links, [&](Index k) {
    const LinkRecord& l = m.links()[k];
    return require(is_coefficient(l.mass) && are_finite(l.com) && are_finite(l.inertia), "inertia of a link");
  }) && each(n.gravity_compensations, [&](Index k) {
    const GravityCompensation& w = m.gravity_compensations()[k];
    return on_a_body(w) && index(w.link, n.links, "link of a weight") &&
           require(is_finite(w.at) && std::isfinite(w.mass), "a weight");
  }) && each(n.drag_boxes, [&](Index k) {
    const DragBox& b = m.drag_boxes()[k];
    return on_a_body(b) && require(is_finite(b.X) && are_finite(b.half), "a box that a medium drags on");
  }) && require(n.fluid_ellipsoids <= n.fluid_shapes, "the number of ellipsoids in a medium") &&
         each(n.fluid_shapes, [&](Index k) {
    const FluidEllipsoid& e = m.fluid_ellipsoids()[k];
    return (k >= n.fluid_ellipsoids || on_a_body(e)) && index(e.shape, n.shapes, "shape of an ellipsoid in a medium") &&
           require(is_finite(e.X) && are_finite(e.half) && are_finite(e.coefficients) && are_finite(e.added_mass) &&
                       are_finite(e.added_inertia) && are_finite(e.placement), "an ellipsoid in a medium");
  });
}

bool BlockChecker::constraints() {
  char message[256];
  Index rows = max_rows * (n.slots - n.constraints) + n.couplings;
  return each(n.constraints, [&](Index k) {
    const ConstraintRecord& c = m.constraints()[k];
    if (!text(c.name) || !require(int(c.spec.type) > DYN_CONSTRAINT_TYPE_NONE &&
        check_constraint(m, c.spec, message, sizeof message) == DYN_OK, "a constraint")) return false;
    Constraint counted{};
    counted.type = c.spec.type, counted.joint_type = c.spec.joint_type;
    rows += constraint_rows(counted);
    return true;
  }) && require(rows == n.constraint_rows, "rows of the constraints") && compliances();
}

bool BlockChecker::compliances() {
  const std::int64_t all = std::int64_t(n.geoms) + n.limits + n.constraints + 2 * std::int64_t(n.tendons) + n.couplings +
                           n.materials + n.nv;
  const auto rubs = [](double c) { return c > 0; };
  const auto rows = n.compliances > 0 ? std::count_if(m.friction(), m.friction() + n.nv, rubs) : 0;
  return require(n.compliances == 0 || n.compliances == all, "the number of compliances") &&
         require(n.friction_rows == rows, "the number of rows of dry friction") && each(n.compliances, [&](Index k) {
           const ComplianceRecord& x = m.compliances()[k];
           return require(is_valid(x.law) && is_coefficient(x.weight[0]) && is_coefficient(x.weight[1]) && x.ratio > 0 &&
                              std::isfinite(x.ratio) && (x.pyramidal == 0 || x.pyramidal == 1),
                          "a compliance");
         });
}

bool BlockChecker::actuators() {
  Index nu = 0, na = 0, rows = 0, adhesions = 0;
  const bool limits = each(n.force_limits, [&](Index k) {
    const ForceLimitRecord& x = m.force_limits()[k];
    if (!require(x.range[0] <= x.range[1] && (x.with_weight == 0 || x.with_weight == 1), "a limit of actuators")) return false;
    if (x.joint < 0)
      return require(x.joint == -1 && x.dof == -1 && x.tendon >= 0 && x.tendon < n.tendons, "a limit of actuators");
    return index(x.joint, n.joints, "a limit of actuators") &&
           require(x.joint > 0 && x.tendon == -1 && x.dof == m.joints()[x.joint].idx_v && m.joints()[x.joint].nv == 1,
                   "a limit of actuators");
  });
  return limits && each(n.actuators, [&](Index k) {
    const ActuatorRecord& r = m.actuators()[k];
    const dynActuator& a = r.spec;
    if (!text(r.name) || !index(a.joint, n.joints, "joint of an actuator")) return false;
    const JointRecord& j = m.joints()[a.joint];
    const bool coordinate = a.transmission == DYN_TRANSMISSION_JOINT && !has_general_law(a) && r.limit == -1;
    const dynTransmission by = a.transmission;
    const bool framed = by == DYN_TRANSMISSION_SITE || by == DYN_TRANSMISSION_SLIDER_CRANK || by == DYN_TRANSMISSION_BODY;
    const bool refers = by == DYN_TRANSMISSION_SLIDER_CRANK || (by == DYN_TRANSMISSION_SITE && a.reference >= 0);
    if (!require(is_value(a.type) && is_value(a.transmission), "type of an actuator") ||
        (a.transmission == DYN_TRANSMISSION_JOINT && !index(a.component, j.nv, "component of an actuator")) ||
        !require(coordinate ? r.path == -1 && r.row == -1 : r.row == rows++, "path of an actuator") ||
        (!coordinate && !index(r.path, n.paths, "path of an actuator")))
      return false;
    if (!require((a.transmission == DYN_TRANSMISSION_TENDON ? r.path < n.tendons && a.tendon == r.path : a.tendon == -1) &&
                     (framed ? a.frame >= 0 && a.frame < n.frames : a.frame == -1) &&
                     (refers ? a.reference >= 0 && a.reference < n.frames : a.reference == -1) &&
                     (by != DYN_TRANSMISSION_BODY || m.frames()[a.frame].type == DYN_FRAME_TYPE_BODY || a.frame == 0),
                 "what an actuator acts on"))
      return false;
    if (!require(a.controls == controls_of(a) && a.idx_u == nu, "controls of an actuator") ||
        !require(r.limit >= -1 && r.limit < n.force_limits, "limit of an actuator"))
      return false;
    if (r.limit >= 0) {
      const ForceLimitRecord& x = m.force_limits()[r.limit];
      const bool of = by == DYN_TRANSMISSION_TENDON ? x.tendon == a.tendon : by == DYN_TRANSMISSION_JOINT && x.joint == a.joint;
      if (!require(of, "limit of an actuator")) return false;
    }
    adhesions += by == DYN_TRANSMISSION_BODY;
    nu += a.controls;
    Index q = -1;
    for (Index s = 0; s < n.euclidean_spans; ++s)
      if (const EuclideanSpan& span = m.euclidean_spans()[s]; r.v >= span.first_v && r.v < span.first_v + span.count)
        q = span.first_q + r.v - span.first_v;
    const Index activations = activations_of(a);
    if (!require(r.v == (coordinate ? j.idx_v + a.component : -1) && r.q == q && r.act == (activations > 0 ? na : -1) &&
                     a.idx_act == r.act && a.activations == activations,
                 "coordinates of an actuator"))
      return false;
    na += activations;
    double motor[sizeof a.motor / sizeof(double)];
    std::memcpy(motor, &a.motor, sizeof motor);
    const double scalars[] = {a.gear, a.kp, a.kv, a.gain, a.time_constant, a.rod, a.ki, a.integral_limit, a.slew, r.period};
    if (!require(are_finite(motor) && are_finite(a.gain_slope) &&
                     (a.type != DYN_ACTUATOR_TYPE_DC_MOTOR || (a.motor.resistance > 0 && a.motor.constant > 0)) &&
                     r.period >= 0 && (a.motor.heat_capacity > 0 || !(a.motor.thermal_resistance > 0)) &&
                     a.velocity_range[0] <= a.velocity_range[1] && a.feedforward_range[0] <= a.feedforward_range[1] &&
                     (by != DYN_TRANSMISSION_SLIDER_CRANK || a.rod > 0),
                 "a number of an actuator"))
      return false;
    return require(are_finite(scalars) && are_finite(a.bias) && are_finite(r.gain) && are_finite(r.bias) &&
                       a.time_constant >= 0 && (a.integrates == 0 || (a.integrates == 1 && a.time_constant == 0)),
                   "a number of an actuator") &&
           require(r.bias[1] == 0 || r.q >= 0 || r.path >= 0, "an actuator depends on a length that is none") &&
           require(a.control_range[0] <= a.control_range[1] && a.force_range[0] <= a.force_range[1] &&
                       a.act_range[0] <= a.act_range[1],
                   "a range of an actuator");
  }) && require(nu == n.nu && na == n.na && adhesions == n.adhesions &&
                n.path_rows == path_rows_of_tendon * n.tendons + n.couplings + rows,
                "controls of the actuators");
}

bool BlockChecker::path_element(const PathElement& e) {
  if (!require(is_value(e.type) && std::isfinite(e.value) && is_finite(e.X) && is_finite(e.side), "a number of a path"))
    return false;
  const bool in_space = e.type != DYN_TENDON_ELEMENT_TYPE_PULLEY && e.type != DYN_TENDON_ELEMENT_TYPE_JOINT;
  if (!require(in_space || e.side_id == -1, "side of a path")) return false;
  if (e.type == DYN_TENDON_ELEMENT_TYPE_PULLEY) return require(e.value > 0, "the divisor of a path");
  if (e.type == DYN_TENDON_ELEMENT_TYPE_JOINT) {
    if (!index(e.id, n.joints, "joint of a path")) return false;
    const JointRecord& j = m.joints()[e.id];
    return require(e.q == j.idx_q && e.dof == j.idx_v && e.body == j.last_body && e.place == e.body, "joint of a path") &&
           index(e.q, n.nq, "coordinate of a path") && index(e.dof, n.nv, "degree of freedom of a path");
  }
  return index(e.id, n.frames, "frame of a path") && require(e.body == m.frames()[e.id].body && e.place == m.frames()[e.id].place,
                 "body of a path") &&
         (e.side_id < 0 || (index(e.side_id, n.frames, "side of a path") &&
                            require(e.side_place == m.frames()[e.side_id].place, "side of a path")));
}

bool BlockChecker::path(Index k) {
  const PathRecord& p = m.paths()[k];
  if (!require(are_finite(p.wrench) && are_finite(p.polynomial) && are_finite(p.neutral), "a number of a path") ||
      !text(p.name) ||
      !index(p.joint, n.joints, "joint of a path") || !index(p.first_dof, std::int64_t(n.path_dofs) + 1, "path") ||
      !index(p.dofs, std::int64_t(n.path_dofs) - p.first_dof + 1, "path"))
    return false;
  const Index *const dofs = m.path_dofs() + p.first_dof, *const up = m.path_parents() + p.first_dof;
  for (Index i = 0; i < p.dofs; ++i) {
    if (!index(dofs[i], i > 0 ? dofs[i - 1] : n.nv, "degree of freedom of a path")) return false;
    const Index parent = m.dof_parent()[dofs[i]];
    if (!require(parent < 0 ? up[i] == -1 : up[i] > i && up[i] < p.dofs && dofs[up[i]] == parent, "degree of freedom of a path"))
      return false;
  }
  if (k >= n.tendons && k < n.tendons + n.couplings)
    return require(p.kind == PathKind::Coupling, "a coupling") && index(p.first, n.tendons, "tendon of a coupling") &&
           (p.elements == -1 || index(p.elements, n.tendons, "tendon of a coupling"));
  const bool known = k < n.tendons ? p.kind == PathKind::Fixed || p.kind == PathKind::Spatial
                                   : p.kind == PathKind::SliderCrank ? p.elements == 2
                                   : p.kind == PathKind::Site ? p.elements <= 2
                                   : (p.kind == PathKind::Fixed || p.kind == PathKind::Axes || p.kind == PathKind::AxesInParent ||
                                      p.kind == PathKind::Adhesion) && p.elements == 1;
  if (!require(known && p.elements > 0, "kind of a path") || !index(p.first, n.path_elements, "element of a path") ||
      !index(p.elements, std::int64_t(n.path_elements) - p.first + 1, "element of a path"))
    return false;
  const PathElement* const e = m.path_elements() + p.first;
  const bool axes = p.kind == PathKind::Axes || p.kind == PathKind::AxesInParent;
  const auto is_site = [&](Index i) { return i >= 0 && i < p.elements && e[i].type == DYN_TENDON_ELEMENT_TYPE_SITE; };
  return each(p.elements, [&](Index i) {
    const bool joint = e[i].type == DYN_TENDON_ELEMENT_TYPE_JOINT, wrap = e[i].type == DYN_TENDON_ELEMENT_TYPE_SPHERE ||
                                                                          e[i].type == DYN_TENDON_ELEMENT_TYPE_CYLINDER;
    return path_element(e[i]) &&
           require(joint == (p.kind == PathKind::Fixed || axes) && (p.kind == PathKind::Spatial || joint || is_site(i)) &&
                       (!axes || m.joints()[e[i].id].type == DYN_JOINT_TYPE_SPHERICAL ||
                        m.joints()[e[i].id].type == DYN_JOINT_TYPE_FREE_FLYER) &&
                       (!wrap || (is_site(i - 1) && is_site(i + 1))),
                   "element of a path");
  });
}

bool BlockChecker::tendons() {
  const auto is_range = [](const double(&x)[2]) { return x[0] <= x[1]; };
  if (!require(std::int64_t(n.tendons) + n.couplings <= n.paths, "paths")) return false;
  if (!each(n.paths, [&](Index k) { return path(k); })) return false;
  return each(n.tendons, [&](Index k) {
    const dynTendon& t = m.tendons()[k].spec;
    return text(m.tendons()[k].name) &&
           require(is_value(t.type) && t.elements == m.paths()[k].elements &&
                       (t.type == DYN_TENDON_TYPE_FIXED) == (m.paths()[k].kind == PathKind::Fixed),
                   "a tendon") &&
           require(is_coefficient(t.stiffness) && is_coefficient(t.damping) && is_coefficient(t.friction) &&
                       is_coefficient(t.armature) && are_finite(t.rest) && is_range(t.rest) && is_range(t.range),
                   "a number of a tendon");
  });
}

bool BlockChecker::sensors() {
  Index values = 0;
  return each(n.sensors, [&](Index k) {
    const dynSensor& s = m.sensors()[k].spec;
    if (!text(m.sensors()[k].name) || !require(is_value(s.quantity), "quantity of a sensor")) return false;
    const SensorRow& row = sensor_row(s.quantity);
    if (!require(s.count >= 0 && s.count <= max_sensor_count && s.values < 1u << std::size(value_sizes) &&
                     is_value(s.side) && is_value(s.other_side) && is_value(s.reduction) && s.delay >= 0,
                 "a number of a sensor") ||
        !require(s.idx == values && s.size == size_of(s) && s.order == row.order &&
                     s.of_values == (s.quantity == DYN_QUANTITY_CONTACT ? values_size(s) : 0), "size of a sensor"))
      return false;
    values += s.size;
    if (!require(are_finite(s.placement) && are_finite(s.reference_placement) && are_finite(s.extent) && are_finite(s.field) &&
                     std::isfinite(s.cutoff) && std::isfinite(s.noise),
                 "a number of a sensor") ||
        !require(s.reference >= -1 && s.reference < (s.other_side == DYN_SIDE_SHAPE ? n.shapes : row.refers ? n.frames : 0) &&
                     (s.quantity != DYN_QUANTITY_INSIDESITE || s.reference >= 0),
                 "reference of a sensor"))
      return false;
    switch (row.object) {
      case SensorObject::None: return require(s.object == -1, "object of a sensor");
      case SensorObject::Joint: {
        if (!index(s.object, n.joints, "joint of a sensor")) return false;
        const JointRecord& j = m.joints()[s.object];
        const bool ball = s.quantity == DYN_QUANTITY_BALLQUAT || s.quantity == DYN_QUANTITY_BALLANGVEL;
        const bool single = j.leader >= 0 || (j.nq == 1 && j.nv == 1);
        return require(s.object > 0 && (ball ? j.type == DYN_JOINT_TYPE_SPHERICAL : single), "joint of a sensor");
      }
      case SensorObject::Tendon: return index(s.object, n.tendons, "tendon of a sensor");
      case SensorObject::Actuator: return index(s.object, n.actuators, "actuator of a sensor");
      case SensorObject::Frame: return index(s.object, n.frames, "frame of a sensor");
      case SensorObject::Sides: {
        const auto good = [&](dynSide side, Index x) {
          if (side == DYN_SIDE_ANY) return x == -1;
          if (side != DYN_SIDE_SHAPE) return x >= 0 && x < n.frames;
          return x >= 0 && x < n.shapes && m.shapes()[x].role == DYN_SHAPE_ROLE_COLLISION;
        };
        const bool pair = s.side != DYN_SIDE_ANY && s.other_side != DYN_SIDE_ANY;
        return require(good(s.side, s.object) && good(s.other_side, s.reference) &&
                           (pair || s.quantity == DYN_QUANTITY_CONTACT), "side of a sensor");
      }
    }
    return false;
  }) && require(values == n.sensor_values, "values of the sensors");
}

bool BlockChecker::rest() {
  return each(n.reports, [&](Index k) {
    const ReportRecord& r = m.reports()[k];
    return text(r.message) &&
           require(is_value(dynReportLevel(r.level)), "level of a line of the load report");
  }) && each(n.disabled, [&](Index k) {
    const DisabledRecord& d = m.disabled_pairs()[k];
    if (!text(d.reason)) return false;
    for (const Index f : {d.frame1, d.frame2})
      if (!index(f, n.frames, "frame of a disabled pair") || !require(f == 0 ||
          m.frames()[f].type == DYN_FRAME_TYPE_BODY, "a disabled pair is of no links")) return false;
    return true;
  });
}

Damage check_block(const Model& m, std::size_t bytes) {
  BlockChecker c(m);
  (void)(c.layout(bytes) && c.names() && c.joints() && c.expanded() && c.order() && c.coordinates() && c.elimination() &&
         c.coefficients() && c.frames() && c.surfaces() && c.shapes() && c.constraints() && c.actuators() &&
         c.tendons() && c.sensors() && c.rest());
  return c.damage;
}

}  // namespace dyn
