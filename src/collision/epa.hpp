// Expanding polytope algorithm (van den Bergen, Game Developers Conference 2001). Finds the boundary point of D = A - B nearest
// to the origin, for overlapping cores. The nearest face of a polytope inside D bounds the depth from below. The support point
// above that face bounds it from above. Face distances are signed, so touching shapes need no special case.
#pragma once

#include <bit>

#include "collision/descent.hpp"
#include "collision/epa_start.hpp"
#include "shape/argmax.hpp"

namespace dyn::collision {

struct EpaResult {
  Vec normal;    // outward of D
  double upper;  // upper bound of the depth, signed
  Vec a, b;      // witness points
  double residual;
  Index iterations;
  bool unique;   // no face of another direction is as near
  bool refined;  // by Newton's method, or on a flat face
};

namespace detail {

template <class D>
class Epa {
 public:
  Epa(const D& d, EpaWorkspace& w, const Options& o)
      : d_(d),
        w_(w),
        o_(o),
        rounding_(d.rounding()),
        wanted_(std::min(o.tolerance, 1e-6) * d.small + rounding_),
        tie_(1e-7 * d.small) {}

  // s: simplex near the origin.
  EpaResult run(const Simplex& s) {
    EpaResult& r = r_;
    r.upper = shape::infinity, r.residual = 0, r.iterations = 0, r.unique = true, r.refined = false;
    Vec n;
    if (!tetrahedron(s, n)) {  // D is flat: take its own normal
      const Vertex p = d_.support(n);
      r.normal = n, r.upper = dot(n, p.w), r.a = p.a, r.b = p.b;
      return r;
    }
    double apart = 0;              // gap between the best depth and the nearest open face
    double next = 0.01 * d_.small;  // gap at which refinement is tried next
    Index nearest;
    double upper = shape::infinity;  // of the depth along the nearest face's normal
    bool is_exact = false;           // the nearest of all faces is one of D
    for (;;) {
      nearest = nearest_face();
      const double offset = w_.offset[nearest];
      apart = std::min(refined_upper_, r.upper) - offset;
      if (apart <= (refined() ? tie_ : wanted_) || r.iterations == 2 * o_.max_iterations) break;
      const Vec n = w_.face[nearest].normal;
      stuck_ = stuck_ || r.iterations == o_.max_iterations;
      const bool rival = stuck_ || (minima_ > 0 && apart <= certain * d_.small);
      if (rival && refined() && is_found(n)) {
        discard(nearest);
        continue;
      }
      ++r.iterations;
      const Vertex p = d_.support(n);
      upper = dot(n, p.w);
      if (upper < r.upper) r.normal = n, r.upper = upper;
      // near convergence: refine by Newton's method, and grow the polytope if that fails
      if (D::curved && (rival || (minima_ == 0 && upper - offset <= next))) {
        next = (upper - offset) * 0.1;
        if (refine(nearest) && rival) {
          discard(nearest);
          continue;
        }
      }
      const bool exact = upper - offset <= wanted_;
      if (exact && minima_ == 0) {
        apart = upper - offset, is_exact = !stuck_;
        break;
      }
      if (exact || stuck_)
        discard(nearest);
      else
        stuck_ = !grow(nearest, p);
    }
    if constexpr (D::curved)
      if (Refined p;
          !refined() && r.upper - lower_bound() > o_.accepted * d_.small && pattern_search_refine(d_, r.normal, wanted_, p))
        record(p);
    if (refined()) {
      r.normal = refined_.normal, r.a = refined_.a, r.b = refined_.b, r.upper = refined_upper_, r.residual = refined_.residual;
      r.unique = refined_.unique, r.refined = true;
    } else {
      if (!is_exact) {
        for (Index f = 0; f < faces_; ++f) w_.offset[f] = w_.face[f].offset;
        nearest = nearest_face();
        upper = dot(w_.face[nearest].normal, d_.support(w_.face[nearest].normal).w);
      }
      // returns the lowest support value if the polytope confirms it, else that of its nearest face
      if (upper > r.upper + wanted_) {
        witness(face_along(r.normal * r.upper));
        r.residual = std::max(apart, shape::norm(r.a - r.b - r.normal * r.upper));
        if (r.residual <= upper - w_.offset[nearest]) return r;
      }
      r.normal = w_.face[nearest].normal, r.upper = upper, r.residual = upper - w_.offset[nearest];
      witness(nearest);
    }
    return r;
  }

