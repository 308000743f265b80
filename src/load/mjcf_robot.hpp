// An MJCF model as values, and the steps between the file and the builder.
#pragma once

#include "colour.hpp"
#include "model/constraints.hpp"
#include "simulation/actuators.hpp"
#include "mjcf_settings.hpp"

namespace dyn::meshes {
struct Mesh;
}

namespace dyn::load {

// A place in a file: what messages and checks of what was read there go through.
struct MjcfPlace {
  Report* report = nullptr;
  int line = 0;
  std::string owner;  // "body 'arm'"

  [[noreturn]] void fail(dynStatus status, const std::string& message) const { report->fail(status, line, owner + ": " + message); }
  void physics(const std::string& message) const { report->physics(line, owner + ": " + message); }
  void info(const std::string& message) const { report->info(line, owner + ": " + message); }
  void warning(const std::string& message) const { report->warning(line, owner + ": " + message); }
};

// What a call of the builder throws, with the place in front.
template <class Call>
auto with_location(const MjcfPlace& place, const Call& call) {
  try {
    return call();
  } catch (const Error& e) {
    place.report->fail(e.status, place.line, e.what());
  }
}

struct MjcfJoint {
  MjcfPlace place;
  JointSpec spec;  // parent and placement come with the tree
  Vec3<double> anchor = Vec3<double>::zero(), axis = Vec3<double>::make(0, 0, 1);  // in the body's frame
  std::optional<std::array<double, 2>> force;  // of all its actuators together
  double reference = 0;  // the coordinate in the configuration that the file draws
  double time_constant = 0, damping_ratio = 0;  // where both are positive, they stand for stiffness and damping
};

struct MjcfGeom {
  MjcfPlace place;
  Shape shape;
  SE3<double> X;  // in the body's frame
  double density = 1000;
  std::optional<double> mass;
  int group = 0;
  std::shared_ptr<const meshes::Mesh> mesh;  // that the shape is, when it was read
  std::string rule;                          // by which a mesh has mass: legacy (also ""), exact, convex, shell
};

struct MjcfSite {
  MjcfPlace place;
  std::string name;
  SE3<double> X;
};

// A rigid body's mass properties: about the centre of mass, body axes.
struct MjcfMass {
  double mass = 0;
  Vec3<double> com = Vec3<double>::zero();
  Sym3<double> inertia = Sym3<double>::diagonal(0, 0, 0);
};

struct MjcfBody {
  MjcfPlace place;
  std::string name;
  int parent = -1;
  SE3<double> X;  // in the parent's frame
  std::optional<MjcfMass> inertial;
  std::vector<MjcfJoint> joints;
  std::vector<MjcfGeom> geoms;
  std::vector<MjcfSite> sites;
  MjcfMassRules rules;  // of its file
  double compensation = 0;
};

inline bool mass_from_geoms(const MjcfBody& b) {
  return b.rules.from_geoms == FromGeoms::Always || (b.rules.from_geoms == FromGeoms::WhenMissing && !b.inertial);
}

struct MjcfExclude {
  MjcfPlace place;
  std::string bodies[2];
};

struct MjcfActuator {
  MjcfPlace place;
  std::string name;
  dynActuator spec;
  std::string joint;
  double damping_ratio = 0;  // in place of kv, or of the last number of the bias
};

// first, second: bodies, sites or joints. numbers: relpose or polycoef, as given.
struct MjcfEquality {
  MjcfPlace place;
  std::string name, kind, first, second;
  std::optional<std::array<double, 3>> anchor;
  std::vector<double> numbers;
  bool enabled, sites;
};

struct MjcfPair {
  MjcfPlace place;
  std::string geoms[2];
  std::optional<dynMaterial> material;
};

struct MjcfKey {
  MjcfPlace place;
  std::string name;
  std::vector<double> qpos;
};

struct MjcfRobot {
  std::string name;
  std::array<double, 3> gravity = {0, 0, -9.81};
  MjcfCompiler compiler;         // the main file's
  std::vector<MjcfBody> bodies;  // depth first in the file's order; 0 is the world
  std::vector<MjcfExclude> excludes;
  std::vector<MjcfKey> keys;
  std::vector<MjcfActuator> actuators;
  std::vector<MjcfEquality> equalities;
  std::vector<MjcfPair> pairs;
  double density = 0, viscosity = 0;
  std::array<double, 3> wind = {0, 0, 0};
};

// Meshes and height fields that a file's geoms name.
class MjcfAssets {
 public:
  MjcfAssets(MjcfSource& source, const MjcfCompiler& compiler, const LoadOptions& options) : source_(source), compiler_(compiler), options_(options) {}
  void add(Element& asset, const MjcfDefaults& defaults);
  // <model> of <asset>: its file
  const Element& model(const Element& e, const std::string& name) const;
  // Makes geom the mesh or height field of that name; needed: its mass will be asked for, so that the file has to be read.
  void mesh(const Element& e, const std::string& name, bool needed, MjcfGeom& geom);
  // false: in a format that is not read, which the report says
  bool height_field(const Element& e, const std::string& name, MjcfGeom& geom);
  // The colour of a geom: its own, else that of its material; 0: neither
  std::uint32_t colour(const Element& geom) const;

