// Whether forward dynamics is defined: bodies that can exist, and inertia in every direction in which a joint moves.
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <new>

#include "algorithm/cholesky.hpp"
#include "algorithm/crba.hpp"
#include "model/block.hpp"
#include "model/builder_impl.hpp"

namespace dyn {

namespace {

// Principal moments about the centre of mass, ascending.
Eigen::Vector3d principal_moments(const Body& b) {
  const Vec3<double> c = b.m > 0 ? b.h * (1 / b.m) : Vec3<double>::zero();
  Eigen::Matrix3d I;
  store33(b.I - (Mat3<double>::identity() * dot(c, c) - outer(c, c)) * b.m, I.data());
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(I, Eigen::EigenvaluesOnly).eigenvalues();
}

bool finite(const Body& b) {
  return std::isfinite(b.m + b.h[0] + b.h[1] + b.h[2] + (b.I(0, 0) + b.I(0, 1) + b.I(0, 2)) +
                       (b.I(1, 1) + b.I(1, 2) + b.I(2, 2)));
}

// Names of the links that make up a joint's body.
std::string links_of(const std::vector<FrameEntry>& frames, int joint) {
  std::string names;
  int count = 0;
  for (const FrameEntry& f : frames)
    if (f.type == DYN_FRAME_TYPE_BODY && f.joint == joint && ++count <= 4) names += (names.empty() ? "'" : ", '") + f.name + "'";
  return names.empty() ? "no link" : count > 4 ? names + ", ..." : names;
}

// A configuration off the singular ones, the same for each trial: translations of the size of the robot.
std::vector<double> generic_configuration(const Model& m, std::uint64_t trial) {
  double length = 0;
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    const Vec3<double> r = m.joint_placement()[i].p;
    length = std::max(length, std::sqrt(dot(r, r)));
    if (b.m > 0)
      length = std::max({length, std::sqrt(dot(b.h, b.h)) / b.m, std::sqrt(std::abs(b.I(0, 0) + b.I(1, 1) + b.I(2, 2)) / b.m)});
  }
  if (!(length > 0)) length = 1;
  const double far[7] = {length, length, length, 1, 1, 1, 1}, near[7] = {1, 1, 1, 1, 1, 1, 1};
  double low[7];
  std::vector<double> q(std::size_t(m.n.nq));
  Random g{trial};
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    if (b.follower) continue;
    visit(b.type, [&]<class J>() {
      const double* high = J::translates && !J::angle ? far : near;
      for (int k = 0; k < 7; ++k) low[k] = -high[k];
      J::random(g, low, high, q.data() + b.user_q);
    });
  }
  return q;
}

struct Workspace {
  Zeros zeros;
  Data<double> d;
  Workspace(const Model& m, dynParts parts) : zeros(data_bytes<double>(m, parts)) {
    if (!zeros.memory) throw std::bad_alloc();
    data_layout(m, parts, zeros.memory, d);
  }
};

// What is left of the diagonal of M after elimination, relative to it; the largest over some configurations. NaN: M overflows.
std::vector<double> factor_pivots(const Model& m) {
  Workspace work(m, DYN_PART_CHOLESKY);
  Data<double>& d = work.d;
  std::vector<double> best(std::size_t(m.n.nv), 0);
  for (std::uint64_t trial = 1; trial <= 3; ++trial) {
    const auto q = generic_configuration(m, trial);
    std::copy(q.begin(), q.end(), d.q);
    d.changed(input_q);
    crba(m, d);
    const Index failed = factorize(m, d);
    // elimination goes from the last to the first: what a failure left out says nothing
    for (Index k = 0; k < failed - 1; ++k) best[std::size_t(k)] = 1;
    for (Index k = failed; k < m.n.nv; ++k)
      best[std::size_t(k)] = std::max(best[std::size_t(k)], 1 / (d.D[k] * d.M[k + std::ptrdiff_t(k) * m.n.nv]));
    for (Index k = 0; k < m.n.nv; ++k)
      if (!std::isfinite(d.M[k + std::ptrdiff_t(k) * m.n.nv])) best[std::size_t(k)] = NAN;
  }
  return best;
}

double trace(const Sym3<double>& A) { return A.d[0] + A.d[1] + A.d[2]; }

