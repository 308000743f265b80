// Dynamics and energy: thin wrappers, as in kinematics.cpp.
#include <cmath>

#include "checks.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

constexpr const double* none = nullptr;

// Inverse dynamics into a field; v and a may be the zeros of data.
dynStatus inverse(Call& call, const double* v, const double* a, const double* fext, double* field, Stage stage, const char* name,
                  double* out) {
  const Model& m = call.m();
  if (stage == Stage::Gravity) rigid_inverse_dynamics(m, call.d(), v, a, fext, field);
  else inverse_dynamics(m, call.d(), v, a, fext, field);
  if (!call.numeric(field, m.n.nv, name, stage)) return call.status;
  call.d().mark_fresh(stage);
  copy_out(field, m.n.nv, out);
  return DYN_OK;
}

}  // namespace

dynStatus dyn::capi::singular(Call& call, Index joint, Stage stage) {
  call.drop_results();
  call.d().invalidate(stage);
  call.d().invalidate(Stage::Factor);  // it may have been half written
  call.rollback();
  const Model& m = call.m();
  return fail(DYN_ERROR_NUMERIC,
              "forward dynamics is singular at joint '%s': its articulated inertia is not positive there; add armature or leave "
              "this configuration",
              m.string(m.joints()[joint].name));
}

bool dyn::capi::finite_mass(Call& call) {
  if (!no_overflow(call, 0)) return false;
  return call.m().no_overflow || call.numeric(call.d().M, std::ptrdiff_t(call.m().n.nv) * call.m().n.nv, "M", Stage::Mass);
}

dynStatus dyn::capi::factor(Call& call) {
  if (const Index failed = factorize(call.m(), call.d())) {
    call.d().invalidate(Stage::Factor);
    const Model& m = call.m();
    const char* name = "?";
    for (Index j = 1; j < m.n.joints; ++j)
      if (m.joints()[j].idx_v <= failed - 1) name = m.joints()[j].nv ? m.string(m.joints()[j].name) : name;
    call.rollback();
    return call.status = fail(DYN_ERROR_NUMERIC,
                              "M is not positive at joint '%s': this configuration is singular; add armature or leave it", name);
  }
  return DYN_OK;
}

