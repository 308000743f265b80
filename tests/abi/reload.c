/* A program that opens and closes the library again and again loses no memory: plugins of simulators and of controllers are reloaded.
   reload LIBRARY ROBOT */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <malloc.h>
#include <stdio.h>
#include <string.h>

#include "dyn.h"

#define FUNCTION(result, name, ...) result (*name)(__VA_ARGS__) = (result(*)(__VA_ARGS__))dlsym(library, #name)
#undef dyn_load_options_init

static int mapped(const char* name) {
  char line[4096];
  int found = 0;
  FILE* maps = fopen("/proc/self/maps", "r");
  while (maps && fgets(line, sizeof line, maps)) found |= strstr(line, name) != NULL;
  if (maps) fclose(maps);
  return found;
}

/* Opens it, loads a robot, fails once, computes, frees, closes. */
static int use(const char* path, const char* robot) {
  void* const library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (!library) return printf("%s\n", dlerror()), 1;
  FUNCTION(void, dyn_load_options_init, dynLoadOptions*, uint32_t);
  FUNCTION(dynStatus, dyn_model_load, const char*, const dynLoadOptions*, dynModel**);
  FUNCTION(void, dyn_model_free, dynModel*);
  FUNCTION(dynStatus, dyn_data_new, const dynModel*, dynParts, dynData**);
  FUNCTION(void, dyn_data_free, dynData*);
  FUNCTION(dynStatus, dyn_step, const dynModel*, dynData*);
  FUNCTION(const char*, dyn_last_error, void);
  dynLoadOptions options;
  dyn_load_options_init(&options, sizeof options);
  options.base = DYN_BASE_FIXED;
  dynModel* model = NULL;
  dynData* data = NULL;
  const int failed = dyn_model_load("/no/such.urdf", &options, &model) == DYN_OK || dyn_model_load(robot, &options, &model) != DYN_OK ||
                     dyn_data_new(model, DYN_PART_ALL, &data) != DYN_OK || dyn_step(model, data) != DYN_OK;
  if (failed) printf("%s\n", dyn_last_error());
  dyn_data_free(data);
  dyn_model_free(model);
  return dlclose(library) != 0 || failed;
}

int main(int count, char** arguments) {
  if (count != 3) return 2;
  enum { first = 100, times = 300, bookkeeping = 50 }; /* bytes that the C library may keep of a library that was opened */
  size_t before = 0;
  for (int k = 0; k < first + times; ++k) {
    if (k == first) before = mallinfo2().uordblks;
    if (use(arguments[1], arguments[2])) return 1;
  }
  const double lost = ((double)mallinfo2().uordblks - (double)before) / times;
  printf("%g bytes lost each time\n", lost);
  if (mapped("libdyn")) return printf("it is still mapped\n"), 1;
  return lost > bookkeeping;
}
