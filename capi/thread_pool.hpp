// Threads that sleep until there is work, and then share it with the thread that calls.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>

namespace dyn::capi {

class ThreadPool {
 public:
  using Work = void (*)(void* context, int thread);

  // The caller of run() is thread 0; threads - 1 more are started. Throws what std::thread throws.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;

  // work(context, 0) here, and work(context, k) on every other thread k that wakes up before it returns; returns when all of them
  // have. So the work must be one that a single thread can finish: a thread that the system is slow to wake isn't waited for, and
  // in a child process of fork(), where the others don't exist, the caller does it all.
  void run(Work work, void* context);

 private:
  void stop();
  void serve(int thread);

  std::unique_ptr<std::thread[]> others;
  int started = 0;
  const int process;  // that has the threads
  Work work = nullptr;
  void* context = nullptr;
  // serve() enters (inside), then looks whether there is work (open); run() closes, then waits until nobody is inside
  alignas(64) std::atomic<std::uint32_t> calls{0};
  std::atomic<bool> stopping{false};
  std::atomic<bool> open{false};
  alignas(64) std::atomic<int> inside{0};
};

}  // namespace dyn::capi
