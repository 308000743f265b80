// Tests the traps of FEATURES S.4 and the symptoms of S.5, a test a row (named after it): each shows that what silently went
// wrong elsewhere can't happen here. Rows that need what the library does not have yet are absent.
#include <functional>

#include "capi/calls.hpp"

namespace dyn_test {
namespace {

double distance(const Numbers& a, const Numbers& b) {
  EXPECT_EQ(a.size(), b.size());
  double worst = 0;
  for (std::size_t k = 0; k < a.size() && k < b.size(); ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}
double largest(const Numbers& a) { return distance(a, Numbers(a.size(), 0.0)); }
void expect_near(const Numbers& a, const Numbers& b, double tolerance, const std::string& what) {
  EXPECT_LE(distance(a, b), tolerance * (1 + largest(a))) << what;
}
Numbers placement(const dynModel* m, dynData* d, int frame) {
  Numbers x(12);
  EXPECT_EQ(DYN_OK, dyn_frame_placement(m, d, frame, x.data())) << dyn_last_error();
  return x;
}
Numbers frame6(dynStatus (*call)(const dynModel*, dynData*, int, dynReference, double*), const dynModel* m, dynData* d, int frame, dynReference r) {
  Numbers x(6);
  EXPECT_EQ(DYN_OK, call(m, d, frame, r, x.data())) << dyn_last_error();
  return x;
}
Numbers cross(const double* a, const double* b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
dynJointInfo joint_info(const dynModel* m, int joint) {
  dynJointInfo info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(DYN_OK, dyn_joint_info(m, joint, &info));
  return info;
}
dynFrameInfo frame_info(const dynModel* m, int frame) {
  dynFrameInfo info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(DYN_OK, dyn_frame_info(m, frame, &info)) << dyn_last_error();
  return info;
}
std::vector<Model> models() {
  std::vector<Model> all;
  all.push_back(all_types()), all.push_back(all_types(false)), all.push_back(robot("panda"));
  all.push_back(robot("go2", DYN_BASE_FLOATING)), all.push_back(robot("gripper"));
  return all;
}

// M is whole: no triangle is left for the caller to fill.
TEST(Traps, T1_HalfFilledM) {
  for (const Model& m : models()) {
    const State s = random_state(m, 1);
    Data d(m);
    const std::size_t n = std::size_t(m.nv());
    for (const char* name : {"dyn_crba", "dyn_minverse"}) {
      Prepared p(call_row(name), m, s);
      ASSERT_EQ(DYN_OK, p(m, d));
      EXPECT_TRUE(p.written()) << name;  // every element, zeros included
      const Numbers M = p.results()[0];
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < i; ++j) ASSERT_EQ(M[i + n * j], M[j + n * i]) << name;
    }
    // each column is what inverse dynamics says: M e = rnea(q, 0, e) - g
    Numbers g(n), tau(n), M = field(m, d, "M"), zero(n, 0.0);
    ASSERT_EQ(DYN_OK, dyn_gravity(m, d, s.q.data(), g.data()));
    for (std::size_t j = 0; j < n; ++j) {
      Numbers e(n, 0.0);
      e[j] = 1;
      ASSERT_EQ(DYN_OK, dyn_rnea(m, d, s.q.data(), zero.data(), e.data(), nullptr, tau.data()));
      for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(tau[i] - g[i], M[i + n * j], 1e-10 * (1 + largest(M))) << i << " " << j;
    }
  }
}

// After all terms, frames are those of the state, or are said to be stale.
void all_terms_and_frames() {
  for (const Model& m : models()) {
    const State s = random_state(m, 2), t = random_state(m, 3);
    Data d(m), fresh(m);
    compute_all(m, d, s);
    std::uint32_t filled = 0;
    ASSERT_EQ(DYN_OK, dyn_all_terms(m, d, DYN_TERM_ALL & ~DYN_TERM_FRAMES, t.q.data(), t.v.data(), &filled));
    EXPECT_FALSE(filled & DYN_TERM_FRAMES);
    EXPECT_EQ(DYN_ERROR_STALE, field_status(m, d, "placements"));
    EXPECT_TRUE(says({"placements", "dyn_frame_placements"}));
    ASSERT_EQ(DYN_OK, dyn_all_terms(m, d, DYN_TERM_ALL, nullptr, nullptr, &filled));
    EXPECT_TRUE(filled & DYN_TERM_FRAMES);
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, fresh, t.q.data(), nullptr, nullptr));
    const Numbers all = field(m, d, "placements");
    for (int f = 0; f < m.nframes(); ++f) {
      const Numbers X = placement(m, fresh, f);
      expect_near(X, Numbers(all.begin() + 12 * f, all.begin() + 12 * (f + 1)), 1e-13, "placements");
      expect_near(X, placement(m, d, f), 1e-13, "a frame's placement");
    }
  }
}
TEST(Traps, T2_FramesAfterAllTerms) { all_terms_and_frames(); }
TEST(Symptoms, S5_FramesOldAfterAllTerms) { all_terms_and_frames(); }

// A changed q takes every old pose away until it is computed again.
TEST(Traps, T3_ReadingAfterChangingQ) {
  for (const Model& m : models()) {
    const State s = random_state(m, 4), t = random_state(m, 5);
    Data d(m);
    compute_all(m, d, s);
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, t.q.data(), nullptr, nullptr, nullptr));
    for (const auto& row : Snapshot(m, d).rows) {
      if (row.name == "q" || row.name == "v" || row.name == "a" || row.name == "tau_applied" || row.name == "time") continue;
      EXPECT_EQ(DYN_ERROR_STALE, row.status) << row.name;
    }
    double X[12];
    EXPECT_EQ(DYN_ERROR_STALE, dyn_frame_placement(m, d, 1, X));
    EXPECT_TRUE(says({"dyn_frame_placement", "not computed for the current state", "call dyn_forward_kinematics first"}));
  }
}

