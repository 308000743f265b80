#include "thread_pool.hpp"

#include <unistd.h>

#include <csignal>

#include "dyn.h"
#include "base/floating_point.hpp"

namespace dyn::capi {

namespace {

// Looks at x for some 100 microseconds while it holds the value: calls that follow each other closely find the threads awake.
template <class T>
void look(const std::atomic<T>& x, T value) {
  for (int k = 0; k < 2000 && x.load(std::memory_order_relaxed) == value; ++k) {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
}

// No signals for the threads of the library: they are the program's.
class SignalsBlocked {
#ifndef _WIN32  // which has none
 public:
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before, nullptr); }

 private:
  sigset_t before;
#endif
};

}  // namespace

ThreadPool::ThreadPool(int threads) : others(new std::thread[std::size_t(threads)]), process(getpid()) {
  [[maybe_unused]] const SignalsBlocked blocked;
  try {
    for (; started < threads - 1; ++started) others[std::size_t(started)] = std::thread(&ThreadPool::serve, this, started + 1);
  } catch (...) {
    stop();
    throw;
  }
}

ThreadPool::~ThreadPool() { stop(); }

void ThreadPool::stop() {
  stopping.store(true);
  calls.fetch_add(1);
  calls.notify_all();
  for (int k = 0; k < started; ++k) {
    std::thread& t = others[std::size_t(k)];
    if (getpid() == process) t.join();
    else t.detach();  // after fork(): there is nothing to wait for
  }
}

void ThreadPool::serve(int thread) {
  dyn_last_error();  // what belongs to the thread alone is made now
  const DefaultFloatingPoint settings;  // not those of the thread that made the pool
  for (std::uint32_t seen = 0;;) {
    look(calls, seen);
    calls.wait(seen);
    seen = calls.load();
    if (stopping.load()) return;
    inside.fetch_add(1);
    if (open.load()) work(context, thread);
    if (inside.fetch_sub(1) == 1) inside.notify_all();
  }
}

void ThreadPool::run(Work w, void* c) {
  work = w, context = c;
  open.store(true);
  calls.fetch_add(1);
  calls.notify_all();
  w(c, 0);
  open.store(false);
  for (int n; (n = inside.load()) != 0;) {
    look(inside, n);
    inside.wait(n);
  }
}

}  // namespace dyn::capi
