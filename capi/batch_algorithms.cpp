// Algorithms of batches: one row for each value of dynAlgorithm, in its order.
#include <cstring>

#include "batch.hpp"

namespace dyn::capi {

namespace {

// The first call's status unless that is good, then the second's.
template <class F>
dynStatus then(dynStatus first, F second) {
  return first == DYN_OK ? second() : first;
}

dynStatus solve_one(const dynModel* m, dynData* d, const dynBatchArrays& x) {
  dynStatus status = dyn_crba(m, d, x.q, nullptr);
  if (status == DYN_OK) status = dyn_cholesky(m, d);
  return status == DYN_OK ? dyn_cholesky_solve(m, d, x.b, 1, x.out[0]) : status;
}

dynStatus step_one(const dynModel* m, dynData* d, const dynBatchArrays& x) {
  dynStatus status = dyn_data_set_state(m, d, x.q, x.v, nullptr, x.tau);
  dynStepOptions options;
  dyn_step_options_init(&options);
  options.integrator = x.integrator, options.dt = x.dt;
  if (status == DYN_OK) status = dyn_data_set_step_options(m, d, &options);
  if (status == DYN_OK) status = dyn_step(m, d);
  if (status == DYN_OK) copy_out(d->body->d.q, m->m->n.nq, x.out[0]), copy_out(d->body->d.v, m->m->n.nv, x.out[1]);
  return status;
}

}  // namespace

#define OUT(name, ...) {#name, [](const Sizes& s) { (void)s; return Extent{__VA_ARGS__}; }}
#define NV s.nv
#define CALL [](const dynModel* m, dynData* d, const dynBatchArrays& x) -> dynStatus
#define AFTER_KINEMATICS(q, v, a, call) \
  CALL { return then(dyn_forward_kinematics(m, d, q, v, a), [&] { return call; }); }

const BatchAlgorithm batch_algorithms[batch_algorithm_count] = {
    {"frame_placement", "frame q", {OUT(placement, 12, 1)},
     AFTER_KINEMATICS(x.q, nullptr, nullptr, dyn_frame_placement(m, d, x.frame, x.out[0]))},
    {"frame_placements", "q", {OUT(placements, 12, s.nframes)},
     AFTER_KINEMATICS(x.q, nullptr, nullptr, dyn_frame_placements(m, d, x.out[0]))},
    {"frame_velocity", "frame reference q v", {OUT(velocity, 6, 1)},
     AFTER_KINEMATICS(x.q, x.v, nullptr, dyn_frame_velocity(m, d, x.frame, x.reference, x.out[0]))},
    {"frame_acceleration", "frame reference q v a", {OUT(acceleration, 6, 1)},
     AFTER_KINEMATICS(x.q, x.v, x.a, dyn_frame_acceleration(m, d, x.frame, x.reference, x.out[0]))},
    {"frame_classical_acceleration", "frame reference q v a", {OUT(acceleration, 6, 1)},
     AFTER_KINEMATICS(x.q, x.v, x.a, dyn_frame_classical_acceleration(m, d, x.frame, x.reference, x.out[0]))},
    {"joint_jacobians", "q", {OUT(J, 6, NV)}, CALL { return dyn_joint_jacobians(m, d, x.q, x.out[0]); }},
    {"joint_jacobians_time_variation", "q v", {OUT(dJ, 6, NV)},
     CALL { return dyn_joint_jacobians_time_variation(m, d, x.q, x.v, x.out[0]); }},
    {"frame_jacobian", "frame reference q", {OUT(J, 6, NV)},
     AFTER_KINEMATICS(x.q, nullptr, nullptr, dyn_frame_jacobian(m, d, x.frame, x.reference, x.out[0]))},
    {"frame_jacobian_time_variation", "frame reference q v", {OUT(dJ, 6, NV)},
     AFTER_KINEMATICS(x.q, x.v, nullptr, dyn_frame_jacobian_time_variation(m, d, x.frame, x.reference, x.out[0]))},
    {"com", "q v a", {OUT(com, 3, 1), OUT(vcom, 3, 1), OUT(acom, 3, 1)},
     CALL {
       const bool moving = x.out[1] || x.out[2];
       return dyn_com(m, d, x.q, moving ? x.v : nullptr, moving ? x.a : nullptr, x.out[0], x.out[1], x.out[2]);
     }},
    {"jcom", "q", {OUT(Jcom, 3, NV)}, CALL { return dyn_jcom(m, d, x.q, x.out[0]); }},
    {"subtree_com", "joint q", {OUT(com, 3, 1), OUT(mass, 1, 1)},
     CALL {
       return then(dyn_com(m, d, x.q, nullptr, nullptr, nullptr, nullptr, nullptr),
                   [&] { return dyn_subtree_com(m, d, x.joint, x.out[0], x.out[1]); });
     }},
    {"subtree_jcom", "joint q", {OUT(J, 3, NV)},
     CALL {
       return then(dyn_com(m, d, x.q, nullptr, nullptr, nullptr, nullptr, nullptr),
                   [&] { return dyn_subtree_jcom(m, d, x.joint, x.out[0]); });
     }},
    {"rnea", "q v a fext", {OUT(tau, NV, 1)}, CALL { return dyn_rnea(m, d, x.q, x.v, x.a, x.fext, x.out[0]); }},
    {"nle", "q v", {OUT(nle, NV, 1)}, CALL { return dyn_nle(m, d, x.q, x.v, x.out[0]); }},
    {"gravity_torque", "q", {OUT(g, NV, 1)}, CALL { return dyn_gravity_torque(m, d, x.q, x.out[0]); }},
    {"static_torque", "q fext", {OUT(tau, NV, 1)}, CALL { return dyn_static_torque(m, d, x.q, x.fext, x.out[0]); }},
    {"coriolis_matrix", "q v", {OUT(C, NV, NV)}, CALL { return dyn_coriolis_matrix(m, d, x.q, x.v, x.out[0]); }},
    {"aba", "q v tau fext", {OUT(ddq, NV, 1)}, CALL { return dyn_aba(m, d, x.q, x.v, x.tau, x.fext, x.out[0]); }},
    {"crba", "q", {OUT(M, NV, NV)}, CALL { return dyn_crba(m, d, x.q, x.out[0]); }},
    {"cholesky_solve", "q b", {OUT(x, NV, 1)}, solve_one},
    {"minv", "q", {OUT(Minv, NV, NV)}, CALL { return dyn_minv(m, d, x.q, x.out[0]); }},
    {"rnea_derivatives", "q v a fext", {OUT(dtau_dq, NV, NV), OUT(dtau_dv, NV, NV)},
     CALL { return dyn_rnea_derivatives(m, d, x.q, x.v, x.a, x.fext, x.out[0], x.out[1]); }},
    {"aba_derivatives", "q v tau fext", {OUT(ddq_dq, NV, NV), OUT(ddq_dv, NV, NV), OUT(ddq_dtau, NV, NV)},
     CALL {
       const dynAbaDerivatives out = {sizeof out, x.out[0], x.out[1], x.out[2]};
       return dyn_aba_derivatives(m, d, x.q, x.v, x.tau, x.fext, &out);
     }},
    {"energy", "q v", {OUT(kinetic, 1, 1), OUT(potential, 1, 1)}, CALL { return dyn_energy(m, d, x.q, x.v, x.out[0], x.out[1]); }},
    {"kinetic_energy", "q v", {OUT(kinetic, 1, 1)}, CALL { return dyn_kinetic_energy(m, d, x.q, x.v, x.out[0]); }},
    {"potential_energy", "q", {OUT(potential, 1, 1)}, CALL { return dyn_potential_energy(m, d, x.q, x.out[0]); }},
    {"centroidal_map", "q v", {OUT(Ag, 6, NV), OUT(Ig, 6, 6), OUT(hg, 6, 1)},
     CALL { return dyn_centroidal_map(m, d, x.q, x.v, x.out[0], x.out[1], x.out[2]); }},
    {"centroidal_map_time_variation", "q v", {OUT(dAg, 6, NV)},
     CALL { return dyn_centroidal_map_time_variation(m, d, x.q, x.v, x.out[0]); }},
    {"centroidal_momentum", "q v", {OUT(hg, 6, 1)}, CALL { return dyn_centroidal_momentum(m, d, x.q, x.v, x.out[0]); }},
    {"centroidal_momentum_time_variation", "q v a", {OUT(dhg, 6, 1)},
     CALL { return dyn_centroidal_momentum_time_variation(m, d, x.q, x.v, x.a, x.out[0]); }},
    {"centroidal_derivatives", "q v a", {OUT(dh_dq, 6, NV), OUT(dhdot_dq, 6, NV), OUT(dhdot_dv, 6, NV), OUT(dhdot_da, 6, NV)},
     CALL {
       const dynCentroidalDerivatives out = {sizeof out, x.out[0], x.out[1], x.out[2], x.out[3]};
       return dyn_centroidal_derivatives(m, d, x.q, x.v, x.a, &out);
     }},
    {"joint_torque_regressor", "q v a", {OUT(Y, NV, s.nparameters)},
     CALL { return dyn_joint_torque_regressor(m, d, x.q, x.v, x.a, x.out[0]); }},
    {"static_regressor", "q", {OUT(Y, 3, s.nparameters)}, CALL { return dyn_static_regressor(m, d, x.q, x.out[0]); }},
    {"kinetic_energy_regressor", "q v", {OUT(y, s.nparameters, 1)},
     CALL { return dyn_kinetic_energy_regressor(m, d, x.q, x.v, x.out[0]); }},
    {"potential_energy_regressor", "q", {OUT(y, s.nparameters, 1)},
     CALL { return dyn_potential_energy_regressor(m, d, x.q, x.out[0]); }},
    {"joint_body_regressor", "joint q v a", {OUT(Y, 6, 10)},
     AFTER_KINEMATICS(x.q, x.v, x.a, dyn_joint_body_regressor(m, d, x.joint, x.out[0]))},
    {"frame_body_regressor", "frame q v a", {OUT(Y, 6, 10)},
     AFTER_KINEMATICS(x.q, x.v, x.a, dyn_frame_body_regressor(m, d, x.frame, x.out[0]))},
    {"integrate", "q v", {OUT(out, s.nq, 1)}, CALL { return (void)d, dyn_integrate(m, x.q, x.v, x.out[0]); }},
    {"gravity_torque_derivatives", "q", {OUT(dg_dq, NV, NV)}, CALL { return dyn_gravity_torque_derivatives(m, d, x.q, x.out[0]); }},
    {"static_torque_derivatives", "q fext", {OUT(dstatic_torque_dq, NV, NV)},
     CALL { return dyn_static_torque_derivatives(m, d, x.q, x.fext, x.out[0]); }},
    {"vcom_derivatives", "q v", {OUT(dvcom_dq, 3, NV), OUT(dvcom_dv, 3, NV)},
     CALL { return dyn_vcom_derivatives(m, d, x.q, x.v, x.out[0], x.out[1]); }},
    {"frame_velocity_derivatives", "frame reference q v", {OUT(dv_dq, 6, NV), OUT(dv_dv, 6, NV)},
     AFTER_KINEMATICS(x.q, x.v, nullptr, dyn_frame_velocity_derivatives(m, d, x.frame, x.reference, x.out[0], x.out[1]))},
    {"frame_acceleration_derivatives", "frame reference q v a", {OUT(da_dq, 6, NV), OUT(da_dv, 6, NV), OUT(da_da, 6, NV)},
     AFTER_KINEMATICS(x.q, x.v, x.a, dyn_frame_acceleration_derivatives(m, d, x.frame, x.reference, x.out[0], x.out[1], x.out[2]))},
    {"frame_classical_acceleration_derivatives", "frame reference q v a", {OUT(da_dq, 6, NV), OUT(da_dv, 6, NV), OUT(da_da, 6, NV)},
     AFTER_KINEMATICS(x.q, x.v, x.a, dyn_frame_classical_acceleration_derivatives(m, d, x.frame, x.reference, x.out[0], x.out[1], x.out[2]))},
    {"rnea_second_order_product", "b q v a fext", {OUT(dqdq, NV, NV), OUT(dvdv, NV, NV), OUT(dqdv, NV, NV), OUT(dadq, NV, NV)},
     CALL {
       const dynSecondOrderDerivatives out = {sizeof out, x.out[0], x.out[1], x.out[2], x.out[3]};
       return dyn_rnea_second_order_product(m, d, x.q, x.v, x.a, x.fext, x.b, &out);
     }},
    {"rnea_second_order_derivatives", "q v a fext",
     {OUT(d2tau_dqdq, NV, NV, NV), OUT(d2tau_dvdv, NV, NV, NV), OUT(d2tau_dqdv, NV, NV, NV), OUT(d2tau_dadq, NV, NV, NV)},
     CALL {
       const dynSecondOrderDerivatives out = {sizeof out, x.out[0], x.out[1], x.out[2], x.out[3]};
       return dyn_rnea_second_order_derivatives(m, d, x.q, x.v, x.a, x.fext, &out);
     }},
    {"frame_kinematic_hessian", "frame reference q", {OUT(H, 6, NV, NV)},
     AFTER_KINEMATICS(x.q, nullptr, nullptr, dyn_frame_kinematic_hessian(m, d, x.frame, x.reference, x.out[0]))},
    {"difference", "q q1", {OUT(v, NV, 1)}, CALL { return (void)d, dyn_difference(m, x.q, x.q1, x.out[0]); }},
    {"step", "dt integrator q v tau", {OUT(q, s.nq, 1), OUT(v, NV, 1)}, step_one},
};
#undef OUT
#undef NV
#undef CALL
#undef AFTER_KINEMATICS

int BatchAlgorithm::output_count() const {
  int count = 0;
  while (count < 4 && outputs[count].name) ++count;
  return count;
}

bool BatchAlgorithm::reads(const char* input) const {
  const std::size_t length = std::strlen(input);
  for (const char* word = inputs; *word;) {
    const std::size_t n = std::strcspn(word, " ");
    if (n == length && std::strncmp(word, input, n) == 0) return true;
    word += n + (word[n] == ' ');
  }
  return false;
}

}  // namespace dyn::capi
