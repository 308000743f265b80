// Shared by the wrappers of collision queries.
#pragma once

#include "checks.hpp"
#include "collision/geom.hpp"
#include "collision/pairs.hpp"

namespace dyn::capi {

void write(const collision::Result& r, dynDistance* distance);
// A shape of the caller's, placed, with what it points to.
struct PlacedShape {
  shape::Shape shape;
  collision::Pose X;
  shape::Hull hull;
  shape::TriangleTree tree;
  shape::Grid grid;

  PlacedShape() = default;
  PlacedShape(const PlacedShape&) = delete;
  PlacedShape& operator=(const PlacedShape&) = delete;
};
// A shape and a placement, checked; name: the argument's.
dynStatus read_geometry(const char* function, const char* name, const dynGeometry* g, PlacedShape& read);
dynStatus read_placement(const char* function, const char* name, const double* x, collision::Pose& out);
dynStatus check_pair(const char* function, const Model& m, int pair, int first = 0);
// So many shapes that pairs are not listed would otherwise look like none that collide.
bool listed(Call& call);
// The placements of q, within the bounds of queries.
bool placed(Call& call);
// Checks of a query: margin (m), capacity of its results, relative tolerance (0: the default).
dynStatus check_margin(const char* function, double margin);
dynStatus check_capacity(const char* function, int capacity);
dynStatus read_tolerance(const char* function, double tolerance, collision::Options& options);

dynStatus read_pair(const char* function, const dynGeometryPair& pair, PlacedShape& A, PlacedShape& B);

// The geom of one of the model's shapes; -1 and an error when it is none. Shapes from first on: -1 stands for all.
Index geom_of_shape(Call& call, int shape, int first);

}  // namespace dyn::capi
