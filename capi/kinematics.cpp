// Kinematics: thin wrappers. Each checks its inputs, sets them, computes, and copies out.
#include <cmath>

#include "checks.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// The level of kinematics that the given arguments ask for; all of it where they have no numbers and may be NULL for that.
int level_of(const Model& m, const double* v, const double* a) { return a || m.n.nv == 0 ? 2 : v ? 1 : 0; }

void kinematics(const Model& m, Data<double>& d, int level) {
  if (level == 2) ensure_acceleration(m, d);
  else if (level == 1) ensure_velocity(m, d);
  else ensure_position(m, d);
}

constexpr double max_acceleration = most * most;

// The first body whose vector has a component beyond the bound (or none at all: NaN), or n.
Index beyond(const Vec3<double>* x, Index n, double bound) {
  for (Index i = 0; i < n; ++i)
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(x[i][c]) <= bound)) return i;
  return n;
}

}  // namespace

bool dyn::capi::no_overflow(Call& call, int level, double bound) {
  const Model& m = call.m();
  Data<double>& d = call.d();
  // the sum over all of them is within the bound nearly always
  if (d.extent[0] <= bound && (level < 1 || d.extent[1] <= most) && (level < 2 || d.extent[2] <= max_acceleration)) return true;
  const struct {
    const Vec3<double>* x;
    int level;
    double bound;
    const char* what;
  } rows[] = {{d.p, 0, bound, "placement"}, {d.omega, 1, most, "velocity"}, {d.vel, 1, most, "velocity"},
              {d.alpha, 2, max_acceleration, "acceleration"}, {d.acc, 2, max_acceleration, "acceleration"}};
  for (const auto& r : rows) {
    if (r.level > level) break;
    const Index i = beyond(r.x, m.n.bodies, r.bound);
    if (i == m.n.bodies) continue;
    d.invalidate(Stage::Position), d.invalidate(Stage::Velocity), d.invalidate(Stage::Acceleration);
    call.drop_results();
    call.rollback();
    call.status = fail(DYN_ERROR_NUMERIC, "%s: the %s of joint '%s' overflows: the inputs are too large for double precision",
                       call.function, r.what, m.string(m.joints()[m.bodies()[i].joint].name));
    return false;
  }
  return true;
}

// The same for what a frame query reads, which another call may have computed without looking.
bool dyn::capi::no_overflow_frame(Call& call, int frame, int level, double bound) {
  const Model& m = call.m();
  const Data<double>& d = call.d();
  for (Index i = m.frames()[frame].body; i != 0; i = m.bodies()[i].parent) {
    bool good = beyond(d.p + i, 1, bound) == 1;
    if (level >= 1) good = good && beyond(d.omega + i, 1, bound) == 1 && beyond(d.vel + i, 1, bound) == 1;
    if (level >= 2) good = good && beyond(d.alpha + i, 1, bound * bound) == 1 && beyond(d.acc + i, 1, bound * bound) == 1;
    if (!good) {
      call.status = fail(DYN_ERROR_NUMERIC, "%s: the motion of joint '%s' overflows: the state is too large for double precision",
                         call.function, m.string(m.joints()[m.bodies()[i].joint].name));
      return false;
    }
  }
  return true;
}

