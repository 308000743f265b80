// What an MJCF file says once for all of it: <compiler>, <option>, <default>.
#pragma once

#include "spatial/se3.hpp"
#include "mjcf_source.hpp"

namespace dyn::load {

enum class FromGeoms { Never, Always, WhenMissing };

// What <compiler> says of masses, with MuJoCo's defaults.
struct MjcfMassRules {
  FromGeoms from_geoms = FromGeoms::WhenMissing;
  double groups[2] = {0, 5};  // of geoms that count
  double min_mass = 0, min_inertia = 0;
  bool balance = false;
};

// And of everything else.
struct MjcfCompiler {
  double angle = 0.017453292519943295;  // what one unit of the file is, rad
  std::string euler = "xyz";            // lower case: turned axes; upper case: fixed ones
  bool autolimits = true;
  MjcfMassRules masses;
  double total_mass = -1;
  bool discard_visual = false, align_free = false;
  std::string mesh_folder;
  bool strip_path = false;
};
void read_compiler(MjcfSource& source, Element& e, MjcfCompiler& compiler);

// Position and orientation of an element: pos, and one of quat, axisangle, euler, xyaxes, zaxis.
SE3<double> read_pose(const Reader& reader, const Element& e, const MjcfCompiler& compiler);
SE3<double> read_rotation(const Reader& reader, const Element& e, const MjcfCompiler& compiler);
bool has_rotation(const Element& e);
Mat3<double> from_euler(const std::array<double, 3>& angles, const MjcfCompiler& compiler);
Mat3<double> from_quaternion(double w, double x, double y, double z);  // any but zero
Mat3<double> turn_z_to(const Vec3<double>& axis);
inline constexpr std::initializer_list<const char*> rotation_attributes = {"quat", "axisangle", "euler", "xyaxes", "zaxis"};

// true, false, auto; what: the value without the attribute
std::optional<bool> read_switch(const Reader& reader, const Element& e, const char* attribute, std::optional<bool> missing);

// Attributes that nothing uses yet, one line of the report for each.
void count_unused(const Reader& reader, const Element& e, const char* kind, std::initializer_list<const char*> attributes);

// mjcf_law.cpp: actuators that are read; what a shortcut such as <position> stands for, written as attributes of <general>, once it has those of
// its class.
bool is_actuator(const Element& e);
void as_general(const Reader& reader, Element& e);

// Classes of defaults.
class MjcfDefaults {
 public:
  MjcfDefaults() : classes_{{"main", {}}} {}
  // a <default> of the root; several of them add up
  void read(MjcfSource& source, Element& e);
  // Writes into e what its class, or else the class around it, says and e does not. kind: the name under which defaults know e.
  void apply(const MjcfSource& source, Element& e, const std::string& kind, const std::string& around) const;
  // The class that an element with childclass makes for what it holds; throws when there is none of that name.
  std::string around(const MjcfSource& source, const Element& e, const std::string& outside) const;

 private:
  using Attributes = std::map<std::string, std::string>;
  struct Class {
    std::string name;
    std::map<std::string, Attributes> kinds;
  };
  void read(MjcfSource& source, Element& e, int at);
  static void write(const Attributes& known, Element& e);
  int find(const MjcfSource& source, const Element& e, const std::string& name) const;

  std::vector<Class> classes_;  // 0: main
};

}  // namespace dyn::load
