// Tests what is too large or singular: DYN_ERROR_NUMERIC or a finite result, never a NaN; and the data as before.
#include <functional>

#include "common/every.hpp"
#include "capi/calls.hpp"

namespace dyn_test {
namespace {

// Makes the numbers of an array that are no quaternion huge.
void blow_up(const dynModel* m, Numbers& x, bool is_q, double size, std::uint64_t seed) {
  Random g{seed};
  for (double& e : x)
    if (!is_q || g.below(2)) e = size * (g.below(2) ? 1 : -1);
  if (!is_q) return;
  // rotations stay rotations
  for (int j = 1; j < dyn_model_njoints(m); ++j) {
    dynJointInfo info{};
    info.struct_size = sizeof info;
    ASSERT_EQ(DYN_OK, dyn_model_joint_info(m, j, &info));
    if (info.nq > info.nv) x[std::size_t(info.idx_q + info.nq - 1)] = size;
  }
}

// All frame queries of a data that says its kinematics are fresh.
void expect_finite_frames(const dynModel* m, dynData* d, const std::string& where) {
  const int nv = dyn_model_nv(m);
  Numbers x(std::size_t(6 * nv * nv + 12));
  using Query = std::function<dynStatus(int, dynReference)>;
  const std::pair<const char*, Query> queries[] = {
      {"placement", [&](int f, dynReference) { return dyn_frame_placement(m, d, f, x.data()); }},
      {"velocity", [&](int f, dynReference r) { return dyn_frame_velocity(m, d, f, r, x.data()); }},
      {"acceleration", [&](int f, dynReference r) { return dyn_frame_acceleration(m, d, f, r, x.data()); }},
      {"classical", [&](int f, dynReference r) { return dyn_frame_classical_acceleration(m, d, f, r, x.data()); }},
      {"jacobian", [&](int f, dynReference r) { return dyn_frame_jacobian(m, d, f, r, x.data()); }},
      {"djacobian", [&](int f, dynReference r) { return dyn_frame_jacobian_time_variation(m, d, f, r, x.data()); }},
      {"velocity by q", [&](int f, dynReference r) { return dyn_frame_velocity_derivatives(m, d, f, r, x.data(), nullptr); }},
      {"acceleration by q",
       [&](int f, dynReference r) { return dyn_frame_acceleration_derivatives(m, d, f, r, x.data(), nullptr, nullptr); }},
      {"classical by q",
       [&](int f, dynReference r) {
         return dyn_frame_classical_acceleration_derivatives(m, d, f, r, x.data(), nullptr, nullptr);
       }},
      {"classical by v",
       [&](int f, dynReference r) {
         return dyn_frame_classical_acceleration_derivatives(m, d, f, r, nullptr, x.data(), nullptr);
       }},
      {"hessian", [&](int f, dynReference r) { return dyn_frame_kinematic_hessian(m, d, f, r, x.data()); }},
  };
  for (const auto& [name, query] : queries)
    for (int f = 0; f < dyn_model_nframes(m); f += 3)
      for (dynReference r : {DYN_REFERENCE_LOCAL, DYN_REFERENCE_WORLD, DYN_REFERENCE_LOCAL_WORLD_ALIGNED}) {
        std::fill(x.begin(), x.end(), 0.5);
        const dynStatus s = query(f, r);
        if (s == DYN_OK) EXPECT_TRUE(finite(x)) << where << ": " << name << " of frame " << f << " in " << r;
        else {
          EXPECT_TRUE(s == DYN_ERROR_NUMERIC || s == DYN_ERROR_STALE) << where << ": " << name << ": " << dyn_last_error();
          for (double e : x) ASSERT_EQ(0.5, e) << where << ": " << name;
        }
      }
}

void sweep(const Model& m, double size, int& refused) {
  const State held = random_state(m, 11);
  const unsigned kinds[] = {uses_q, uses_v, uses_a, uses_tau, uses_fext, uses_b, uses_lambda, uses_q | uses_v | uses_a};
  for (const CallRow& row : call_rows)
    for (unsigned kind : kinds) {
      if (!(row.uses & kind)) continue;
      Data d(m);
      compute_all(m, d, held);
      Prepared p(row, m, random_state(m, 12));
      if (kind & uses_q) blow_up(m, p.s.q, true, size, 1);
      if (kind & uses_v) blow_up(m, p.s.v, false, size, 2);
      if (kind & uses_a) blow_up(m, p.s.a, false, size, 3);
      if (kind & uses_tau) blow_up(m, p.s.tau, false, size, 4);
      if (kind & uses_fext) blow_up(m, p.s.fext, false, size, 5);
      if (kind & (uses_b | uses_lambda)) blow_up(m, p.b, false, size, 6);
      const std::string where = std::string(dyn_model_name(m)) + " " + row.name + " " + std::to_string(kind) + " at " +
                                std::to_string(std::log10(size));
      const Snapshot before(m, d);
      const dynStatus status = p(m, d);
      if (status == DYN_OK) {
        for (const Numbers& x : p.results()) EXPECT_TRUE(may_be_infinite(row) || finite(x)) << where;
        for (const auto& r : Snapshot(m, d).rows)
          EXPECT_TRUE(std::string(r.name) == "distances" || finite(r.bits)) << where << ": " << r.name;  // infinite: not tested
        if (std::string(row.name) == "dyn_forward_kinematics") expect_finite_frames(m, d, where);
        continue;
      }
      ++refused;
      EXPECT_EQ(DYN_ERROR_NUMERIC, status) << where << dyn_last_error();
      EXPECT_TRUE(says({"too large"}) || says({"singular"}) || says({"no longer finite"})) << where << ": " << dyn_last_error();
      EXPECT_TRUE(p.untouched()) << where;
      // results that the call would have replaced may be gone; none is wrong, and the state is the old one
      EXPECT_EQ("", before.differs(Snapshot(m, d), true)) << where;
    }
}

TEST(Overflow, OneIn200) {
  int refused = 0;
  for (const Model& m : {all_types(), all_types(false), robot("panda"), robot("go2", DYN_BASE_FLOATING)})
    sweep(m, 1e200, refused);
  EXPECT_GT(refused, 20);
}
TEST(Overflow, Largest) {
  int refused = 0;
  for (const Model& m : {all_types(), all_types(false), robot("humanoid", DYN_BASE_FLOATING), robot("gripper")})
    sweep(m, 1.7e308, refused);
  EXPECT_GT(refused, 20);
}
TEST(Overflow, SquaresNearTheLimit) {
  int refused = 0;
  for (double size : {1e100, 1e150, 1e154})
    for (const Model& m : {all_types(), all_types(false), robot("panda"), robot("humanoid", DYN_BASE_FLOATING)})
      sweep(m, size, refused);
}

// The state itself may be huge (nothing is computed when it is set); what is computed from it is finite or refused.
TEST(Overflow, HeldState) {
  for (const Model& m : {all_types(), all_types(false), robot("panda"), robot("humanoid", DYN_BASE_FLOATING)})
    for (double size : {1e100, 1e160, 1e200, 1.7e308})
      for (unsigned kind : {unsigned(uses_q), unsigned(uses_v), unsigned(uses_a), unsigned(uses_q | uses_v | uses_a)}) {
        Data d(m);
        State s = random_state(m, 16);
        compute_all(m, d, s);
        if (kind & uses_q) blow_up(m, s.q, true, size, 7);
        if (kind & uses_v) blow_up(m, s.v, false, size, 8);
        if (kind & uses_a) blow_up(m, s.a, false, size, 9);
        ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, s.q.data(), s.v.data(), s.a.data(), s.tau.data()));
        for (const CallRow& row : call_rows) {
          ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, s.q.data(), s.v.data(), s.a.data(), s.tau.data()));
          Prepared p(row, m, s);
          p.x.q = p.x.v = p.x.a = p.x.tau = nullptr;
          const std::string where = std::string(dyn_model_name(m)) + " " + row.name + " " + std::to_string(kind) + " at " +
                                    std::to_string(std::log10(size));
          const dynStatus status = p(m, d);
          EXPECT_TRUE(status == DYN_OK || status == DYN_ERROR_NUMERIC || status == DYN_ERROR_STALE)
              << where << ": " << dyn_last_error();
          EXPECT_TRUE(status == DYN_OK || p.untouched()) << where;
          for (const Numbers& x : p.results()) EXPECT_TRUE(may_be_infinite(row) || finite(x)) << where;
          for (const auto& r : Snapshot(m, d).rows)
            EXPECT_TRUE(std::string(r.name) == "distances" || finite(r.bits)) << where << ": " << r.name;  // infinite: not tested
          if (std::string(row.name) == "dyn_step") continue;
          EXPECT_TRUE(same_bits(s.q, field(m, d, "q")) && same_bits(s.v, field(m, d, "v"))) << where;
        }
        ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, s.q.data(), s.v.data(), s.a.data(), s.tau.data()));
        expect_finite_frames(m, d, std::string(dyn_model_name(m)) + " held " + std::to_string(kind));
      }
}

