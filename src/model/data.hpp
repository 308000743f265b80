// What the robot is doing: every buffer that the modules declare (data_fields.def), laid out once in one 64-byte aligned arena.
#pragma once

#include <algorithm>

#include "constraint/constraint_instance.hpp"
#include "effect/applied_wrench.hpp"
#include "model/model.hpp"
#include "spatial/inertia_rate.hpp"
#include "spatial/moments.hpp"

namespace dyn {

// Types of buffers that upper modules define. simulation/data_layout.hpp knows their sizes.
namespace collision {
struct EpaWorkspace;
struct Geom;
struct Masks;
struct PlacedHull;
struct Result;
}  // namespace collision
namespace simulation {
struct StepDerivatives;
struct Workspace;
}
// A force along a path that a step takes at its end: force - stiffness h l' - damping (l' - l'_0) - armature (l' - l'_0) / h,
// within its range, with l' the rate at the end and l'_0 that at the beginning.
template <class T>
struct PathForce {
  T force, stiffness, damping, armature, lower, upper;
  Index acts;  // 1: as a row of the step; 0: it was added to tau, or there is none
};
template <class T> struct Composite;
template <class T> struct Contraction;
template <class T> struct SecondOrderRows;

// What is computed, and from what: a field is fresh when its stage was computed for the current versions of its inputs.
enum class Stage : Index {
#define STAGE(name, inputs) name,
#include "model/data_fields.def"
  count_
};

enum Input : Index { input_q, input_v, input_a, input_tau, input_count };

// Which inputs each stage depends on: a bit each.
inline constexpr unsigned stage_inputs(Stage s) {
  [[maybe_unused]] constexpr unsigned Q = 1, V = 2, A = 4, TAU = 8;
  constexpr unsigned inputs[] = {
#define STAGE(name, inputs) inputs,
#include "model/data_fields.def"
  };
  return inputs[std::size_t(s)];
}

// First expanded degree of freedom at or after body i.
inline Index first_dof(const Model& m, Index i) { return i < m.n.bodies ? m.bodies()[i].idx_v : m.n.nvx; }

// Inertial parameters of all joints' bodies.
inline Index parameter_count(const Model& m) { return 10 * (m.n.joints - 1); }
// The public fields, in the order of data_fields.def: their ids.
enum class FieldId : Index {
#define FIELD(name, rows, cols, part, stage, unit, frame, producer, sentence) name,
#include "model/data_fields.def"
  count_
};

template <class T>
struct Data {
#define FIELD(name, rows, cols, part, stage, unit, frame, producer, sentence) T* name;
#define BUFFER(type, name, count, part, sentence) type* name;
#include "model/data_fields.def"

  simulation::Workspace* step;                       // in step_memory
  simulation::StepDerivatives* derivatives;          // in derivative_memory
  dynParts parts;
  std::uint32_t acting;  // DYN_EFFECT_... that are switched on at a joint which has them, and pushed
  std::uint32_t pushed;  // acting_wrenches when there are any; acting_friction_rows where steps have them
  std::uint32_t rows_dropped;  // 1: some constraint may have redundant rows that are left out; else none has
  std::uint64_t version[input_count];                // of q, v, a, tau: a number larger than all before when the value changes
  std::uint64_t
      stamp[std::size_t(Stage::count_)];  // the newest of the versions that each stage was computed for; 0: not computed

  bool has(dynParts p) const { return p == 0 || (parts & p) != 0; }
  bool fresh(Stage s) const { return s == Stage::State || stamp[std::size_t(s)] == newest(s); }
  void mark_fresh(Stage s) { stamp[std::size_t(s)] = newest(s); }
  void invalidate(Stage s) { stamp[std::size_t(s)] = 0; }
  // Tells the inputs of a stage apart: none can change without a version that is newer than all others.
  std::uint64_t newest(Stage s) const {
    const unsigned inputs = stage_inputs(s);
    std::uint64_t n = 0;
    for (int i = 0; i < input_count; ++i)
      if ((inputs >> i & 1u) && version[i] > n) n = version[i];
    return n;
  }

  // An input was written.
  void changed(Input input) { version[input] = *std::max_element(version, version + input_count) + 1; }

