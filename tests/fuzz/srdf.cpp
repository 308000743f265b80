// An SRDF for a small robot.
#include <fstream>
#include <sstream>

#include "fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const std::string robot = [] {
    std::stringstream text;
    text << std::ifstream(std::string(DYN_MODELS_DIR) + "/robots/double_pendulum.urdf").rdbuf();
    return text.str();
  }();
  const std::string path = fuzz::file("robot.srdf", bytes, size);
  fuzz::load(reinterpret_cast<const uint8_t*>(robot.data()), robot.size(), size % 2 ? DYN_BASE_FIXED : DYN_BASE_UNSPECIFIED,
             path.c_str());
  return 0;
}
