#include "collision/pair_search.hpp"

#include <new>

#include "shape/list.hpp"

namespace dyn::collision {

namespace {

constexpr double fat = 0.1;  // margin of boxes over the mean bounding radius
std::ptrdiff_t pair_capacity(const Model& m) { return 1024 + 16 * std::ptrdiff_t(m.n.geoms); }
std::size_t rounded(std::size_t bytes) { return (bytes + 63) / 64 * 64; }

// f(array, count)
template <class F>
void for_each_array(const Model& m, PairSearch& s, char*& moving, char*& fixed, char*& sleeping, F&& f) {
  f(moving, std::ptrdiff_t(BroadPhase::bytes(m.n.geoms, pair_capacity(m)))),
      f(fixed, std::ptrdiff_t(BroadPhase::bytes(m.n.geoms, 1)));
  f(sleeping, std::ptrdiff_t(BroadPhase::bytes(m.n.geoms, 1)));
  f(s.moving, 1), f(s.fixed, 1), f(s.sleeping, 1);
  for (Index** list : {&s.active, &s.moving_geoms, &s.fixed_geoms, &s.unbounded_geoms}) f(*list, m.n.geoms);
  f(s.isolated, m.n.geoms), f(s.found, pair_capacity(m));
}

}  // namespace

std::size_t search_bytes(const Model& m) {
  if (!uses_pair_search(m)) return 0;
  PairSearch s;
  char *moving, *fixed, *sleeping;
  std::size_t bytes = rounded(sizeof s);
  for_each_array(m, s, moving, fixed, sleeping,
                 [&](auto* array, std::ptrdiff_t n) { bytes += rounded(std::size_t(n) * sizeof *array); });
  return bytes;
}

Bounds inflated_bounds(const Geom& g, const Pose& X, double more) {
  Bounds b{};
  if (g.shape.type == shape::Type::Convex) {  // cheaper than by all its vertices
    const shape::Shape box{shape::Type::Box, g.shape.radius, g.box_half, nullptr};
    b = shape::Box(box).bounds(Pose{X.R, X.act(g.box_center)});
  } else {
    shape::visit(g.shape, [&](const auto& s) { b = s.bounds(X); });
  }
  const double e = more + 1e-9 * (g.bounding_radius + more);  // beyond the accuracy of distances
  const auto by = shape::Vec::make(e, e, e);
  return {b.lower - by, b.upper + by};
}

void PairSearch::set_up(const Model& m, Data<double>& d) {
  char *next = d.pair_search + rounded(sizeof *this), *of_moving, *of_fixed, *of_sleeping;
  for_each_array(m, *this, of_moving, of_fixed, of_sleeping, [&](auto*& array, std::ptrdiff_t n) {
    array = reinterpret_cast<std::remove_reference_t<decltype(array)>>(next);
    next += rounded(std::size_t(n) * sizeof *array);
  });
  moving_count = fixed_count = unbounded_count = 0, capacity = pair_capacity(m);
  double sum = 0;
  for (Index k = 0; k < m.n.geoms; ++k) {
    if (!has_geometry(m, k)) continue;
    const Geom& g = d.geoms[k];
    if (!(g.bounding_radius < shape::infinity)) unbounded_geoms[unbounded_count++] = k;
    else if (g.body == 0) fixed_geoms[fixed_count++] = k;
    else moving_geoms[moving_count++] = k, sum += g.bounding_radius;
  }
  new (moving) BroadPhase(m.n.geoms, capacity, moving_count ? fat * sum / moving_count : 0, of_moving);
  new (fixed) BroadPhase(m.n.geoms, 1, 0, of_fixed);
  for (Index k = 0; k < fixed_count; ++k) {
    const Geom& g = d.geoms[fixed_geoms[k]];
    d.geom_poses[fixed_geoms[k]] = SE3<double>{d.R[0], d.p[0]} * g.X;
    fixed->insert(inflated_bounds(g, d.geom_poses[fixed_geoms[k]], 0.01 * g.bounding_radius));
  }
  new (sleeping) BroadPhase(m.n.geoms, 1, 0, of_sleeping);
  for (Index k = 0; k < moving_count; ++k)
    moving->insert({shape::Vec::zero(), shape::Vec::zero()}), sleeping->insert({shape::Vec::zero(), shape::Vec::zero()});
  for (Index k = 0; k < moving_count; ++k) sleeping->remove(k);
  for (Index k = 0; k < unbounded_count; ++k)
    d.geom_poses[unbounded_geoms[k]] =
        SE3<double>{d.R[d.geoms[unbounded_geoms[k]].body], d.p[d.geoms[unbounded_geoms[k]].body]} * d.geoms[unbounded_geoms[k]].X;
  list_active();
  ready = true;
}

void PairSearch::put_to_sleep(const Data<double>& d, Index geom, double more) {
  const Index id = id_of(geom);
  moving->remove(id), sleeping->insert_at(id, inflated_bounds(d.geoms[geom], d.geom_poses[geom], more));
}

void PairSearch::wake(Index geom) {
  const Index id = id_of(geom);
  moving->insert_at(id, sleeping->bounds(id)), sleeping->remove(id);
}

void PairSearch::list_active() {
  active_count = 0;
  for (Index k = 0; k < moving_count; ++k) {
    isolated[k].radius = 0;
    if (moving->has(k)) active[active_count++] = k;
  }
}

bool PairSearch::move(const Data<double>& d, const Geom& g, const Pose& X, Index id, double more) {
  constexpr double wider = 20;
  constexpr Index few = 32;  // with more shapes some are near most of the time
  constexpr double pause = 8;  // moves before a shape that was not isolated is tested again
  const double radius = g.bounding_radius + wider * more, half = g.bounding_radius + radius + 1e-9 * radius;
  const auto by = shape::Vec::make(half, half, half);
  const Bounds ball{X.p - by, X.p + by};
  if (isolated[id].radius < 0) return ++isolated[id].radius, moving->update(id, inflated_bounds(g, X, more)), false;
  bool is_isolated = moving->count() <= few;
  for (Index k = 0; is_isolated && k < unbounded_count; ++k) {
    const Geom& v = d.geoms[unbounded_geoms[k]];
    is_isolated = v.body == 0 && distance_lower_bound(g, X, v, d.geom_poses[unbounded_geoms[k]]) > radius + more;
  }
  if (is_isolated) moving->query(ball, [&](Index k) { is_isolated &= k == id; });
  if (is_isolated) fixed->query(ball, [&](Index) { is_isolated = false; });
  if (is_isolated) sleeping->query(ball, [&](Index) { is_isolated = false; });
  isolated[id] = {X.p, is_isolated ? radius : -pause};
  moving->update(id, is_isolated ? ball : inflated_bounds(g, X, more));
  return is_isolated;
}

void PairSearch::place_all(const Data<double>& d, double margin) {
  for (Index k = 0; k < moving_count; ++k)
    isolated[k].radius = 0, moving->update(k, inflated_bounds(d.geoms[moving_geoms[k]], d.geom_poses[moving_geoms[k]], margin));
}

bool PairSearch::collect(const Data<double>& d) {
  found_count = 0;
  const auto take = [&](Index a, Index b) {
    if (found_count < capacity) found[found_count] = id_pair(a, b);
    ++found_count;
  };
  if (!moving->pairs([&](Index a, Index b) { take(moving_geoms[a], moving_geoms[b]); })) return false;
  first_other = found_count;
  for_each_other(d, take);
  if (found_count > capacity) return false;
  std::sort(found + first_other, found + found_count);
  return true;
}

}  // namespace dyn::collision
