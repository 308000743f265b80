// What a builder has collected.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "joint/kinds.hpp"
#include "model/builder.hpp"
#include "model/model.hpp"

namespace dyn {

[[noreturn]] inline void refuse(dynStatus status, const std::string& message) { throw Error(status, message); }

// A simple joint: alone, or a part of a composite.
struct JointPart {
  dynJointType type;
  Axis axis, axis2;
  double pitch;
  SE3<double> before;  // from the user frame of the part before, or of the joint
};

struct PlacedElement {
  SE3<double> before;  // from the user frame of the element before
  Element element;
};

struct JointEntry {
  JointSpec spec;
  int parent;             // index of the carrying joint, or -1
  SE3<double> placement;  // in the carrying joint's frame
  std::vector<JointPart> parts;
  std::vector<PlacedElement> elements;
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
  double compensation = 0;  // share of its weight that is held
  int parent = 0;           // the frame that it hangs on
  bool mocap = false;       // of a link fixed to the world: the caller sets its pose
};

struct ShapeEntry {
  Shape shape;
  int frame;
};

// A configuration: whole, in the order of the model that will be made, or split by joints: each added joint's own coordinates
// (none: neutral), which joints that come or go do not disturb.
struct ConfigurationEntry {
  std::string name;
  bool split;
  std::vector<double> whole;
  std::vector<std::vector<double>> by_joint;
  std::vector<std::vector<double>> v_by_joint = {};  // none: zero
  std::map<std::string, ConfigurationState::Actuator> actuators = {};
  double time = 0;
  std::map<std::string, Placement> mocaps = {};  // none: as in the model
};

struct ReportEntry {
  dynReportLevel level;
  int line;
  std::string message;
};

struct DisabledEntry {
  int frame1, frame2;
  std::string reason;
};

// first, second: indices of frames, or of joints.
struct ConstraintEntry {
  std::string name;
  dynConstraint spec;
  int first, second;
  Compliance compliance = {};
};

// Indices of a joint (JOINT) or frames; -1: none.
struct TendonElementEntry {
  dynTendonElementType type;
  int id, side;
  double value;
};
struct TendonEntry {
  std::string name;
  dynTendon spec;
  std::vector<TendonElementEntry> elements;
  Compliance compliance = {}, friction_compliance = {};
};
// Of two tendons, by their indices; tendon2 -1: of one.
struct TendonCoupling {
  std::string name;
  int tendon1, tendon2;
  std::array<double, 5> coefficients;
  Compliance compliance = {};
};

struct ActuatorEntry {
  std::string name;
  dynActuator spec;
  int target;          // index of a joint, tendon or frame: by spec.transmission
  int reference = -1;  // frame
};

// Of the sum of the actuators on a joint or tendon.
struct ForceLimitEntry {
  bool tendon, with_weight;
  int target;  // its index
  double range[2];
};

// object: index of a joint, tendon, actuator, frame or shape, by spec.quantity and spec.side; reference: of a frame or shape; -1:
// none.
struct SensorEntry {
  std::string name;
  dynSensor spec;
  int object, reference;
};

// A pair of shapes that is tested whatever the filter says; material: of its contacts, or that of the shapes.
struct PairEntry {
  int shape1, shape2;
  std::optional<dynMaterial> material;
  Compliance compliance = {};  // with a material
};

// Numbers of a list's entries by name, the first of equals. Entries that were added since the last call are looked at then.
class NameIndex {
 public:
  // -1: there is none.
  template <class List, class NameOf>
  int find(const List& list, const std::string& name, const NameOf& name_of) const {
    if (known_ > list.size()) forget();
    for (; known_ < list.size(); ++known_) numbers_.try_emplace(name_of(list[known_]), int(known_));
    const auto at = numbers_.find(name);
    return at == numbers_.end() ? -1 : at->second;
  }
  template <class List>
  int find(const List& list, const std::string& name) const {
    return find(list, name, [](const auto& x) -> const std::string& { return x.name; });
  }
  // To be called when entries go, or are renamed.
  void forget() const { numbers_.clear(), known_ = 0; }

