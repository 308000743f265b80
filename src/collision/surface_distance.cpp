// Pieces of surfaces are convex shapes. Searches both trees for the nearest two. Lower bounds of two nodes come from separating
// planes: those of their boxes and slabs, and those across the best normal so far.
#include "collision/surface_distance.hpp"

#include "shape/list.hpp"
#include "surface_face.hpp"

namespace dyn::collision {
namespace {

using namespace shape;

// Alternating projection of points. Gives an upper bound of the distance and a first direction.
template <class S, class B>
void guess(const S& a, const B& b, const Pose& X, NearestPair& nearest, Vec& n) {
  Vec p = X.p;
  double least = infinity;
  for (int i = 0; i < 2; ++i) {
    const Vec on_a = a.nearest(p).point;
    const Nearest on_b = b.nearest(X.act_inverse(on_a));
    p = X.act(on_b.point);
    const double d = std::max(on_b.distance, 0.0), apart = norm(p - on_a);
    if (apart > 0 && d > 0 && d < least) n = (p - on_a) * (1 / apart);  // of shapes that touch, rounding may leave nothing
    if (!(d < 0.9 * least)) break;
    least = d;
  }
  nearest.limit = least - a.radius - b.radius + nearest.tie;
}

void set_status(Result& r, double size, const Options& o) {
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
// A shape inside a closed surface touches no triangle. `point` is a point of B that shows it. The separating plane is that of the
// nearest triangle, and along(-n) is B's support point beyond it. The depth is at least the point's.
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
  set_status(r, std::min(size_of(a), b.radius), o);
  return r;
}

// parted: pose after a translation that is being verified
template <class S, class B>
Result with_convex(const S& a, const Shape& shape_b, const B& b, const Pose& X, Workspace& w, const Options& o,
                   bool parted = false) {
  constexpr bool flat = B::type == Type::HalfSpace;
  const double size = std::min(size_of(a), size_of(b));
  NearestPair nearest(size);
  double least_skipped = infinity;  // lower bound of the distances of the pieces that are skipped
  // no point of B lies below `level` along n
  Bounds box{};
  Vec n = -X.R.z;
  double level = dot(n, X.p) - b.radius;
  auto look_along = [&](const Vec& normal) {
    if constexpr (!flat) n = normal, level = dot(n, farthest(b, X, -n));
  };
  if constexpr (!flat) {
    box = b.bounds(X);
    Vec first = axis(2);
    guess(a, b, X, nearest, first);
    look_along(first);
  }
  const bool limited = o.max_distance < nearest.limit;  // pieces beyond it are not searched
  if (limited) nearest.limit = o.max_distance;
  const auto skips = [&](double least) {
    if (least > nearest.limit) least_skipped = std::min(least_skipped, least);
    return least;
  };
  // lower bound by planes across m. up, down: support heights of the node along m and -m
  const Vec center = middle(box);
  auto beyond = [&](const Vec& m, double up, double down = infinity) {
    double least = -infinity;
    if constexpr (!flat) {
      least = dot(m, farthest(b, X, -m)) - up;
      if (down < infinity) least = std::max(least, -dot(m, farthest(b, X, m)) - down);
    }
    return least;
  };
  auto lower = [&](const auto& node) {
    const Bounds of = a.box(node);
    const Slab slab = a.slab(node);
    double least = level - support_height(of, slab, n);
    if constexpr (!flat) {
      least = std::max(least, distance_between(of, box));
      if (least - a.radius <= nearest.limit) {
        const Vec across = toward(middle(of), center);
        least = std::max(least, beyond(across, support_height(of, slab, across)));
      }
      if (least - a.radius <= nearest.limit) least = std::max(least, beyond(slab.normal, slab.high, -slab.low));
    }
    return skips(least - a.radius);
  };
  auto lower_of_piece = [&](const Corners& f) {
    double least = level - f.support_height(n);
    if constexpr (!flat) {
      if (least - a.radius <= nearest.limit) least = std::max(least, distance_between(f.box, box));
      const Vec across = toward(f.center, center), m = f.normal;
      if (least - a.radius <= nearest.limit) least = std::max(least, beyond(across, f.support_height(across)));
      if (least - a.radius <= nearest.limit) least = std::max(least, beyond(m, f.support_height(m), f.support_height(-m)));
    }
    return skips(least - a.radius);
  };
  Facet piece;
  auto leaf = [&](auto node) {
    for (Index i = 0, count = a.pieces(node); i < count; ++i) {
      a.piece(node, i, piece);
      if (!(lower_of_piece({piece, Pose::identity()}) <= nearest.limit)) continue;
      const Result r = distance(piece.shape(a.radius), {Mat::identity(), piece.origin}, shape_b, X, w, o);
      skips(r.distance - r.residual);
      if (nearest.consider(r)) look_along(r.normal);
    }
  };
  search(a, nearest.limit, lower, leaf);
  if (limited && !(nearest.best.distance < infinity) && least_skipped < infinity) {
    Result beyond{};
    beyond.distance = least_skipped, beyond.normal = n, beyond.status = Status::Separated;
    return beyond;
  }
  if (nearest.nothing()) search(a, nearest.limit, lower, leaf);
  Result r = nearest.best;
  Vec inner = X.p;
  if constexpr (B::type == Type::Convex) inner = X.act(b.hull.center);
  if constexpr (!flat)
    if (r.distance < 0 && !parted) {
      const FaceAbove face = face_above(a, b, X, inner, box);
      const bool longer = face.depth < infinity && face.depth > -r.distance && dot(face.normal, r.normal) < 1 - 1e-9;
      // the overlap left after the translation decides
      auto left = [&](const Vec& way) { return -with_convex(a, shape_b, b, Pose{X.R, X.p + way}, w, o, true).distance; };
      const bool tie = face.depth <= -1.001 * r.distance;
      if (longer && stays_below(a, face, r) && (tie || left(r.normal * -r.distance) > 1e-9 * size) &&
          left(face.normal * face.depth) <= o.accepted * size) {
        r.normal = face.normal, r.distance = -face.depth, r.residual = 0;
        r.point_b = face.lowest, r.point_a = face.lowest + face.normal * face.depth;
      }
    }
  set_status(r, size, o);
  if constexpr (!flat) {
    enclosed(a, Pose::identity(), inner, r, [&](const Vec& d) { return farthest(b, X, d); });
  }
  return r;
}

// Descends both trees at once. Splits the node with the larger box.
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
  Entry stack[S::max_stack + T::max_stack];
  Index depth = 0;
  Vec n = axis(2);
  guess(a, b, X, nearest, n);
  // gap along m, a direction of A, between a part of A of height `up` and a part of B
  auto between = [&](const Vec& m, double up, auto&& support_height_b) {
    return dot(m, X.p) - support_height_b(transpose_times(X.R, -m)) - up;
  };
  auto lower = [&](const typename S::Node& i, const typename T::Node& j, const Bounds& x, const Bounds& y) {
    const double rounding = a.radius + b.radius;
    double least = distance_between(x, y) - rounding;
    if (!(least <= nearest.limit)) return least;
    const Slab p = a.slab(i), q = b.slab(j);
    const Bounds in_b = b.box(j);
    auto support_height_b = [&](const Vec& m) { return support_height(in_b, q, m); };
    auto consider = [&](const Vec& m, double up) { least = std::max(least, between(m, up, support_height_b) - rounding); };
    consider(n, support_height(x, p, n));
    const Vec across = toward(middle(x), middle(y));
    if (least <= nearest.limit) consider(across, support_height(x, p, across));
    if (least <= nearest.limit) consider(p.normal, p.high), consider(-p.normal, -p.low);
    const Vec m = X.R * q.normal;
    if (least <= nearest.limit) consider(m, support_height(x, p, m)), consider(-m, support_height(x, p, -m));
    return least;
  };
  auto lower_of_pieces = [&](const Corners& p, const Corners& q) {
    const double rounding = a.radius + b.radius;
    double least = -infinity;
    auto consider = [&](const Vec& m) { least = std::max(least, -q.support_height(-m) - p.support_height(m) - rounding); };
    consider(n);
    if (least <= nearest.limit) consider(toward(p.center, q.center));
    if (least <= nearest.limit) consider(p.normal), consider(-p.normal);
    if (least <= nearest.limit) consider(q.normal), consider(-q.normal);
    if (least <= nearest.limit) least = std::max(least, distance_between(p.box, q.box) - rounding);
    return least;
  };
  auto push = [&](const typename S::Node& i, const typename T::Node& j, const Bounds& x, const Bounds& y, Index first) {
    const Entry e = {i, j, x, y, lower(i, j, x, y)};
    if (!(e.lower <= nearest.limit)) return;
    Index at = depth++;
    for (; at > first && stack[at - 1].lower < e.lower; --at) stack[at] = stack[at - 1];
    stack[at] = e;
  };
  Facet p, q[max_pieces];
  auto leaves = [&](const Entry& e) {
    const Index count_a = a.pieces(e.a), count_b = b.pieces(e.b);
    Corners of_q[max_pieces];
    for (Index j = 0; j < count_b; ++j) b.piece(e.b, j, q[j]), of_q[j] = Corners(q[j], X);
    for (Index i = 0; i < count_a; ++i) {
      a.piece(e.a, i, p);
      const Corners of_p(p, Pose::identity());
      for (Index j = 0; j < count_b; ++j) {
        if (!(lower_of_pieces(of_p, of_q[j]) <= nearest.limit)) continue;
        const Result r =
            distance(p.shape(a.radius), {Mat::identity(), p.origin}, q[j].shape(b.radius), {X.R, of_q[j].center}, w, o);
        if (nearest.consider(r)) n = r.normal;
      }
    }
  };
  auto descend = [&] {
    push(S::root(a), T::root(b), a.box(S::root(a)), transformed(b.box(T::root(b)), X), 0);
    while (depth > 0) {
      const Entry e = stack[--depth];
      if (!(e.lower <= nearest.limit)) continue;
      typename S::Node of_a[S::max_children];
      typename T::Node of_b[T::max_children];
      const Index in_a = a.split(e.a, of_a), in_b = b.split(e.b, of_b), first = depth;
      if (in_a == 0 && in_b == 0)
        leaves(e);
      else if (in_a > 0 && (in_b == 0 || largest(half_of(e.box_a)) >= largest(half_of(e.box_b))))
        for (Index i = 0; i < in_a; ++i) push(of_a[i], e.b, a.box(of_a[i]), e.box_b, first);
      else
        for (Index i = 0; i < in_b; ++i) push(e.a, of_b[i], e.box_a, transformed(b.box(of_b[i]), X), first);
    }
  };
  descend();
  if (nearest.nothing()) descend();
  Result r = nearest.best;
  set_status(r, size, o);
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

Result surface_distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, Workspace& workspace,
                        const Options& options) {
  const bool exchanged = !is_surface(a.type);
  const Pose &X_W1 = exchanged ? X_WB : X_WA, &X_W2 = exchanged ? X_WA : X_WB;
  const Mat Rt = transpose(X_W1.R);
  const Pose X = {Rt * X_W2.R, Rt * (X_W2.p - X_W1.p)};
  Result r{};
  visit(exchanged ? b : a, [&]<class S>(const S& s) {
    if constexpr (is_surface(S::type)) {
      Options o = options;
      // of a closed mesh, the nearest triangle tells how deep a shape lies inside
      if (S::type == Type::Triangles && s.closed()) o.max_distance = infinity;
      if (is_surface((exchanged ? a : b).type)) o.max_distance = infinity;
      r = with_any(s, exchanged ? a : b, X, workspace, o);
    }
  });
  r.normal = X_W1.R * r.normal, r.point_a = X_W1.act(r.point_a), r.point_b = X_W1.act(r.point_b);
  if (exchanged) exchange(r);
  return r;
}

}  // namespace dyn::collision
