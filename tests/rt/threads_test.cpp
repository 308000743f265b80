// Tests threads: one model shared by several, each with its own data, gives bit for bit what one thread gives; a data used by two
// at once is reported in checked builds; models, data and builders are made and freed at the same time.
#include <atomic>
#include <thread>

#include "capi/batch.hpp"

namespace dyn_test {
namespace {

constexpr int thread_count = 4;

template <class F>
void in_parallel(F f) {
  std::vector<std::thread> threads;
  for (int k = 0; k < thread_count; ++k) threads.emplace_back(f, k);
  for (std::thread& t : threads) t.join();
}

// FNV-1a over all results of all calls for one state.
std::uint64_t all_results(const dynModel* m, dynData* d, std::uint64_t seed) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  auto add = [&](const Numbers& x) {
    for (double e : x) {
      std::uint64_t bits;
      std::memcpy(&bits, &e, 8);
      hash = (hash ^ bits) * 0x100000001b3u;
    }
  };
  const State s = random_state(m, seed);
  compute_all(m, d, s);
  for (const CallRow& row : call_rows) {
    const std::string name = row.name;
    if (name == "dyn_step") continue;
    Prepared p(row, m, s);
    const dynStatus status = p(m, d);
    EXPECT_TRUE(status == DYN_OK || (name == "dyn_step_derivatives" && status == DYN_ERROR_NUMERIC))
        << name << ": " << dyn_last_error();
    for (const Numbers& x : p.results()) add(x);
  }
  for (dynIntegrator i : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_RK4}) {
    const dynStatus status = take_step(m, d, i, 1e-3);  // random states are fast, or near a singularity of angles about z, y, x
    EXPECT_TRUE(status == DYN_OK || status == DYN_ERROR_NUMERIC) << dyn_last_error();
    add(field(m, d, "q")), add(field(m, d, "v"));
  }
  Numbers out(s.q.size());
  EXPECT_EQ(DYN_OK, dyn_integrate(m, s.q.data(), s.v.data(), out.data()));
  add(out);
  EXPECT_EQ(-1, dyn_model_joint_id(m, "nobody"));  // each thread has its own errors
  EXPECT_TRUE(says({"nobody"}));
  return hash;
}

TEST(Threads, BitEqualToOne) {
  constexpr std::uint64_t states = 1000;
  for (const Model& m : {all_types(), robot("panda"), robot("go2", DYN_BASE_FLOATING)}) {
    std::vector<std::uint64_t> alone(states);
    {
      Data d(m);
      for (std::uint64_t k = 0; k < states; ++k) alone[k] = all_results(m, d, k);
    }
    std::vector<std::vector<std::uint64_t>> together(thread_count, std::vector<std::uint64_t>(states));
    in_parallel([&](int thread) {
      Data d(m);
      // each in another order
      for (std::uint64_t k = 0; k < states; ++k) {
        const std::uint64_t seed = (k * 7 + std::uint64_t(thread) * 251) % states;
        together[std::size_t(thread)][seed] = all_results(m, d, seed);
      }
    });
    for (const auto& results : together) EXPECT_EQ(alone, results) << dyn_model_name(m);
  }
}

// One thread works, another looks at the same data: DYN_ERROR_BUSY in checked builds, for one or the other.
TEST(Threads, DataOfTwo) {
  const Model m = chain(sanitized ? 150 : 400);
  Data d(m, DYN_PART_MASS);
  const State s = random_state(m, 1), t = random_state(m, 2);
  const dynField q = dyn_field_id("q");
  std::atomic<bool> done{false};
  std::atomic<int> busy{0}, other{0};
  std::string message;
  auto note = [&](dynStatus status) {
    if (status == DYN_ERROR_BUSY) ++busy;
    else if (status != DYN_OK) ++other;
  };
  std::thread worker([&] {
    for (int k = 0; k < (checked_build() ? 5000 : 100) && (!busy || k < 50); ++k)
      note(dyn_crba(m, d, (k % 2 ? s : t).q.data(), nullptr));
    done = true;
  });
  while (!done) {
    dynArray a = view();
    const dynStatus status = dyn_data_array(m, d, q, &a);  // reads nothing that the other call writes
    note(status);
    if (status == DYN_ERROR_BUSY) message = dyn_last_error();
  }
  worker.join();
  EXPECT_EQ(0, other);
  if (checked_build()) {
    EXPECT_GT(busy, 0);
    EXPECT_TRUE(message.empty() || says({"dyn_data_array", "another thread", "its own"}, message));
  } else {
    EXPECT_EQ(0, busy);
  }
  // and afterwards it is free again
  EXPECT_EQ(DYN_OK, dyn_crba(m, d, s.q.data(), nullptr));
}