 private:
  mutable std::unordered_map<std::string, int> numbers_;
  mutable std::size_t known_ = 0;
};

struct Builder::Impl {
  std::string name;
  std::array<double, 3> gravity = {0, 0, -9.81};
  double density = 0, viscosity = 0;
  std::array<double, 3> wind{};
  std::vector<JointEntry> joints;  // in the order of addition: parents first
  std::vector<FrameEntry> frames;  // 0 is the universe
  std::unordered_map<std::string, std::vector<int>> frame_index;
  std::vector<ShapeEntry> shapes;
  std::vector<ConfigurationEntry> configurations;
  std::string initial = "neutral";  // configuration of new data
  SimulationRecord simulation;
  std::vector<ReportEntry> reports;
  std::vector<DisabledEntry> disabled;  // not tested for collision
  std::vector<ConstraintEntry> constraints;
  bool allow_massless = false;  // joints that move no inertia: a warning; forward dynamics then fails when it is called
  int constraint_slots = 8;  // spare ones
  int contact_capacity = 0;  // 0: by the shapes
  bool compliant = false, pyramidal = true;
  double impratio = 1;
  std::vector<TendonEntry> tendons;
  std::vector<TendonCoupling> couplings;
  std::vector<ActuatorEntry> actuators;
  std::vector<ForceLimitEntry> force_limits;
  std::vector<SensorEntry> sensors;
  std::vector<PairEntry> pairs;
  // (the names of joints and frames are in frame_index)
  struct Names {
    NameIndex configurations, constraints, tendons, couplings, actuators, sensors;
    mutable std::unordered_map<std::string, std::vector<int>> shapes;  // those for collision
    mutable std::size_t known_shapes = 0;
  } names;

