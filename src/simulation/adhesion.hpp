// Moment arms of actuators that pull a link to what it touches: the mean over its contacts of the normal pointing away from the
// link. Contacts are those that the last step left.
#pragma once

#include "algorithm/actuators.hpp"
#include "simulation/workspace.hpp"

namespace dyn::simulation {

inline void measure_adhesion(const Model& m, Data<double>& d, Index path, Index link) {
  const PathRecord& p = m.paths()[path];
  const Index* const dofs = m.path_dofs() + p.first_dof;
  for (Index i = 0; i < p.dofs; ++i) d.path_row[dofs[i]] = 0;
  Index count = 0;
  const double touching = tuning::slop * d.step->length;
  for_each_contact(*d.step, [&](const dynContactForce& f) {
    const dynContact& c = f.contact;
    if (c.shape_a < 0 || c.shape_b < 0 || c.distance > touching) return;
    const auto frame = [&](std::int32_t shape) -> const FrameRecord& { return m.frames()[m.shapes()[shape].frame]; };
    if (m.shapes()[c.shape_a].frame != link && m.shapes()[c.shape_b].frame != link) return;
    const Vec3<double> x = load3(c.position), none = Vec3<double>::zero();
    add_pair(m, d, load3(c.normal), none, PathPoint<double>{x, frame(c.shape_a).body}, PathPoint<double>{x, frame(c.shape_b).body},
             d.path_row);
    ++count;
  });
  for (Index i = 0; i < p.dofs; ++i) d.path_moment[p.first_dof + i] = count > 0 ? d.path_row[dofs[i]] / count : 0;
}

inline void measure_adhesions(const Model& m, Data<double>& d) {
  for (Index k = 0; k < (m.n.adhesions > 0 ? m.n.actuators : 0); ++k)
    if (const ActuatorRecord& r = m.actuators()[k]; r.spec.transmission == DYN_TRANSMISSION_BODY)
      measure_adhesion(m, d, r.path, r.spec.frame);
}

}  // namespace dyn::simulation