// After any algorithm with a new q: what can be read is of that q.
TEST(Traps, T4_PlacementsAfterEveryAlgorithm) {
  for (const Model& m : models()) {
    const State s = random_state(m, 6), t = random_state(m, 7);
    Data fresh(m);
    compute_all(m, fresh, t);
    const Snapshot expected(m, fresh);
    for (const CallRow& row : call_rows) {
      if (!(row.uses & uses_q)) continue;
      Data d(m);
      compute_all(m, d, s);
      Prepared p(row, m, t);
      ASSERT_EQ(DYN_OK, p(m, d)) << row.name;
      // the rest of the state, too
      ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, t.q.data(), t.v.data(), t.a.data(), t.tau.data()));
      const Snapshot got(m, d);
      for (std::size_t k = 0; k < got.rows.size(); ++k)
        if (got.rows[k].status == DYN_OK && got.rows[k].name != "time")
          expect_near(expected.rows[k].bits, got.rows[k].bits, 1e-9, got.rows[k].name + " after " + row.name);
    }
  }
}

TEST(Traps, T5_DataOfAModelWithoutTheFrame) {
  Builder b;
  b.joint(Spec("j", DYN_JOINT_REVOLUTE)).body("l", "j");
  const Model before = b.finish();
  Data d(before);
  ASSERT_EQ(DYN_OK, dyn_builder_frame(b, "tool", "l", nullptr, DYN_FRAME_OP_FRAME));
  const Model after = b.finish();
  const int tool = dyn_frame_id(after, "tool");
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(before, d, nullptr, nullptr, nullptr));
  double X[12];
  EXPECT_EQ(DYN_ERROR_MODEL, dyn_frame_placement(after, d, tool, X));
  EXPECT_TRUE(says({"another model", "make data from the model you pass"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_frame_placement(before, d, tool, X));
}

TEST(Traps, T6_ModelsNeverChange) {
  Builder b;
  b.joint(Spec("j", DYN_JOINT_REVOLUTE)).body("l", "j");
  const Model m = b.finish();
  Data d(m);
  const State s = random_state(m, 8);
  compute_all(m, d, s);
  const Snapshot before(m, d);
  const double gravity[3] = {0, 0, 0};
  ASSERT_EQ(DYN_OK, dyn_builder_gravity(b, gravity));
  b.joint(Spec("k", DYN_JOINT_REVOLUTE, "j")).body("heavy", "k", 100);
  b.finish();
  EXPECT_TRUE(m.nv() == 1 && m.njoints() == 2 && dyn_total_mass(m) == 1);
  Data again(m);
  compute_all(m, again, s);
  EXPECT_EQ("", before.differs(Snapshot(m, again)));
}

void missing_base() {
  dynModel* m = nullptr;
  const std::string path = std::string(DYN_MODELS_DIR) + "/robots/go2.urdf";
  EXPECT_EQ(DYN_ERROR_BASE, dyn_model_load(path.c_str(), nullptr, &m));
  EXPECT_TRUE(says({"go2.urdf:", "root link 'base' has mass", "DYN_BASE_FIXED or DYN_BASE_FLOATING"}));
  EXPECT_EQ(nullptr, m);
  const Model fixed = robot("go2", DYN_BASE_FIXED), floating = robot("go2", DYN_BASE_FLOATING);
  EXPECT_EQ(12, fixed.nq());
  EXPECT_TRUE(floating.nq() == 19 && floating.nv() == 18);
  EXPECT_EQ(DYN_JOINT_FREE_FLYER, joint_info(floating, 1).type);
}
TEST(Traps, T7_MissingFloatingBase) { missing_base(); }
TEST(Symptoms, S5_NqSevenShort) { missing_base(); }

// A quaternion that is not of norm 1 is the same rotation; zero is none.
void quaternions() {
  const Model m = robot("go2", DYN_BASE_FLOATING);
  const State s = random_state(m, 9);
  Data unit(m);
  compute_all(m, unit, s);
  for (double scale : {0.5, 1 + 1e-4, 3.0, 1e-150, 1e150}) {
    State t = s;
    for (std::size_t k = 3; k < 7; ++k) t.q[k] *= scale;
    Data d(m);
    compute_all(m, d, t);
    for (const char* name : {"placements", "M", "tau", "nle", "ddq", "com", "Jcom", "kinetic"})
      expect_near(field(m, unit, name), field(m, d, name), 1e-11, name);
  }
  State t = s;
  std::fill_n(t.q.begin() + 3, 4, 0.0);
  Data d(m);
  for (const CallRow& row : call_rows) {
    if (!(row.uses & uses_q)) continue;
    Prepared p(row, m, t);
    EXPECT_EQ(DYN_ERROR_QUATERNION, p(m, d)) << row.name;
    EXPECT_TRUE(says({row.name, "quaternion of joint 'root_joint'", "zero"}));
    EXPECT_TRUE(p.untouched());
    p.s.q[4] = nan;
    EXPECT_EQ(DYN_ERROR_NONFINITE, p(m, d)) << row.name;
    EXPECT_TRUE(says({"q[4] is NaN"}));
  }
}
TEST(Traps, T8_UnnormalisedQuaternion) { quaternions(); }
TEST(Symptoms, S5_TorquesZeroOrWild) { quaternions(); }

// The only way to move a configuration stays on the manifold and turns back; adding is not it.
TEST(Traps, T9_AddingToQ) {
  for (const Model& m : models()) {
    const State s = random_state(m, 10);
    Numbers q1(s.q.size()), v(s.v.size());
    ASSERT_EQ(DYN_OK, dyn_integrate(m, s.q.data(), s.v.data(), q1.data()));
    int normalized = 0;
    ASSERT_EQ(DYN_OK, dyn_is_normalized(m, q1.data(), 1e-14, &normalized));
    EXPECT_EQ(1, normalized);
    ASSERT_EQ(DYN_OK, dyn_difference(m, s.q.data(), q1.data(), v.data()));
    expect_near(s.v, v, 1e-12, "difference of integrate");
    // a step moves by it, too
    Data d(m);
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, s.q.data(), s.v.data(), nullptr, nullptr));
    for (int k = 0; k < 100; ++k) ASSERT_EQ(DYN_OK, dyn_step(m, d, k % 2 ? DYN_RK4 : DYN_SEMI_IMPLICIT_EULER, 1e-5)) << dyn_last_error();
    ASSERT_EQ(DYN_OK, dyn_is_normalized(m, field(m, d, "q").data(), 1e-14, &normalized));
    EXPECT_EQ(1, normalized);
  }
}

