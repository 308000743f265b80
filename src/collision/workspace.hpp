// Scratch of a query as plain values: the polytope of EPA (epa.hpp).
#pragma once

#include "shape/shape.hpp"

namespace dyn::collision {

using shape::Vec;

// A point of D = A - B and the points of the two cores that it comes from.
struct Vertex {
  Vec w, a, b;  // w = a - b
};

// A triangle, counter-clockwise seen from outside. across[i]: the face beyond the edge from vertex i to the next.
struct EpaFace {
  Vec normal;
  double offset;  // normal.x of its plane; infinite: removed
  Index at[3], across[3];

  bool removed() const { return offset == shape::infinity; }
};

struct EpaWorkspace {
  static constexpr Index max_vertices = 160, max_faces = 2 * max_vertices;
  Vertex vertex[max_vertices];
  EpaFace face[max_faces];
  double offset[max_faces];    // of faces still to be searched; others: infinite
  Index free[max_faces];       // indices of removed faces
  Index stack[max_faces], visible[max_faces];
  Index from[max_vertices];    // the new face that begins at a vertex of the horizon
};

using Workspace = EpaWorkspace;

}  // namespace dyn::collision