extern "C" {

dynStatus dyn_rnea(const dynModel* model, dynData* data, const double* q, const double* v, const double* a, const double* fext,
                   double* tau) {
  Call call(model, data, DYN_PART_INVERSE, "dyn_rnea");
  if (!call || !check_fext(call, fext) || !call.inputs(q, v, a, nullptr)) return call.status;
  Data<double>& d = call.d();
  return inverse(call, d.v, d.a, fext, d.tau, Stage::Tau, "tau", tau);
}

dynStatus dyn_nle(const dynModel* model, dynData* data, const double* q, const double* v, double* nle) {
  Call call(model, data, DYN_PART_INVERSE, "dyn_nle");
  if (!call || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  Data<double>& d = call.d();
  return inverse(call, d.v, d.zero, none, d.nle, Stage::Nle, "nle", nle);
}

dynStatus dyn_gravity_torque(const dynModel* model, dynData* data, const double* q, double* g) {
  Call call(model, data, DYN_PART_INVERSE, "dyn_gravity_torque");
  if (!call || !call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  Data<double>& d = call.d();
  return inverse(call, d.zero, d.zero, none, d.g, Stage::Gravity, "g", g);
}

dynStatus dyn_static_torque(const dynModel* model, dynData* data, const double* q, const double* fext, double* tau) {
  Call call(model, data, DYN_PART_INVERSE, "dyn_static_torque");
  if (!call || !check_fext(call, fext) || !call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  Data<double>& d = call.d();
  return inverse(call, d.zero, d.zero, fext, d.static_torque, Stage::Static, "static_torque", tau);
}

dynStatus dyn_coriolis_matrix(const dynModel* model, dynData* data, const double* q, const double* v, double* C) {
  Call call(model, data, DYN_PART_CORIOLIS, "dyn_coriolis_matrix");
  if (!call || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  Data<double>& d = call.d();
  const std::ptrdiff_t nv = call.m().n.nv;
  coriolis_matrix(call.m(), d);
  if (!call.numeric(d.coriolis, nv * nv, "coriolis", Stage::Coriolis)) return call.status;
  copy_out(d.coriolis, nv * nv, C);
  return DYN_OK;
}

dynStatus dyn_aba(const dynModel* model, dynData* data, const double* q, const double* v, const double* tau, const double* fext,
                  double* ddq) {
  Call call(model, data, DYN_PART_FORWARD, "dyn_aba");
  if (!call || !check_fext(call, fext)) return call.status;
  if (call.m().has_mimic && !call.d().has(DYN_PART_CHOLESKY))
    return fail(DYN_ERROR_PART,
                "dyn_aba: the model has mimic joints, so that it needs part DYN_PART_CHOLESKY as well: name it in dyn_data_new");
  if (!call.inputs(q, v, nullptr, tau)) return call.status;
  Data<double>& d = call.d();
  if (const Index joint = forward_dynamics(call.m(), d, d.v, d.tau_applied, fext, d.ddq))
    return singular(call, joint, Stage::Ddq);
  if (!call.numeric(d.ddq, call.m().n.nv, "ddq", Stage::Ddq)) return call.status;
  d.mark_fresh(Stage::Ddq);
  copy_out(d.ddq, call.m().n.nv, ddq);
  return DYN_OK;
}

dynStatus dyn_crba(const dynModel* model, dynData* data, const double* q, double* M) {
  Call call(model, data, DYN_PART_MASS, "dyn_crba");
  if (!call || !call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  Data<double>& d = call.d();
  crba(call.m(), d);
  if (!finite_mass(call)) return call.status;
  copy_out(d.M, std::ptrdiff_t(call.m().n.nv) * call.m().n.nv, M);
  return DYN_OK;
}

dynStatus dyn_cholesky(const dynModel* model, dynData* data) {
  Call call(model, data, DYN_PART_CHOLESKY, "dyn_cholesky");
  if (!call || !call.fresh(Stage::Mass, "M", "dyn_crba")) return call.status;
  return factor(call);
}

dynStatus dyn_cholesky_solve(const dynModel* model, dynData* data, const double* b, int nrhs, double* x) {
  Call call(model, data, DYN_PART_CHOLESKY, "dyn_cholesky_solve");
  if (!call) return call.status;
  const Index numbers = nrhs == 0 ? 0 : call.m().n.nv;
  if (!call.required("b", b, numbers) || !call.required("x", x, numbers)) return call.status;
  if (nrhs < 0) return fail(DYN_ERROR_ARGUMENT, "dyn_cholesky_solve: nrhs is %d: it can't be negative", nrhs);
  const std::ptrdiff_t nv = call.m().n.nv;
  for (int k = 0; k < nrhs; ++k)
    if (!call.finite("b", b + nv * k, Index(nv))) return call.status;
  if (!call.fresh(Stage::Factor, "the factor of M", "dyn_cholesky")) return call.status;
  double* before = call.d().backup;  // this call replaces no input
  for (int k = 0; k < nrhs; ++k, b += nv, x += nv) {
    if (solve(call.m(), call.d(), b, x, before)) continue;
    const Index bad = finite_count(x, Index(nv));
    if (bad == nv) continue;
    copy_out(before, nv, x);
    return fail(DYN_ERROR_NUMERIC,
                "dyn_cholesky_solve: x[%d] of right-hand side %d overflows: b is too large for double precision; x is written "
                "before this one",
                int(bad), k);
  }
  return DYN_OK;
}

dynStatus dyn_minv(const dynModel* model, dynData* data, const double* q, double* Minv) {
  Call call(model, data, DYN_PART_MINV, "dyn_minv");
  if (!call || !call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  Data<double>& d = call.d();
  if (const Index failed = minverse(call.m(), d)) return singular(call, failed, Stage::Minv);
  const bool finite = d.fresh(Stage::Mass) ? finite_mass(call) : no_overflow(call, 0);
  if (!finite || !call.numeric(d.Minv, std::ptrdiff_t(call.m().n.nv) * call.m().n.nv, "Minv", Stage::Minv)) return call.status;
  copy_out(d.Minv, std::ptrdiff_t(call.m().n.nv) * call.m().n.nv, Minv);
  return DYN_OK;
}

static bool energies(Call& call) {
  Data<double>& d = call.d();
  kinetic_energy(call.m(), d);
  potential_energy(call.m(), d);
  d.mechanical[0] = d.kinetic[0] + d.potential[0];
  d.mark_fresh(Stage::Mechanical);
  return call.numeric(d.mechanical, 1, "energy", Stage::Mechanical);
}

dynStatus dyn_energy(const dynModel* model, dynData* data, const double* q, const double* v, double* kinetic, double* potential) {
  Call call(model, data, DYN_PART_ENERGY, "dyn_energy");
  if (!call || !call.inputs(q, v, nullptr, nullptr) || !energies(call)) return call.status;
  copy_out(call.d().kinetic, 1, kinetic), copy_out(call.d().potential, 1, potential);
  return DYN_OK;
}

dynStatus dyn_kinetic_energy(const dynModel* model, dynData* data, const double* q, const double* v, double* kinetic) {
  Call call(model, data, DYN_PART_ENERGY, "dyn_kinetic_energy");
  if (!call || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  kinetic_energy(call.m(), call.d());
  if (call.numeric(call.d().kinetic, 1, "energy", Stage::Kinetic)) copy_out(call.d().kinetic, 1, kinetic);
  return call.status;
}

dynStatus dyn_potential_energy(const dynModel* model, dynData* data, const double* q, double* potential) {
  Call call(model, data, DYN_PART_ENERGY, "dyn_potential_energy");
  if (!call || !call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  potential_energy(call.m(), call.d());
  if (call.numeric(call.d().potential, 1, "energy", Stage::Potential)) copy_out(call.d().potential, 1, potential);
  return call.status;
}

dynStatus dyn_all_terms(const dynModel* model, dynData* data, uint32_t mask, const double* q, const double* v, uint32_t* filled) {
  static constexpr struct {
    uint32_t term;
    dynParts part;
    Stage stage;
  } needs[] = {{DYN_TERM_KINEMATICS, DYN_PART_KINEMATICS, Stage::Velocity},
               {DYN_TERM_FRAMES, DYN_PART_FRAMES, Stage::Frames},
               {DYN_TERM_JACOBIANS, DYN_PART_JACOBIANS, Stage::Jacobians},
               {DYN_TERM_JACOBIANS_TIME_VARIATION, DYN_PART_JACOBIANS, Stage::DJacobians},
               {DYN_TERM_COM, DYN_PART_COM, Stage::Vcom},
               {DYN_TERM_JCOM, DYN_PART_COM, Stage::Jcom},
               {DYN_TERM_NLE, DYN_PART_INVERSE, Stage::Nle},
               {DYN_TERM_GRAVITY_TORQUE, DYN_PART_INVERSE, Stage::Gravity},
               {DYN_TERM_MASS, DYN_PART_MASS, Stage::Mass},
               {DYN_TERM_CHOLESKY, DYN_PART_CHOLESKY, Stage::Factor},
               {DYN_TERM_MINV, DYN_PART_MINV, Stage::Minv},
               {DYN_TERM_CORIOLIS, DYN_PART_CORIOLIS, Stage::Coriolis},
               {DYN_TERM_ENERGY, DYN_PART_ENERGY, Stage::Mechanical}};
  dynParts parts = 0;
  for (const auto& n : needs)
    if (mask & n.term) parts |= n.part;
  Call call(model, data, parts, "dyn_all_terms");
  if (!call) return call.status;
  if (mask & ~uint32_t(DYN_TERM_ALL))
    return fail(DYN_ERROR_ARGUMENT, "dyn_all_terms: mask 0x%x has unknown bits: use DYN_TERM_... values", unsigned(mask));
  if (!call.inputs(q, v, nullptr, nullptr)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  const std::ptrdiff_t nv = m.n.nv;
  const bool velocities =
      mask & (DYN_TERM_KINEMATICS | DYN_TERM_JACOBIANS_TIME_VARIATION | DYN_TERM_COM | DYN_TERM_CORIOLIS | DYN_TERM_ENERGY);
  const bool level = velocities && d.has(DYN_PART_KINEMATICS);
  if (level) ensure_velocity(m, d);
  else ensure_position(m, d);
  if (!no_overflow(call, level)) return call.status;
  if (mask & DYN_TERM_JACOBIANS && !(mask & DYN_TERM_JACOBIANS_TIME_VARIATION)) joint_jacobians(m, d);
  if (mask & DYN_TERM_JACOBIANS_TIME_VARIATION) {
    joint_jacobians_time_variation(m, d);
    if (!call.numeric(d.dJ, Index(6 * nv), "dJ", Stage::DJacobians)) return call.status;
  }
  if (mask & (DYN_TERM_COM | DYN_TERM_JCOM)) {
    center_of_mass(m, d, mask & DYN_TERM_COM ? 1 : 0);
    if (!call.numeric(d.com, 3, "com", Stage::Com) || (mask & DYN_TERM_COM && !call.numeric(d.vcom, 3, "vcom", Stage::Vcom)))
      return call.status;
  }
  if (mask & DYN_TERM_JCOM) center_of_mass_jacobian(m, d, 0, d.Jcom), d.mark_fresh(Stage::Jcom);
  if (mask & DYN_TERM_NLE) {
    inverse_dynamics(m, d, d.v, d.zero, none, d.nle);
    if (!call.numeric(d.nle, m.n.nv, "nle", Stage::Nle)) return call.status;
    d.mark_fresh(Stage::Nle);
  }
  if (mask & DYN_TERM_GRAVITY_TORQUE) {
    rigid_inverse_dynamics(m, d, d.zero, d.zero, none, d.g);
    if (!call.numeric(d.g, m.n.nv, "g", Stage::Gravity)) return call.status;
    d.mark_fresh(Stage::Gravity);
  }
  if (mask & (DYN_TERM_MASS | DYN_TERM_CHOLESKY | DYN_TERM_MINV)) {
    crba(m, d);
    if (!finite_mass(call)) return call.status;
  }
  if (mask & (DYN_TERM_CHOLESKY | DYN_TERM_MINV) && factor(call) != DYN_OK) return call.status;
  if (mask & DYN_TERM_MINV) {
    if (const Index failed = minverse(m, d)) return singular(call, failed, Stage::Minv);
    if (!call.numeric(d.Minv, nv * nv, "Minv", Stage::Minv)) return call.status;
  }
  if (mask & DYN_TERM_CORIOLIS) {
    coriolis_matrix(m, d);
    if (!call.numeric(d.coriolis, nv * nv, "coriolis", Stage::Coriolis)) return call.status;
  }
  if (mask & DYN_TERM_ENERGY && !energies(call)) return call.status;
  if (mask & DYN_TERM_FRAMES) {
    for (Index k = 0; k < m.n.frames; ++k) frame_placement(m, d, k, d.placements + 12 * std::ptrdiff_t(k));
    d.mark_fresh(Stage::Frames);
  }
  if (filled) {
    *filled = 0;
    for (const auto& n : needs)
      if (d.fresh(n.stage)) *filled |= n.term;
  }
  return DYN_OK;
}

}  // extern "C"
