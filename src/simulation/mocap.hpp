// Mocap bodies: links fixed to the world whose pose the caller sets. They are part of the world's body. Frames, shapes and
// anchors on them are where the model has them, moved by X (X of the model)^-1.
#pragma once

#include "collision/geom.hpp"
#include "model/constraints.hpp"

namespace dyn {

// The motion of a mocap body from the model's placement to X.
SE3<double> mocap_motion(const Model& m, Index mocap, const double* X);
// Places shapes that are on a mocap body; place: its number among Data::R.
void place_geoms(const Model& m, collision::Geom* geoms, Index place, const SE3<double>& motion);

// Places a mocap body and what is on it. possible: parts that a program may ask for, as in data_layout.
template <dynParts possible = DYN_PART_ALL, class T>
void place_mocap(const Model& m, Data<T>& d, Index mocap, const double* X) {
  const SE3<double> motion = mocap_motion(m, mocap, X);
  const Index place = m.n.bodies + mocap;
  for (int i = 0; i < 12; ++i) d.mocap[12 * mocap + i] = T(X[i]);
  d.R[place] = cast<T>(motion.R), d.p[place] = cast<T>(motion.p);
  if constexpr (possible & DYN_PART_COLLISION)
    if (d.geoms) place_geoms(m, d.geoms, place, motion);
  if constexpr (possible & DYN_PART_CONSTRAINTS)
    for (Index s = 0; d.slots && s < m.n.slots; ++s) place_anchors(m, d, s);
}

// Places all as in a named configuration.
template <dynParts possible = DYN_PART_ALL, class T>
void place_mocaps(const Model& m, Data<T>& d, Index configuration) {
  for (Index k = 0; k < m.n.mocaps; ++k)
    place_mocap<possible>(m, d, k, m.configuration_mocaps() + 12 * (std::ptrdiff_t(configuration) * m.n.mocaps + k));
}

namespace simulation {
// After a mocap body was placed elsewhere: what steps know of where it was no longer holds, and what it touches or holds does not
// rest, if rouse.
void mocap_moved(const Model& m, Data<double>& d, Index mocap, bool rouse = true);
}  // namespace simulation

}  // namespace dyn