// Each reference is asked for by name, and is what its name says; velocity, acceleration and Jacobian agree in each.
void references() {
  for (const Model& m : models()) {
    const State s = random_state(m, 11);
    Data d(m);
    compute_all(m, d, s);
    const std::size_t n = std::size_t(m.nv());
    for (int f = 0; f < m.nframes(); ++f) {
      const Numbers X = placement(m, d, f);
      const Numbers L = frame6(dyn_frame_velocity, m, d, f, DYN_LOCAL), A = frame6(dyn_frame_velocity, m, d, f, DYN_LOCAL_WORLD_ALIGNED),
                    W = frame6(dyn_frame_velocity, m, d, f, DYN_WORLD);
      auto turn = [&](const double* x) {
        Numbers y(3, 0.0);
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j) y[i] += X[i + 3 * j] * x[j];
        return y;
      };
      const Numbers linear = turn(L.data()), angular = turn(L.data() + 3), moved = cross(X.data() + 9, A.data() + 3);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(A[k], linear[k], 1e-10);
        EXPECT_NEAR(A[3 + k], angular[k], 1e-10);
        EXPECT_NEAR(W[k], A[k] + moved[k], 1e-10);
        EXPECT_EQ(W[3 + k], A[3 + k]);
      }
      for (dynReference r : {DYN_LOCAL, DYN_WORLD, DYN_LOCAL_WORLD_ALIGNED}) {
        Numbers J(6 * n), Jv(6, 0.0);
        ASSERT_EQ(DYN_OK, dyn_frame_jacobian(m, d, f, r, J.data()));
        for (std::size_t c = 0; c < n; ++c)
          for (std::size_t i = 0; i < 6; ++i) Jv[i] += J[i + 6 * c] * s.v[c];
        expect_near(frame6(dyn_frame_velocity, m, d, f, r), Jv, 1e-11, "J v");
      }
    }
  }
}
TEST(Traps, T10_ReferencesMixed) {
  references();
  const Model m = chain(2);
  Data d(m);
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, nullptr, nullptr, nullptr));
  double J[12];
  const int none = 3;
  dynReference r;
  std::memcpy(&r, &none, sizeof r);
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_frame_jacobian(m, d, 1, r, J));
  EXPECT_TRUE(says({"dyn_frame_jacobian", "reference 3", "DYN_LOCAL_WORLD_ALIGNED"}));
}
TEST(Symptoms, S5_FrameMismatch) { references(); }

// Two functions with two names: the classical one is the second derivative of the position.
TEST(Traps, T11_SpatialOrClassicalAcceleration) {
  for (const Model& m : models()) {
    const State s = random_state(m, 12);
    Data d(m), e(m);
    compute_all(m, d, s);
    // q(t) with v(0) = v and dv/dt = a, on the manifold
    auto position = [&](double t, int f) {
      Numbers step(s.v), q(s.q.size()), half(s.q.size());
      const int parts = 64;  // v changes along the way: midpoint steps
      q = s.q;
      for (int k = 0; k < parts; ++k) {
        const double h = t / parts, at = (k + 0.5) * h;
        for (std::size_t i = 0; i < step.size(); ++i) step[i] = h * (s.v[i] + at * s.a[i]);
        EXPECT_EQ(DYN_OK, dyn_integrate(m, q.data(), step.data(), q.data()));
      }
      EXPECT_EQ(DYN_OK, dyn_forward_kinematics(m, e, q.data(), nullptr, nullptr));
      return placement(m, e, f);
    };
    for (int f : {1, m.nframes() / 2, m.nframes() - 1}) {
      const Numbers classical = frame6(dyn_frame_classical_acceleration, m, d, f, DYN_LOCAL_WORLD_ALIGNED),
                    spatial = frame6(dyn_frame_acceleration, m, d, f, DYN_LOCAL_WORLD_ALIGNED), V = frame6(dyn_frame_velocity, m, d, f, DYN_LOCAL_WORLD_ALIGNED);
      const double h = 2e-3;
      const Numbers before = position(-h, f), now = position(0, f), after = position(h, f);
      const Numbers turn = cross(V.data() + 3, V.data());
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR((after[9 + k] - 2 * now[9 + k] + before[9 + k]) / (h * h), classical[k], 2e-3 * (1 + largest(classical))) << dyn_frame_name(m, f);
        EXPECT_NEAR(spatial[k] + turn[k], classical[k], 1e-10 * (1 + largest(classical)));
        EXPECT_EQ(spatial[3 + k], classical[3 + k]);
      }
    }
  }
}

