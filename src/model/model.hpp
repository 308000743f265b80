// The compiled model: one block of plain values. The header below lies at its start; arrays are found by offsets, so the
// block can be copied, mapped, or sent to another process as it is.
#pragma once

#include <cstddef>
#include <cstdint>

#include "dyn.h"
#include "effect/driver.hpp"
#include "joint/body.hpp"
#include "model/compliance.hpp"
#include "model/pair_filter.hpp"
#include "model/stored.hpp"
#include "shape/height_field.hpp"
#include "shape/material.hpp"
#include "shape/triangles.hpp"

namespace dyn {

// A chain: each body is its predecessor's only child, except that the last one may have any children.
struct JointRun {
  BodyType type;
  Index first, last;   // bodies [first, last)
  Index parent;        // of the first
  Index idx_q, idx_v;  // of the first, in the expanded coordinates
};

// Bodies few enough that what their placing needs stays in the innermost cache.
struct CacheBlock {
  static constexpr Index size = 64;
  Index first;               // body
  Index first_run, last_run;
  Index first_q, last_q;     // expanded coordinates that hold its angles; the sweep's last four end within the array's padding
};

// Neighbouring coordinates, in q and in v, that form a vector space.
struct EuclideanSpan {
  Index first_q, first_v, count;
};

// Degrees of freedom in a row in the elimination tree of M: up to four, each but the last with the next one as its only child.
struct DofGroup {
  Index first, count;
  Index depth, parent;  // of the first
  Index end;            // one past their last descendant
};

struct JointRecord {
  Mat3<double> C;  // axes of the joint's own frame in the last body's internal frame (same origin)
  Index name;      // offset in text
  dynJointType type;
  Index parent;
  Index first_body, last_body;  // both included; of the universe: 0, 0
  Index idx_q, idx_v, nq, nv;
  Index leader;  // or -1
  double ratio, offset;
  double axis[3], axis2[3], pitch;
  double placement[12];
  Index first_part, parts;            // composite: its simple joints, in order; otherwise none
  // own, of a joint with one coordinate: a follower's are also part of its leader's
#define COEFFICIENT(name, has, sentence) double name;
#include "effect/coefficients.def"
  double spring_reference;
};

// A simple joint of a composite.
struct PartRecord {
  dynJointType type;
  double axis[3], axis2[3], pitch;
  double placement[12];  // after the part before
};

struct FrameRecord {
  SE3<double> X;  // in the body's internal frame
  Index name;
  dynFrameType type;
  Index joint, body;
  Index link;            // BODY: its number among the links; otherwise -1
  Index parent;          // the frame that it hangs on; of the universe: 0
  double placement[12];  // in the joint's frame
  Index place;           // its number among Data::R: the body, or n.bodies + the number of the mocap body that it is on
  Index padding;
};

// Of a link itself, in its frame.
struct LinkRecord {
  double mass, com[3], inertia[9];
};

// A weight that is held, at a point of the body.
struct GravityCompensation {
  Vec3<double> at;  // in the body's internal frame
  double mass;
  Index joint, body, link;
};

// The box of equal inertia, on which a medium drags.
struct DragBox {
  SE3<double> X;  // centre and principal axes in the body's internal frame
  double half[3];
  Index joint, body;
};

// A shape on which a medium acts as on an ellipsoid.
struct FluidEllipsoid {
  SE3<double> X;  // centre and axes in the body's internal frame
  double half[3];
  double coefficients[5];  // blunt, slender and angular drag, Kutta lift, Magnus force
  double added_mass[3], added_inertia[3];  // of a medium of density 1, along and about the axes
  double placement[12];                    // in the link's frame
  Index joint, body, shape, padding;
};

// Of an actuator: force = gain . controls + bias . (1, length, its rate).
struct ActuatorRecord {
  dynActuator spec;
  double gain[3], bias[3];
  Index name, q, v, act;  // the user's coordinate (or -1) and degree of freedom (or -1); of the activation, or -1
  Index path, row;        // what it acts through, and its number among those that do; or -1: a coordinate
  Index limit, padding;   // its number among force_limits, or -1
  double period;          // of a length that is an angle, for servos: l and l + period are the same; 0: none
};

// Limit of the sum of the actuators on a joint or a tendon; the other one is -1.
struct ForceLimitRecord {
  double range[2];
  Index joint, tendon, dof, with_weight;
};

struct TendonRecord {
  dynTendon spec;
  Index name, padding;
};

struct SensorRecord {
  dynSensor spec;
  Index name, padding;
};

// A length as a function of the configuration: of tendons, by their ids, of couplings, and of what else actuators act through.
enum class PathKind : Index { Fixed, Spatial, Site, Coupling, Axes, AxesInParent, SliderCrank, Adhesion };
inline constexpr Index path_rows_of_tendon = 3;  // of a step: its limit, its spring and damper, its friction
struct PathRecord {
  double wrench[6];   // SITE, AXES; SLIDER_CRANK: the rod
  double polynomial[5], neutral[2];  // COUPLING: l = L1 - neutral1 - p(L2 - neutral2)
  PathKind kind;
  Index first, elements;    // in path_elements
  Index first_dof, dofs;    // in path_dofs: the degrees of freedom that move it, and their ancestors in the elimination tree
  Index joint;              // whose effects it has: the only one that moves it, or 0
  Index angular;            // 1: a length in rad
  Index name;               // of a coupling
};
// An element of a path, with a frame or the coordinate of a joint.
struct PathElement {
  SE3<double> X;       // of the frame in its body's internal frame
  Vec3<double> side;   // the side's origin in its body's internal frame
  double value;
  dynTendonElementType type;
  Index id, body, place;      // joint or frame; -1: none. place: as in FrameRecord
  Index side_id, side_place;  // frame; -1: none
  Index q, dof;              // the user's
};

struct ShapeRecord {
  Index name, mesh;
  dynShapeType type : 5;
  std::uint32_t priority : 3;                                     // of the material, of 3 bits with a sign
  std::uint32_t role : 4, filter : 2, latent : 2, material : 16;  // dynShapeRole; PairFilter; its number among the materials
  std::uint32_t colour;                   // colour.hpp
  Index frame;
  Index surface;  // CONVEX, TRIANGLES, HEIGHT_FIELD: its number among the hulls, trees or grids; otherwise -1
  double placement[12], size[3];
  double radius;  // of rounding
  std::uint32_t contype, conaffinity;
};

// A coordinate with a finite limit; of a quaternion w, by whose lower limit cos(a/2) the angle of the rotation is at most a.
struct LimitRecord {
  Index q, body,
      dof;  // the user's coordinate; the body that it moves, its expanded degree of freedom (of a quaternion the first)
};

// A collision shape.
struct GeomRecord {
  Index shape;  // its number among all shapes
};

// Pairs are listed up to so many collision shapes; of more only those that are no ordinary ones: wanted, disabled, overlapping.
inline constexpr Index max_geoms = 1000;

// Two collision shapes (numbers of geoms, a < b) of different bodies that are not parent and child; ascending.
struct PairRecord {
  std::uint16_t a, b;
  std::uint8_t reason;  // dynPairReason: whether new data tests it
  std::uint8_t own;  // 0: the filter decides; else it is wanted: 1: with the material of its shapes, or 2 + the number of another
  static constexpr Index max_own = 253;
  bool wanted() const { return own > 0; }
  Index material() const { return own > 1 ? own - 1 : 0; }  // 1 + its own material's number; 0: that of its shapes
};

// Two links that are not tested for collision.
struct DisabledRecord {
  Index frame1, frame2, reason;
};

struct ReportRecord {
  dynReportLevel level;
  Index line, message;
};

// How simulations begin and step.
struct SimulationRecord {
  double dt = 1e-3;  // s
  dynIntegrator integrator = DYN_INTEGRATOR_SEMI_IMPLICIT_EULER;
  std::uint32_t effects = DYN_EFFECT_ALL & ~std::uint32_t(DYN_EFFECT_SLEEPING);  // of steps by DYN_EFFECT_AS_STATED
  Index initial = 0;  // configuration of new data
  Index padding = 0;
};

// A constraint of the model; its frames or joints are ids.
struct ConstraintRecord {
  dynConstraint spec;
  Index name;
};

struct ModelSizes {
  Index nq, nv;    // the user's coordinates
  Index nqx, nvx;  // expanded: followers of a mimic have their own
  Index mimic_q, mimic_v;  // nqx, nvx when there are followers, else 0
  Index bodies, joint_runs, cache_blocks, sweep, euclidean_spans, manifold_joints, joints, parts, frames, links, shapes, geoms,
      pairs, reports, configurations, text, disabled;
  Index hulls, trees, grids, surface_numbers, surface_indices;
  Index constraints, slots, constraint_rows;  // slots: with the spare ones; rows that fit into them
  Index materials;
  Index actuators, nu, na, gravity_compensations, drag_boxes;
  Index contacts, limits, carriers;  // contact points that a step has room for; degrees of freedom that carry two bodies, at most
  // since version 5 of .dynb
  Index tendons, couplings, paths, path_elements, path_dofs;  // paths: of tendons, of couplings, of actuators
  Index paths_in_space;  // of those: that need placements
  Index path_rows;  // that a step has room for: of each tendon, coupling, and actuator on a path
  Index mocaps;
  Index sensors, sensor_values;
  Index force_limits, adhesions;  // adhesions: paths of this kind
  Index compliances;  // 0: the model states none
  Index fluid_shapes, fluid_ellipsoids;  // fluid_ellipsoids: the first, that move
  Index friction_rows;  // degrees of freedom with dry friction, of models with compliances. The number of sizes is even
};

struct Model {
  static constexpr std::uint64_t magic_value = 0x31304c444f4d5944u;  // "DYMODL01"

