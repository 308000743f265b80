// Lays out Data: the one place that knows the types of all modules' buffers. data_layout.cpp instantiates it for double and all
// parts; a program with other scalars or fewer parts (microcontrollers) includes this file.
#pragma once

#include <cmath>
#include <cstring>
#include <type_traits>

#include "algorithm/composite.hpp"
#include "algorithm/padding.hpp"
#include "base/sincos.hpp"
#include "collision/geom.hpp"
#include "integrator/stepping.hpp"
#include "model/constraints.hpp"
#include "model/effects.hpp"
#include "simulation/mocap.hpp"

namespace dyn {

namespace collision {
std::size_t search_bytes(const Model& m);  // of a PairSearch (pair_search.hpp)
}
namespace simulation {
std::size_t workspace_bytes(const Model& m);
Workspace* place(const Model& m, Data<double>& d, void* memory);
std::size_t derivative_bytes(const Model& m);
StepDerivatives* place_derivatives(const Model& m, void* memory);
}  // namespace simulation

namespace detail {
template <dynParts possible, class T, class Visit>
inline void for_each_buffer(const Model& m, dynParts parts, Data<T>& d, Visit visit) {
  const std::ptrdiff_t nq = m.n.nq, nv = m.n.nv, nframes = m.n.frames, nparameters = parameter_count(m), npairs = m.n.pairs,
                       nrows = m.n.constraint_rows, nu = m.n.nu, na = m.n.na, nactuators = m.n.actuators, ntendons = m.n.tendons,
                       nmocaps = m.n.mocaps,
                       nsensordata = m.n.sensor_values;
  (void)nq, (void)nv, (void)nframes, (void)nparameters, (void)npairs, (void)nrows, (void)nu, (void)na, (void)nactuators,
      (void)ntendons, (void)nmocaps, (void)nsensordata;
#define FIELD(name, rows, cols, part, stage, unit, frame, producer, sentence) \
  visit(d.name, (part) == 0 || (parts & possible & (part)) ? std::size_t(rows) * std::size_t(cols) : 0);
#define BUFFER(type, name, count, part, sentence) \
  visit(d.name, (part) == 0 || (parts & possible & (part)) ? std::size_t(count) : 0);
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

template <dynParts possible, class T>
void data_layout(const Model& m, dynParts parts, void* memory, Data<T>& d) {
  static_assert(complete_parts(possible) == possible);
  char* at = static_cast<char*>(memory);
  d.parts = complete_parts(m, parts);
  detail::for_each_buffer<possible>(m, d.parts, d, [&](auto*& p, std::size_t count) {
    using E = std::remove_reference_t<decltype(*p)>;
    p = count ? reinterpret_cast<E*>(at) : nullptr;
#if DYN_CHECKED
    // whatever is read before it was computed shows
    for (std::size_t i = 0; i < count * sizeof(E) / sizeof(T); ++i) reinterpret_cast<T*>(at)[i] = T(NAN);
#endif
    at += (count * sizeof(E) + 63) / 64 * 64;
  });
  set_to_configuration(m, d, m.simulation()->initial);
  for (Index i = 0; i < m.n.nvx; ++i) d.zero[i] = T(0);
  for (int k = 0; k < 3; ++k) d.world_gravity[k] = T(m.gravity[k]);
  for (Index k = 0; k < (d.actuator_force ? m.n.actuators : 0); ++k) d.actuator_force[k] = T(0);
  for (Index k = 0; k < (d.path_forces ? m.n.path_rows : 0); ++k) d.path_forces[k].acts = 0;
  for (Index k = 0; k < (d.wrenches ? m.n.joints : 0); ++k) d.wrenches[k] = AppliedWrench<T>::none();
  d.pushed = 0, d.rows_dropped = 0;
  d.step = nullptr, d.derivatives = nullptr;
#if DYN_CHECKED
  // entries of unrelated joints are zero for good, and those of joints that do not carry the body
  for (T* x : {d.M, d.coriolis, d.dtau_dq, d.dtau_dv, d.dg_dq, d.dstatic_torque_dq, d.lambda_d2tau_dqdq, d.lambda_d2tau_dvdv,
               d.lambda_d2tau_dqdv, d.lambda_d2tau_dadq})
    if (x) std::fill_n(x, std::ptrdiff_t(m.n.nv) * m.n.nv, T(0));
  for (T* x : {d.Mx, d.dqx, d.dvx, d.d2x})
    if (x) std::fill_n(x, std::ptrdiff_t(m.n.nvx) * m.n.nvx, T(0));
  if (d.Linv) std::fill_n(d.Linv, m.n.nv * padded_factor(m), T(0));
  if (d.regressor) std::fill_n(d.regressor, std::ptrdiff_t(m.n.nv) * parameter_count(m), T(0));
  if constexpr (possible & DYN_PART_SIMULATION)
    if (d.step_memory) std::memset(d.step_memory, 0, simulation::workspace_bytes(m));
#endif
  if constexpr ((possible & DYN_PART_SIMULATION) && std::is_same_v<T, double>)
    if (d.step_memory) d.step = simulation::place(m, d, d.step_memory);
  if constexpr ((possible & DYN_PART_STEP_DERIVATIVES) && std::is_same_v<T, double>)
    if (d.derivative_memory) d.derivatives = simulation::place_derivatives(m, d.derivative_memory);
  for (Index j = 0; j < m.n.joints; ++j)
    d.chosen_effects[j] = DYN_EFFECT_DEFAULT, d.effects[j] = DYN_EFFECT_DEFAULT & DYN_EFFECT_ALL;
  apply_effects(m, d);
  if constexpr (possible & DYN_PART_COLLISION)
    if (d.geoms) collision::set_up(m, d);
  if constexpr (possible & DYN_PART_CONSTRAINTS)
    if (d.slots) set_up_constraints(m, d);
  place_mocaps<possible>(m, d, m.simulation()->initial);
  d.R[0] = Mat3<T>::identity();
  for (Vec3<T>* x : {d.p, d.r, d.rel, d.omega, d.vel, d.alpha, d.acc, d.omega_rnea, d.alpha_rnea, d.acc_rnea, d.omega_centroidal,
                     d.vel_centroidal, d.alpha_centroidal, d.acc_centroidal})
    if (x) x[0] = Vec3<T>::zero();
  for (int k = 0; k < 3; ++k) d.extent[k] = T(0);
  for (auto& v : d.version) v = 1;
  for (auto& s : d.stamp) s = 0;
}

}  // namespace dyn