  // Coordinates as the recursions read them: followers of a mimic have their own entries.
  const T* expand_q(const Model& m) const {
    if (!m.has_mimic) return q;
    for (Index k = 0; k < m.n.nqx; ++k) qx[k] = T(m.ratio_q()[k]) * q[m.expand_q()[k]] + T(m.offset_q()[k]);
    return qx;
  }
  const T* expand(const Model& m, const T* x, T* expanded) const {
    if (!m.has_mimic) return x;
    for (Index k = 0; k < m.n.nvx; ++k) expanded[k] = T(m.ratio_v()[k]) * x[m.expand_v()[k]];
    return expanded;
  }
  // the transpose of expand: x_leader += ratio x_follower
  void reduce(const Model& m, const T* expanded, T* x) const {
    for (Index k = 0; k < m.n.nv; ++k) x[k] = T(0);
    for (Index k = 0; k < m.n.nvx; ++k) x[m.expand_v()[k]] += T(m.ratio_v()[k]) * expanded[k];
  }
};

// Parts with what they imply.
inline constexpr dynParts complete_parts(dynParts p) {
  if (p == 0) p = DYN_PART_ALL;
  if (p & DYN_PART_STEP_DERIVATIVES) p |= DYN_PART_SIMULATION | DYN_PART_MINV | DYN_PART_INVERSE_DERIVATIVES;
  if (p & DYN_PART_SIMULATION) p |= DYN_PART_FORWARD;
  if (p & DYN_PART_CONSTRAINT_DERIVATIVES) p |= DYN_PART_CONSTRAINTS | DYN_PART_FORWARD_DERIVATIVES;
  if (p & DYN_PART_CONSTRAINTS) p |= DYN_PART_FORWARD | DYN_PART_INVERSE | DYN_PART_KINEMATICS;
  if (p & DYN_PART_SECOND_ORDER) p |= DYN_PART_INVERSE_DERIVATIVES;
  if (p & DYN_PART_FORWARD_DERIVATIVES) p |= DYN_PART_MINV | DYN_PART_INVERSE_DERIVATIVES;
  if (p & DYN_PART_INVERSE_DERIVATIVES) p |= DYN_PART_INVERSE | DYN_PART_MASS;
  if (p & DYN_PART_MINV) p |= DYN_PART_CHOLESKY | DYN_PART_FORWARD;
  if (p & DYN_PART_CHOLESKY) p |= DYN_PART_MASS;
  if (p & DYN_PART_IK) p |= DYN_PART_COM;
  if (p & (DYN_PART_JACOBIANS | DYN_PART_COM | DYN_PART_CORIOLIS | DYN_PART_ENERGY | DYN_PART_FRAMES |
           DYN_PART_CENTROIDAL | DYN_PART_REGRESSOR | DYN_PART_IK | DYN_PART_COLLISION)) p |= DYN_PART_KINEMATICS;
  return p;
}

inline dynParts complete_parts(const Model& m, dynParts p) {
  p = complete_parts(p);
  if ((p & DYN_PART_SIMULATION) && m.n.slots + m.n.contacts + m.n.limits + m.n.path_rows + m.n.friction_rows > 0)
    p = complete_parts(p | DYN_PART_CONSTRAINTS | (m.n.contacts > 0 ? DYN_PART_COLLISION : 0));
  if ((p & DYN_PART_SIMULATION) && m.n.drag_boxes + m.n.fluid_ellipsoids > 0) p = complete_parts(p | DYN_PART_KINEMATICS);
  return m.has_mimic && (p & (DYN_PART_CONSTRAINTS | DYN_PART_SIMULATION)) ? complete_parts(p | DYN_PART_CHOLESKY) : p;
}

// Bytes of the arena (a multiple of 64). possible: parts that a program may ask for, with what they imply. Where flash is small
// it is a few, and what lays out the others is left out. simulation/data_layout.hpp defines both functions.
template <class T, dynParts possible = DYN_PART_ALL>
std::size_t data_bytes(const Model& m, dynParts parts);

// Lays the buffers out in memory (64-byte aligned, data_bytes of zeros) and sets the neutral state at rest.
template <dynParts possible = DYN_PART_ALL, class T>
void data_layout(const Model& m, dynParts parts, void* memory, Data<T>& d);

}  // namespace dyn
