// Operations on configurations: no data, the model alone.
#include <limits>

#include "algorithm/configuration.hpp"
#include "guard.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// Checks a model and arguments in turn; the first failure stays.
struct Check {
  dynStatus status;
  const Model* m = nullptr;
  const char* function;
  bool large = false;  // a number was so large that what is made of it may overflow

  Check(const dynModel* model, const char* f) : status(check(model)), function(f) {
    if (status == DYN_OK) m = model->m.get();
  }
  Check& vector(const char* name, const double* x, Index n) {
    if (status != DYN_OK) return *this;
    if (!x && n > 0) status = fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, name);
    else if (any_beyond(x, n, 166)) {  // 1e50
      large = true;
      if (const Index k = finite_count(x, n); k < n)
        status = fail(DYN_ERROR_NONFINITE, "%s: %s[%d] is %s: give a finite number", function, name, int(k),
                      x[k] != x[k] ? "NaN" : "infinite");
    }
    return *this;
  }
  Check& q(const char* name, const double* x) {
    if (status != DYN_OK) return *this;
    vector(name, x, m->n.nq);
    if (status == DYN_OK)
      if (const Index j = zero_norm_joint(*m, x))
        status = fail(DYN_ERROR_QUATERNION, "%s: the quaternion or (cos, sin) of joint '%s' in %s is zero: give one of norm 1",
                      function, m->string(m->joints()[j].name), name);
    return *this;
  }
  Check& v(const char* name, const double* x) { return status == DYN_OK ? vector(name, x, m->n.nv) : *this; }
  // Runs f<J>(body, result) for each joint, result being room for what it writes, when something may overflow: so that an output
  // is written whole or not at all.
  template <class F>
  Check& fits(F f) {
    if (status != DYN_OK || !large) return *this;
    for_each_leader(*m, [&]<class J>(const Body& b) {
      double result[72] = {};
      f.template operator()<J>(b, result);
      if (status == DYN_OK && finite_count(result, 72) < 72)
        status = fail(DYN_ERROR_NUMERIC, "%s: the result of joint '%s' overflows: the inputs are too large for double precision",
                      function, m->string(m->joints()[b.joint].name));
    });
    return *this;
  }
  Check& output(const void* p, Index n = 1) {
    if (status == DYN_OK && !p && n > 0) status = fail(DYN_ERROR_ARGUMENT, "%s: the output is NULL", function);
    return *this;
  }
  Index nq() const { return m ? m->n.nq : 0; }
  Index nv() const { return m ? m->n.nv : 0; }
  explicit operator bool() const { return status == DYN_OK; }
};

}  // namespace