TEST(Overflow, SaysWhereAndWhy) {
  const Model m = all_types();
  Data d(m);
  State s = random_state(m, 13);
  compute_all(m, d, s);
  std::fill(s.v.begin(), s.v.end(), 1e200);
  EXPECT_EQ(DYN_ERROR_NUMERIC, dyn_rnea(m, d, nullptr, s.v.data(), nullptr, nullptr, nullptr));
  EXPECT_TRUE(says({"dyn_rnea", "tau[", "overflow", "too large"}));
  EXPECT_EQ(DYN_ERROR_NUMERIC, dyn_forward_kinematics(m, d, nullptr, s.v.data(), s.a.data()));
  EXPECT_TRUE(says({"joint '", "too large"}));
}

// What the failed call was to compute is lost and says so; the state is as before, and no result is another number.
TEST(Overflow, LostResultsAreStale) {
  const Model m = all_types();
  const State s = random_state(m, 17);
  const Numbers huge(s.v.size(), 1e200);
  const std::pair<const char*, const char*> rows[] = {
      {"dyn_rnea", "tau"}, {"dyn_nle", "nle"}, {"dyn_aba", "ddq"}, {"dyn_energy", "mechanical"}};
  for (const auto& [name, lost] : rows)
    for (bool held : {false, true}) {  // the huge v is the call's, or the data's
      Data d(m);
      compute_all(m, d, s);
      if (held) {
        ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, nullptr, huge.data(), nullptr, nullptr));
      }
      const Snapshot before(m, d);
      Prepared p(call_row(name), m, s);
      p.x.q = p.x.a = p.x.tau = nullptr;
      p.x.v = held ? nullptr : huge.data();
      EXPECT_EQ(DYN_ERROR_NUMERIC, p(m, d)) << name;
      if (!held) {
        EXPECT_EQ("", before.differs(Snapshot(m, d), true)) << name;
      }
      EXPECT_TRUE(same_bits(s.q, field(m, d, "q")) && same_bits(held ? huge : s.v, field(m, d, "v"))) << name;
      EXPECT_EQ(DYN_ERROR_STALE, field_status(m, d, lost)) << name;
      EXPECT_TRUE(says({lost, "call "})) << dyn_last_error();
    }
}

