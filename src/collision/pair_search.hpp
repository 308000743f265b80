// Broad phase over a robot's collision shapes. Used where pairs are not listed, or are too many to test one by one. Fixed shapes
// lie in a tree of their own, which costs nothing until something comes near.
#pragma once

#include "collision/broad/broad_phase.hpp"
#include "collision/bounding_sphere.hpp"
#include "collision/pairs.hpp"

namespace dyn::collision {

// Index of the listed pair of two shapes, a < b, or -1.
inline Index listed_pair(const Model& m, Index a, Index b) {
  const PairRecord* const end = m.pairs() + m.n.pairs;
  const PairRecord* const p = std::lower_bound(
      m.pairs(), end, std::pair{a, b},
      [](const PairRecord& x, const std::pair<Index, Index>& y) { return x.a != y.first ? x.a < y.first : x.b < y.second; });
  return p != end && p->a == a && p->b == b ? Index(p - m.pairs()) : -1;
}

// The world's link that holds a frame; 0: the world itself.
inline Index fixed_link(const FrameRecord* frames, Index frame) {
  while (frame != 0 && (frames[frame].joint != 0 || frames[frame].type != DYN_FRAME_TYPE_BODY)) frame = frames[frame].parent;
  return frame;
}

// A body and its parent touch at their joint, so they are not tested. Joints without mass between them count as one. A free flyer
// has no parent. A joint on the world has the link that holds it as parent, where `held`.
inline bool parent_and_child(const JointRecord* joints, const Body* bodies, const FrameRecord* frames, Index parent, Index child,
                             bool held) {
  for (Index k = frames[child].joint; k != 0 && joints[k].type != DYN_JOINT_TYPE_FREE_FLYER; k = joints[k].parent) {
    const Index carrier = joints[k].parent;
    if (carrier == frames[parent].joint) return carrier != 0 || (held && parent != 0 && parent == fixed_link(frames, child));
    if (bodies[joints[carrier].last_body].m > 0) return false;
  }
  return false;
}
inline PairFilter filter_of(const ShapeRecord& a, const ShapeRecord& b) {
  return PairFilter(std::min<std::uint32_t>(a.filter, b.filter));
}
inline bool adjacent(const JointRecord* joints, const Body* bodies, const FrameRecord* frames, const ShapeRecord& a,
                     const ShapeRecord& b) {
  const PairFilter filter = filter_of(a, b);
  const bool held = filter < PairFilter::Mujoco;
  return filter != PairFilter::SameBody && (parent_and_child(joints, bodies, frames, a.frame, b.frame, held) ||
                                            parent_and_child(joints, bodies, frames, b.frame, a.frame, held));
}

inline bool has_geometry(const Model& m, Index geom) { return m.shapes()[m.geoms()[geom].shape].type != DYN_SHAPE_TYPE_MESH; }

// Returns whether two shapes are tested, a < b. pair: its index, or -1 if unlisted.
inline bool is_tested(const Model& m, const Data<double>& d, Index a, Index b, Index& pair) {
  if (pair = listed_pair(m, a, b); pair >= 0) return d.pair_states[pair] == DYN_PAIR_REASON_TESTED;
  if (lists_pairs(m)) return false;
  const auto shape = [&](Index geom) -> const ShapeRecord& { return m.shapes()[m.geoms()[geom].shape]; };
  return m.bodies()[d.geoms[a].body].joint != m.bodies()[d.geoms[b].body].joint &&
         masks_allow(d.geom_masks[a], d.geom_masks[b]) && !adjacent(m.joints(), m.bodies(), m.frames(), shape(a), shape(b)) &&
         has_geometry(m, a) && has_geometry(m, b);
}

// Whether steps search pairs by boxes. Measured: boxes are cheaper from this many listed pairs a shape.
inline constexpr Index search_pairs_per_shape = 16;
inline bool uses_pair_search(const Model& m) {
  return !lists_pairs(m) || m.n.pairs > search_pairs_per_shape * std::ptrdiff_t(m.n.geoms);
}

// Sphere in which a shape was isolated. While the shape stays inside, no query is needed.
struct IsolatedSphere {
  shape::Vec center;
  double radius;  // less the bounding radius; 0 or less: not isolated
};

struct PairSearch {
  bool ready;  // lists and fixed boxes are set up
  BroadPhase *moving, *fixed, *sleeping;              // by ids, which index the lists; sleeping: shapes that can move
  Index *moving_geoms, *fixed_geoms, *unbounded_geoms;    // ascending; unbounded: shapes without a box
  Index moving_count, fixed_count, unbounded_count;
  Index* active;                                     // ids in `moving`, ascending
  IsolatedSphere* isolated;                                      // by id
  Index active_count;
  IdPair* found;  // pairs of moving shapes; from first_other on pairs with others; both ascending
  std::ptrdiff_t first_other, found_count, capacity;

