// How long each of many calls takes: the percentiles and the longest, which a cycle time has to hold.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace latency {

// Prints: name, p50, p99, p99.9, p99.99, maximum in us. change(k) makes the next input, outside of the time taken.
template <class Change, class Call>
void measure(const char* name, std::int64_t calls, Change&& change, Call&& call) {
  using clock = std::chrono::steady_clock;
  std::vector<std::int64_t> taken(static_cast<std::size_t>(calls));
  for (int k = 0; k < 1000; ++k) change(k), call();
  for (std::int64_t k = 0; k < calls; ++k) {
    change(int(k % 1000));
    const auto from = clock::now();
    call();
    taken[std::size_t(k)] = std::chrono::duration_cast<std::chrono::nanoseconds>(clock::now() - from).count();
  }
  std::sort(taken.begin(), taken.end());
  const auto at = [&](double share) { return taken[std::size_t(double(calls - 1) * share)] * 1e-3; };
  std::printf("%s\t%.2f\t%.2f\t%.2f\t%.2f\t%.2f\n", name, at(0.5), at(0.99), at(0.999), at(0.9999), at(1));
  std::fflush(stdout);
}

// Steps of a scene from its beginning, again and again; its file's name is that of the row.
inline constexpr int scene_steps = 1000;
inline std::int64_t scene_calls(std::int64_t calls) { return std::max<std::int64_t>(calls / 100, scene_steps); }
inline std::string row_of(const std::string& path) {
  const std::size_t begin = path.rfind('/') + 1;
  return path.substr(begin, path.rfind('.') - begin);
}

// Input k, component i: the same numbers in every library.
inline double input(int k, int i) { return 0.3 * double((k * 7 + i * 13) % 41 - 20) / 20; }

}  // namespace latency