// Where a frame was attached does not matter, only the joint that carries it and where it lies.
TEST(Traps, T12_ParentFrame) {
  double there[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.1, 0.2, 0.3}, rest[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.4, 0.1, 0.2}, whole[12];
  std::copy(there, there + 12, whole);
  for (int k = 9; k < 12; ++k) whole[k] += rest[k];
  const double com[3] = {};
  Builder b;
  b.joint(Spec("j", DYN_JOINT_REVOLUTE));
  ASSERT_EQ(DYN_OK, dyn_builder_body(b, "l", "j", there, 1, com, some_inertia));
  ASSERT_EQ(DYN_OK, dyn_builder_frame(b, "of joint", "j", whole, DYN_FRAME_OP_FRAME));
  ASSERT_EQ(DYN_OK, dyn_builder_frame(b, "of link", "l", rest, DYN_FRAME_OP_FRAME));
  const Model m = b.finish();
  const State s = random_state(m, 13);
  Data d(m);
  compute_all(m, d, s);
  const int one = dyn_frame_id(m, "of joint"), two = dyn_frame_id(m, "of link");
  EXPECT_EQ(frame_info(m, one).joint, frame_info(m, two).joint);
  expect_near(placement(m, d, one), placement(m, d, two), 1e-15, "placement");
  for (dynReference r : {DYN_LOCAL, DYN_WORLD, DYN_LOCAL_WORLD_ALIGNED}) {
    expect_near(frame6(dyn_frame_velocity, m, d, one, r), frame6(dyn_frame_velocity, m, d, two, r), 1e-15, "velocity");
    expect_near(frame6(dyn_frame_acceleration, m, d, one, r), frame6(dyn_frame_acceleration, m, d, two, r), 1e-15, "acceleration");
  }
}

// Fixed joints and merged links keep their names, placements, and their own masses.
TEST(Traps, T13_FixedJointsDisappear) {
  const char* text =
      "<robot name='r'>"
      "<link name='a'><inertial><mass value='2'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
      "<link name='b'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
      "<link name='c'><inertial><mass value='0.5'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
      "<link name='d'/>"
      "<joint name='ab' type='revolute'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
      "<joint name='bc' type='fixed'><origin xyz='0.5 0 0'/><parent link='b'/><child link='c'/></joint>"
      "<joint name='cd' type='fixed'><origin xyz='0 0.25 0'/><parent link='c'/><child link='d'/></joint></robot>";
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FLOATING;
  dynModel* raw = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load_string(text, &options, &raw)) << dyn_last_error();
  const Model m(raw);
  Data d(m);
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, nullptr, nullptr, nullptr));
  EXPECT_EQ(3, m.njoints());
  EXPECT_EQ(4, dyn_nbodies(m));
  const int carrier = dyn_joint_id(m, "ab");
  EXPECT_EQ(-1, dyn_joint_id(m, "bc"));
  for (const char* name : {"bc", "cd"}) {
    const dynFrameInfo info = frame_info(m, dyn_frame_id(m, name));
    EXPECT_EQ(DYN_FRAME_FIXED_JOINT, info.type) << name;
    EXPECT_EQ(carrier, info.joint) << name;
  }
  const double masses[] = {2, 1, 0.5, 0};
  for (int k = 0; k < 4; ++k) {
    const char name[2] = {char('a' + k), 0};
    const dynFrameInfo info = frame_info(m, dyn_frame_id_of_type(m, name, DYN_FRAME_BODY));
    EXPECT_EQ(masses[k], info.mass) << name;
    EXPECT_EQ(k ? carrier : dyn_joint_id(m, "root_joint"), info.joint) << name;
  }
  EXPECT_EQ(3.5, dyn_total_mass(m));
  EXPECT_EQ((Numbers{1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0.25, 0}), placement(m, d, dyn_frame_id(m, "d")));
}

