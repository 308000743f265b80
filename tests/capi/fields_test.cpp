// Tests the table of fields: ids and names, shapes, producers; and freshness: stale before the producer, fresh after, stale
// again when an input changes, fresh still when it is set to the same bits.
#include <map>
#include <set>

#include "capi/calls.hpp"

namespace dyn_test {
namespace {

std::vector<dynFieldInfo> fields() {
  std::vector<dynFieldInfo> all;
  for (dynField f = 0; f < dyn_field_count(); ++f) {
    dynFieldInfo info{};
    info.struct_size = sizeof info;
    EXPECT_EQ(DYN_OK, dyn_field_info(f, &info));
    all.push_back(info);
  }
  return all;
}

TEST(Fields, TableIsSound) {
  std::set<std::string> names;
  for (dynField f = 0; f < dyn_field_count(); ++f) {
    const dynFieldInfo info = fields()[std::size_t(f)];
    EXPECT_EQ(f, dyn_field_id(info.name));
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_GT(std::strlen(info.sentence), 0u) << info.name;
    EXPECT_GT(std::strlen(info.unit), 0u) << info.name;
    EXPECT_EQ(0u, info.part & ~dynParts(DYN_PART_ALL)) << info.name;
    if (std::strlen(info.producer)) call_row(info.producer);  // is a call
  }
  for (const char* name : {"q",
                           "v",
                           "a",
                           "tau_applied",
                           "time",
                           "placements",
                           "J",
                           "dJ",
                           "com",
                           "vcom",
                           "acom",
                           "Jcom",
                           "tau",
                           "nle",
                           "g",
                           "static_torque",
                           "ddq",
                           "M",
                           "Minv",
                           "coriolis",
                           "kinetic",
                           "potential",
                           "mechanical",
                           "Ag",
                           "dAg",
                           "Ig",
                           "hg",
                           "dhg",
                           "dh_dq",
                           "dhdot_dq",
                           "dhdot_dv",
                           "regressor",
                           "static_regressor",
                           "kinetic_energy_regressor",
                           "potential_energy_regressor",
                           "dvcom_dq",
                           "dg_dq",
                           "dstatic_torque_dq",
                           "dtau_dq",
                           "dtau_dv",
                           "ddq_dq",
                           "ddq_dv",
                           "lambda_d2tau_dqdq",
                           "lambda_d2tau_dvdv",
                           "lambda_d2tau_dqdv",
                           "lambda_d2tau_dadq"})
    EXPECT_TRUE(names.count(name)) << name;
}

// "nv x nv" and the like.
int dimension(const dynModel* m, const std::string& text) {
  if (text == "nq") return dyn_model_nq(m);
  if (text == "nv") return dyn_model_nv(m);
  if (text == "nframes") return dyn_model_nframes(m);
  if (text == "nrows") return 6 * dyn_model_nconstraint_slots(m);  // of models without constraints of their own
  if (text == "npairs") return dyn_model_npairs(m);
  if (text == "nu") return dyn_model_nu(m);
  if (text == "nactuators") return dyn_model_nactuators(m);
  if (text == "nmocaps") return dyn_model_nmocaps(m);
  if (text == "nsensordata") return dyn_model_nsensordata(m);
  if (text == "ntendons") return dyn_model_ntendons(m);
  if (text == "na") return 0;  // of models without filters
  if (text == "nparameters") return 10 * (dyn_model_njoints(m) - 1);
  return std::stoi(text);
}

TEST(Fields, ViewsHaveTheShapeOfTheText) {
  for (const Model& m : {all_types(), robot("panda"), robot("go2", DYN_BASE_FLOATING)}) {
    Data d(m);
    compute_all(m, d, random_state(m, 31));
    for (dynField f = 0; f < dyn_field_count(); ++f) {
      const std::string shape = fields()[std::size_t(f)].shape;
      const std::size_t cross = shape.find(" x ");
      ASSERT_NE(std::string::npos, cross) << shape;
      dynArray a = view();
      ASSERT_EQ(DYN_OK, dyn_data_array(m, d, f, &a)) << dyn_last_error();
      EXPECT_EQ(dimension(m, shape.substr(0, cross)), a.rows) << shape;
      EXPECT_EQ(dimension(m, shape.substr(cross + 3)), a.cols) << shape;
      EXPECT_TRUE(a.stride[0] == 1 && a.stride[1] == a.rows && a.data && a.struct_size == sizeof a) << shape;
    }
  }
}

// The view follows the data, and its address never changes.
TEST(Fields, ViewsStay) {
  const Model m = all_types();
  Data d(m);
  compute_all(m, d, random_state(m, 32));
  std::vector<const double*> at;
  for (dynField f = 0; f < dyn_field_count(); ++f) {
    dynArray a = view();
    ASSERT_EQ(DYN_OK, dyn_data_array(m, d, f, &a));
    at.push_back(a.data);
  }
  compute_all(m, d, random_state(m, 33));
  for (dynField f = 0; f < dyn_field_count(); ++f) {
    dynArray a = view();
    ASSERT_EQ(DYN_OK, dyn_data_array(m, d, f, &a));
    EXPECT_EQ(at[std::size_t(f)], a.data);
  }
}

// Whether another value of an input makes a field stale: where its call reads that input, but for what calls with several
// results compute without it.
bool field_depends_on(const dynFieldInfo& field, const CallRow& row, const std::string& input) {
  const std::map<std::string, std::set<std::string>> without = {{"v", {"com", "potential", "Ag", "Ig"}},
                                                                {"a", {"com", "vcom", "dh_dq", "dhdot_dv"}}};
  const std::map<std::string, unsigned> uses = {{"q", uses_q}, {"v", uses_v}, {"a", uses_a}, {"tau", uses_tau}};
  if (input == "q" && !(row.uses & (uses_q | uses_v | uses_a | uses_tau))) return true;  // of what an earlier call was given
  const auto independent = without.find(input);
  return (row.uses & uses.at(input)) && !(independent != without.end() && independent->second.count(field.name));
}

TEST(Freshness, StaleFreshStale) {
  const Model m = all_types();
  for (const dynFieldInfo& info : fields()) {
    if (!std::strlen(info.producer)) continue;
    const std::string who = std::string(info.name) + " of " + info.producer;
    const CallRow& row = call_row(info.producer);
    const auto depends = [&](const std::string& input) { return field_depends_on(info, row, input); };
    Data d(m);
    const State s = random_state(m, 34), t = random_state(m, 35);
    EXPECT_EQ(DYN_ERROR_STALE, field_status(m, d, info.name)) << who;
    EXPECT_TRUE(says({"dyn_data_array", info.name, "not computed for the current state", std::string("call ") + info.producer}))
        << who;
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, s.q.data(), s.v.data(), s.a.data()));
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, nullptr, nullptr, nullptr, s.tau.data()));
    EXPECT_EQ(DYN_ERROR_STALE, field_status(m, d, info.name)) << who;
    Prepared p(row, m, s);
    ASSERT_EQ(DYN_OK, p(m, d)) << dyn_last_error();
    ASSERT_EQ(DYN_OK, field_status(m, d, info.name)) << who;
    const Numbers first = field(m, d, info.name);

    // the same bits again: still fresh, and the same
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, s.q.data(), s.v.data(), s.a.data(), s.tau.data()));
    EXPECT_EQ(DYN_OK, field_status(m, d, info.name)) << who;
    EXPECT_TRUE(same_bits(first, field(m, d, info.name))) << who;

    // another q: stale; the first q again: stale until it is computed, and then the same
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, t.q.data(), nullptr, nullptr, nullptr));
    EXPECT_EQ(depends("q") ? DYN_ERROR_STALE : DYN_OK, field_status(m, d, info.name)) << who;
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, nullptr, s.v.data(), s.a.data()));
    Prepared other(row, m, s);
    other.x.q = nullptr;
    ASSERT_EQ(DYN_OK, other(m, d)) << dyn_last_error();
    EXPECT_FALSE(!first.empty() && depends("q") && same_bits(first, field(m, d, info.name)) && std::string(info.name) !=
        "kinetic" &&
                 std::string(info.name) != "lambda")
        << who;  // no constraint, no force
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, s.q.data(), s.v.data(), s.a.data()));
    EXPECT_EQ(depends("q") ? DYN_ERROR_STALE : DYN_OK, field_status(m, d, info.name)) << who;
    ASSERT_EQ(DYN_OK, p(m, d));
    EXPECT_TRUE(same_bits(first, field(m, d, info.name))) << who;

    // v, a and tau matter to what depends on them, and to nothing else
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, nullptr, nullptr, nullptr, t.tau.data()));
    EXPECT_EQ(depends("tau") ? DYN_ERROR_STALE : DYN_OK, field_status(m, d, info.name)) << who;
    ASSERT_EQ(DYN_OK, p(m, d));
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, nullptr, nullptr, t.a.data(), nullptr));
    EXPECT_EQ(depends("a") ? DYN_ERROR_STALE : DYN_OK, field_status(m, d, info.name)) << who;
    ASSERT_EQ(DYN_OK, p(m, d)) << dyn_last_error();
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, nullptr, t.v.data(), nullptr, nullptr));
    EXPECT_EQ(depends("v") ? DYN_ERROR_STALE : DYN_OK, field_status(m, d, info.name)) << who;
  }
}

