// What the tests of the C interface share: models, data, random states, and snapshots of all that a data shows.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "common/every.hpp"
#include "common/with.hpp"
#include "dyn.h"

namespace dyn_test {

using Numbers = std::vector<double>;
inline constexpr double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();

inline bool checked_build() { return std::strstr(dyn_build_info(), ", checked") != nullptr; }
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

// ---------------------------------------------------------------------------------------------------- models

struct Model {
  dynModel* m = nullptr;
  Model() = default;
  explicit Model(dynModel* model) : m(model) {}
  Model(Model&& other) noexcept : m(other.m) { other.m = nullptr; }
  Model& operator=(Model&& other) noexcept {
    std::swap(m, other.m);
    return *this;
  }
  ~Model() { dyn_model_free(m); }
  operator dynModel*() const { return m; }
  int nq() const { return dyn_model_nq(m); }
  int nv() const { return dyn_model_nv(m); }
  int njoints() const { return dyn_model_njoints(m); }
  int nframes() const { return dyn_model_nframes(m); }
};

inline Model robot(const char* name, dynBase base = DYN_BASE_FIXED) {
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = base;
  dynModel* m = nullptr;
  const std::string path = std::string(DYN_MODELS_DIR) + "/robots/" + name + ".urdf";
  EXPECT_EQ(DYN_OK, dyn_model_load(path.c_str(), &options, &m)) << dyn_last_error();
  return Model(m);
}

struct Spec : dynJointSpec {
  Spec(const char* name_, dynJointType type_, const char* parent_ = nullptr, std::array<double, 3> at = {0, 0, 0}) {
    dyn_joint_spec_init(this);
    name = name_, type = type_, parent = parent_;
    std::copy(at.begin(), at.end(), placement + 9);
  }
  Spec& about(double x, double y, double z) {
    axis[0] = x, axis[1] = y, axis[2] = z;
    return *this;
  }
};

inline constexpr double no_inertia[9] = {}, some_inertia[9] = {0.02, 0.001, 0, 0.001, 0.03, 0, 0, 0, 0.025};

struct Builder {
  dynBuilder* b = nullptr;
  explicit Builder(const char* name = "built") { EXPECT_EQ(DYN_OK, dyn_builder_new(name, &b)); }
  Builder(const Builder&) = delete;
  ~Builder() { dyn_builder_free(b); }
  operator dynBuilder*() const { return b; }
  Builder& joint(const dynJointSpec& s) {
    EXPECT_EQ(DYN_OK, dyn_builder_add_joint(b, &s)) << dyn_last_error();
    return *this;
  }
  Builder& body(const char* name, const char* parent, double mass = 1, std::array<double, 3> com = {0.1, 0.05, -0.02},
                const double* inertia = some_inertia) {
    EXPECT_EQ(DYN_OK, dyn_builder_add_body(b, name, parent, nullptr, mass, com.data(), inertia)) << dyn_last_error();
    return *this;
  }
  Builder& shape(const char* body, dynShapeType type, std::array<double, 3> size) {
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = body, s.type = type;
    std::copy(size.begin(), size.end(), s.size);
    EXPECT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
    return *this;
  }
  Model finish() {
    dynModel* m = nullptr;
    EXPECT_EQ(DYN_OK, dyn_builder_finish(b, &m)) << dyn_last_error();
    return Model(m);
  }
};

// Every joint type: a free flyer with a limb of one joint of each type, a composite, a merged link, user frames; and, when
// asked for, two followers of the first hinge.
inline Model all_types(bool mimic = true) {
  Builder b("all_types");
  const std::array<double, 3> at = {0.1, -0.2, 0.3};
  b.joint(Spec("free", DYN_JOINT_TYPE_FREE_FLYER)).body("trunk", "free", 5);
  b.joint(Spec("hinge", DYN_JOINT_TYPE_REVOLUTE, "free", at).about(0, 1, 0)).body("b1", "hinge");
  b.joint(Spec("wheel", DYN_JOINT_TYPE_CONTINUOUS, "hinge", at).about(1, 0, 0)).body("b2", "wheel");
  b.joint(Spec("slider", DYN_JOINT_TYPE_PRISMATIC, "wheel", at).about(0, 0.6, 0.8)).body("b3", "slider");
  Spec screw("screw", DYN_JOINT_TYPE_HELICAL, "slider", at);
  screw.pitch = 0.05;
  b.joint(screw).body("b4", "screw");
  b.joint(Spec("tube", DYN_JOINT_TYPE_CYLINDRICAL, "free", at).about(1, 1, 0)).body("b5", "tube");
  b.joint(Spec("cardan", DYN_JOINT_TYPE_UNIVERSAL, "tube", at)).body("b6", "cardan");
  b.joint(Spec("ball", DYN_JOINT_TYPE_SPHERICAL, "cardan", at)).body("b7", "ball");
  b.joint(Spec("zyx", DYN_JOINT_TYPE_SPHERICAL_ZYX, "free", at)).body("b8", "zyx");
  b.joint(Spec("plane", DYN_JOINT_TYPE_PLANAR, "zyx", at).about(0, 1, 1)).body("b9", "plane");
  b.joint(Spec("carriage", DYN_JOINT_TYPE_TRANSLATION, "plane", at)).body("b10", "carriage");
  Spec parts[] = {Spec(nullptr, DYN_JOINT_TYPE_REVOLUTE), Spec(nullptr, DYN_JOINT_TYPE_FIXED, nullptr, at),
                  Spec(nullptr, DYN_JOINT_TYPE_SPHERICAL), Spec(nullptr, DYN_JOINT_TYPE_PRISMATIC).about(1, 0, 0)};
  Spec compound("compound", DYN_JOINT_TYPE_COMPOSITE, "free", at);
  compound.parts = parts, compound.parts_count = 4;
  b.joint(compound).body("b11", "compound");
  b.joint(Spec("dial", DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED, "compound", at)).body("b12", "dial");
  b.joint(Spec("weld", DYN_JOINT_TYPE_FIXED, "dial", at)).body("b13", "weld");
  std::string last = "weld";
  for (const dynJointType type : every<dynJointType>("dynJointType")) {
    if (type <= DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED) continue;  // each of those stands above
    const std::string name = "type" + std::to_string(int(type));
    b.joint(Spec(name.c_str(), type, last.c_str(), at).about(1, 2, 0)).body(("of_" + name).c_str(), name.c_str());
    last = name;
  }
  if (mimic) {
    Spec follower("follower", DYN_JOINT_TYPE_PRISMATIC, "dial", at), second("second", DYN_JOINT_TYPE_REVOLUTE, "screw", at);
    follower.mimic = "hinge", follower.mimic_ratio = -0.3, follower.mimic_offset = 0.1;
    second.mimic = "follower", second.mimic_ratio = 2;
    b.joint(follower).body("b14", "follower").joint(second).body("b15", "second");
  }
  b.shape("trunk", DYN_SHAPE_TYPE_BOX, {0.1, 0.05, 0.02})
      .shape("b4", DYN_SHAPE_TYPE_CYLINDER, {0.02, 0.1, 0})
      .shape("b7", DYN_SHAPE_TYPE_ELLIPSOID, {0.02, 0.03, 0.04});
  b.shape("b10", DYN_SHAPE_TYPE_CAPSULE, {0.02, 0.1, 0}).shape("b13", DYN_SHAPE_TYPE_SPHERE, {0.03, 0, 0});
  EXPECT_EQ(DYN_OK, dyn_builder_add_frame(b, "tool", "weld", nullptr, DYN_FRAME_TYPE_OP_FRAME));
  EXPECT_EQ(DYN_OK, dyn_builder_add_frame(b, "imu", "trunk", nullptr, DYN_FRAME_TYPE_SENSOR));
  return b.finish();
}

inline Model chain(int n) {
  Builder b("chain");
  std::string parent;
  for (int k = 0; k < n; ++k) {
    const std::string name = "j" + std::to_string(k);
    b.joint(Spec(name.c_str(), DYN_JOINT_TYPE_REVOLUTE, parent.empty() ? nullptr : parent.c_str(), {0, 0, k ? 0.1 : 0.0})
                .about(k % 2, 1, 0));
    b.body(("l" + std::to_string(k)).c_str(), name.c_str(), 0.5);
    parent = name;
  }
  return b.finish();
}

// A point mass at the end of two massless rods: M is exactly singular at q = 0, and forward dynamics is undefined there.
inline Model singular_at_zero(bool mimic = false) {
  Builder b("rods");
  b.joint(Spec("shoulder", DYN_JOINT_TYPE_REVOLUTE)).joint(Spec("elbow", DYN_JOINT_TYPE_REVOLUTE, "shoulder", {1, 0, 0}));
  b.body("bob", "elbow", 1, {1, 0, 0}, no_inertia);
  b.joint(Spec("apart", DYN_JOINT_TYPE_REVOLUTE)).body("wheel", "apart");
  if (mimic) {
    Spec follower("follower", DYN_JOINT_TYPE_REVOLUTE);
    follower.mimic = "apart";
    b.joint(follower).body("pinion", "follower");
  }
  return b.finish();
}

// ---------------------------------------------------------------------------------------------------- data

struct Data {
  dynData* d = nullptr;
  Data() = default;
  explicit Data(const dynModel* m, dynParts parts = 0) { EXPECT_EQ(DYN_OK, dyn_data_new(m, parts, &d)) << dyn_last_error(); }
  Data(Data&& other) noexcept : d(other.d) { other.d = nullptr; }
  ~Data() { dyn_data_free(d); }
  operator dynData*() const { return d; }
};

// A small deterministic generator (SplitMix64).
struct Random {
  std::uint64_t state;
  std::uint64_t next() {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  double uniform(double a, double b) { return a + (b - a) * double(next() >> 11) * 0x1p-53; }
  int below(int n) { return n > 0 ? int(next() % std::uint64_t(n)) : 0; }
  Numbers numbers(int n, double a = -1, double b = 1) {
    Numbers x(static_cast<std::size_t>(n));
    for (double& e : x) e = uniform(a, b);
    return x;
  }
};

struct State {
  Numbers q, v, a, tau, fext;
};

inline State random_state(const dynModel* m, std::uint64_t seed) {
  State s;
  s.q.resize(std::size_t(dyn_model_nq(m)));
  EXPECT_EQ(DYN_OK, dyn_configuration_random(m, seed, nullptr, nullptr, s.q.data())) << dyn_last_error();
  Random g{seed};
  s.v = g.numbers(dyn_model_nv(m)), s.a = g.numbers(dyn_model_nv(m)), s.tau = g.numbers(dyn_model_nv(m)),
  s.fext = g.numbers(6 * dyn_model_njoints(m));
  return s;
}

inline dynStatus take_step(const dynModel* m, dynData* d, dynIntegrator integrator, double dt) {
  dynStepOptions options;
  dyn_step_options_init(&options);
  options.integrator = integrator, options.dt = dt;
  const dynStatus status = dyn_data_set_step_options(m, d, &options);
  return status == DYN_ERROR_ARGUMENT || status == DYN_ERROR_NONFINITE ? status : dyn_step(m, d);
}

inline void compute_centroidal_and_regressors(const dynModel* m, dynData* d) {
  ASSERT_EQ(DYN_OK, dyn_centroidal_derivatives(m, d, nullptr, nullptr, nullptr, nullptr)) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_centroidal_map_time_variation(m, d, nullptr, nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_joint_torque_regressor(m, d, nullptr, nullptr, nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_static_regressor(m, d, nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_kinetic_energy_regressor(m, d, nullptr, nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_potential_energy_regressor(m, d, nullptr, nullptr));
}
inline void compute_other_derivatives(const dynModel* m, dynData* d, const double* fext, const double* lambda) {
  ASSERT_EQ(DYN_OK, dyn_vcom_derivatives(m, d, nullptr, nullptr, nullptr, nullptr)) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_gravity_torque_derivatives(m, d, nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_static_torque_derivatives(m, d, nullptr, fext, nullptr));
  ASSERT_EQ(DYN_OK, dyn_rnea_second_order_product(m, d, nullptr, nullptr, nullptr, fext, lambda, nullptr));
}
// Forward before inverse: their tau and derivatives are of different accelerations, and the last call's are kept.
inline dynStatus compute_derivatives(const dynModel* m, dynData* d, const double* fext) {
  const dynStatus status = dyn_aba_derivatives(m, d, nullptr, nullptr, nullptr, fext, nullptr);
  return status == DYN_OK ? dyn_rnea_derivatives(m, d, nullptr, nullptr, nullptr, fext, nullptr, nullptr) : status;
}

// Runs the algorithms whose fields nothing has computed.
inline void compute_stale(const dynModel* m, dynData* d, const double* fext = nullptr) {
  dynBatchArrays held;  // inputs that are NULL
  dyn_batch_arrays_init(&held);
  held.fext = fext;
  for (const dynAlgorithm algorithm : every<dynAlgorithm>("dynAlgorithm")) {
    dynAlgorithmInfo info{};
    info.struct_size = sizeof info;
    ASSERT_EQ(DYN_OK, dyn_algorithm_info(m, algorithm, &info));
    for (dynField f = 0; f < dyn_field_count(); ++f) {
      dynFieldInfo field{};
      dynArray a{};
      field.struct_size = sizeof field, a.struct_size = sizeof a;
      ASSERT_EQ(DYN_OK, dyn_field_info(f, &field));
      if (field.producer != "dyn_" + std::string(info.name) || dyn_data_array(m, d, f, &a) != DYN_ERROR_STALE) continue;
      ASSERT_EQ(DYN_OK, dyn_algorithm_run(m, d, algorithm, &held)) << dyn_last_error();
    }
  }
}

// Brings every field of the state to life.
inline void compute_all(const dynModel* m, dynData* d, const State& s) {
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, s.q.data(), s.v.data(), s.a.data())) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, nullptr, nullptr, nullptr, s.tau.data()));
  ASSERT_EQ(DYN_OK, dyn_constrained_dynamics(m, d, nullptr, nullptr, nullptr, s.fext.data(), nullptr, nullptr))
      << dyn_last_error();
  ASSERT_EQ(DYN_OK, compute_derivatives(m, d, s.fext.data())) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_all_terms(m, d, DYN_TERM_ALL, nullptr, nullptr, nullptr)) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_com(m, d, nullptr, s.v.data(), s.a.data(), nullptr, nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_rnea(m, d, nullptr, nullptr, nullptr, s.fext.data(), nullptr));
  ASSERT_EQ(DYN_OK, dyn_static_torque(m, d, nullptr, s.fext.data(), nullptr));
  ASSERT_EQ(DYN_OK, dyn_aba(m, d, nullptr, nullptr, nullptr, s.fext.data(), nullptr)) << dyn_last_error();
  compute_centroidal_and_regressors(m, d);
  compute_other_derivatives(m, d, s.fext.data(), s.a.data());
  ASSERT_EQ(DYN_OK, dyn_distances(m, d, nullptr, nullptr)) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_tendons(m, d, nullptr, nullptr, nullptr, nullptr, nullptr)) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_sensors(m, d, nullptr, nullptr, nullptr, nullptr)) << dyn_last_error();
  compute_stale(m, d, s.fext.data());
}