// The mask of all terms comes back as what is in data, and it is so: field by field.
TEST(Traps, T16_WhatAllTermsFilled) {
  static const struct {
    std::uint32_t term;
    std::vector<const char*> fields;
  } rows[] = {{DYN_TERM_FRAMES, {"placements"}}, {DYN_TERM_JACOBIANS, {"J"}}, {DYN_TERM_DJACOBIANS, {"dJ"}}, {DYN_TERM_COM, {"com", "vcom"}},
              {DYN_TERM_JCOM, {"Jcom"}}, {DYN_TERM_NLE, {"nle"}}, {DYN_TERM_GRAVITY, {"g"}}, {DYN_TERM_MASS, {"M"}}, {DYN_TERM_MINV, {"Minv"}},
              {DYN_TERM_CORIOLIS, {"coriolis"}}, {DYN_TERM_ENERGY, {"kinetic", "potential", "mechanical"}}};
  const Model m = all_types();
  Random g{14};
  for (int round = 0; round < 400; ++round) {
    const State s = random_state(m, std::uint64_t(round));
    Data d(m);
    const std::uint32_t mask = std::uint32_t(g.next()) & DYN_TERM_ALL;
    std::uint32_t filled = 0;
    ASSERT_EQ(DYN_OK, dyn_all_terms(m, d, mask, s.q.data(), s.v.data(), &filled)) << dyn_last_error();
    EXPECT_EQ(mask, filled & mask) << "asked for and not filled";
    EXPECT_EQ(0u, filled & ~std::uint32_t(DYN_TERM_ALL));
    for (const auto& row : rows)
      for (const char* name : row.fields) {
        const bool fresh = field_status(m, d, name) == DYN_OK;
        EXPECT_TRUE(fresh || !(filled & row.term)) << name << " of mask " << mask;
        EXPECT_TRUE(!fresh || filled & row.term || row.fields.size() > 1) << name << " of mask " << mask;
      }
    Numbers X(12), V(6), ones(std::size_t(m.nv()), 1.0);
    EXPECT_EQ(filled & DYN_TERM_KINEMATICS ? DYN_OK : DYN_ERROR_STALE, dyn_frame_velocity(m, d, 1, DYN_LOCAL, V.data()));
    EXPECT_EQ(filled & DYN_TERM_FACTOR ? DYN_OK : DYN_ERROR_STALE, dyn_solve(m, d, ones.data(), 1, ones.data()));
    EXPECT_EQ(DYN_OK, dyn_frame_placement(m, d, 1, X.data()));  // always included
  }
  // one pass or many: the same
  const State s = random_state(m, 15);
  Data all(m), one(m);
  ASSERT_EQ(DYN_OK, dyn_all_terms(m, all, DYN_TERM_ALL, s.q.data(), s.v.data(), nullptr));
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, one, s.q.data(), s.v.data(), nullptr, nullptr));
  for (const char* name : {"dyn_frame_placements", "dyn_joint_jacobians_time_variation", "dyn_center_of_mass", "dyn_center_of_mass_jacobian",
                           "dyn_nonlinear_effects", "dyn_gravity", "dyn_minverse", "dyn_coriolis_matrix", "dyn_energy"}) {
    State rest = s;
    std::fill(rest.a.begin(), rest.a.end(), 0.0);
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, one, s.q.data(), s.v.data(), nullptr));
    Prepared p(call_row(name), m, rest);
    ASSERT_EQ(DYN_OK, p(m, one)) << name << dyn_last_error();
  }
  for (const auto& row : rows)
    for (const char* name : row.fields) expect_near(field(m, one, name), field(m, all, name), 1e-12, name);
}

// A mesh that is not there is said, with where it was looked for; strict refuses.
TEST(Traps, T19_MeshNotFound) {
  const char* text =
      "<robot name='r'><link name='a'>\n<collision><geometry><mesh filename='package://nowhere/meshes/a.stl'/></geometry></collision></link></robot>";
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  const char* dirs[] = {"/none/such"};
  options.package_dirs = dirs, options.package_dirs_count = 1;
  dynModel* raw = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load_string(text, &options, &raw)) << dyn_last_error();
  const Model m(raw);
  bool found = false;
  for (int k = 0; k < dyn_report_count(m); ++k) {
    dynReportEntry e{};
    e.struct_size = sizeof e;
    ASSERT_EQ(DYN_OK, dyn_report_entry(m, k, &e));
    found |= e.level == DYN_REPORT_WARNING && e.line == 2 && says({"package://nowhere/meshes/a.stl", "not found", "/none/such"}, e.message);
  }
  EXPECT_TRUE(found);
  options.strict = 1;
  dynModel* none = nullptr;
  EXPECT_EQ(DYN_ERROR_STRICT, dyn_model_load_string(text, &options, &none));
  EXPECT_TRUE(says({"a.stl", "not found"}));
}

// What is singular is an error that names the joint; nothing that is not a number leaves a function.
TEST(Traps, T20_NanFromTheSingular) {
  for (const bool mimic : {false, true}) {
    const Model m = singular_at_zero(mimic);
    Data d(m);
    Numbers out(9, 0.5);
    for (const char* name : {"dyn_aba", "dyn_minverse"}) {
      Prepared p(call_row(name), m, State{Numbers(3, 0.0), Numbers(3, 0.0), Numbers(3, 0.0), Numbers(3, 1.0), Numbers(30, 0.0)});
      EXPECT_EQ(DYN_ERROR_NUMERIC, p(m, d)) << name;
      EXPECT_TRUE(says({"singular", "'shoulder'", "armature"}));
      EXPECT_TRUE(p.untouched()) << name;
    }
    // ever nearer to it: finite or refused
    for (double q = 1; q > 1e-320; q /= 8) {
      const Numbers bent = {0, q, 0}, tau(3, 1.0);
      const dynStatus s = dyn_aba(m, d, bent.data(), nullptr, tau.data(), nullptr, out.data());
      EXPECT_TRUE(s == DYN_OK || s == DYN_ERROR_NUMERIC);
      EXPECT_TRUE(finite(out));
    }
  }
}

// Each data is its own: what one computes is nothing to the other. (At once by two threads: tests/rt.)
void shared_data() {
  const Model m = all_types();
  Data d(m), e(m);
  const State s = random_state(m, 16), t = random_state(m, 17);
  compute_all(m, d, s);
  const Snapshot before(m, d);
  compute_all(m, e, t);
  ASSERT_EQ(DYN_OK, dyn_step(m, e, DYN_RK4, 1e-3));
  EXPECT_EQ("", before.differs(Snapshot(m, d)));
}
TEST(Traps, T21_SharedData) { shared_data(); }
TEST(Symptoms, S5_UnstableResults) { shared_data(); }