extern "C" {

dynStatus dyn_forward_kinematics(const dynModel* model, dynData* data, const double* q, const double* v, const double* a) {
  Call call(model, data, DYN_PART_KINEMATICS, "dyn_forward_kinematics");
  if (!call || !call.inputs(q, v, a, nullptr)) return call.status;
  const int level = level_of(call.m(), v, a);
  kinematics(call.m(), call.d(), level);
  no_overflow(call, level);
  return call.status;
}

dynStatus dyn_frame_placement(const dynModel* model, dynData* data, int frame, double placement[12]) {
  Call call(model, data, 0, "dyn_frame_placement");
  if (!call || !call.frame(frame) || !call.required("placement", placement) ||
      !call.fresh(Stage::Position, "the placement", "dyn_forward_kinematics"))
    return call.status;
  if (no_overflow_frame(call, frame, 0)) frame_placement(call.m(), call.d(), frame, placement);
  return call.status;
}

dynStatus dyn_frame_placements(const dynModel* model, dynData* data, double* placements) {
  Call call(model, data, DYN_PART_FRAMES, "dyn_frame_placements");
  if (!call || !call.fresh(Stage::Position, "the placement", "dyn_forward_kinematics") || !no_overflow(call, 0))
    return call.status;
  const Model& m = call.m();
  for (Index k = 0; k < m.n.frames; ++k) frame_placement(m, call.d(), k, call.d().placements + 12 * std::ptrdiff_t(k));
  call.d().mark_fresh(Stage::Frames);
  copy_out(call.d().placements, 12 * std::ptrdiff_t(m.n.frames), placements);
  return DYN_OK;
}

dynStatus dyn_frame_velocity(const dynModel* model, dynData* data, int frame, dynReference reference, double velocity[6]) {
  Call call(model, data, DYN_PART_KINEMATICS, "dyn_frame_velocity");
  if (!call || !call.frame(frame) || !call.reference(reference) || !call.required("velocity", velocity) ||
      !call.fresh(Stage::Velocity, "the velocity", "dyn_forward_kinematics with q and v"))
    return call.status;
  if (no_overflow_frame(call, frame, 1)) frame_velocity(call.m(), call.d(), frame, reference, velocity);
  return call.status;
}

static dynStatus acceleration(const dynModel* model, dynData* data, int frame, dynReference reference, double* out,
                              bool classical, const char* function) {
  Call call(model, data, DYN_PART_KINEMATICS, function);
  if (!call || !call.frame(frame) || !call.reference(reference) || !call.required("acceleration", out) ||
      !call.fresh(Stage::Acceleration, "the acceleration", "dyn_forward_kinematics with q, v and a"))
    return call.status;
  if (no_overflow_frame(call, frame, 2)) frame_acceleration(call.m(), call.d(), frame, reference, classical, out);
  return call.status;
}

dynStatus dyn_frame_acceleration(const dynModel* model, dynData* data, int frame, dynReference reference, double a[6]) {
  return acceleration(model, data, frame, reference, a, false, "dyn_frame_acceleration");
}

dynStatus dyn_frame_classical_acceleration(const dynModel* model, dynData* data, int frame, dynReference reference, double a[6]) {
  return acceleration(model, data, frame, reference, a, true, "dyn_frame_classical_acceleration");
}

dynStatus dyn_joint_jacobians(const dynModel* model, dynData* data, const double* q, double* J) {
  Call call(model, data, DYN_PART_JACOBIANS, "dyn_joint_jacobians");
  if (!call || !call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  joint_jacobians(call.m(), call.d());
  if (!no_overflow(call, 0)) return call.status;
  copy_out(call.d().J, 6 * call.m().n.nv, J);
  return DYN_OK;
}

dynStatus dyn_joint_jacobians_time_variation(const dynModel* model, dynData* data, const double* q, const double* v, double* dJ) {
  Call call(model, data, DYN_PART_JACOBIANS, "dyn_joint_jacobians_time_variation");
  if (!call || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  joint_jacobians_time_variation(call.m(), call.d());
  if (!call.numeric(call.d().dJ, 6 * call.m().n.nv, "dJ", Stage::DJacobians)) return call.status;
  copy_out(call.d().dJ, 6 * call.m().n.nv, dJ);
  return DYN_OK;
}

dynStatus dyn_frame_jacobian(const dynModel* model, dynData* data, int frame, dynReference reference, double* J) {
  Call call(model, data, 0, "dyn_frame_jacobian");
  if (!call || !call.frame(frame) || !call.reference(reference) || !call.required("J", J, call.m().n.nv) ||
      !call.fresh(Stage::Position, "the Jacobian's configuration", "dyn_forward_kinematics"))
    return call.status;
  if (no_overflow_frame(call, frame, 0)) frame_jacobian(call.m(), call.d(), frame, reference, J);
  return call.status;
}

dynStatus dyn_frame_jacobian_time_variation(const dynModel* model, dynData* data, int frame, dynReference reference, double* dJ) {
  Call call(model, data, DYN_PART_KINEMATICS, "dyn_frame_jacobian_time_variation");
  if (!call || !call.frame(frame) || !call.reference(reference) || !call.required("dJ", dJ, call.m().n.nv) ||
      !call.fresh(Stage::Velocity, "the velocity", "dyn_forward_kinematics with q and v"))
    return call.status;
  if (no_overflow_frame(call, frame, 1)) frame_jacobian_time_variation(call.m(), call.d(), frame, reference, dJ);
  return call.status;
}

dynStatus dyn_com(const dynModel* model, dynData* data, const double* q, const double* v, const double* a, double* com,
                             double* vcom, double* acom) {
  Call call(model, data, DYN_PART_COM, "dyn_com");
  if (!call || !call.inputs(q, v, a, nullptr)) return call.status;
  Data<double>& d = call.d();
  const int level = acom ? 2 : vcom ? (a ? 2 : 1) : level_of(call.m(), v, a);
  center_of_mass(call.m(), d, level);
  if (!no_overflow(call, 0) || !call.numeric(d.com, 3, "com", Stage::Com) ||
      (level >= 1 && !call.numeric(d.vcom, 3, "vcom", Stage::Vcom)) ||
      (level >= 2 && !call.numeric(d.acom, 3, "acom", Stage::Acom)))
    return call.status;
  copy_out(d.com, 3, com), copy_out(d.vcom, 3, vcom), copy_out(d.acom, 3, acom);
  return DYN_OK;
}

dynStatus dyn_jcom(const dynModel* model, dynData* data, const double* q, double* Jcom) {
  Call call(model, data, DYN_PART_COM, "dyn_jcom");
  if (!call || !call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  Data<double>& d = call.d();
  if (!d.fresh(Stage::Com) || !d.fresh(Stage::Position)) center_of_mass(call.m(), d, 0);
  if (!no_overflow(call, 0) || !call.numeric(d.com, 3, "com", Stage::Com)) return call.status;
  center_of_mass_jacobian(call.m(), d, 0, d.Jcom);
  d.mark_fresh(Stage::Jcom);
  copy_out(d.Jcom, 3 * call.m().n.nv, Jcom);
  return DYN_OK;
}

// A subtree has no mass, or one that can be divided by.
static bool weighable(Call& call, int joint) {
  const double mass = call.d().msub[call.m().joints()[joint].first_body];
  if (mass > 0 && !std::isfinite(1 / mass))
    call.status = fail(DYN_ERROR_NUMERIC, "%s: the subtree of joint '%s' has a mass of %g kg: too small for double precision",
                       call.function, call.m().string(call.m().joints()[joint].name), mass);
  return call.status == DYN_OK;
}

dynStatus dyn_subtree_com(const dynModel* model, dynData* data, int joint, double com[3], double* mass) {
  Call call(model, data, DYN_PART_COM, "dyn_subtree_com");
  if (!call || !call.joint(joint) || !call.fresh(Stage::Com, "the centre of mass", "dyn_com")) return call.status;
  if (!weighable(call, joint)) return call.status;
  const Data<double>& d = call.d();
  const Index body = call.m().joints()[joint].first_body;
  const double total = d.msub[body];
  if (com) store3(d.p[body] + d.hsub[body] * (total > 0 ? 1 / total : 0), com);
  if (mass) *mass = total;
  return DYN_OK;
}

dynStatus dyn_subtree_jcom(const dynModel* model, dynData* data, int joint, double* J) {
  Call call(model, data, DYN_PART_COM, "dyn_subtree_jcom");
  if (!call || !call.joint(joint) || !call.required("J", J, call.m().n.nv) ||
      !call.fresh(Stage::Com, "the centre of mass", "dyn_com"))
    return call.status;
  if (weighable(call, joint)) center_of_mass_jacobian(call.m(), call.d(), call.m().joints()[joint].first_body, J);
  return call.status;
}

}  // extern "C"