inline dynArray view() {
  dynArray a{};
  a.struct_size = sizeof a;
  return a;
}
inline dynStatus read_field(const dynModel* m, dynData* d, dynField field, Numbers& out) {
  dynArray a = view();
  const dynStatus s = dyn_data_array(m, d, field, &a);
  out.clear();
  if (s == DYN_OK)
    for (int j = 0; j < a.cols; ++j)
      for (int i = 0; i < a.rows; ++i) out.push_back(a.data[i * a.stride[0] + j * a.stride[1]]);
  return s;
}
inline Numbers field(const dynModel* m, dynData* d, const char* name) {
  Numbers x;
  EXPECT_EQ(DYN_OK, read_field(m, d, dyn_field_id(name), x)) << name << ": " << dyn_last_error();
  return x;
}
inline dynStatus field_status(const dynModel* m, dynData* d, const char* name) {
  Numbers x;
  return read_field(m, d, dyn_field_id(name), x);
}
inline bool same_bits(const Numbers& a, const Numbers& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}
inline bool finite(const Numbers& x) {
  for (double e : x)
    if (!std::isfinite(e)) return false;
  return true;
}

// All that a data shows: each field's status and bits, and what the frame queries, the subtrees and the factor say.
struct Snapshot {
  struct Row {
    std::string name;
    dynStatus status;
    Numbers bits;
  };
  std::vector<Row> rows;

