"""dyn.hpp: compiles on its own as C++17 and beside a program's own namespace dyn, and answers what the package answers."""

import os
import shutil
import subprocess
from pathlib import Path

import libdyn as dyn
import numpy as np
import pytest
from conftest import ARM, CAPI

CXX = os.environ.get("CXX") or shutil.which("c++")
pytestmark = pytest.mark.skipif(not CXX, reason="no C++ compiler")

PROGRAM = r"""
#include "dyn.hpp"
#include <cassert>
#include <cmath>
#include <cstdio>
#ifdef BESIDE
namespace dyn { struct Model { int x; }; struct Error { int y; }; inline Model own() { return Model{1}; } }
namespace user = dyn_api;
#else
namespace user = dyn;
#endif
template <class F> dynStatus status_of(F f) { try { f(); } catch (const user::Error& e) { assert(*e.what()); return e.status(); } return DYN_OK; }
int main(int argc, char** argv) {
  assert(argc == 2);
  auto model = user::Model::load_string(argv[1], user::LoadOptions().base(DYN_BASE_FIXED).gravity(0, 0, -9.81));
  assert(model.nq() == 2 && model.nv() == 2 && model.njoints() == 3 && model.name() == "arm");
  assert(model.joint_name(model.joint_id("elbow")) == "elbow" && model.joint_info(1).type == DYN_JOINT_TYPE_REVOLUTE);
  assert(model.array(DYN_MODEL_ARRAY_UPPER_LIMIT)[0] == 2.5 && model.configurations().at(0) == "neutral");
  assert(model.q_permutation({"elbow", "shoulder"}).first == (std::vector<int32_t>{1, 0}));
  user::Vector q{0.3, -0.4}, v{1, 2}, a{-1, 0.5};
  {
    const user::Vector6 twist{0.1, -0.2, 0.3, 0.4, 0.5, -0.6};
    const user::Placement X = user::se3::exp(twist), I = user::se3::compose(X, user::se3::inverse(X));
    for (int i = 0; i < 6; ++i) assert(std::abs(user::se3::log(X)[i] - twist[i]) < 1e-14);
    for (int i = 0; i < 12; ++i) assert(std::abs(I[i] - (i % 4 == 0 && i < 9)) < 1e-14);
    const user::Matrix J = user::se3::jexp(twist), L = user::se3::jexp(twist, user::Side::left), Ad = user::se3::adjoint(X);
    for (int k = 0; k < 36; ++k) {
      double sum = 0;
      for (int i = 0; i < 6; ++i) sum += Ad(k % 6, i) * J(i, k / 6);
      assert(std::abs(L(k % 6, k / 6) - sum) < 1e-14);
    }
    const user::Vector3 p{1, 2, 3}, there = user::se3::act(X, p), back = user::se3::act(user::se3::inverse(X), there);
    const user::Rotation R = user::so3::from_quaternion(user::so3::to_quaternion(user::so3::exp({0.1, 0.2, 3})));
    for (int i = 0; i < 3; ++i) {
      assert(std::abs(back[i] - p[i]) < 1e-14 && std::abs(user::so3::log(R)[i] - (i == 2 ? 3 : 0.1 * (i + 1))) < 1e-13);
      assert(std::abs(user::se3::act_motion(X, twist)[i] - twist[i]) < 1e-14);  // a twist is its own screw's
    }
    assert(std::abs(user::se3::from_rpy(user::se3::to_rpy(X))[4] - X[4]) < 1e-15);
    assert(user::se3::from_matrix(user::se3::to_matrix(X)) == X);
    assert(std::abs(user::se3::from_quaternion(user::se3::to_quaternion(X))[1] - X[1]) < 1e-15);
    assert(std::abs(user::se3::interpolate(X, I, 1)[10]) < 1e-14 && user::se3::act_inertia(X, J).rows == 6);
    assert(user::so3::interpolate(R, R, 0.3).size() == 9 && user::so3::jlog(user::so3::inverse(R)).rows == 3);
    assert(status_of([] { user::se3::exp({0, 0, 0, NAN, 0, 0}); }) == DYN_ERROR_NONFINITE);
  }
  user::Builder two(model);
  two.attach(model, "other_", user::JointSpec("rail", DYN_JOINT_TYPE_PRISMATIC, "tool"));
  assert(two.finish().nv() == 5 && user::Builder(model).lock({"elbow"}, q).finish().nv() == 1);
  assert(user::Builder(model).remove_subtree("elbow").finish().nv() == 1 && user::Builder(model).keep_subtree("elbow").attach(model, "x").finish().nv() == 3);
  user::Data data(model);
  const user::Vector tau = data.rnea(q, v, a).copy();
  const user::View ddq = data.aba(q, v, tau);
  for (int i = 0; i < 2; ++i) assert(std::abs(ddq[i] - a[i]) < 1e-12);
  const user::View M = data.crba(q);
  assert(M.rows() == 2 && M.cols() == 2 && M(0, 1) == M(1, 0));
  data.cholesky();
  const user::Vector x = data.cholesky_solve(tau);
  assert(std::abs(M(0, 0) * x[0] + M(0, 1) * x[1] - tau[0]) < 1e-12);
  assert(data.minv().size() == 4 && data.coriolis_matrix(q, v).size() == 4 && data.joint_jacobians().rows() == 6);
  data.forward_kinematics(q, v, a);
  const int tool = model.frame_id("tool");
  const auto J = data.frame_jacobian(tool, DYN_REFERENCE_WORLD);
  const auto velocity = data.frame_velocity(tool, DYN_REFERENCE_WORLD);
  for (int i = 0; i < 6; ++i) assert(std::abs(J(i, 0) * v[0] + J(i, 1) * v[1] - velocity[i]) < 1e-12);
  data.frame_jacobian_time_variation(tool), data.frame_acceleration(tool), data.frame_classical_acceleration(tool), data.frame_placement(tool);
  assert(data.frame_placements().cols() == model.nframes());
  assert(data.compute_com(q, v, a).size() == 3 && data.jcom().cols() == 2);
  assert(data.subtree_com(1).second == 2 && data.subtree_jcom(1).size() == 6);
  assert(data.energy(q, v).mechanical() == data.kinetic_energy() + data.potential_energy());
  assert(data.all_terms(DYN_TERM_MASS, q, v) & DYN_TERM_MASS);
  data.forward_kinematics(q);
  const auto reached = data.ik({user::IkTask::pose(tool, data.frame_placement(tool)), user::IkTask::posture(q).weights({1, 0.5}).priority(1)}, v);
  assert(reached.converged() && reached.residuals.size() == 2 && reached.residuals[0][0] <= 1e-6 && reached.q.size() == 2);
  assert(status_of([&] { data.ik({user::IkTask::com({0, 0, 0}).weights({1, 1})}); }) == DYN_ERROR_SIZE);
  assert(status_of([&] { data.ik({}); }) == DYN_ERROR_ARGUMENT);
  data.compute_nle(), data.gravity_torque(), data.compute_static_torque(), data.joint_jacobians_time_variation();
  assert(model.distance(model.integrate(q, v), q) > 0 && model.is_normalized(model.normalize(model.random(3))));
  assert(model.difference(q, model.interpolate(q, v, 0.5)).size() == 2);
  model.integrate_jacobians(q, v), model.difference_jacobians(q, v);
  const auto inverse = data.rnea_derivatives(q, v, a);
  assert(inverse.dtau_dq.cols() == 2 && inverse.dtau_dv.cols() == 2 && inverse.dtau_da(0, 1) == inverse.dtau_da(1, 0));
  const auto forward = data.aba_derivatives(q, v);
  assert(forward.ddq_dq.cols() == 2 && forward.ddq_dv.cols() == 2 && forward.ddq_dtau(0, 0) > 0);
  const user::Vector hg = data.centroidal_momentum(q, v).copy();
  const user::View Ag = data.centroidal_map();
  for (int i = 0; i < 6; ++i) assert(std::abs(Ag(i, 0) * v[0] + Ag(i, 1) * v[1] - hg[i]) < 1e-12);
  assert(data.centroidal_map_time_variation().cols() == 2 && data.centroidal_momentum_time_variation(q, v, a).size() == 6 && data.field("Ig")(0, 0) > 0);
  assert(data.centroidal_derivatives(q, v, a).dhdot_da(1, 1) == data.field("Ag")(1, 1));
  data.forward_kinematics(q, v, a);
  const auto by = data.frame_acceleration_derivatives(tool, DYN_REFERENCE_WORLD), classical = data.frame_classical_acceleration_derivatives(tool, DYN_REFERENCE_WORLD);
  for (int i = 0; i < 12; ++i) assert(by.da_da.values[std::size_t(i)] == J.values[std::size_t(i)] && classical.da_da.values[std::size_t(i)] == J.values[std::size_t(i)]);
  assert(data.frame_velocity_derivatives(tool, DYN_REFERENCE_WORLD).dv_dv.values == J.values && data.frame_kinematic_hessian(tool).cols == 4);
  assert(data.vcom_derivatives(q, v).dvcom_dv(0, 1) == data.jcom()(0, 1));
  assert(data.gravity_torque_derivatives(q)(0, 1) == data.static_torque_derivatives(q)(0, 1));
  const auto product = data.rnea_second_order_product(user::Vector{0, 1}, q, v, a);
  const auto second = data.rnea_second_order_derivatives(q, v, a);
  for (int i = 0; i < 4; ++i) assert(std::abs(product.dqdq.data()[i] - second.d2tau_dqdq[std::size_t(4 + i)]) < 1e-12);
  assert(product.dvdv.size() == 4 && product.dqdv.size() == 4 && product.dadq.size() == 4 && second.d2tau_dadq.size() == 8);
  const auto pi = model.inertial_parameters();
  const user::View Y = data.joint_torque_regressor(q, v, a);
  double sum = 0;
  for (int k = 0; k < Y.cols(); ++k) sum += Y(0, k) * pi.values[std::size_t(k)];
  assert(Y.cols() == 20 && std::abs(sum - tau[0]) < 1e-12);
  assert(data.compute_static_regressor().rows() == 3 && data.compute_kinetic_energy_regressor().size() == 20 && data.compute_potential_energy_regressor().size() == 20);
  assert(data.joint_body_regressor(1).cols == 10 && data.frame_body_regressor(tool).rows == 6);
  const user::Parameters ball{2, 0.1, 0, 0, 1, 0, 1, 0, 0, 1};
  assert(user::is_physically_consistent(ball) && user::body_regressor({}, {}).size() == 60);
  assert(std::abs(user::parameters_from_log_cholesky(user::log_cholesky_from_parameters(ball))[1] - 0.1) < 1e-12);
  assert(user::parameters_from_pseudo_inertia(user::pseudo_inertia_from_parameters(ball))[0] == 2);
  assert(user::log_cholesky_jacobian(user::log_cholesky_from_parameters(ball))(0, 0) > 3.999);
  const user::StateLayout pinocchio = user::StateLayout(DYN_CONVENTION_PINOCCHIO).joints({"elbow", "shoulder"});
  const user::State there = model.to_peer(pinocchio, q, v, a), back = model.from_peer(pinocchio, there.q, there.v, there.a);
  assert(model.sizes(pinocchio).first == 3 && there.q[2] == q[0] && there.v[0] == v[1] && there.tau.empty());
  assert(std::abs(back.q[1] - q[1]) < 1e-15 && back.v == user::Vector(v) && back.a == user::Vector(a));
  assert(status_of([&] { model.to_peer(user::StateLayout(DYN_CONVENTION_MUJOCO).joints({"elbow"}), q); }) == DYN_ERROR_NAME);
  dynTendon twice;
  dyn_tendon_init(&twice, DYN_TENDON_TYPE_FIXED);
  dynTendonElement of_elbow;
  dyn_tendon_element_init(&of_elbow, DYN_TENDON_ELEMENT_TYPE_JOINT);
  of_elbow.name = "elbow", of_elbow.value = 2;
  dynTendon cord;
  dyn_tendon_init(&cord, DYN_TENDON_TYPE_SPATIAL);
  std::vector<dynTendonElement> ends(2);
  for (dynTendonElement& e : ends) dyn_tendon_element_init(&e, DYN_TENDON_ELEMENT_TYPE_SITE);
  ends[0].name = "universe", ends[1].name = "tool";
  dynActuator pulls;
  dyn_actuator_init(&pulls, DYN_ACTUATOR_TYPE_MOTOR);
  pulls.transmission = DYN_TRANSMISSION_SITE, pulls.wrench[2] = 1;
  user::Builder strung(model);
  strung.add_tendon("sum", twice, {of_elbow}).add_tendon("cord", cord, ends).couple_tendons("k", "sum", "", {});
  user::Data hung(strung.add_actuator("lift", pulls, "tool", "upper").finish());
  const user::Model& with_cords = hung.model();
  assert(with_cords.ntendons() == 2 && with_cords.tendon_name(with_cords.tendon_id("cord")) == "cord");
  assert(with_cords.tendon_info(0).elements == 1 && std::string(with_cords.tendon_element(0, 0).name) == "elbow");
  assert(status_of([&] { hung.tendon_path(1); }) == DYN_ERROR_ARGUMENT);
  const auto lengths = hung.tendons(q, v);
  assert(lengths.length[0] == 2 * q[1] && lengths.velocity[0] == 2 * v[1] && lengths.J(0, 0) == 0 && lengths.J(0, 1) == 2);
  std::vector<std::int32_t> begins;
  const auto path = hung.tendon_path(1, &begins);
  assert(path.cols == 2 && begins[0] == 1 && begins[1] == 0 && path(2, 1) == hung.frame_placement(tool)[11]);
  dynConstraint point;
  dyn_constraint_init(&point, DYN_CONSTRAINT_TYPE_CONNECT);
  point.first = tool;
  user::Data tied(user::Builder(model).add_constraint("pin", point, "tool").set_constraint_slots(2).finish());
  assert(tied.model().nconstraints() == 1 && tied.model().nconstraint_slots() == 3 && tied.model().constraint_name(tied.model().constraint_id("pin")) == "pin");
  assert(tied.model().constraint_info(0).type == DYN_CONSTRAINT_TYPE_CONNECT && tied.constraint_rows().second == 3);
  tied.anchor_constraint(0, q);
  const auto terms = tied.constraint_terms(q, v);
  assert(terms.J.rows == 3 && std::abs(terms.C[0]) < 1e-15 && terms.Jv.size() == 3 && terms.drift.size() == 3);
  assert(std::abs(tied.constraint_impulse(q, v).x[0]) < 1e-9 && tied.constrained_dynamics(q, user::Vector{0, 0}, tau).result.rank == 2);
  assert(std::abs(tied.constrained_dynamics(q, user::Vector{0, 0}, tau, user::none, user::ConstraintOptions().regularisation(1e-6)).x[1]) < 1e-9);
  assert(tied.constrained_inverse_dynamics(q, v, a).x.size() == 2 && tied.project(q).result.reason == DYN_CONSTRAINT_REASON_CONVERGED);
  const auto G = tied.delassus(q);
  assert(std::abs(tied.delassus_times(user::Vector{1, 0, 0})[0] - G(0, 0)) < 1e-12 && tied.delassus_factor().second.size() == 2);
  assert(tied.delassus_solve(user::Vector{1, 0, 0}, 1).size() == 3 && tied.constrained_dynamics_derivatives(q, v, tau).lambda_dq.rows == 3);
  assert(tied.constraint_impulse_derivatives(q, v).ddq_dv.cols == 2 && tied.constraint_report(q).first.redundant == 1);
  tied.set_constraint(1, tied.constraint(0)), tied.set_constraint_enabled(1, false), tied.clear_constraint(1);
  data.set_state(q, v);
  data.set_step_options(DYN_INTEGRATOR_RK4, 1e-3);
  data.step();
  data.advance(2e-3);
  assert(data.step_options().integrator == DYN_INTEGRATOR_RK4 && data.step_report().steps == 2);
  assert(std::abs(data.time() - 3e-3) < 1e-15);
  assert(status_of([&] { data.rnea(user::Vector{1}, v, a); }) == DYN_ERROR_SIZE);
  assert(status_of([&] { data.rnea(user::Vector{}, v, a); }) == DYN_ERROR_SIZE);
  assert(status_of([&] { data.set_state(q); data.field("M"); }) == DYN_ERROR_STALE);
  assert(status_of([&] { model.joint_id("nobody"); }) == DYN_ERROR_NAME);
  assert(status_of([&] { user::Model::load("nowhere.urdf"); }) == DYN_ERROR_FILE);
  user::Batch batch(model, 2);
  const user::Vector qs{0.3, -0.4, 1, 2, 0.3, -0.4}, vs{1, 2, 0, 0, 1, 2}, as{-1, 0.5, 0, 0, -1, 0.5};
  user::Vector taus(6);
  std::vector<dynStatus> states(3, DYN_ERROR_INTERNAL);
  batch.run(DYN_ALGORITHM_RNEA, 3, user::BatchArrays().q(qs).v(vs).a(as).out(0, taus).status(states));
  for (int i = 0; i < 2; ++i) assert(taus[std::size_t(i)] == tau[std::size_t(i)] && taus[std::size_t(4 + i)] == tau[std::size_t(i)]);
  assert(states == std::vector<dynStatus>(3, DYN_OK) && std::string(batch.info(DYN_ALGORITHM_RNEA).inputs) == "q v a fext");
  assert(status_of([&] { batch.run(DYN_ALGORITHM_RNEA, 3, user::BatchArrays().q(qs).v(v).out(0, taus)); }) == DYN_ERROR_SIZE);
  assert(status_of([&] { batch.run(DYN_ALGORITHM_CRBA, 3, user::BatchArrays().q(qs).out(0, taus)); }) == DYN_ERROR_SIZE);
  assert(status_of([&] { batch.run(DYN_ALGORITHM_RNEA, 3, user::BatchArrays().q(qs).v(user::Vector(6, NAN)).out(0, taus)); }) == DYN_ERROR_NONFINITE);
  assert(status_of([&] { user::Batch(model, 0); }) == DYN_ERROR_ARGUMENT);
  dynRollout play = user::rollout();
  user::Vector later(12);
  const dynSensorType com = DYN_SENSOR_TYPE_COM;
  user::Vector seen(3 * 2 * std::size_t(user::sensor_size(com)));
  play.steps = 10, play.every = 5, play.q0 = qs.data(), play.v0 = vs.data(), play.q = later.data();
  play.sensors = 1, play.sensor = &com, play.sensor_data = seen.data();
  batch.rollout(3, play);
  for (std::size_t i = 0; i < 4; ++i) assert(later[i] == later[8 + i]);
  assert(later[0] != later[2] && seen[2] < 0);
  play.every = 3;
  assert(status_of([&] { batch.rollout(3, play); }) == DYN_ERROR_ARGUMENT);
  std::vector<char> memory(user::Data::size(model));
  user::Data placed(model, DYN_PART_ALL, memory.data(), memory.size());
  user::Builder b("pendulum");
  b.set_gravity({0, 0, -1}).add_joint(user::JointSpec("hinge", DYN_JOINT_TYPE_REVOLUTE).axis({0, 1, 0})).add_body("bob", "hinge", 1, {0, 0, -1}, {});
  b.add_frame("tip", "hinge").add_configuration("up", {3.14});
  user::Data swing{b.finish()};
  assert(std::abs(swing.crba()[0] - 1) < 1e-12);
  user::Data moved = std::move(swing);
  assert(moved.model().nq() == 1);
  for (double t : tau) std::printf("%.17g\n", t);
}
"""


@pytest.mark.parametrize("beside", [False, True])
def test_program(tmp_path, beside):
    (tmp_path / "p.cpp").write_text(PROGRAM)
    library = Path(dyn.library_path).resolve()
    flags = ["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-I{CAPI.parent}/include", "p.cpp", "-o", "p",
             str(library)]
    subprocess.run([CXX, *(["-DBESIDE"] if beside else []), *flags, f"-Wl,-rpath,{library.parent}"], cwd=tmp_path, check=True)
    run = subprocess.run([str(tmp_path / "p"), ARM], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    expected = dyn.load_string(ARM, base="fixed").data().rnea([0.3, -0.4], [1, 2], [-1, 0.5])
    np.testing.assert_array_equal([float(line) for line in run.stdout.split()], expected)
