// Writer of MJCF.
#pragma once

#include <tuple>

#include "mjcf_wrap.hpp"
#include "save_xml.hpp"

namespace dyn::load {

class MjcfWriter {
 public:
  MjcfWriter(const Model& m, SaveReport& report);
  std::string write();

 private:
  // Named configurations with what they state of velocities, controls, activations and time.
  std::vector<double> qpos_of(Index configuration) const;
  std::vector<double> qvel_of(Index configuration) const;
  void put_state(XmlElement& key, Index configuration);
  bool given_by_poses() const;
  // A simple joint, and the pose of the body's frame in its own at q = 0.
  struct Piece {
    Index joint;
    SimpleJoint simple;
    SE3<double> before;
  };
  // The element that holds a joint's frames, shapes and children, and its pose in the joint's frame.
  struct Attachment {
    XmlElement* element = nullptr;
    SE3<double> X = SE3<double>::identity();
  };

  std::string frame_name(Index f) const { return m.string(m.frames()[f].name); }
  std::string body_name(Index f) const { return f == 0 ? "world" : body_names.at(f); }
  XmlElement& section(const char* name);

  // save_mjcf.cpp
  void add_option();
  void add_flags(XmlElement& option);
  double reference(Index joint, const SimpleJoint& s) const;
  SE3<double> drawn_motion(Index joint, const SimpleJoint& s) const;
  bool aligned_when_drawn(Index joint) const;
  std::vector<Index> joints_of_one_body(Index first) const;
  std::vector<Piece> pieces_of(const std::vector<Index>& group);
  void add_moving(Index first);
  void add_content(Index joint, Index main);
  void add_link(XmlElement& body, Index frame, double least_mass = 0, double least_moment = 0);
  // save_mjcf_joint.cpp
  void add_joint(XmlElement& body, const Piece& p, const SE3<double>& end);
  void add_numbers(XmlElement& e, const Piece& p);
  template <class E>
  void put_coefficient(XmlElement& e, double c, const std::string& joint);
  void add_keys();
  // save_mjcf_geom.cpp
  void add_geom(XmlElement& body, const ShapeRecord& s, Index k);
  void put_fluid(XmlElement& e, Index shape);  // of the geom of a shape
  double height_asset(const ShapeRecord& s, std::string& name);  // height of its lowest point over its origin
  std::set<std::pair<Index, Index>> untested_links();
  void add_contacts();
  // What differs from MuJoCo's defaults. reference, impedance: the attributes' names. (save_mjcf_laws.cpp)
  static void put_compliance(XmlElement& e, const Compliance& law, const char* reference, const char* impedance);
  // save_mjcf_mesh.cpp
  std::string mesh_asset(const ShapeRecord& s);  // empty: it cannot be read
  std::string mesh_file(const ShapeRecord& s);
  XmlElement& new_mesh(const std::string& wish, std::string& name);
  static void put_mesh(XmlElement& mesh, std::span<const double> vertices, const Index* corners, size_t triangles);
  // save_mjcf_laws.cpp
  void add_actuators();
  void add_constraints();
  bool pushes_free_joint(const dynActuator& a) const;
  void put_transmission(XmlElement& e, const dynActuator& a);
  void put_muscle(XmlElement& e, const dynActuator& a);
  void put_driver(XmlElement& e, const dynActuator& a);
  const ForceLimitRecord* force_limit(Index joint, Index tendon) const;  // or nullptr
  std::string site(Index frame, const double (&placement)[12], const std::string& name);
  const Piece& piece(Index joint, int dof) const;
  void add_sensors();  // save_mjcf_sensor.cpp
  void put_sides(XmlElement& e, const dynSensor& s);
  // save_mjcf_tendon.cpp
  void add_tendons();
  void add_element(XmlElement& tendon, const PathElement& e);
  std::string site(Index frame);
  std::string wrapped_geom(const PathElement& e);

  const Model& m;
  Losses losses;
  tinyxml2::XMLDocument doc;
  XmlElement* root;
  std::vector<std::vector<Index>> on, children;  // frames and joints of each joint
  std::vector<Attachment> attachments;                 // by joint
  std::vector<XmlElement*> mocap_elements = std::vector<XmlElement*>(size_t(m.n.frames));  // by frame
  std::vector<Piece> pieces;                     // in the file's order
  std::vector<Index> written_actuators;
  std::map<Index, std::string> body_names;       // of BODY frames
  std::map<Index, std::string> geom_names;       // of shapes
  std::map<Index, std::string> frame_sites;      // of frames that tendons and actuators name
  std::map<std::tuple<Index, double, bool>, std::string> wraps;  // added geoms, by frame, radius, and whether cylinders
  std::map<std::pair<int, Index>, std::string> surface_assets;
  std::map<std::string, std::string> file_assets;
  Names bodies, joints, geoms, assets;
  int depth = 0;                                 // of open elements
  Index drawn = -1;                              // the configuration that gives the poses of the file
};

void put_range(XmlElement& e, const char* attribute, const double (&range)[2]);
void put_pose(XmlElement& e, const SE3<double>& X);
bool is_identity_rotation(const Mat3<double>& R);  // within rounding

}  // namespace dyn::load
