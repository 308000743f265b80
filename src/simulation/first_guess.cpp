// The forces of the step before, as the first guess of the contact solver.
#include <algorithm>

#include "collision/pair_contacts.hpp"
#include "simulation/step.hpp"

namespace dyn::simulation {

namespace {

bool same_pair(const dynContactForce& x, const dynContactForce& y) {
  return x.contact.shape_a == y.contact.shape_a && x.contact.shape_b == y.contact.shape_b;
}

// The contacts of one pair, now and in the step before.
struct PairGuess {
  dynContactForce *begin, *end;
  const dynContactForce *begin_before, *end_before;
  const Model& m;
  const Data<double>& d;
  const dynContactForce* taken[collision::Manifold::most] = {};
  int taken_count = 0;

  const dynContactForce* same_feature(const dynContactForce& x) const {
    return std::find_if(begin_before, end_before,
                        [&](const dynContactForce& y) { return y.contact.feature == x.contact.feature; });
  }
  bool is_taken(const dynContactForce& y) const {
    return std::find(taken, taken + taken_count, &y) != taken + taken_count ||
           std::any_of(begin, end, [&](const dynContactForce& x) { return x.contact.feature == y.contact.feature; });
  }
  double reach() const {
    const auto radius = [&](Index shape) { return d.geoms[collision::geom_of_shape(m, shape)].bounding_radius; };
    return tuning::search::same_place * std::min(radius(begin->contact.shape_a), radius(begin->contact.shape_b));
  }
  const dynContactForce* nearest(const dynContactForce& x, double reach) const {
    const dynContactForce* found = nullptr;
    double least = reach * reach;
    for (const dynContactForce* y = begin_before; y != end_before; ++y) {
      const Vec3<double> off = load3(x.contact.position) - load3(y->contact.position);
      if (const double distance2 = dot(off, off); distance2 < least && !is_taken(*y)) least = distance2, found = y;
    }
    return found;
  }
  void copy() {
    bool all = true;
    for (dynContactForce* x = begin; x != end; ++x) {
      const dynContactForce* const y = same_feature(*x);
      copy_force(*x, y == end_before ? nullptr : y), all = all && y != end_before;
    }
    if (all) return;
    const double within = reach();
    for (dynContactForce* x = begin; x != end && taken_count < collision::Manifold::most; ++x)
      if (same_feature(*x) == end_before)
        if (const dynContactForce* const y = nearest(*x, within)) copy_force(*x, y), taken[taken_count++] = y;
  }
};

}  // namespace

// A contact keeps the force of the same features. Where edges of both shapes coincide, rounding decides whose corner a point is:
// such a point keeps the force of the nearest one that is gone.
void take_previous_forces(const Model& m, Data<double>& d) {
  Workspace& w = *d.step;
  const dynContactForce *before = w.previous, *const end_before = w.previous + w.previous_count;
  dynContactForce* const end = w.contacts + w.contact_count;
  const auto first_not = [](auto* from, auto* to, const dynContactForce& pair) {
    return std::find_if_not(from, to, [&](const dynContactForce& x) { return same_pair(x, pair); });
  };
  for (dynContactForce *x = w.contacts, *next; x != end; x = next) {
    next = first_not(x, end, *x);
    while (before != end_before && !same_pair(*before, *x) && collision::comes_before(before->contact, x->contact)) ++before;
    const dynContactForce* const next_before = first_not(before, end_before, *x);
    PairGuess{x, next, before, next_before, m, d}.copy();
    before = next_before;
  }
}

}  // namespace dyn::simulation
