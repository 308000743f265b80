// Tests the groups SO(3) and SE(3) of dyn.h: identities, Jacobians by central differences, extreme angles, and what is refused.
#include <functional>
#include <random>

#include "capi/support.hpp"

namespace dyn_test::groups_test {
namespace {

constexpr double pi = 3.14159265358979323846;

double largest_gap(const Numbers& a, const Numbers& b) {
  double gap = 0;
  for (std::size_t k = 0; k < a.size(); ++k) gap = std::max(gap, std::abs(a[k] - b[k]));
  return a.size() == b.size() ? gap : inf;
}
Numbers times(const Numbers& A, const Numbers& B, std::size_t rows) {
  const std::size_t inner = A.size() / rows, cols = B.size() / inner;
  Numbers C(rows * cols);
  for (std::size_t c = 0; c < cols; ++c)
    for (std::size_t k = 0; k < inner; ++k)
      for (std::size_t r = 0; r < rows; ++r) C[r + rows * c] += A[r + rows * k] * B[k + inner * c];
  return C;
}
Numbers transposed(const Numbers& A, std::size_t n) {
  Numbers B(n * n);
  for (std::size_t r = 0; r < n; ++r)
    for (std::size_t c = 0; c < n; ++c) B[c + n * r] = A[r + n * c];
  return B;
}
Numbers identity(std::size_t n) {
  Numbers I(n * n);
  for (std::size_t k = 0; k < n; ++k) I[k * (n + 1)] = 1;
  return I;
}
double dot(const Numbers& a, const Numbers& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

// A function of dyn.h with its inputs, called on count elements.
enum class Kind { Free, Rotation, Quaternion, Matrix, Pose };  // what an element must be
struct In {
  const char* name;
  std::size_t size;
  Kind kind = Kind::Free;
  bool once = false;  // one element whatever the count
};
struct Row {
  const char* name;
  std::vector<In> in;
  const char* out_name;
  std::size_t out;
  std::function<dynStatus(std::size_t, const double* const*, double*)> call;
};
template <class F>
auto of_one(F f) {
  return [f](std::size_t n, const double* const* x, double* out) { return f(n, x[0], out); };
}
template <class F>
auto of_two(F f) {
  return [f](std::size_t n, const double* const* x, double* out) { return f(n, x[0], x[1], out); };
}
template <class F>
auto of_three(F f) {
  return [f](std::size_t n, const double* const* x, double* out) { return f(n, x[0], x[1], x[2], out); };
}
template <class F>
auto action(F f) {
  return [f](std::size_t n, const double* const* x, double* out) { return f(x[0], n, x[1], out); };
}
template <class F>
auto jacobian(F f, int left) {
  return [f, left](std::size_t n, const double* const* x, double* out) { return f(n, x[0], left, out); };
}
const In X_AB{"X_AB", 12, Kind::Rotation}, X_once{"X_AB", 12, Kind::Rotation, true};
const Row rows[] = {
    {"dyn_so3_compose", {{"R_AB", 9, Kind::Rotation}, {"R_BC", 9, Kind::Rotation}}, "R_AC", 9, of_two(dyn_so3_compose)},
    {"dyn_so3_inverse", {{"R_AB", 9, Kind::Rotation}}, "R_BA", 9, of_one(dyn_so3_inverse)},
    {"dyn_so3_act", {{"R_AB", 9, Kind::Rotation, true}, {"x_B", 3}}, "x_A", 3, action(dyn_so3_act)},
    {"dyn_so3_exp", {{"w", 3}}, "R", 9, of_one(dyn_so3_exp)},
    {"dyn_so3_log", {{"R", 9, Kind::Rotation}}, "w", 3, of_one(dyn_so3_log)},
    {"dyn_so3_jexp", {{"w", 3}}, "J", 9, jacobian(dyn_so3_jexp, 1)},
    {"dyn_so3_jlog", {{"R", 9, Kind::Rotation}}, "J", 9, jacobian(dyn_so3_jlog, 0)},
    {"dyn_so3_interpolate", {{"R0", 9, Kind::Rotation}, {"R1", 9, Kind::Rotation}, {"u", 1}}, "R", 9,
     of_three(dyn_so3_interpolate)},
    {"dyn_so3_from_quaternion", {{"quaternion", 4, Kind::Quaternion}}, "R", 9, of_one(dyn_so3_from_quaternion)},
    {"dyn_so3_to_quaternion", {{"R", 9, Kind::Rotation}}, "quaternion", 4, of_one(dyn_so3_to_quaternion)},
    {"dyn_so3_from_rpy", {{"rpy", 3}}, "R", 9, of_one(dyn_so3_from_rpy)},
    {"dyn_so3_to_rpy", {{"R", 9, Kind::Rotation}}, "rpy", 3, of_one(dyn_so3_to_rpy)},
    {"dyn_se3_compose", {X_AB, {"X_BC", 12, Kind::Rotation}}, "X_AC", 12, of_two(dyn_se3_compose)},
    {"dyn_se3_inverse", {X_AB}, "X_BA", 12, of_one(dyn_se3_inverse)},
    {"dyn_se3_act", {X_once, {"p_B", 3}}, "p_A", 3, action(dyn_se3_act)},
    {"dyn_se3_act_motion", {X_once, {"m_B", 6}}, "m_A", 6, action(dyn_se3_act_motion)},
    {"dyn_se3_act_force", {X_once, {"f_B", 6}}, "f_A", 6, action(dyn_se3_act_force)},
    {"dyn_se3_act_inertia", {X_once, {"I_B", 36}}, "I_A", 36, action(dyn_se3_act_inertia)},
    {"dyn_se3_adjoint", {X_AB}, "Ad", 36, of_one(dyn_se3_adjoint)},
    {"dyn_se3_exp", {{"twist", 6}}, "X", 12, of_one(dyn_se3_exp)},
    {"dyn_se3_log", {{"X", 12, Kind::Rotation}}, "twist", 6, of_one(dyn_se3_log)},
    {"dyn_se3_jexp", {{"twist", 6}}, "J", 36, jacobian(dyn_se3_jexp, 0)},
    {"dyn_se3_jlog", {{"X", 12, Kind::Rotation}}, "J", 36, jacobian(dyn_se3_jlog, 1)},
    {"dyn_se3_interpolate", {{"X0", 12, Kind::Rotation}, {"X1", 12, Kind::Rotation}, {"u", 1}}, "X", 12,
     of_three(dyn_se3_interpolate)},
    {"dyn_se3_from_matrix", {{"matrix", 16, Kind::Matrix}}, "X", 12, of_one(dyn_se3_from_matrix)},
    {"dyn_se3_to_matrix", {{"X", 12, Kind::Rotation}}, "matrix", 16, of_one(dyn_se3_to_matrix)},
    {"dyn_se3_from_quaternion", {{"q", 7, Kind::Pose}}, "X", 12, of_one(dyn_se3_from_quaternion)},
    {"dyn_se3_to_quaternion", {{"X", 12, Kind::Rotation}}, "q", 7, of_one(dyn_se3_to_quaternion)},
    {"dyn_se3_from_rpy", {{"xyz_rpy", 6}}, "X", 12, of_one(dyn_se3_from_rpy)},
    {"dyn_se3_to_rpy", {{"X", 12, Kind::Rotation}}, "xyz_rpy", 6, of_one(dyn_se3_to_rpy)},
};

// Of the function of this name, for one element; it must succeed.
Numbers result(const std::string& name, const std::vector<Numbers>& in) {
  for (const Row& r : rows)
    if (r.name == "dyn_" + name) {
      Numbers out(r.out, 777);
      std::vector<const double*> x;
      for (const Numbers& each : in) x.push_back(each.data());
      EXPECT_EQ(DYN_OK, r.call(1, x.data(), out.data())) << dyn_last_error();
      return out;
    }
  ADD_FAILURE() << name;
  return {};
}

struct Random {
  std::mt19937 engine{7};
  std::normal_distribution<double> normal;
  Numbers vector(std::size_t n) {
    Numbers x(n);
    for (double& e : x) e = normal(engine);
    return x;
  }
  // A twist whose angle is this.
  Numbers twist(double angle) {
    Numbers t = vector(6);
    const double norm = std::sqrt(t[3] * t[3] + t[4] * t[4] + t[5] * t[5]);
    for (std::size_t k = 3; k < 6; ++k) t[k] *= angle / norm;
    return t;
  }
  Numbers placement() { return result("se3_exp", {vector(6)}); }
  Numbers element(const In& in) {
    if (in.kind == Kind::Free) return vector(in.size);
    const Numbers X = placement();
    if (in.kind == Kind::Rotation) return {X.begin(), X.begin() + std::ptrdiff_t(in.size)};
    if (in.kind == Kind::Matrix) return result("se3_to_matrix", {X});
    return in.kind == Kind::Pose ? result("se3_to_quaternion", {X}) : vector(4);
  }
};
Numbers rotation_of(const Numbers& X) { return {X.begin(), X.begin() + 9}; }
Numbers angular(const Numbers& twist) { return {twist.begin() + 3, twist.end()}; }

TEST(Groups, ComposeInvertAndAct) {
  Random random;
  for (int k = 0; k < 20; ++k) {
    const Numbers A = random.placement(), B = random.placement(), AB = result("se3_compose", {A, B}), p = random.vector(3);
    const Numbers product = times(result("se3_to_matrix", {A}), result("se3_to_matrix", {B}), 4);
    EXPECT_LE(largest_gap(product, result("se3_to_matrix", {AB})), 1e-14);
    EXPECT_LE(largest_gap(result("se3_compose", {AB, result("se3_inverse", {B})}), A), 1e-14);
    EXPECT_LE(largest_gap(result("se3_act", {AB, p}), result("se3_act", {A, result("se3_act", {B, p})})), 1e-14);
    EXPECT_LE(largest_gap(result("so3_act", {rotation_of(A), p}), times(rotation_of(A), p, 3)), 1e-15);
    const Numbers AB3 = result("so3_compose", {rotation_of(A), rotation_of(B)});
    EXPECT_LE(largest_gap(AB3, rotation_of(AB)), 1e-15);
    EXPECT_LE(largest_gap(times(AB3, result("so3_inverse", {AB3}), 3), identity(3)), 1e-15);
  }
}

TEST(Groups, MotionsForcesInertiasAndTheAdjoint) {
  Random random;
  for (int k = 0; k < 20; ++k) {
    const Numbers X = random.placement(), Y = random.placement(), m = random.vector(6), f = random.vector(6);
    const Numbers Ad = result("se3_adjoint", {X}), m_A = result("se3_act_motion", {X, m}), f_A = result("se3_act_force", {X, f});
    EXPECT_LE(largest_gap(m_A, times(Ad, m, 6)), 1e-14);
    EXPECT_LE(largest_gap(times(transposed(Ad, 6), f_A, 6), f), 1e-13);
    EXPECT_NEAR(dot(f_A, m_A), dot(f, m), 1e-13);  // power is the same
    const Numbers both = result("se3_adjoint", {result("se3_compose", {X, Y})});
    EXPECT_LE(largest_gap(both, times(Ad, result("se3_adjoint", {Y}), 6)), 1e-13);
    const Numbers L = random.vector(36), I = times(L, transposed(L, 6), 6), I_A = result("se3_act_inertia", {X, I});
    EXPECT_LE(largest_gap(times(I_A, m_A, 6), result("se3_act_force", {X, times(I, m, 6)})), 1e-12);  // momentum
    EXPECT_LE(largest_gap(I_A, transposed(I_A, 6)), 1e-13);
  }
}

// From 0 through tiny angles to pi.
const double angles[] = {0, 1e-160, 1e-20, 1e-9, 1e-4, 0.5, 0.999, 1.001, 1.999, 2.001, 3, pi - 1e-4, pi - 1e-8};

TEST(Groups, LogUndoesExp) {
  Random random;
  for (double angle : angles) {
    const Numbers t = random.twist(angle), X = result("se3_exp", {t}), w = angular(t);
    // near pi the angle is read from a cosine at its end: errors of R are divided by the distance to pi, no closer than 1e-8
    const double tolerance = 1e-14 * (angle > 3.1 ? 1 / std::max(pi - angle, 1e-8) : 1) + 1e-14;
    EXPECT_LE(largest_gap(result("se3_log", {X}), t), std::min(tolerance, 1e-7)) << angle;
    EXPECT_LE(largest_gap(result("so3_log", {result("so3_exp", {w})}), w), std::min(tolerance, 1e-7)) << angle;
    EXPECT_LE(largest_gap(result("se3_exp", {result("se3_log", {X})}), X), 1e-14) << angle;
    if (angle > 0 && angle < 1e-8) {  // small rotations keep their direction
      const Numbers back = result("so3_log", {result("so3_exp", {w})});
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(back[k] / angle, w[k] / angle, 1e-14) << angle;
    }
  }
  // at pi: w or -w
  const Numbers half_turn{0, 0, pi};
  EXPECT_NEAR(std::abs(result("so3_log", {result("so3_exp", {half_turn})})[2]), pi, 1e-15);
}

// J e_k against exp(t + h e_k) and exp(t - h e_k): the error is h^2 of the third derivative and 1e-16 / h.
TEST(Groups, JacobiansAreCentralDifferences) {
  Random random;
  const double h = 1e-5;
  for (double angle : {0.0, 1e-6, 0.3, 0.999, 1.001, 1.999, 2.001, 3.0, 4.5})
    for (int left : {0, 1}) {
      const Numbers t = random.twist(angle), w = angular(t), X = result("se3_exp", {t});
      Numbers J(36), J3(9), back(36), back3(9);
      ASSERT_EQ(DYN_OK, dyn_se3_jexp(1, t.data(), left, J.data()));
      ASSERT_EQ(DYN_OK, dyn_so3_jexp(1, w.data(), left, J3.data()));
      for (std::size_t k = 0; k < 6; ++k) {
        Numbers ahead = t, behind = t;
        ahead[k] += h, behind[k] -= h;
        const Numbers a = result("se3_exp", {ahead}), b = result("se3_exp", {behind}), b_inverse = result("se3_inverse", {b});
        const Numbers change = result("se3_log", {result("se3_compose", {left ? a : b_inverse, left ? b_inverse : a})});
        for (std::size_t r = 0; r < 6; ++r) {
          EXPECT_NEAR(J[r + 6 * k], change[r] / (2 * h), 2e-9) << angle << " " << left;
          if (k >= 3 && r >= 3) {
            EXPECT_NEAR(J3[r - 3 + 3 * (k - 3)], change[r] / (2 * h), 2e-9) << angle << " " << left;
          }
        }
      }
      if (angle > pi) continue;  // log gives the shorter way
      ASSERT_EQ(DYN_OK, dyn_se3_jlog(1, X.data(), left, back.data()));
      ASSERT_EQ(DYN_OK, dyn_so3_jlog(1, X.data(), left, back3.data()));
      EXPECT_LE(largest_gap(times(back, J, 6), identity(6)), 1e-12) << angle;
      EXPECT_LE(largest_gap(times(back3, J3, 3), identity(3)), 1e-13) << angle;
    }
}

TEST(Groups, LeftJacobianIsTheAdjointTimesTheRightOne) {
  Random random;
  for (double angle : angles) {
    const Numbers t = random.twist(angle);
    Numbers right(36), left(36);
    ASSERT_EQ(DYN_OK, dyn_se3_jexp(1, t.data(), 0, right.data()));
    ASSERT_EQ(DYN_OK, dyn_se3_jexp(1, t.data(), 1, left.data()));
    EXPECT_LE(largest_gap(left, times(result("se3_adjoint", {result("se3_exp", {t})}), right, 6)), 1e-13) << angle;
  }
}

TEST(Groups, Interpolation) {
  Random random;
  const Numbers A = random.placement(), B = random.placement(), R0 = rotation_of(A), R1 = rotation_of(B);
  EXPECT_LE(largest_gap(result("se3_interpolate", {A, B, {0}}), A), 1e-14);
  EXPECT_LE(largest_gap(result("se3_interpolate", {A, B, {1}}), B), 1e-14);
  Numbers first;
  for (int k = 0; k < 4; ++k) {  // equal steps
    const Numbers a = result("se3_interpolate", {A, B, {k / 4.0}}), b = result("se3_interpolate", {A, B, {(k + 1) / 4.0}});
    const Numbers step = result("se3_log", {result("se3_compose", {result("se3_inverse", {a}), b})});
    if (k == 0) first = step;
    EXPECT_LE(largest_gap(step, first), 1e-14);
  }
  EXPECT_LE(largest_gap(result("so3_interpolate", {R0, R1, {0.3}}), result("so3_interpolate", {R1, R0, {0.7}})), 1e-14);
}

TEST(Groups, Conversions) {
  Random random;
  for (int k = 0; k < 20; ++k) {
    const Numbers X = random.placement(), R = rotation_of(X);
    EXPECT_LE(largest_gap(result("se3_from_matrix", {result("se3_to_matrix", {X})}), X), 0);
    EXPECT_LE(largest_gap(result("se3_from_quaternion", {result("se3_to_quaternion", {X})}), X), 1e-15);
    EXPECT_LE(largest_gap(result("se3_from_rpy", {result("se3_to_rpy", {X})}), X), 1e-15);
    Numbers q = result("so3_to_quaternion", {R});
    EXPECT_NEAR(dot(q, q), 1, 1e-15);
    EXPECT_GE(q[3], 0);
    for (double scale : {-1.0, 1e-300, 1e300}) {  // of any norm
      Numbers scaled = q;
      for (double& x : scaled) x *= scale;
      EXPECT_LE(largest_gap(result("so3_from_quaternion", {scaled}), R), 2e-15) << scale;
    }
  }
  const Numbers quarter = result("so3_act", {result("so3_from_rpy", {{0, 0, pi / 2}}), {1, 0, 0}});
  EXPECT_LE(largest_gap(quarter, {0, 1, 0}), 1e-15);
}

// Roll and yaw turn about one axis when the pitch is a right angle: together they are right, close to it as well.
TEST(Groups, GimbalLock) {
  for (double from_end : {0.0, 1e-15, 1e-13, 1e-12, 1e-9, 1e-6})
    for (double sign : {1.0, -1.0}) {
      const Numbers R = result("so3_from_rpy", {{0.3, sign * (pi / 2 - from_end), -0.2}}), rpy = result("so3_to_rpy", {R});
      EXPECT_LE(largest_gap(result("so3_from_rpy", {rpy}), R), 2e-15 + (from_end < 1e-12 ? 1e-12 : 0)) << from_end;
      if (from_end == 0) {
        EXPECT_EQ(0, rpy[0]);
      }
    }
  for (double x : result("so3_to_rpy", {identity(3)})) EXPECT_FALSE(std::signbit(x));
}

TEST(Groups, ArraysAreTheirElements) {
  Random random;
  const std::size_t count = 3;
  for (const Row& r : rows) {
    std::vector<Numbers> all(r.in.size());
    std::vector<std::vector<Numbers>> single(count, std::vector<Numbers>(r.in.size()));
    for (std::size_t i = 0; i < r.in.size(); ++i)
      for (std::size_t k = 0; k < count; ++k) {
        single[k][i] = r.in[i].once && k ? single[0][i] : random.element(r.in[i]);
        if (!r.in[i].once || !k) all[i].insert(all[i].end(), single[k][i].begin(), single[k][i].end());
      }
    std::vector<const double*> x;
    for (const Numbers& each : all) x.push_back(each.data());
    Numbers out(r.out * count + 1, 777);
    ASSERT_EQ(DYN_OK, r.call(count, x.data(), out.data())) << dyn_last_error();
    EXPECT_EQ(777, out.back()) << r.name;
    for (std::size_t k = 0; k < count; ++k)
      EXPECT_EQ(Numbers(out.begin() + std::ptrdiff_t(r.out * k), out.begin() + std::ptrdiff_t(r.out * (k + 1))),
                result(r.name + 4, single[k])) << r.name;
    // in place
    for (std::size_t i = 0; i < r.in.size(); ++i)
      if (r.in[i].size == r.out && !r.in[i].once) {
        Numbers place = all[i];
        std::vector<const double*> same = x;
        same[i] = place.data();
        ASSERT_EQ(DYN_OK, r.call(count, same.data(), place.data())) << r.name;
        place.push_back(777);
        EXPECT_EQ(out, place) << r.name << " " << r.in[i].name;
      }
    // none
    const std::vector<const double*> nothing(r.in.size(), nullptr);
    if (!r.in[0].once) {
      EXPECT_EQ(DYN_OK, r.call(0, nothing.data(), nullptr)) << r.name;
    }
  }
}

// Each number of each input in turn.
TEST(Groups, RefusesWithNameAndIndex) {
  Random random;
  for (const Row& r : rows) {
    std::vector<Numbers> in;
    for (const In& i : r.in) in.push_back(random.element(i));
    Numbers out(r.out, 777);
    auto call = [&](std::size_t count = 1) {
      std::vector<const double*> x;
      for (const Numbers& each : in) x.push_back(each.empty() ? nullptr : each.data());
      return r.call(count, x.data(), out.data());
    };
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Numbers good = in[i];
      for (std::size_t k = 0; k < good.size(); ++k)
        for (double bad : {nan, inf, -inf, 1e41}) {
          if (bad == 1e41 && (r.in[i].kind == Kind::Quaternion || r.in[i].kind == Kind::Pose)) continue;  // of any norm
          in[i][k] = bad;
          EXPECT_EQ(std::isfinite(bad) ? DYN_ERROR_ARGUMENT : DYN_ERROR_NONFINITE, call()) << r.name << " " << r.in[i].name;
          EXPECT_TRUE(says({r.name, std::string(r.in[i].name) + "[" + std::to_string(k) + "]"}));
          in[i] = good;
        }
      in[i].clear();
      EXPECT_EQ(DYN_ERROR_ARGUMENT, call()) << r.name;
      EXPECT_TRUE(says({r.name, std::string(r.in[i].name) + " is NULL"}));
      in[i] = good;
      if (r.in[i].kind == Kind::Rotation || r.in[i].kind == Kind::Matrix)
        for (double factor : {-1.0, 1 + 1e-5}) {  // a mirror image, and a column too long
          for (std::size_t k = 0; k < 3; ++k) in[i][k] *= factor;
          EXPECT_EQ(DYN_ERROR_INVALID, call()) << r.name;
          EXPECT_TRUE(says({r.name, r.in[i].name, "element 0", "is no rotation"}));
          in[i] = good;
        }
    }
    std::vector<const double*> x;
    for (const Numbers& each : in) x.push_back(each.data());
    EXPECT_EQ(DYN_ERROR_ARGUMENT, r.call(1, x.data(), nullptr)) << r.name;
    EXPECT_TRUE(says({r.name, std::string(r.out_name) + " is NULL"}));
    EXPECT_EQ(DYN_ERROR_ARGUMENT, call(std::size_t(-1))) << r.name;
    EXPECT_TRUE(says({r.name, "count is"}));
    EXPECT_EQ(Numbers(r.out, 777), out) << r.name;
  }
  const double zero[7] = {};
  double out[12] = {777};
  EXPECT_EQ(DYN_ERROR_QUATERNION, dyn_so3_from_quaternion(1, zero, out));
  EXPECT_EQ(DYN_ERROR_QUATERNION, dyn_se3_from_quaternion(1, zero, out));
  Numbers matrix = identity(4);
  matrix[7] = 1e-9;
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_se3_from_matrix(1, matrix.data(), out));
  EXPECT_TRUE(says({"dyn_se3_from_matrix", "last row is 0 1e-09 0 1"}));
  const double w[3] = {};
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_so3_jexp(1, w, 2, out));
  EXPECT_TRUE(says({"dyn_so3_jexp", "left is 2"}));
  EXPECT_EQ(777, out[0]);
}

// The largest numbers that are taken give finite results.
TEST(Groups, Extremes) {
  for (double size : {1e-300, 1e-20, 1e20, 1e40})
    for (const Row& r : rows) {
      std::vector<Numbers> in;
      Random random;
      for (const In& i : r.in) {
        in.push_back(random.element(i));
        for (std::size_t k = 0; k < i.size; ++k)
          if (i.kind == Kind::Free || (i.kind == Kind::Rotation && k >= 9)) in.back()[k] = k % 2 ? size : -size;
      }
      for (double x : result(r.name + 4, in)) EXPECT_TRUE(std::isfinite(x)) << r.name << " " << size;
    }
}

}  // namespace
}  // namespace dyn_test::groups_test
