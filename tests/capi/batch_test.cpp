// Tests batches: every algorithm gives what single calls give, with `exact` bit for bit; a state's bits depend on nothing but the
// state; a state that fails is named and the others are computed; bad arguments are refused.
#include "capi/batch.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <climits>
#include <thread>

namespace dyn_test {
namespace {

std::vector<Model> models() {
  std::vector<Model> all;
  all.push_back(all_types());
  all.push_back(robot("panda"));
  all.push_back(robot("go2", DYN_BASE_FLOATING));
  all.push_back(chain(30));
  for (std::uint64_t seed = 1; seed <= (sanitized ? 3 : 10); ++seed) all.push_back(random_robot(seed, 4 + 2 * int(seed)));
  return all;
}

TEST(Batch, EqualsSingleCalls) {
  constexpr int n = 70;
  int compared = 0;
  for (const Model& m : models()) {
    const Batch one(m, 1), two(m, 2), four(m, 4);
    for (int which = 0; which < batch_algorithms; ++which) {
      BatchCase alone(m, which, n), together(m, which, n), many(m, which, n);
      for (BatchCase* c : {&alone, &together, &many}) c->x.exact = 1;
      ASSERT_EQ(DYN_OK, alone(one)) << dyn_last_error();
      ASSERT_EQ(DYN_OK, together(two)) << dyn_last_error();
      ASSERT_EQ(DYN_OK, many(four)) << dyn_last_error();
      EXPECT_TRUE(alone.guarded() && together.guarded() && many.guarded()) << alone.info.name;
      for (int o = 0; o < alone.info.outputs; ++o) {
        EXPECT_TRUE(same_bits(alone.out[o], together.out[o])) << alone.info.name;
        EXPECT_TRUE(same_bits(alone.out[o], many.out[o])) << alone.info.name;
      }
      for (int k = 0; k < n; ++k) {
        EXPECT_EQ(DYN_OK, together.status[std::size_t(k)]);
        const auto expected = alone.single(k);
        for (int o = 0; o < alone.info.outputs; ++o)
          ASSERT_TRUE(same_bits(expected[std::size_t(o)], alone.row(o, k)))
              << dyn_model_name(m) << ": " << alone.info.name << "[" << k << "]";
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 7 * n * batch_algorithms - 1);
}

// In lanes: each number within rounding of the largest of its state's results, where M is divided by times its condition.
TEST(Batch, LanesAreNearSingleCalls) {
  constexpr int n = 70;
  int differ = 0;
  for (const Model& m : models()) {
    const Batch batch(m, 1);
    for (int which = 0; which < batch_algorithms; ++which) {
      const BatchCase lanes(m, which, n);
      BatchCase exact(m, which, n);
      exact.x.exact = 1;
      const bool divides = which == DYN_ALGORITHM_ABA || which == DYN_ALGORITHM_MINV || which == DYN_ALGORITHM_ABA_DERIVATIVES;
      ASSERT_EQ(DYN_OK, lanes(batch)) << dyn_last_error();
      ASSERT_EQ(DYN_OK, exact(batch)) << dyn_last_error();
      for (int k = 0; k < n; ++k)
        for (int o = 0; o < lanes.info.outputs; ++o) {
          const Numbers x = lanes.row(o, k), y = exact.row(o, k);
          double size = 0, gap = 0;
          for (std::size_t i = 0; i < x.size(); ++i)
            size = std::max(size, std::abs(y[i])), gap = std::max(gap, std::abs(x[i] - y[i]));
          ASSERT_LE(gap, (divides ? 1e-6 : 1e-12) * size) << dyn_model_name(m) << ": " << lanes.info.name << "[" << k << "]";
          differ += gap > 0;
        }
    }
  }
  EXPECT_GT(differ, 0);
}

// Lanes serve models up to a size, beyond which their data leave the cache; that size depends on how much an algorithm writes.
// Larger models have the bits of single calls.
TEST(Batch, LanesServeModelsUpToAStatedSize) {
  const std::vector<dynAlgorithm> few = {DYN_ALGORITHM_FRAME_PLACEMENT, DYN_ALGORITHM_JOINT_JACOBIANS, DYN_ALGORITHM_CRBA},
                                  matrices = {DYN_ALGORITHM_MINV, DYN_ALGORITHM_RNEA_DERIVATIVES, DYN_ALGORITHM_ABA_DERIVATIVES},
                                  vectors = {DYN_ALGORITHM_RNEA, DYN_ALGORITHM_NLE, DYN_ALGORITHM_GRAVITY_TORQUE,
                                             DYN_ALGORITHM_ABA};
  const auto differ = [](const std::vector<dynAlgorithm>& algorithms, int dofs) {
    const Model m = chain(dofs);
    EXPECT_EQ(dofs, dyn_model_nv(m));
    const Batch batch(m, 1);
    bool any = false;
    for (const dynAlgorithm which : algorithms) {
      const BatchCase lanes(m, which, 16);
      BatchCase exact(m, which, 16);
      exact.x.exact = 1;
      EXPECT_EQ(DYN_OK, lanes(batch)) << dyn_last_error();
      EXPECT_EQ(DYN_OK, exact(batch)) << dyn_last_error();
      for (int o = 0; o < lanes.info.outputs; ++o) any |= !same_bits(lanes.out[o], exact.out[o]);
    }
    return any;
  };
  EXPECT_FALSE(differ(few, 20));
  EXPECT_FALSE(differ(matrices, 76));
  EXPECT_FALSE(differ(vectors, 150));
  EXPECT_TRUE(differ(matrices, 56));
  // without fused operations lanes and single calls have the same bits where they add up in the same order
  if (std::string(dyn_build_info()).find("x86_64,") != std::string::npos) return;
  EXPECT_TRUE(differ(few, 14));
  EXPECT_TRUE(differ(vectors, 112));
}

// Whatever their number, order, threads and neighbours, of which some fail.
TEST(Batch, BitsDependOnTheStateAlone) {
  constexpr int n = 41;
  for (const Model& m : {all_types(), robot("panda"), robot("go2", DYN_BASE_FLOATING), random_robot(3, 12)}) {
    const Batch one(m, 1), four(m, 4);
    for (int which = 0; which < batch_algorithms; ++which) {
      const BatchCase all(m, which, n);
      ASSERT_EQ(DYN_OK, all(four)) << dyn_last_error();
      for (int k = 0; k < n; k += 5) {
        const BatchCase alone(m, which, 1, std::uint64_t(1 + k)), next(m, which, 3, std::uint64_t(1 + k));
        ASSERT_EQ(DYN_OK, alone(one)) << dyn_last_error();
        ASSERT_EQ(DYN_OK, next(one)) << dyn_last_error();
        for (int o = 0; o < all.info.outputs; ++o) {
          ASSERT_TRUE(same_bits(all.row(o, k), alone.row(o, 0))) << all.info.name;
          if (k + 3 <= n) {
            ASSERT_TRUE(same_bits(all.row(o, k + 2), next.row(o, 2))) << all.info.name;
          }
        }
      }
      if (!reads(all.info, "q")) continue;
      for (const bool most : {false, true}) {
        const auto fails = [&](int k) { return most ? k % 8 != 7 : k % 3 == 2; };
        BatchCase broken(m, which, n);
        for (int k = 0; k < n; ++k)
          if (fails(k)) broken.q[std::size_t(k * dyn_model_nq(m))] = nan;
        EXPECT_EQ(DYN_ERROR_NONFINITE, broken(one));
        for (int k = 0; k < n; ++k)
          for (int o = 0; o < all.info.outputs && !fails(k); ++o)
            ASSERT_TRUE(same_bits(all.row(o, k), broken.row(o, k))) << all.info.name << "[" << k << "]";
      }
    }
  }
}

// What a data holds from the state before, or from another algorithm, makes no difference.
TEST(Batch, TheSameStateAgain) {
  const Model m = all_types();
  const Batch one(m, 1);
  for (int which = 0; which < batch_algorithms; ++which) {
    BatchCase c(m, which, 2);
    c.x.exact = 1;
    for (Numbers* x : {&c.q, &c.v, &c.a, &c.tau, &c.fext, &c.b, &c.q1})
      std::copy_n(x->begin(), x->size() / 2, x->begin() + std::ptrdiff_t(x->size() / 2));
    const auto expected = c.single(0);
    for (int before = 0; before < batch_algorithms; ++before) {
      BatchCase other(m, before, 2);
      other.x.q = c.q.data(), other.x.v = c.v.data(), other.x.a = c.a.data(), other.x.tau = c.tau.data();
      ASSERT_EQ(DYN_OK, other(one)) << dyn_last_error();
      ASSERT_EQ(DYN_OK, c(one)) << dyn_last_error();
      for (int o = 0; o < c.info.outputs; ++o)
        ASSERT_TRUE(same_bits(expected[std::size_t(o)], c.row(o, 0)) && same_bits(expected[std::size_t(o)], c.row(o, 1)))
            << c.info.name << " after " << other.info.name;
    }
  }
}

TEST(Batch, FramesJointsAndReferences) {
  const Model m = all_types();
  const Batch batch(m, 2);
  for (int which = 0; which < batch_algorithms; ++which)
    for (int f = 1; f < m.njoints(); f += 3)
      for (dynReference r : {DYN_REFERENCE_LOCAL, DYN_REFERENCE_WORLD, DYN_REFERENCE_LOCAL_WORLD_ALIGNED}) {
        BatchCase c(m, which, 5);
        c.x.frame = c.x.joint = f, c.x.reference = r, c.x.exact = 1;
        ASSERT_EQ(DYN_OK, c(batch)) << dyn_last_error();
        for (int k = 0; k < 5; ++k)
          for (int o = 0; o < c.info.outputs; ++o)
            ASSERT_TRUE(same_bits(c.single(k)[std::size_t(o)], c.row(o, k))) << c.info.name;
      }
}

// v, a, tau that are not given are zeros, whatever the call before had; an output may be asked for alone.
TEST(Batch, InputsAndOutputsLeftOut) {
  for (const Model& m : {all_types(), robot("panda")}) {
    const Batch batch(m, 2);
    for (int which = 0; which < batch_algorithms; ++which) {
      BatchCase zeros(m, which, 40), absent(m, which, 40);
      for (Numbers* x : {&zeros.v, &zeros.a, &zeros.tau, &zeros.fext}) std::fill(x->begin(), x->end(), 0.0);
      absent.x.v = absent.x.a = absent.x.tau = absent.x.fext = nullptr, absent.x.status = nullptr;
      ASSERT_EQ(DYN_OK, zeros(batch)) << dyn_last_error();
      ASSERT_EQ(DYN_OK, BatchCase(m, which, 40)(batch));
      ASSERT_EQ(DYN_OK, absent(batch)) << dyn_last_error();
      for (int o = 0; o < zeros.info.outputs; ++o) {
        for (std::size_t e = 0; e < zeros.out[o].size(); ++e) ASSERT_EQ(zeros.out[o][e], absent.out[o][e]) << zeros.info.name;
        BatchCase one(m, which, 40), all(m, which, 40);
        for (int other = 0; other < 4; ++other)
          if (other != o) one.x.out[other] = nullptr;
        ASSERT_EQ(DYN_OK, one(batch)) << dyn_last_error();
        ASSERT_EQ(DYN_OK, all(batch));
        EXPECT_TRUE(same_bits(all.out[o], one.out[o])) << zeros.info.name << " " << o;
      }
    }
  }
}

TEST(Batch, OutputInPlaceOfAnInput) {
  const Model m = all_types();
  const Batch batch(m, 4);
  BatchCase apart(m, DYN_ALGORITHM_INTEGRATE, 100), same(m, DYN_ALGORITHM_INTEGRATE, 100);
  same.x.out[0] = same.q.data();
  ASSERT_EQ(DYN_OK, apart(batch));
  ASSERT_EQ(DYN_OK, same(batch));
  apart.out[0].resize(same.q.size());
  EXPECT_TRUE(same_bits(apart.out[0], same.q));
}

// States 7 and 50 have one bad number in one input.
TEST(Batch, StatesThatFail) {
  const Model m = all_types();
  for (int threads : {1, 2, 4}) {
    const Batch batch(m, threads);
    for (int which = 0; which < batch_algorithms; ++which) {
      const BatchCase good(m, which, 60);
      ASSERT_EQ(DYN_OK, good(batch));
      for (const char* input : {"q", "v", "a", "tau", "fext", "b", "q1"}) {
        if (!reads(good.info, input)) continue;
        BatchCase c(m, which, 60);
        const std::string name = input;
        Numbers& x = name == "q"     ? c.q
                     : name == "v"   ? c.v
                     : name == "a"   ? c.a
                     : name == "tau" ? c.tau
                     : name == "b"   ? c.b
                     : name == "q1"  ? c.q1
                                     : c.fext;
        const std::size_t size = x.size() / 60;
        x[7 * size + size - 1] = nan, x[50 * size + size - 1] = -inf;
        EXPECT_EQ(DYN_ERROR_NONFINITE, c(batch)) << c.info.name << " " << input;
        const std::string said = which == DYN_ALGORITHM_DIFFERENCE && name == "q"                  ? "q0"
                                 : which == DYN_ALGORITHM_RNEA_SECOND_ORDER_PRODUCT && name == "b" ? "lambda"
                                                                                                   : name;
        EXPECT_TRUE(says({"dyn_batch_run: " + std::string(c.info.name) + ": state 7: ",
                          said + "[" + std::to_string(size - 1) + "] is NaN", "2 of 60 states"}));
        EXPECT_TRUE(c.guarded());
        for (int k = 0; k < 60; ++k) {
          const bool bad = k == 7 || k == 50;
          EXPECT_EQ(bad ? DYN_ERROR_NONFINITE : DYN_OK, c.status[std::size_t(k)]);
          for (int o = 0; o < c.info.outputs; ++o)
            ASSERT_TRUE(bad ? c.untouched(o, k) : same_bits(good.row(o, k), c.row(o, k))) << c.info.name << "[" << k << "]";
        }
        ASSERT_EQ(DYN_OK, good(batch));  // and it works on
      }
    }
  }
}

TEST(Batch, EachStateHasItsOwnStatus) {
  const Model m = all_types(), rods = singular_at_zero();
  const Batch batch(m, 3), of_rods(rods, 2);
  BatchCase c(m, DYN_ALGORITHM_RNEA, 90);
  std::fill(c.q.begin() + 3 + 80 * m.nq(), c.q.begin() + 7 + 80 * m.nq(), 0.0);
  std::fill(c.v.begin() + 30 * m.nv(), c.v.begin() + 31 * m.nv(), 1e300);
  c.a[std::size_t(89 * m.nv())] = nan;
  EXPECT_EQ(DYN_ERROR_NUMERIC, c(batch));
  EXPECT_TRUE(says({"rnea: state 30:", "overflows", "3 of 90"}));
  EXPECT_EQ(DYN_ERROR_NUMERIC, c.status[30]);
  EXPECT_EQ(DYN_ERROR_QUATERNION, c.status[80]);
  EXPECT_EQ(DYN_ERROR_NONFINITE, c.status[89]);
  EXPECT_EQ(87, std::count(c.status.begin(), c.status.end(), DYN_OK));

  BatchCase singular(rods, DYN_ALGORITHM_ABA, 20);
  std::fill(singular.q.begin() + 3 * rods.nq(), singular.q.begin() + 4 * rods.nq(), 0.0);
  EXPECT_EQ(DYN_ERROR_NUMERIC, singular(of_rods));
  EXPECT_TRUE(says({"aba: state 3:", "singular at joint", "1 of 20"}));
}

TEST(Batch, Arguments) {
  const Model m = robot("go2", DYN_BASE_FLOATING);
  const Batch batch(m, 2);
  BatchCase c(m, DYN_ALGORITHM_RNEA, 10);
  auto refused = [&](dynStatus status, const std::vector<std::string>& fragments) {
    EXPECT_EQ(status, c(batch));
    EXPECT_TRUE(says(fragments));
    for (int k = 0; k < 10; ++k) EXPECT_TRUE(c.untouched(0, k));
  };
  c.n = -1, refused(DYN_ERROR_ARGUMENT, {"dyn_batch_run", "n is -1"});
  c.n = INT64_MIN, refused(DYN_ERROR_ARGUMENT, {"n is"});
  c.n = INT64_MAX, refused(DYN_ERROR_ARGUMENT, {"n is"});
  c.n = 10, c.x.q = nullptr, refused(DYN_ERROR_ARGUMENT, {"rnea", "q is NULL"});
  c.x.q = c.q.data(), c.x.out[0] = nullptr, refused(DYN_ERROR_ARGUMENT, {"rnea", "out[0]", "NULL"});
  c.x.out[0] = c.out[0].data(), c.x.struct_size = 8, refused(DYN_ERROR_SIZE, {"struct_size", "dyn_batch_arrays_init"});
  c.x.struct_size = sizeof c.x, c.algorithm = DYN_ALGORITHM_CHOLESKY_SOLVE, c.x.b = nullptr,
  refused(DYN_ERROR_ARGUMENT, {"solve", "b is NULL"});
  for (int which : {-1, batch_algorithms, 1 << 30}) {
    c.algorithm = dynAlgorithm(which);
    refused(DYN_ERROR_ARGUMENT, {"dyn_batch_run", "algorithm is " + std::to_string(which)});
    dynAlgorithmInfo info{};
    info.struct_size = sizeof info;
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_algorithm_info(m, dynAlgorithm(which), &info));
  }
  // what all states share is not said of one
  BatchCase frame(m, DYN_ALGORITHM_FRAME_VELOCITY, 10);
  frame.x.frame = 999;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, frame(batch));
  EXPECT_TRUE(says({"dyn_batch_run: frame_velocity: frame 999 does not exist"}));
  EXPECT_EQ(std::string::npos, std::string(dyn_last_error()).find("state"));
  EXPECT_EQ(10, std::count(frame.status.begin(), frame.status.end(), DYN_ERROR_ARGUMENT));
  BatchCase joint(m, DYN_ALGORITHM_JOINT_BODY_REGRESSOR, 10);
  joint.x.joint = -1;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, joint(batch));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_batch_run(batch, DYN_ALGORITHM_RNEA, 1, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_algorithm_info(m, DYN_ALGORITHM_RNEA, nullptr));
  dynAlgorithmInfo small{};
  small.struct_size = 4;
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_algorithm_info(m, DYN_ALGORITHM_RNEA, &small));
  dyn_batch_arrays_init(nullptr);
  // no states: nothing to do, and nothing is read
  dynBatchArrays empty;
  dyn_batch_arrays_init(&empty);
  EXPECT_EQ(DYN_OK, dyn_batch_run(batch, DYN_ALGORITHM_RNEA, 0, &empty));
}

