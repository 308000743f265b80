// Parts that programs may ask for. Builds for boards may state fewer (DYN_PARTS), and then leave out what the others take.
#pragma once

#include "model/data.hpp"

namespace dyn::capi {

#ifndef DYN_PARTS
#define DYN_PARTS DYN_PART_ALL
#endif
inline constexpr dynParts possible_parts = complete_parts(DYN_PARTS);

}  // namespace dyn::capi