  Snapshot(const dynModel* m, dynData* d) {
    for (dynField f = 0; f < dyn_field_count(); ++f) {
      dynFieldInfo info{};
      info.struct_size = sizeof info;
      EXPECT_EQ(DYN_OK, dyn_field_info(f, &info));
      Numbers x;
      const dynStatus s = read_field(m, d, f, x);
      rows.push_back({info.name, s, x});
    }
    const int nv = dyn_model_nv(m);
    auto query = [&](const char* name, std::size_t n, auto&& call) {
      Numbers x(n, 0.0);
      const dynStatus s = call(x.data());
      rows.push_back({name, s, s == DYN_OK ? x : Numbers()});
    };
    for (int frame : {1, dyn_model_nframes(m) - 1}) {
      query("frame placement", 12, [&](double* x) { return dyn_frame_placement(m, d, frame, x); });
      query("frame velocity", 6, [&](double* x) { return dyn_frame_velocity(m, d, frame, DYN_REFERENCE_LOCAL, x); });
      query("frame acceleration", 6, [&](double* x) { return dyn_frame_acceleration(m, d, frame, DYN_REFERENCE_WORLD, x); });
      query("frame Jacobian", std::size_t(6 * nv),
            [&](double* x) { return dyn_frame_jacobian(m, d, frame, DYN_REFERENCE_LOCAL, x); });
    }
    query("subtree com", 3, [&](double* x) { return dyn_subtree_com(m, d, dyn_model_njoints(m) - 1, x, nullptr); });
    const Numbers ones(std::size_t(nv), 1.0);
    query("solve", std::size_t(nv), [&](double* x) { return dyn_cholesky_solve(m, d, ones.data(), 1, x); });
  }
  // "" when equal. With lost: results may have become stale, never different; the state must be equal.
  std::string differs(const Snapshot& after, bool lost = false) const {
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const Row &x = rows[k], &y = after.rows[k];
      if (x.status == y.status && same_bits(x.bits, y.bits)) continue;
      if (lost && y.status == DYN_ERROR_STALE) continue;
      return x.name + ": " + dyn_status_name(x.status) + " -> " + dyn_status_name(y.status);
    }
    return "";
  }
};

// The last error holds all of these.
inline ::testing::AssertionResult says(const std::vector<std::string>& fragments, const std::string& text = dyn_last_error()) {
  for (const std::string& f : fragments)
    if (text.find(f) == std::string::npos) return ::testing::AssertionFailure() << "'" << f << "' is not in: " << text;
  return ::testing::AssertionSuccess();
}

}  // namespace dyn_test
