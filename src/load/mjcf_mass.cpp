// Mass properties of bodies from <inertial> or from geoms.
#include <Eigen/Eigenvalues>

#include <cmath>

#include "collision/geom.hpp"
#include "shape/list.hpp"
#include "mesh.hpp"
#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

using Vec = Vec3<double>;

Eigen::Vector3d principal(const Sym3<double>& I, Eigen::Matrix3d* axes = nullptr) {
  Eigen::Matrix3d dense;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) dense(r, c) = I(r, c);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(dense);
  if (axes) *axes = solver.eigenvectors();
  return solver.eigenvalues();
}

Sym3<double> six(double xx, double yy, double zz, double xy, double xz, double yz) {
  return {Vec::make(xx, yy, zz), Vec::make(xy, yz, xz)};
}

Sym3<double> symmetric(const Eigen::Matrix3d& m) { return six(m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)); }

MjcfMass of(const meshes::Solid& solid) {
  const double sign = solid.volume < 0 ? -1 : 1;  // inside out
  return {sign * solid.volume, solid.com, solid.inertia * sign};
}

// Tetrahedra between an apex and each triangle. positive: all volumes count as positive.
struct Tetrahedra {
  double volume = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();    // integral of x from the apex
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();   // and of x x^T

  Tetrahedra(const meshes::Mesh& mesh, const Vec& apex, bool positive) {
    for (Index t = 0; t < mesh.triangle_count(); ++t) {
      Eigen::Matrix3d corners;
      for (int k = 0; k < 3; ++k) store3(mesh.corner(t, k) - apex, corners.col(k).data());
      const double volume_here = corners.determinant() / 6, v = positive ? std::abs(volume_here) : volume_here;
      const Eigen::Vector3d sum = corners.rowwise().sum();
      volume += v, first += v / 4 * sum, second += v / 20 * (corners * corners.transpose() + sum * sum.transpose());
    }
  }
};

// MuJoCo's rules. Tetrahedra from the surface's centroid give the centre of mass; those from there give volume and inertia.
// positive (legacy): parts that are concave as seen from there count more than once.
MjcfMass by_tetrahedra(const meshes::Mesh& mesh, bool positive) {
  Vec mean = Vec::zero();
  double area = 0;
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2), n = cross(b - a, c - a);
    const double twice = std::sqrt(dot(n, n));
    mean += (a + b + c) * (twice / 3), area += twice;
  }
  if (!(area > 0)) return {};
  mean = mean * (1 / area);
  const Tetrahedra about_mean(mesh, mean, positive);
  if (!(about_mean.volume > 0)) return {};
  const Vec com = mean + load3(about_mean.first.data()) * (1 / about_mean.volume);
  const Tetrahedra about_com(mesh, com, positive);
  return {about_com.volume, com, symmetric(about_com.second.trace() * Eigen::Matrix3d::Identity() - about_com.second)};
}

// Inertia of a surface of unit mass per area.
MjcfMass shell(const meshes::Mesh& mesh) {
  double area = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();   // integral of x
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // and of x x^T
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) store3(mesh.corner(t, k), corners.col(k).data());
    const Eigen::Vector3d a = corners.col(1) - corners.col(0), b = corners.col(2) - corners.col(0), sum = corners.rowwise().sum();
    const double part = a.cross(b).norm() / 2;
    area += part, first += part / 3 * sum, second += part / 12 * (corners * corners.transpose() + sum * sum.transpose());
  }
  if (!(area > 0)) return {};
  const Eigen::Vector3d com = first / area;
  second -= area * com * com.transpose();
  return {area, load3(com.data()), symmetric(second.trace() * Eigen::Matrix3d::Identity() - second)};
}

// Moments of the geom's shape at density 1, about its centre of mass, in the shape's frame.
MjcfMass solid_of(const MjcfGeom& g) {
  if (g.mesh) return mjcf_mesh_mass(*g.mesh, g);
  MjcfMass out;
  shape::Shape s{};
  if (!collision::geometry_of(g.shape.type, g.shape.size.data(), 0, s) || s.type == shape::Type::HalfSpace || g.shape.surface)
    return out;
  shape::visit(s, [&](const auto& solid) {
    const Inertia<double> Y = solid.solid();  // symmetric shapes: about their centre
    out = {Y.m, Vec::zero(), Y.I};
  });
  return out;
}

// Inertia of a point mass: m (|d|^2 1 - d d^T)
Sym3<double> of_point(double m, const Vec& d) {
  return six(m * (d[1] * d[1] + d[2] * d[2]), m * (d[0] * d[0] + d[2] * d[2]), m * (d[0] * d[0] + d[1] * d[1]), -m * d[0] * d[1],
             -m * d[0] * d[2], -m * d[1] * d[2]);
}

// Returns nullopt if no geom has mass.
std::optional<MjcfMass> from_geoms(const MjcfBody& body) {
  MjcfMass total;
  std::vector<MjcfMass> parts;
  for (const MjcfGeom& g : body.geoms) {
    if (g.group < body.rules.groups[0] || g.group > body.rules.groups[1] || g.mass.value_or(g.density) == 0) continue;
    MjcfMass part = solid_of(g);
    if (part.mass == 0) continue;
    const double scale = g.mass ? *g.mass / part.mass : g.density;
    part = {part.mass * scale, g.X.act(part.com), congruence(g.X.R, part.inertia.full()) * scale};
    total.mass += part.mass;
    total.com += part.com * part.mass;
    parts.push_back(part);
  }
  if (parts.empty()) return std::nullopt;
  if (total.mass > 0) total.com = total.com * (1 / total.mass);
  for (const MjcfMass& p : parts) total.inertia = total.inertia + p.inertia + of_point(p.mass, p.com - total.com);
  return total;
}

}  // namespace

