// Regressors: thin wrappers.
#include "algorithm/regressor.hpp"

#include "guard.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// A field of data is computed: finite and copied out, or the inputs of this call are taken back.
dynStatus deliver(Call& call, const double* field, std::ptrdiff_t n, const char* name, Stage stage, double* out) {
  if (call.numeric(field, n, name, stage)) copy_out(field, n, out);
  return call.status;
}

// The 6 x 10 regressor of a body seen from a frame.
dynStatus of_frame(Call& call, const FramePose<double>& F, double* out) {
  double Y[60];
  frame_body_regressor(call.d(), F, Y);
  if (finite_count(Y, 60) < 60)
    return fail(DYN_ERROR_NUMERIC, "%s: the regressor overflows: the state is too large for double precision", call.function);
  copy_out(Y, 60, out);
  return DYN_OK;
}

}  // namespace

extern "C" {

dynStatus dyn_joint_torque_regressor(const dynModel* model, dynData* data, const double* q, const double* v, const double* a,
                                     double* Y) {
  Call call(model, data, DYN_PART_REGRESSOR, "dyn_joint_torque_regressor");
  if (!call || !call.inputs(q, v, a, nullptr)) return call.status;
  const double size = joint_torque_regressor(call.m(), call.d());
  const std::ptrdiff_t n = std::ptrdiff_t(call.m().n.nv) * parameter_count(call.m());
  if (!(size < 1e100) && !call.numeric(call.d().regressor, n, "regressor", Stage::TorqueRegressor)) return call.status;
  copy_out(call.d().regressor, n, Y);
  return DYN_OK;
}

dynStatus dyn_static_regressor(const dynModel* model, dynData* data, const double* q, double* Y) {
  Call call(model, data, DYN_PART_REGRESSOR, "dyn_static_regressor");
  if (!call || !call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  static_regressor(call.m(), call.d());
  return deliver(call, call.d().static_regressor, 3 * parameter_count(call.m()), "static_regressor", Stage::StaticRegressor, Y);
}

dynStatus dyn_kinetic_energy_regressor(const dynModel* model, dynData* data, const double* q, const double* v, double* y) {
  Call call(model, data, DYN_PART_REGRESSOR, "dyn_kinetic_energy_regressor");
  if (!call || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  kinetic_energy_regressor(call.m(), call.d());
  return deliver(call, call.d().kinetic_energy_regressor, parameter_count(call.m()), "kinetic_energy_regressor",
                 Stage::KineticRegressor, y);
}

dynStatus dyn_potential_energy_regressor(const dynModel* model, dynData* data, const double* q, double* y) {
  Call call(model, data, DYN_PART_REGRESSOR, "dyn_potential_energy_regressor");
  if (!call || !call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  potential_energy_regressor(call.m(), call.d());
  return deliver(call, call.d().potential_energy_regressor, parameter_count(call.m()), "potential_energy_regressor",
                 Stage::PotentialRegressor, y);
}

dynStatus dyn_joint_body_regressor(const dynModel* model, dynData* data, int joint, double Y[60]) {
  Call call(model, data, DYN_PART_KINEMATICS, "dyn_joint_body_regressor");
  if (!call || !call.joint(joint) || !call.required("Y", Y) ||
      !call.fresh(Stage::Acceleration, "the acceleration", "dyn_forward_kinematics with q, v and a"))
    return call.status;
  return of_frame(call, joint_pose(call.m(), call.d(), joint), Y);
}

dynStatus dyn_frame_body_regressor(const dynModel* model, dynData* data, int frame, double Y[60]) {
  Call call(model, data, DYN_PART_KINEMATICS, "dyn_frame_body_regressor");
  if (!call || !call.frame(frame) || !call.required("Y", Y) ||
      !call.fresh(Stage::Acceleration, "the acceleration", "dyn_forward_kinematics with q, v and a"))
    return call.status;
  return of_frame(call, frame_pose(call.m(), call.d(), frame), Y);
}

}  // extern "C"
