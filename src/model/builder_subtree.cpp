// Parts of a robot: what a joint carries, or all but that.
#include <algorithm>

#include "builder_impl.hpp"
#include "constraint/list.hpp"
#include "table/sensors.hpp"

namespace dyn {

namespace {

int find_joint(const std::vector<JointEntry>& joints, const std::string& name) {
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (joints[j].spec.name == name) return int(j);
  throw Error(DYN_ERROR_NAME, "there is no moving joint '" + name + "'");
}

// Which joints hang on one, itself included; parents come first.
std::vector<bool> subtree_of(const std::vector<JointEntry>& joints, int root) {
  std::vector<bool> in(joints.size(), false);
  in[std::size_t(root)] = true;
  for (std::size_t j = std::size_t(root) + 1; j < joints.size(); ++j)
    in[j] = joints[j].parent >= 0 && in[std::size_t(joints[j].parent)];
  return in;
}

}  // namespace

void Builder::Impl::keep(const std::vector<bool>& kept, bool world) {
  split_configurations();
  names = {};
  std::vector<int> joint(joints.size(), -1), frame(frames.size(), -1);  // new index of each old one
  std::vector<JointEntry> left;
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (kept[j]) {
      joint[j] = int(left.size());
      left.push_back(std::move(joints[j]));
      if (left.back().parent >= 0) left.back().parent = joint[std::size_t(left.back().parent)];
    }
  joints = std::move(left);

  std::vector<FrameEntry> seen;
  frame_index.clear();
  for (std::size_t f = 0; f < frames.size(); ++f) {
    FrameEntry& e = frames[f];
    if (e.joint < 0 && f > 0 && !world) continue;
    if (e.joint >= 0 && (e.joint = joint[std::size_t(e.joint)]) < 0) continue;
    frame[f] = int(seen.size());
    e.parent = std::max(0, frame[std::size_t(e.parent)]);
    frame_index[e.name].push_back(frame[f]);
    seen.push_back(std::move(e));
  }
  frames = std::move(seen);
  std::vector<int> shape(shapes.size());
  for (std::size_t k = 0, next = 0; k < shapes.size(); ++k) shape[k] = frame[std::size_t(shapes[k].frame)] < 0 ? -1 : int(next++);
  std::erase_if(pairs, [&](PairEntry& p) {
    return (p.shape1 = shape[std::size_t(p.shape1)]) < 0 || (p.shape2 = shape[std::size_t(p.shape2)]) < 0;
  });
  std::erase_if(shapes, [&](const ShapeEntry& s) { return frame[std::size_t(s.frame)] < 0; });
  for (ShapeEntry& s : shapes) s.frame = frame[std::size_t(s.frame)];
  std::erase_if(disabled,
                [&](const DisabledEntry& p) { return frame[std::size_t(p.frame1)] < 0 || frame[std::size_t(p.frame2)] < 0; });
  for (DisabledEntry& p : disabled) p.frame1 = frame[std::size_t(p.frame1)], p.frame2 = frame[std::size_t(p.frame2)];

  // a tendon, a coupling or an actuator goes with anything that it needs
  const auto follow = [](const std::vector<int>& to, int& x) { return x < 0 || (x = to[std::size_t(x)]) >= 0; };
  std::vector<int> tendon(tendons.size(), -1);
  std::vector<TendonEntry> left_tendons;
  for (std::size_t k = 0; k < tendons.size(); ++k) {
    const bool whole = std::all_of(tendons[k].elements.begin(), tendons[k].elements.end(), [&](TendonElementEntry& e) {
      return follow(e.type == DYN_TENDON_ELEMENT_TYPE_JOINT ? joint : frame, e.id) && follow(frame, e.side);
    });
    if (!whole) continue;
    tendon[k] = int(left_tendons.size());
    left_tendons.push_back(std::move(tendons[k]));
  }
  tendons = std::move(left_tendons);
  std::erase_if(couplings, [&](TendonCoupling& c) { return !follow(tendon, c.tendon1) || !follow(tendon, c.tendon2); });
  std::vector<int> actuator(actuators.size(), -1);
  std::vector<ActuatorEntry> left_actuators;
  for (std::size_t k = 0; k < actuators.size(); ++k) {
    ActuatorEntry& a = actuators[k];
    const dynTransmission by = a.spec.transmission;
    const bool on_joint = by == DYN_TRANSMISSION_JOINT || by == DYN_TRANSMISSION_AXES;
    if (!follow(on_joint ? joint : by == DYN_TRANSMISSION_TENDON ? tendon : frame, a.target) ||
        !follow(frame, a.reference))
      continue;
    actuator[k] = int(left_actuators.size());
    left_actuators.push_back(std::move(a));
  }
  actuators = std::move(left_actuators);
  std::erase_if(sensors, [&](SensorEntry& s) {
    const SensorObject on = sensor_row(s.spec.quantity).object;
    const std::vector<int>& to = on == SensorObject::Joint      ? joint
                                 : on == SensorObject::Tendon   ? tendon
                                 : on == SensorObject::Actuator ? actuator
                                 : s.spec.side == DYN_SIDE_SHAPE ? shape
                                                                 : frame;
    return !follow(to, s.object) || !follow(s.spec.other_side == DYN_SIDE_SHAPE ? shape : frame, s.reference);
  });
  std::erase_if(force_limits, [&](ForceLimitEntry& x) { return !follow(x.tendon ? tendon : joint, x.target); });
  std::erase_if(constraints, [&](ConstraintEntry& c) {
    const std::vector<int>& at = between_joints(c.spec.type) ? joint : frame;
    const bool alone = between_joints(c.spec.type) && c.second < 0;
    c.first = c.first < 0 ? c.first : at[std::size_t(c.first)], c.second = c.second < 0 ? c.second : at[std::size_t(c.second)];
    if (c.first < 0 || (c.second < 0 && !alone)) return true;
    // two frames that a locked joint has made one body
    return !between_joints(c.spec.type) && frames[std::size_t(c.first)].joint == frames[std::size_t(c.second)].joint;
  });

  for (ConfigurationEntry& c : configurations) {
    for (auto* numbers : {&c.by_joint, &c.v_by_joint}) {
      numbers->resize(joint.size());
      std::vector<std::vector<double>> own(joints.size());
      for (std::size_t j = 0; j < joint.size(); ++j)
        if (joint[j] >= 0) own[std::size_t(joint[j])] = std::move((*numbers)[j]);
      *numbers = std::move(own);
    }
    std::erase_if(c.actuators, [&](const auto& x) {
      return std::none_of(actuators.begin(), actuators.end(), [&](const ActuatorEntry& a) { return a.name == x.first; });
    });
  }
}

// A follower can't go without its leader.
static void check_leaders(const std::vector<JointEntry>& joints, const std::vector<bool>& kept, const std::string& who) {
  const std::vector<Leader> leaders = resolve_mimic(joints);
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (kept[j] && leaders[j].joint >= 0 && !kept[std::size_t(leaders[j].joint)])
      throw Error(DYN_ERROR_INVALID, who + ": joint '" + joints[j].spec.name + "' stays and follows '" +
                                         joints[std::size_t(leaders[j].joint)].spec.name +
                                         "', which doesn't: lock the leader first");
}

// Followers of followers that go follow who leads them.
static void follow_leaders(std::vector<JointEntry>& joints) {
  const std::vector<Leader> leaders = resolve_mimic(joints);
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (leaders[j].joint >= 0) {
      JointSpec& s = joints[j].spec;
      s.mimic = joints[std::size_t(leaders[j].joint)].spec.name, s.mimic_ratio = leaders[j].ratio,
      s.mimic_offset = leaders[j].offset;
    }
}

void Builder::subtree(const std::string& root) {
  Impl next = *impl;
  const std::vector<bool> kept = subtree_of(next.joints, find_joint(next.joints, root));
  check_leaders(next.joints, kept, "subtree of '" + root + "'");
  follow_leaders(next.joints);
  next.keep(kept, false);
  *impl = std::move(next);
}

void Builder::remove(const std::string& root) {
  Impl next = *impl;
  std::vector<bool> kept = subtree_of(next.joints, find_joint(next.joints, root));
  kept.flip();
  check_leaders(next.joints, kept, "remove '" + root + "'");
  follow_leaders(next.joints);
  next.keep(kept);
  *impl = std::move(next);
}

}  // namespace dyn
