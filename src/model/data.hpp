// What the robot is doing: every buffer, laid out once in one 64-byte aligned arena. Generated from data_fields.def.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "base/sincos.hpp"
#include "collision/geom.hpp"
#include "constraint/constraint_instance.hpp"
#include "model/model.hpp"
#include "simulation/wrench.hpp"
#include "spatial/inertia_rate.hpp"
#include "spatial/moments.hpp"

namespace dyn {

// Of steps (simulation/workspace.hpp), in the memory given, aligned to 64 bytes.
namespace simulation {
struct Workspace;
std::size_t workspace_bytes(const Model& m);
Workspace* place(const Model& m, void* memory);
dynStepOptions default_options();
}  // namespace simulation

// What is computed, and from what: a field is fresh when its stage was computed for the current versions of its inputs.
enum class Stage : Index {
  State, Position, Velocity, Acceleration, Frames, Jacobians, DJacobians, Com, Vcom, Acom, Jcom, Tau, Nle, Gravity, Static, Ddq,
  Mass, Factor, Minv, Coriolis, Kinetic, Potential, Mechanical,
  InverseDerivatives, ForwardDerivatives, GravityDerivatives, StaticDerivatives, ComDerivatives, SecondOrder,
  CentroidalMap, CentroidalMapRate, CentroidalMomentum, CentroidalMomentumRate, CentroidalDerivatives, CentroidalRateDerivative,
  Distances,
  TorqueRegressor, StaticRegressor, KineticRegressor, PotentialRegressor,
  ConstrainedDdq,
  count_
};

enum Input : Index { input_q, input_v, input_a, input_tau, input_count };

// which inputs each stage depends on: a bit each
inline constexpr unsigned stage_inputs(Stage s) {
  constexpr unsigned Q = 1, V = 2, A = 4, TAU = 8;
  switch (s) {
    case Stage::State: return 0;
    case Stage::Velocity: case Stage::DJacobians: case Stage::Vcom: case Stage::Nle: case Stage::Coriolis: case Stage::Kinetic:
    case Stage::Mechanical: return Q | V;
    case Stage::CentroidalMapRate: case Stage::CentroidalMomentum: case Stage::CentroidalDerivatives: case Stage::KineticRegressor:
    case Stage::ComDerivatives:
      return Q | V;
    case Stage::CentroidalMomentumRate: case Stage::CentroidalRateDerivative: case Stage::TorqueRegressor: return Q | V | A;
    case Stage::Acceleration: case Stage::Acom: case Stage::Tau: case Stage::InverseDerivatives:
    case Stage::SecondOrder: return Q | V | A;
    case Stage::Ddq: case Stage::ForwardDerivatives: case Stage::ConstrainedDdq: return Q | V | TAU;
    default: return Q;
  }
}

// Numbers of degrees of freedom in whole tiles of four (algorithm/tiles.hpp).
inline std::ptrdiff_t padded_tiles(std::ptrdiff_t n) { return (n + 3) / 4 * 4; }

// And in whole packs of eight (algorithm/cholesky.hpp).
inline std::ptrdiff_t padded_factor(const Model& m) { return (std::ptrdiff_t(m.n.nv) + 7) & ~std::ptrdiff_t(7); }

// Of an integrator: q at the beginning of a step, the state there and in a stage, and its rate in up to 12 stages.
inline std::ptrdiff_t integrator_stage_count(std::ptrdiff_t nq, std::ptrdiff_t nv, std::ptrdiff_t na) { return nq + (2 * nv + na) * (2 + 12); }

// First expanded degree of freedom at or after body i.
inline Index first_dof(const Model& m, Index i) { return i < m.n.bodies ? m.bodies()[i].idx_v : m.n.nvx; }

// Inertial parameters of all joints' bodies.
inline Index parameter_count(const Model& m) { return 10 * (m.n.joints - 1); }
// Room for one component of all columns of S, to be read eight at a time.
inline std::ptrdiff_t padded_regressor(const Model& m) { return (std::ptrdiff_t(m.n.nvx) + 14) / 8 * 8; }

// The public fields, in the order of data_fields.def: their ids.
enum class FieldId : Index {
#define FIELD(name, rows, cols, part, stage, unit, frame, producer, sentence) name,
#include "model/data_fields.def"
  count_
};

// Sums over a subtree, at the tree's root in world axes.
template <class T>
struct Composite {
  Moments<T> Y;
  MomentRates<T> rates;
  Force<T> f;
};

// Sums over a subtree of what the motion with the velocities lambda of second derivatives adds, at the tree's root in world axes.
template <class T>
struct Contraction {
  MomentRates<T> rates;
  Vec3<T> Q;
};

// Four columns each of S, psi', psi'', W, by components.
template <class T>
struct SecondOrderRows {
  alignas(4 * sizeof(T)) T S[24], dS[24], ddS[24], W[24];
};

template <class T>
struct Data {
#define FIELD(name, rows, cols, part, stage, unit, frame, producer, sentence) T* name;
#define BUFFER(type, name, count, part, sentence) type* name;
#include "model/data_fields.def"