// One bit of one input is a change.
TEST(Freshness, OneBit) {
  const Model m = all_types();
  const State s = random_state(m, 36);
  Data d(m);
  for (int k = 0; k < m.nq(); ++k) {
    compute_all(m, d, s);
    Numbers q = s.q;
    q[std::size_t(k)] = std::nextafter(q[std::size_t(k)], 10);
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, q.data(), nullptr, nullptr, nullptr));
    for (const char* name : {"M", "tau", "ddq", "J", "com"}) EXPECT_EQ(DYN_ERROR_STALE, field_status(m, d, name)) << k << name;
  }
  // the signs of zeros count, too
  Numbers zero(std::size_t(m.nv()), 0.0), minus(std::size_t(m.nv()), -0.0);
  ASSERT_EQ(DYN_OK, dyn_nle(m, d, nullptr, zero.data(), nullptr));
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, nullptr, minus.data(), nullptr, nullptr));
  EXPECT_EQ(DYN_ERROR_STALE, field_status(m, d, "nle"));
}

// The data's own arrays as inputs.
TEST(Freshness, OwnArraysAsInputs) {
  const Model m = all_types();
  const State s = random_state(m, 37);
  Data d(m), e(m);
  compute_all(m, d, s), compute_all(m, e, s);
  dynArray q = view(), v = view(), a = view(), tau = view();
  ASSERT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id("q"), &q));
  ASSERT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id("v"), &v));
  ASSERT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id("a"), &a));
  ASSERT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id("tau_applied"), &tau));
  EXPECT_EQ(DYN_OK, dyn_forward_kinematics(m, d, q.data, v.data, a.data));
  EXPECT_EQ("", Snapshot(m, e).differs(Snapshot(m, d)));
  // one held value as another input: forward dynamics' result as the acceleration of inverse dynamics
  dynArray ddq = view();
  ASSERT_EQ(DYN_OK, dyn_aba(m, d, nullptr, nullptr, nullptr, nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id("ddq"), &ddq));
  ASSERT_EQ(DYN_OK, dyn_rnea(m, d, nullptr, nullptr, ddq.data, nullptr, nullptr));
  const Numbers back = field(m, d, "tau");
  for (std::size_t k = 0; k < back.size(); ++k) EXPECT_NEAR(s.tau[k], back[k], 1e-8);
}

