// Inertial parameters and their forms: no data, most of it no model.
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "algorithm/regressor.hpp"
#include "guard.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

struct Numbers {
  const char* name;
  const double* x;
  Index n;
};

// Given, and finite.
dynStatus check_input(const char* function, const Numbers& in, const void* out, const char* out_name) {
  if (!in.x || !out) return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, in.x ? out_name : in.name);
  if (const Index k = finite_count(in.x, in.n); k < in.n)
    return fail(DYN_ERROR_NONFINITE, "%s: %s[%d] is %s: give a finite number", function, in.name, int(k),
                in.x[k] != in.x[k] ? "NaN" : "infinite");
  return DYN_OK;
}

// Copies results that are finite.
dynStatus deliver(const char* function, const double* result, Index n, double* out) {
  if (finite_count(result, n) < n)
    return fail(DYN_ERROR_NUMERIC, "%s: the result overflows: the numbers are too large for double precision", function);
  copy_out(result, n, out);
  return DYN_OK;
}

}  // namespace

extern "C" {

dynStatus dyn_model_inertial_parameters(const dynModel* model, double* pi) {
  const DefaultFloatingPoint settings;
  if (const dynStatus s = check(model)) return s;
  if (!pi && parameter_count(*model->m))
    return fail(DYN_ERROR_ARGUMENT, "dyn_model_inertial_parameters: pi is NULL: it is required");
  inertial_parameters(*model->m, pi);
  return DYN_OK;
}

dynStatus dyn_body_regressor(const double velocity[6], const double acceleration[6], double Y[60]) {
  const DefaultFloatingPoint settings;
  for (const Numbers& in : {Numbers{"velocity", velocity, 6}, Numbers{"acceleration", acceleration, 6}})
    if (const dynStatus s = check_input("dyn_body_regressor", in, Y, "Y")) return s;
  const Motion<double> v = load_motion(velocity), a = load_motion(acceleration);
  Force<double> F[10];
  body_regressor(Mat3<double>::identity(), v.angular, a.angular, a.linear + cross(v.angular, v.linear), F);
  double result[60];
  for (int c = 0; c < 10; ++c) store6(F[c], result + 6 * c);
  return deliver("dyn_body_regressor", result, 60, Y);
}

dynStatus dyn_pseudo_inertia_from_parameters(const double pi[10], double J[16]) {
  const DefaultFloatingPoint settings;
  if (const dynStatus s = check_input("dyn_pseudo_inertia_from_parameters", {"pi", pi, 10}, J, "J")) return s;
  double result[16];
  pseudo_inertia(pi, result);
  return deliver("dyn_pseudo_inertia_from_parameters", result, 16, J);
}

dynStatus dyn_parameters_from_pseudo_inertia(const double J[16], double pi[10]) {
  const DefaultFloatingPoint settings;
  if (const dynStatus s = check_input("dyn_parameters_from_pseudo_inertia", {"J", J, 16}, pi, "pi")) return s;
  double largest = 0;
  for (int k = 0; k < 16; ++k) largest = std::max(largest, std::abs(J[k]));
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < c; ++r)
      if (std::abs(J[r + 4 * c] - J[c + 4 * r]) > 1e-9 * largest)
        return fail(DYN_ERROR_ARGUMENT,
                    "dyn_parameters_from_pseudo_inertia: J is not symmetric: J[%d, %d] is %g, J[%d, %d] is %g", r, c,
                    J[r + 4 * c], c, r, J[c + 4 * r]);
  double result[10];
  parameters_of_pseudo_inertia(J, result);
  return deliver("dyn_parameters_from_pseudo_inertia", result, 10, pi);
}

dynStatus dyn_log_cholesky_from_parameters(const double pi[10], double theta[10]) {
  const DefaultFloatingPoint settings;
  if (const dynStatus s = check_input("dyn_log_cholesky_from_parameters", {"pi", pi, 10}, theta, "theta")) return s;
  double result[10];
  if (!log_cholesky(pi, result))
    return fail(DYN_ERROR_INVALID,
                "dyn_log_cholesky_from_parameters: no body has these parameters: %s; see dyn_is_physically_consistent",
                pi[0] > 0 ? "the pseudo-inertia is not positive definite" : "the mass is not positive");
  return deliver("dyn_log_cholesky_from_parameters", result, 10, theta);
}

dynStatus dyn_parameters_from_log_cholesky(const double theta[10], double pi[10]) {
  const DefaultFloatingPoint settings;
  if (const dynStatus s = check_input("dyn_parameters_from_log_cholesky", {"theta", theta, 10}, pi, "pi")) return s;
  double result[10];
  parameters_of_log_cholesky(theta, result);
  return deliver("dyn_parameters_from_log_cholesky", result, 10, pi);
}

dynStatus dyn_log_cholesky_jacobian(const double theta[10], double jacobian[100]) {
  const DefaultFloatingPoint settings;
  if (const dynStatus s = check_input("dyn_log_cholesky_jacobian", {"theta", theta, 10}, jacobian, "jacobian")) return s;
  double result[100];
  log_cholesky_jacobian(theta, result);
  return deliver("dyn_log_cholesky_jacobian", result, 100, jacobian);
}

dynStatus dyn_is_physically_consistent(const double pi[10], int* consistent) {
  const DefaultFloatingPoint settings;
  if (const dynStatus s = check_input("dyn_is_physically_consistent", {"pi", pi, 10}, consistent, "consistent")) return s;
  double J[16], U[16];
  pseudo_inertia(pi, J);
  *consistent = upper_cholesky(J, U);
  return DYN_OK;
}

}  // extern "C"
