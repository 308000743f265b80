// Convex hulls as meshes with faces, and the depth of a mesh under its hull.
#include <algorithm>
#include <cstdint>

#include "mesh.hpp"
#include "mesh_module.hpp"

namespace dyn::meshes {

using namespace load;

namespace {

// Faces from the module, freed with this object.
struct ModuleHull {
  const mesh::Module& module = mesh_module();
  mesh::HullFaces faces{};
  explicit ModuleHull(const Mesh& m) {
    mesh::Failure failure{};
    if (!module.hull(m.vertices.data(), m.vertex_count(), &faces, &failure)) throw Error(failure.status, failure.message);
  }
  ModuleHull(const ModuleHull&) = delete;
  ~ModuleHull() { module.free_hull(&faces); }
};

struct HalfEdge {
  Index from, to, face;
  bool operator<(const HalfEdge& e) const { return from != e.from ? from < e.from : to < e.to; }
};
// Half edges of all faces, sorted by their start.
std::vector<HalfEdge> half_edges(const Polytope& p) {
  std::vector<HalfEdge> all;
  all.reserve(p.face_corners.size());
  for (std::size_t f = 0; f + 1 < p.face_start.size(); ++f)
    for (Index k = p.face_start[f], end = p.face_start[f + 1]; k < end; ++k)
      all.push_back(
          {p.face_corners[std::size_t(k)], p.face_corners[std::size_t(k + 1 < end ? k + 1 : p.face_start[f])], Index(f)});
  std::sort(all.begin(), all.end());
  return all;
}

// Normal of the polygon's area vector. The offset is that of the outermost corner.
void add_plane(Polytope& p, const Mesh& mesh, const Index* corners, Index n) {
  Vec3<double> area = Vec3<double>::zero();
  const Vec3<double> o = mesh.vertex(corners[0]);
  for (Index k = 1; k + 1 < n; ++k) area += cross(mesh.vertex(corners[k]) - o, mesh.vertex(corners[k + 1]) - o);
  const Vec3<double> normal = area * (1 / length(area));
  double offset = dot(normal, o);
  for (Index k = 1; k < n; ++k) offset = std::max(offset, dot(normal, mesh.vertex(corners[k])));
  p.planes.insert(p.planes.end(), {normal[0], normal[1], normal[2], offset});
}

}  // namespace

Mesh hull_of(const Mesh& from) {
  const ModuleHull hull(from);
  const mesh::HullFaces& h = hull.faces;
  Mesh out;
  for (Index c = 0; c < h.corner_count; ++c) {
    const double* v = from.vertices.data() + 3 * std::ptrdiff_t(h.corners[c]);
    out.vertices.insert(out.vertices.end(), v, v + 3);
  }
  Polytope& p = out.polytope.emplace();
  p.face_start.assign(h.face_start, h.face_start + h.face_count + 1);
  p.face_corners.assign(h.face_corners, h.face_corners + h.face_start[h.face_count]);
  for (Index f = 0; f < h.face_count; ++f) {
    const Index* corners = h.face_corners + h.face_start[f];
    const Index n = h.face_start[f + 1] - h.face_start[f];
    add_plane(p, out, corners, n);
    for (Index k = 1; k + 1 < n; ++k) out.triangles.insert(out.triangles.end(), {corners[0], corners[k], corners[k + 1]});
  }
  out.topology = topology_of(out.triangles);

  p.neighbour_start.assign(1, 0);
  for (const HalfEdge& e : half_edges(p)) {
    p.neighbours.push_back(e.to);
    p.neighbour_start.resize(std::size_t(e.from) + 2, p.neighbour_start.back());
    p.neighbour_start.back() = Index(p.neighbours.size());
  }
  for (Index c = 0; c < out.vertex_count(); ++c) {
    const Vec3<double> v = out.vertex(c);
    p.x.push_back(v[0]), p.y.push_back(v[1]), p.z.push_back(v[2]);
    p.center += v * (1.0 / out.vertex_count());
    p.extent = std::max(p.extent, length(v));
  }
  for (std::vector<double>* x : {&p.x, &p.y, &p.z})
    x->resize((x->size() + Polytope::lanes - 1) / Polytope::lanes * Polytope::lanes, x->back());
  return out;
}

// A ray from the centre along r leaves through the face f of largest n_f . r / (offset_f - n_f . centre). This is linear on the
// polar polytope, so hill climbing from face to face finds the maximum.
double depth_under(const Mesh& mesh, const Polytope& p) {
  const std::vector<HalfEdge> edges = half_edges(p);
  const std::size_t faces = p.face_start.size() - 1;
  std::vector<Index> adjacent_face(p.face_corners.size());  // the face across each edge
  for (std::size_t f = 0; f < faces; ++f)
    for (Index k = p.face_start[f], end = p.face_start[f + 1]; k < end; ++k) {
      const Index from = p.face_corners[std::size_t(k)], to = p.face_corners[std::size_t(k + 1 < end ? k + 1 : p.face_start[f])];
      adjacent_face[std::size_t(k)] = std::lower_bound(edges.begin(), edges.end(), HalfEdge{to, from, 0})->face;
    }
  std::vector<double> height(faces);  // height of each face over the centre
  for (std::size_t f = 0; f < faces; ++f) height[f] = p.planes[4 * f + 3] - dot(load3(p.planes.data() + 4 * f), p.center);

  double deepest = 0;
  std::size_t at = 0;
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3<double> r = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) * (1.0 / 3) - p.center;
    const auto ratio = [&](std::size_t f) { return dot(load3(p.planes.data() + 4 * f), r) / height[f]; };
    double most = ratio(at);
    for (bool up = true; up;) {
      up = false;
      const std::size_t here = at;
      for (Index k = p.face_start[here]; k < p.face_start[here + 1]; ++k) {
        const std::size_t f = std::size_t(adjacent_face[std::size_t(k)]);
        if (const double x = ratio(f); x > most) most = x, at = f, up = true;
      }
    }
    deepest = std::max(deepest, height[at] * (1 - most));
  }
  return deepest;
}

}  // namespace dyn::meshes