TEST(Threads, CreationAndFreeing) {
  const Model shared = all_types();
  in_parallel([&](int thread) {
    for (int k = 0; k < 60; ++k) {
      const Model mine = k % 3 ? chain(3 + thread) : robot("double_pendulum");
      Data a(mine), b(shared), c(shared, DYN_PART_INVERSE);
      std::vector<unsigned char> memory(dyn_data_size(mine, 0));
      dynData* placed = nullptr;
      EXPECT_EQ(DYN_OK, dyn_data_init(mine, 0, memory.data(), memory.size(), &placed));
      EXPECT_EQ(DYN_OK, dyn_crba(mine, a, nullptr, nullptr));
      EXPECT_EQ(DYN_OK, dyn_gravity_torque(shared, c, nullptr, nullptr));
      EXPECT_EQ(DYN_ERROR_MODEL, dyn_crba(mine, b, nullptr, nullptr));
      dyn_data_free(placed);
      dynModel* none = nullptr;
      EXPECT_NE(DYN_OK, dyn_model_load_string("<robot name='r'><link/></robot>", nullptr, &none));
      EXPECT_GT(std::strlen(dyn_last_error()), 0u);
    }
  });
}

// Batches of several threads, one model: each gives what it gives alone.
TEST(Threads, Batches) {
  const Model m = all_types();
  const Batch quiet(m, 1);
  std::vector<std::unique_ptr<BatchCase>> alone;
  for (int which = 0; which < batch_algorithms; ++which) {
    alone.push_back(std::make_unique<BatchCase>(m, which, 64));
    ASSERT_EQ(DYN_OK, (*alone.back())(quiet));
  }
  in_parallel([&](int thread) {
    const Batch batch(m, 1 + thread);
    for (int round = 0; round < 3; ++round)
      for (int which = 0; which < batch_algorithms; ++which) {
        const BatchCase c(m, which, 64);
        EXPECT_EQ(DYN_OK, c(batch)) << dyn_last_error();
        for (int o = 0; o < c.info.outputs; ++o)
          EXPECT_TRUE(same_bits(alone[std::size_t(which)]->out[o], c.out[o])) << c.info.name;
      }
  });
}

// Short calls in quick succession: threads arrive while a call ends and the next begins.
TEST(Threads, BatchesInQuickSuccession) {
  const Model m = chain(3);
  const Batch batch(m, 4);
  std::vector<std::unique_ptr<BatchCase>> cases;
  for (int n = 1; n < 20; ++n) cases.push_back(std::make_unique<BatchCase>(m, DYN_ALGORITHM_RNEA, n));
  for (int round = 0; round < (sanitized ? 100 : 1000); ++round)
    for (const auto& c : cases) {
      std::fill(c->status.begin(), c->status.end(), DYN_ERROR_INTERNAL);
      ASSERT_EQ(DYN_OK, (*c)(batch));
      for (dynStatus s : c->status) ASSERT_EQ(DYN_OK, s);
    }
}

// One batch, two threads: one is refused, or both are right.
TEST(Threads, BatchOfTwo) {
  const Model m = all_types();
  const Batch batch(m, 2);
  std::atomic<int> good{0};
  in_parallel([&](int) {
    for (int k = 0; k < 20; ++k) {
      const BatchCase c(m, DYN_ALGORITHM_CRBA, 50);
      const dynStatus status = c(batch);
      if (status == DYN_OK) {
        ++good;
        for (dynStatus s : c.status) EXPECT_EQ(DYN_OK, s);
      } else {
        EXPECT_EQ(DYN_ERROR_BUSY, status);
        EXPECT_TRUE(says({"another thread is using this batch"}));
        EXPECT_TRUE(c.untouched(0, 0));
      }
    }
  });
  EXPECT_GT(good, 0);
}

}  // namespace
}  // namespace dyn_test
