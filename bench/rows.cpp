#include "rows.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace bench {

void require(dynStatus s) {
  if (s == DYN_OK) return;
  std::fprintf(stderr, "dyn_bench: %s: %s\n", dyn_status_name(s), dyn_last_error());
  std::exit(1);
}

Robot::Robot(const dynModel* model, const std::string& name) : nq(dyn_model_nq(model)), nv(dyn_model_nv(model)), m(model) {
  const dynParts square = DYN_PART_MASS | DYN_PART_CHOLESKY | DYN_PART_MINV | DYN_PART_CORIOLIS | DYN_PART_INVERSE_DERIVATIVES |
                          DYN_PART_FORWARD_DERIVATIVES | DYN_PART_REGRESSOR | DYN_PART_IK | DYN_PART_SECOND_ORDER;
  require(dyn_data_new(m, nv <= dense ? dynParts(DYN_PART_ALL) : DYN_PART_ALL & ~square, &d));

  joint = name.empty() ? dyn_model_njoints(m) - 1 : dyn_model_joint_id(m, name.c_str());
  if (joint < 0) std::fprintf(stderr, "dyn_bench: no joint '%s'\n", name.c_str()), std::exit(1);
  frame = dyn_model_frame_id_of_type(m, dyn_model_joint_name(m, joint), DYN_FRAME_TYPE_JOINT);

  q.resize(std::size_t(states) * std::size_t(nq));
  const std::vector<double> low(std::size_t(nq), -1), high(std::size_t(nq), 1);
  for (int k = 0; k < states; ++k)
    require(dyn_configuration_random(m, std::uint64_t(k + 1), low.data(), high.data(), q.data() + std::ptrdiff_t(k) * nq));
  std::srand(1);
  for (auto* w : {&v, &a, &tau})
    for (int k = 0; k < states * nv; ++k) w->push_back(2.0 * std::rand() / RAND_MAX - 1);
  const std::size_t n = std::size_t(nv);
  x.resize(std::max({std::size_t(nq), 18 * n, nv <= dense ? 2 * n * n : 0, nv <= tensors ? 4 * n * n * n : 0}));

  add_kinematics();
  add_dynamics();
  add_derivatives();
  add_constraints();
  add_centroidal();
  add_regressors();
  add_configurations();
}

void Robot::add_kinematics() {
  add("forward_kinematics", [this](int k) { dyn_forward_kinematics(m, d, Q(k), nullptr, nullptr); });
  add("forward_kinematics_q_v", [this](int k) { dyn_forward_kinematics(m, d, Q(k), V(k), nullptr); });
  add("forward_kinematics_q_v_a", [this](int k) { dyn_forward_kinematics(m, d, Q(k), V(k), A(k)); });
  add("joint_jacobians", [this](int k) { dyn_joint_jacobians(m, d, Q(k), nullptr); });
  add("joint_jacobians_time_variation", [this](int k) { dyn_joint_jacobians_time_variation(m, d, Q(k), V(k), nullptr); });
  add("frame_jacobian", [this](int k) {
    dyn_forward_kinematics(m, d, Q(k), nullptr, nullptr);
    dyn_frame_jacobian(m, d, frame, DYN_REFERENCE_LOCAL, x.data());
  });
  add("com", [this](int k) { dyn_com(m, d, Q(k), nullptr, nullptr, nullptr, nullptr, nullptr); });
  add("com_qva", [this](int k) { dyn_com(m, d, Q(k), V(k), A(k), nullptr, nullptr, nullptr); });
  add("jcom", [this](int k) { dyn_jcom(m, d, Q(k), nullptr); });
}

