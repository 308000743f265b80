// Model to URDF: constraints, and the report of what the format cannot hold.
#include "model/constraints.hpp"
#include "save_urdf.hpp"
#include "urdf_robot.hpp"

namespace dyn::load {

// Written as urdf_constraint.cpp reads them.
void UrdfWriter::add_constraints() {
  if (m.n.constraints == 0) return;
  XmlElement& block = *robot->InsertNewChildElement("libdyn");
  for (Index k = 0; k < m.n.constraints; ++k) {
    const dynConstraint& c = m.constraints()[k].spec;
    const std::string name = m.string(m.constraints()[k].name);
    if (c.first == 0 && floating) {
      losses.loss("constraints whose first end is the world, which has no link, are left out", name);
      continue;
    }
    XmlElement& e = *block.InsertNewChildElement("constraint");
    put(e, "name", name);
    put(e, "type", std::string(constraint_type_name(c)));
    const dynConstraint standard = default_constraint(c.type);
    const auto number = [&](const char* attribute, double x, double missing) {
      if (x != missing) put(e, attribute, x);
    };
    number("stiffness", c.stiffness, standard.stiffness), number("damping", c.damping, standard.damping),
        number("restitution", c.restitution, standard.restitution);
    number("length", c.length, standard.length), number("pitch", c.pitch, standard.pitch),
        number("force", c.force, standard.force);
    if (c.type == DYN_CONSTRAINT_TYPE_COUPLING) put(e, "coefficients", std::span(c.coefficients));
    const bool of_joints = between_joints(c.type);
    const auto end = [&](const char* which, int at, const double* placement, bool needed) {
      if (at == 0 && !needed) return;
      XmlElement& x = *e.InsertNewChildElement(which);
      put(x, of_joints ? "joint" : "link",
          of_joints ? std::string(m.string(m.joints()[at].name))
          : at == 0 ? main_name[0]
                    : frame_name(at));
      put_origin(x, load_se3(placement));
    };
    const bool coupled = c.type == DYN_CONSTRAINT_TYPE_COUPLING;
    end("first", c.first, c.placement1, true),
        end("second", c.second, c.placement2,
            coupled || (c.second == 0 && !of_joints && !floating && !is_identity(c.placement2)));
    if (c.type == DYN_CONSTRAINT_TYPE_LOOP)
      put(*e.InsertNewChildElement("axis"), "xyz", std::span(c.axis)),
          put(*e.InsertNewChildElement("axis2"), "xyz", std::span(c.axis2));
    if (!c.enabled) losses.loss("the disabled state of constraints", name);
    losses.note("constraints are in a <libdyn> block, which other readers skip", name);
  }
}

void UrdfWriter::report_losses() {
  for (Index k = 0; k < m.n.tendons; ++k) losses.loss("tendons", m.string(m.tendons()[k].name));
  for (Index k = 0; k < m.n.sensors; ++k) losses.loss("sensors", m.string(m.sensors()[k].name));
  for (Index k = 0; k < m.n.couplings; ++k) losses.loss("couplings of tendons", m.string(m.paths()[m.n.tendons + k].name));
  for (Index k = 0; k < m.n.actuators; ++k) losses.loss("actuators", m.string(m.actuators()[k].name));
  for (Index k = 1; k < m.n.configurations; ++k)
    losses.loss("named configurations (an SRDF has them)", m.string(m.configuration_names()[k]));
  for (Index k = 0; k < m.n.disabled; ++k)
    losses.loss("disabled pairs (an SRDF has them)", frame_name(m.disabled_pairs()[k].frame1));
  for (Index k = 0; k < m.n.pairs; ++k)
    if (m.pairs()[k].wanted())
      losses.loss("explicitly requested collision pairs", m.string(m.shapes()[m.geoms()[m.pairs()[k].a].shape].name));
  if (m.gravity[0] != 0 || m.gravity[1] != 0 || m.gravity[2] != -9.81)
    losses.loss("gravity (an option of loading): it is " + number_list(m.gravity) + " m/s^2");
  if (m.density != 0 || m.viscosity != 0) losses.loss("the medium: its density, viscosity and wind");
  if (m.n.fluid_shapes > 0) losses.loss("fluid forces on ellipsoids of shapes");
  if (floating) losses.note("the base is an option of loading: load the file with a floating base");
  else if (main[0] >= 0) losses.note("the base is an option of loading: load the file with a fixed base");
  for (Index k = 0; floating && k < 6; ++k)
    if (m.armature()[k] != 0 || m.damping()[k] != 0 || m.friction()[k] != 0)
      return losses.loss("armature, damping and dry friction of the floating base");
}

}  // namespace dyn::load