// The first call computes what the later ones do; nothing is set up on the way. (No allocation in it: tests/rt.)
TEST(Traps, T24_FirstCall) {
  for (const Model& m : models()) {
    const State s = random_state(m, 18);
    for (const CallRow& row : call_rows) {
      if (row.needs != Needs::nothing || std::string(row.name) == "dyn_step" || std::string(row.name) == "dyn_data_array") continue;
      Data d(m);
      Prepared first(row, m, s), second(row, m, s);
      ASSERT_EQ(DYN_OK, first(m, d)) << row.name;
      ASSERT_EQ(DYN_OK, second(m, d)) << row.name;
      for (int k = 0; k < row.outputs; ++k) EXPECT_TRUE(same_bits(first.out[k], second.out[k])) << row.name;
    }
  }
}

// ---------------------------------------------------------------------------------------------------- T25

// The same mechanism with its followers bound to their leaders, and free.
Model geared(bool bound) {
  Builder b;
  const std::array<double, 3> at = {0.2, 0.1, -0.1};
  b.joint(Spec("base", DYN_JOINT_FREE_FLYER)).body("trunk", "base", 3);
  b.joint(Spec("lead", DYN_JOINT_REVOLUTE, "base", at).about(0, 1, 0)).body("b1", "lead");
  auto follow = [&](const char* name, dynJointType type, const char* parent, const char* leader, double ratio, double offset, double x) {
    Spec s(name, type, parent, at);
    s.about(x, 1, 0.5);
    if (bound) s.mimic = leader, s.mimic_ratio = ratio, s.mimic_offset = offset;
    b.joint(s).body((std::string("b ") + name).c_str(), name);
  };
  follow("inner", DYN_JOINT_REVOLUTE, "lead", "lead", -1.5, 0.2, 1);
  b.joint(Spec("ball", DYN_JOINT_SPHERICAL, "inner", at)).body("b2", "ball");
  follow("tip", DYN_JOINT_PRISMATIC, "ball", "inner", 0.4, -0.1, 0);
  follow("aside", DYN_JOINT_REVOLUTE, "base", "late", 2, 0, -1);  // its leader comes later
  b.joint(Spec("late", DYN_JOINT_PRISMATIC, "base", at)).body("b3", "late");
  follow("screw", DYN_JOINT_CONTINUOUS, "late", "late", 3, 0.3, 2);
  return b.finish();
}

