// Joints locked at a configuration: each becomes a fixed frame of what carries it, and its links part of that body.
#include <algorithm>
#include <cmath>

#include "builder_impl.hpp"
#include "base/portable.hpp"
#include "joint/list.hpp"

namespace dyn {

namespace {

constexpr double norm_tolerance = 1e-6;

// The joint's user frame at q in the joint frame.
SE3<double> transform(const JointEntry& joint, const double* q) {
  SE3<double> X = SE3<double>::identity();
  for (const PlacedElement& e : joint.elements) {
    Body b{};
    b.pitch = e.element.pitch;
    const Mat3<double> Z = z_to(e.element.axis);
    X = X * e.before;
    X.R = X.R * Z;
    visit(e.element.type, [&]<class J>() {
      J::place(b, q, math::cos(q[0]), math::sin(q[0]), X);
      q += J::nq;
    });
    X.R = X.R * transpose(Z);
  }
  return X;
}

double norm_error(const JointEntry& joint, const double* q) {
  double worst = 0;
  for (const PlacedElement& e : joint.elements)
    visit(e.element.type, [&]<class J>() {
      worst = std::max(worst, J::norm_error(q));
      q += J::nq;
    });
  return worst;
}

// Limits of orientations and (cos, sin) pairs mean nothing.
void check_limits(const JointEntry& joint, const std::vector<double>& q) {
  std::size_t first = 0;
  for (const PlacedElement& e : joint.elements)
    visit(e.element.type, [&]<class J>() {
      const std::size_t bounded = J::nq == J::nv ? J::nq : J::translates ? 3 : 0;
      for (std::size_t k = first; k < first + bounded; ++k) {
        const double low = joint.spec.lower.empty() ? -HUGE_VAL : joint.spec.lower[k],
                     high = joint.spec.upper.empty() ? HUGE_VAL : joint.spec.upper[k];
        if (q[k] < low || q[k] > high)
          throw Error(DYN_ERROR_INVALID, "lock: joint '" + joint.spec.name + "' is at " + number(q[k]) +
                                             (q.size() > 1 ? " (its coordinate " + std::to_string(k) + ")" : "") +
                                             ", outside of its limits, " + number(low) + " to " + number(high) +
                                             ": lock it within them");
      }
      first += J::nq;
    });
}

// The joints to lock: those named, and whoever follows them.
std::vector<bool> marked(const std::vector<JointEntry>& joints, const std::vector<Leader>& leaders,
                         const std::vector<std::string>& names) {
  std::vector<bool> locked(joints.size(), false);
  for (const std::string& name : names) {
    const auto at = std::find_if(joints.begin(), joints.end(), [&](const JointEntry& e) { return e.spec.name == name; });
    if (at == joints.end()) throw Error(DYN_ERROR_NAME, "lock: there is no moving joint '" + name + "'");
    if (locked[std::size_t(at - joints.begin())])
      throw Error(DYN_ERROR_NAME, "lock: joint '" + name + "' is named twice: name it once");
    locked[std::size_t(at - joints.begin())] = true;
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (leaders[j].joint < 0) continue;
    const bool leader = locked[std::size_t(leaders[j].joint)];
    if (locked[j] && !leader) {
      const std::string& name = joints[std::size_t(leaders[j].joint)].spec.name;
      throw Error(DYN_ERROR_INVALID, "lock: joint '" + joints[j].spec.name + "' follows '" + name +
                                         "', which is not locked: lock '" + name + "', and it is locked, too");
    }
  }
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (leaders[j].joint >= 0) locked[j] = locked[std::size_t(leaders[j].joint)];
  return locked;
}

}  // namespace

void Builder::lock(const std::vector<std::string>& names, const std::vector<double>& q) {
  Impl next = *impl;
  std::vector<JointEntry>& joints = next.joints;
  const std::vector<Leader> leaders = resolve_mimic(joints);
  std::size_t nq = 0;
  for (const JointEntry& e : joints) nq += std::size_t(own_nq(e));
  if (q.size() != nq)
    throw Error(DYN_ERROR_SIZE, "lock: q has " + std::to_string(q.size()) + " numbers, needs nq = " + std::to_string(nq));
  for (std::size_t k = 0; k < nq; ++k)
    if (!std::isfinite(q[k]))
      throw Error(DYN_ERROR_NONFINITE, "lock: q[" + std::to_string(k) + "] is " + number(q[k]) + ": give a finite number");
  std::vector<std::vector<double>> own = by_joint(joints, q);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (leaders[j].joint >= 0) continue;
    const double error = norm_error(joints[j], own[j].data());
    if (!(error <= norm_tolerance))
      throw Error(DYN_ERROR_QUATERNION, "lock: the quaternion or (cos, sin) of joint '" + joints[j].spec.name +
                                            "' has a norm that is off 1 by " + number(error) + ": normalize q");
  }
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (leaders[j].joint >= 0) own[j] = {leaders[j].ratio * own[std::size_t(leaders[j].joint)][0] + leaders[j].offset};
  std::vector<bool> locked = marked(joints, leaders, names);

  // from the root to the leaves: what a locked joint carries goes over to what carries it
  std::vector<SE3<double>> X(joints.size(), SE3<double>::identity());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    JointEntry& e = joints[j];
    if (e.parent >= 0 && locked[std::size_t(e.parent)]) {
      e.placement = X[std::size_t(e.parent)] * e.placement;
      e.parent = joints[std::size_t(e.parent)].parent;
    }
    if (!locked[j]) continue;
    check_limits(e, own[j]);
    X[j] = e.placement * transform(e, own[j].data());
  }
  for (FrameEntry& f : next.frames) {
    if (f.joint < 0 || !locked[std::size_t(f.joint)]) continue;
    const std::size_t j = std::size_t(f.joint);
    if (f.type == DYN_FRAME_TYPE_JOINT) f.type = DYN_FRAME_TYPE_FIXED_JOINT;
    f.X = X[j] * f.X;
    f.Y = act(f.X, Inertia<double>::at_com(f.mass, load3(f.com.data()), load33(f.inertia.data())));
    f.joint = joints[j].parent;
  }
  locked.flip();
  next.keep(locked);
  *impl = std::move(next);
}

}  // namespace dyn
