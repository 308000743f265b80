// Makes a model: joints, bodies, frames, shapes, configurations; finish() compiles them into one immutable block.
// Host side: allocates and throws dyn::Error. Everything is checked when it is added; what only the whole can show
// (cycles of mimic, masses that leave forward dynamics undefined) is checked by finish().
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "dyn.h"
#include "effect/driver.hpp"
#include "model/compliance.hpp"
#include "model/pair_filter.hpp"
#include "shape/material.hpp"

namespace dyn {

struct Model;
struct SurfaceData;

// An error on its way to the C boundary: the status and one sentence saying what, where, and what to do.
struct Error : std::runtime_error {
  dynStatus status;
  Error(dynStatus s, const std::string& message) : std::runtime_error(message), status(s) {}
};

using Placement = std::array<double, 12>;  // rotation by columns, then translation
inline constexpr Placement identity_placement = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

// Where something is attached: a name, and optionally which types of frame (a mask of dynFrameType, 0: any) may answer to it.
struct Parent {
  std::string name;  // "" or "universe": the world
  int types = 0;
};

// Field meanings and units are those of dynJointSpec in dyn.h; an empty vector means "absent".
struct JointSpec {
  std::string name;
  dynJointType type = DYN_JOINT_TYPE_REVOLUTE;
  Parent parent;
  Placement placement = identity_placement;
  std::array<double, 3> axis = {0, 0, 1}, axis2 = {1, 0, 0};
  double pitch = 0;
  std::vector<double> lower, upper;                // nq
  std::vector<double> velocity, effort;            // nv
#define COEFFICIENT(name, has, sentence) std::vector<double> name;  // nv
#include "effect/coefficients.def"
  std::vector<double> spring_reference;            // nq
  double rotor_inertia = 0, gear_ratio = 1;
  std::string mimic;  // leader's name; "" for none
  double mimic_ratio = 1, mimic_offset = 0;
  std::vector<JointSpec> parts;  // composite
  Compliance compliance = {}, friction_compliance = {};  // of its limits, of its dry friction
};

// How a medium acts on a shape, as dyn_builder_set_shape_fluid.
struct FluidShape {
  std::array<double, 5> coefficients = {0.5, 0.25, 1.5, 1, 1};  // MuJoCo's
  std::array<double, 3> semiaxes = {0, 0, 0};
  Placement placement = identity_placement;  // in the link's frame
};

struct Shape {
  std::string name;
  dynShapeType type = DYN_SHAPE_TYPE_BOX;
  dynShapeRole role = DYN_SHAPE_ROLE_COLLISION;
  std::string body;
  Placement placement = identity_placement;
  std::array<double, 3> size = {0, 0, 0};
  std::string mesh;
  double radius = 0;                           // of rounding
  std::uint32_t contype = 1, conaffinity = 1;  // groups it is in, groups it collides with
  shape::ShapeMaterial material = {shape::default_material()};
  std::shared_ptr<const SurfaceData> surface = nullptr;  // of CONVEX, TRIANGLES and HEIGHT_FIELD (builder_surface.hpp)
  std::uint32_t colour = 0;                              // colour.hpp
  PairFilter filter = PairFilter::Guess;
  Compliance compliance = {};
  std::optional<FluidShape> fluid = std::nullopt;
};

// An element of a tendon, as dynTendonElement.
struct TendonElement {
  dynTendonElementType type = DYN_TENDON_ELEMENT_TYPE_SITE;
  std::string name, side = {};
  double value = 1;
};

// What a named configuration states beside q. Joints and actuators that are not named: zero.
struct ConfigurationState {
  struct Actuator {
    std::array<double, 3> control{};
    std::array<double, max_activations> activation = {};
  };
  std::vector<std::pair<std::string, std::vector<double>>> v;  // by joints
  std::vector<std::pair<std::string, Actuator>> actuators;
  std::vector<std::pair<std::string, Placement>> mocaps;  // none: as in the model
  double time = 0;
};

// A quantity of one object, as dynParameter. set throws for numbers that are refused, and then changes nothing.
struct Parameter {
  dynParameterGroup group;
  const char* object;
  std::string name;
  const char* quantity;
  std::vector<double> values;
  std::function<std::vector<double>()> get;
  std::function<void(const std::vector<double>&)> set;
};

// nq and nv of a type with no parts.
int joint_nq(dynJointType type);
int joint_nv(dynJointType type);
// The same of a joint with its parts.
int spec_nq(const JointSpec& spec);
int spec_nv(const JointSpec& spec);

struct ModelDeleter {
  void operator()(Model* m) const;
};
using ModelPtr = std::unique_ptr<Model, ModelDeleter>;

class Builder {
 public:
  explicit Builder(std::string name);
  // With all that the model was made from: finished at once, it makes the same model.
  explicit Builder(const Model& model);
  ~Builder();
  Builder(const Builder&) = delete;
  Builder& operator=(const Builder&) = delete;

