// Model to URDF: links with their inertia and shapes.
#include <cstdio>

#include "save_urdf.hpp"
#include "shape_form.hpp"
#include "spatial/rpy.hpp"

namespace dyn::load {

void put_origin(XmlElement& parent, const SE3<double>& X) {
  const Vec3<double> rpy = roll_pitch_yaw(X.R);
  if (X.p[0] == 0 && X.p[1] == 0 && X.p[2] == 0 && rpy[0] == 0 && rpy[1] == 0 && rpy[2] == 0) return;
  XmlElement& origin = *parent.InsertNewChildElement("origin");
  put(origin, "xyz", {X.p[0], X.p[1], X.p[2]});
  if (rpy[0] != 0 || rpy[1] != 0 || rpy[2] != 0) put(origin, "rpy", {rpy[0], rpy[1], rpy[2]});
}

XmlElement& UrdfWriter::add_link(const std::string& name, Index frame) {
  XmlElement& link = *robot->InsertNewChildElement("link");
  put(link, "name", name);
  if (frame < 0) return link;
  if (m.frames()[frame].link >= 0) {
    const LinkRecord& l = m.links()[m.frames()[frame].link];
    if (m.compensation(m.frames()[frame].link) != 0) losses.loss("gravity compensation of links", name);
    if (l.mass != 0 || std::any_of(l.inertia, l.inertia + 9, [](double x) { return x != 0; })) {
      XmlElement& inertial = *link.InsertNewChildElement("inertial");
      put_origin(inertial, {Mat3<double>::identity(), load3(l.com)});
      put(*inertial.InsertNewChildElement("mass"), "value", l.mass);
      XmlElement& I = *inertial.InsertNewChildElement("inertia");
      const double* x = l.inertia;
      put(I, "ixx", x[0]), put(I, "ixy", x[3]), put(I, "ixz", x[6]), put(I, "iyy", x[4]), put(I, "iyz", x[7]),
          put(I, "izz", x[8]);
    }
  }
  for (Index k = 0; k < m.n.shapes; ++k)
    if (m.shapes()[k].frame == frame) add_shape(link, m.shapes()[k]);
  return link;
}

void UrdfWriter::add_shape(XmlElement& link, const ShapeRecord& s) {
  const std::string name = m.string(s.name), mesh = m.string(s.mesh), called = name.empty() ? link.Attribute("name") : name;
  XmlElement* geometry = doc.NewElement("geometry");
  const auto shape = [&](const char* kind) -> XmlElement& { return *geometry->InsertNewChildElement(kind); };
  const bool meshed = s.type == DYN_SHAPE_TYPE_MESH || s.type == DYN_SHAPE_TYPE_CONVEX || s.type == DYN_SHAPE_TYPE_TRIANGLES;
  if (const auto form = shape_form(RobotFormat::Urdf, s.type)) {
    if (!form->standard) losses.note(std::string("shape '") + form->name + "', which is not in the URDF standard", called);
    XmlElement& e = shape(form->name);
    if (!form->attribute[1]) put(e, form->attribute[0], std::span(s.size, form->sizes));
    else
      for (size_t i = 0; i < form->sizes; ++i) put(e, form->attribute[i], s.size[i]);
  } else if (meshed && !mesh.empty()) {
    XmlElement& e = shape("mesh");
    put(e, "filename", mesh);
    if (s.size[0] != 1 || s.size[1] != 1 || s.size[2] != 1) put(e, "scale", std::span(s.size));
    if (s.type != DYN_SHAPE_TYPE_MESH)
      losses.note("hulls and triangles of mesh files are saved by file name: load the file with the same option for meshes",
                  called);
  } else {
    losses.loss("shapes that are no mesh file and none of " + shape_names(RobotFormat::Urdf) + " are left out", called);
    return doc.DeleteNode(geometry);
  }
  const dynMaterial material = shape::acting(m.materials()[s.material], s.latent);
  if (s.role == DYN_SHAPE_ROLE_COLLISION && !is_default(material, true))
    losses.loss("materials of shapes (friction, restitution, ...)", called);
  if (s.role == DYN_SHAPE_ROLE_COLLISION && (s.contype != 1 || s.conaffinity != 1))
    losses.loss("collision masks of shapes", called);
  if (s.radius > 0) losses.loss("rounding of shapes", called);
  XmlElement& e = *link.InsertNewChildElement(s.role == DYN_SHAPE_ROLE_COLLISION ? "collision" : "visual");
  if (!name.empty()) put(e, "name", name);
  put_origin(e, load_se3(s.placement));
  e.InsertEndChild(geometry);
  if (s.colour) {
    XmlElement& material = *e.InsertNewChildElement("material");
    char unique[16];
    std::snprintf(unique, sizeof unique, "rgba_%08x", unsigned(s.colour));
    put(material, "name", std::string(unique));
    put_rgba(*material.InsertNewChildElement("color"), s.colour);
  }
}

}  // namespace dyn::load