TEST(Batch, Creation) {
  const Model m = robot("go2", DYN_BASE_FLOATING);
  dynBatch* none = nullptr;
  for (int threads : {0, -1, INT_MIN}) {
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_batch_new(m, 0, threads, &none));
    EXPECT_TRUE(says({"dyn_batch_new", "threads is " + std::to_string(threads)}));
  }
  for (int threads : {257, INT_MAX}) {
    EXPECT_EQ(DYN_ERROR_LIMIT, dyn_batch_new(m, 0, threads, &none));
    EXPECT_TRUE(says({"dyn_batch_new", "the limit is 256"}));
  }
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_batch_new(m, 1u << 30, 2, &none));
  EXPECT_TRUE(says({"parts"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_batch_new(m, 0, 2, nullptr));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_batch_new(nullptr, 0, 2, &none));
  EXPECT_EQ(nullptr, none);
  for (int k = 0; k < 20; ++k) Batch(m, 1 + k, DYN_PART_INVERSE);  // made and freed while its threads are still starting
  const Batch inverse(m, 2, DYN_PART_INVERSE);
  EXPECT_EQ(DYN_OK, BatchCase(m, DYN_ALGORITHM_RNEA, 100)(inverse));
  EXPECT_EQ(DYN_ERROR_PART, BatchCase(m, DYN_ALGORITHM_CRBA, 100)(inverse));
  EXPECT_TRUE(says({"crba", "DYN_PART_MASS", "dyn_batch_new"}));
}