// Every algorithm honours mimic, as the reduction q_x = G q + offset, v_x = G v says.
TEST(Traps, T25_MimicInEveryAlgorithm) {
  const Model m = geared(true), full = geared(false);
  const std::size_t n = std::size_t(m.nv()), N = std::size_t(full.nv());
  ASSERT_EQ(n + 4, N);
  Numbers G(N * n, 0.0);
  for (int j = 1; j < full.njoints(); ++j) {
    const dynJointInfo f = joint_info(full, j), r = joint_info(m, j);
    ASSERT_STREQ(f.name, r.name);
    EXPECT_EQ(r.mimic_leader < 0 ? f.nv : 0, r.nv) << f.name;
    for (int k = 0; k < f.nv; ++k) G[std::size_t(f.idx_v + k) + N * std::size_t(r.idx_v + k)] = r.mimic_leader < 0 ? 1 : r.mimic_ratio;
  }
  auto expand = [&](const Numbers& x) {
    Numbers y(N, 0.0);
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t k = 0; k < n; ++k) y[i] += G[i + N * k] * x[k];
    return y;
  };
  auto reduce = [&](const Numbers& y, std::size_t rows = 1) {  // columns of a rows x N matrix
    Numbers x(rows * n, 0.0);
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = 0; i < N; ++i)
        for (std::size_t r = 0; r < rows; ++r) x[r + rows * k] += G[i + N * k] * y[r + rows * i];
    return x;
  };
  auto transpose = [](const Numbers& A, std::size_t rows) {
    Numbers B(A.size());
    const std::size_t cols = A.size() / rows;
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < cols; ++j) B[j + cols * i] = A[i + rows * j];
    return B;
  };
  auto both_sides = [&](const Numbers& A) { return transpose(reduce(transpose(reduce(A, N), N), n), n); };

  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const State s = random_state(m, seed);
    State x;
    x.q.assign(std::size_t(full.nq()), 0.0);
    for (int j = 1; j < full.njoints(); ++j) {
      const dynJointInfo f = joint_info(full, j), r = joint_info(m, j);
      for (int k = 0; k < f.nq; ++k)
        x.q[std::size_t(f.idx_q + k)] = r.mimic_leader < 0 ? s.q[std::size_t(r.idx_q + k)] : r.mimic_ratio * s.q[std::size_t(r.idx_q)] + r.mimic_offset;
    }
    x.v = expand(s.v), x.a = expand(s.a), x.tau.assign(N, 0.0), x.fext = s.fext;
    Data d(m), e(full);
    compute_all(m, d, s), compute_all(full, e, x);
    for (const char* name : {"tau", "nle", "g", "static_torque"}) expect_near(reduce(field(full, e, name)), field(m, d, name), 1e-12, name);
    for (const char* name : {"placements", "com", "vcom", "acom", "kinetic", "potential", "mechanical"})
      expect_near(field(full, e, name), field(m, d, name), 1e-12, name);
    for (const char* name : {"J", "dJ"}) expect_near(reduce(field(full, e, name), 6), field(m, d, name), 1e-12, name);
    expect_near(reduce(field(full, e, "Jcom"), 3), field(m, d, "Jcom"), 1e-12, "Jcom");
    for (const char* name : {"M", "coriolis"}) expect_near(both_sides(field(full, e, name)), field(m, d, name), 1e-12, name);
    // M Minv = 1, and forward dynamics with it
    const Numbers M = field(m, d, "M"), Minv = field(m, d, "Minv"), ddq = field(m, d, "ddq");
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        double sum = 0;
        for (std::size_t k = 0; k < n; ++k) sum += M[i + n * k] * Minv[k + n * j];
        EXPECT_NEAR(i == j, sum, 1e-9);
      }
    Numbers back(n);
    ASSERT_EQ(DYN_OK, dyn_rnea(m, d, nullptr, nullptr, ddq.data(), s.fext.data(), back.data()));
    expect_near(s.tau, back, 1e-9, "rnea of aba");
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, s.q.data(), s.v.data(), s.a.data()));
    ASSERT_EQ(DYN_OK, dyn_center_of_mass(m, d, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr));
    for (int f = 0; f < m.nframes(); ++f)
      for (dynReference r : {DYN_LOCAL, DYN_WORLD, DYN_LOCAL_WORLD_ALIGNED}) {
        for (auto call : {dyn_frame_velocity, dyn_frame_acceleration, dyn_frame_classical_acceleration})
          expect_near(frame6(call, full, e, f, r), frame6(call, m, d, f, r), 1e-12, "frame");
        Numbers J(6 * n), F(6 * N);
        for (auto call : {dyn_frame_jacobian, dyn_frame_jacobian_time_variation}) {
          ASSERT_EQ(DYN_OK, call(m, d, f, r, J.data()));
          ASSERT_EQ(DYN_OK, call(full, e, f, r, F.data()));
          expect_near(reduce(F, 6), J, 1e-12, "frame Jacobian");
        }
      }
    for (int j = 1; j < m.njoints(); ++j) {
      Numbers c(3), C(3), J(3 * n), F(3 * N);
      ASSERT_EQ(DYN_OK, dyn_subtree_center_of_mass(m, d, j, c.data(), nullptr));
      ASSERT_EQ(DYN_OK, dyn_subtree_center_of_mass(full, e, j, C.data(), nullptr));
      expect_near(C, c, 1e-12, "subtree");
      ASSERT_EQ(DYN_OK, dyn_subtree_center_of_mass_jacobian(m, d, j, J.data()));
      ASSERT_EQ(DYN_OK, dyn_subtree_center_of_mass_jacobian(full, e, j, F.data()));
      expect_near(reduce(F, 3), J, 1e-12, "subtree Jacobian");
    }
    // and a step keeps the gears in mesh: the full model moved by the reduced accelerations is the same motion
    Numbers moved(s.q.size()), hv(s.v);
    for (std::size_t k = 0; k < n; ++k) hv[k] = 1e-3 * (s.v[k] + 1e-3 * ddq[k]);
    ASSERT_EQ(DYN_OK, dyn_integrate(m, s.q.data(), hv.data(), moved.data()));
    Data step(m);
    ASSERT_EQ(DYN_OK, dyn_aba(m, step, s.q.data(), s.v.data(), s.tau.data(), nullptr, nullptr));
    const Numbers free_ddq = field(m, step, "ddq");
    ASSERT_EQ(DYN_OK, dyn_step(m, step, DYN_SEMI_IMPLICIT_EULER, 1e-3));
    for (std::size_t k = 0; k < n; ++k) EXPECT_NEAR(s.v[k] + 1e-3 * free_ddq[k], field(m, step, "v")[k], 1e-12);
  }
}

// ----------------------------------------------------------------------------------------------------

// Damping and dry friction are kept as data with the model; inverse and forward dynamics are those of the frictionless robot, both.
TEST(Traps, T26_DampingLoadedButUnused) {
  const char* text =
      "<robot name='r'><link name='a'/><link name='b'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
      "<joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/>%s</joint></robot>";
  Model m[2];
  for (int k = 0; k < 2; ++k) {
    std::string t = text;
    t.replace(t.find("%s"), 2, k ? "<dynamics damping='0.7' friction='0.3'/>" : "");
    dynLoadOptions options;
    dyn_load_options_init(&options);
    options.base = DYN_BASE_FIXED, options.strict = 1;  // strict: and nothing is lost
    ASSERT_EQ(DYN_OK, dyn_model_load_string(t.c_str(), &options, &m[k].m)) << dyn_last_error();
  }
  EXPECT_EQ(0.7, dyn_model_array(m[1], DYN_DAMPING)[0]);
  EXPECT_EQ(0.3, dyn_model_array(m[1], DYN_FRICTION)[0]);
  EXPECT_EQ(0.0, dyn_model_array(m[0], DYN_DAMPING)[0]);
  const State s = random_state(m[0], 19);
  Data d(m[0]), e(m[1]);
  compute_all(m[0], d, s), compute_all(m[1], e, s);
  EXPECT_EQ("", Snapshot(m[0], d).differs(Snapshot(m[1], e)));
  ASSERT_EQ(DYN_OK, dyn_step(m[0], d, DYN_RK4, 0.1));
  ASSERT_EQ(DYN_OK, dyn_step(m[1], e, DYN_RK4, 0.1));
  EXPECT_TRUE(same_bits(field(m[0], d, "v"), field(m[1], e, "v")));
}

