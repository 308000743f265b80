// Algorithms of a control cycle through dyn.h, each in many states: results for comparison, and the work of every call. No heap
// and no files: the same source on boards and on a PC.
#pragma once

#include "boards/dice.hpp"
#include "dyn.h"

namespace boards {

// CHOLESKY: of ABA with mimic joints
constexpr dynParts worst_parts = DYN_PART_INVERSE | DYN_PART_FORWARD | DYN_PART_CHOLESKY | DYN_PART_JACOBIANS;
constexpr dynParts worst_parts_of_steps = worst_parts | DYN_PART_SIMULATION;
constexpr int worst_states = 20, worst_steps = 60, worst_iterations = 50;

// clock(name, call) runs call and returns its status. start: of steps above a floor, with random velocities and torques; nullptr:
// none.
template <class Out, class Clock>
dynStatus worst_figures(const dynModel* m, dynData* d, const double* start, Out&& out, Clock&& clock) {
  constexpr int most = 48;
  static double q[most], v[most], a[most], tau[most], x[most * most];
  const int nq = dyn_model_nq(m), nv = dyn_model_nv(m), frame = dyn_model_nframes(m) - 1;
  if (nq > most || nv > most) return DYN_ERROR_LIMIT;
  Dice dice;
  dynStatus status = DYN_OK;
  // one algorithm in every state; results of the last one
  auto measure = [&](const char* name, int results, auto&& call) {
    for (int k = 0; k < worst_states && !status; ++k) {
      status = dyn_configuration_random(m, std::uint64_t(k), nullptr, nullptr, q);
      for (int i = 0; i < nv; ++i) v[i] = dice(), a[i] = dice(), tau[i] = 10 * dice();
      if (!status) status = clock(name, call);
    }
    for (int i = 0; i < results; ++i) out(x[i]);
  };
  measure("gravity compensation", nv, [&] { return dyn_gravity_torque(m, d, q, x); });
  measure("RNEA", nv, [&] { return dyn_rnea(m, d, q, v, a, nullptr, x); });
  measure("ABA", nv, [&] { return dyn_aba(m, d, q, v, tau, nullptr, x); });
  measure("CRBA", nv * nv, [&] { return dyn_crba(m, d, q, x); });
  measure("kinematics and Jacobian of a frame", 6 * nv, [&] {
    const dynStatus s = dyn_joint_jacobians(m, d, q, nullptr);
    return s ? s : dyn_frame_jacobian(m, d, frame, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, x);
  });
  if (!start || status) return status;

  dynStepOptions options;
  dyn_step_options_init(&options);
  options.max_iterations = worst_iterations;
  status = dyn_data_set_step_options(m, d, &options);
  for (int i = 0; i < nv; ++i) v[i] = 0.2 * dice();
  dynStepReport report;
  report.struct_size = sizeof report;
  int contacts = 0;
  for (int k = 0; k < worst_steps && !status; ++k) {
    for (int i = 0; i < nv; ++i) tau[i] = 2 * dice();
    status = k ? dyn_data_set_state(m, d, nullptr, nullptr, nullptr, tau) : dyn_data_set_state(m, d, start, v, nullptr, tau);
    if (!status) status = clock("step with contact", [&] { return dyn_step(m, d); });
    if (!status) status = dyn_data_step_report(m, d, &report);
    contacts = report.contacts > contacts ? report.contacts : contacts;
  }
  out(contacts);
  return status;
}

}  // namespace boards