// Steps that blow up leave state and time; and what dyn_aba had computed is not theirs.
TEST(Overflow, FailedStep) {
  for (const bool mimic : {true, false})
    for (dynIntegrator integrator : every<dynIntegrator>("dynIntegrator")) {
      const Model m = all_types(mimic);
      Data d(m);
      const State s = random_state(m, 14);
      compute_all(m, d, s);
      for (double dt : {1e200, 1e308}) {
        const Snapshot before(m, d);
        EXPECT_EQ(DYN_ERROR_NUMERIC, take_step(m, d, integrator, dt)) << dt;
        EXPECT_TRUE(says({"dyn_step", "as before"}));
        // an iteration that does not end, or steps that none is short enough for, are nobody's
        if (integrator != DYN_INTEGRATOR_IMPLICIT_MIDPOINT && integrator != DYN_INTEGRATOR_REFERENCE) {
          EXPECT_TRUE(says({"joint '"}));
        }
        EXPECT_EQ("", before.differs(Snapshot(m, d), true)) << "mimic " << mimic << " integrator " << integrator;
        // placements and the frame queries survive
        double X[12], V[6];
        EXPECT_EQ(DYN_OK, dyn_frame_placement(m, d, 1, X)) << dyn_last_error();
        EXPECT_EQ(DYN_OK, dyn_frame_acceleration(m, d, 1, DYN_REFERENCE_LOCAL, V)) << dyn_last_error();
      }
    }
}

