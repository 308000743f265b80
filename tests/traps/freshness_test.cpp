// Common mistakes with stale results: what is read is complete and of the current state.
#include <set>

#include "traps/traps.hpp"

namespace dyn_test {
namespace {

// M is symmetric and full: no triangle is left for the caller to fill.
TEST(Traps, MassMatrixIsFull) {
  for (const Model& m : models()) {
    const State s = random_state(m, 1);
    Data d(m);
    const std::size_t n = std::size_t(m.nv());
    for (const char* name : {"dyn_crba", "dyn_minv"}) {
      Prepared p(call_row(name), m, s);
      ASSERT_EQ(DYN_OK, p(m, d));
      EXPECT_TRUE(p.written()) << name;  // every element, zeros included
      const Numbers M = p.results()[0];
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < i; ++j) ASSERT_EQ(M[i + n * j], M[j + n * i]) << name;
    }
    // each column agrees with inverse dynamics: M e = rnea(q, 0, e) - g
    Numbers g(n), tau(n), M = field(m, d, "M"), zero(n, 0.0);
    ASSERT_EQ(DYN_OK, dyn_gravity_torque(m, d, s.q.data(), g.data()));
    for (std::size_t j = 0; j < n; ++j) {
      Numbers e(n, 0.0);
      e[j] = 1;
      ASSERT_EQ(DYN_OK, dyn_rnea(m, d, s.q.data(), zero.data(), e.data(), nullptr, tau.data()));
      for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(tau[i] - g[i], M[i + n * j], 1e-10 * (1 + largest(M))) << i << " " << j;
    }
  }
}

// After dyn_all_terms, frames are of the current state or are reported as stale.
TEST(Traps, FramesAreCurrentAfterAllTerms) {
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

// Inputs, which are set and not computed.
bool of_the_state(const std::string& field) {
  static const std::set<std::string> names = {"q", "v", "a", "tau_applied", "time", "world_gravity", "ctrl", "act", "actuator_force",
                                              "mocap"};
  return names.count(field) > 0;
}

// Fields whose call reads no q, as the power of given forces.
bool is_without_q(const std::string& field) {
  return std::any_of(std::begin(call_rows), std::end(call_rows),
                     [&](const CallRow& row) { return row.name == "dyn_" + field && !(row.uses & uses_q); });
}

// Changing q makes every pose stale until it is computed again.
TEST(Traps, ChangingQInvalidatesPlacements) {
  for (const Model& m : models()) {
    const State s = random_state(m, 4), t = random_state(m, 5);
    Data d(m);
    compute_all(m, d, s);
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, t.q.data(), nullptr, nullptr, nullptr));
    for (const auto& row : Snapshot(m, d).rows) {
      if (of_the_state(row.name) || is_without_q(row.name)) continue;
      EXPECT_EQ(DYN_ERROR_STALE, row.status) << row.name;
    }
    double X[12];
    EXPECT_EQ(DYN_ERROR_STALE, dyn_frame_placement(m, d, 1, X));
    EXPECT_TRUE(says({"dyn_frame_placement", "not computed for the current state", "call dyn_forward_kinematics first"}));
  }
}

// After any algorithm with a new q, all that can be read belongs to that q.
TEST(Traps, PlacementsAreOfTheLastQAfterEveryAlgorithm) {
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
      // likewise the rest of the state
      ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, t.q.data(), t.v.data(), t.a.data(), t.tau.data()));
      const Snapshot got(m, d);
      for (std::size_t k = 0; k < got.rows.size(); ++k)
        if (got.rows[k].status == DYN_OK && got.rows[k].name != "time")
          expect_near(expected.rows[k].bits, got.rows[k].bits, 1e-9, got.rows[k].name + " after " + row.name);
    }
  }
}

// The mask that dyn_all_terms returns agrees with the fields that are fresh.
TEST(Traps, AllTermsTellsWhichFieldsAreFresh) {
  static const struct {
    std::uint32_t term;
    std::vector<const char*> fields;
  } rows[] = {{DYN_TERM_FRAMES, {"placements"}},
              {DYN_TERM_JACOBIANS, {"J"}},
              {DYN_TERM_JACOBIANS_TIME_VARIATION, {"dJ"}},
              {DYN_TERM_COM, {"com", "vcom"}},
              {DYN_TERM_JCOM, {"Jcom"}},
              {DYN_TERM_NLE, {"nle"}},
              {DYN_TERM_GRAVITY_TORQUE, {"g"}},
              {DYN_TERM_MASS, {"M"}},
              {DYN_TERM_MINV, {"Minv"}},
              {DYN_TERM_CORIOLIS, {"coriolis"}},
              {DYN_TERM_ENERGY, {"kinetic", "potential", "mechanical"}}};
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
    EXPECT_EQ(filled & DYN_TERM_KINEMATICS ? DYN_OK : DYN_ERROR_STALE,
              dyn_frame_velocity(m, d, 1, DYN_REFERENCE_LOCAL, V.data()));
    EXPECT_EQ(filled & DYN_TERM_CHOLESKY ? DYN_OK : DYN_ERROR_STALE, dyn_cholesky_solve(m, d, ones.data(), 1, ones.data()));
    EXPECT_EQ(DYN_OK, dyn_frame_placement(m, d, 1, X.data()));  // always included
  }
  // one pass and separate passes give the same numbers
  const State s = random_state(m, 15);
  Data all(m), one(m);
  ASSERT_EQ(DYN_OK, dyn_all_terms(m, all, DYN_TERM_ALL, s.q.data(), s.v.data(), nullptr));
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, one, s.q.data(), s.v.data(), nullptr, nullptr));
  for (const char* name : {"dyn_frame_placements", "dyn_joint_jacobians_time_variation", "dyn_com", "dyn_jcom",
                           "dyn_nle", "dyn_gravity_torque", "dyn_minv", "dyn_coriolis_matrix", "dyn_energy"}) {
    State rest = s;
    std::fill(rest.a.begin(), rest.a.end(), 0.0);
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, one, s.q.data(), s.v.data(), nullptr));
    Prepared p(call_row(name), m, rest);
    ASSERT_EQ(DYN_OK, p(m, one)) << name << dyn_last_error();
  }
  for (const auto& row : rows)
    for (const char* name : row.fields) expect_near(field(m, one, name), field(m, all, name), 1e-12, name);
}

// A new data holds no results: reading one is an error, not the identity.
TEST(Traps, NewDataRefusesToBeRead) {
  for (const Model& m : models()) {
    Data d(m);
    double X[12] = {9};
    EXPECT_EQ(DYN_ERROR_STALE, dyn_frame_placement(m, d, 1, X));
    EXPECT_TRUE(says({"call dyn_forward_kinematics first"}));
    EXPECT_EQ(9, X[0]);
    for (const auto& row : Snapshot(m, d).rows)
      EXPECT_TRUE(row.status == DYN_ERROR_STALE || of_the_state(row.name)) << row.name;
  }
}


}  // namespace
}  // namespace dyn_test
