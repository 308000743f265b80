// What templates ask of their scalar.
#pragma once

namespace dyn {

// Whether it is the number of one state, which its branches may follow. Numbers of several states (lane.hpp) share them.
template <class T>
inline constexpr bool branches_by_state = true;

}  // namespace dyn