  simulation::Workspace* step;                       // in step_memory
  dynParts parts;
  std::uint32_t acting;                              // DYN_EFFECT_... that are switched on at a joint which has them, and acting_wrenches
  std::uint32_t pushed;                              // acting_wrenches when there are any
  std::uint64_t version[input_count];                // of q, v, a, tau: a number larger than all before when the value changes
  std::uint64_t stamp[std::size_t(Stage::count_)];  // the newest of the versions that each stage was computed for; 0: not computed

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

// Of a search for pairs by boxes (collision/pair_search.hpp), in the memory given, aligned to 64 bytes.
namespace collision {
struct PairSearch;
std::size_t search_bytes(const Model& m);
}  // namespace collision

// Parts with what they imply.
inline constexpr dynParts complete_parts(dynParts p) {
  if (p == 0) p = DYN_PART_ALL;
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
  if ((p & DYN_PART_SIMULATION) && m.n.slots + m.n.contacts + m.n.limits > 0) p = complete_parts(p | DYN_PART_CONSTRAINTS | (m.n.contacts > 0 ? DYN_PART_COLLISION : 0));
  if ((p & DYN_PART_SIMULATION) && m.n.drag_boxes > 0) p = complete_parts(p | DYN_PART_KINEMATICS);
  return m.has_mimic && (p & (DYN_PART_CONSTRAINTS | DYN_PART_SIMULATION)) ? complete_parts(p | DYN_PART_CHOLESKY) : p;
}

// Bytes of the arena (a multiple of 64). possible: parts that a program may ask for, with what they imply; where memory for code is dear, a few:
// what lays out the others is then left out.
template <class T, dynParts possible = DYN_PART_ALL>
std::size_t data_bytes(const Model& m, dynParts parts);

// The model's constraints in their slots (model/constraints.hpp).
template <class T>
void set_up_constraints(const Model& m, Data<T>& d);

// Lays the buffers out in memory (64-byte aligned, data_bytes long) and sets the neutral state at rest.
template <dynParts possible = DYN_PART_ALL, class T>
void data_layout(const Model& m, dynParts parts, void* memory, Data<T>& d);

namespace detail {
template <dynParts possible, class T, class Visit>
inline void for_each_buffer(const Model& m, dynParts parts, Data<T>& d, Visit visit) {
  const std::ptrdiff_t nq = m.n.nq, nv = m.n.nv, nframes = m.n.frames, nparameters = parameter_count(m), npairs = m.n.pairs,
                       nrows = m.n.constraint_rows, nu = m.n.nu, na = m.n.na, nactuators = m.n.actuators;
  (void)nq, (void)nv, (void)nframes, (void)nparameters, (void)npairs, (void)nrows, (void)nu, (void)na, (void)nactuators;
#define FIELD(name, rows, cols, part, stage, unit, frame, producer, sentence) \
  visit(d.name, (part) == 0 || (parts & possible & (part)) ? std::size_t(rows) * std::size_t(cols) : 0);
#define BUFFER(type, name, count, part, sentence) visit(d.name, (part) == 0 || (parts & possible & (part)) ? std::size_t(count) : 0);
#include "model/data_fields.def"
}
}  // namespace detail

template <class T, dynParts possible>
std::size_t data_bytes(const Model& m, dynParts parts) {
  Data<T> unused;
  std::size_t bytes = 0;
  detail::for_each_buffer<possible>(m, complete_parts(m, parts), unused,
                          [&](auto*& p, std::size_t count) { bytes += (count * sizeof(*p) + 63) / 64 * 64; });
  return bytes;
}

// Fills in the coefficients of the effects that are switched on.
template <class T>
void apply_effects(const Model& m, Data<T>& d) {
  const struct {
    std::uint32_t bit;
    const double* from;
    T* to;
  } rows[] = {{DYN_EFFECT_ARMATURE, m.armature(), d.armature}, {DYN_EFFECT_DAMPING, m.damping(), d.damping},
              {DYN_EFFECT_SPRINGS, m.stiffness(), d.stiffness}, {DYN_EFFECT_FRICTION, m.friction(), d.friction}};
  d.acting = d.pushed;
  const auto on = [&](Index joint, std::uint32_t bit) { d.acting |= d.effects[joint] & bit; };
  for (Index k = 0; k < m.n.actuators && d.has(DYN_PART_SIMULATION); ++k) on(m.actuators()[k].spec.joint, DYN_EFFECT_ACTUATORS);
  for (Index k = 0; k < m.n.gravity_compensations && d.has(DYN_PART_SIMULATION); ++k) on(m.gravity_compensations()[k].joint, DYN_EFFECT_GRAVITY_COMPENSATION);
  for (Index k = 0; k < m.n.drag_boxes && d.has(DYN_PART_SIMULATION); ++k) on(m.drag_boxes()[k].joint, DYN_EFFECT_FLUID);
  for (Index j = 1; j < m.n.joints; ++j)
    for (Index k = m.joints()[j].idx_v, end = k + m.joints()[j].nv; k < end; ++k)
      for (const auto& r : rows) {
        if (!r.to) continue;
        r.to[k] = d.effects[j] & r.bit ? T(r.from[k]) : T(0);
        if (r.to[k] != T(0)) d.acting |= r.bit;
      }
  for (Index k = 0; k < m.n.limits; ++k)
    if (d.effects[m.bodies()[m.limits()[k].body].joint] & DYN_EFFECT_LIMITS) d.acting |= DYN_EFFECT_LIMITS;
  const bool rests = d.has(DYN_PART_SIMULATION) && !m.has_mimic && m.n.slots + m.n.contacts + m.n.limits > 0;
  for (Index j = 1; rests && j < m.n.joints; ++j) on(j, DYN_EFFECT_SLEEPING);
}

template <dynParts possible, class T>
void data_layout(const Model& m, dynParts parts, void* memory, Data<T>& d) {
  static_assert(complete_parts(possible) == possible);
  char* at = static_cast<char*>(memory);
  d.parts = complete_parts(m, parts);
  detail::for_each_buffer<possible>(m, d.parts, d, [&](auto*& p, std::size_t count) {
    using E = std::remove_reference_t<decltype(*p)>;
    p = count ? reinterpret_cast<E*>(at) : nullptr;
    const std::size_t room = (count * sizeof(E) + 63) / 64 * 64;
    std::memset(at, 0, room);
#if DYN_CHECKED
    // whatever is read before it was computed shows
    for (std::size_t i = 0; i < count * sizeof(E) / sizeof(T); ++i) reinterpret_cast<T*>(at)[i] = T(NAN);
#endif
    at += room;
  });
  for (Index i = 0; i < m.n.nq; ++i) d.q[i] = T(m.neutral()[i]);
  for (Index i = 0; i < m.n.nv; ++i) d.v[i] = d.a[i] = d.tau_applied[i] = T(0);
  for (Index i = 0; i < m.n.nvx; ++i) d.zero[i] = T(0);
  d.time[0] = T(0);
  for (int k = 0; k < 3; ++k) d.world_gravity[k] = T(m.gravity[k]);
  for (Index k = 0; k < (d.ctrl ? m.n.nu : 0); ++k) d.ctrl[k] = T(0);
  for (Index k = 0; k < (d.act ? m.n.na : 0); ++k) d.act[k] = T(0);
  for (Index k = 0; k < (d.actuator_force ? m.n.actuators : 0); ++k) d.actuator_force[k] = T(0);
  for (Index k = 0; k < (d.wrenches ? m.n.joints : 0); ++k) d.wrenches[k] = simulation::AppliedWrench<T>::none();
  d.pushed = 0;
  d.step = nullptr;
  if constexpr (possible & DYN_PART_SIMULATION)
    if (d.step_memory) d.step = simulation::place(m, d.step_memory);
  // entries of unrelated joints are zero for good, and those of joints that do not carry the body
  for (T* x : {d.M, d.coriolis, d.dtau_dq, d.dtau_dv, d.dg_dq, d.dstatic_torque_dq, d.lambda_d2tau_dqdq, d.lambda_d2tau_dvdv, d.lambda_d2tau_dqdv,
               d.lambda_d2tau_dadq})
    if (x) std::fill_n(x, std::ptrdiff_t(m.n.nv) * m.n.nv, T(0));
  for (T* x : {d.Mx, d.dqx, d.dvx, d.d2x})
    if (x) std::fill_n(x, std::ptrdiff_t(m.n.nvx) * m.n.nvx, T(0));
  if (d.Linv) std::fill_n(d.Linv, m.n.nv * padded_factor(m), T(0));
  if (d.regressor) std::fill_n(d.regressor, std::ptrdiff_t(m.n.nv) * parameter_count(m), T(0));
  for (Index j = 0; j < m.n.joints; ++j) d.effects[j] = DYN_EFFECT_DEFAULT;
  apply_effects(m, d);
  if constexpr (possible & DYN_PART_COLLISION)
    if (d.geoms) collision::set_up(m, d);
  if constexpr (possible & DYN_PART_CONSTRAINTS)
    if (d.slots) set_up_constraints(m, d);
  d.R[0] = Mat3<T>::identity();
  for (Vec3<T>* x : {d.p, d.r, d.rel, d.w, d.u, d.dw, d.du, d.wd, d.al, d.ac, d.mw, d.mu, d.mdw, d.mdu})
    if (x) x[0] = Vec3<T>::zero();
  for (int k = 0; k < 3; ++k) d.extent[k] = T(0);
  for (auto& v : d.version) v = 1;
  for (auto& s : d.stamp) s = 0;
}

}  // namespace dyn

#include "model/constraints.hpp"
