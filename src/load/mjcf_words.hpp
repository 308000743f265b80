// Words of <contact data> and <rangefinder data>, in their order.
#pragma once

#include <string_view>
#include <utility>

#include "dyn.h"

namespace dyn::load {

inline constexpr std::pair<std::string_view, std::uint32_t> contact_words[] = {
    {"found", DYN_VALUE_FOUND},  {"force", DYN_VALUE_FORCE},   {"torque", DYN_VALUE_MOMENT},  {"dist", DYN_VALUE_DISTANCE},
    {"pos", DYN_VALUE_POSITION}, {"normal", DYN_VALUE_NORMAL}, {"tangent", DYN_VALUE_TANGENT}};
inline constexpr std::pair<std::string_view, std::uint32_t> ray_words[] = {
    {"dist", DYN_VALUE_DISTANCE},  {"dir", DYN_VALUE_DIRECTION}, {"origin", DYN_VALUE_ORIGIN},
    {"point", DYN_VALUE_POSITION}, {"normal", DYN_VALUE_NORMAL}, {"depth", DYN_VALUE_DEPTH}};

}  // namespace dyn::load