 private:
  const D& d_;
  EpaWorkspace& w_;
  const Options& o_;
  const double rounding_, wanted_, tie_;
  EpaResult r_;
  Refined refined_{};
  double refined_upper_ = shape::infinity;
  using Block = shape::ArgmaxBlock;
  static constexpr Index lanes = shape::argmax_lanes;
  static_assert(EpaWorkspace::max_faces % lanes == 0);
  static constexpr int max_minima = 8;
  static constexpr double same = 0.999;  // cosine between directions that lead to the same minimum
  Vec minimum_[max_minima];  // directions of the minima found
  int minima_ = 0;
  bool stuck_ = false;  // the polytope cannot grow further
  Index vertices_ = 0, faces_ = 0, free_ = 0;

  static constexpr double certain = 1e-3;  // gap below which rival minima are examined, relative to the size

  bool refined() const { return refined_upper_ <= r_.upper + tie_; }

  // The first of the nearest. Offsets are infinite from faces_ to the end of its block.
  Index nearest_face() const {
    const auto block = [&](Index f) { return Block::load(w_.offset + f); };
    Block least = block(0);
    for (Index f = lanes; f < faces_; f += lanes) least = min(least, block(f));
    const Double4 l = min(slice4<0>(least), slice4<4>(least));
    const double offset = std::min(std::min(l[0], l[1]), std::min(l[2], l[3]));
    for (Index first = 0; first < faces_; first += 64) {
      std::uint64_t at = 0;  // no branch for a face: which one it is cannot be predicted
      for (Index f = first; f < std::min(first + 64, faces_); f += Double4::lanes)
        at |= std::uint64_t(bits_of(Double4::load(w_.offset + f) <= offset)) << (f - first);
      if (at) return first + Index(std::countr_zero(at));
    }
    return 0;
  }
  // Number of a new face; -1: there is no room.
  Index new_face() {
    if (free_ > 0) return w_.free[--free_];
    if (faces_ == EpaWorkspace::max_faces) return -1;
    if (faces_ % lanes == 0) std::fill_n(w_.offset + faces_, lanes, shape::infinity);
    return faces_++;
  }

  double lower_bound() const {
    double least = shape::infinity;
    for (Index f = 0; f < faces_; ++f) least = std::min(least, w_.face[f].offset);
    return least;
  }

  // Returns whether a minimum was found near this direction.
  bool is_found(const Vec& n) const {
    for (int i = 0; i < minima_; ++i)
      if (dot(n, minimum_[i]) > same) return true;
    return false;
  }
  void discard(Index f) { w_.offset[f] = shape::infinity; }

  // Refines to a local minimum of the depth: the normal of a flat face, or the result of Newton's method.
  [[gnu::noinline]] bool refine(Index f) {
    Refined p;
    const Vec n = w_.face[f].normal;
    if (on_face(d_, n, p) && !is_found(p.normal)) {
      record(p);
      if (dot(n, p.normal) > same) return true;
    }
    const Part part = nearest_part(f);
    Vertex at[3];
    for (int i = 0; i < part.size; ++i) at[i] = w_.vertex[w_.face[f].at[part.at[i]]];
    if (!newton_refine(d_, at, part.weight, part.size, n, wanted_, p)) return false;
    record(p);
    return true;
  }
  void record(Refined p) {
    if (minima_ < max_minima) minimum_[minima_++] = p.normal;
    const double less = refined_upper_ + p.distance;
    if (std::abs(less) <= tie_ && dot(p.normal, refined_.normal) < 1 - 1e-6) p.unique = refined_.unique = false;
    if (less > 0) refined_ = p, refined_upper_ = -p.distance;
  }

  // The first polytope. Returns false if D is flat; n is then its normal.
  bool tetrahedron(const Simplex& s, Vec& n) {
    if (!spanning_vertices(d_, s, 16 * rounding_, w_.vertex, n)) return false;
    vertices_ = 4;
    static constexpr Index corners[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    static constexpr Index beyond[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}};
    for (Index f = 0; f < 4; ++f) {
      new_face();
      for (int i = 0; i < 3; ++i) w_.face[f].at[i] = corners[f][i], w_.face[f].across[i] = beyond[f][i];
      plane(f, -1);
    }
    return true;
  }

  // Plane of a face. A sliver takes the plane of its neighbour.
  void plane(Index f, Index neighbour) {
    EpaFace& F = w_.face[f];
    const Vec a = w_.vertex[F.at[0]].w, b = w_.vertex[F.at[1]].w, c = w_.vertex[F.at[2]].w, n = triangle_normal(a, b, c);
    const double nn = dot(n, n);
    if (neighbour >= 0 && nn <= 1e-28 * dot(b - a, b - a) * dot(c - a, c - a)) {
      F.normal = w_.face[neighbour].normal, F.offset = w_.face[neighbour].offset;
    } else {
      F.normal = n * (1 / std::sqrt(nn));
      F.offset = dot(F.normal, a);
    }
    w_.offset[f] = F.offset;
  }

