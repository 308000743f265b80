// An SRDF beside a URDF: named configurations, and pairs of links that are not tested for collision.
#pragma once

#include "urdf_robot.hpp"

namespace dyn::load {

struct Srdf {
  struct State {
    std::string name;  // of the configuration: "state", or "group/state" when several groups have one of this name
    int line;
    std::vector<std::pair<std::string, std::vector<double>>> joints;  // the model's, with their own coordinates
  };
  struct Pair {
    std::string link1, link2, reason;
  };
  std::vector<State> states;
  std::vector<Pair> pairs;
};

// What an SRDF is read against.
struct SrdfContext {
  const UrdfRobot& robot;
  const std::string& root;  // link
  bool floating;            // "root_joint" carries the root
  Report& report;
};

// The file's parts; entries of the report begin with the file's name.
Srdf load_srdf(const std::string& file, const UrdfRobot& robot, const UrdfTree& tree, bool floating, bool strict, std::vector<Report::Entry>& entries);

// srdf_states.cpp
std::vector<Srdf::State> read_states(const Element& root, const SrdfContext& context);
// srdf_pairs.cpp
std::vector<Srdf::Pair> read_pairs(const Element& root, const SrdfContext& context);

// Whether the robot has a link, or a joint, of this name; reported where it has not.
bool known_link(const Element& e, const std::string& name, const std::string& owner, const SrdfContext& context);
bool known_joint(const Element& e, const std::string& name, const std::string& owner, const SrdfContext& context);
// Virtual joints carry the root in the world: the model's is "root_joint", whatever the SRDF calls it.
bool is_virtual(const Element& root, const std::string& joint);

}  // namespace dyn::load
