// Damaged copies of a file, by seed, and a process of its own in which to read them.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace dyn_test {

// SplitMix64 (Steele, Lea, Flood 2014)
struct Seeded {
  std::uint64_t state;
  std::uint64_t next() {
    std::uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
  }
  std::size_t below(std::size_t n) { return n ? std::size_t(next() % n) : 0; }
};

// One to four changes: bits, bytes, numbers, parts that go, come twice or change places, an early end.
inline std::string mutant(std::string text, std::uint64_t seed) {
  static constexpr std::string_view words[] = {
      "0",     "-1",    "1",          "x",          "inf",  "nan", "1e999", "1e-999",
      "-0",    "65536", "2147483648", "4294967295", "",     "0x7", "1 2",   "99999999999999999999",
      "\"",    "<",     ">",          "/>",         "&#0;", "{",   "]",     "\xff",
      "1e300", "0.5",   "#",          "null",       "\\",   ","};
  Seeded random{seed};
  for (std::size_t changes = 1 + random.below(4); changes > 0 && !text.empty(); --changes) {
    const std::size_t at = random.below(text.size()), length = 1 + random.below(std::min<std::size_t>(40, text.size() - at));
    const std::string part = text.substr(at, length);
    switch (random.below(8)) {
      case 0:
        text[at] = char(text[at] ^ (1 << random.below(8)));
        break;
      case 1:
        text[at] = char(random.below(256));
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(random.below(text.size()), part);
        break;
      case 4:
        text.resize(at);
        break;
      case 5:
        text.insert(at, words[random.below(std::size(words))]);
        break;
      default: {  // a number
        const std::size_t from = text.find_first_of("0123456789", at);
        if (from == text.npos) break;
        const std::size_t to = std::min(text.find_first_not_of("0123456789.eE+-", from), text.size());
        text.replace(from, to - from, words[random.below(std::size(words))]);
      }
    }
  }
  return text;
}

// How many mutants a test reads: some hundred, or DYN_MUTANTS.
inline std::uint64_t mutant_count(std::uint64_t usual) {
  const char* asked = std::getenv("DYN_MUTANTS");
  return asked ? std::strtoull(asked, nullptr, 10) : usual;
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool limits_memory = false;  // a sanitizer maps terabytes,
inline constexpr unsigned slower = 10;        // and takes its time
#else
inline constexpr bool limits_memory = true;
inline constexpr unsigned slower = 1;
#endif

// Calls f in a child process with so many bytes of memory beside those it has, and seconds of processor time. Fails unless
// it returns.
template <class F>
void in_child(std::uint64_t bytes, unsigned seconds, const F& f) {
  std::fflush(nullptr);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    unsigned long pages = 0;
    if (std::FILE* statm = std::fopen("/proc/self/statm", "r")) {
      if (std::fscanf(statm, "%lu", &pages) != 1) pages = 0;
      std::fclose(statm);
    }
    const rlim_t memory = rlim_t(pages) * rlim_t(sysconf(_SC_PAGESIZE)) + bytes;
    const rlimit space{memory, memory}, time{slower * seconds, slower * seconds + 1};
    if (limits_memory) setrlimit(RLIMIT_AS, &space);
    setrlimit(RLIMIT_CPU, &time);
    f();
    std::fflush(nullptr);
    _exit(testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  ASSERT_EQ(child, waitpid(child, &status, 0));
  EXPECT_TRUE(WIFEXITED(status)) << "ended by signal " << (WIFSIGNALED(status) ? WTERMSIG(status) : 0);
  EXPECT_EQ(0, WIFEXITED(status) ? WEXITSTATUS(status) : 1);
}

}  // namespace dyn_test
