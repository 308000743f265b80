#include "collision/pair_search.hpp"

#include <new>

#include "shape/list.hpp"

namespace dyn::collision {

namespace {

constexpr double fat = 0.1;  // margin of boxes, of the mean reach
std::ptrdiff_t pair_capacity(const Model& m) { return 1024 + 16 * std::ptrdiff_t(m.n.geoms); }
std::size_t rounded(std::size_t bytes) { return (bytes + 63) / 64 * 64; }

// f(array, numbers)
template <class F>
void for_each_array(const Model& m, PairSearch& s, char*& moving, char*& fixed, char*& resting, F&& f) {
  f(moving, std::ptrdiff_t(BroadPhase::bytes(m.n.geoms, pair_capacity(m)))), f(fixed, std::ptrdiff_t(BroadPhase::bytes(m.n.geoms, 1)));
  f(resting, std::ptrdiff_t(BroadPhase::bytes(m.n.geoms, 1)));
  f(s.moving, 1), f(s.fixed, 1), f(s.resting, 1);
  for (Index** list : {&s.active, &s.moving_geoms, &s.fixed_geoms, &s.vast_geoms}) f(*list, m.n.geoms);
  f(s.alone, m.n.geoms), f(s.found, pair_capacity(m));
}

}  // namespace

std::size_t search_bytes(const Model& m) {
  if (!may_search(m)) return 0;
  PairSearch s;
  char *moving, *fixed, *resting;
  std::size_t bytes = rounded(sizeof s);
  for_each_array(m, s, moving, fixed, resting, [&](auto* array, std::ptrdiff_t n) { bytes += rounded(std::size_t(n) * sizeof *array); });
  return bytes;
}

Bounds swollen(const Geom& g, const Pose& X, double more) {
  Bounds b{};
  shape::visit(g.shape, [&](const auto& s) { b = s.bounds(X); });
  const double e = more + 1e-9 * (g.reach + more);  // beyond what distances are known to
  const auto by = shape::Vec::make(e, e, e);
  return {b.lower - by, b.upper + by};
}

void PairSearch::set_up(const Model& m, Data<double>& d) {
  char *next = d.pair_search + rounded(sizeof *this), *of_moving, *of_fixed, *of_resting;
  for_each_array(m, *this, of_moving, of_fixed, of_resting, [&](auto*& array, std::ptrdiff_t n) {
    array = reinterpret_cast<std::remove_reference_t<decltype(array)>>(next);
    next += rounded(std::size_t(n) * sizeof *array);
  });
  moving_count = fixed_count = vast_count = 0, room = pair_capacity(m);
  double sum = 0;
  for (Index k = 0; k < m.n.geoms; ++k) {
    if (!known(m, k)) continue;
    const Geom& g = d.geoms[k];
    if (!(g.reach < shape::infinity)) vast_geoms[vast_count++] = k;
    else if (g.body == 0) fixed_geoms[fixed_count++] = k;
    else moving_geoms[moving_count++] = k, sum += g.reach;
  }
  new (moving) BroadPhase(m.n.geoms, room, moving_count ? fat * sum / moving_count : 0, of_moving);
  new (fixed) BroadPhase(m.n.geoms, 1, 0, of_fixed);
  for (Index k = 0; k < fixed_count; ++k) {
    const Geom& g = d.geoms[fixed_geoms[k]];
    d.geom_poses[fixed_geoms[k]] = SE3<double>{d.R[0], d.p[0]} * g.X;
    fixed->insert(swollen(g, d.geom_poses[fixed_geoms[k]], 0.01 * g.reach));
  }
  new (resting) BroadPhase(m.n.geoms, 1, 0, of_resting);
  for (Index k = 0; k < moving_count; ++k) moving->insert({shape::Vec::zero(), shape::Vec::zero()}), resting->insert({shape::Vec::zero(), shape::Vec::zero()});
  for (Index k = 0; k < moving_count; ++k) resting->remove(k);
  for (Index k = 0; k < vast_count; ++k) d.geom_poses[vast_geoms[k]] = SE3<double>{d.R[d.geoms[vast_geoms[k]].body], d.p[d.geoms[vast_geoms[k]].body]} * d.geoms[vast_geoms[k]].X;
  list_active();
  ready = true;
}

void PairSearch::rest(const Data<double>& d, Index geom, double more) {
  const Index id = id_of(geom);
  moving->remove(id), resting->put_back(id, swollen(d.geoms[geom], d.geom_poses[geom], more));
}

void PairSearch::stir(Index geom) {
  const Index id = id_of(geom);
  moving->put_back(id, resting->bounds(id)), resting->remove(id);
}

void PairSearch::list_active() {
  active_count = 0;
  for (Index k = 0; k < moving_count; ++k) {
    alone[k].radius = 0;
    if (moving->has(k)) active[active_count++] = k;
  }
}

bool PairSearch::move(const Data<double>& d, const Geom& g, const Pose& X, Index id, double more) {
  constexpr double wider = 20;
  constexpr Index few = 32;  // of more, some are near most of the time
  constexpr double pause = 8;  // moves before one that was not alone may be
  const double radius = g.reach + wider * more, half = g.reach + radius + 1e-9 * radius;
  const auto by = shape::Vec::make(half, half, half);
  const Bounds ball{X.p - by, X.p + by};
  if (alone[id].radius < 0) return ++alone[id].radius, moving->update(id, swollen(g, X, more)), false;
  bool is_alone = moving->count() <= few;
  for (Index k = 0; is_alone && k < vast_count; ++k) {
    const Geom& v = d.geoms[vast_geoms[k]];
    is_alone = v.body == 0 && distance_at_least(g, X, v, d.geom_poses[vast_geoms[k]]) > radius + more;
  }
  if (is_alone) moving->query(ball, [&](Index k) { is_alone &= k == id; });
  if (is_alone) fixed->query(ball, [&](Index) { is_alone = false; });
  if (is_alone) resting->query(ball, [&](Index) { is_alone = false; });
  alone[id] = {X.p, is_alone ? radius : -pause};
  moving->update(id, is_alone ? ball : swollen(g, X, more));
  return is_alone;
}

void PairSearch::place_all(const Data<double>& d, double margin) {
  for (Index k = 0; k < moving_count; ++k) alone[k].radius = 0, moving->update(k, swollen(d.geoms[moving_geoms[k]], d.geom_poses[moving_geoms[k]], margin));
}

bool PairSearch::collect(const Data<double>& d) {
  found_count = 0;
  const auto take = [&](Index a, Index b) {
    if (found_count < room) found[found_count] = id_pair(a, b);
    ++found_count;
  };
  if (!moving->pairs([&](Index a, Index b) { take(moving_geoms[a], moving_geoms[b]); })) return false;
  others = found_count;
  each_other(d, take);
  if (found_count > room) return false;
  std::sort(found + others, found + found_count);
  return true;
}

}  // namespace dyn::collision