// Joints come in the file's order, not the alphabet's; by name, the indices in any order one likes.
TEST(Traps, T27_JointOrder) {
  const char* names[] = {"zeta", "alpha", "mid"};
  std::string text = "<robot name='r'><link name='root'/>";
  const std::string solid = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>";
  for (const char* n : names)
    text += std::string("<link name='l") + n + "'>" + solid + "<joint name='" + n + "' type='continuous'><parent link='root'/><child link='l" + n +
            "'/><axis xyz='0 0 1'/></joint>";
  text += "</robot>";
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  dynModel* raw = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load_string(text.c_str(), &options, &raw)) << dyn_last_error();
  const Model m(raw);
  for (int k = 0; k < 3; ++k) EXPECT_STREQ(names[k], dyn_joint_name(m, k + 1));
  const char* mine[] = {"alpha", "mid", "zeta"};
  std::int32_t q[3], v[3];
  ASSERT_EQ(DYN_OK, dyn_q_permutation(m, mine, 3, q, v));
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(q[k] == (k + 1) % 3 && v[k] == q[k]) << k;
}

// Six numbers are [linear; angular] everywhere.
TEST(Traps, T28_OrderOfSix) {
  Builder b;
  b.joint(Spec("rail", DYN_JOINT_PRISMATIC).about(1, 0, 0)).body("car", "rail", 2, {0, 0, 0});
  b.joint(Spec("pivot", DYN_JOINT_REVOLUTE, "rail")).body("arm", "pivot", 1, {0, 0, 0});
  b.joint(Spec("free", DYN_JOINT_FREE_FLYER)).body("ball", "free", 3, {0, 0, 0});
  const Model m = b.finish();
  Data d(m);
  State s = random_state(m, 20);
  s.v = {5, 7, 1, 2, 3, 4, 5, 6};
  std::fill(s.q.begin(), s.q.end(), 0.0);
  s.q.back() = 1;
  compute_all(m, d, s);
  expect_near({5, 0, 0, 0, 0, 0}, frame6(dyn_frame_velocity, m, d, dyn_frame_id(m, "rail"), DYN_LOCAL), 1e-15, "rail");
  expect_near({5, 0, 0, 0, 0, 7}, frame6(dyn_frame_velocity, m, d, dyn_frame_id(m, "pivot"), DYN_LOCAL), 1e-15, "pivot");
  expect_near({1, 2, 3, 4, 5, 6}, frame6(dyn_frame_velocity, m, d, dyn_frame_id(m, "free"), DYN_LOCAL), 1e-15, "free");
  const Numbers J = field(m, d, "J");
  expect_near({1, 0, 0, 0, 0, 0}, Numbers(J.begin(), J.begin() + 6), 1e-15, "column of rail");
  expect_near({0, 0, 0, 0, 0, 1}, Numbers(J.begin() + 6, J.begin() + 12), 1e-15, "column of pivot");
  // forces, too: the first three push
  Numbers fext(24, 0.0), none(8, 0.0), push(8), rest(8);
  fext[6 * 3 + 0] = 10;
  ASSERT_EQ(DYN_OK, dyn_static_torque(m, d, nullptr, nullptr, rest.data()));
  ASSERT_EQ(DYN_OK, dyn_static_torque(m, d, nullptr, fext.data(), push.data()));
  for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(k == 2 ? -10 : 0, push[k] - rest[k], 1e-12) << k;
}

// An external force acts at the joint frame's origin, in its axes: tau - J^T f with the joint frame's own Jacobian.
TEST(Traps, T30_ForceAtTheWrongPoint) {
  for (const Model& m : models()) {
    const State s = random_state(m, 21);
    Data d(m);
    compute_all(m, d, s);
    const std::size_t n = std::size_t(m.nv());
    Numbers with(n), without(n), J(6 * n);
    ASSERT_EQ(DYN_OK, dyn_rnea(m, d, nullptr, nullptr, nullptr, nullptr, without.data()));
    for (int j = 1; j < m.njoints(); ++j) {
      Numbers fext(s.fext.size(), 0.0);
      std::copy_n(s.fext.begin() + 6 * j, 6, fext.begin() + 6 * j);
      ASSERT_EQ(DYN_OK, dyn_rnea(m, d, nullptr, nullptr, nullptr, fext.data(), with.data()));
      ASSERT_EQ(DYN_OK, dyn_frame_jacobian(m, d, dyn_frame_id(m, dyn_joint_name(m, j)), DYN_LOCAL, J.data()));
      for (std::size_t c = 0; c < n; ++c) {
        double power = 0;
        for (std::size_t k = 0; k < 6; ++k) power += J[k + 6 * c] * fext[std::size_t(6 * j) + k];
        EXPECT_NEAR(without[c] - power, with[c], 1e-10 * (1 + largest(without))) << dyn_joint_name(m, j);
      }
    }
  }
}

// Nothing computed is no identity: a new data says so.
TEST(Symptoms, S5_EverythingIsTheIdentity) {
  for (const Model& m : models()) {
    Data d(m);
    double X[12] = {9};
    EXPECT_EQ(DYN_ERROR_STALE, dyn_frame_placement(m, d, 1, X));
    EXPECT_TRUE(says({"call dyn_forward_kinematics first"}));
    EXPECT_EQ(9, X[0]);
    for (const auto& row : Snapshot(m, d).rows)
      EXPECT_TRUE(row.status == DYN_ERROR_STALE || row.name == "q" || row.name == "v" || row.name == "a" || row.name == "tau_applied" || row.name == "time")
          << row.name;
  }
}

}  // namespace
}  // namespace dyn_test
