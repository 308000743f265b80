#include "simulation/mocap.hpp"

#include <algorithm>

namespace dyn {

SE3<double> mocap_motion(const Model& m, Index mocap, const double* X) {
  const double* const model = m.frames()[m.mocaps()[mocap]].placement;
  return std::equal(X, X + 12, model) ? SE3<double>::identity() : load_se3(X) * load_se3(model).inverse();
}

void place_geoms(const Model& m, collision::Geom* geoms, Index place, const SE3<double>& motion) {
  for (Index k = 0; k < m.n.geoms; ++k) {
    const ShapeRecord& s = m.shapes()[m.geoms()[k].shape];
    const FrameRecord& f = m.frames()[s.frame];
    if (f.place == place) geoms[k].X = motion * (f.X * load_se3(s.placement));
  }
}

}  // namespace dyn