  static PairSearch* of(const Data<double>& d) { return reinterpret_cast<PairSearch*>(d.pair_search); }
  void set_up(const Model& m, Data<double>& d);
  // Call after set_up and after motion. Boxes cover d.geom_poses and the margin.
  void place_all(const Data<double>& d, double margin);
  // Moves a shape from the active boxes to the sleeping ones, and back. Call list_active afterwards.
  void put_to_sleep(const Data<double>& d, Index geom, double more);
  void wake(Index geom);
  void list_active();
  // Places the box of a moving shape, enlarged by `more`. Returns whether it is isolated.
  bool place(const Data<double>& d, Index id, double more) {
    const Geom& g = d.geoms[moving_geoms[id]];
    const Pose& X = d.geom_poses[moving_geoms[id]];
    const IsolatedSphere& a = isolated[id];
    const shape::Vec way = X.p - a.center;
    if (const double left = a.radius - more; left > 0 && dot(way, way) <= left * left) return true;
    return move(d, g, X, id, more);
  }
  // f(a, b), a < b, of pairs with overlapping boxes. Returns whether they came in ascending order, which fails when they exceed
  // the capacity.
  template <class F>
  bool for_each(const Data<double>& d, F&& f) {
    const auto ordered = [&](Index a, Index b) { f(std::min(a, b), std::max(a, b)); };
    if (!collect(d)) {
      for (Index i = 0; i < active_count; ++i)
        moving->query(moving->bounds(active[i]), [&](Index k) {
          if (k > active[i]) ordered(moving_geoms[active[i]], moving_geoms[k]);
        });
      for_each_other(d, ordered);
      return false;
    }
    for (std::ptrdiff_t i = 0, j = first_other; i < first_other || j < found_count;) {
      const IdPair p = j == found_count || (i < first_other && found[i] < found[j]) ? found[i++] : found[j++];
      f(first_of(p), second_of(p));
    }
    return true;
  }

 private:
  bool move(const Data<double>& d, const Geom& g, const Pose& X, Index id, double more);
  Index id_of(Index geom) const {
    return Index(std::lower_bound(moving_geoms, moving_geoms + moving_count, geom) - moving_geoms);
  }
  bool collect(const Data<double>& d);
  // Moving shapes against fixed, sleeping and unbounded ones.
  template <class F>
  void for_each_other(const Data<double>& d, F&& f) {
    for (Index i = 0; i < active_count; ++i) {
      const Index a = moving_geoms[active[i]];
      const Bounds& box = moving->bounds(active[i]);
      if (isolated[active[i]].radius > 0) continue;
      fixed->query(box, [&](Index k) { f(a, fixed_geoms[k]); });
      if (active_count < moving_count) sleeping->query(box, [&](Index k) { f(a, moving_geoms[k]); });
      for (Index k = 0; k < unbounded_count; ++k) f(a, unbounded_geoms[k]);
    }
    for (Index k = 0; k < unbounded_count; ++k) {
      if (d.geoms[unbounded_geoms[k]].body == 0) continue;
      for (Index l = 0; l < fixed_count; ++l) f(unbounded_geoms[k], fixed_geoms[l]);
      for (Index l = 0; active_count < moving_count && l < moving_count; ++l)
        if (sleeping->has(l)) f(unbounded_geoms[k], moving_geoms[l]);
    }
  }
};

// Box of a shape enlarged by `more`.
Bounds inflated_bounds(const Geom& g, const Pose& X, double more);

}  // namespace dyn::collision
