// The floating-point settings of a thread.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace dyn {

// While it lives, results are rounded to nearest, subnormal numbers count, and nothing traps, whatever the caller has set: code
// compiled with -ffast-math makes its process flush subnormal numbers, and debuggers of numerics trap divisions by zero. Vectors
// divide by zero in lanes that are not used. Exceptions that the caller had not raised yet are not raised for it where its
// settings are others. Processors without such settings: nothing.
class DefaultFloatingPoint {
 public:
#if defined(__SSE2__)
  DefaultFloatingPoint() {
    const unsigned now = _mm_getcsr();
    if ((now & ~raised) != standard) [[unlikely]] set(standard), callers = now;
  }
  ~DefaultFloatingPoint() {
    if (callers) [[unlikely]] set(callers);
  }

 private:
  static constexpr unsigned raised = 0x3f, standard = 0x1f80;
  static void set(unsigned settings) {
    asm volatile("" ::: "memory");  // arithmetic stays on its side
    _mm_setcsr(settings);
    asm volatile("" ::: "memory");
  }
  unsigned callers = 0;  // 0: they are the default ones
#elif defined(__aarch64__)
  DefaultFloatingPoint() : callers(get()) {
    if (callers != 0) [[unlikely]] set(0);
  }
  ~DefaultFloatingPoint() {
    if (callers != 0) [[unlikely]] set(callers);
  }

 private:
  static unsigned long get() {
    unsigned long settings;
    asm volatile("mrs %0, fpcr" : "=r"(settings));
    return settings;
  }
  static void set(unsigned long settings) { asm volatile("msr fpcr, %0" ::"r"(settings) : "memory"); }
  unsigned long callers;
#else
  DefaultFloatingPoint() {}
  ~DefaultFloatingPoint() {}
#endif
  DefaultFloatingPoint(const DefaultFloatingPoint&) = delete;
};

}  // namespace dyn