MjcfMass mjcf_mesh_mass(const meshes::Mesh& mesh, const MjcfGeom& g) {
  const bool closed = mesh.topology.closed && meshes::solid_of(mesh).volume != 0;
  const std::string who = "mesh " + load::in_quotes(g.shape.mesh);
  if (g.rule == "convex") return of(meshes::solid_of(meshes::hull_of(mesh)));
  if (g.rule == "exact") {
    if (closed) return of(meshes::solid_of(mesh));
    const MjcfMass out = by_tetrahedra(mesh, false);
    if (!(out.mass > 0))
      g.place.fail(DYN_ERROR_INVALID, who + " is not closed and has no volume: give inertia=\"convex\" or an <inertial>");
    g.place.warning(who + " is not closed: the mass of its body is that of the tetrahedra from its centre to its triangles");
    return out;
  }
  if (g.rule == "shell") return shell(mesh);
  const MjcfMass out = by_tetrahedra(mesh, true);
  if (!closed) g.place.warning(who + " is not closed: the mass of its body is MuJoCo's estimate (legacy)");
  else if (const MjcfMass exact = of(meshes::solid_of(mesh)); std::abs(out.mass - exact.mass) > 1e-3 * exact.mass)
    g.place.warning(who + ": by MuJoCo's rule (legacy) its volume is " + text(out.mass) + " m^3, and exactly it is " +
                    text(exact.mass) + " m^3: give inertia=\"exact\" to the mesh, or an <inertial> to the body");
  return out;
}

MjcfMass read_mjcf_inertial(const MjcfFile& file, const Element& e, const std::string& owner) {
  const Reader reader = file.source.reader(e, owner);
  reader.unread(e, {"pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "mass", "diaginertia", "fullinertia"}, {});
  const SE3<double> X = read_pose(reader, e, file.compiler);
  MjcfMass out;
  if (!e.Attribute("pos")) reader.fail(DYN_ERROR_PARSE, e, "<inertial> has no attribute pos");
  out.com = X.p;
  out.mass = reader.number(e, "mass");
  if (out.mass < 0) reader.bad_numbers(e, "mass", "it is negative");
  const auto diagonal = reader.vector3(e, "diaginertia");
  const auto full = reader.numbers(e, "fullinertia", 6);
  if (diagonal && full) reader.fail(DYN_ERROR_INVALID, e, "<inertial> has diaginertia and fullinertia: keep one");
  if (full && has_rotation(e)) reader.fail(DYN_ERROR_INVALID, e, "<inertial> has fullinertia and a rotation: keep one");
  if (diagonal) out.inertia = congruence(X.R, Sym3<double>::diagonal((*diagonal)[0], (*diagonal)[1], (*diagonal)[2]).full());
  if (full) out.inertia = six((*full)[0], (*full)[1], (*full)[2], (*full)[3], (*full)[4], (*full)[5]);
  return out;
}

std::vector<MjcfMass> mjcf_masses(const MjcfRobot& robot) {
  std::vector<MjcfMass> out(robot.bodies.size());
  double sum = 0;
  for (size_t i = 1; i < out.size(); ++i) {
    const MjcfBody& body = robot.bodies[i];
    const std::optional<MjcfMass> geoms = mass_from_geoms(body) ? from_geoms(body) : std::nullopt;
    out[i] = geoms ? *geoms : body.inertial.value_or(MjcfMass());
    Eigen::Matrix3d axes;
    Eigen::Vector3d moments = principal(out[i].inertia, &axes);
    const double largest = moments[2], slack = 1e-9 * largest;
    if (moments[0] < -slack)
      body.place.fail(DYN_ERROR_INVALID, "its inertia has a negative principal moment, " + text(moments[0]) + " kg m^2");
    if (moments[0] + moments[1] < moments[2] - slack) {
      if (!body.rules.balance)
        body.place.fail(DYN_ERROR_INVALID, "its inertia is impossible: principal moments " + text(moments[0]) + " + " +
                                               text(moments[1]) + " < " + text(moments[2]) +
                                               " kg m^2 (<compiler balanceinertia=\"true\"> would take their mean)");
      body.place.warning("its inertia is impossible: balanceinertia takes the mean of the principal moments");
      moments.setConstant(moments.mean());
    }
    out[i].mass = std::max(out[i].mass, body.rules.min_mass);
    moments = moments.cwiseMax(body.rules.min_inertia);
    out[i].inertia = symmetric(axes * moments.asDiagonal() * axes.transpose());
    sum += out[i].mass;
  }
  if (robot.compiler.total_mass > 0 && sum > 0)
    for (MjcfMass& m : out) m.mass *= robot.compiler.total_mass / sum, m.inertia = m.inertia * (robot.compiler.total_mass / sum);
  return out;
}

}  // namespace dyn::load