TEST(Batch, Handles) {
  const Model m = chain(3);
  const BatchCase c(m, DYN_ALGORITHM_RNEA, 10);
  alignas(64) unsigned char zeros[256] = {};
  dynBatch* dead = nullptr;
  ASSERT_EQ(DYN_OK, dyn_batch_new(m, 0, 2, &dead));
  dyn_batch_free(dead), dyn_batch_free(dead), dyn_batch_free(nullptr);
  EXPECT_EQ(DYN_ERROR_HANDLE, c(nullptr));
  EXPECT_TRUE(says({"batch is NULL", "dyn_batch_new"}));
  EXPECT_EQ(DYN_ERROR_HANDLE, c(dead));
  EXPECT_TRUE(says({"batch has been freed"}));
  EXPECT_EQ(DYN_ERROR_HANDLE, c(reinterpret_cast<dynBatch*>(zeros)));
  EXPECT_EQ(DYN_ERROR_HANDLE, c(reinterpret_cast<dynBatch*>(m.m)));
  dynAlgorithmInfo info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_algorithm_info(reinterpret_cast<dynModel*>(zeros), DYN_ALGORITHM_RNEA, &info));
  EXPECT_EQ(DYN_OK, dyn_algorithm_info(nullptr, DYN_ALGORITHM_RNEA, &info));
  EXPECT_TRUE(info.name == std::string("rnea") && info.outputs == 1 && info.rows[0] == 0);
  Model gone = chain(3);
  const Batch orphan(gone, 2);
  gone = Model();
  EXPECT_EQ(DYN_ERROR_HANDLE, c(orphan));
  EXPECT_TRUE(says({"model", "freed"}));
}

// A process that was forked has none of the threads, and still gets its results.
TEST(Batch, AfterFork) {
  if (sanitized) GTEST_SKIP() << "sanitizers watch threads of their own";
  const Model m = chain(5);
  auto* batch = new Batch(m, 4);
  const BatchCase parent(m, DYN_ALGORITHM_CRBA, 300), child(m, DYN_ALGORITHM_CRBA, 300);
  ASSERT_EQ(DYN_OK, parent(*batch));
  const pid_t pid = fork();
  ASSERT_GE(pid, 0);
  if (pid == 0) {
    const bool good = child(*batch) == DYN_OK && same_bits(parent.out[0], child.out[0]);
    delete batch;
    _exit(good ? 0 : 1);
  }
  int status = 1;
  ASSERT_EQ(pid, waitpid(pid, &status, 0));
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_EQ(DYN_OK, parent(*batch));
  delete batch;
}

}  // namespace
}  // namespace dyn_test
