// Checks whether a body can have these mass properties. Numbers of the file are used or refused, never replaced.
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "urdf_robot.hpp"

namespace dyn::load {

namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

// Files have about six digits. A radius of gyration of 10 nm counts as zero.
constexpr double relative_tolerance = 1e-6;
constexpr double tiny_radius_squared = 1e-16;

double tolerance(double mass, double largest) { return relative_tolerance * std::abs(largest) + mass * tiny_radius_squared; }

Matrix3 skew_squared(const Vector3& c) { return c * c.transpose() - c.squaredNorm() * Matrix3::Identity(); }

std::string formatted(const std::array<double, 3>& m) {
  char buffer[100];
  std::string out;
  for (double x : m) {
    const int n = std::snprintf(buffer, sizeof buffer, "%.4g", x);
    for (int i = 0; i < n; ++i)
      if (buffer[i] == ',') buffer[i] = '.';  // snprintf follows the locale
    out += (out.empty() ? "" : ", ") + std::string(buffer);
  }
  return out;
}

// Nearest moments that satisfy a + b >= c.
std::array<double, 3> nearest_possible(std::array<double, 3> m) {
  for (double& x : m) x = std::max(x, 0.0);
  const double excess = std::max(0.0, m[2] - m[0] - m[1]) / 3;
  return {m[0] + excess, m[1] + excess, m[2] - excess};
}

bool negative(const UrdfLink& l) { return l.moments[0] < -tolerance(l.mass, std::max(std::abs(l.moments[0]), l.moments[2])); }

std::string moments_of(const UrdfLink& l) {
  return "link " + in_quotes(l.name) + ": the principal moments of inertia are " + formatted(l.moments) + " kg m^2";
}

}  // namespace

void check_inertia(UrdfLink& l, Report& report) {
  if (l.inertial_line == 0) return;
  const std::string called = "link " + in_quotes(l.name);
  const Matrix3 I = Eigen::Map<const Matrix3>(l.inertia.data());
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(I, Eigen::EigenvaluesOnly);
  if (!I.allFinite() || !solver.eigenvalues().allFinite())
    report.fail(DYN_ERROR_INVALID, l.inertial_line, called + ": the inertia is too large for a double once it is rotated");
  Vector3::Map(l.moments.data()) = solver.eigenvalues();
  if (I.isZero(0)) {
    if (l.mass > 0)
      report.info(l.inertial_line, called + " has a mass of " + text(l.mass) + " kg and no rotational inertia: a point mass");
    return;
  }
  if (l.mass == 0)
    report.physics(l.inertial_line, called + " has rotational inertia but no mass, which is impossible: kept as given");
  if (negative(l)) return;  // check_welded_inertia decides
  const double excess = l.moments[2] - l.moments[0] - l.moments[1];
  if (excess > tolerance(l.mass, l.moments[2]))
    report.physics(l.inertial_line,
                   moments_of(l) + ", and no body has one above the sum of the other two: kept as given; nearest possible: " +
                       formatted(nearest_possible(l.moments)));
}

void check_welded_inertia(const UrdfRobot& robot, const UrdfTree& tree, bool fixed_base, Report& report) {
  if (std::none_of(robot.links.begin(), robot.links.end(), negative)) return;

  // Links by their moving joint, placed in that joint's frame.
  const int n = int(robot.links.size());
  std::vector<int> rigid_group(n, tree.root);  // first link of each rigid group
  std::vector<Eigen::Isometry3d> placement(n, Eigen::Isometry3d::Identity());
  for (int j : tree.order) {
    const JointSpec& s = robot.joints[j].spec;
    const int parent = tree.parent[j], child = tree.child[j];
    rigid_group[child] = s.type == DYN_JOINT_TYPE_FIXED ? rigid_group[parent] : child;
    if (s.type != DYN_JOINT_TYPE_FIXED) continue;
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.linear() = Eigen::Map<const Matrix3>(s.placement.data());
    X.translation() = Eigen::Map<const Vector3>(s.placement.data() + 9);
    placement[child] = placement[parent] * X;
  }
  std::vector<double> mass(n);
  std::vector<Vector3> moment(n, Vector3::Zero());
  std::vector<Matrix3> about_origin(n, Matrix3::Zero());
  for (int i = 0; i < n; ++i) {
    const UrdfLink& l = robot.links[i];
    const Vector3 c = placement[i] * Vector3(Eigen::Map<const Vector3>(l.com.data()));
    const Matrix3 R = placement[i].linear();
    mass[rigid_group[i]] += l.mass;
    moment[rigid_group[i]] += l.mass * c;
    about_origin[rigid_group[i]] += R * Eigen::Map<const Matrix3>(l.inertia.data()) * R.transpose() - l.mass * skew_squared(c);
  }

  for (int i = 0; i < n; ++i) {
    const UrdfLink& l = robot.links[i];
    if (!negative(l)) continue;
    const int g = rigid_group[i];
    Matrix3 I = about_origin[g];
    if (mass[g] > 0) I += mass[g] * skew_squared(moment[g] / mass[g]);
    const Vector3 whole = Eigen::SelfAdjointEigenSolver<Matrix3>(I, Eigen::EigenvaluesOnly).eigenvalues();
    const bool welded_to_world = fixed_base && g == tree.root;
    const bool made_up = welded_to_world || whole[0] >= -tolerance(mass[g], whole[2]);
    report.physics(
        l.inertial_line,
        moments_of(l) + ", and a body has no negative one: kept as given" +
            (made_up
                 ? ", because the links it is welded to make up for it"
                 : "; correct <inertia> (about the centre of mass, in the axes of the inertial's <origin>); nearest possible: " +
                       formatted(nearest_possible(l.moments))));
  }
}

}  // namespace dyn::load
