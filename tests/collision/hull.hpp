// Hull of few points by testing every plane through three of them, in the arrays of shape::Hull.
#pragma once

#include <vector>

#include "shape/convex.hpp"

namespace dyn_test {

using dyn::Index;
using dyn::shape::Hull;
using dyn::shape::Vec;

struct HullData {
  std::vector<double> x, y, z, planes;
  std::vector<Index> face_start, face_vertices, neighbour_start, neighbours, vertex_faces;
  Hull hull{};

  HullData(const HullData&) = delete;
  HullData& operator=(const HullData&) = delete;

  explicit HullData(const std::vector<Vec>& points) {
    const Index n = Index(points.size());
    double size = 0;
    for (const Vec& p : points) size = std::max(size, dyn::shape::norm(p));
    std::vector<std::vector<Index>> faces;
    for (Index i = 0; i < n; ++i)
      for (Index j = i + 1; j < n; ++j)
        for (Index k = j + 1; k < n; ++k) try_face(points, i, j, k, size * 1e-12, faces);
    // vertices on a face
    std::vector<Index> number(points.size(), -1), kept;
    for (auto& f : faces)
      for (Index v : f)
        if (number[std::size_t(v)] < 0) number[std::size_t(v)] = Index(kept.size()), kept.push_back(v);
    Vec sum = Vec::zero();
    for (Index v : kept) {
      const Vec& p = points[std::size_t(v)];
      x.push_back(p[0]), y.push_back(p[1]), z.push_back(p[2]), sum += p;
      hull.extent = std::max(hull.extent, dyn::shape::norm(p));
    }
    hull.vertices = Index(kept.size()), hull.faces = Index(faces.size());
    hull.center = sum * (1.0 / hull.vertices);
    while (x.size() < std::size_t(Hull::padded(hull.vertices)))
      x.push_back(x.back()), y.push_back(y.back()), z.push_back(z.back());
    std::vector<std::vector<Index>> next(kept.size());
    face_start.push_back(0);
    for (auto& f : faces) {
      for (std::size_t i = 0; i < f.size(); ++i) {
        const Index a = number[std::size_t(f[i])], b = number[std::size_t(f[(i + 1) % f.size()])];
        face_vertices.push_back(a);
        next[std::size_t(a)].push_back(b);
      }
      face_start.push_back(Index(face_vertices.size()));
    }
    neighbour_start.push_back(0);
    for (auto& list : next) {
      neighbours.insert(neighbours.end(), list.begin(), list.end());
      neighbour_start.push_back(Index(neighbours.size()));
    }
    hull.x = x.data(), hull.y = y.data(), hull.z = z.data(), hull.planes = planes.data();
    hull.face_start = face_start.data(), hull.face_vertices = face_vertices.data();
    hull.neighbour_start = neighbour_start.data(), hull.neighbours = neighbours.data();
    hull.corners = Index(neighbours.size());
    vertex_faces.resize(neighbours.size());
    if (!dyn::shape::list_vertex_faces(hull, vertex_faces.data())) vertex_faces.clear();
  }

 private:
  void try_face(const std::vector<Vec>& p, Index i, Index j, Index k, double eps, std::vector<std::vector<Index>>& faces) {
    const Vec a = p[std::size_t(i)];
    Vec n = cross(p[std::size_t(j)] - a, p[std::size_t(k)] - a);
    if (dyn::shape::norm(n) <= eps * eps) return;
    n = n * (1 / dyn::shape::norm(n));
    bool above = false, below = false;
    std::vector<Index> on;
    for (std::size_t l = 0; l < p.size(); ++l) {
      const double h = dot(n, p[l] - a);
      above |= h > eps, below |= h < -eps;
      if (std::abs(h) <= eps) on.push_back(Index(l));
    }
    if (above && below) return;
    if (on[0] != i || on[1] != j || on[2] != k) return;  // the same face from another triple
    if (above) n = -n;
    // counter-clockwise about the mean
    Vec c = Vec::zero();
    for (Index l : on) c += p[std::size_t(l)] * (1.0 / double(on.size()));
    const Vec u = p[std::size_t(i)] - c, v = cross(n, u);
    auto angle = [&](Index l) { return std::atan2(dot(p[std::size_t(l)] - c, v), dot(p[std::size_t(l)] - c, u)); };
    std::sort(on.begin(), on.end(), [&](Index l, Index m) { return angle(l) < angle(m); });
    faces.push_back(on);
    planes.insert(planes.end(), {n[0], n[1], n[2], dot(n, a)});
  }
};

}  // namespace dyn_test
