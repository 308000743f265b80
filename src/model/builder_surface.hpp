// Hulls, triangle trees and grids on their way into a model.
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "dyn.h"
#include "model/stored.hpp"
#include "shape/height_field.hpp"
#include "shape/triangles.hpp"

namespace dyn {

// A header without pointers and its arrays, as in a model.
template <class T>
struct Held {
  T header{};
  std::vector<double> numbers;
  std::vector<Index> indices;

  // Takes the arrays that a header points to.
  explicit Held(const T& from) : header(from) {
    header.each_array([&]<class X>(const X*& array, std::size_t n) {
      if constexpr (std::is_same_v<X, double>) {
        numbers.insert(numbers.end(), array, array + n);
        numbers.resize(pool_capacity(numbers.size()));
      } else {
        indices.insert(indices.end(), array, array + n);
      }
      array = nullptr;
    });
  }
  T view() const { return dyn::view(header, numbers.data(), indices.data()); }
};

inline constexpr std::int64_t max_heights = shape::Grid::max_heights;

struct SurfaceData {
  std::variant<Held<shape::Hull>, Held<shape::TriangleTree>, Held<shape::Grid>> held;
};
using SurfacePtr = std::shared_ptr<const SurfaceData>;

struct Model;
// What a shape of a model is made of, taken from it; nullptr: nothing.
SurfacePtr surface_of(const Model& m, Index shape);
// Which type of shape it is.
dynShapeType type_of(const SurfaceData& surface);

// vertices: 3 each, triangles: 3 indices each, not empty; closed: they bound a solid
SurfacePtr triangle_tree(const std::vector<double>& vertices, const std::vector<Index>& triangles, bool closed);
// heights: columns * rows, row after row; both at least 2. Throws, naming what is wrong.
SurfacePtr height_grid(const double* heights, Index columns, Index rows, double step_x, double step_y, double bottom);

}  // namespace dyn
