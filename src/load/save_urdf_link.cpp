// Model to URDF: links with their inertia and shapes.
#include <cstdio>

#include "save_urdf.hpp"

namespace dyn::load {

void put_origin(XmlElement& parent, const SE3<double>& X) {
  const auto rpy = roll_pitch_yaw(X.R);
  if (X.p[0] == 0 && X.p[1] == 0 && X.p[2] == 0 && rpy[0] == 0 && rpy[1] == 0 && rpy[2] == 0) return;
  XmlElement& origin = *parent.InsertNewChildElement("origin");
  put(origin, "xyz", {X.p[0], X.p[1], X.p[2]});
  if (rpy[0] != 0 || rpy[1] != 0 || rpy[2] != 0) put(origin, "rpy", rpy);
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
      put(I, "ixx", x[0]), put(I, "ixy", x[3]), put(I, "ixz", x[6]), put(I, "iyy", x[4]), put(I, "iyz", x[7]), put(I, "izz", x[8]);
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
  switch (s.type) {
    case DYN_SHAPE_TYPE_BOX: put(shape("box"), "size", std::span(s.size)); break;
    case DYN_SHAPE_TYPE_SPHERE: put(shape("sphere"), "radius", s.size[0]); break;
    case DYN_SHAPE_TYPE_CAPSULE: losses.note("shape 'capsule', which is not in the URDF standard", called); [[fallthrough]];
    case DYN_SHAPE_TYPE_CYLINDER: {
      XmlElement& e = shape(s.type == DYN_SHAPE_TYPE_CYLINDER ? "cylinder" : "capsule");
      put(e, "radius", s.size[0]), put(e, "length", s.size[1]);
      break;
    }
    case DYN_SHAPE_TYPE_MESH: case DYN_SHAPE_TYPE_CONVEX: case DYN_SHAPE_TYPE_TRIANGLES:
      if (!mesh.empty()) {
        XmlElement& e = shape("mesh");
        put(e, "filename", mesh);
        if (s.size[0] != 1 || s.size[1] != 1 || s.size[2] != 1) put(e, "scale", std::span(s.size));
        if (s.type != DYN_SHAPE_TYPE_MESH) losses.note("hulls and triangles of mesh files are saved by file name: load the file with the same option for meshes", called);
        break;
      }
      [[fallthrough]];
    default: losses.loss("shapes that are no box, sphere, cylinder, capsule or mesh file are left out", called); return doc.DeleteNode(geometry);
  }
  const dynMaterial& material = m.materials()[s.material];
  if (s.role == DYN_SHAPE_ROLE_COLLISION && !is_default(material, true)) losses.loss("materials of shapes (friction, restitution, ...)", called);
  if (s.role == DYN_SHAPE_ROLE_COLLISION && (s.contype != 1 || s.conaffinity != 1)) losses.loss("collision masks of shapes", called);
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
