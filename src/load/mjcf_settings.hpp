// Settings of a whole MJCF file: <compiler>, <option>, <default>.
#pragma once

#include "spatial/se3.hpp"
#include "mjcf_source.hpp"

namespace dyn::load {

enum class FromGeoms { Never, Always, WhenMissing };

// Rules of <compiler> for masses, with MuJoCo's defaults.
struct MjcfMassRules {
  FromGeoms from_geoms = FromGeoms::WhenMissing;
  double groups[2] = {0, 5};  // of geoms that count
  double min_mass = 0, min_inertia = 0;
  bool balance = false;
};

// Other attributes of <compiler>.
struct MjcfCompiler {
  double angle = 0.017453292519943295;  // rad per unit of the file
  std::string euler = "xyz";            // lower case: rotating axes; upper case: fixed axes
  bool autolimits = true;
  MjcfMassRules masses;
  double total_mass = -1;
  bool discard_visual = false, align_free = false, fit_bounds = false;
  // <lengthrange>: whether the ranges of lengths that a file gives are used, whether others follow from the limits of what an
  // actuator acts through, and whether they are computed at all.
  bool length_given = true, length_of_limits = false, length_computed = true;
  std::string mesh_folder;
  bool strip_path = false;
};
void read_compiler(MjcfSource& source, Element& e, MjcfCompiler& compiler);

// Pose of an element: pos, and one of quat, axisangle, euler, xyaxes, zaxis.
SE3<double> read_pose(const Reader& reader, const Element& e, const MjcfCompiler& compiler);
SE3<double> read_rotation(const Reader& reader, const Element& e, const MjcfCompiler& compiler);
bool has_rotation(const Element& e);
Mat3<double> from_euler(const std::array<double, 3>& angles, const MjcfCompiler& compiler);
Mat3<double> from_quaternion(double w, double x, double y, double z);  // must not be zero
Mat3<double> turn_z_to(const Vec3<double>& axis);
inline constexpr std::initializer_list<const char*> rotation_attributes = {"quat", "axisangle", "euler", "xyaxes", "zaxis"};

// true or false; nullopt for auto. missing: value without the attribute.
std::optional<bool> read_switch(const Reader& reader, const Element& e, const char* attribute, std::optional<bool> missing);

// A range that is switched on, or given while the switch is "auto".
std::optional<std::array<double, 2>> read_limits(const Reader& reader, const Element& e, const char* attribute,
                                                 const char* limited, bool autolimits);
double read_bound(double x);  // the largest double stands for no bound

// One number for all degrees of freedom. Newer files may give a polynomial; only its linear term is used.
double read_coefficient(const Reader& reader, const Element& e, const char* attribute);

// mjcf_law.cpp: is_actuator tells whether an actuator is supported. as_general rewrites a shortcut such as <position> as
// <general>, after its class was applied, and keeps its kind in an attribute whose name no file can have.
inline constexpr const char* converted_from = "converted from";
bool is_actuator(const Element& e);
void as_general(const Reader& reader, Element& e);

// Classes of defaults.
class MjcfDefaults {
 public:
  MjcfDefaults() : classes_{{"main", {}}}, numbers_{{"main", 0}} {}
  // Reads a <default> of the root. Several of them add up.
  void read(MjcfSource& source, Element& e);
  // Writes into e the attributes of its class, or of the class around it, that e does not have. kind: element name in the
  // defaults.
  void apply(const MjcfSource& source, Element& e, const std::string& kind, const std::string& around) const;
  // Returns the default class of the content of an element with childclass. Throws if the class does not exist.
  std::string around(const MjcfSource& source, const Element& e, const std::string& outside) const;

 private:
  using Attributes = std::map<std::string, std::string>;
  struct Class {
    std::string name;
    std::map<std::string, Attributes> kinds;
  };
  void read(MjcfSource& source, Element& e, int at);
  static void write(const MjcfSource& source, const Attributes& known, Element& e);
  int find(const MjcfSource& source, const Element& e, const std::string& name) const;

  std::vector<Class> classes_;  // 0: main
  std::map<std::string, int, std::less<>> numbers_;  // of the classes by name
};

}  // namespace dyn::load
