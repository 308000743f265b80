// Effects that a command line asks for, of a robot.
#pragma once

#include "cli.hpp"

namespace cli {

// The effects that act: "stated" stands for those of steps of new data, which are the file's less what its flags switch off.
std::uint32_t effects_on(const Robot& robot, const EffectOptions& options);
std::uint32_t effect_bits(const std::string& name);

}  // namespace cli