// The same along the tree: each articulated pivot relative to its value before the joints one level below gave way, so
// that long chains do not look singular. (Elimination of a body's children can only cancel what they brought.)
std::vector<double> articulated_pivots(const Model& m) {
  Workspace work(m, DYN_PART_KINEMATICS);
  Data<double>& d = work.d;
  std::vector<double> best(std::size_t(m.n.nv), 0);
  std::vector<ArticulatedInertia<double>> IA(static_cast<std::size_t>(m.n.bodies)), before(static_cast<std::size_t>(m.n.bodies));
  for (std::uint64_t trial = 1; trial <= 3; ++trial) {
    const auto q = generic_configuration(m, trial);
    std::copy(q.begin(), q.end(), d.q);
    d.changed(input_q);
    forward_kinematics<0>(m, d);
    for (Index i = 0; i < m.n.bodies; ++i)
      IA[std::size_t(i)] = before[std::size_t(i)] = ArticulatedInertia<double>::rigid(world_inertia(m.bodies()[i], d.R[i]));
    for (Index i = m.n.bodies - 1; i >= 1; --i) {
      const Body& b = m.bodies()[i];
      ArticulatedInertia<double> Y = IA[std::size_t(i)];
      const ArticulatedInertia<double> whole = Y;
      visit(b.type, [&]<class J>() {
        for (int k = 0; k < J::nv; ++k) {
          const Motion<double> s = J::column(b, d.R[i], k);
          const ArticulatedInertia<double>& rigid = before[std::size_t(i)];
          const double bound = trace(rigid.I) * dot(s.angular, s.angular) +
                               trace(rigid.M) * dot(s.linear, s.linear);  // whose rounding is no inertia
          const double armature = m.armature()[b.user_v + k], scale = std::max(dot(s, rigid * s), 0.1 * bound) + armature;
          const Force<double> U = Y * s;
          const double D = dot(s, U) + armature;
          const double pivot = scale > 0 ? D / scale : 0;
          double& largest = best[std::size_t(b.user_v + k)];
          largest = std::isfinite(scale) ? std::max(largest, pivot) : NAN;
          if (pivot > 1e-14) Y = Y.minus_outer(U, 1 / D);
        }
      });
      if (b.parent == 0) continue;
      const std::size_t p = std::size_t(b.parent);
      IA[p] = IA[p] + Y.shifted(d.r[i]);
      before[p] = before[p] + whole.shifted(d.r[i]);
    }
  }
  return best;
}

}  // namespace

// Beyond what six digits round, and what a radius of 10 nm makes. (Negative moments may be a part of a body: check_dynamics.)
void check_moments(const std::string& who, double mass, const std::array<double, 9>& inertia) {
  const Eigen::Matrix3d I = Eigen::Map<const Eigen::Matrix3d>(inertia.data());
  if (!I.allFinite()) return;
  const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(I, Eigen::EigenvaluesOnly).eigenvalues();
  const double slack = 1e-6 * moments[2] + mass * 1e-16;
  if (moments[0] >= -slack && moments[2] > moments[0] + moments[1] + slack)
    throw Error(DYN_ERROR_INVALID, who + ": the principal moments of its inertia are " + number(moments[0]) + ", " +
                                       number(moments[1]) + " and " + number(moments[2]) +
                                       " kg m^2, and no body has one above the sum of the other two");
}

// Forward dynamics must be defined: M positive at some configurations off the singular ones.
std::vector<std::string> check_dynamics(const Model& m, const std::vector<int>& order, const std::vector<JointEntry>& joints,
                                        const std::vector<FrameEntry>& frames, bool allow_massless) {
  std::vector<std::string> massless;
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    const int owner = order[std::size_t(b.joint - 1)];
    if (!finite(b))
      throw Error(DYN_ERROR_INVALID, "joint '" + joints[std::size_t(owner)].spec.name + "': the inertia of its body (" +
                                         links_of(frames, owner) +
                                         ") overflows: masses or distances are too large for double precision");
    const Eigen::Vector3d moments = principal_moments(b);
    const Vec3<double> c = b.m > 0 ? b.h * (1 / b.m) : Vec3<double>::zero();
    const double scale = std::max({std::abs(moments[0]), moments[2], 1e-6 * b.m * dot(c, c)});
    if (moments[0] < -1e-6 * scale) {
      const std::string message = "joint '" + joints[std::size_t(owner)].spec.name + "': the inertia of its body (" +
                                  links_of(frames, owner) + ") has a negative principal moment " + number(moments[0]) +
                                  " kg m^2: no mass distribution has that; correct the file";
      if (!allow_massless) throw Error(DYN_ERROR_INVALID, message);
      massless.push_back(message);
    }
  }
  if (m.n.nv == 0) return massless;
  const std::vector<double> pivots = m.has_mimic ? factor_pivots(m) : articulated_pivots(m);
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    if (b.follower) continue;  // its leader carries it
    for (Index k = 0; k < primitive_nv(b.type); ++k)
      if (!(pivots[std::size_t(b.user_v + k)] > 1e-13)) {
        const int joint = order[std::size_t(b.joint - 1)];
        if (std::isnan(pivots[std::size_t(b.user_v + k)]))
          throw Error(DYN_ERROR_INVALID, "joint '" + joints[std::size_t(joint)].spec.name +
                                             "': the inertia that it moves overflows: masses, distances or "
                                             "mimic ratios are too large for double precision");
        const std::string message =
            "joint '" + joints[std::size_t(joint)].spec.name + "': nothing resists it: " + links_of(frames, joint) +
            " and what hangs on it have no mass or inertia in its direction, so that forward dynamics is undefined; "
            "give the links an inertial, give the joint an armature, or make it fixed";
        if (!allow_massless || pivots[std::size_t(b.user_v + k)] > 0) throw Error(DYN_ERROR_INVALID, message);
        massless.push_back(message);
      }
  }
  return massless;
}

}  // namespace dyn