 private:
  struct Entry {
    Element* element;
    std::shared_ptr<const meshes::Mesh> mesh;
    std::string path;
  };
  Entry& find(std::map<std::string, Entry>& all, const char* kind, const Element& e, const std::string& name) const;
  void read(Entry& entry) const;

  MjcfSource& source_;
  const MjcfCompiler& compiler_;
  const LoadOptions& options_;
  std::map<std::string, Entry> meshes_, fields_, models_;
  Colours materials_;
};

// One file's settings while its bodies are read.
struct MjcfFile {
  MjcfSource& source;
  const LoadOptions& options;
  MjcfRobot& robot;
  MjcfCompiler compiler;
  MjcfDefaults defaults;
  MjcfAssets assets;
  bool part = false;  // one body of it is attached

  MjcfFile(MjcfSource& s, MjcfRobot& r, const LoadOptions& o) : source(s), options(o), robot(r), assets(s, compiler, o) {}
  MjcfFile(const MjcfFile&) = delete;
};

// Where an element stands: the body and frame that carry it, the class around it, and what its names get.
struct MjcfContext {
  int body = 0;
  SE3<double> X = SE3<double>::identity();  // of the frame in the body
  std::string childclass, prefix, suffix;

  std::string name(const std::string& n) const { return n.empty() ? n : prefix + n + suffix; }
};

// mjcf.cpp: everything under <mujoco>; the world's content goes to where the context is.
void read_mjcf_file(MjcfFile& file, Element& root, const MjcfContext& context, const char* body = nullptr);
// mjcf_tree.cpp: bodies, frames, replicas, attached models
void read_mjcf_body(MjcfFile& file, Element& e, const MjcfContext& context);
void read_mjcf_content(MjcfFile& file, Element& e, const MjcfContext& context);
// mjcf_joint.cpp, mjcf_geom.cpp
void read_mjcf_joint(MjcfFile& file, Element& e, const MjcfContext& context);
void read_mjcf_geom(MjcfFile& file, Element& e, const MjcfContext& context);
// mjcf_mass.cpp
MjcfMass read_mjcf_inertial(const MjcfFile& file, const Element& e, const std::string& owner);
std::vector<MjcfMass> mjcf_masses(const MjcfRobot& robot);
// mjcf_rest.cpp: sections beside the bodies
void read_mjcf_option(MjcfFile& file, Element& e);
void read_mjcf_contact(MjcfFile& file, Element& e, const MjcfContext& context);
void read_mjcf_keys(MjcfFile& file, Element& e, const MjcfContext& context);
void report_mjcf_section(MjcfFile& file, Element& e);
// mjcf_actuator.cpp, mjcf_equality.cpp
void read_mjcf_actuators(MjcfFile& file, Element& section, const MjcfContext& context);
void limit_mjcf_actuators(MjcfRobot& robot);  // what limits a joint's actuators limits the one that there is
void add_mjcf_actuators(Builder& builder, const MjcfRobot& robot);
// mjcf_damping.cpp: whether there are servos that are damped by a ratio; their damping, by the model without actuators. The same of joints.
bool damped_by_ratio(const MjcfRobot& robot);
void compute_mjcf_damping(const Model& model, MjcfRobot& robot);
bool has_springdampers(const MjcfRobot& robot);
void compute_mjcf_springs(const Model& model, MjcfRobot& robot);
void read_mjcf_equalities(MjcfFile& file, Element& section, const MjcfContext& context);
void add_mjcf_equalities(Builder& builder, const MjcfRobot& robot);
void read_mjcf_pair(MjcfFile& file, Element& e, const MjcfContext& context);
void mark_mjcf_pairs(MjcfRobot& robot);  // geoms that a pair names collide, whatever their masks say
void add_mjcf_pairs(Builder& builder, const MjcfRobot& robot);
// mjcf_build.cpp
ModelPtr build_mjcf(MjcfRobot& robot, MjcfSource& source, const LoadOptions& options);

}  // namespace dyn::load
