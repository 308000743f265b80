// Files that the command line names: nothing is written over what is read, and no two answers into one file.
#pragma once

#include "cli.hpp"

namespace cli {

struct NamedFile {
  const char* option;
  std::string path;  // "": not given
};
// What every subcommand with a robot reads, and what else one does.
std::vector<NamedFile> inputs_of(const RobotOptions& robot, std::vector<NamedFile> more = {});
// Before any work: bad usage when an output is an input or another output, whatever their names; fails for one that cannot be
// written. Nothing is changed. Devices and pipes may be anything at once.
void check_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs = {});

}  // namespace cli
