// Colours that a file gives its shapes: for looks alone, so that a wrong one is none.
#pragma once

#include <map>

#include "xml.hpp"

namespace dyn::load {

// The attribute rgba; 0: there is none of four numbers.
std::uint32_t colour_of(const Element& e);
// Materials of a URDF by name: those of <robot>, then those that links bring along.
using Colours = std::map<std::string, std::uint32_t>;
Colours urdf_colours(const Element& robot);
// The <color> of a <material>, or that of its name; 0: neither.
std::uint32_t colour_of_material(const Element& material, const Colours& known);

}  // namespace dyn::load