  void gravity(const std::array<double, 3>& g);
  // The parent must have been added before. A FIXED joint becomes a frame of type FIXED_JOINT.
  void joint(const JointSpec& spec);
  // A link at placement in its parent's frame: adds a BODY frame and the inertia (about the centre of mass, frame axes,
  // 3 x 3) to the joint that carries it. Throws for a negative mass and for a non-symmetric inertia, naming the body; what
  // the bodies of a joint add up to is checked by finish().
  void body(const std::string& name, const Parent& parent, const Placement& placement, double mass,
            const std::array<double, 3>& com, const std::array<double, 9>& inertia);
  void frame(const std::string& name, const Parent& parent, const Placement& placement, dynFrameType type);
  void shape(const Shape& shape);
  void colour(std::uint32_t of_last_shape);
  // Of the last shape, too; semiaxes zero: those of its size; no placement: the shape's. (builder_fluid.cpp)
  void fluid(FluidShape of_last_shape, const std::optional<Placement>& placement = std::nullopt);
  void configuration(const std::string& name, const std::vector<double>& q);
  // The same by joints, each with its own coordinates; the others are neutral.
  void configuration_of_joints(const std::string& name, const std::vector<std::pair<std::string, std::vector<double>>>& joints,
                               const ConfigurationState& state = {});
  // Where new data begins: the name of a configuration.
  void initial_configuration(const std::string& name);
  // dt and integrator of new data, and the effects that the model states (DYN_EFFECT_AS_STATED).
  void stepping(double dt, dynIntegrator integrator, std::uint32_t effects);
  // Two bodies that are not tested for collision.
  void disabled_pair(const std::string& body1, const std::string& body2, const std::string& reason);
  void report(dynReportLevel level, int line, const std::string& message);
  // first and second name frames, or joints; "": the universe, or none.
  void constraint(const std::string& name, const dynConstraint& spec, const Parent& first, const Parent& second,
                  const Compliance& compliance = {});
  void allow_massless_joints();  // finish() reports joints that move no inertia; without this it throws
  void constraint_slots(int spare);
  void contact_capacity(int contacts);  // of a step; 0: by its shapes
  // (builder_tendon.cpp)
  void tendon(const std::string& name, const dynTendon& spec, const std::vector<TendonElement>& elements,
              const Compliance& compliance = {}, const Compliance& friction = {});
  void couple_tendons(const std::string& name, const std::string& tendon1, const std::string& tendon2,
                      const std::array<double, 5>& coefficients, const Compliance& compliance = {});
  // target: the name of a joint, tendon or frame; reference: of a frame, or "". (builder_actuator.cpp)
  void actuator(const std::string& name, const dynActuator& spec, const std::string& target, const std::string& reference = "");
  // object: the name of a joint, tendon, actuator or frame, by spec.quantity; reference: of a frame, or "". (builder_sensor.cpp)
  void sensor(const std::string& name, const dynSensor& spec, const std::string& object, const std::string& reference = "");
  // Of the sum of the actuators on a joint or a tendon. with_weight: and of the weight that is held for the joint.
  void limit_actuators(bool tendon, const std::string& target, double lower, double upper, bool with_weight);
  void gravity_compensation(const std::string& body, double share);
  void mocap(const std::string& body);  // a link fixed to the world, whose pose data sets
  void medium(double density, double viscosity, const std::array<double, 3>& wind);
  // Two collision shapes, by their names, that are tested whatever the filter says. material: nullptr, that of the shapes.
  void pair(const std::string& shape1, const std::string& shape2, const dynMaterial* material,
            const Compliance& compliance = {});
  // The model states compliances: of what is added, the defaults where it is silent. impratio, pyramidal: of MuJoCo's cones.
  void compliant(double impratio, bool pyramidal);

  // Operations on the whole; one that throws changes nothing. (builder_lock.cpp, builder_attach.cpp, builder_subtree.cpp)
  // Fixes joints, and their followers, at q (nq numbers in the order of the model that would be made).
  void lock(const std::vector<std::string>& joints, const std::vector<double>& q);
  // Adds a model whose world the joint carries (nullptr: the worlds are one), its names behind the prefix.
  void attach(const Model& model, const std::string& prefix, const JointSpec* joint);
  // Keeps a joint and what it carries; the world is then where the joint's parent was.
  void subtree(const std::string& joint);
  // Takes away a joint and what it carries.
  void remove(const std::string& joint);

  // Numbers of what was added. The list is made when it is asked for, and good until the builder changes otherwise.
  // (builder_parameters.cpp)
  const std::vector<Parameter>& parameters();
  void set_parameter(std::size_t index, const std::vector<double>& values);
  void forget_parameters() { parameters_.clear(); }

  // Compiles: joints depth first, children in the order of addition.
  ModelPtr finish() const;

 private:
  friend struct Compiler;
  friend class ParameterLister;
  struct Impl;
  std::unique_ptr<Impl> impl;
  std::vector<Parameter> parameters_;  // empty: not listed
};

// Semiaxes in a medium of a shape of this size; zeros where its type gives none.
std::array<double, 3> fluid_semiaxes(dynShapeType type, const double* size);

// Throws where no body has these principal moments; who begins the message. (Files say so in their report, or under strict.)
void check_moments(const std::string& who, double mass, const std::array<double, 9>& inertia);

}  // namespace dyn
