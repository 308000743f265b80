// Model to MJCF: shapes, their meshes and height fields, and which pairs are tested.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "collision/pair_search.hpp"
#include "model/builder_surface.hpp"
#include "save_mjcf.hpp"
#include "shape_form.hpp"
#include "table/names.hpp"

namespace dyn::load {

namespace {

// Writes friction unless it is MuJoCo's default. condim selects the kinds of friction.
int condim(const dynMaterial& acting) { return acting.rolling != 0 ? 6 : acting.torsion != 0 ? 4 : acting.friction != 0 ? 3 : 1; }

void put_friction(XmlElement& e, const shape::ShapeMaterial& x) {
  const int dim = x.latent == 0 ? condim(x) : x.latent == 1 ? 4 : x.latent == 2 ? 3 : 1;
  if (dim != 3) put(e, "condim", dim);
  if (x.friction != 1 || x.torsion != 0.005 || x.rolling != 0.0001) put(e, "friction", {x.friction, x.torsion, x.rolling});
  if (x.priority != 0) put(e, "priority", x.priority);
}

// A contact spring of little damping, from which mjcf_rebound() gives the restitution.
void put_restitution(XmlElement& e, double restitution) {
  if (restitution == 0) return;
  const double stiffness = 1e4, decay = -std::log(restitution), pi = 3.14159265358979324;
  put(e, "solref", {-stiffness, -2 * std::sqrt(stiffness) * decay / std::sqrt(pi * pi + decay * decay)});
}

Compliance compliance_of_shape(const Model& m, Index shape) {
  for (Index g = 0; m.n.compliances > 0 && g < m.n.geoms; ++g)
    if (m.geoms()[g].shape == shape) return m.geom_compliances()[g].law;
  return {};
}

bool is_usual_reference(const Compliance& x) {
  const Compliance usual;
  return std::equal(x.reference, x.reference + 2, usual.reference);
}

}  // namespace

void MjcfWriter::add_geom(XmlElement& body, const ShapeRecord& s, Index k) {
  const std::string name = m.string(s.name),
                    called = name.empty() ? (body.Attribute("name") ? body.Attribute("name") : "world") : name;
  const bool visual = s.role == DYN_SHAPE_ROLE_VISUAL;
  const std::optional<ShapeForm> form = shape_form(RobotFormat::Mjcf, s.type);
  if (!form && shape::size_count(s.type) > 0)
    return losses.loss(std::string("shapes of type ") + name_of(s.type) + " are left out", called);
  const bool meshed = s.type == DYN_SHAPE_TYPE_MESH || s.type == DYN_SHAPE_TYPE_CONVEX || s.type == DYN_SHAPE_TYPE_TRIANGLES;
  const std::string mesh = meshed ? mesh_asset(s) : "";
  if (meshed && mesh.empty()) return;
  XmlElement& e = *body.InsertNewChildElement("geom");
  if (!name.empty()) {
    geom_names[k] = geoms.claim(name);
    put(e, "name", geom_names[k]);
    if (geom_names[k] != name) losses.note("geoms were renamed, because their name is taken", name);
  }
  SE3<double> X = load_se3(s.placement);
  const auto type = [&](const char* kind) { put(e, "type", std::string(kind)); };
  switch (s.type) {
    case DYN_SHAPE_TYPE_HALF_SPACE:
      type("plane"), put(e, "size", {0, 0, 1});
      if (visual) losses.note("visual half-spaces, which loading leaves out", called);
      break;
    case DYN_SHAPE_TYPE_HEIGHT_FIELD: {
      std::string asset;
      const double up = height_asset(s, asset);
      if (up != 0) X.p += X.R * Vec3<double>::make(0, 0, up);
      type("hfield"), put(e, "hfield", asset);
      break;
    }
    case DYN_SHAPE_TYPE_MESH:
    case DYN_SHAPE_TYPE_CONVEX:
    case DYN_SHAPE_TYPE_TRIANGLES:
      type("mesh"), put(e, "mesh", mesh);
      if (s.type != DYN_SHAPE_TYPE_MESH)
        losses.note("hulls and triangles become meshes: load the file with meshes as hulls or triangles", called);
      break;
    default: {  // a primitive
      std::vector<double> size(form->sizes);
      for (size_t i = 0; i < size.size(); ++i) size[i] = s.size[i] * form->factor[i];
      type(form->name), put(e, form->attribute[0], size);
    }
  }
  put_pose(e, X);
  put_fluid(e, k);
  if (s.colour) put_rgba(e, s.colour);
  if (visual) {
    if (s.radius > 0) losses.loss("rounding of visual shapes", called);
    return put(e, "contype", 0), put(e, "conaffinity", 0);
  }
  if (s.contype != 1) put(e, "contype", s.contype);
  if (s.conaffinity != 1) put(e, "conaffinity", s.conaffinity);
  const shape::ShapeMaterial material = material_of(m, s);
  put_friction(e, material);
  if (s.radius > 0) put(e, "margin", s.radius);
  const Compliance law = compliance_of_shape(m, k);
  if (is_usual_reference(law)) put_restitution(e, material.restitution);
  put_compliance(e, law, "solref", "solimp");
  if (law.mix != 1) put(e, "solmix", law.mix);
  dynMaterial rest = material;
  std::fill_n(rest.surface_velocity, 3, 0.0), rest.restitution = 0;
  if (std::any_of(material.surface_velocity, material.surface_velocity + 3, [](double v) { return v != 0; }))
    put(e, "surfacevel", std::span(material.surface_velocity));
  if (!is_default(rest, false)) losses.loss("stiffness and damping of materials", called);
  bool wanted = false;
  for (const PairRecord *p = m.pairs(), *end = p + m.n.pairs; p != end; ++p)
    wanted |= p->wanted() && (m.geoms()[p->a].shape == k || m.geoms()[p->b].shape == k);
  if (s.contype == 0 && s.conaffinity == 0 && !wanted) losses.loss("collision shapes with empty masks become visual", called);
}

void MjcfWriter::put_fluid(XmlElement& e, Index shape) {
  const FluidEllipsoid *x = m.fluid_ellipsoids(), *const end = x + m.n.fluid_shapes;
  while (x != end && x->shape != shape) ++x;
  if (x == end) return;
  put(e, "fluidshape", std::string("ellipsoid")), put(e, "fluidcoef", std::span(x->coefficients));
  const ShapeRecord& s = m.shapes()[shape];
  const bool own = !std::equal(x->placement, x->placement + 12, s.placement);
  const auto semiaxes = fluid_semiaxes(s.type, s.size);
  if (s.type == DYN_SHAPE_TYPE_MESH || s.type == DYN_SHAPE_TYPE_CONVEX || s.type == DYN_SHAPE_TYPE_TRIANGLES)
    losses.note("ellipsoids of meshes in a medium become those that MuJoCo fits to the mesh", m.string(s.name));
  else if (own || !std::equal(x->half, x->half + 3, semiaxes.begin()))
    losses.loss("ellipsoids in a medium that are not of their shape's size and place", m.string(s.name));
}

double MjcfWriter::height_asset(const ShapeRecord& s, std::string& asset) {
  const Stored<shape::Grid>& at = m.grids()[s.surface];
  const shape::Grid g = view(at.header, m.surface_numbers() + at.numbers, m.surface_indices() + at.indices);
  const auto [low, high] = std::minmax_element(g.height, g.height + std::ptrdiff_t(g.columns) * g.rows);
  const double least = *low, range = *high - *low;
  std::string& name = surface_assets[{int(s.type), s.surface}];
  if (name.empty()) {
    name = assets.claim("height_field");
    XmlElement& field = *section("asset").InsertNewChildElement("hfield");
    put(field, "name", name), put(field, "nrow", g.rows), put(field, "ncol", g.columns);
    put(field, "size", {(g.columns - 1) * g.step_x / 2, (g.rows - 1) * g.step_y / 2, range > 0 ? range : 1, least - g.bottom});
    std::vector<double> heights;  // the text begins with the farthest row
    for (Index j = g.rows; j-- > 0;)
      for (Index i = 0; i < g.columns; ++i) heights.push_back(g.at(i, j)[2] - least);
    put(field, "elevation", heights);
  }
  asset = name;
  return least;
}

// Pairs of links that MuJoCo would test and the model does not: a link of the world with one on its joints, and those that
// overlap.
std::set<std::pair<Index, Index>> MjcfWriter::untested_links() {
  const auto is_geom = [&](const ShapeRecord& s) {
    return s.role == DYN_SHAPE_ROLE_COLLISION && s.frame != 0 && s.filter < std::uint32_t(PairFilter::Mujoco);
  };
  std::set<Index> fixed, moving;
  for (Index k = 0; k < m.n.shapes; ++k)
    if (const ShapeRecord& s = m.shapes()[k]; is_geom(s)) (m.frames()[s.frame].joint == 0 ? fixed : moving).insert(s.frame);
  std::set<std::pair<Index, Index>> out, tested;
  for (const Index a : fixed)
    for (const Index b : moving)
      if (collision::parent_and_child(m.joints(), m.bodies(), m.frames(), a, b, true)) out.emplace(a, b);
  for (const bool overlap : {false, true})
    for (Index k = 0; k < m.n.pairs; ++k) {
      const PairRecord& p = m.pairs()[k];
      const auto frame = [&](Index geom) { return m.shapes()[m.geoms()[geom].shape].frame; };
      const auto links = std::minmax({frame(p.a), frame(p.b)});
      if (!overlap && p.reason == DYN_PAIR_REASON_TESTED) tested.insert(links);
      if (!overlap || p.reason != DYN_PAIR_REASON_OVERLAPS) continue;
      if (tested.count(links))
        losses.loss("pairs of shapes that overlap, of links of which others are tested", frame_name(links.first));
      else
        out.insert(links);
    }
  return out;
}

void MjcfWriter::add_contacts() {
  const auto exclude = [&](Index a, Index b) {
    XmlElement& e = *section("contact").InsertNewChildElement("exclude");
    put(e, "body1", body_name(a)), put(e, "body2", body_name(b));
  };
  std::set<std::pair<Index, Index>> more = untested_links();
  for (Index k = 0; k < m.n.disabled; ++k) {
    const DisabledRecord& d = m.disabled_pairs()[k];
    exclude(d.frame1, d.frame2), more.erase({d.frame1, d.frame2}), more.erase({d.frame2, d.frame1});
  }
  for (const auto& [a, b] : more) exclude(a, b);
  for (Index k = 0; k < m.n.pairs; ++k) {
    const PairRecord& p = m.pairs()[k];
    if (!p.wanted()) continue;
    const Index a = m.geoms()[p.a].shape, b = m.geoms()[p.b].shape;
    if (!geom_names.count(a) || !geom_names.count(b)) {
      losses.loss("pairs with shapes that are left out", m.string(m.shapes()[a].name));
      continue;
    }
    XmlElement& e = *section("contact").InsertNewChildElement("pair");
    put(e, "geom1", geom_names[a]), put(e, "geom2", geom_names[b]);
    const dynMaterial x = p.material() ? m.materials()[p.material() - 1]
                                       : shape::combined(material_of(m, m.shapes()[a]), material_of(m, m.shapes()[b]));
    put(e, "condim", condim(x)), put(e, "friction", {x.friction, x.friction, x.torsion, x.rolling, x.rolling});
    const Compliance law =
        m.n.compliances > 0 && p.material() ? m.material_compliances()[p.material() - 1].law : Compliance();
    if (is_usual_reference(law)) put_restitution(e, x.restitution);
    put_compliance(e, law, "solref", "solimp");
    if (law.across[0] != 0 || law.across[1] != 0) put(e, "solreffriction", std::span(law.across));
    if (law.margin != 0) put(e, "margin", law.margin);
    dynMaterial rest = x;
    rest.restitution = 0;
    if (!is_default(rest, false)) losses.loss("stiffness, damping and surface velocity of materials", geom_names[a]);
  }
}

}  // namespace dyn::load
