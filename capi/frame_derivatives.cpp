// Derivatives of frame motions: thin wrappers.
#include "checks.hpp"

using namespace dyn;
using namespace dyn::capi;

static dynStatus acceleration_derivatives(const dynModel* model, dynData* data, int frame, dynReference reference, bool classical,
                                          double* da_dq, double* da_dv, double* da_da, const char* function) {
  Call call(model, data, DYN_PART_KINEMATICS, function);
  if (!call || !call.frame(frame) || !call.reference(reference) ||
      !call.fresh(Stage::Acceleration, "the acceleration", "dyn_forward_kinematics with q, v and a"))
    return call.status;
  if (no_overflow_frame(call, frame, 2, max_to_differentiate))
    frame_acceleration_derivatives(call.m(), call.d(), frame, reference, classical, da_dq, da_dv, da_da);
  return call.status;
}

extern "C" {

dynStatus dyn_frame_velocity_derivatives(const dynModel* model, dynData* data, int frame, dynReference reference, double* dv_dq,
                                         double* dv_dv) {
  Call call(model, data, DYN_PART_KINEMATICS, "dyn_frame_velocity_derivatives");
  if (!call || !call.frame(frame) || !call.reference(reference) ||
      !call.fresh(Stage::Velocity, "the velocity", "dyn_forward_kinematics with q and v"))
    return call.status;
  if (no_overflow_frame(call, frame, 1, max_to_differentiate))
    frame_velocity_derivatives(call.m(), call.d(), frame, reference, dv_dq, dv_dv);
  return call.status;
}

dynStatus dyn_frame_acceleration_derivatives(const dynModel* model, dynData* data, int frame, dynReference reference,
                                             double* da_dq, double* da_dv, double* da_da) {
  return acceleration_derivatives(model, data, frame, reference, false, da_dq, da_dv, da_da,
                                  "dyn_frame_acceleration_derivatives");
}

dynStatus dyn_frame_classical_acceleration_derivatives(const dynModel* model, dynData* data, int frame, dynReference reference,
                                                       double* da_dq, double* da_dv, double* da_da) {
  return acceleration_derivatives(model, data, frame, reference, true, da_dq, da_dv, da_da,
                                  "dyn_frame_classical_acceleration_derivatives");
}

dynStatus dyn_frame_kinematic_hessian(const dynModel* model, dynData* data, int frame, dynReference reference, double* H) {
  Call call(model, data, DYN_PART_JACOBIANS, "dyn_frame_kinematic_hessian");
  if (!call || !call.frame(frame) || !call.reference(reference) || !call.required("H", H) ||
      !call.fresh(Stage::Position, "the Jacobian's configuration", "dyn_forward_kinematics"))
    return call.status;
  if (no_overflow_frame(call, frame, 0)) frame_kinematic_hessian(call.m(), call.d(), frame, reference, H);
  return call.status;
}

}  // extern "C"
