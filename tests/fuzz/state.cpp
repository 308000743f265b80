// States in JSON, as the command reads them.
#include "cli.hpp"
#include "fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const cli::Robot robot([] {
    cli::RobotOptions options;
    options.file = std::string(DYN_MODELS_DIR) + "/robots/double_pendulum.urdf";
    return options;
  }());
  cli::StateOptions options;
  options.file = fuzz::file("state.json", bytes, size);
  try {
    cli::read_state(robot, options);
  } catch (const cli::Failure&) {
  }
  return 0;
}