void Robot::add_dynamics() {
  add("rnea", [this](int k) { dyn_rnea(m, d, Q(k), V(k), A(k), nullptr, nullptr); });
  add("nle", [this](int k) { dyn_nle(m, d, Q(k), V(k), nullptr); });
  add("gravity_torque", [this](int k) { dyn_gravity_torque(m, d, Q(k), nullptr); });
  add("static_torque", [this](int k) { dyn_static_torque(m, d, Q(k), nullptr, nullptr); });
  add("aba", [this](int k) { dyn_aba(m, d, Q(k), V(k), U(k), nullptr, nullptr); });
  add("kinetic_energy", [this](int k) { dyn_kinetic_energy(m, d, Q(k), V(k), nullptr); });
  add("potential_energy", [this](int k) { dyn_potential_energy(m, d, Q(k), nullptr); });
  if (nv > dense) return;
  add("coriolis_matrix", [this](int k) { dyn_coriolis_matrix(m, d, Q(k), V(k), nullptr); });
  add("crba", [this](int k) { dyn_crba(m, d, Q(k), nullptr); });
  add("cholesky", [this](int) { dyn_cholesky(m, d); }, [this] { dyn_crba(m, d, Q(0), nullptr); });
  add(
      "cholesky_solve", [this](int k) { dyn_cholesky_solve(m, d, U(k), 1, x.data()); },
      [this] { dyn_crba(m, d, Q(0), nullptr), dyn_cholesky(m, d); });
  add("minv", [this](int k) { dyn_minv(m, d, Q(k), nullptr); });
  add("all_terms", [this](int k) {
    dyn_all_terms(m, d, DYN_TERM_ALL & ~unsigned(DYN_TERM_CHOLESKY | DYN_TERM_MINV | DYN_TERM_CORIOLIS | DYN_TERM_FRAMES), Q(k),
                  V(k), nullptr);
  });
}

void Robot::add_derivatives() {
  add("vcom_derivatives", [this](int k) { dyn_vcom_derivatives(m, d, Q(k), V(k), nullptr, nullptr); });
  add("frame_velocity_derivatives", [this](int k) {
    dyn_forward_kinematics(m, d, Q(k), V(k), nullptr);
    dyn_frame_velocity_derivatives(m, d, frame, DYN_REFERENCE_LOCAL, x.data(), x.data() + 6 * nv);
  });
  add("frame_acceleration_derivatives", [this](int k) {
    dyn_forward_kinematics(m, d, Q(k), V(k), A(k));
    dyn_frame_acceleration_derivatives(m, d, frame, DYN_REFERENCE_LOCAL, x.data(), x.data() + 6 * nv, x.data() + 12 * nv);
  });
  if (nv > dense) return;
  add("rnea_derivatives", [this](int k) { dyn_rnea_derivatives(m, d, Q(k), V(k), A(k), nullptr, nullptr, nullptr); });
  add("aba_derivatives", [this](int k) { dyn_aba_derivatives(m, d, Q(k), V(k), U(k), nullptr, nullptr); });
  add("gravity_torque_derivatives", [this](int k) { dyn_gravity_torque_derivatives(m, d, Q(k), nullptr); });
  add("static_torque_derivatives", [this](int k) { dyn_static_torque_derivatives(m, d, Q(k), nullptr, nullptr); });
  add("rnea_second_order_product", [this](int k) {
    dyn_rnea_second_order_product(m, d, Q(k), V(k), A(k), nullptr, U(k), nullptr);
  });
  if (nv > tensors) return;
  add("frame_kinematic_hessian", [this](int k) {
    dyn_forward_kinematics(m, d, Q(k), nullptr, nullptr);
    dyn_frame_kinematic_hessian(m, d, frame, DYN_REFERENCE_LOCAL, x.data());
  });
  add("rnea_second_order_derivatives", [this](int k) {
    const std::ptrdiff_t cube = std::ptrdiff_t(nv) * nv * nv;
    double* t = x.data();
    const dynSecondOrderDerivatives out = {sizeof out, t, t + cube, t + 2 * cube, t + 3 * cube};
    dyn_rnea_second_order_derivatives(m, d, Q(k), V(k), A(k), nullptr, &out);
  });
}

