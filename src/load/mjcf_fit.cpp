// A primitive <geom> with a mesh takes its pose and sizes from the mesh, by MuJoCo's rules.
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh.hpp"
#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

using Vec = Vec3<double>;

// Principal axes with moments that descend: the longest extent is along z.
Mat3<double> descending_axes(const Sym3<double>& inertia, double moments[3]) {
  Eigen::Matrix3d dense;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) dense(r, c) = inertia(r, c);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(dense);
  const auto axis = [&](int k) {
    return Vec::make(solver.eigenvectors()(0, k), solver.eigenvectors()(1, k), solver.eigenvectors()(2, k));
  };
  for (int k = 0; k < 3; ++k) moments[k] = solver.eigenvalues()[2 - k];
  Mat3<double> R;
  R.x = axis(2), R.y = axis(1), R.z = cross(R.x, R.y);
  return R;
}

}  // namespace

void fit_mjcf_geom(const meshes::Mesh& mesh, bool bounds, double scale, MjcfGeom& geom) {
  const MjcfMass mass = mjcf_mesh_mass(mesh, geom);
  if (!(mass.mass > 0)) geom.place.fail(DYN_ERROR_INVALID, "the mesh that it is fitted to has no volume: give its size");
  double moments[3];
  SE3<double> X = {descending_axes(mass.inertia, moments), mass.com};
  std::array<double, 3> half, out;
  double around = 0;  // largest distance of a vertex from the axis z
  if (bounds) {
    constexpr double far = std::numeric_limits<double>::infinity();
    std::array<double, 3> low = {far, far, far}, high = {-far, -far, -far};
    const auto each_vertex = [&](const auto& f) {
      for (Index i = 0; i < mesh.vertex_count(); ++i) f(X.act_inverse(mesh.vertex(i)));
    };
    each_vertex([&](const Vec& v) {
      for (int k = 0; k < 3; ++k)
        low[size_t(k)] = std::min(low[size_t(k)], v[k]), high[size_t(k)] = std::max(high[size_t(k)], v[k]);
    });
    X.p = X.act(Vec::make(low[0] + high[0], low[1] + high[1], low[2] + high[2]) * 0.5);
    for (size_t k = 0; k < 3; ++k) half[k] = (high[k] - low[k]) / 2;
    each_vertex([&](const Vec& v) { around = std::max(around, std::hypot(v[0], v[1])); });
  } else {
    // a box of this volume with these moments
    for (size_t k = 0; k < 3; ++k)
      half[k] = std::sqrt(std::max(0.0, 6 * (moments[(k + 1) % 3] + moments[(k + 2) % 3] - moments[k]) / mass.mass)) / 2;
    around = (half[0] + half[1]) / 2;
  }
  out = half;
  if (geom.shape.type == DYN_SHAPE_TYPE_SPHERE)
    out = {bounds ? std::max({half[0], half[1], half[2]}) : (half[0] + half[1] + half[2]) / 3, 0, 0};
  if (geom.shape.type == DYN_SHAPE_TYPE_CYLINDER) out = {around, half[2], 0};
  if (geom.shape.type == DYN_SHAPE_TYPE_CAPSULE) out = {around, std::max(0.0, half[2] - (bounds ? around : around / 2)), 0};
  for (size_t k = 0; k < 3; ++k) geom.shape.size[k] = scale * out[k];
  geom.X = geom.X * X;
}

void fit_mjcf_fluid(const meshes::Mesh& mesh, MjcfGeom& geom) {
  const MjcfMass mass = mjcf_mesh_mass(mesh, geom);
  if (!(mass.mass > 0)) geom.place.fail(DYN_ERROR_INVALID, "the mesh has no volume: its ellipsoid in a medium is not defined");
  double moments[3];
  const SE3<double> X = {descending_axes(mass.inertia, moments), mass.com};
  geom.fluid->semiaxes = {0, 0, 0};
  for (Index i = 0; i < mesh.vertex_count(); ++i) {
    const Vec v = X.act_inverse(mesh.vertex(i));
    for (int k = 0; k < 3; ++k) geom.fluid->semiaxes[size_t(k)] = std::max(geom.fluid->semiaxes[size_t(k)], std::abs(v[k]));
  }
  store_se3(geom.X * X, geom.fluid->placement.data());
}

}  // namespace dyn::load
