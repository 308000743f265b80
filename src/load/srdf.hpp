// An SRDF that belongs to a URDF: named configurations, and disabled collision pairs.
#pragma once

#include <map>
#include <set>

#include "budget.hpp"
#include "urdf_robot.hpp"

namespace dyn::load {

struct Srdf {
  struct State {
    std::string name;  // of the configuration: "state", or "group/state" if several groups have one of this name
    int line;
    std::vector<std::pair<std::string, std::vector<double>>> joints;  // joints of the model with their coordinates
  };
  struct Pair {
    std::string link1, link2, reason;
  };
  std::vector<State> states;
  std::vector<Pair> pairs;
};

// The robot that an SRDF refers to.
struct SrdfContext {
  const UrdfRobot& robot;
  const std::string& root;  // link
  bool floating;            // the root link is on "root_joint"
  Report& report;
  Budget* budget;
  std::set<std::string_view> links = {};
  std::map<std::string_view, const JointSpec*> joints = {};
  std::set<std::string_view> virtual_joints = {};  // of the SRDF
  mutable int unknown = 0;                         // names so far
};

// Reads the file. Report entries begin with its name.
Srdf load_srdf(const LoadOptions& options, const UrdfRobot& robot, const UrdfTree& tree, bool floating,
               std::vector<Report::Entry>& entries);

// srdf_states.cpp
std::vector<Srdf::State> read_states(const Element& root, const SrdfContext& context);
// srdf_pairs.cpp
std::vector<Srdf::Pair> read_pairs(const Element& root, const SrdfContext& context);

// Returns whether the robot has a link or joint of this name. Reports it otherwise.
bool known_link(const Element& e, const std::string& name, const std::string& owner, const SrdfContext& context);
bool known_joint(const Element& e, const std::string& name, const std::string& owner, const SrdfContext& context);
// Virtual joints connect the root to the world. In the model it is "root_joint", whatever the SRDF calls it.
bool is_virtual(const SrdfContext& context, const std::string& joint);

}  // namespace dyn::load
