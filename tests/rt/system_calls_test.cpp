// Tests that calls after creation make no system call: the kernel kills a process that does.
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <linux/seccomp.h>

#include "capi/batch.hpp"
#include "rt/work.hpp"

namespace dyn_test {
namespace {

// A process that may only read, write and leave (seccomp's strict mode; the kernel kills it for anything else).
TEST(SystemCalls, NoneAfterCreation) {
  if (sanitized) GTEST_SKIP() << "sanitizers make system calls";
  for (const Robot& r : robots()) {
    Work work(r.m);
    dyn_model_nq(nullptr);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) _exit(77);
      for (int round = 0; round < 2; ++round)
        for (const Ready& c : work.calls) c.call();
      syscall(SYS_exit, 0);
    }
    int status = 0;
    ASSERT_EQ(child, waitpid(child, &status, 0));
    if (WIFEXITED(status) && WEXITSTATUS(status) == 77) GTEST_SKIP() << "no seccomp here";
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << r.name << ": a system call was made (status " << status << ")";
  }
}

// With one thread there are none at all.
TEST(SystemCalls, NoneInABatchOnOneThread) {
  if (sanitized) GTEST_SKIP() << "sanitizers make system calls";
  const Model m = all_types();
  const Batch batch(m, 1);
  std::vector<std::unique_ptr<BatchCase>> cases;
  for (int which = 0; which < batch_algorithms; ++which) cases.push_back(std::make_unique<BatchCase>(m, which, 20));
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) _exit(77);
    for (const auto& c : cases) (*c)(batch);
    syscall(SYS_exit, 0);
  }
  int status = 0;
  ASSERT_EQ(child, waitpid(child, &status, 0));
  if (WIFEXITED(status) && WEXITSTATUS(status) == 77) GTEST_SKIP() << "no seccomp here";
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "a system call was made (status " << status << ")";
}

}  // namespace
}  // namespace dyn_test
