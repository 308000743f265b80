// Rotations and placements: the groups SO(3) and SE(3), without model and data.
#include <cmath>
#include <cstddef>

#include "checks.hpp"
#include "guard.hpp"
#include "rotation.hpp"
#include "spatial/explog.hpp"
#include "spatial/rpy.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// Within this bound no product overflows, not even the fourth powers in Jexp6. (10^40: dyn.h says so.)
constexpr double largest = max_to_differentiate;

// The arguments of one call. After the first that is refused the others are not looked at.
struct Arguments {
  DefaultFloatingPoint settings;
  const char* function;
  std::size_t count;
  dynStatus status = DYN_OK;

  Arguments(const char* f, std::size_t n) : function(f), count(n) {
    constexpr std::size_t most_elements = std::size_t(PTRDIFF_MAX) / (36 * sizeof(double));
    if (n > most_elements) status = fail(DYN_ERROR_ARGUMENT, "%s: count is %zu: give at most %zu", f, n, most_elements);
  }
  explicit operator bool() const { return status == DYN_OK; }

  Arguments& given(const char* name, const void* x) {
    if (*this && !x && count) status = fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, name);
    return *this;
  }
  // The first `used` of each element's numbers.
  Arguments& numbers(const char* name, const double* x, std::size_t size, std::size_t used) {
    given(name, x);
    for (std::size_t k = 0; *this && k < count; ++k)
      for (std::size_t i = 0; i < used && *this; ++i)
        if (!(std::abs(x[size * k + i]) <= largest)) refuse_number(name, x, size * k + i);
    return *this;
  }
  Arguments& numbers(const char* name, const double* x, std::size_t size) { return numbers(name, x, size, size); }
  Arguments& rotation(const char* name, std::size_t element, const Mat3<double>& R) {
    if (*this && !is_rotation(R))
      status = fail(DYN_ERROR_INVALID, "%s: %s, element %zu, is no rotation: its axes are not orthonormal and right-handed",
                    function, name, element);
    return *this;
  }
  // The first nine of each element's numbers are a rotation.
  Arguments& rotations(const char* name, const double* x, std::size_t size) {
    numbers(name, x, size);
    for (std::size_t k = 0; *this && k < count; ++k) rotation(name, k, load33(x + size * k));
    return *this;
  }
  // Behind the first `offset` numbers of each element.
  Arguments& quaternions(const char* name, const double* x, std::size_t size, std::size_t offset) {
    given(name, x);
    for (std::size_t k = 0; *this && k < count; ++k) {
      const double* q = x + size * k + offset;
      for (std::size_t i = 0; *this && i < 4; ++i)
        if (!std::isfinite(q[i])) refuse_number(name, x, size * k + offset + i);
      if (*this && q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0)
        status = fail(DYN_ERROR_QUATERNION, "%s: %s, element %zu, has the quaternion 0 0 0 0, which is no rotation", function,
                      name, k);
    }
    return *this;
  }
  Arguments& flag(const char* name, int x) {
    if (*this && x != 0 && x != 1) status = fail(DYN_ERROR_ARGUMENT, "%s: %s is %d: give 0 or 1", function, name, x);
    return *this;
  }
  // One placement or rotation that acts on all elements.
  Arguments& actor(const char* name, const double* x, std::size_t size) {
    if (!*this) return *this;
    Arguments one(function, 1);
    status = one.rotations(name, x, size).status;
    return *this;
  }

 private:
  void refuse_number(const char* name, const double* x, std::size_t i) {
    if (std::isfinite(x[i]))
      status = fail(DYN_ERROR_ARGUMENT, "%s: %s[%zu] is %g: give numbers within %g", function, name, i, x[i], largest);
    else
      status = fail(DYN_ERROR_NONFINITE, "%s: %s[%zu] is %s: give a finite number", function, name, i,
                    std::isnan(x[i]) ? "NaN" : "infinite");
  }
};

// f(in, out) for each element.
template <class F>
dynStatus each(const Arguments& arguments, const double* in, std::size_t in_size, double* out, std::size_t out_size, F f) {
  if (arguments)
    for (std::size_t k = 0; k < arguments.count; ++k) f(in + in_size * k, out + out_size * k);
  return arguments.status;
}