  // Replaces the faces that p sees by a cone from their horizon to p. Returns false without a valid horizon or free face.
  bool grow(Index seen, const Vertex& p) {
    if (vertices_ == EpaWorkspace::max_vertices) return false;
    auto sees = [&](Index f) { return dot(w_.face[f].normal, p.w) - w_.face[f].offset > -rounding_; };
    Index depth = 0, visible = 0, horizon = 0;
    auto remove = [&](Index f) {
      w_.offset[f] = w_.face[f].offset = shape::infinity, w_.visible[visible++] = f, w_.stack[depth++] = f;
    };
    const Index top = vertices_++;
    w_.vertex[top] = p;
    for (Index v = 0; v < top; ++v) w_.from[v] = -1;
    remove(seen);
    Index last = -1;
    while (depth > 0) {
      const Index f = w_.stack[--depth];
      for (int i = 0; i < 3; ++i) {
        const Index g = w_.face[f].across[i];
        if (w_.face[g].removed()) continue;
        if (sees(g)) {
          remove(g);
          continue;
        }
        // an edge of the horizon: add a face from it to p
        const Index a = w_.face[f].at[i], b = w_.face[f].at[i == 2 ? 0 : i + 1];
        const Index n = new_face();
        if (n < 0 || w_.from[a] >= 0) return false;
        EpaFace& F = w_.face[n];
        F.at[0] = a, F.at[1] = b, F.at[2] = top;
        F.across[0] = g;
        EpaFace& G = w_.face[g];
        const int j = G.at[0] == b ? 0 : G.at[1] == b ? 1 : 2;  // its edge back from b to a
        if (G.across[j] == f && G.at[j] == b) G.across[j] = n;
        w_.from[a] = n;
        plane(n, g);
        last = n, ++horizon;
      }
    }
    if (last < 0) return false;
    // link the cone: the face from a to b precedes the one that begins at b
    Index f = last;
    do {
      const Index next = w_.from[w_.face[f].at[1]];
      if (next < 0) return false;
      w_.face[f].across[1] = next, w_.face[next].across[2] = f;
      f = next;
    } while (f != last && --horizon > 0);
    if (horizon != 1) return false;
    for (Index i = 0; i < visible; ++i) w_.free[free_++] = w_.visible[i];
    return true;
  }

  Part nearest_part(Index f, const Vec& to = Vec::zero()) const {
    const Index* at = w_.face[f].at;
    return nearest_on_triangle(w_.vertex[at[0]].w - to, w_.vertex[at[1]].w - to, w_.vertex[at[2]].w - to);
  }
  // Face nearest to a boundary point of D, for when another face as near to the origin has another normal.
  Index face_along(const Vec& p) const {
    Index best = 0;
    double least = shape::infinity;
    for (Index f = 0; f < faces_; ++f) {
      if (w_.face[f].removed()) continue;
      const double distance = nearest_part(f, p).vv;
      if (distance < least) least = distance, best = f;
    }
    return best;
  }

  // Sets the witness points from the face nearest to the origin. Clears `unique` if other faces are as near.
  void witness(Index f) {
    // of coplanar triangles take the one that holds the projection of the origin
    const double offset = w_.face[f].offset;
    const Vec foot = r_.normal * offset;
    Part nearest = nearest_part(f, foot);
    for (Index g = 0; g < faces_; ++g) {
      if (w_.offset[g] > offset + tie_) continue;
      if (dot(w_.face[g].normal, r_.normal) < 1 - 1e-12) {
        r_.unique = r_.unique && dot(w_.face[g].normal, r_.normal) > 1 - 1e-6;
      } else if (w_.offset[g] <= offset + 4 * rounding_) {
        const Part other = nearest_part(g, foot);
        if (other.vv < nearest.vv) nearest = other, f = g;
      }
    }
    r_.a = r_.b = Vec::zero();
    for (int i = 0; i < nearest.size; ++i) {
      const Vertex& x = w_.vertex[w_.face[f].at[nearest.at[i]]];
      r_.a += x.a * nearest.weight[i], r_.b += x.b * nearest.weight[i];
    }
    // a curved rim of a flat face reaches beyond its triangles, and the foot may lie there
    if (shape::norm(r_.a - r_.b - foot) <= 1e-7 * offset + 8 * rounding_) return;
    Refined p;
    if (on_face(d_, r_.normal, p) && dot(p.normal, r_.normal) > 1 - 1e-12)
      r_.a = p.a, r_.b = p.b;
    else
      r_.unique = false;
  }
};

}  // namespace detail

template <class D>
[[gnu::noinline]] inline EpaResult epa(const D& difference, const Simplex& s, EpaWorkspace& workspace, const Options& options) {
  return detail::Epa<D>(difference, workspace, options).run(s);
}

}  // namespace dyn::collision
