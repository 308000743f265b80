// Tests random sequences of calls with valid and invalid arguments: statuses that exist, outputs whole or untouched, errors that
// say something, results that are finite, and at the end of each sequence nothing fresh that a new data would not compute.
#include "capi/calls.hpp"

namespace dyn_test {
namespace {

// A number that may be anything.
double odd_number(Random& g) {
  static constexpr double odd[] = {0, -0.0, 1, -1, 1e-310, 4.9e-324, 1e-200, 1e100, -1e160, 1e200, 1.7e308, nan, inf, -inf};
  return odd[g.below(int(std::size(odd)))];
}

// Some entries of some arrays become odd, some pointers NULL.
void disturb(Prepared& p, Random& g, const dynModel* m) {
  Numbers* arrays[] = {&p.s.q, &p.s.v, &p.s.a, &p.s.tau, &p.s.fext, &p.b};
  const double** pointers[] = {&p.x.q, &p.x.v, &p.x.a, &p.x.tau, &p.x.fext, &p.x.b};
  for (int k = 0; k < 6; ++k) {
    if (g.below(4) == 0) *pointers[k] = nullptr;
    else if (g.below(12) == 0 && !arrays[k]->empty()) (*arrays[k])[std::size_t(g.below(int(arrays[k]->size())))] = odd_number(g);
    else if (g.below(24) == 0)
      for (double& e : *arrays[k]) e = odd_number(g);
  }
  p.x.frame = g.below(dyn_model_nframes(m) + 2) - 1, p.x.joint = g.below(dyn_model_njoints(m) + 2) - 1;
  const int reference = sanitized ? g.below(4) : g.below(5) - 1, integrator = sanitized ? g.below(2) : g.below(4) - 1;
  std::memcpy(&p.x.reference, &reference, sizeof reference), std::memcpy(&p.x.integrator, &integrator, sizeof integrator);
  p.x.dt = g.below(8) ? g.uniform(-1e-3, 1e-2) : odd_number(g);
  p.x.mask = std::uint32_t(g.next()) & (g.below(6) ? std::uint32_t(DYN_TERM_ALL) : 0xffffu);
  p.x.nrhs = g.below(3) - 1;
  p.x.field = g.below(dyn_field_count() + 2) - 1;
  for (double*& out : p.x.out)
    if (g.below(6) == 0) out = nullptr;
  if (g.below(6) == 0) p.x.filled = nullptr;
  if (g.below(8) == 0) p.array.struct_size = std::uint32_t(g.below(64));
}

bool reads_forces(const std::string& field) {
  dynFieldInfo info{};
  info.struct_size = sizeof info;
  return dyn_field_info(dyn_field_id(field.c_str()), &info) == DYN_OK && *info.producer &&
         call_row(info.producer).uses & uses_fext;
}

// What is fresh in d is what a new data computes from the state of d. Forces from outside are not part of the state: those rows
// are compared when the caller says none was given.
void expect_nothing_stale(const Model& m, dynData* d, bool forces, std::uint64_t sequence) {
  State s;
  s.q = field(m, d, "q"), s.v = field(m, d, "v"), s.a = field(m, d, "a"), s.tau = field(m, d, "tau_applied");
  double size = 0;
  for (const Numbers* x : {&s.q, &s.v, &s.a, &s.tau})
    for (double e : *x) size = std::max(size, std::abs(e));
  if (size > 1e3) return;
  Data fresh(m);
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, fresh, s.q.data(), s.v.data(), s.a.data())) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, fresh, nullptr, nullptr, nullptr, s.tau.data()));
  if (dyn_constrained_dynamics(m, fresh, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr) != DYN_OK) return;
  if (compute_derivatives(m, fresh, nullptr) != DYN_OK) return;  // near a singular configuration
  if (dyn_all_terms(m, fresh, DYN_TERM_ALL, nullptr, nullptr, nullptr) != DYN_OK) return;
  ASSERT_EQ(DYN_OK, dyn_com(m, fresh, nullptr, s.v.data(), s.a.data(), nullptr, nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_rnea(m, fresh, nullptr, nullptr, nullptr, nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_static_torque(m, fresh, nullptr, nullptr, nullptr));
  if (dyn_aba(m, fresh, nullptr, nullptr, nullptr, nullptr, nullptr) != DYN_OK) return;
  compute_centroidal_and_regressors(m, fresh);
  compute_other_derivatives(m, fresh, nullptr, s.tau.data());
  ASSERT_EQ(DYN_OK, dyn_distances(m, fresh, nullptr, nullptr));
  compute_stale(m, fresh);
  double worst_M = 1;
  for (double e : field(m, fresh, "Minv")) worst_M = std::max(worst_M, std::abs(e));
  const Snapshot expected(m, fresh), got(m, d);
  for (std::size_t k = 0; k < got.rows.size(); ++k) {
    const auto &x = got.rows[k], &y = expected.rows[k];
    if (x.status != DYN_OK || x.name == "time") continue;
    if (forces && reads_forces(x.name)) continue;
    if (x.name.starts_with("lambda_")) continue;  // of another lambda
    ASSERT_EQ(x.bits.size(), y.bits.size());
    double scale = 1, off = 0;
    for (std::size_t i = 0; i < x.bits.size(); ++i)
      if (x.bits[i] != y.bits[i])
        scale = std::max(scale, std::abs(y.bits[i])), off = std::max(off, std::abs(x.bits[i] - y.bits[i]));
    ASSERT_LE(off, 1e-12 * scale * (1 + size) * (1 + size) * worst_M)
        << x.name << " is not that of the state, sequence " << sequence;
  }
}

void run(std::uint64_t first, std::uint64_t last) {
  const Model models[] = {all_types(), all_types(false), chain(3), robot("gripper"), singular_at_zero(true)};
  constexpr int count = int(std::size(models));
  std::vector<Data> data;
  for (const Model& m : models) data.emplace_back(m);
  std::uint64_t calls = 0, statuses[32] = {};
  for (std::uint64_t sequence = first; sequence < last; ++sequence) {
    Random g{sequence};
    const int own = g.below(count);
    const Model& m = models[own];
    bool forces = false;
    if (g.below(50) == 0) {  // another data, with some parts only
      dyn_data_free(data[std::size_t(own)].d);
      data[std::size_t(own)].d = nullptr;
      ASSERT_EQ(DYN_OK, dyn_data_new(m, g.below(4) ? dynParts(DYN_PART_ALL) : dynParts(g.next() & DYN_PART_ALL),
                                     &data[std::size_t(own)].d));
    }
    {  // forget the forces of the sequence before
      const State s = random_state(m, g.next());
      ASSERT_EQ(DYN_OK, dyn_data_set_state(m, data[std::size_t(own)], s.q.data(), s.v.data(), s.a.data(), s.tau.data()));
    }
    for (int k = g.below(10) + 2; k-- > 0; ++calls) {
      const CallRow& row = call_rows[g.below(int(std::size(call_rows)))];
      Prepared p(row, m, random_state(m, g.next()));
      if (g.below(2)) disturb(p, g, m);
      if (p.x.nrhs > 1 || (p.x.nrhs < 1 && g.below(2))) p.x.nrhs = 1;
      dynData* d = g.below(40) ? data[std::size_t(own)].d : g.below(2) ? nullptr : data[std::size_t(g.below(count))].d;
      const dynStatus s = p(g.below(60) ? m.m : nullptr, d);
      ASSERT_TRUE(s >= DYN_OK && s <= DYN_ERROR_INTERNAL && s != DYN_ERROR_INTERNAL) << row.name;
      ++statuses[s];
      if (s == DYN_OK) {
        for (const Numbers& out : p.results())
          ASSERT_TRUE(may_be_infinite(row) || finite(out)) << row.name << " sequence " << sequence;
        if (row.uses & uses_fext && p.x.fext) forces = true;
      } else {
        const std::uint32_t size = p.array.struct_size;
        p.array.struct_size = sizeof p.array;
        ASSERT_TRUE(p.untouched()) << row.name << " " << dyn_last_error() << " sequence " << sequence;
        p.array.struct_size = size;
        ASSERT_GT(std::strlen(dyn_last_error()), 10u) << row.name;
      }
    }
    dynArray q = view();
    ASSERT_EQ(DYN_OK, dyn_data_array(m, data[std::size_t(own)], dyn_field_id("q"), &q));
    for (int k = 0; k < q.rows; ++k) ASSERT_TRUE(std::isfinite(q.data[k])) << "sequence " << sequence;
    if (sequence % 4 == 0) expect_nothing_stale(m, data[std::size_t(own)], forces, sequence);
    if (::testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(calls, 5 * (last - first));
  for (dynStatus s : {DYN_OK, DYN_ERROR_ARGUMENT, DYN_ERROR_HANDLE, DYN_ERROR_MODEL, DYN_ERROR_NONFINITE, DYN_ERROR_STALE,
                      DYN_ERROR_PART, DYN_ERROR_NUMERIC})
    EXPECT_GT(statuses[s], 0u) << dyn_status_name(s);
}

TEST(Fuzz, Sequences20000) { run(0, 20000); }
TEST(Fuzz, Sequences500000Slow) { run(20000, 520000); }

// The builder with random specifications: models or refusals, and what is made works.
TEST(Fuzz, Builders) {
  const int joint_types = int(every<dynJointType>("dynJointType").size());
  int made = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    Random g{seed};
    Builder b;
    std::vector<std::string> names = {"universe", "nobody", ""};
    Spec parts[3] = {Spec(nullptr, DYN_JOINT_TYPE_REVOLUTE), Spec(nullptr, DYN_JOINT_TYPE_PRISMATIC),
                     Spec(nullptr, DYN_JOINT_TYPE_SPHERICAL)};
    for (int k = g.below(6) + 1; k-- > 0;) {
      const std::string name = g.below(12) ? "j" + std::to_string(names.size()) : names[std::size_t(g.below(int(names.size())))];
      const std::string parent = g.below(6) ? names.back() : names[std::size_t(g.below(int(names.size())))];
      const std::string leader = names[std::size_t(g.below(int(names.size())))];
      Spec s(name.c_str(), DYN_JOINT_TYPE_REVOLUTE, parent.c_str(), {g.uniform(-1, 1), g.uniform(-1, 1), 0});
      const int type = g.below(40) ? g.below(joint_types) : g.below(100) - 50;
      std::memcpy(&s.type, &type, sizeof type);
      s.about(g.uniform(-1, 1), g.uniform(-1, 1), g.below(8) ? 1 : odd_number(g));
      if (g.below(8) == 0) s.placement[g.below(12)] = odd_number(g);
      if (g.below(10) == 0) s.pitch = odd_number(g);
      if (g.below(6) == 0) s.mimic = leader.c_str(), s.mimic_ratio = g.below(4) ? g.uniform(-2, 2) : odd_number(g);
      if (type == DYN_JOINT_TYPE_COMPOSITE) s.parts = parts, s.parts_count = std::size_t(g.below(4));
      Numbers limits = g.numbers(7);
      if (g.below(6) == 0) s.armature = s.damping = limits.data();
      if (g.below(6) == 0) s.lower = limits.data();
      if (dyn_builder_add_joint(b, &s) == DYN_OK) names.push_back(name);
      Numbers I(9, 0.0);
      I[0] = I[4] = I[8] = g.below(12) ? 0.1 : odd_number(g);
      const double com[3] = {g.uniform(-1, 1), 0, g.below(12) ? 0.1 : odd_number(g)};
      const std::string body = "b" + std::to_string(g.below(1000));
      dyn_builder_add_body(b, body.c_str(), names.back().c_str(), nullptr, g.below(12) ? 1 : odd_number(g), com, I.data());
    }
    dynModel* raw = nullptr;
    if (dyn_builder_finish(b, &raw) != DYN_OK) {
      ASSERT_EQ(nullptr, raw);
      ASSERT_GT(std::strlen(dyn_last_error()), 10u);
      continue;
    }
    const Model m(raw);
    ++made;
    Data d(m);
    Numbers q(std::size_t(m.nq()));
    if (dyn_configuration_random(m, seed, nullptr, nullptr, q.data()) != DYN_OK) continue;
    ASSERT_TRUE(finite(q));
    const State s = random_state(m, seed);
    for (const CallRow& row : call_rows) {
      Prepared p(row, m, s);
      const dynStatus status = p(m, d);
      ASSERT_TRUE(status == DYN_OK || status == DYN_ERROR_STALE || status == DYN_ERROR_NUMERIC)
          << row.name << dyn_last_error() << seed;
      if (status != DYN_OK) continue;
      for (const Numbers& out : p.results()) ASSERT_TRUE(may_be_infinite(row) || finite(out)) << row.name << " seed " << seed;
    }
  }
  EXPECT_GT(made, 300);
}

}  // namespace
}  // namespace dyn_test