  int find_joint(const std::string& name) const;  // -1: there is no moving joint of that name
  int find_shape(const std::string& name, const std::string& who) const;  // for collision; -1: none; throws if there are several
  int find(const Parent& parent, const std::string& who) const;
  int find_frame(const std::string& name, const std::string& who) const;  // that something acts on or runs along
  void add_frame(FrameEntry entry, const std::string& who);
  void add_joint(const JointSpec& spec);
  void check_configuration_name(const std::string& name) const;
  void check_constraint_name(const std::string& name) const;
  void check_actuator_name(const std::string& name) const;
  void check_sensor_name(const std::string& name) const;
  void check_tendon_name(const std::string& name) const;
  void check_coupling_name(const std::string& name) const;
  int find_tendon(const std::string& name, const std::string& who) const;
  // Makes every configuration one by joints.
  void split_configurations();
  // Drops the joints not marked, with the frames, shapes and numbers that they carry; world: what is fixed to it stays.
  void keep(const std::vector<bool>& joints, bool world = true);
};

// What a joint of a model was made from, and its parts. (builder_copy.cpp)
JointSpec spec_of(const Model& m, const JointRecord& joint);
std::vector<JointPart> parts_of(const JointSpec& s);
// Throw for numbers of a joint, a link or a tendon that are refused; who begins the message.
void check_joint_numbers(const std::string& who, const JointSpec& s, const std::vector<PlacedElement>& elements);
void check_link_numbers(const std::string& who, double mass, const std::array<double, 3>& com,
                        const std::array<double, 9>& inertia);
void check_tendon_numbers(const std::string& who, const dynTendon& t);
// The chain of primitives of a joint's parts.
std::vector<PlacedElement> elements_of(const JointSpec& s, const std::vector<JointPart>& parts);
// Joints depth first, siblings in the order of addition.
std::vector<int> depth_first(const std::vector<JointEntry>& joints);
// A joint's own coordinates where nothing moves.
std::vector<double> neutral_of(const JointEntry& joint);
int own_nq(const JointEntry& joint);  // 0 for a follower
int own_nv(const JointEntry& joint);
// Coordinates of the model in each joint's own, by the order of addition; followers have none. size: own_nq or own_nv.
std::vector<std::vector<double>> by_joint(const std::vector<JointEntry>& joints, const std::vector<double>& x,
                                          int (*size)(const JointEntry&) = own_nq);

// Who a joint follows: q = ratio q_leader + offset; joint -1: it moves by itself.
struct Leader {
  int joint;
  double ratio, offset;
};
// Follows mimic of mimic to the joint that moves by itself.
std::vector<Leader> resolve_mimic(const std::vector<JointEntry>& joints);
// Chains of one type, as long as they can be, and cache blocks of them.
void make_runs(const std::vector<Body>& bodies, std::vector<JointRun>& joint_runs, std::vector<CacheBlock>& cache_blocks);
// Coordinates of vector spaces, as many side by side as there are, and the bodies that have others.
void make_spans(const std::vector<Body>& bodies, std::vector<EuclideanSpan>& euclidean_spans,
                std::vector<Index>& manifold_joints);
// The groups of degrees of freedom, from their parents, depths and ends of descendants in the elimination tree. Returns how many
// there are.
Index make_dof_groups(const std::vector<Index>& parent, const std::vector<Index>& depth, const std::vector<Index>& end,
                      DofGroup* groups);
// Elimination tree of M: the parent of each degree of freedom, or -1.
void elimination_tree(const Model& m, std::vector<Index>& parent);
// Throws DYN_ERROR_INVALID, naming the joint, when forward dynamics is undefined. order: joints of the model as added.
// allow_massless: a message for each joint that moves no inertia, or a negative one, instead.
std::vector<std::string> check_dynamics(const Model& m, const std::vector<int>& order, const std::vector<JointEntry>& joints,
                                        const std::vector<FrameEntry>& frames, bool allow_massless);

// Two shapes, the lower number first, that are tested whatever the filter says, and 1 + the number of their own material or 0.
using WantedPairs = std::map<std::pair<Index, Index>, std::int32_t>;
using GeomPairs = std::vector<std::pair<Index, Index>>;
// Pairs of collision shapes but those of one body and of a body and its parent, if they are not wanted; of more than max_geoms
// shapes those that are wanted, disabled, or known to overlap.
std::vector<PairRecord> pairs_of(const std::vector<JointRecord>& joints, const std::vector<Body>& bodies,
                                 const std::vector<FrameRecord>& frames, const std::vector<ShapeRecord>& shapes,
                                 const std::vector<GeomRecord>& geoms, const std::vector<DisabledRecord>& disabled,
                                 const WantedPairs& wanted, const GeomPairs& overlapping);
// Several collision shapes, and no pair of them is tested: the load report says so.
inline constexpr const char* nothing_tested = "no pair of the collision shapes is tested: dyn info --pairs says why";
// Begins the lines of the load report on pairs that overlap.
inline constexpr const char* overlap_report = "not tested for collision, because they overlap in nearly every configuration: ";
inline constexpr const char* massless_report = "forward dynamics may be undefined: ";  // and on joints without inertia
// What only the finished model shows; the load report says it.
struct Findings {
  GeomPairs overlapping;
  bool all_looked_at = true;  // the search for them ended by itself
  std::vector<std::string> massless;
};
// Tested pairs of filter Guess that overlap in the neutral configuration and in all of 32 random ones, or all but one. Ascending.
// The search ends after max_looks pairs with overlapping boxes, or max_overlaps pairs that overlap: shapes in one place have the
// square of their number. all: whether it did not.
inline constexpr std::size_t max_looks = 2000000, max_overlaps = 20000;
GeomPairs overlapping(const Model& m, bool& all);

// Sizes of a primitive joint.
int primitive_nq(BodyType t);
int primitive_nv(BodyType t);

// Constraints as the model keeps them; id: of each added joint. (builder_constraint.cpp)
std::vector<dynConstraint> constraints_of(const std::vector<ConstraintEntry>& constraints, const std::vector<Index>& id);
// Rows of all of them, and six for each spare slot.
Index room_for_rows(const std::vector<ConstraintEntry>& constraints, int spare);
// Throws when the model can't have one.
void check_constraints(const Model& m);
// Actuators as the model keeps them, and their sizes. (builder_actuator.cpp)
std::vector<ActuatorRecord> actuators_of(const std::vector<ActuatorEntry>& actuators,
                                         const std::vector<ForceLimitEntry>& limits, const std::vector<Index>& id,
                                         const std::vector<JointRecord>& joints,
                                         const std::vector<EuclideanSpan>& euclidean_spans, ModelSizes& n);
// Lengths at rest that the entries leave open, and those of couplings, in the finished model. (algorithm/builder_paths.cpp)
void settle_tendons(Model& m);
// Inverse inertias of compliances, in the finished model. (algorithm/builder_compliance.cpp)
void settle_compliances(Model& m);
// On which a medium drags; X: the link's frame in its body's internal one. None of a link without mass.
std::optional<DragBox> drag_box(const FrameEntry& link, const SE3<double>& X);
// The ellipsoid of a shape with fluid forces, likewise. (builder_fluid.cpp)
FluidEllipsoid fluid_ellipsoid(const FluidShape& shape, const SE3<double>& X);

// Throw unless the n numbers are finite, and x is a placement; `where` begins the message.
void check_finite(const std::string& where, const double* x, std::size_t n);
SE3<double> check_placement(const std::string& where, const Placement& x);
std::string number(double x);          // six digits, independent of the locale
Mat3<double> z_to(const Axis& a);      // smallest rotation that takes z to the unit vector a

}  // namespace dyn
