// A URDF file as values, and the steps between file and builder. Each step fails through the report.
#pragma once

#include "colour.hpp"
#include "mesh_path.hpp"
#include "xml.hpp"

namespace dyn::load {

struct UrdfShape {
  Shape shape;
  int line = 0;
};

struct UrdfLink {
  std::string name;
  int line = 0;
  int inertial_line = 0;  // 0: no <inertial>
  double mass = 0;
  std::array<double, 3> com = {0, 0, 0};
  std::array<double, 9> inertia = {};  // about the centre of mass, link axes
  std::array<double, 3> moments = {};  // principal, ascending
  std::vector<UrdfShape> shapes;
};

struct UrdfJoint {
  JointSpec spec;  // parent is set when the tree is known
  std::string type;
  std::string parent, child;  // links
  int line = 0, parent_line = 0, child_line = 0, mimic_line = 0;
};

struct UrdfConstraint {
  std::string name, first, second;  // second: "": the world
  dynConstraint spec;
  int line = 0;
};

struct UrdfRobot {
  std::string name;
  std::vector<UrdfLink> links;    // in the file's order
  std::vector<UrdfJoint> joints;  // in the file's order
  std::vector<UrdfConstraint> constraints;
};

struct UrdfTree {
  int root = 0;                    // link
  std::vector<int> order;          // joints, depth first; children in the file's order
  std::vector<int> parent, child;  // of each joint: links
};

// urdf_read.cpp, urdf_link.cpp, urdf_joint.cpp: the walk over the XML.
UrdfRobot read_urdf(const Element& root, Report& report, const LoadOptions& options);
// Replaces collision meshes by shapes.
void read_collision_meshes(UrdfRobot& robot, Report& report, const LoadOptions& options);
UrdfLink read_link(const Element& e, Report& report, MeshPaths& meshes, const Colours& colours);
// urdf_constraint.cpp: the content of a <libdyn> block, and names of constraint types. A loop has the name of its joint's type.
const char* constraint_type_name(const dynConstraint& c);
void read_constraints(const Element& block, Report& report, std::vector<UrdfConstraint>& out, Budget* budget);
UrdfJoint read_joint(const Element& e, Report& report, const LoadOptions& options);

// urdf_tree.cpp: one root, no cycle, every link known and with one parent. Mimic leaders exist and move.
UrdfTree check_tree(const UrdfRobot& robot, Report& report);
void check_mimic(UrdfRobot& robot, Report& report);

// urdf_inertia.cpp. check_inertia throws for impossible inertias and sets the principal moments. A negative moment is allowed if
// links welded to the body compensate it, which check_welded_inertia decides.
void check_inertia(UrdfLink& link, Report& report);
void check_welded_inertia(const UrdfRobot& robot, const UrdfTree& tree, bool fixed_base, Report& report);

// urdf_mass.cpp: every joint moves mass.
void check_moving_mass(const UrdfRobot& robot, const UrdfTree& tree, Report& report);

// urdf_unused.cpp: reports damping, dry friction and limits, which the algorithms do not apply by themselves.
void report_unused_data(const UrdfRobot& robot, Report& report);

// urdf_base.cpp: fixed or floating, or DYN_ERROR_BASE.
bool floating_base(const UrdfRobot& robot, const UrdfTree& tree, dynBase base, Report& report);

// urdf_urdfdom.cpp: reads the text again with urdfdom and reports differences.
void compare_with_urdfdom(const std::string& text, const UrdfRobot& robot, const UrdfTree& tree, Report& report);

}  // namespace dyn::load
