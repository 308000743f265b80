// The function runs in a child that its parent single-steps between two stops; an empty function's count is taken off.
#include "count.hpp"

#include <csignal>
#include <sched.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

namespace bench {
namespace {

long steps(const std::function<void()>& f) {
  const pid_t child = fork();
  if (child == 0) {
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(1);
    raise(SIGSTOP);
    f();
    raise(SIGSTOP);
    _exit(0);
  }
  if (child < 0) return -1;
  int status = 0;
  long n = -1;
  if (waitpid(child, &status, 0) == child && WIFSTOPPED(status))
    do ++n;
    while (ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr) == 0 && waitpid(child, &status, 0) == child && WIFSTOPPED(status) &&
           WSTOPSIG(status) == SIGTRAP);
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return n;
}

}  // namespace

long instructions(const std::function<void()>& f) {
  // parent and child on one processor: a switch between them is what a step takes
  cpu_set_t all, here;
  CPU_ZERO(&here);
  CPU_SET(sched_getcpu(), &here);
  const bool pinned = sched_getaffinity(0, sizeof all, &all) == 0 && sched_setaffinity(0, sizeof here, &here) == 0;
  const long n = steps(f), none = steps([] {});
  if (pinned) sched_setaffinity(0, sizeof all, &all);
  return n < 0 || none < 0 ? -1 : n - none;
}

}  // namespace bench
