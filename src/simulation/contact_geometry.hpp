// How a contact point moves with its shapes. For B moved by a small translation `step` of the contact point and a small rotation
// `turn`, with A at rest, the normal turns by a rotation vector and the point moves:
//   rotation = by_step.turn step + by_turn.turn turn      motion = by_step.move step + by_turn.move turn
//   change of the gap = by_step.gap . step + by_turn.gap . turn
// (normal . step where the point is the nearest of both shapes, but not at points beside it.) What A does follows: a common
// motion of both carries all of it along.
#pragma once

#include "simulation/step.hpp"

namespace dyn::simulation {

struct ContactGeometry {
  struct Change {
    Mat3<double> turn, move;
    Vec3<double> gap;
  } by_step, by_turn;
};

// Returns false where it is not known: the point has no counterpart when the shapes move.
// Balls and corners on half-spaces and balls on balls have closed forms. Of others, central differences of the contact points of
// the pair.
bool contact_geometry(const Model& m, Data<double>& d, const dynContact& contact, const ContactLaw& law, ContactGeometry& out);

}  // namespace dyn::simulation
