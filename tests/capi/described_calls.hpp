// Calls of a model and a data as a table: name, parts, inputs, outputs, what must be fresh. calls.hpp adds algorithms that no row
// describes.
#pragma once

#include <functional>

#include "capi/support.hpp"

namespace dyn_test {

enum Uses : unsigned {
  uses_q = 1,
  uses_v = 2,
  uses_a = 4,
  uses_tau = 8,
  uses_fext = 16,
  uses_b = 32,
  uses_frame = 64,
  uses_joint = 128,
  uses_reference = 256,
  uses_lambda = 512
};
enum class Needs { nothing, position, velocity, acceleration, com, mass, factor };

// Arguments of any of the calls; each takes what it needs.
struct Arguments {
  const double *q = nullptr, *v = nullptr, *a = nullptr, *tau = nullptr, *fext = nullptr, *b = nullptr, *lambda = nullptr;
  int frame = 1, joint = 1, nrhs = 1;
  dynReference reference = DYN_REFERENCE_LOCAL;
  dynIntegrator integrator = DYN_INTEGRATOR_SEMI_IMPLICIT_EULER;
  double dt = 1e-3;
  std::uint32_t mask = DYN_TERM_ALL;
  double* out[4] = {};
  std::uint32_t* filled = nullptr;
  dynArray* array = nullptr;
  dynField field = 0;
};

struct CallRow {
  const char* name;
  dynParts part;
  unsigned uses;
  Needs needs;
  bool out_required;
  int outputs;
  std::function<std::size_t(const dynModel*, int output)> size;
  std::function<dynStatus(const dynModel*, dynData*, const Arguments&)> call;
};

namespace sizes {
inline std::size_t none(const dynModel*, int) { return 0; }
inline std::size_t one(const dynModel*, int) { return 1; }
inline std::size_t two(const dynModel*, int) { return 2; }
inline std::size_t three(const dynModel*, int) { return 3; }
inline std::size_t six(const dynModel*, int) { return 6; }
inline std::size_t twelve(const dynModel*, int) { return 12; }
inline std::size_t frames(const dynModel* m, int) { return 12 * std::size_t(dyn_model_nframes(m)); }
inline std::size_t sensors(const dynModel* m, int) { return std::size_t(dyn_model_nsensordata(m)); }
inline std::size_t nv(const dynModel* m, int) { return std::size_t(dyn_model_nv(m)); }
inline std::size_t state(const dynModel* m, int k) { return k ? nv(m, 0) : std::size_t(dyn_model_nq(m)); }
inline std::size_t three_nv(const dynModel* m, int) { return 3 * nv(m, 0); }
inline std::size_t six_nv(const dynModel* m, int) { return 6 * nv(m, 0); }
inline std::size_t hessian(const dynModel* m, int) { return 6 * nv(m, 0) * nv(m, 0); }
inline std::size_t cube(const dynModel* m, int) { return nv(m, 0) * nv(m, 0) * nv(m, 0); }
inline std::size_t square(const dynModel* m, int) { return nv(m, 0) * nv(m, 0); }
inline std::size_t map_inertia_momentum(const dynModel* m, int k) { return k == 0 ? six_nv(m, 0) : k == 1 ? 36 : 6; }
inline std::size_t parameters(const dynModel* m, int) { return 10 * std::size_t(dyn_model_njoints(m) - 1); }
inline std::size_t three_parameters(const dynModel* m, int) { return 3 * parameters(m, 0); }
inline std::size_t nv_parameters(const dynModel* m, int) { return nv(m, 0) * parameters(m, 0); }
inline std::size_t six_ten(const dynModel*, int) { return 60; }
inline std::size_t solution_and_residual(const dynModel* m, int k) { return k ? 2 : std::size_t(dyn_model_nq(m)); }
inline std::size_t pairs(const dynModel* m, int) { return std::size_t(dyn_model_npairs(m)); }
inline std::size_t pairs_and_gradients(const dynModel* m, int k) { return pairs(m, 0) * (k ? nv(m, 0) : 1); }
inline std::size_t point_and_mass(const dynModel*, int k) { return k ? 1 : 3; }
}  // namespace sizes

// A task without weight, which every q meets: the state stays (ik_test.cpp has the others).
inline dynStatus solve_nothing(const dynModel* m, dynData* d, const Arguments& x) {
  dynIkTask task;
  dyn_ik_task_init(&task);
  task.frame = x.frame, task.weight = 0;
  dynIkOptions options;
  dyn_ik_options_init(&options);
  options.limits = 0;
  dynIkResult result{};
  result.struct_size = sizeof result;
  return dyn_ik(m, d, x.q, &task, 1, &options, with<dynIkOutput>({0, x.out[0], x.out[1], &result}));
}

#define DYN_CALL [](const dynModel* m, dynData* d, [[maybe_unused]] const Arguments& x) -> dynStatus
inline const CallRow described_calls[] = {
    {"dyn_data_set_state", 0, uses_q | uses_v | uses_a | uses_tau, Needs::nothing, false, 0, sizes::none,
     DYN_CALL { return dyn_data_set_state(m, d, x.q, x.v, x.a, x.tau); }},
    {"dyn_data_warm_up", 0, 0, Needs::nothing, false, 0, sizes::none, DYN_CALL { return dyn_data_warm_up(m, d); }},
    {"dyn_data_set_effects", 0, 0, Needs::nothing, false, 0, sizes::none,
     DYN_CALL { return dyn_data_set_effects(m, d, 0, DYN_EFFECT_ARMATURE); }},
    {"dyn_data_effects", 0, 0, Needs::nothing, false, 0, sizes::none,
     DYN_CALL {
       std::uint32_t effects;
       return dyn_data_effects(m, d, 0, &effects);
     }},
    {"dyn_forward_kinematics", DYN_PART_KINEMATICS, uses_q | uses_v | uses_a, Needs::nothing, false, 0, sizes::none,
     DYN_CALL { return dyn_forward_kinematics(m, d, x.q, x.v, x.a); }},
    {"dyn_frame_placement", 0, uses_frame, Needs::position, true, 1, sizes::twelve,
     DYN_CALL { return dyn_frame_placement(m, d, x.frame, x.out[0]); }},
    {"dyn_frame_placements", DYN_PART_FRAMES, 0, Needs::position, false, 1, sizes::frames,
     DYN_CALL { return dyn_frame_placements(m, d, x.out[0]); }},
    {"dyn_frame_velocity", DYN_PART_KINEMATICS, uses_frame | uses_reference, Needs::velocity, true, 1, sizes::six,
     DYN_CALL { return dyn_frame_velocity(m, d, x.frame, x.reference, x.out[0]); }},
    {"dyn_frame_acceleration", DYN_PART_KINEMATICS, uses_frame | uses_reference, Needs::acceleration, true, 1, sizes::six,
     DYN_CALL { return dyn_frame_acceleration(m, d, x.frame, x.reference, x.out[0]); }}
     , {"dyn_frame_classical_acceleration", DYN_PART_KINEMATICS, uses_frame | uses_reference, Needs::acceleration, true, 1,
        sizes::six, DYN_CALL{return dyn_frame_classical_acceleration(m, d, x.frame, x.reference, x.out[0]);
     }
     }
     , {"dyn_joint_jacobians", DYN_PART_JACOBIANS, uses_q, Needs::nothing, false, 1, sizes::six_nv,
        DYN_CALL{return dyn_joint_jacobians(m, d, x.q, x.out[0]);
     }
     }
     , {"dyn_joint_jacobians_time_variation", DYN_PART_JACOBIANS, uses_q | uses_v, Needs::nothing, false, 1, sizes::six_nv,
        DYN_CALL{return dyn_joint_jacobians_time_variation(m, d, x.q, x.v, x.out[0]);
     }
     }
     , {"dyn_frame_jacobian", 0, uses_frame | uses_reference, Needs::position, true, 1, sizes::six_nv,
        DYN_CALL{return dyn_frame_jacobian(m, d, x.frame, x.reference, x.out[0]);
     }
     }
     , {"dyn_frame_jacobian_time_variation", DYN_PART_KINEMATICS, uses_frame | uses_reference, Needs::velocity, true, 1,
        sizes::six_nv, DYN_CALL{return dyn_frame_jacobian_time_variation(m, d, x.frame, x.reference, x.out[0]);
     }
     }
     , {"dyn_frame_velocity_derivatives", DYN_PART_KINEMATICS, uses_frame | uses_reference, Needs::velocity, false, 2,
        sizes::six_nv, DYN_CALL{return dyn_frame_velocity_derivatives(m, d, x.frame, x.reference, x.out[0], x.out[1]);
     }
     }
     , {"dyn_frame_acceleration_derivatives", DYN_PART_KINEMATICS, uses_frame | uses_reference, Needs::acceleration, false, 3,
        sizes::six_nv,
        DYN_CALL{return dyn_frame_acceleration_derivatives(m, d, x.frame, x.reference, x.out[0], x.out[1], x.out[2]);
     }
     }
     , {"dyn_frame_classical_acceleration_derivatives", DYN_PART_KINEMATICS, uses_frame | uses_reference, Needs::acceleration,
        false, 3, sizes::six_nv,
        DYN_CALL{return dyn_frame_classical_acceleration_derivatives(m, d, x.frame, x.reference, x.out[0], x.out[1], x.out[2]);
     }
     }
     , {"dyn_frame_kinematic_hessian", DYN_PART_JACOBIANS, uses_frame | uses_reference, Needs::position, true, 1, sizes::hessian,
        DYN_CALL{return dyn_frame_kinematic_hessian(m, d, x.frame, x.reference, x.out[0]);
     }
     }
     , {"dyn_com", DYN_PART_COM, uses_q | uses_v | uses_a, Needs::nothing, false, 3, sizes::three,
        DYN_CALL{return dyn_com(m, d, x.q, x.v, x.a, x.out[0], x.out[1], x.out[2]);
     }
     }
     , {"dyn_jcom", DYN_PART_COM, uses_q, Needs::nothing, false, 1, sizes::three_nv,
        DYN_CALL{return dyn_jcom(m, d, x.q, x.out[0]);
     }
     }
     , {"dyn_vcom_derivatives", DYN_PART_COM, uses_q | uses_v, Needs::nothing, false, 2, sizes::three_nv,
        DYN_CALL{return dyn_vcom_derivatives(m, d, x.q, x.v, x.out[0], x.out[1]);
     }
     }
     , {"dyn_subtree_com", DYN_PART_COM, uses_joint, Needs::com, false, 2, sizes::point_and_mass,
        DYN_CALL{return dyn_subtree_com(m, d, x.joint, x.out[0], x.out[1]);
     }
     }
     , {"dyn_subtree_jcom", DYN_PART_COM, uses_joint, Needs::com, true, 1, sizes::three_nv,
        DYN_CALL{return dyn_subtree_jcom(m, d, x.joint, x.out[0]);
     }
     }
     , {"dyn_rnea", DYN_PART_INVERSE, uses_q | uses_v | uses_a | uses_fext, Needs::nothing, false, 1, sizes::nv,
        DYN_CALL{return dyn_rnea(m, d, x.q, x.v, x.a, x.fext, x.out[0]);
     }
     }
     , {"dyn_sensors", DYN_PART_KINEMATICS, uses_q | uses_v | uses_a, Needs::nothing, false, 1, sizes::sensors,
        DYN_CALL{return dyn_sensors(m, d, x.q, x.v, x.a, x.out[0]);
     }
     }
     , {"dyn_nle", DYN_PART_INVERSE, uses_q | uses_v, Needs::nothing, false, 1, sizes::nv,
        DYN_CALL{return dyn_nle(m, d, x.q, x.v, x.out[0]);
     }
     }
     , {"dyn_gravity_torque", DYN_PART_INVERSE, uses_q, Needs::nothing, false, 1, sizes::nv,
        DYN_CALL{return dyn_gravity_torque(m, d, x.q, x.out[0]);
     }
     }
     , {"dyn_static_torque", DYN_PART_INVERSE, uses_q | uses_fext, Needs::nothing, false, 1, sizes::nv,
        DYN_CALL{return dyn_static_torque(m, d, x.q, x.fext, x.out[0]);
     }
     }
     , {"dyn_coriolis_matrix", DYN_PART_CORIOLIS, uses_q | uses_v, Needs::nothing, false, 1, sizes::square,
        DYN_CALL{return dyn_coriolis_matrix(m, d, x.q, x.v, x.out[0]);
     }
     }
     , {"dyn_aba", DYN_PART_FORWARD, uses_q | uses_v | uses_tau | uses_fext, Needs::nothing, false, 1, sizes::nv,
        DYN_CALL{return dyn_aba(m, d, x.q, x.v, x.tau, x.fext, x.out[0]);
     }
     }
     , {"dyn_crba", DYN_PART_MASS, uses_q, Needs::nothing, false, 1, sizes::square, DYN_CALL{return dyn_crba(m, d, x.q, x.out[0]);
     }
     }
     , {"dyn_cholesky", DYN_PART_CHOLESKY, 0, Needs::mass, false, 0, sizes::none, DYN_CALL{return dyn_cholesky(m, d);
     }
     }
     , {"dyn_cholesky_solve", DYN_PART_CHOLESKY, uses_b, Needs::factor, true, 1, sizes::nv,
        DYN_CALL{return dyn_cholesky_solve(m, d, x.b, x.nrhs, x.out[0]);
     }
     }
     , {"dyn_minv", DYN_PART_MINV, uses_q, Needs::nothing, false, 1, sizes::square, DYN_CALL{return dyn_minv(m, d, x.q, x.out[0]);
     }
     }
     , {"dyn_rnea_derivatives", DYN_PART_INVERSE_DERIVATIVES, uses_q | uses_v | uses_a | uses_fext, Needs::nothing, false, 2,
        sizes::square, DYN_CALL{return dyn_rnea_derivatives(m, d, x.q, x.v, x.a, x.fext, x.out[0], x.out[1]);
     }
     }
     , {"dyn_aba_derivatives", DYN_PART_FORWARD_DERIVATIVES, uses_q | uses_v | uses_tau | uses_fext, Needs::nothing, false, 3,
        sizes::square,
        DYN_CALL{
            return dyn_aba_derivatives(m, d, x.q, x.v, x.tau, x.fext, with<dynAbaDerivatives>({0, x.out[0], x.out[1], x.out[2]}));
     }
     }
     , {"dyn_gravity_torque_derivatives", DYN_PART_INVERSE_DERIVATIVES, uses_q, Needs::nothing, false, 1, sizes::square,
        DYN_CALL{return dyn_gravity_torque_derivatives(m, d, x.q, x.out[0]);
     }
     }
     , {"dyn_static_torque_derivatives", DYN_PART_INVERSE_DERIVATIVES, uses_q | uses_fext, Needs::nothing, false, 1,
        sizes::square, DYN_CALL{return dyn_static_torque_derivatives(m, d, x.q, x.fext, x.out[0]);
     }
     }
     , {"dyn_rnea_second_order_product", DYN_PART_SECOND_ORDER, uses_q | uses_v | uses_a | uses_fext | uses_lambda,
        Needs::nothing, false, 4, sizes::square,
        DYN_CALL{return dyn_rnea_second_order_product(
            m, d, x.q, x.v, x.a, x.fext, x.lambda, with<dynSecondOrderDerivatives>({0, x.out[0], x.out[1], x.out[2], x.out[3]}));
     }
     }
     , {"dyn_rnea_second_order_derivatives", DYN_PART_SECOND_ORDER, uses_q | uses_v | uses_a | uses_fext, Needs::nothing, false,
        4, sizes::cube,
        DYN_CALL{return dyn_rnea_second_order_derivatives(
            m, d, x.q, x.v, x.a, x.fext, with<dynSecondOrderDerivatives>({0, x.out[0], x.out[1], x.out[2], x.out[3]}));
     }
     }
     , {"dyn_energy", DYN_PART_ENERGY, uses_q | uses_v, Needs::nothing, false, 2, sizes::one,
        DYN_CALL{return dyn_energy(m, d, x.q, x.v, x.out[0], x.out[1]);
     }
     }
     , {"dyn_kinetic_energy", DYN_PART_ENERGY, uses_q | uses_v, Needs::nothing, false, 1, sizes::one,
        DYN_CALL{return dyn_kinetic_energy(m, d, x.q, x.v, x.out[0]);
     }
     }
     , {"dyn_potential_energy", DYN_PART_ENERGY, uses_q, Needs::nothing, false, 1, sizes::one,
        DYN_CALL{return dyn_potential_energy(m, d, x.q, x.out[0]);
     }
     }
     , {"dyn_centroidal_map", DYN_PART_CENTROIDAL, uses_q | uses_v, Needs::nothing, false, 3, sizes::map_inertia_momentum,
        DYN_CALL{return dyn_centroidal_map(m, d, x.q, x.v, x.out[0], x.out[1], x.out[2]);
     }
     }
     , {"dyn_centroidal_map_time_variation", DYN_PART_CENTROIDAL, uses_q | uses_v, Needs::nothing, false, 1, sizes::six_nv,
        DYN_CALL{return dyn_centroidal_map_time_variation(m, d, x.q, x.v, x.out[0]);
     }
     }
     , {"dyn_centroidal_momentum", DYN_PART_CENTROIDAL, uses_q | uses_v, Needs::nothing, false, 1, sizes::six,
        DYN_CALL{return dyn_centroidal_momentum(m, d, x.q, x.v, x.out[0]);
     }
     }
     , {"dyn_centroidal_momentum_time_variation", DYN_PART_CENTROIDAL, uses_q | uses_v | uses_a, Needs::nothing, false, 1,
        sizes::six, DYN_CALL{return dyn_centroidal_momentum_time_variation(m, d, x.q, x.v, x.a, x.out[0]);
     }
     }
     , {"dyn_centroidal_derivatives", DYN_PART_CENTROIDAL, uses_q | uses_v | uses_a, Needs::nothing, false, 4, sizes::six_nv,
        DYN_CALL{return dyn_centroidal_derivatives(m, d, x.q, x.v, x.a,
                                                   with<dynCentroidalDerivatives>({0, x.out[0], x.out[1], x.out[2], x.out[3]}));
     }
     }
     , {"dyn_joint_torque_regressor", DYN_PART_REGRESSOR, uses_q | uses_v | uses_a, Needs::nothing, false, 1,
        sizes::nv_parameters, DYN_CALL{return dyn_joint_torque_regressor(m, d, x.q, x.v, x.a, x.out[0]);
     }
     }
     , {"dyn_static_regressor", DYN_PART_REGRESSOR, uses_q, Needs::nothing, false, 1, sizes::three_parameters,
        DYN_CALL{return dyn_static_regressor(m, d, x.q, x.out[0]);
     }
     }
     , {"dyn_kinetic_energy_regressor", DYN_PART_REGRESSOR, uses_q | uses_v, Needs::nothing, false, 1, sizes::parameters,
        DYN_CALL{return dyn_kinetic_energy_regressor(m, d, x.q, x.v, x.out[0]);
     }
     }
     , {"dyn_potential_energy_regressor", DYN_PART_REGRESSOR, uses_q, Needs::nothing, false, 1, sizes::parameters,
        DYN_CALL{return dyn_potential_energy_regressor(m, d, x.q, x.out[0]);
     }
     }
     , {"dyn_joint_body_regressor", DYN_PART_KINEMATICS, uses_joint, Needs::acceleration, true, 1, sizes::six_ten,
        DYN_CALL{return dyn_joint_body_regressor(m, d, x.joint, x.out[0]);
     }
     }
     , {"dyn_frame_body_regressor", DYN_PART_KINEMATICS, uses_frame, Needs::acceleration, true, 1, sizes::six_ten,
        DYN_CALL{return dyn_frame_body_regressor(m, d, x.frame, x.out[0]);
     }
     }
     , {"dyn_ik", DYN_PART_IK, uses_q | uses_frame, Needs::nothing, false, 2, sizes::solution_and_residual, solve_nothing},
         {"dyn_distances", DYN_PART_COLLISION, uses_q, Needs::nothing, false, 1, sizes::pairs,
          DYN_CALL{return dyn_distances(m, d, x.q, x.out[0]);
     }
     }
     , {"dyn_collisions", DYN_PART_COLLISION, uses_q, Needs::nothing, false, 0, sizes::none, DYN_CALL{int count;
     return dyn_collisions(m, d, x.q, 0, nullptr, 0, &count);
     }},
    {"dyn_contacts", DYN_PART_COLLISION, uses_q, Needs::nothing, false, 0, sizes::none,
     DYN_CALL {
       int count;
       return dyn_contacts(m, d, x.q, 0.01, nullptr, 0, &count);
     }},
    {"dyn_smooth_distances", DYN_PART_COLLISION, uses_q, Needs::nothing, false, 2, sizes::pairs_and_gradients,
     DYN_CALL { return dyn_smooth_distances(m, d, x.q, 1e-3, x.out[0], x.out[1], nullptr); }},
    {"dyn_rays", DYN_PART_COLLISION, uses_q, Needs::nothing, false, 1, sizes::two, DYN_CALL {
       static const double origins[6] = {0, 0, 9, 5, 0, 0.3}, directions[6] = {0, 0, -1, -1, 0, 0};
       return dyn_rays(m, d, x.q, with<dynRays>({0, 2, 0xffffffffu, origins, directions, 100}), x.out[0], nullptr, nullptr);
     }}
     ,
         // without constraints: constraint_test.cpp has those with
         {"dyn_data_set_constraint", DYN_PART_CONSTRAINTS, 0, Needs::nothing, false, 0, sizes::none,
          DYN_CALL{return dyn_data_set_constraint(m, d, 0, nullptr);
     }
     }
     , {"dyn_data_constraint", DYN_PART_CONSTRAINTS, 0, Needs::nothing, false, 0, sizes::none, DYN_CALL{dynConstraint c;
     dyn_constraint_init(&c, DYN_CONSTRAINT_TYPE_NONE);
     return dyn_data_constraint(m, d, 0, &c);
     }}
     , {"dyn_data_set_constraint_enabled", DYN_PART_CONSTRAINTS, 0, Needs::nothing, false, 0, sizes::none,
        DYN_CALL{return dyn_data_set_constraint_enabled(m, d, 0, 0);
     }
     }
     , {"dyn_data_constraint_rows", DYN_PART_CONSTRAINTS, 0, Needs::nothing, false, 0, sizes::none,
        DYN_CALL{return dyn_data_constraint_rows(m, d, -1, nullptr, nullptr);
     }
     }
     , {"dyn_constraint_terms", DYN_PART_CONSTRAINTS, uses_q | uses_v, Needs::nothing, false, 0, sizes::none,
        DYN_CALL{return dyn_constraint_terms(m, d, x.q, x.v, nullptr, nullptr, nullptr, nullptr);
     }
     }
     , {"dyn_constrained_dynamics", DYN_PART_CONSTRAINTS, uses_q | uses_v | uses_tau | uses_fext, Needs::nothing, false, 1,
        sizes::nv,
        DYN_CALL{return dyn_constrained_dynamics(m, d, x.q, x.v, x.tau, x.fext, nullptr,
                                                 with<dynConstrainedOutput>({0, x.out[0], nullptr, nullptr, nullptr}));
     }
     }
     , {"dyn_constrained_inverse_dynamics", DYN_PART_CONSTRAINTS, uses_q | uses_v | uses_a | uses_fext, Needs::nothing, false, 1,
        sizes::nv,
        DYN_CALL{return dyn_constrained_inverse_dynamics(m, d, x.q, x.v, x.a, x.fext, nullptr,
                                                         with<dynConstrainedOutput>({0, nullptr, x.out[0], nullptr, nullptr}));
     }
     }
     , {"dyn_constraint_impulse", DYN_PART_CONSTRAINTS, uses_q | uses_v, Needs::nothing, false, 1, sizes::nv,
        DYN_CALL{return dyn_constraint_impulse(m, d, x.q, x.v, nullptr, x.out[0], nullptr, nullptr);
     }
     }
     , {"dyn_project", DYN_PART_CONSTRAINTS, uses_q | uses_v, Needs::nothing, false, 2, sizes::state,
        DYN_CALL{return dyn_project(m, d, x.q, x.v, nullptr, x.out[0], x.out[1], nullptr);
     }
     }
     , {"dyn_delassus", DYN_PART_CONSTRAINTS, uses_q, Needs::nothing, false, 0, sizes::none,
        DYN_CALL{return dyn_delassus(m, d, x.q, nullptr);
     }
     }
     , {"dyn_delassus_factor", DYN_PART_CONSTRAINTS, uses_q, Needs::nothing, false, 0, sizes::none,
        DYN_CALL{return dyn_delassus_factor(m, d, x.q, nullptr, nullptr);
     }
     }
     , {"dyn_delassus_times", DYN_PART_CONSTRAINTS, uses_q, Needs::nothing, false, 0, sizes::none,
        DYN_CALL{return dyn_delassus_times(m, d, x.q, nullptr, nullptr);
     }
     }
     , {"dyn_delassus_solve", DYN_PART_CONSTRAINTS, uses_q, Needs::nothing, false, 0, sizes::none,
        DYN_CALL{return dyn_delassus_solve(m, d, x.q, 0.1, nullptr, nullptr);
     }
     }
     , {"dyn_constrained_dynamics_derivatives", DYN_PART_CONSTRAINT_DERIVATIVES, uses_q | uses_v | uses_tau | uses_fext,
        Needs::nothing, false, 3, sizes::square,
        DYN_CALL{
            const dynConstraintDerivatives out = {sizeof out, x.out[0], x.out[1], x.out[2], nullptr, nullptr, nullptr, nullptr};
     return dyn_constrained_dynamics_derivatives(m, d, x.q, x.v, x.tau, x.fext, nullptr, &out);
     }}
     , {"dyn_constraint_impulse_derivatives", DYN_PART_CONSTRAINT_DERIVATIVES, uses_q | uses_v, Needs::nothing, false, 2,
        sizes::square,
        DYN_CALL{
            const dynConstraintDerivatives out = {sizeof out, x.out[0], x.out[1], nullptr, nullptr, nullptr, nullptr, nullptr};
     return dyn_constraint_impulse_derivatives(m, d, x.q, x.v, nullptr, &out);
     }},
    {"dyn_constraint_report", DYN_PART_CONSTRAINTS, uses_q, Needs::nothing, false, 0, sizes::none,
     DYN_CALL {
       dynConstraintReport report{};
       report.struct_size = sizeof report;
       return dyn_constraint_report(m, d, x.q, &report, nullptr, 0);
     }},
    {"dyn_all_terms", DYN_PART_ALL, uses_q | uses_v, Needs::nothing, false, 0, sizes::none,
     DYN_CALL { return dyn_all_terms(m, d, x.mask, x.q, x.v, x.filled); }}
     , {"dyn_step", DYN_PART_SIMULATION, 0, Needs::nothing, false, 0, sizes::none,
        DYN_CALL{return take_step(m, d, x.integrator, x.dt);
     }
     }
     , {"dyn_step_derivatives", DYN_PART_STEP_DERIVATIVES, 0, Needs::nothing, false, 0, sizes::none,
        DYN_CALL{
            dynStepDerivatives out;
            dyn_step_derivatives_init(&out);
            dynStepDerivativeReport report{};
            report.struct_size = sizeof report, out.report = &report;
     return dyn_step_derivatives(m, d, nullptr, &out);
     }
     }
     , {"dyn_data_array", 0, 0, Needs::nothing, false, 0, sizes::none, DYN_CALL{return dyn_data_array(m, d, x.field, x.array);
     }
     }
     ,
     };
#undef DYN_CALL

}  // namespace dyn_test
