#include "fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  fuzz::load(bytes, size, size % 2 ? DYN_BASE_FIXED : DYN_BASE_FLOATING);
  return 0;
}