extern "C" {

dynStatus dyn_integrate(const dynModel* model, const double* q, const double* v, double* out) {
  const DefaultFloatingPoint settings;
  Check c(model, "dyn_integrate");
  if (c.q("q", q).v("v", v).output(out, c.nq()).fits([&]<class J>(const Body& b, double* x) {
        J::integrate(q + b.user_q, v + b.user_v, x);
      }))
    integrate(*c.m, q, v, out);
  return c.status;
}

dynStatus dyn_difference(const dynModel* model, const double* q0, const double* q1, double* v) {
  const DefaultFloatingPoint settings;
  Check c(model, "dyn_difference");
  if (c.q("q0", q0).q("q1", q1).output(v, c.nv()).fits([&]<class J>(const Body& b, double* x) {
        J::difference(b, q0 + b.user_q, q1 + b.user_q, x);
      }))
    difference(*c.m, q0, q1, v);
  return c.status;
}

dynStatus dyn_interpolate(const dynModel* model, const double* q0, const double* q1, double u, double* out) {
  const DefaultFloatingPoint settings;
  Check c(model, "dyn_interpolate");
  if (c.q("q0", q0).q("q1", q1).vector("u", &u, 1).output(out, c.nq()).fits([&]<class J>(const Body& b, double* x) {
        double v[6];
        J::difference(b, q0 + b.user_q, q1 + b.user_q, v);
        for (int k = 0; k < J::nv; ++k) v[k] *= u;
        J::integrate(q0 + b.user_q, v, x);
      }))
    interpolate(*c.m, q0, q1, u, out);
  return c.status;
}

dynStatus dyn_configuration_distance(const dynModel* model, const double* q0, const double* q1, double* result) {
  const DefaultFloatingPoint settings;
  Check c(model, "dyn_configuration_distance");
  if (!c.q("q0", q0).q("q1", q1).output(result)) return c.status;
  const double d = distance(*c.m, q0, q1);
  if (!std::isfinite(d))
    return fail(DYN_ERROR_NUMERIC,
                "dyn_configuration_distance: the distance overflows: the inputs are too large for double precision");
  *result = d;
  return DYN_OK;
}

dynStatus dyn_configuration_neutral(const dynModel* model, double* q) {
  Check c(model, "dyn_configuration_neutral");
  if (c.output(q, c.nq())) copy_out(c.m->neutral(), c.m->n.nq, q);
  return c.status;
}

dynStatus dyn_configuration_random(const dynModel* model, uint64_t seed, const double* lower, const double* upper, double* q) {
  const DefaultFloatingPoint settings;
  Check c(model, "dyn_configuration_random");
  if (!c.output(q, c.nq())) return c.status;
  const double* low = lower ? lower : c.m->lower_limit();
  const double* high = upper ? upper : c.m->upper_limit();
  for (Index k = 0; k < c.m->n.nq; ++k) {
    if (std::isnan(low[k]) || std::isnan(high[k]))
      return fail(DYN_ERROR_NONFINITE, "dyn_configuration_random: %s[%d] is NaN: give a number, or an infinity for no bound",
                  std::isnan(low[k]) ? "lower" : "upper", int(k));
    if (low[k] > std::numeric_limits<double>::max() || high[k] < std::numeric_limits<double>::lowest())
      return fail(
          DYN_ERROR_INVALID,
          "dyn_configuration_random: nothing lies between lower[%d] = %g and upper[%d] = %g: give a bound that numbers can meet",
          int(k), low[k], int(k), high[k]);
    if (low[k] > high[k])
      return fail(DYN_ERROR_INVALID, "dyn_configuration_random: lower[%d] = %g exceeds upper[%d] = %g: exchange them", int(k),
                  low[k], int(k), high[k]);
  }
  random_configuration(*c.m, seed, low, high, q);
  return DYN_OK;
}

dynStatus dyn_configuration_normalize(const dynModel* model, double* q) {
  const DefaultFloatingPoint settings;
  Check c(model, "dyn_configuration_normalize");
  if (c.q("q", q)) normalize(*c.m, q);
  return c.status;
}

dynStatus dyn_configuration_is_normalized(const dynModel* model, const double* q, double tolerance, int* normalized) {
  const DefaultFloatingPoint settings;
  Check c(model, "dyn_configuration_is_normalized");
  if (!c.vector("q", q, c.m ? c.m->n.nq : 0).output(normalized)) return c.status;
  if (!(tolerance >= 0))
    return fail(DYN_ERROR_ARGUMENT, "dyn_configuration_is_normalized: tolerance is %g: it can't be negative or NaN", tolerance);
  *normalized = norm_error(*c.m, q) <= tolerance;
  return DYN_OK;
}

dynStatus dyn_integrate_jacobians(const dynModel* model, const double* q, const double* v, double* dq, double* dv) {
  const DefaultFloatingPoint settings;
  Check c(model, "dyn_integrate_jacobians");
  if (c.q("q", q).v("v", v).fits([&]<class J>(const Body& b, double* x) {
        J::integrate_jacobians(q + b.user_q, v + b.user_v, Block<double>{x, 6}, Block<double>{x + 36, 6});
      }))
    integrate_jacobians(*c.m, q, v, dq, dv);
  return c.status;
}

dynStatus dyn_difference_jacobians(const dynModel* model, const double* q0, const double* q1, double* dq0, double* dq1) {
  const DefaultFloatingPoint settings;
  Check c(model, "dyn_difference_jacobians");
  if (c.q("q0", q0).q("q1", q1).fits([&]<class J>(const Body& b, double* x) {
        J::difference_jacobians(b, q0 + b.user_q, q1 + b.user_q, Block<double>{x, 6}, Block<double>{x + 36, 6});
      }))
    difference_jacobians(*c.m, q0, q1, dq0, dq1);
  return c.status;
}

}  // extern "C"
