#include "fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  fuzz::load(bytes, size, DYN_BASE_UNSPECIFIED);
  return 0;
}