// A singular configuration: the state that was held comes back, in each call that finds it.
TEST(Singular, NamesTheJointAndTakesTheStateBack) {
  for (const bool mimic : {false, true}) {
    const Model m = singular_at_zero(mimic);
    const Numbers good = {0.3, 0.7, 0.1}, bad(3, 0.0);
    using Call = std::function<dynStatus(dynData*, const double*)>;
    const std::pair<const char*, Call> calls[] = {
        {"dyn_aba", [&](dynData* d, const double* q) { return dyn_aba(m, d, q, nullptr, nullptr, nullptr, nullptr); }},
        {"dyn_minv", [&](dynData* d, const double* q) { return dyn_minv(m, d, q, nullptr); }},
        {"dyn_all_terms CHOLESKY",
         [&](dynData* d, const double* q) { return dyn_all_terms(m, d, DYN_TERM_CHOLESKY, q, nullptr, nullptr); }},
        {"dyn_all_terms MINV",
         [&](dynData* d, const double* q) { return dyn_all_terms(m, d, DYN_TERM_MINV, q, nullptr, nullptr); }},
        {"dyn_all_terms ALL",
         [&](dynData* d, const double* q) { return dyn_all_terms(m, d, DYN_TERM_ALL, q, nullptr, nullptr); }},
    };
    for (const auto& [name, call] : calls) {
      Data d(m);
      State s = random_state(m, 15);
      s.q = good;
      compute_all(m, d, s);
      const Snapshot before(m, d);
      EXPECT_EQ(DYN_ERROR_NUMERIC, call(d, bad.data())) << name;
      EXPECT_TRUE(says({"singular", "joint 'shoulder'", "armature"})) << name << ": " << dyn_last_error();
      EXPECT_EQ("", before.differs(Snapshot(m, d), true)) << name << (mimic ? " with mimic" : "");
      EXPECT_TRUE(same_bits(good, field(m, d, "q"))) << name;
      EXPECT_EQ(DYN_OK, call(d, nullptr)) << name << dyn_last_error();
    }
    // in two calls: M exists, its factor does not
    Data d(m);
    ASSERT_EQ(DYN_OK, dyn_crba(m, d, bad.data(), nullptr));
    const Snapshot before(m, d);
    EXPECT_EQ(DYN_ERROR_NUMERIC, dyn_cholesky(m, d));
    EXPECT_TRUE(says({"singular", "shoulder"}));
    EXPECT_EQ("", before.differs(Snapshot(m, d)));
    Numbers x = {1, 2, 3};
    EXPECT_EQ(DYN_ERROR_STALE, dyn_cholesky_solve(m, d, x.data(), 1, x.data()));
    // and a step from there
    EXPECT_EQ(DYN_ERROR_NUMERIC, take_step(m, d, DYN_INTEGRATOR_RK4, 1e-3));
    EXPECT_TRUE(says({"singular", "joint 'shoulder'", "as before"}));
    EXPECT_EQ("", before.differs(Snapshot(m, d), true));
  }
}

}  // namespace
}  // namespace dyn_test
