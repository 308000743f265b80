// Tests data: creation and its refusals, in the caller's memory at any address, several at once, lifetimes, and that each
// keeps to its own memory.
#include "capi/calls.hpp"

#ifdef __linux__
#include <unistd.h>

#include <cstdio>
#endif

namespace dyn_test {
namespace {

TEST(DataNew, Refusals) {
  const Model m = chain(2);
  dynData* d = nullptr;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_new(m, 0, nullptr));
  EXPECT_TRUE(says({"dyn_data_new", "data is NULL", "address"}));
  for (dynParts parts : {dynParts(DYN_PART_ALL) + 1, 0x80000000u, 0xffffffffu}) {
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_new(m, parts, &d));
    EXPECT_TRUE(says({"dyn_data_new", "unknown bits", "DYN_PART_"}));
    EXPECT_EQ(0u, dyn_data_size(m, parts));
    EXPECT_TRUE(says({"dyn_data_size", "unknown bits"}));
    char memory[8];
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_init(m, parts, memory, sizeof memory, &d));
  }
  EXPECT_EQ(nullptr, d);
}

TEST(DataNew, NeutralAtRest) {
  const Model m = all_types();
  Data d(m);
  Numbers q(std::size_t(m.nq()));
  ASSERT_EQ(DYN_OK, dyn_configuration_neutral(m, q.data()));
  EXPECT_TRUE(same_bits(q, field(m, d, "q")));
  for (const char* name : {"v", "a", "tau_applied"})
    EXPECT_TRUE(same_bits(Numbers(std::size_t(m.nv()), 0.0), field(m, d, name))) << name;
  EXPECT_EQ(0.0, field(m, d, "time")[0]);
}

#ifdef __linux__
// Resident memory of this process (bytes).
double resident() {
  long pages = 0;
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  EXPECT_TRUE(file && std::fscanf(file, "%*d %ld", &pages) == 1);
  if (file) std::fclose(file);
  return double(pages) * double(sysconf(_SC_PAGESIZE));
}

// All parts of a long chain have matrices of nv x nv numbers, which take no memory before a call uses them.
TEST(DataNew, TakesTheMemoryOfWhatIsUsed) {
  if (sanitized || checked_build()) GTEST_SKIP() << "the memory is filled here";
  const Model m = chain(1000);
  const double nv = m.nv(), matrix = 8 * nv * nv, all = double(dyn_data_size(m, 0)), before = resident();
  ASSERT_GT(all, 20 * matrix);
  Data d(m);
  EXPECT_LT(resident() - before, 64e3 + 4e3 * nv);
  const Numbers v(std::size_t(m.nv()), 0.1);
  ASSERT_EQ(DYN_OK, dyn_rnea(m, d, nullptr, v.data(), v.data(), nullptr, nullptr));
  EXPECT_LT(resident() - before, 64e3 + 4e3 * nv);
  ASSERT_EQ(DYN_OK, dyn_crba(m, d, nullptr, nullptr));
  EXPECT_GT(resident() - before, 0.5 * matrix);
  EXPECT_LT(resident() - before, 64e3 + 4e3 * nv + 3 * matrix);
  ASSERT_EQ(DYN_OK, dyn_data_warm_up(m, d));
  EXPECT_GT(resident() - before, 0.9 * all);
}
#endif

TEST(DataNew, OnePartIsSmallerThanAll) {
  const Model m = robot("humanoid", DYN_BASE_FLOATING);
  const std::size_t all = dyn_data_size(m, DYN_PART_ALL);
  EXPECT_EQ(all, dyn_data_size(m, 0));
  std::size_t sum = 0;
  for (unsigned bit = 0; bit < 22; ++bit) {
    const std::size_t size = dyn_data_size(m, 1u << bit);
    EXPECT_TRUE(size > 0 && size < all) << bit;
    sum += size;
  }
  EXPECT_GT(sum, all);
  EXPECT_LE(dyn_data_size(m, DYN_PART_CHOLESKY), dyn_data_size(m, DYN_PART_MINV));
}

