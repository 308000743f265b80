#include "save_xml.hpp"

#include <cmath>
#include <cstring>

#include "shape/material.hpp"

namespace dyn::load {

std::string number_list(std::span<const double> x) {
  std::string out;
  for (const double e : x) out += (out.empty() ? "" : " ") + text(e == 0 ? 0.0 : e);
  return out;
}

std::string printed(const tinyxml2::XMLDocument& doc) {
  tinyxml2::XMLPrinter printer;
  doc.Print(&printer);
  return {printer.CStr(), size_t(printer.CStrSize() - 1)};
}

void Losses::add(dynReportLevel level, const std::string& what, const std::string& name) {
  for (Line& l : lines_)
    if (l.what == what && l.level == level) {
      if (!name.empty()) l.names.push_back(name);
      return;
    }
  lines_.push_back({level, what, {}});
  if (!name.empty()) lines_.back().names.push_back(name);
}

void Losses::write_report() const {
  for (const Line& l : lines_) {
    std::string out = l.what;
    const size_t shown = std::min<size_t>(l.names.size(), 5);
    for (size_t k = 0; k < shown; ++k) out += (k ? ", " : ": ") + in_quotes(l.names[k]);
    if (l.names.size() > shown) out += " and " + std::to_string(l.names.size() - shown) + " more";
    report_.push_back({l.level, out});
  }
}

std::string Names::claim(const std::string& wanted) {
  std::string name = wanted;
  for (int k = 2; !taken_.insert(name).second; ++k) name = wanted + "_" + std::to_string(k);
  return name;
}

std::vector<SimpleJoint> chain_of(const Model& m, Index joint, Names& names) {
  const JointRecord& r = m.joints()[joint];
  const std::string name = m.string(r.name), leader = r.leader >= 0 ? m.string(m.joints()[r.leader].name) : "";
  const JointSpec spec = spec_of(m, r);
  const std::vector<PlacedElement> elements = elements_of(spec, parts_of(spec));
  std::vector<SimpleJoint> out;
  int q = 0, v = 0;
  for (const PlacedElement& p : elements) {
    const dyn::Element& e = p.element;
    const bool last = &p == &elements.back();
    SimpleJoint s{DYN_JOINT_TYPE_REVOLUTE,
                  e.axis,
                  p.before,
                  last ? name : names.claim(name + "_" + std::to_string(out.size() + 1)),
                  q,
                  v,
                  leader,
                  r.ratio,
                  r.offset};
    q += primitive_nq(e.type), v += primitive_nv(e.type);
    switch (e.type) {
      case BodyType::Revolute: s.type = e.wraps ? DYN_JOINT_TYPE_CONTINUOUS : DYN_JOINT_TYPE_REVOLUTE; break;
      case BodyType::Prismatic: s.type = DYN_JOINT_TYPE_PRISMATIC; break;
      case BodyType::RevoluteUnbounded: s.type = DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED; break;
      case BodyType::Spherical: s.type = DYN_JOINT_TYPE_SPHERICAL; break;
      case BodyType::FreeFlyer: s.type = DYN_JOINT_TYPE_FREE_FLYER; break;
      case BodyType::Helical:
        out.push_back({DYN_JOINT_TYPE_PRISMATIC, e.axis, p.before, names.claim(name + "_advance"), s.q, s.v, s.name, e.pitch, 0});
        s.before = SE3<double>::identity();
    }
    out.push_back(s);
  }
  return out;
}

ScalarNumbers numbers_of(const JointSpec& spec, const SimpleJoint& s) {
  const auto at = [](const std::vector<double>& x, int k, double missing) {
    return size_t(k) < x.size() ? x[size_t(k)] : missing;
  };
  constexpr double inf = std::numeric_limits<double>::infinity();
  if (!s.leader.empty() && s.leader != spec.mimic) return {-inf, inf, inf, inf, 0};  // the slide of a helical joint
  return {
      at(spec.lower, s.q, -inf), at(spec.upper, s.q, inf),          at(spec.velocity, s.v, inf),
      at(spec.effort, s.v, inf), at(spec.spring_reference, s.q, 0),
#define COEFFICIENT(name, has, sentence) at(spec.name, s.v, 0),
#include "effect/coefficients.def"
  };
}

bool is_default(const dynMaterial& material, bool with_friction) {
  dynMaterial x = material, standard = shape::default_material();
  if (!with_friction) x.friction = standard.friction, x.torsion = standard.torsion, x.rolling = standard.rolling;
  return std::memcmp(&x, &standard, sizeof x) == 0;
}

std::vector<std::vector<Index>> frames_by_joint(const Model& m) {
  std::vector<std::vector<Index>> out(size_t(m.n.joints));
  for (Index f = 1; f < m.n.frames; ++f) out[size_t(m.frames()[f].joint)].push_back(f);
  return out;
}

double mass_of(const Model& m, const std::vector<Index>& frames) {
  double sum = 0;
  for (const Index f : frames)
    if (const Index link = m.frames()[f].link; link >= 0) sum += m.links()[link].mass;
  return sum;
}

}  // namespace dyn::load
