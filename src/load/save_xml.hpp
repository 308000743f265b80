// Shared by the writers of URDF and MJCF: numbers, the report of losses, unique names, joints as chains of simple ones.
#pragma once

#include <tinyxml2.h>

#include <limits>
#include <map>
#include <set>
#include <span>

#include "effect/list.hpp"
#include "model/colour.hpp"
#include "model/save.hpp"
#include "model/builder_impl.hpp"
#include "report.hpp"

namespace dyn::load {

using XmlElement = tinyxml2::XMLElement;

inline constexpr double no_limit_written = std::numeric_limits<double>::max();  // read back as no limit

// Numbers separated by spaces, each as the shortest text that reads back as the same double.
std::string number_list(std::span<const double> x);
inline std::string number_list(std::initializer_list<double> x) { return number_list({x.begin(), x.size()}); }
inline void put(XmlElement& e, const char* attribute, std::span<const double> x) {
  e.SetAttribute(attribute, number_list(x).c_str());
}
inline void put(XmlElement& e, const char* attribute, std::initializer_list<double> x) {
  e.SetAttribute(attribute, number_list(x).c_str());
}
inline void put(XmlElement& e, const char* attribute, double x) { put(e, attribute, {x}); }
inline void put(XmlElement& e, const char* attribute, const std::string& x) { e.SetAttribute(attribute, x.c_str()); }
// Three digits suffice for 8 bits.
inline void put_rgba(XmlElement& e, std::uint32_t colour) {
  std::array<double, 4> rgba = rgba_of(colour);
  for (double& x : rgba) x = std::round(1000 * x) / 1000;
  put(e, "rgba", rgba);
}
std::string printed(const tinyxml2::XMLDocument& doc);

// Report of what a format cannot hold. Losses of one kind are one line with all their names.
class Losses {
 public:
  explicit Losses(SaveReport& report) : report_(report) {}
  void write_report() const;  // to the report
  Losses(const Losses&) = delete;
  void loss(const std::string& what, const std::string& name = "") { add(DYN_REPORT_LEVEL_DROPPED, what, name); }
  void note(const std::string& what, const std::string& name = "") { add(DYN_REPORT_LEVEL_INFO, what, name); }

 private:
  struct Line {
    dynReportLevel level;
    std::string what;
    std::vector<std::string> names;
  };
  void add(dynReportLevel level, const std::string& what, const std::string& name);
  SaveReport& report_;
  std::vector<Line> lines_;
};

// Unique names of one kind of element.
class Names {
 public:
  std::string claim(const std::string& wanted);
  void reserve(const std::string& name) { taken_.insert(name); }

 private:
  std::set<std::string> taken_;
};

// A revolute, continuous, prismatic, spherical, free or (cos, sin) joint of a chain. The last one has the joint's name and frame.
struct SimpleJoint {
  dynJointType type;
  Axis axis;
  SE3<double> before;  // from the frame before, at q = 0
  std::string name;
  int q, v;            // first coordinate and degree of freedom within the joint
  std::string leader;  // of a mimic joint, or ""
  double ratio, offset;
};
// A helical joint becomes a slide that mimics a rotation.
std::vector<SimpleJoint> chain_of(const Model& m, Index joint, Names& names);

// Parameters of a joint with one coordinate.
struct ScalarNumbers {
  double lower, upper, velocity, effort, rest;
#define COEFFICIENT(name, has, sentence) double name = 0;
#include "effect/coefficients.def"
};
ScalarNumbers numbers_of(const JointSpec& spec, const SimpleJoint& joint);

inline bool is_identity(const double (&placement)[12]) {
  return std::equal(placement, placement + 12, identity_placement.begin());
}
bool is_default(const dynMaterial& material, bool with_friction);
// Frames of each joint, in order. The world's do not include the universe.
std::vector<std::vector<Index>> frames_by_joint(const Model& m);
// Of the links among these frames.
double mass_of(const Model& m, const std::vector<Index>& frames);

}  // namespace dyn::load
