// An MJCF model as values, and the steps between file and builder.
#pragma once

#include <map>
#include <set>

#include "collision_mesh.hpp"
#include "colour.hpp"
#include "model/constraints.hpp"
#include "model/model.hpp"
#include "algorithm/actuators.hpp"
#include "mjcf_settings.hpp"

namespace dyn::meshes {
struct Mesh;
}

namespace dyn::load {

struct CollisionMesh;

// A place in a file, as the prefix of messages.
struct MjcfPlace {
  Report* report = nullptr;
  int line = 0;
  std::string owner;  // "body 'arm'"

  [[noreturn]] void fail(dynStatus status, const std::string& message) const {
    report->fail(status, line, owner + ": " + message);
  }
  void physics(const std::string& message) const { report->physics(line, owner + ": " + message); }
  void info(const std::string& message) const { report->info(line, owner + ": " + message); }
  void warning(const std::string& message) const { report->warning(line, owner + ": " + message); }
};

// Adds the place to errors of the builder.
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
  JointSpec spec;  // parent and placement are set with the tree
  Vec3<double> anchor = Vec3<double>::zero(), axis = Vec3<double>::make(0, 0, 1);  // in the body's frame
  std::optional<std::array<double, 2>> force;  // total of all its actuators
  bool compensates = false;                    // and of the compensation of gravity
  double reference = 0;  // coordinate at the initial configuration
  double time_constant = 0, damping_ratio = 0;  // both positive: they define stiffness and damping
};

struct MjcfGeom {
  MjcfPlace place;
  int body;  // its number
  Shape shape;
  SE3<double> X;  // in the body's frame
  double density = 1000;
  std::optional<double> mass;
  int group = 0, priority = 0;
  double margin = 0;  // by which its surface is raised in contacts
  std::shared_ptr<const meshes::Mesh> mesh;  // set if the mesh was read
  std::string rule;                          // how a mesh gets its mass: legacy (also ""), exact, convex, shell
  bool discarded = false;                    // <compiler discardvisual>: it is no shape
  std::optional<FluidShape> fluid = {};      // semiaxes zero: those of its size; placement in the body's frame
  bool wrapped = false, has_site = false;    // by a tendon; at the frame of a site
  std::string frame;                         // of a wrapped geom
};

struct MjcfSite {
  MjcfPlace place;
  std::string name, frame = {};  // frame: another name, where a joint has its name
  SE3<double> X;
  dynShapeType shape = DYN_SHAPE_TYPE_SPHERE;  // of its zone, with sizes as of shapes
  std::array<double, 3> extent = {0.005, 0.005, 0.005};
};

// Mass properties of a rigid body about its centre of mass, in body axes.
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
  MjcfMassRules rules;  // of the file it stands in
  double compensation = 0;
  bool mocap = false;
};

inline bool mass_from_geoms(const MjcfBody& b) {
  return b.rules.from_geoms == FromGeoms::Always || (b.rules.from_geoms == FromGeoms::WhenMissing && !b.inertial);
}

struct MjcfExclude {
  MjcfPlace place;
  std::string bodies[2];
};

// Elements name joints, sites and geoms of the file.
struct MjcfTendon {
  MjcfPlace place;
  std::string name;
  dynTendon spec;
  std::vector<TendonElement> elements;
  std::optional<std::array<double, 2>> force;  // total of all its actuators
  Compliance compliance = {}, friction_compliance = {};
};

struct MjcfActuator {
  MjcfPlace place;
  std::string name;
  dynActuator spec;
  std::string target, reference;  // joint, tendon or sites, by spec.transmission
  double damping_ratio = 0;  // instead of kv, or of the last bias parameter
  double muscle_scale = 0;   // instead of the force of a muscle, which follows from the inertia that it moves
  size_t activations = 0;    // numbers in the file's keys
  bool inert = false;        // not supported: it keeps its control and exerts no force
};

// on, to: what object and reference name: "site", "body", "xbody", "geom", "joint", "tendon", "actuator".
struct MjcfSensor {
  MjcfPlace place;
  std::string name;
  dynSensor spec;
  std::string on, object, to, reference;
};

// first, second: bodies, sites, joints or tendons. numbers: relpose or polycoef as in the file.
struct MjcfEquality {
  MjcfPlace place;
  std::string name, kind, first, second;
  std::optional<std::array<double, 3>> anchor;
  std::vector<double> numbers;
  bool enabled, sites;
  Compliance compliance = {};
};

// Of the sum of the actuators on a joint or tendon.
struct MjcfForceLimit {
  MjcfPlace place;
  bool tendon;
  std::string target;
  std::array<double, 2> range;
  bool with_weight;
};

