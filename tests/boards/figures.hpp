// Results that boards and a PC compute. One function for each image passes every result to out(x), and the work of each call to
// clock(name, calls, call). No heap and no files: the same source on both.
#pragma once

#include <cstring>

#include "algorithm/declarations.hpp"
#include "boards/dice.hpp"
#include "integrator/stepping.hpp"
#include "simulation/data_layout.hpp"
#include "simulation/sleep.hpp"
#include "simulation/workspace.hpp"

namespace boards {

using namespace dyn;

// A data of some parts, in the caller's memory.
template <dynParts parts>
struct Bench {
  const Model& m;
  Data<double> d;

  Bench(const Model& model, void* memory) : m(model) {
    std::memset(memory, 0, bytes(m));
    data_layout<parts>(m, parts, memory, d);
    Dice dice;
    for (Index k = 0; k < m.n.nq; ++k) d.q[k] = m.neutral()[k] + 0.5 * dice();
    for (Index k = 0; k < m.n.nv; ++k) d.v[k] = dice(), d.a[k] = dice(), d.tau_applied[k] = 10 * dice();
    for (Input i : {input_q, input_v, input_a, input_tau}) d.changed(i);
  }
  static std::size_t bytes(const Model& m) { return data_bytes<double, parts>(m, parts); }
};

template <class Out>
void give(const double* x, std::ptrdiff_t n, Out&& out) {
  for (std::ptrdiff_t k = 0; k < n; ++k) out(x[k]);
}

using Rnea = Bench<complete_parts(DYN_PART_INVERSE)>;

template <class Out, class Clock>
void rnea_figures(const Model& m, void* memory, Out&& out, Clock&& clock) {
  Rnea x(m, memory);
  clock("RNEA", 100, [&] { inverse_dynamics(m, x.d, x.d.v, x.d.a, static_cast<const double*>(nullptr), x.d.tau); });
  give(x.d.tau, m.n.nv, out);
}

using Dynamics = Bench<complete_parts(DYN_PART_KINEMATICS | DYN_PART_JACOBIANS | DYN_PART_COM | DYN_PART_INVERSE |
                                      DYN_PART_FORWARD_DERIVATIVES | DYN_PART_CORIOLIS | DYN_PART_ENERGY | DYN_PART_CENTROIDAL)>;

template <class Out, class Clock>
void dynamics_figures(const Model& m, void* memory, Out&& out, Clock&& clock) {
  Dynamics x(m, memory);
  Data<double>& d = x.d;
  const double* const none = nullptr;
  const std::ptrdiff_t nv = m.n.nv;
  clock("forward kinematics", 100, [&] { forward_kinematics<2>(m, d); });
  for (Index k = 1; k < m.n.frames; ++k) {
    double X[12], V[6], A[6];
    frame_placement(m, d, k, X), frame_velocity(m, d, k, DYN_REFERENCE_LOCAL, V),
        frame_acceleration(m, d, k, DYN_REFERENCE_WORLD, true, A);
    give(X, 12, out), give(V, 6, out), give(A, 6, out);
  }
  clock("RNEA", 100, [&] { inverse_dynamics(m, d, d.v, d.a, none, d.tau); });
  give(d.tau, nv, out);
  clock("ABA", 100, [&] { forward_dynamics(m, d, d.v, d.tau_applied, none, d.ddq); });
  give(d.ddq, nv, out);
  clock("CRBA", 100, [&] { d.invalidate(Stage::Mass), crba(m, d); });
  give(d.M, nv * nv, out);
  clock("RNEA derivatives", 100, [&] { d.invalidate(Stage::Mass), rnea_derivatives(m, d, d.v, d.a, none); });
  give(d.dtau_dq, nv * nv, out), give(d.dtau_dv, nv * nv, out);
  clock("ABA derivatives", 20, [&] {
    d.invalidate(Stage::Mass), d.invalidate(Stage::Factor), d.invalidate(Stage::Minv),
        aba_derivatives(m, d, d.v, d.tau_applied, none);
  });
  give(d.ddq_dq, nv * nv, out), give(d.ddq_dv, nv * nv, out), give(d.Minv, nv * nv, out);
  clock("Jacobians", 100, [&] { joint_jacobians(m, d); });
  give(d.J, 6 * nv, out);
  clock("centre of mass", 100, [&] { center_of_mass(m, d, 2); });
  give(d.com, 3, out), give(d.acom, 3, out);
  clock("Coriolis matrix", 100, [&] { coriolis_matrix(m, d); });
  give(d.coriolis, nv * nv, out);
  clock("centroidal momentum", 100, [&] { centroidal_map<false>(m, d); });
  give(d.Ag, 6 * nv, out);
}

using Steps = Bench<complete_parts(DYN_PART_SIMULATION | DYN_PART_CONSTRAINTS | DYN_PART_COLLISION | DYN_PART_CHOLESKY)>;

// A quadruped that lands on its feet: the state after each of several steps.
template <class Out, class Clock>
void contact_figures(const Model& m, void* memory, Out&& out, Clock&& clock) {
  Steps x(m, memory);
  Data<double>& d = x.d;
  for (Index k = 0; k < m.n.nq; ++k) d.q[k] = m.configurations()[m.n.nq * (m.n.configurations - 1) + k];
  for (Index k = 0; k < m.n.nv; ++k) d.v[k] = 0, d.tau_applied[k] = 0;
  d.changed(input_q), d.changed(input_v), d.changed(input_tau);
  Index contacts = 0;
  clock("step with contacts", 20, [&] {
    const double h = 1e-3;
    simulation::begin_sleep(m, d, h);
    d.changed(input_q), d.changed(input_v);
    d.step->report = {};
    const Index failed = integrator::step(m, d, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, h, d.step->report);
    d.changed(input_q), d.changed(input_v);
    simulation::end_sleep(m, d, h);
    contacts = failed ? -1 : d.step->report.contacts;
  });
  out(double(contacts));
  give(d.q, m.n.nq, out), give(d.v, m.n.nv, out);
}

}  // namespace boards
