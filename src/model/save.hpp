// Models to files. Host side.
#pragma once

#include <string>
#include <vector>

#include "model/model.hpp"

namespace dyn {

// What a format has no place for (a warning), or says in another way (an information): one line each.
struct SaveEntry {
  dynReportLevel level;
  std::string message;
};
using SaveReport = std::vector<SaveEntry>;

std::string save_urdf(const Model& m, SaveReport& report);
std::string save_mjcf(const Model& m, SaveReport& report);
// narrow: for machines whose vectors have three lanes; without names (and load report) it can be used in place alone.
std::string save_dynb(const Model& m, bool narrow = false, bool names = true);

// The format that the path's extension names; throws for others.
dynFormat format_of(const std::string& path);
// strict: throws when the report has a warning.
std::string save_string(const Model& m, dynFormat format, bool strict, SaveReport& report);
void save_file(const Model& m, const std::string& path, bool strict, SaveReport& report);

}  // namespace dyn
