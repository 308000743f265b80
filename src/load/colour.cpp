#include "colour.hpp"

#include <cmath>

#include "model/colour.hpp"
#include "number.hpp"

namespace dyn::load {

std::uint32_t colour_of(const Element& e) {
  const char* text = e.Attribute("rgba");
  const auto parts = split(text ? text : "");
  double rgba[4];
  if (parts.size() != 4) return 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (!parse_number(parts[i], rgba[i]).empty() || !std::isfinite(rgba[i])) return 0;
  return packed_colour(rgba);
}

std::uint32_t colour_of_material(const Element& material, const Colours& known) {
  if (const Element* color = first(material, "color")) return colour_of(*color);
  const char* name = material.Attribute("name");
  const auto found = known.find(name ? name : "");
  return found == known.end() ? 0 : found->second;
}

Colours urdf_colours(const Element& robot) {
  Colours out;
  const auto add = [&](const Element* material) {
    const char* name = material ? material->Attribute("name") : nullptr;
    if (name && first(*material, "color")) out.try_emplace(name, colour_of_material(*material, {}));
  };
  for (const Element* m = first(robot, "material"); m; m = next(*m, "material")) add(m);
  for (const Element* link = first(robot, "link"); link; link = next(*link, "link"))
    for (const Element* v = first(*link, "visual"); v; v = next(*v, "visual")) add(first(*v, "material"));
  return out;
}

}  // namespace dyn::load