struct MjcfPair {
  MjcfPlace place;
  std::string geoms[2];
  dynMaterial material;
  std::uint32_t latent = 0;  // kinds of friction that do not act, as ShapeMaterial has it
  double margin = 0;
  Compliance compliance = {};
};

struct MjcfKey {
  MjcfPlace place;
  std::string name;
  std::vector<double> qpos, qvel = {}, act = {}, ctrl = {}, mpos = {}, mquat = {};
  double time = 0;
};

struct MjcfNames;

// Numbers of all contacts, in place of those of geoms and pairs.
struct MjcfOverride {
  Compliance compliance;
  double restitution, friction[3], margin;
};

struct MjcfRobot {
  std::string name;
  std::array<double, 3> gravity = {0, 0, -9.81};
  MjcfCompiler compiler;         // the main file's
  std::vector<MjcfBody> bodies;  // depth first, in the file's order; 0 is the world
  std::vector<MjcfExclude> excludes;
  std::vector<MjcfKey> keys;
  std::vector<MjcfTendon> tendons;
  std::vector<MjcfActuator> actuators;
  std::vector<MjcfForceLimit> force_limits;
  std::vector<MjcfSensor> sensors;
  std::array<double, 3> magnetic = {0, -0.5, 0};
  std::vector<MjcfEquality> equalities;
  std::vector<MjcfPair> pairs;
  double density = 0, viscosity = 0;
  std::array<double, 3> wind = {0, 0, 0};
  PairFilter filter = PairFilter::Mujoco;  // <flag filterparent>
  double timestep = 0.002;
  dynIntegrator integrator = DYN_INTEGRATOR_SEMI_IMPLICIT_EULER;
  std::uint32_t effects = SimulationRecord().effects;             // less those that flags switch off
  double impratio = 1;
  bool pyramidal = true;
  std::optional<MjcfOverride> override_ = {};  // <flag override>
  bool contacts = true, closed = true, control_ranges = true;  // flags; closed: equalities hold
  bool lost_mass = false;            // something that is not supported would give a body mass
  std::set<std::string> lost_names;  // what bodies and joints that it would make begin with
  std::set<size_t> lost_lengths;     // of these names

  std::set<std::string> lost_tendons;  // that refer to such parts
  std::map<std::string, size_t> tendon_numbers;
  Budget* budget = nullptr;  // of this load
  std::shared_ptr<const MjcfNames> names;  // made on demand (mjcf_names.cpp); to be reset when a part is added or named

  bool has_lost(const std::string& name) const {
    return std::any_of(lost_lengths.begin(), lost_lengths.end(),
                       [&](size_t n) { return n <= name.size() && lost_names.count(name.substr(0, n)); });
  }
};

// Parts by their names, the first of equals; nullptr: there is none. (mjcf_names.cpp)
MjcfBody* find_body(MjcfRobot& robot, const std::string& name);
MjcfJoint* find_joint(MjcfRobot& robot, const std::string& name);
MjcfGeom* find_geom(MjcfRobot& robot, const std::string& name);
MjcfSite* find_site(MjcfRobot& robot, const std::string& name);
MjcfTendon* find_tendon(MjcfRobot& robot, const std::string& name);
inline const MjcfBody* find_body(const MjcfRobot& robot, const std::string& name) {
  return find_body(const_cast<MjcfRobot&>(robot), name);
}
inline const MjcfJoint* find_joint(const MjcfRobot& robot, const std::string& name) {
  return find_joint(const_cast<MjcfRobot&>(robot), name);
}
inline const MjcfGeom* find_geom(const MjcfRobot& robot, const std::string& name) {
  return find_geom(const_cast<MjcfRobot&>(robot), name);
}
inline const MjcfSite* find_site(const MjcfRobot& robot, const std::string& name) {
  return find_site(const_cast<MjcfRobot&>(robot), name);
}
// " (did you mean 'elbow'?)" of all joints, geoms or sites.
std::string suggestion(const MjcfRobot& robot, const char* kind, const std::string& name);

// Meshes and height fields by the names that geoms use.
class MjcfAssets {
 public:
  MjcfAssets(MjcfSource& source, const MjcfCompiler& compiler, const LoadOptions& options)
      : source_(source), compiler_(compiler), options_(options) {}
  void add(Element& asset, const MjcfDefaults& defaults);
  // The file of a <model> of <asset>.
  const Element& model(const Element& e, const std::string& name) const;
  // Sets the geom's mesh by name. needed: the mass is needed, so the file must be read.
  void mesh(const Element& e, const std::string& name, bool needed, MjcfGeom& geom);
  // The mesh by name, read.
  const meshes::Mesh& mesh(const Element& e, const std::string& name);
  // Sets the geom's height field by name. Returns false, with a report entry, if its format is not supported.
  bool height_field(const Element& e, const std::string& name, MjcfGeom& geom);
  // Colour of a geom: its own, else that of its material; 0: none.
  std::uint32_t colour(const Element& geom) const;

