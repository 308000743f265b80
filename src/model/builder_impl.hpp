// What a builder has collected.
#pragma once

#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "dyn/joint/kinds.hpp"
#include "dyn/model/builder.hpp"
#include "dyn/model/model.hpp"

namespace dyn {

struct JointEntry {
  JointSpec spec;
  int parent;             // index of the carrying joint, or -1
  SE3<double> placement;  // in the carrying joint's frame
  struct Part {
    SE3<double> before;
    Element element;
  };
  std::vector<Part> elements;
};

struct FrameEntry {
  std::string name;
  dynFrameType type;
  int joint;                // carrying joint, or -1: the world
  SE3<double> X;            // in the joint's frame
  Inertia<double> Y;        // in the joint's frame, about its origin
  double mass = 0;          // as given, in the frame
  std::array<double, 3> com{};
  std::array<double, 9> inertia{};
};

struct ShapeEntry {
  Shape shape;
  int frame;
};

struct ReportEntry {
  dynReportLevel level;
  int line;
  std::string message;
};

struct Builder::Impl {
  std::string name;
  std::array<double, 3> gravity = {0, 0, -9.81};
  std::vector<JointEntry> joints;  // in the order of addition: parents first
  std::vector<FrameEntry> frames;  // 0 is the universe
  std::unordered_map<std::string, std::vector<int>> frame_index;
  std::vector<ShapeEntry> shapes;
  std::vector<std::pair<std::string, std::vector<double>>> configurations;
  std::vector<ReportEntry> reports;

  int find(const Parent& parent, const std::string& who) const;
  void add_frame(FrameEntry entry, const std::string& who);
};

// Who a joint follows: q = ratio q_leader + offset; joint -1: it moves by itself.
struct Leader {
  int joint;
  double ratio, offset;
};
// Follows mimic of mimic to the joint that moves by itself.
std::vector<Leader> resolve_mimic(const std::vector<JointEntry>& joints);
// Chains of one type, as long as they can be, and chunks of them.
void make_runs(const std::vector<Body>& bodies, std::vector<Run>& runs, std::vector<Chunk>& chunks);
// Elimination tree of M: the parent of each degree of freedom, or -1.
void elimination_tree(const Model& m, std::vector<Index>& parent);
// Throws DYN_ERROR_INVALID, naming the joint, when forward dynamics is undefined. order: joints of the model as added.
void check_dynamics(const Model& m, const std::vector<int>& order, const std::vector<JointEntry>& joints, const std::vector<FrameEntry>& frames);

// Sizes of a primitive joint.
int primitive_nq(BodyType t);
int primitive_nv(BodyType t);

std::string number(double x);          // six digits, independent of the locale
Mat3<double> z_to(const Axis& a);      // smallest rotation that takes z to the unit vector a

}  // namespace dyn