TEST(DataInit, Refusals) {
  const Model m = chain(2);
  std::vector<unsigned char> memory(dyn_data_size(m, 0) + 64, 0x3c);
  const std::vector<unsigned char> before = memory;
  dynData* d = nullptr;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_init(m, 0, nullptr, memory.size(), &d));
  EXPECT_TRUE(says({"dyn_data_init", "memory is NULL"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_init(m, 0, memory.data(), memory.size(), nullptr));
  EXPECT_TRUE(says({"dyn_data_init", "data is NULL"}));
  const std::size_t needed = dyn_data_size(m, 0);
  for (std::size_t size : {std::size_t(0), std::size_t(1), needed / 2, needed - 1}) {
    EXPECT_EQ(DYN_ERROR_SIZE, dyn_data_init(m, 0, memory.data(), size, &d));
    EXPECT_TRUE(says({std::to_string(size) + " bytes", "needs " + std::to_string(needed), "dyn_data_size"}));
  }
  EXPECT_EQ(nullptr, d);
  EXPECT_EQ(before, memory);
}

// The same numbers wherever the data lies, and not a byte outside of it.
TEST(DataInit, AnyAddress) {
  for (const Model& m : {all_types(), robot("panda")}) {
    const State s = random_state(m, 21);
    Data reference(m);
    compute_all(m, reference, s);
    const Snapshot expected(m, reference);
    const std::size_t size = dyn_data_size(m, 0);
    for (std::size_t offset : {0u, 1u, 3u, 7u, 8u, 31u, 33u, 63u}) {
      std::vector<unsigned char> memory(size + 256, 0x3c);
      unsigned char* at = memory.data() + 64 + offset;
      dynData* d = nullptr;
      ASSERT_EQ(DYN_OK, dyn_data_init(m, 0, at, size, &d)) << dyn_last_error();
      compute_all(m, d, s);
      EXPECT_EQ("", expected.differs(Snapshot(m, d))) << offset;
      ASSERT_EQ(DYN_OK, take_step(m, d, DYN_INTEGRATOR_RK4, 1e-3));
      for (std::size_t k = 0; k < memory.size(); ++k)
        ASSERT_TRUE((k >= 64 + offset && k < 64 + offset + size) || memory[k] == 0x3c) << offset << " " << k;
      dyn_data_free(d);
      EXPECT_EQ(DYN_ERROR_HANDLE, dyn_crba(m, d, nullptr, nullptr));
      EXPECT_TRUE(says({"data", "freed"}));
      dyn_data_free(d);
      // the memory serves again
      ASSERT_EQ(DYN_OK, dyn_data_init(m, 0, at, size, &d));
      compute_all(m, d, s);
      EXPECT_EQ("", expected.differs(Snapshot(m, d))) << offset;
      dyn_data_free(d);
    }
  }
}

// Each part alone writes within its own memory.
TEST(DataInit, EachPartKeepsToItsMemory) {
  const Model m = all_types(false);
  const State s = random_state(m, 22);
  for (unsigned bit = 0; bit < 17; ++bit) {
    const std::size_t size = dyn_data_size(m, 1u << bit);
    std::vector<unsigned char> memory(size + 128, 0x3c);
    dynData* d = nullptr;
    ASSERT_EQ(DYN_OK, dyn_data_init(m, 1u << bit, memory.data() + 64, size, &d));
    for (int round = 0; round < 2; ++round)  // what needs another's result finds it in the second round
      for (const CallRow& row : call_rows) {
        Prepared p(row, m, s);
        const dynStatus status = p(m, d);
        EXPECT_TRUE(status == DYN_OK || status == DYN_ERROR_PART || status == DYN_ERROR_STALE)
            << row.name << ": " << dyn_last_error();
      }
    for (std::size_t k = 0; k < 64; ++k) ASSERT_TRUE(memory[k] == 0x3c && memory[64 + size + k] == 0x3c) << bit;
  }
}

TEST(Several, Interleaved) {
  const Model a = all_types(), b = robot("go2", DYN_BASE_FLOATING);
  Data a1(a), a2(a), b1(b), b2(b), a_alone(a), b_alone(b);
  const State sa = random_state(a, 23), ta = random_state(a, 24), sb = random_state(b, 25), tb = random_state(b, 26);
  compute_all(a, a_alone, sa), compute_all(b, b_alone, sb);
  const Snapshot expected_a(a, a_alone), expected_b(b, b_alone);
  for (const CallRow& row : call_rows) {
    if (std::string(row.name) == "dyn_step") continue;
    Prepared pa1(row, a, sa), pa2(row, a, ta), pb1(row, b, sb), pb2(row, b, tb);
    pa1(a, a1), pb1(b, b1), pa2(a, a2), pb2(b, b2);
  }
  compute_all(a, a1, sa), compute_all(b, b1, sb);
  EXPECT_EQ("", expected_a.differs(Snapshot(a, a1)));
  EXPECT_EQ("", expected_b.differs(Snapshot(b, b1)));
}

TEST(Several, ModelFreedBeforeItsData) {
  dynModel* m = nullptr;
  {
    Builder b;
    b.joint(Spec("j", DYN_JOINT_TYPE_REVOLUTE)).body("l", "j");
    ASSERT_EQ(DYN_OK, dyn_builder_finish(b, &m));
  }
  Data d(m);
  std::vector<unsigned char> memory(dyn_data_size(m, 0));
  dynData* placed = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_init(m, 0, memory.data(), memory.size(), &placed));
  dyn_model_free(m);
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_crba(m, d, nullptr, nullptr));
  dyn_data_free(placed);  // and d at the end of the scope
}

}  // namespace
}  // namespace dyn_test
