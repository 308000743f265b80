// Random robots with every joint type, and their build with mimic joints, without them, or in other units.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "common/every.hpp"
#include "common/eigen.hpp"
#include "model/builder.hpp"
#include "model/model.hpp"

namespace dyn_test {

inline Placement placement(const M4& X) {
  Placement out;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 3; ++r) out[std::size_t(3 * c + r)] = X(r, c);
  return out;
}
inline std::array<double, 3> array3(const V3& a) { return {a[0], a[1], a[2]}; }
inline std::array<double, 9> array9(const M3& A) {
  std::array<double, 9> out;
  std::copy(A.data(), A.data() + 9, out.begin());
  return out;
}

struct BodySpec {
  std::string name, parent;
  M4 placement = M4::Identity();
  double mass = 1;
  V3 com = V3::Zero();
  M3 inertia = M3::Identity();  // about the centre of mass
};

// 1: a length, 0: an angle (or a number without unit), for each coordinate of q (nq) or v (nv)
inline std::vector<int> lengths(const JointSpec& s, bool of_q) {
  switch (s.type) {
    case DYN_JOINT_TYPE_PRISMATIC: return {1};
    case DYN_JOINT_TYPE_CYLINDRICAL: return {0, 1};
    case DYN_JOINT_TYPE_PLANAR: return {1, 1, 0};
    case DYN_JOINT_TYPE_TRANSLATION: return {1, 1, 1};
    case DYN_JOINT_TYPE_FREE_FLYER: return of_q ? std::vector<int>{1, 1, 1, 0, 0, 0, 0} : std::vector<int>{1, 1, 1, 0, 0, 0};
    case DYN_JOINT_TYPE_COMPOSITE: {
      std::vector<int> all;
      for (const JointSpec& p : s.parts)
        for (int x : lengths(p, of_q)) all.push_back(x);
      return all;
    }
    default: return std::vector<int>(std::size_t(of_q ? joint_nq(s.type) : joint_nv(s.type)), 0);
  }
}

struct Tree {
  std::vector<JointSpec> joints;  // fixed ones included, parents first
  std::vector<BodySpec> bodies;
  std::vector<BodySpec> frames;  // name, parent, placement
  V3 gravity = V3(0.3, -0.4, -9.7);

  ModelPtr build(bool mimic = true) const {
    Builder b("tree");
    b.gravity(array3(gravity));
    for (JointSpec s : joints) {
      if (!mimic) s.mimic.clear();
      b.joint(s);
    }
    for (const BodySpec& s : bodies)
      b.body(s.name, {s.parent, 0}, dyn_test::placement(s.placement), s.mass, array3(s.com), array9(s.inertia));
    for (const BodySpec& s : frames) b.frame(s.name, {s.parent, 0}, dyn_test::placement(s.placement), DYN_FRAME_TYPE_OP_FRAME);
    return b.finish();
  }
  const JointSpec& joint(const std::string& name) const {
    return *std::find_if(joints.begin(), joints.end(), [&](const JointSpec& s) { return s.name == name; });
  }

  // The same robot when lengths are counted in units 1/L and masses in 1/M.
  static void scale(JointSpec& s, double L, double M, const Tree& tree) {
    for (std::size_t k = 9; k < 12; ++k) s.placement[k] *= L;
    s.pitch *= L;
    const auto q = lengths(s, true), v = lengths(s, false);
    for (std::size_t k = 0; k < s.lower.size(); ++k)
      if (q[k]) s.lower[k] *= L, s.upper[k] *= L;
    for (std::size_t k = 0; k < s.armature.size(); ++k) s.armature[k] *= v[k] ? M : M * L * L;
    if (!s.mimic.empty()) {
      const double own = v[0] ? L : 1, leader = lengths(tree.joint(s.mimic), false)[0] ? L : 1;
      s.mimic_ratio *= own / leader, s.mimic_offset *= own;
    }
    for (JointSpec& p : s.parts) scale(p, L, M, tree);
  }
  Tree scaled(double L, double M) const {
    Tree t = *this;
    for (JointSpec& s : t.joints) scale(s, L, M, *this);
    for (auto* list : {&t.bodies, &t.frames})
      for (BodySpec& s : *list) s.placement.topRightCorner<3, 1>() *= L, s.mass *= M, s.com *= L, s.inertia *= M * L * L;
    t.gravity *= L;
    return t;
  }
};

