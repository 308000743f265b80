// Shapes in robot files, as src/shape describes them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "shape/geometry.hpp"

namespace dyn::load {

enum class RobotFormat { Mjcf, Urdf };

struct ShapeForm : shape::FileForm {
  dynShapeType type;
  std::size_t sizes;
};

// f(form) for each shape that the format has.
template <class F>
void each_shape_form(RobotFormat format, F&& f) {
  shape::each_shape([&]<class S>() {
    const ShapeForm form = {format == RobotFormat::Mjcf ? S::mjcf : S::urdf, S::id, S::size_names.size()};
    if (form.name) f(form);
  });
}

// Returns nullopt if the format lacks the shape.
inline std::optional<ShapeForm> shape_form(RobotFormat format, dynShapeType type) {
  std::optional<ShapeForm> found;
  each_shape_form(format, [&](const ShapeForm& form) {
    if (form.type == type) found = form;
  });
  return found;
}
inline std::optional<ShapeForm> shape_form(RobotFormat format, std::string_view name) {
  std::optional<ShapeForm> found;
  each_shape_form(format, [&](const ShapeForm& form) {
    if (form.name == name) found = form;
  });
  return found;
}

// "box, sphere, capsule", for messages.
inline std::string shape_names(RobotFormat format) {
  std::string names;
  each_shape_form(format, [&](const ShapeForm& form) { names += (names.empty() ? "" : ", ") + std::string(form.name); });
  return names;
}

}  // namespace dyn::load
