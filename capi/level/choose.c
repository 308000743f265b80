/* Which of its levels the library uses: the best one that this processor runs, or the one that the environment variable DYN_LEVEL
   names (plain, x86-64-v3, x86-64-v4), if it runs here. Chosen once, when the library is loaded. */
#include <cpuid.h>
#include <stdlib.h>
#include <string.h>

/* what a level runs before its first function */
typedef void (*Initializer)(void);

#define LEVEL(name, architecture)                                            \
  extern const Initializer __start_dyn_init_##name[] __attribute__((weak)); \
  extern const Initializer __stop_dyn_init_##name[] __attribute__((weak));
#include "levels.inc"
#undef LEVEL

struct Level {
  const char* architecture;
  const Initializer *first, *last;
};
static const struct Level levels[] = {
#define LEVEL(name, architecture) {architecture, __start_dyn_init_##name, __stop_dyn_init_##name},
#include "levels.inc"
#undef LEVEL
};

/* index in levels; -1: not chosen yet (stubs.S) */
__attribute__((visibility("hidden"))) int dyn_level = -1;

static int has_v3(void) {
  unsigned a, b, c = 0, d, extended = 0;
  if (!__get_cpuid(1, &a, &b, &c, &d) || !__get_cpuid(0x80000001, &a, &b, &extended, &d)) return 0;
  return (c & bit_F16C) && (c & bit_MOVBE) && (extended & bit_LZCNT) && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
         __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
}

static int has_v4(void) {
  return has_v3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}

static int runs(const char* architecture) {
  if (strcmp(architecture, "x86-64-v3") == 0) return has_v3();
  if (strcmp(architecture, "x86-64-v4") == 0) return has_v4();
  return 1;
}

__attribute__((constructor, visibility("hidden"))) void dyn_choose_level(void) {
  if (dyn_level >= 0) return;
  __builtin_cpu_init();
  const char* asked = getenv("DYN_LEVEL");
  const int count = (int)(sizeof levels / sizeof *levels);
  int chosen = 0;
  for (int k = 0; k < count; ++k)
    if (runs(levels[k].architecture)) chosen = k;
  for (int k = 0; asked && k < count; ++k)
    if (strcmp(asked, levels[k].architecture) == 0 && runs(asked)) chosen = k;
  for (const Initializer* f = levels[chosen].first; f != levels[chosen].last; ++f) (*f)();
  dyn_level = chosen;
}