void store66(const Mat6<double>& A, double* x) {
  for (int c = 0; c < 3; ++c) {
    store3(A.ll[c], x + 6 * c), store3(A.al[c], x + 6 * c + 3);
    store3(A.la[c], x + 6 * (c + 3)), store3(A.aa[c], x + 6 * (c + 3) + 3);
  }
}

Mat6<double> adjoint(const SE3<double>& X) { return {X.R, cross(X.p, X.R), Mat3<double>::zero(), X.R}; }

// A = (F Y)^T, F the matrix of X.act for forces.
void act_on_columns(const SE3<double>& X, const double* Y, double* A) {
  for (int c = 0; c < 6; ++c) {
    double column[6];
    store6(X.act(load_force(Y + 6 * c)), column);
    for (int r = 0; r < 6; ++r) A[c + 6 * r] = column[r];
  }
}

}  // namespace

extern "C" {

dynStatus dyn_so3_compose(size_t count, const double* R_AB, const double* R_BC, double* R_AC) {
  Arguments a(__func__, count);
  a.rotations("R_AB", R_AB, 9).rotations("R_BC", R_BC, 9).given("R_AC", R_AC);
  for (size_t k = 0; a && k < count; ++k) store33(load33(R_AB + 9 * k) * load33(R_BC + 9 * k), R_AC + 9 * k);
  return a.status;
}

dynStatus dyn_so3_inverse(size_t count, const double* R_AB, double* R_BA) {
  return each(Arguments(__func__, count).rotations("R_AB", R_AB, 9).given("R_BA", R_BA), R_AB, 9, R_BA, 9,
              [](const double* R, double* out) { store33(transpose(load33(R)), out); });
}

dynStatus dyn_so3_act(const double R_AB[9], size_t count, const double* x_B, double* x_A) {
  Arguments a(__func__, count);
  if (!a.actor("R_AB", R_AB, 9).numbers("x_B", x_B, 3).given("x_A", x_A)) return a.status;
  return each(a, x_B, 3, x_A, 3, [R = load33(R_AB)](const double* x, double* out) { store3(R * load3(x), out); });
}

dynStatus dyn_so3_exp(size_t count, const double* w, double* R) {
  return each(Arguments(__func__, count).numbers("w", w, 3).given("R", R), w, 3, R, 9,
              [](const double* x, double* out) { store33(exp3(load3(x)), out); });
}

dynStatus dyn_so3_log(size_t count, const double* R, double* w) {
  return each(Arguments(__func__, count).rotations("R", R, 9).given("w", w), R, 9, w, 3,
              [](const double* x, double* out) { store3(log3(load33(x)), out); });
}

dynStatus dyn_so3_jexp(size_t count, const double* w, int left, double* J) {
  return each(Arguments(__func__, count).numbers("w", w, 3).flag("left", left).given("J", J), w, 3, J, 9,
              [left](const double* x, double* out) { store33(Jexp3(left ? -load3(x) : load3(x)), out); });
}

dynStatus dyn_so3_jlog(size_t count, const double* R, int left, double* J) {
  return each(Arguments(__func__, count).rotations("R", R, 9).flag("left", left).given("J", J), R, 9, J, 9,
              [left](const double* x, double* out) {
                const Vec3<double> w = log3(load33(x));
                store33(Jlog3(left ? -w : w), out);
              });
}

dynStatus dyn_so3_interpolate(size_t count, const double* R0, const double* R1, const double* u, double* R) {
  Arguments a(__func__, count);
  a.rotations("R0", R0, 9).rotations("R1", R1, 9).numbers("u", u, 1).given("R", R);
  for (size_t k = 0; a && k < count; ++k) {
    const Mat3<double> from = load33(R0 + 9 * k);
    store33(from * exp3(log3(transpose(from) * load33(R1 + 9 * k)) * u[k]), R + 9 * k);
  }
  return a.status;
}

dynStatus dyn_so3_from_quaternion(size_t count, const double* quaternion, double* R) {
  return each(Arguments(__func__, count).quaternions("quaternion", quaternion, 4, 0).given("R", R), quaternion, 4, R, 9,
              [](const double* x, double* out) { store33(rotation(load_quaternion(x)), out); });
}

dynStatus dyn_so3_to_quaternion(size_t count, const double* R, double* q) {
  return each(Arguments(__func__, count).rotations("R", R, 9).given("quaternion", q), R, 9, q, 4,
              [](const double* x, double* out) { store(quaternion(load33(x)), out); });
}

dynStatus dyn_so3_from_rpy(size_t count, const double* rpy, double* R) {
  return each(Arguments(__func__, count).numbers("rpy", rpy, 3).given("R", R), rpy, 3, R, 9,
              [](const double* x, double* out) { store33(rotation_of_rpy(x[0], x[1], x[2]), out); });
}

dynStatus dyn_so3_to_rpy(size_t count, const double* R, double* rpy) {
  return each(Arguments(__func__, count).rotations("R", R, 9).given("rpy", rpy), R, 9, rpy, 3,
              [](const double* x, double* out) { store3(roll_pitch_yaw(load33(x)), out); });
}

dynStatus dyn_se3_compose(size_t count, const double* X_AB, const double* X_BC, double* X_AC) {
  Arguments a(__func__, count);
  a.rotations("X_AB", X_AB, 12).rotations("X_BC", X_BC, 12).given("X_AC", X_AC);
  for (size_t k = 0; a && k < count; ++k) store_se3(load_se3(X_AB + 12 * k) * load_se3(X_BC + 12 * k), X_AC + 12 * k);
  return a.status;
}

dynStatus dyn_se3_inverse(size_t count, const double* X_AB, double* X_BA) {
  return each(Arguments(__func__, count).rotations("X_AB", X_AB, 12).given("X_BA", X_BA), X_AB, 12, X_BA, 12,
              [](const double* x, double* out) { store_se3(load_se3(x).inverse(), out); });
}

dynStatus dyn_se3_act(const double X_AB[12], size_t count, const double* p_B, double* p_A) {
  Arguments a(__func__, count);
  if (!a.actor("X_AB", X_AB, 12).numbers("p_B", p_B, 3).given("p_A", p_A)) return a.status;
  return each(a, p_B, 3, p_A, 3, [X = load_se3(X_AB)](const double* x, double* out) { store3(X.act(load3(x)), out); });
}

dynStatus dyn_se3_act_motion(const double X_AB[12], size_t count, const double* m_B, double* m_A) {
  Arguments a(__func__, count);
  if (!a.actor("X_AB", X_AB, 12).numbers("m_B", m_B, 6).given("m_A", m_A)) return a.status;
  return each(a, m_B, 6, m_A, 6, [X = load_se3(X_AB)](const double* x, double* out) { store6(X.act(load_motion(x)), out); });
}

dynStatus dyn_se3_act_force(const double X_AB[12], size_t count, const double* f_B, double* f_A) {
  Arguments a(__func__, count);
  if (!a.actor("X_AB", X_AB, 12).numbers("f_B", f_B, 6).given("f_A", f_A)) return a.status;
  return each(a, f_B, 6, f_A, 6, [X = load_se3(X_AB)](const double* x, double* out) { store6(X.act(load_force(x)), out); });
}

dynStatus dyn_se3_act_inertia(const double X_AB[12], size_t count, const double* I_B, double* I_A) {
  Arguments a(__func__, count);
  if (!a.actor("X_AB", X_AB, 12).numbers("I_B", I_B, 36).given("I_A", I_A)) return a.status;
  // F I F^T with F = Ad^-T, the matrix that acts on forces
  return each(a, I_B, 36, I_A, 36, [X = load_se3(X_AB)](const double* x, double* out) {
    double half[36];
    act_on_columns(X, x, half);
    act_on_columns(X, half, out);
  });
}

dynStatus dyn_se3_adjoint(size_t count, const double* X_AB, double* Ad) {
  return each(Arguments(__func__, count).rotations("X_AB", X_AB, 12).given("Ad", Ad), X_AB, 12, Ad, 36,
              [](const double* x, double* out) { store66(adjoint(load_se3(x)), out); });
}

dynStatus dyn_se3_exp(size_t count, const double* twist, double* X) {
  return each(Arguments(__func__, count).numbers("twist", twist, 6).given("X", X), twist, 6, X, 12,
              [](const double* x, double* out) { store_se3(exp6(load_motion(x)), out); });
}

dynStatus dyn_se3_log(size_t count, const double* X, double* twist) {
  return each(Arguments(__func__, count).rotations("X", X, 12).given("twist", twist), X, 12, twist, 6,
              [](const double* x, double* out) { store6(log6(load_se3(x)), out); });
}

dynStatus dyn_se3_jexp(size_t count, const double* twist, int left, double* J) {
  return each(Arguments(__func__, count).numbers("twist", twist, 6).flag("left", left).given("J", J), twist, 6, J, 36,
              [sign = left ? -1.0 : 1.0](const double* x, double* out) { store66(Jexp6(load_motion(x) * sign), out); });
}

dynStatus dyn_se3_jlog(size_t count, const double* X, int left, double* J) {
  return each(Arguments(__func__, count).rotations("X", X, 12).flag("left", left).given("J", J), X, 12, J, 36,
              [sign = left ? -1.0 : 1.0](const double* x, double* out) { store66(Jlog6(log6(load_se3(x)) * sign), out); });
}

dynStatus dyn_se3_interpolate(size_t count, const double* X0, const double* X1, const double* u, double* X) {
  Arguments a(__func__, count);
  a.rotations("X0", X0, 12).rotations("X1", X1, 12).numbers("u", u, 1).given("X", X);
  for (size_t k = 0; a && k < count; ++k) {
    const SE3<double> from = load_se3(X0 + 12 * k);
    store_se3(from * exp6(log6(from.inverse() * load_se3(X1 + 12 * k)) * u[k]), X + 12 * k);
  }
  return a.status;
}

dynStatus dyn_se3_from_matrix(size_t count, const double* matrix, double* X) {
  Arguments a(__func__, count);
  a.numbers("matrix", matrix, 16);
  for (size_t k = 0; a && k < count; ++k) {
    const double* m = matrix + 16 * k;
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      return fail(DYN_ERROR_INVALID, "%s: matrix, element %zu: its last row is %g %g %g %g: give 0 0 0 1", __func__, k, m[3],
                  m[7], m[11], m[15]);
    a.rotation("matrix", k, {load3(m), load3(m + 4), load3(m + 8)});
  }
  return each(a.given("X", X), matrix, 16, X, 12, [](const double* m, double* out) {
    store_se3(SE3<double>{{load3(m), load3(m + 4), load3(m + 8)}, load3(m + 12)}, out);
  });
}

dynStatus dyn_se3_to_matrix(size_t count, const double* X, double* matrix) {
  return each(Arguments(__func__, count).rotations("X", X, 12).given("matrix", matrix), X, 12, matrix, 16,
              [](const double* x, double* out) {
                for (int c = 0; c < 4; ++c) store3(load3(x + 3 * c), out + 4 * c), out[4 * c + 3] = c == 3;
              });
}

dynStatus dyn_se3_from_quaternion(size_t count, const double* q, double* X) {
  return each(Arguments(__func__, count).numbers("q", q, 7, 3).quaternions("q", q, 7, 3).given("X", X), q, 7, X, 12,
              [](const double* x, double* out) { store_se3(SE3<double>{rotation(load_quaternion(x + 3)), load3(x)}, out); });
}

dynStatus dyn_se3_to_quaternion(size_t count, const double* X, double* q) {
  return each(Arguments(__func__, count).rotations("X", X, 12).given("q", q), X, 12, q, 7, [](const double* x, double* out) {
    store3(load3(x + 9), out), store(quaternion(load33(x)), out + 3);
  });
}

dynStatus dyn_se3_from_rpy(size_t count, const double* xyz_rpy, double* X) {
  return each(Arguments(__func__, count).numbers("xyz_rpy", xyz_rpy, 6).given("X", X), xyz_rpy, 6, X, 12,
              [](const double* x, double* out) {
                store_se3(SE3<double>{rotation_of_rpy(x[3], x[4], x[5]), load3(x)}, out);
              });
}

dynStatus dyn_se3_to_rpy(size_t count, const double* X, double* xyz_rpy) {
  return each(Arguments(__func__, count).rotations("X", X, 12).given("xyz_rpy", xyz_rpy), X, 12, xyz_rpy, 6,
              [](const double* x, double* out) { store3(load3(x + 9), out), store3(roll_pitch_yaw(load33(x)), out + 3); });
}

}  // extern "C"
