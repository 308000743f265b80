// What the wrappers of collision queries share.
#pragma once

#include "checks.hpp"
#include "collision/geom.hpp"
#include "collision/pairs.hpp"

namespace dyn::capi {

void fill(const collision::Result& r, dynDistance* out);
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
// A margin of a query in metres, room for its answers, a relative tolerance (0: the default).
dynStatus check_margin(const char* function, double margin);
dynStatus check_capacity(const char* function, int capacity);
dynStatus read_tolerance(const char* function, double tolerance, collision::Options& options);

dynStatus read_pair(const char* function, const dynGeometry* a, const double* placement_a, const dynGeometry* b, const double* placement_b,
                    PlacedShape& A, PlacedShape& B);

// The geom of one of the model's shapes; -1 and an error when it is none. Shapes from first on: -1 stands for all.
Index geom_of_shape(Call& call, int shape, int first);

// A structure that answers are written into.
template <class T>
dynStatus check_out(const char* function, const char* type, const T* out) {
  if (!out) return fail(DYN_ERROR_ARGUMENT, "%s: out is NULL: it is required", function);
  if (out->struct_size < sizeof(T)) return fail(DYN_ERROR_SIZE, "%s: struct_size is %u, needs %zu: set it to sizeof(%s)", function, out->struct_size, sizeof(T), type);
  return DYN_OK;
}

}  // namespace dyn::capi