 private:
  struct Entry {
    Element* element;
    std::shared_ptr<const meshes::Mesh> mesh;
    std::string path;
    std::optional<CollisionMesh> collision = std::nullopt;
    std::shared_ptr<const SurfaceData> grid = nullptr;  // of a height field
  };
  Entry& find(std::map<std::string, Entry>& all, const char* kind, const Element& e, const std::string& name) const;
  Entry& mesh_entry(const Element& e, const std::string& name);
  void read(Entry& entry) const;
  void charge_work(const meshes::Mesh& mesh, const Element& e) const;

  MjcfSource& source_;
  const MjcfCompiler& compiler_;
  const LoadOptions& options_;
  std::map<std::string, Entry> meshes_, fields_, models_;
  Colours materials_;
};

// Where an element stands: its body and frame, its default class, and the affixes of its names.
struct MjcfContext {
  int body = 0;
  SE3<double> X = SE3<double>::identity();  // of the frame in the body
  std::string childclass, prefix, suffix, outer;  // outer: suffix of names that were not copied
  const Element* replicate = nullptr;  // the innermost around it
  int copies = 0;  // that it stands in, of parts of the same model
  double replicas = 1;  // copies that the <replicate> around it make

  std::string name(const std::string& n) const { return n.empty() ? n : prefix + n + suffix; }
};

struct MjcfFile;

// What <replicate> copied: the suffixes of a name's copies. Elements that refer to a copied name are copied, too.
class MjcfCopies {
 public:
  using Read = void (*)(MjcfFile&, Element&, const MjcfContext&);
  void add(const Element& e, const MjcfContext& context);
  // Reads the elements of a section, as MuJoCo does: first those that refer to nothing copied, then the others once a copy.
  void read_section(MjcfFile& file, Element& section, const MjcfContext& context, Read read) const;
  // The name that an element means by one of a joint, body, site, geom or tendon: its own copy's, if there is one.
  std::string name(const MjcfContext& context, const std::string& kind, const std::string& name) const;

 private:
  using Replica = std::pair<const Element*, std::string>;  // the innermost <replicate>, and the suffix of its copy
  using Replicas = std::set<Replica>;
  struct Copied {
    Replicas replicas;
    std::set<std::string> suffixes;
  };
  const Copied* copied(const std::string& kind, const std::string& name) const;
  const Replicas* replicas_in(const Element& e) const;  // of the first copied name in e's attributes
  std::map<std::pair<std::string, std::string>, Copied> copies_;
  std::vector<Replica> replicas_;  // in the file's order
  Replicas known_;
};

// Settings of one file while its bodies are read.
struct MjcfFile {
  MjcfSource& source;
  const LoadOptions& options;
  MjcfRobot& robot;
  MjcfCompiler compiler;
  MjcfDefaults defaults;
  MjcfAssets assets;
  MjcfCopies copies;
  bool part = false;  // only one body of the file is attached

  MjcfFile(MjcfSource& s, MjcfRobot& r, const LoadOptions& o) : source(s), options(o), robot(r), assets(s, compiler, o) {}
  MjcfFile(const MjcfFile&) = delete;
};

