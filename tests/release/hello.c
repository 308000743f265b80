/* The version, and the degrees of freedom of a robot. */
#include <dyn.h>
#include <stdio.h>

int main(int count, char** words) {
  dynLoadOptions options;
  dynModel* model = NULL;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FLOATING;
  if (count != 2 || dyn_model_load(words[1], &options, &model) != DYN_OK) {
    fprintf(stderr, "%s\n", dyn_last_error());
    return 1;
  }
  printf("C: libdyn %s, nv %d\n", dyn_version(), dyn_model_nv(model));
  dyn_model_free(model);
  return 0;
}
