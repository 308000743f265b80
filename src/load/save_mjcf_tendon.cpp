// Model to MJCF: tendons and their couplings.
#include <cmath>

#include "save_mjcf.hpp"

namespace dyn::load {

// The site at the origin of a frame: the frame itself or an added one.
std::string MjcfWriter::site(Index frame) {
  std::string& name = frame_sites[frame];
  if (name.empty()) {
    double identity[12];
    std::copy(identity_placement.begin(), identity_placement.end(), identity);
    name = site(frame, identity, (frame == 0 ? std::string("world") : frame_name(frame)) + "_site");
  }
  return name;
}

// The geom that a tendon wraps around: a shape of the model that lies there, or an added one that is massless, out of view, and
// loaded as a frame alone.
std::string MjcfWriter::wrapped_geom(const PathElement& e) {
  const FrameRecord& f = m.frames()[e.id];
  const SE3<double> X = load_se3(f.placement);
  const bool cylinder = e.type == DYN_TENDON_ELEMENT_TYPE_CYLINDER;
  const dynShapeType type = cylinder ? DYN_SHAPE_TYPE_CYLINDER : DYN_SHAPE_TYPE_SPHERE;
  const std::string frame = site(e.id);
  for (const auto& [k, name] : geom_names) {
    const ShapeRecord& s = m.shapes()[k];
    const FrameRecord& carrier = m.frames()[s.frame];
    if (s.type == type && s.size[0] == e.value && carrier.joint == f.joint && wraps_as(name, frame) &&
        is_same_pose(load_se3(carrier.placement) * load_se3(s.placement), X))
      return name;
  }
  std::string& name = wraps[{e.id, e.value, cylinder}];
  if (!name.empty()) return name;
  name = geoms.claim(frame);
  XmlElement& geom = *attachments[size_t(f.joint)].element->InsertNewChildElement("geom");
  put(geom, "name", name), put(geom, "type", std::string(cylinder ? "cylinder" : "sphere"));
  if (cylinder) put(geom, "size", {e.value, e.value});
  else put(geom, "size", e.value);
  put_pose(geom, attachments[size_t(f.joint)].X.inverse() * X);
  put(geom, "contype", 0), put(geom, "conaffinity", 0), put(geom, "mass", 0), put(geom, "group", group_of_wraps);
  losses.note("geoms were added for tendons to wrap around", name);
  return name;
}

void MjcfWriter::add_tendons() {
  for (Index k = 0; k < m.n.tendons; ++k) {
    const dynTendon& t = m.tendons()[k].spec;
    const bool fixed = t.type == DYN_TENDON_TYPE_FIXED;
    XmlElement& tendon = *section("tendon").InsertNewChildElement(fixed ? "fixed" : "spatial");
    put(tendon, "name", std::string(m.string(m.tendons()[k].name)));
    if (m.n.compliances > 0) {
      put_compliance(tendon, m.tendon_compliances()[k].law, "solreflimit", "solimplimit");
      put_compliance(tendon, m.tendon_friction_compliances()[k].law, "solreffriction", "solimpfriction");
    }
    if (t.range[0] < t.range[1]) put_range(tendon, "range", t.range);
    else losses.loss("ranges of a single point", m.string(m.tendons()[k].name));
    // two -1 would stand for the length that the file draws
    const double high = t.rest[0] == -1 && t.rest[1] == -1 ? std::nextafter(-1.0, 0.0) : t.rest[1];
    put(tendon, "springlength", {t.rest[0], high});
    for (const auto& [attribute, x] : {std::pair{"stiffness", t.stiffness}, {"damping", t.damping}, {"frictionloss", t.friction},
                                       {"armature", t.armature}})
      if (x != 0) put(tendon, attribute, x);
    if (const ForceLimitRecord* const limit = force_limit(-1, k)) put_range(tendon, "actuatorfrcrange", limit->range);
    const PathRecord& p = m.paths()[k];
    for (const PathElement *e = m.path_elements() + p.first, *end = e + p.elements; e != end; ++e) add_element(tendon, *e);
  }
  for (Index k = m.n.tendons; k < m.n.tendons + m.n.couplings; ++k) {
    const PathRecord& p = m.paths()[k];
    const auto name = [&](Index t) { return std::string(m.string(m.tendons()[t].name)); };
    XmlElement& e = *section("equality").InsertNewChildElement("tendon");
    put(e, "name", std::string(m.string(p.name))), put(e, "tendon1", name(p.first));
    if (p.elements >= 0) put(e, "tendon2", name(p.elements));
    put(e, "polycoef", std::span(p.polynomial));
    if (m.n.compliances > 0) put_compliance(e, m.coupling_compliances()[k - m.n.tendons].law, "solref", "solimp");
  }
}

void MjcfWriter::add_element(XmlElement& tendon, const PathElement& e) {
  const auto child = [&](const char* kind) -> XmlElement& { return *tendon.InsertNewChildElement(kind); };
  switch (e.type) {
    case DYN_TENDON_ELEMENT_TYPE_JOINT: {
      XmlElement& x = child("joint");
      put(x, "joint", piece(e.id, 0).simple.name), put(x, "coef", e.value);
      break;
    }
    case DYN_TENDON_ELEMENT_TYPE_SITE: put(child("site"), "site", site(e.id)); break;
    case DYN_TENDON_ELEMENT_TYPE_PULLEY: put(child("pulley"), "divisor", e.value); break;
    default: {
      XmlElement& x = child("geom");
      put(x, "geom", wrapped_geom(e));
      if (e.side_id >= 0) put(x, "sidesite", site(e.side_id));
    }
  }
}

}  // namespace dyn::load