// Feet on the ground: points of frames named ..._foot, faces of ..._sole. Robots without any have no rows here, but chains.
void Robot::add_constraints() {
  if (nv > dense) return;
  int slot = 0;
  for (int f = 0; f < dyn_model_nframes(m) && slot < dyn_model_nconstraint_slots(m); ++f) {
    const std::string name = dyn_model_frame_name(m, f);
    const bool foot = name.size() > 5 && name.compare(name.size() - 5, 5, "_foot") == 0,
               sole = name.size() > 5 && name.compare(name.size() - 5, 5, "_sole") == 0;
    dynFrameInfo info{};
    info.struct_size = sizeof info;
    require(dyn_model_frame_info(m, f, &info));
    const bool soles = dyn_model_frame_id(m, "left_sole") >= 0;
    if (info.type != DYN_FRAME_TYPE_BODY || !(soles ? sole : foot)) continue;
    dynConstraint c;
    dyn_constraint_init(&c, soles ? DYN_CONSTRAINT_TYPE_FRAME : DYN_CONSTRAINT_TYPE_POINT);
    c.first = f;
    require(dyn_data_set_constraint(m, d, slot++, &c));
  }
  // a chain rests on two points: of its last joint's frame and of the one half-way
  if (std::string(dyn_model_name(m)).starts_with("chain"))
    for (int j : {dyn_model_njoints(m) - 1, (dyn_model_njoints(m) - 1) / 2}) {
      dynConstraint c;
      dyn_constraint_init(&c, DYN_CONSTRAINT_TYPE_POINT);
      c.first = dyn_model_frame_id_of_type(m, dyn_model_joint_name(m, j), DYN_FRAME_TYPE_JOINT);
      require(dyn_data_set_constraint(m, d, slot++, &c));
    }
  if (!slot) return;
  add("constrained_dynamics", [this](int k) { dyn_constrained_dynamics(m, d, Q(k), V(k), U(k), nullptr, nullptr, nullptr); });
  add("constraint_impulse", [this](int k) { dyn_constraint_impulse(m, d, Q(k), V(k), nullptr, nullptr, nullptr, nullptr); });
  add("delassus", [this](int k) { dyn_delassus(m, d, Q(k), nullptr); });
  add("constrained_dynamics_derivatives", [this](int k) {
    dynConstraintDerivatives out{};
    out.struct_size = sizeof out;
    dyn_constrained_dynamics_derivatives(m, d, Q(k), V(k), U(k), nullptr, nullptr, &out);
  });
}

void Robot::add_centroidal() {
  add("centroidal_map", [this](int k) { dyn_centroidal_map(m, d, Q(k), V(k), nullptr, nullptr, nullptr); });
  add("centroidal_map_time_variation", [this](int k) { dyn_centroidal_map_time_variation(m, d, Q(k), V(k), nullptr); });
  add("centroidal_momentum", [this](int k) { dyn_centroidal_momentum(m, d, Q(k), V(k), nullptr); });
  add("centroidal_momentum_time_variation",
      [this](int k) { dyn_centroidal_momentum_time_variation(m, d, Q(k), V(k), A(k), nullptr); });
  add("centroidal_derivatives", [this](int k) { dyn_centroidal_derivatives(m, d, Q(k), V(k), A(k), nullptr); });
}

void Robot::add_regressors() {
  if (nv > dense) return;
  add("joint_body_regressor", [this](int k) {
    dyn_forward_kinematics(m, d, Q(k), V(k), A(k));
    dyn_joint_body_regressor(m, d, joint, x.data());
  });
  add("joint_torque_regressor", [this](int k) { dyn_joint_torque_regressor(m, d, Q(k), V(k), A(k), nullptr); });
  add("static_regressor", [this](int k) { dyn_static_regressor(m, d, Q(k), nullptr); });
  add("kinetic_energy_regressor", [this](int k) { dyn_kinetic_energy_regressor(m, d, Q(k), V(k), nullptr); });
  add("potential_energy_regressor", [this](int k) { dyn_potential_energy_regressor(m, d, Q(k), nullptr); });
}

void Robot::add_configurations() {
  add("integrate", [this](int k) { dyn_integrate(m, Q(k), V(k), x.data()); });
  add("difference", [this](int k) { dyn_difference(m, Q(k), Q(k + 1), x.data()); });
  add("interpolate", [this](int k) { dyn_interpolate(m, Q(k), Q(k + 1), 0.3, x.data()); });
  add("configuration_distance", [this](int k) { dyn_configuration_distance(m, Q(k), Q(k + 1), x.data()); });
  if (nv > dense) return;
  add("integrate_jacobians",
      [this](int k) { dyn_integrate_jacobians(m, Q(k), V(k), x.data(), x.data() + std::ptrdiff_t(nv) * nv); });
  add("difference_jacobians",
      [this](int k) { dyn_difference_jacobians(m, Q(k), Q(k + 1), x.data(), x.data() + std::ptrdiff_t(nv) * nv); });
}

}  // namespace bench