// mjcf.cpp: reads everything under <mujoco>. The content of its world goes to the context's frame.
void read_mjcf_file(MjcfFile& file, Element& root, const MjcfContext& context, const char* body = nullptr);
// mjcf_tree.cpp: bodies, frames, replicas, attached models
void read_mjcf_body(MjcfFile& file, Element& e, const MjcfContext& context);
// Reads and returns the named body or frame in e at any depth, or nullptr. Only its own pose counts, not those around it.
const Element* read_mjcf_named(MjcfFile& file, Element& e, MjcfContext context, std::string_view kind, std::string_view name);
void read_mjcf_content(MjcfFile& file, Element& e, const MjcfContext& context);
// mjcf_joint.cpp, mjcf_geom.cpp
void read_mjcf_joint(MjcfFile& file, Element& e, const MjcfContext& context);
void read_mjcf_geom(MjcfFile& file, Element& e, const MjcfContext& context);
// mjcf_compliance.cpp. reference, impedance: the attributes' names.
Compliance read_mjcf_compliance(const Reader& reader, const Element& e, const char* reference, const char* impedance);
std::uint32_t mjcf_latent(const Reader& reader, const Element& e);  // ShapeMaterial::latent, of condim
double mjcf_rebound(const Reader& reader, const Element& e, const char* solref = "solref");  // restitution
void override_mjcf_contacts(MjcfRobot& robot);
void set_mjcf_priorities(MjcfRobot& robot);
// mjcf_mass.cpp
MjcfMass read_mjcf_inertial(const MjcfFile& file, const Element& e, const std::string& owner);
std::vector<MjcfMass> mjcf_masses(const MjcfRobot& robot);
MjcfMass mjcf_mesh_mass(const meshes::Mesh& mesh, const MjcfGeom& g);  // at density 1
// mjcf_fit.cpp: sizes and pose of a primitive that is fitted to a mesh; bounds: to its box, not to its inertia.
void fit_mjcf_geom(const meshes::Mesh& mesh, bool bounds, double scale, MjcfGeom& geom);
// Sets the ellipsoid on which a medium acts: as far along principal axes as the mesh is at most.
void fit_mjcf_fluid(const meshes::Mesh& mesh, MjcfGeom& geom);
// mjcf_builtin.cpp: the surface of a <mesh builtin>, or its corners alone.
meshes::Mesh mjcf_builtin_mesh(const Reader& reader, const Element& e);
// mjcf_rest.cpp: sections beside the bodies
void read_mjcf_option(MjcfFile& file, Element& e);
void read_mjcf_contact(MjcfFile& file, Element& e, const MjcfContext& context);  // an element of <contact>
void report_mjcf_section(MjcfFile& file, Element& e);
// mjcf_keys.cpp: named configurations. Keys come after the actuators, whose controls they hold.
void read_mjcf_keys(MjcfFile& file, Element& e, const MjcfContext& context);
void add_mjcf_initial_configuration(Builder& builder, const MjcfRobot& robot);
void add_mjcf_keys(Builder& builder, const MjcfRobot& robot);
// mjcf_tendon.cpp
void read_mjcf_tendon(MjcfFile& file, Element& e, const MjcfContext& context);
void name_mjcf_frames(MjcfRobot& robot);  // of sites and wrapped geoms
void add_mjcf_tendons(Builder& builder, const MjcfRobot& robot);
// mjcf_sensor.cpp
void read_mjcf_sensor(MjcfFile& file, Element& e, const MjcfContext& context);
void add_mjcf_sensors(Builder& builder, const MjcfRobot& robot, const std::vector<MjcfMass>& masses);
// mjcf_actuator.cpp, mjcf_equality.cpp
void read_mjcf_actuator(MjcfFile& file, Element& e, const MjcfContext& context);
// mjcf_driver.cpp: the law of a <pid> or <dcmotor>.
void read_mjcf_driver(const Reader& reader, const Element& e, bool autolimits, MjcfActuator& actuator);
void read_mjcf_range(const Reader& reader, const Element& e, const char* attribute, const char* limited, bool autolimits,
                     double (&out)[2]);
void limit_mjcf_actuators(MjcfRobot& robot);  // applies the actuator force range of a joint or tendon to its only actuator
// One that is not supported keeps its control and its place, and exerts no force.
void make_mjcf_actuator_inert(MjcfActuator& actuator, const std::string& why);
void add_mjcf_actuators(Builder& builder, const MjcfRobot& robot);
// One actuator, with spec in place of its own.
void add_mjcf_actuator(Builder& builder, const MjcfRobot& robot, const MjcfActuator& a, const dynActuator& spec);
// mjcf_measure.cpp: numbers that follow from inertias and lengths, of actuators and of joints with a time constant. Their models
// have motors in place of these actuators, and no other actuators.
bool has_measured_actuators(const MjcfRobot& robot);
void add_mjcf_motors(Builder& builder, const MjcfRobot& robot);
void measure_mjcf_actuators(const Model& model, MjcfRobot& robot);
bool has_springdampers(const MjcfRobot& robot);
void compute_mjcf_springs(const Model& model, MjcfRobot& robot);
void read_mjcf_equality(MjcfFile& file, Element& e, const MjcfContext& context);
void add_mjcf_equalities(Builder& builder, MjcfRobot& robot);
void read_mjcf_pair(MjcfFile& file, Element& e, const MjcfContext& context);
void mark_mjcf_pairs(MjcfRobot& robot);  // geoms named by a pair collide whatever their masks
void add_mjcf_pairs(Builder& builder, const MjcfRobot& robot);
// mjcf_build.cpp
ModelPtr build_mjcf(MjcfRobot& robot, MjcfSource& source, const LoadOptions& options);

}  // namespace dyn::load