struct TreeOptions {
  int joints = 0;  // 0: 1 to 60, by the seed
  double mimic = 0.15, armature = 0.3, massless = 0.1, branch = 0.35, resistance = 0;
  std::vector<dynJointType> types;  // empty: all
};

// A box of random sizes: its moments obey the triangle inequality.
inline BodySpec random_body(Dice& dice, const std::string& name, const std::string& parent) {
  BodySpec b;
  b.name = name, b.parent = parent;
  b.placement = dice.pose(0.1);
  b.mass = dice.in(0.5, 2);
  b.com = dice.vector(3, 0.1);
  const double x = dice.in(0.1, 0.4), y = dice.in(0.1, 0.4), z = dice.in(0.1, 0.4);
  const M3 R = dice.rotation();
  b.inertia = R * V3(y * y + z * z, x * x + z * z, x * x + y * y).asDiagonal() * R.transpose() * b.mass;
  b.inertia = (0.5 * (b.inertia + b.inertia.transpose())).eval();
  return b;
}

inline JointSpec random_joint(Dice& dice, dynJointType type) {
  JointSpec s;
  s.type = type;
  s.placement = placement(dice.pose(0.3));
  s.axis = array3(dice.direction() * dice.in(0.1, 10));
  s.axis2 = array3(dice.direction());
  s.pitch = dice.in(-0.3, 0.3);
  if (type == DYN_JOINT_TYPE_COMPOSITE) {
    // at most three rotations and three translations, so that the motion has full rank
    static const std::vector<std::vector<dynJointType>> recipes = {
        {DYN_JOINT_TYPE_REVOLUTE, DYN_JOINT_TYPE_PRISMATIC},
        {DYN_JOINT_TYPE_FIXED, DYN_JOINT_TYPE_REVOLUTE},
        {DYN_JOINT_TYPE_PRISMATIC, DYN_JOINT_TYPE_SPHERICAL},
        {DYN_JOINT_TYPE_CYLINDRICAL, DYN_JOINT_TYPE_REVOLUTE},
        {DYN_JOINT_TYPE_PLANAR, DYN_JOINT_TYPE_UNIVERSAL},
        {DYN_JOINT_TYPE_TRANSLATION, DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED, DYN_JOINT_TYPE_REVOLUTE},
        {DYN_JOINT_TYPE_HELICAL, DYN_JOINT_TYPE_FIXED, DYN_JOINT_TYPE_COMPOSITE}};
    for (dynJointType part : recipes[std::size_t(dice.below(int(recipes.size())))]) {
      s.parts.push_back(random_joint(dice, part == DYN_JOINT_TYPE_COMPOSITE ? DYN_JOINT_TYPE_PRISMATIC : part));
      if (part == DYN_JOINT_TYPE_COMPOSITE) {  // a composite inside a composite
        JointSpec inner;
        inner.type = DYN_JOINT_TYPE_COMPOSITE;
        inner.placement = placement(dice.pose(0.3));
        inner.parts = {s.parts.back()};
        s.parts.back() = inner;
      }
    }
  }
  const std::size_t nq = std::size_t(spec_nq(s));
  const double range = type == DYN_JOINT_TYPE_SPHERICAL_ZYX ? 1
                       : type == DYN_JOINT_TYPE_REVOLUTE    ? 3
                                                            : 0.8;  // zyx: off gimbal lock
  s.lower.assign(nq, -range), s.upper.assign(nq, range);
  return s;
}

inline const std::vector<dynJointType>& moving_types() {
  static const std::vector<dynJointType> all = [] {
    std::vector<dynJointType> types = every<dynJointType>("dynJointType");
    std::erase(types, DYN_JOINT_TYPE_FIXED);
    return types;
  }();
  return all;
}

// Every coefficient but armature for a joint, each with the given chance.
inline void add_resistance(Dice& dice, double chance, JointSpec& s) {
  const std::size_t nv = std::size_t(spec_nv(s));
#define COEFFICIENT(name, has, sentence) &s.name,
  for (auto* x : {
#include "effect/coefficients.def"
       })
    if (x != &s.armature && dice.chance(chance))
      for (std::size_t k = 0; k < nv; ++k) x->push_back(dice.in(0, 3));
  if (s.stiffness.empty()) return;
  if (s.type == DYN_JOINT_TYPE_SPHERICAL) {
    const V3 q = dice.direction() * dice.in(0.2, 0.6);
    s.stiffness[1] = s.stiffness[2] = s.stiffness[0];
    s.spring_reference = {q[0], q[1], q[2], 1};
  } else if (s.type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED) {
    s.spring_reference = {1, dice.in(-1, 1)};
  } else if (s.type == DYN_JOINT_TYPE_FREE_FLYER || spec_nq(s) != spec_nv(s)) {
    s.stiffness.clear();
  } else {
    for (std::size_t k = 0; k < nv; ++k) s.spring_reference.push_back(dice.in(-1, 1));
  }
}