  std::uint64_t magic;
  std::uint64_t bytes;
  std::uint64_t id;  // differs between any two models made in one process
  ModelSizes n;
  Index model_name;  // offset in text
  Index has_mimic;   // 1: some joint follows another
  std::uint32_t effects;  // DYN_EFFECT_... that some joint has
  Index groups;           // how many of dof_groups there are
  Index contact_capacity; // that was asked for; 0: by the shapes
  Index
      no_overflow;  // 1: masses, moments, pitches, ratios, armatures below 1e25: M is finite where all placements are below 1e100
  double gravity[3];
  double density, viscosity, wind[3];  // of the medium
  double total_mass;

  enum class Field : Index {
#define FIELD(type, name, count, sentence) name,
#include "model/model_fields.def"
#undef FIELD
    count_
  };
  std::uint32_t offset[std::size_t(Field::count_)];  // of arrays, by eights of bytes

#define FIELD(type, name, count, sentence)                                                   \
  const type* name() const {                                                                 \
    return reinterpret_cast<const type*>(reinterpret_cast<const char*>(this) +               \
                                         8 * std::size_t(offset[std::size_t(Field::name)])); \
  }
#include "model/model_fields.def"
#undef FIELD

  const char* string(Index at) const { return text() + at; }
  // nv, nu, na numbers of a named configuration, and its time.
  const double* configuration_state(Index k) const {
    return configuration_states() + std::ptrdiff_t(k) * (n.nv + n.nu + n.na + 1);
  }
  // Parts of compliances().
  const ComplianceRecord* geom_compliances() const { return compliances(); }
  const ComplianceRecord* limit_compliances() const { return compliances() + n.geoms; }
  const ComplianceRecord* constraint_compliances() const { return limit_compliances() + n.limits; }
  const ComplianceRecord* tendon_compliances() const { return constraint_compliances() + n.constraints; }
  const ComplianceRecord* coupling_compliances() const { return tendon_compliances() + n.tendons; }
  const ComplianceRecord* material_compliances() const { return coupling_compliances() + n.couplings; }
  // of dry friction
  const ComplianceRecord* dof_compliances() const { return material_compliances() + n.materials; }
  const ComplianceRecord* tendon_friction_compliances() const { return dof_compliances() + n.nv; }
  // Share of a link's weight that is held from outside.
  double compensation(Index link) const {
    for (const GravityCompensation *w = gravity_compensations(), *end = w + n.gravity_compensations; w != end; ++w)
      if (w->link == link) return w->mass / links()[link].mass;
    return 0;
  }
};

inline shape::ShapeMaterial material_of(const Model& m, const ShapeRecord& s) {
  constexpr int sign = -shape::least_priority;
  return {m.materials()[s.material], (int(s.priority) ^ sign) - sign, s.latent};
}

inline bool lists_pairs(const Model& m) { return m.n.geoms <= max_geoms; }

inline constexpr Index max_contacts = 1000000;  // that a step may have room for

}  // namespace dyn
