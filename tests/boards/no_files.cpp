// The core reads no robot's file: what dyn_model_load would call. Tests that come here fail, and are left out (reads_files).
#include "model/load.hpp"

namespace dyn {

ModelPtr load_file(const std::string&, const LoadOptions&) { throw Error(DYN_ERROR_FILE, "this build reads no files"); }
ModelPtr load_string(const std::string&, const LoadOptions&) { throw Error(DYN_ERROR_FILE, "this build reads no files"); }

}  // namespace dyn
