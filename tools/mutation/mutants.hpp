// In the mutated tree alone (tools/mutants): which mutant is on, by DYN_MUTANT, and what a run reaches, for DYN_MUTANTS_RECORD.
#pragma once

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace mutants {

inline constexpr int expressions = MUTANTS_EXPRESSIONS, constants = MUTANTS_CONSTANTS, page = 4096;

inline unsigned char reached[expressions + 1];
inline volatile unsigned char read[constants + 1];
// each constant on a page of its own: a first read of it is a fault, while reads are recorded
alignas(page) inline char arena[constants + 1][page];
inline bool registered[constants + 1];

inline const int active = std::getenv("DYN_MUTANT") ? std::atoi(std::getenv("DYN_MUTANT")) : 0;
inline const char* const record = std::getenv("DYN_MUTANTS_RECORD");

inline bool on(int n) {
  reached[n] = 1;
  return active == n;
}

inline void fault(int, siginfo_t* info, void*) {
  const char* at = static_cast<const char*>(info->si_addr);
  if (at < arena[0] || at >= arena[constants + 1]) {
    std::signal(SIGSEGV, SIG_DFL);
    return;
  }
  const long n = (at - arena[0]) / page;
  read[n] = 1;
  mprotect(arena[n], page, PROT_READ | PROT_WRITE);
}

struct Writer {
  ~Writer() {
    if (!record) return;
    char line[16 * (expressions + constants + 2)];
    int n = 0;
    for (int i = 1; i <= expressions; ++i)
      if (reached[i]) n += std::sprintf(line + n, "e%d\n", i);
    for (int i = 1; i <= constants; ++i)
      if (read[i]) n += std::sprintf(line + n, "c%d\n", i);
    const int file = open(record, O_WRONLY | O_CREAT | O_APPEND, 0644);
    if (file >= 0 && write(file, line, std::size_t(n)) >= 0) close(file);
  }
};
inline const Writer writer;

inline double raised(double x) { return x > 0.1 && x < 1 ? 1 - (1 - x) / 10 : 10 * x; }
inline double lowered(double x) { return x / 10; }
template <class T>
T changed(int up, int down, T x) {
  if (active == up) return T(T(0.5) ? T(raised(double(x))) : T(2 * x));
  if (active == down) return T(T(0.5) ? T(lowered(double(x))) : T(x / 2));
  return x;
}

// A constant of a namespace or a class. Reads by initial values of others do not count.
template <class T>
const T& value(int n, int up, int down, T x) {
  T* const place = reinterpret_cast<T*>(arena[n]);
  if (record) {
    struct sigaction action = {};
    action.sa_sigaction = fault, action.sa_flags = SA_SIGINFO | SA_NODEFER;
    sigaction(SIGSEGV, &action, nullptr);
    mprotect(place, page, PROT_READ | PROT_WRITE);
  }
  *place = changed(up, down, x);
  if (record) {
    registered[n] = true;
    for (int i = 1; i <= constants; ++i)
      if (registered[i]) read[i] = 0, mprotect(arena[i], page, PROT_NONE);
  }
  return *place;
}

// A constant of a function.
template <class T>
T local(int n, int up, int down, T x) {
  read[n] = 1;
  return changed(up, down, x);
}

}  // namespace mutants
