// Writer of URDF.
#pragma once

#include "save_xml.hpp"

namespace dyn::load {

class UrdfWriter {
 public:
  UrdfWriter(const Model& m, SaveReport& report);
  std::string write();

 private:
  std::string frame_name(Index f) const { return m.string(m.frames()[f].name); }
  XmlElement& add_link(const std::string& name, Index frame);  // frame: BODY, 0: the world, -1: none
  void add_shape(XmlElement& link, const ShapeRecord& s);
  XmlElement& add_joint(const std::string& name, const char* type, const std::string& parent, const std::string& child,
                        const SE3<double>& X);
  void add_numbers(XmlElement& e, const JointSpec& spec, const SimpleJoint& s);
  std::string bare_world();
  void add_moving(Index j);
  void add_fixed(Index f, std::set<Index>& done);
  void add_constraints();
  void report_losses();

  const Model& m;
  Losses losses;
  tinyxml2::XMLDocument doc;
  XmlElement* robot;
  std::vector<std::vector<Index>> on;  // frames of each joint
  std::vector<Index> main;             // BODY frame in each joint's own frame, or -1
  std::vector<std::string> main_name;
  std::string bare;  // see bare_world
  Names links, joints;
  bool floating;  // the root link is free, which is an option of the loader
};

void put_origin(XmlElement& parent, const SE3<double>& X);

}  // namespace dyn::load