// Exchanged: v takes what a held, and a what v held.
TEST(Freshness, OwnArraysExchanged) {
  const Model m = chain(3);
  const State s = random_state(m, 38);
  Data d(m), e(m);
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, s.q.data(), s.v.data(), s.a.data(), nullptr));
  dynArray v = view(), a = view();
  ASSERT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id("v"), &v));
  ASSERT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id("a"), &a));
  Numbers one(3), two(3);
  ASSERT_EQ(DYN_OK, dyn_rnea(m, d, nullptr, a.data, v.data, nullptr, one.data()));
  ASSERT_EQ(DYN_OK, dyn_rnea(m, e, s.q.data(), s.a.data(), s.v.data(), nullptr, two.data()));
  EXPECT_TRUE(same_bits(one, two));
}

// Algorithms in any order give what a new data gives.
TEST(Freshness, OrderDoesNotMatter) {
  for (const Model& m : {all_types(), all_types(false)}) {
    Random g{39};
    Data used(m);
    for (int round = 0; round < 300; ++round) {
      const State s = random_state(m, 100 + std::uint64_t(g.below(3)));
      const CallRow& row = call_rows[g.below(int(std::size(call_rows)))];
      if (std::string(row.name) == "dyn_step" || std::string(row.name) == "dyn_data_array") continue;
      ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, used, s.q.data(), s.v.data(), g.below(2) ? s.a.data() : nullptr));
      Prepared p(row, m, s);
      const dynStatus status = p(m, used);
      if (status == DYN_ERROR_STALE) continue;
      ASSERT_EQ(DYN_OK, status) << row.name << dyn_last_error();
      Data fresh(m);
      compute_all(m, fresh, s);
      Prepared q(row, m, s);
      ASSERT_EQ(DYN_OK, q(m, fresh)) << row.name;
      for (int k = 0; k < row.outputs; ++k)
        for (std::size_t i = 0; i < p.out[k].size(); ++i) {
          if (q.out[k][i] == p.out[k][i]) continue;  // also both infinite: a pair that is not tested
          ASSERT_NEAR(q.out[k][i], p.out[k][i], 1e-11 * (1 + std::abs(q.out[k][i]))) << row.name << " after other calls";
        }
    }
  }
}

}  // namespace
}  // namespace dyn_test
