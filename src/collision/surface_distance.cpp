// Pieces of surfaces are convex shapes: a search through the trees for the nearest two. What lies below two nodes is no nearer than any
// two planes between them: those of their boxes and slabs, and those across the normal of the best pair so far.
#include "dyn/collision/surface_distance.hpp"

#include "dyn/shape/list.hpp"

namespace dyn::collision {
namespace {

using namespace shape;

// The nearest pair of pieces so far.
struct NearestPair {
  Result best{};
  double limit = infinity;  // pairs farther apart don't matter
  double tie, same;         // distances are equal within tie, points within same

  explicit NearestPair(double size) : tie(1e-9 * size), same(1e-5 * size) { best.distance = infinity, best.unique = true; }

  // true: it is the new one
  bool consider(const Result& r) {
    best.iterations += r.iterations;
    if (!(r.distance <= limit)) return false;
    const bool better = r.distance < best.distance, tied = std::abs(r.distance - best.distance) <= tie;
    const bool other = tied && (norm(r.point_a - best.point_a) > same || norm(r.normal - best.normal) > 1e-5);
    const bool unique = (r.unique || !(better || tied)) && (best.unique || !tied) && !other;
    if (better) {
      const Index iterations = best.iterations;
      best = r, best.iterations = iterations, limit = r.distance + tie;
    }
    best.unique = better || tied ? unique : best.unique;
    return better;
  }
};

void judge(Result& r, double size, const Options& o) {
  const double touching = o.touching * size;
  r.status = !(r.residual <= o.accepted * size) ? Status::Failed
             : r.distance > touching            ? Status::Separated
             : r.distance >= -touching          ? Status::Touching
                                                : Status::Penetrating;
}
void exchange(Result& r) { r.normal = -r.normal, std::swap(r.point_a, r.point_b); }

template <class S>
double size_of(const S& s) {
  return s.extent() + s.radius;
}
// A box in another frame.
Bounds turned(const Bounds& b, const Pose& X) {
  const Vec c = X.act(middle(b)), h = half_of(b), r = sizes(X.R.x) * h[0] + sizes(X.R.y) * h[1] + sizes(X.R.z) * h[2];
  return {c - r, c + r};
}
Bounds box_of(const Facet& f, const Pose& X) {
  Bounds b = {X.act(f.corner(0)), X.act(f.corner(0))};
  for (int k = 1; k < f.hull.vertices; ++k) {
    const Vec p = X.act(f.corner(k));
    b = {lesser(b.lower, p), greater(b.upper, p)};
  }
  return b;
}
// How far a piece reaches along n, and the plane of its triangle.
double reach(const Facet& f, const Vec& n) {
  double most = dot(n, f.hull.vertex(0));
  for (int k = 1; k < f.hull.vertices; ++k) most = std::max(most, dot(n, f.hull.vertex(k)));
  return most + dot(n, f.origin);
}

// The point of a shape farthest along n, both in the frame that X leads to.
template <class B>
Vec farthest(const B& b, const Pose& X, const Vec& n) {
  return X.act(b.support(transpose_times(X.R, n))) + n * b.radius;
}

// What touches no triangle of a closed surface may lie inside of it, as `point` tells, a point of B. It is parted by the plane of the
// nearest triangle, beyond which B reaches as far as along(-n). The depth is at least the point's.
template <class S, class Along>
bool enclosed(const S& a, const Pose& X, const Vec& point, Result& r, Along&& along) {
  if (!a.closed() || !(r.distance > 0) || !a.inside(X.act_inverse(point))) return false;
  const double least = norm(point - r.point_a);
  r.normal = -r.normal, r.point_b = along(-r.normal);
  r.distance = dot(r.normal, r.point_b - r.point_a);
  r.point_a = r.point_b - r.normal * r.distance;
  r.residual = std::max(0.0, -r.distance - least);
  r.unique = false, r.status = Status::Penetrating;
  return true;
}

template <class S>
Result with_sphere(const S& a, const Sphere& b, const Pose& X, const Options& o) {
  const Nearest n = a.signed_distance(X.p);
  Result r{};
  r.unique = n.unique, r.distance = n.distance - b.radius, r.normal = n.normal;
  r.point_a = n.point, r.point_b = X.p - n.normal * b.radius;
  judge(r, std::min(size_of(a), b.radius), o);
  return r;
}

template <class S, class B>
Result with_convex(const S& a, const Shape& shape_b, const B& b, const Pose& X, Workspace& w, const Options& o) {
  constexpr bool flat = B::type == Type::HalfSpace;
  const double size = std::min(size_of(a), size_of(b));
  NearestPair nearest(size);
  // nothing of B lies below `level` along n
  Bounds box{};
  Vec n = -X.R.z;
  double level = dot(n, X.p) - b.radius;
  auto look_along = [&](const Vec& normal) {
    if constexpr (!flat) n = normal, level = dot(n, farthest(b, X, -n));
  };
  if constexpr (!flat) {
    box = b.bounds(X);
    const Vec between = middle(box) - middle(a.box(S::root(a)));
    look_along(dot(between, between) > 0 ? between * (1 / norm(between)) : axis(2));
  }
  // the planes across m: how far B is beyond what reaches up and down along it
  auto beyond = [&](const Vec& m, double up, double down) {
    if constexpr (flat) return -infinity;
    else return std::max(dot(m, farthest(b, X, -m)) - up, -dot(m, farthest(b, X, m)) - down);
  };
  auto lower = [&](const auto& node) {
    const Bounds of = a.box(node);
    const Slab slab = a.slab(node);
    double least = level - reach(of, slab, n);
    if constexpr (!flat) {
      least = std::max(least, distance_between(of, box));
      if (least - a.radius <= nearest.limit) least = std::max(least, beyond(slab.normal, slab.high, -slab.low));
    }
    return least - a.radius;
  };
  auto lower_of_piece = [&](const Facet& f) {
    double least = level - reach(f, n);
    if constexpr (!flat) {
      if (least - a.radius <= nearest.limit) least = std::max(least, distance_between(box_of(f, Pose::identity()), box));
      const Vec m = f.hull.normal(0);
      if (least - a.radius <= nearest.limit) least = std::max(least, beyond(m, reach(f, m), reach(f, -m)));
    }
    return least - a.radius;
  };
  Facet piece;
  search(a, nearest.limit, lower, [&](auto node) {
    for (Index i = 0, count = a.pieces(node); i < count; ++i) {
      a.piece(node, i, piece);
      if (!(lower_of_piece(piece) <= nearest.limit)) continue;
      const Result r = distance(piece.shape(a.radius), {Mat::identity(), piece.origin}, shape_b, X, w, o);
      if (nearest.consider(r)) look_along(r.normal);
    }
  });
  Result r = nearest.best;
  judge(r, size, o);
  if constexpr (!flat) {
    Vec inner = X.p;
    if constexpr (B::type == Type::Convex) inner = X.act(b.hull.center);
    enclosed(a, Pose::identity(), inner, r, [&](const Vec& d) { return farthest(b, X, d); });
  }
  return r;
}

// Two trees at once: the node of the larger box is split.
template <class S, class T>
Result surfaces(const S& a, const T& b, const Pose& X, Workspace& w, const Options& o) {
  const double size = std::min(size_of(a), size_of(b));
  NearestPair nearest(size);
  struct Entry {
    typename S::Node a;
    typename T::Node b;
    Bounds box_a, box_b;  // in the frame of A
    double lower;
  };
  Entry stack[S::most_stack + T::most_stack];
  Index depth = 0;
  Vec n = axis(2);
  // along m, a direction of A: from what reaches so far in A to the part of B that `along` bounds
  auto between = [&](const Vec& m, double up, auto&& reach_b) { return dot(m, X.p) - reach_b(transpose_times(X.R, -m)) - up; };
  auto lower = [&](const typename S::Node& i, const typename T::Node& j, const Bounds& x, const Bounds& y) {
    const double rounding = a.radius + b.radius;
    double least = distance_between(x, y) - rounding;
    if (!(least <= nearest.limit)) return least;
    const Slab p = a.slab(i), q = b.slab(j);
    const Bounds in_b = b.box(j);
    auto reach_b = [&](const Vec& m) { return reach(in_b, q, m); };
    auto consider = [&](const Vec& m, double up) { least = std::max(least, between(m, up, reach_b) - rounding); };
    consider(n, reach(x, p, n));
    if (least <= nearest.limit) consider(p.normal, p.high), consider(-p.normal, -p.low);
    const Vec m = X.R * q.normal;
    if (least <= nearest.limit) consider(m, reach(x, p, m)), consider(-m, reach(x, p, -m));
    return least;
  };
  auto lower_of_pieces = [&](const Facet& p, const Facet& q) {
    const double rounding = a.radius + b.radius;
    double least = -infinity;
    auto reach_b = [&](const Vec& m) { return reach(q, m); };
    auto consider = [&](const Vec& m) { least = std::max(least, between(m, reach(p, m), reach_b) - rounding); };
    consider(n);
    const Vec m = p.hull.normal(0), k = X.R * q.hull.normal(0);
    if (least <= nearest.limit) consider(m), consider(-m);
    if (least <= nearest.limit) consider(k), consider(-k);
    if (least <= nearest.limit) least = std::max(least, distance_between(box_of(p, Pose::identity()), box_of(q, X)) - rounding);
    return least;
  };
  auto push = [&](const typename S::Node& i, const typename T::Node& j, const Bounds& x, const Bounds& y, Index first) {
    const Entry e = {i, j, x, y, lower(i, j, x, y)};
    if (!(e.lower <= nearest.limit)) return;
    Index at = depth++;
    for (; at > first && stack[at - 1].lower < e.lower; --at) stack[at] = stack[at - 1];
    stack[at] = e;
  };
  Facet p, q;
  auto leaves = [&](const Entry& e) {
    for (Index i = 0, m = a.pieces(e.a); i < m; ++i) {
      a.piece(e.a, i, p);
      for (Index j = 0, k = b.pieces(e.b); j < k; ++j) {
        b.piece(e.b, j, q);
        if (!(lower_of_pieces(p, q) <= nearest.limit)) continue;
        const Result r = distance(p.shape(a.radius), {Mat::identity(), p.origin}, q.shape(b.radius), {X.R, X.act(q.origin)}, w, o);
        if (nearest.consider(r)) n = r.normal;
      }
    }
  };
  push(S::root(a), T::root(b), a.box(S::root(a)), turned(b.box(T::root(b)), X), 0);
  while (depth > 0) {
    const Entry e = stack[--depth];
    if (!(e.lower <= nearest.limit)) continue;
    typename S::Node of_a[S::most_children];
    typename T::Node of_b[T::most_children];
    const Index in_a = a.split(e.a, of_a), in_b = b.split(e.b, of_b), first = depth;
    if (in_a == 0 && in_b == 0)
      leaves(e);
    else if (in_a > 0 && (in_b == 0 || largest(half_of(e.box_a)) >= largest(half_of(e.box_b))))
      for (Index i = 0; i < in_a; ++i) push(of_a[i], e.b, a.box(of_a[i]), e.box_b, first);
    else
      for (Index i = 0; i < in_b; ++i) push(e.a, of_b[i], e.box_a, turned(b.box(of_b[i]), X), first);
  }
  Result r = nearest.best;
  judge(r, size, o);
  if (enclosed(a, Pose::identity(), farthest(b, X, n), r, [&](const Vec& d) { return farthest(b, X, d); })) return r;
  exchange(r);
  enclosed(b, X, farthest(a, Pose::identity(), n), r, [&](const Vec& d) { return farthest(a, Pose::identity(), d); });
  exchange(r);
  return r;
}

template <class S>
Result with_any(const S& a, const Shape& b, const Pose& X, Workspace& w, const Options& o) {
  Result r{};
  visit(b, [&]<class B>(const B& s) {
    if constexpr (is_surface(B::type)) r = surfaces(a, s, X, w, o);
    else if constexpr (B::type == Type::Sphere) r = with_sphere(a, s, X, o);
    else r = with_convex(a, b, s, X, w, o);
  });
  return r;
}

}  // namespace

Result surface_distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, Workspace& workspace, const Options& options) {
  const bool exchanged = !is_surface(a.type);
  const Pose &X_W1 = exchanged ? X_WB : X_WA, &X_W2 = exchanged ? X_WA : X_WB;
  const Mat Rt = transpose(X_W1.R);
  const Pose X = {Rt * X_W2.R, Rt * (X_W2.p - X_W1.p)};
  Result r{};
  visit(exchanged ? b : a, [&]<class S>(const S& s) {
    if constexpr (is_surface(S::type)) r = with_any(s, exchanged ? a : b, X, workspace, options);
  });
  r.normal = X_W1.R * r.normal, r.point_a = X_W1.act(r.point_a), r.point_b = X_W1.act(r.point_b);
  if (exchanged) exchange(r);
  return r;
}

}  // namespace dyn::collision