inline Tree random_tree(std::uint64_t seed, const TreeOptions& options = {}) {
  Dice dice(seed * 7919 + 17);
  Tree tree;
  const auto& types = options.types.empty() ? moving_types() : options.types;
  const int n = options.joints ? options.joints : 1 + dice.below(60);
  std::vector<int> parent, simple;  // simple: of one coordinate
  for (int j = 0; j < n; ++j) {
    // one-coordinate joints are half of all, as in robots
    const bool single = options.types.empty() && dice.chance(0.4);
    JointSpec s = random_joint(
        dice, single ? moving_types()[std::size_t(dice.below(4))] : types[std::size_t(dice.below(int(types.size())))]);
    s.name = "j" + std::to_string(j);
    parent.push_back(j == 0 ? -1 : dice.chance(options.branch) ? dice.below(j + 1) - 1 : j - 1);
    if (parent.back() >= 0) s.parent.name = "j" + std::to_string(parent.back());
    if (dice.chance(options.armature)) {
      s.armature.assign(std::size_t(spec_nv(s)), 0);
      for (double& x : s.armature) x = dice.in(0, 0.2);
    }
    if (spec_nq(s) == 1) simple.push_back(j);
    tree.joints.push_back(s);
    tree.bodies.push_back(random_body(dice, "b" + std::to_string(j), s.name));
    BodySpec frame;
    frame.name = "f" + std::to_string(j), frame.parent = s.name, frame.placement = dice.pose(0.3);
    tree.frames.push_back(frame);
    if (dice.chance(0.2)) {  // a link welded on
      JointSpec weld;
      weld.name = "weld" + std::to_string(j), weld.type = DYN_JOINT_TYPE_FIXED, weld.parent.name = s.name,
      weld.placement = placement(dice.pose(0.2));
      tree.joints.push_back(weld);
      tree.bodies.push_back(random_body(dice, "w" + std::to_string(j), weld.name));
    }
  }
  // joints without mass of their own before another simple joint that has it
  for (int j = 0; j + 1 < n; ++j) {
    const bool both = std::count(simple.begin(), simple.end(), j) && std::count(simple.begin(), simple.end(), j + 1);
    if (!both || parent[std::size_t(j + 1)] != j || !dice.chance(options.massless)) continue;
    const std::string own = "b" + std::to_string(j), next = "b" + std::to_string(j + 1);
    const bool carried = std::any_of(tree.bodies.begin(), tree.bodies.end(), [&](const BodySpec& b) { return b.name == next; });
    if (carried) std::erase_if(tree.bodies, [&](const BodySpec& b) { return b.name == own; });
    ++j;
  }
  // mimic: a random order in which followers follow someone before them, so that there is no cycle; in the tree the leader
  // may well come later
  for (std::size_t k = simple.size(); k > 1; --k) std::swap(simple[k - 1], simple[std::size_t(dice.below(int(k)))]);
  for (std::size_t k = 1; k < simple.size(); ++k) {
    if (!dice.chance(options.mimic)) continue;
    JointSpec& s = *std::find_if(tree.joints.begin(), tree.joints.end(),
                                 [&](const JointSpec& x) { return x.name == "j" + std::to_string(simple[k]); });
    s.mimic = "j" + std::to_string(simple[std::size_t(dice.below(int(k)))]);
    s.mimic_ratio = dice.in(-1.5, 1.5), s.mimic_offset = dice.in(-0.5, 0.5);
  }
  Dice own(seed + 101);  // so that the robots are the same without
  if (options.resistance > 0)
    for (JointSpec& s : tree.joints)
      if (s.type != DYN_JOINT_TYPE_FIXED) add_resistance(own, options.resistance, s);
  return tree;
}

inline constexpr int tree_count = 200;

}  // namespace dyn_test
