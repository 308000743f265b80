// Colours of shapes in robot files. They only affect looks, so an invalid colour counts as none.
#pragma once

#include <map>

#include "xml.hpp"

namespace dyn::load {

// Reads the attribute rgba. Returns 0 unless it has four numbers.
std::uint32_t colour_of(const Element& e);
// Materials of a URDF by name. Those of <robot> come first, then those of links.
using Colours = std::map<std::string, std::uint32_t>;
Colours urdf_colours(const Element& robot);
// Reads the <color> of a <material>, else looks up its name. Returns 0 if there is neither.
std::uint32_t colour_of_material(const Element& material, const Colours& known);

}  // namespace dyn::load
