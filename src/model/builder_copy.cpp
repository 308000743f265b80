// A builder that holds what a model was made from: finished again, it makes the same model.
#include <algorithm>
#include <map>

#include "builder_impl.hpp"
#include "builder_surface.hpp"
#include "constraint/list.hpp"
#include "effect/list.hpp"
#include "table/sensors.hpp"

namespace dyn {

namespace {

Placement placement_of(const double* x) {
  Placement out;
  std::copy(x, x + 12, out.begin());
  return out;
}
Axis axis_of(const double* x) { return {x[0], x[1], x[2]}; }

template <class Impl>
void copy_compliances(const Model& m, Impl& to) {
  if (m.n.compliances == 0) return;
  to.compliant = true, to.impratio = m.compliances()[0].ratio, to.pyramidal = m.compliances()[0].pyramidal != 0;
  for (Index k = 0; k < m.n.geoms; ++k) to.shapes[std::size_t(m.geoms()[k].shape)].shape.compliance = m.geom_compliances()[k].law;
  for (Index k = 0; k < m.n.limits; ++k)
    to.joints[std::size_t(m.bodies()[m.limits()[k].body].joint) - 1].spec.compliance = m.limit_compliances()[k].law;
  for (Index k = 0; k < m.n.constraints; ++k) to.constraints[std::size_t(k)].compliance = m.constraint_compliances()[k].law;
  for (Index k = 0; k < m.n.tendons; ++k) {
    TendonEntry& t = to.tendons[std::size_t(k)];
    t.compliance = m.tendon_compliances()[k].law, t.friction_compliance = m.tendon_friction_compliances()[k].law;
  }
  for (Index j = 1; j < m.n.joints; ++j)
    if (const JointRecord& r = m.joints()[j]; r.nv > 0)
      to.joints[std::size_t(j) - 1].spec.friction_compliance = m.dof_compliances()[r.idx_v].law;
  for (Index k = 0; k < m.n.couplings; ++k) to.couplings[std::size_t(k)].compliance = m.coupling_compliances()[k].law;
  std::size_t pair = 0;
  for (Index k = 0; k < m.n.pairs; ++k) {
    const PairRecord& r = m.pairs()[k];
    if (r.material()) to.pairs[pair].compliance = m.material_compliances()[r.material() - 1].law;
    pair += r.wanted();
  }
}

}  // namespace

JointSpec spec_of(const Model& m, const JointRecord& r) {
  JointSpec s;
  s.name = m.string(r.name), s.type = r.type;
  s.parent.name = r.parent ? m.string(m.joints()[r.parent].name) : "";
  s.placement = placement_of(r.placement);
  s.axis = axis_of(r.axis), s.axis2 = axis_of(r.axis2), s.pitch = r.pitch;
  for (const PartRecord *p = m.parts() + r.first_part, *end = p + r.parts; p != end; ++p) {
    JointSpec part;
    part.type = p->type, part.placement = placement_of(p->placement);
    part.axis = axis_of(p->axis), part.axis2 = axis_of(p->axis2), part.pitch = p->pitch;
    s.parts.push_back(part);
  }
  const int nv = spec_nv(s);
  auto take = [](const double* x, Index first, Index n) { return std::vector<double>(x + first, x + first + n); };
  for_each_effect([&]<class E>() {
    if constexpr (effect::HasCoefficient<E>) E::of(s) = nv == 1 ? std::vector<double>{E::of(r)} : take(E::of(m), r.idx_v, nv);
  });
  if (spec_nq(s) == 1) s.spring_reference = {r.spring_reference};
  else s.spring_reference = take(m.spring_reference(), r.idx_q, spec_nq(s));
  if (r.leader >= 0) {
    s.mimic = m.string(m.joints()[r.leader].name), s.mimic_ratio = r.ratio, s.mimic_offset = r.offset;
    return s;
  }
  s.lower = take(m.lower_limit(), r.idx_q, r.nq), s.upper = take(m.upper_limit(), r.idx_q, r.nq);
  s.velocity = take(m.velocity_limit(), r.idx_v, nv), s.effort = take(m.effort_limit(), r.idx_v, nv);
  return s;
}

std::vector<JointPart> parts_of(const JointSpec& s) {
  if (s.type != DYN_JOINT_TYPE_COMPOSITE) return {{s.type, s.axis, s.axis2, s.pitch, SE3<double>::identity()}};
  std::vector<JointPart> out;
  for (const JointSpec& p : s.parts) out.push_back({p.type, p.axis, p.axis2, p.pitch, load_se3(p.placement.data())});
  return out;
}

Builder::Builder(const Model& m) : Builder(m.string(m.model_name)) {
  std::copy(m.gravity, m.gravity + 3, impl->gravity.begin());
  for (Index j = 1; j < m.n.joints; ++j) {
    const JointRecord& r = m.joints()[j];
    JointEntry e;
    e.spec = spec_of(m, r);
    e.parent = r.parent - 1;
    e.placement = load_se3(r.placement);
    e.parts = parts_of(e.spec);
    e.elements = elements_of(e.spec, e.parts);
    impl->joints.push_back(std::move(e));
  }
  for (Index f = 1; f < m.n.frames; ++f) {
    const FrameRecord& r = m.frames()[f];
    FrameEntry e{m.string(r.name), r.type, r.joint - 1, load_se3(r.placement), Inertia<double>::zero(), {}, {}, {}};
    if (r.link >= 0) {
      const LinkRecord& link = m.links()[r.link];
      e.mass = link.mass;
      std::copy(link.com, link.com + 3, e.com.begin());
      std::copy(link.inertia, link.inertia + 9, e.inertia.begin());
      e.compensation = m.compensation(r.link);
      e.Y = act(e.X, Inertia<double>::at_com(link.mass, load3(link.com), load33(link.inertia)));
    }
    e.parent = r.parent, e.mocap = std::find(m.mocaps(), m.mocaps() + m.n.mocaps, f) != m.mocaps() + m.n.mocaps;
    impl->frame_index[e.name].push_back(int(f));
    impl->frames.push_back(std::move(e));
  }
  std::map<std::pair<dynShapeType, Index>, SurfacePtr> surfaces;  // each once
  for (Index k = 0; k < m.n.shapes; ++k) {
    const ShapeRecord& r = m.shapes()[k];
    Shape s{m.string(r.name),          r.type, dynShapeRole(r.role), m.string(m.frames()[r.frame].name),
            placement_of(r.placement), {},     m.string(r.mesh)};
    std::copy(r.size, r.size + 3, s.size.begin());
    s.radius = r.radius, s.contype = r.contype, s.conaffinity = r.conaffinity, s.material = material_of(m, r),
    s.colour = r.colour, s.filter = PairFilter(r.filter);
    if (r.surface >= 0) {
      SurfacePtr& surface = surfaces[{dynShapeType(r.type), r.surface}];
      if (!surface) surface = surface_of(m, k);
      s.surface = surface;
    }
    impl->shapes.push_back({std::move(s), r.frame});
  }
  for (Index k = 0; k < m.n.fluid_shapes; ++k) {
    const FluidEllipsoid& e = m.fluid_ellipsoids()[k];
    FluidShape& x = impl->shapes[std::size_t(e.shape)].shape.fluid.emplace();
    std::copy(e.coefficients, e.coefficients + 5, x.coefficients.begin()), std::copy(e.half, e.half + 3, x.semiaxes.begin());
    x.placement = placement_of(e.placement);
  }
  for (Index k = 0; k < m.n.reports; ++k) {
    const ReportRecord& r = m.reports()[k];
    impl->reports.push_back({r.level, r.line, m.string(r.message)});
    impl->allow_massless |= impl->reports.back().message.starts_with(massless_report);
  }
  for (Index k = 0; k < m.n.disabled; ++k) {
    const DisabledRecord& r = m.disabled_pairs()[k];
    impl->disabled.push_back({r.frame1, r.frame2, m.string(r.reason)});
  }
  for (Index k = 0; k < m.n.constraints; ++k) {
    const ConstraintRecord& r = m.constraints()[k];
    const int less = between_joints(r.spec.type) ? 1 : 0;
    impl->constraints.push_back({m.string(r.name), r.spec, r.spec.first - less, r.spec.second - less});
  }
  impl->constraint_slots = m.n.slots - m.n.constraints;
  impl->contact_capacity = m.contact_capacity;
  impl->density = m.density, impl->viscosity = m.viscosity;
  std::copy(m.wind, m.wind + 3, impl->wind.begin());
  for (Index k = 0; k < m.n.tendons; ++k) {
    TendonEntry t{m.string(m.tendons()[k].name), m.tendons()[k].spec, {}};
    const PathRecord& p = m.paths()[k];
    for (const PathElement *e = m.path_elements() + p.first, *end = e + p.elements; e != end; ++e)
      t.elements.push_back({e->type, e->type == DYN_TENDON_ELEMENT_TYPE_JOINT ? e->id - 1 : e->id, e->side_id, e->value});
    impl->tendons.push_back(std::move(t));
  }
  for (const PathRecord *p = m.paths() + m.n.tendons, *end = p + m.n.couplings; p != end; ++p) {
    impl->couplings.push_back({m.string(p->name), p->first, p->elements, {}});
    std::copy_n(p->polynomial, 5, impl->couplings.back().coefficients.begin());
  }
  for (Index k = 0; k < m.n.actuators; ++k) {
    const ActuatorRecord& r = m.actuators()[k];
    const dynTransmission by = r.spec.transmission;
    const int target = by == DYN_TRANSMISSION_JOINT || by == DYN_TRANSMISSION_AXES ? r.spec.joint - 1
                       : by == DYN_TRANSMISSION_TENDON ? r.spec.tendon : r.spec.frame;
    impl->actuators.push_back({m.string(r.name), r.spec, target, r.spec.reference});
  }
  for (const ForceLimitRecord *r = m.force_limits(), *end = r + m.n.force_limits; r != end; ++r)
    impl->force_limits.push_back(
        {r->tendon >= 0, r->with_weight != 0, int(r->tendon >= 0 ? r->tendon : r->joint - 1), {r->range[0], r->range[1]}});
  for (Index k = 0; k < m.n.sensors; ++k) {
    const dynSensor& s = m.sensors()[k].spec;
    const int object = sensor_row(s.quantity).object == SensorObject::Joint ? s.object - 1 : s.object;
    impl->sensors.push_back({m.string(m.sensors()[k].name), s, object, s.reference});
  }
  for (Index k = 0; k < m.n.pairs; ++k) {
    const PairRecord& r = m.pairs()[k];
    if (!r.wanted()) continue;
    PairEntry pair{int(m.geoms()[r.a].shape), int(m.geoms()[r.b].shape), std::nullopt};
    if (r.material()) pair.material = m.materials()[r.material() - 1];
    impl->pairs.push_back(pair);
  }
  copy_compliances(m, *impl);
  for (Index k = 1; k < m.n.configurations; ++k) {  // 0: neutral
    const double *q = m.configurations() + std::ptrdiff_t(k) * m.n.nq, *v = m.configuration_state(k), *u = v + m.n.nv,
                 *act = u + m.n.nu;
    ConfigurationEntry c{m.string(m.configuration_names()[k]),
                         true,
                         {},
                         by_joint(impl->joints, {q, q + m.n.nq}),
                         by_joint(impl->joints, {v, u}, own_nv)};
    for (Index i = 0; i < m.n.actuators; ++i) {
      const ActuatorRecord& r = m.actuators()[i];
      ConfigurationState::Actuator& x = c.actuators[m.string(r.name)];
      std::copy_n(u + r.spec.idx_u, r.spec.controls, x.control.begin());
      if (r.act >= 0) std::copy_n(act + r.act, r.spec.activations, x.activation.begin());
    }
    c.time = act[m.n.na];
    for (Index i = 0; i < m.n.mocaps; ++i)
      c.mocaps[m.string(m.frames()[m.mocaps()[i]].name)] =
          placement_of(m.configuration_mocaps() + 12 * (std::ptrdiff_t(k) * m.n.mocaps + i));
    impl->configurations.push_back(std::move(c));
  }
  impl->simulation = *m.simulation(), impl->initial = m.string(m.configuration_names()[m.simulation()->initial]);
}

}  // namespace dyn
