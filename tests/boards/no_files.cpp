// The core reads no robot files. Tests that load one fail here and are left out (reads_files).
#include "model/load.hpp"

namespace dyn {

ModelPtr load_file(const std::string&, const LoadOptions&) { throw Error(DYN_ERROR_FILE, "this build reads no files"); }
ModelPtr load_string(const std::string&, const LoadOptions&) { throw Error(DYN_ERROR_FILE, "this build reads no files"); }

}  // namespace dyn
