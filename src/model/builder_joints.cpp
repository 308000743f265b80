// Joints of a model: their coordinates, the bodies that they move, and the coefficients of their degrees of freedom.
#include "builder_compile.hpp"
#include "effect/list.hpp"
#include "joint/list.hpp"

namespace dyn {

namespace {

// Copies numbers, if there are any, to where the joint's begin.
void put(const std::vector<double>& from, std::vector<double>& to, Index at) {
  std::copy(from.begin(), from.end(), to.begin() + at);
}

}  // namespace

void Compiler::add_universe() {
  Body world{};
  world.h = Vec3<double>::zero();
  world.I = Mat3<double>::zero();
  world.ratio = 1;
  a.bodies.push_back(world);
  a.joint_placement.push_back(SE3<double>::identity());
  JointRecord universe{};
  universe.C = Mat3<double>::identity();
  universe.name = text.add("universe");
  universe.type = DYN_JOINT_TYPE_FIXED;
  universe.leader = -1, universe.ratio = 1;
  store_se3(SE3<double>::identity(), universe.placement);
  a.joints.push_back(universe);
}

void Compiler::assign_coordinates() {
  idx_q.resize(in.joints.size()), idx_v.resize(in.joints.size());
  for (int j : order)
    if (leaders[std::size_t(j)].joint < 0) {
      idx_q[std::size_t(j)] = n.nq, idx_v[std::size_t(j)] = n.nv;
      n.nq += spec_nq(in.joints[std::size_t(j)].spec), n.nv += spec_nv(in.joints[std::size_t(j)].spec);
    }
  for (int j : order)
    if (leaders[std::size_t(j)].joint >= 0) {
      idx_q[std::size_t(j)] = idx_q[std::size_t(leaders[std::size_t(j)].joint)];
      idx_v[std::size_t(j)] = idx_v[std::size_t(leaders[std::size_t(j)].joint)];
    }
}

void Compiler::size_coordinate_arrays() {
  if (std::size_t(n.nv) > 1000000) throw Error(DYN_ERROR_LIMIT, "the model has more than 1,000,000 degrees of freedom");
  constexpr double inf = std::numeric_limits<double>::infinity();
  for_each_effect([&]<class E>() {
    if constexpr (effect::HasCoefficient<E>) E::of(a).assign(std::size_t(n.nv), 0);
  });
  a.velocity_limit.assign(std::size_t(n.nv), inf), a.effort_limit = a.velocity_limit;
  a.lower_limit.assign(std::size_t(n.nq), -inf), a.upper_limit.assign(std::size_t(n.nq), inf);
  a.neutral.assign(std::size_t(n.nq), 0), a.spring_reference = a.neutral;
  a.own_v.assign(std::size_t(n.nv), 0);
}

void Compiler::add_joints() {
  for (const int j : order) add_joint(j);
  n.bodies = Index(a.bodies.size()), n.parts = Index(a.parts.size());
  if (mimic) {
    n.mimic_q = n.nqx, n.mimic_v = n.nvx;
  } else {
    a.expand_q.clear(), a.ratio_q.clear(), a.offset_q.clear(), a.expand_v.clear(), a.ratio_v.clear(), a.own_v.clear();
  }
}

void Compiler::add_joint(int j) {
  const JointEntry& e = in.joints[std::size_t(j)];
  const Leader& l = leaders[std::size_t(j)];
  const bool follower = l.joint >= 0;
  mimic |= follower;
  JointRecord r{};
  r.name = text.add(e.spec.name);
  r.type = e.spec.type;
  r.parent = e.parent < 0 ? 0 : id[std::size_t(e.parent)];
  r.idx_q = idx_q[std::size_t(j)], r.idx_v = idx_v[std::size_t(j)];
  r.nq = follower ? 0 : spec_nq(e.spec), r.nv = follower ? 0 : spec_nv(e.spec);
  r.leader = follower ? id[std::size_t(l.joint)] : -1;
  r.ratio = l.ratio, r.offset = l.offset;
  std::copy(e.spec.axis.begin(), e.spec.axis.end(), r.axis);
  std::copy(e.spec.axis2.begin(), e.spec.axis2.end(), r.axis2);
  r.pitch = e.spec.pitch;
  store_se3(e.placement, r.placement);
  r.first_body = Index(a.bodies.size());
  add_bodies(e, l, r);
  if (e.spec.type == DYN_JOINT_TYPE_COMPOSITE) add_parts(e, r);
  add_coefficients(e.spec, l, r);
  if (!follower) {
    put(e.spec.lower, a.lower_limit, r.idx_q), put(e.spec.upper, a.upper_limit, r.idx_q);
    put(e.spec.velocity, a.velocity_limit, r.idx_v), put(e.spec.effort, a.effort_limit, r.idx_v);
  }
  a.joints.push_back(r);
}

void Compiler::add_bodies(const JointEntry& e, const Leader& l, JointRecord& r) {
  const bool follower = r.leader >= 0;
  const JointRecord& parent = a.joints[std::size_t(r.parent)];
  SE3<double> before = rotation_only(parent.C) * e.placement;
  Index body_parent = parent.last_body, user_q = r.idx_q, user_v = r.idx_v;
  for (const PlacedElement& part : e.elements) {
    const Mat3<double> Z = z_to(part.element.axis);
    const SE3<double> X = before * part.before * rotation_only(Z);
    Body b{};
    b.h = Vec3<double>::zero(), b.I = Mat3<double>::zero();
    b.pitch = part.element.pitch, b.wraps = part.element.wraps;
    b.ratio = l.ratio, b.follower = follower;
    b.type = part.element.type;
    b.parent = body_parent;
    b.idx_q = n.nqx, b.idx_v = n.nvx;
    b.user_q = user_q, b.user_v = user_v;
    b.joint = Index(a.joints.size());
    visit(b.type, [&]<class J>() {
      if (!follower) J::neutral(a.neutral.data() + user_q), J::neutral(a.spring_reference.data() + user_q);
    });
    const Index nq = primitive_nq(b.type), nv = primitive_nv(b.type);
    for (Index k = 0; k < nq; ++k) a.expand_q.push_back(user_q + k), a.ratio_q.push_back(l.ratio), a.offset_q.push_back(l.offset);
    for (Index k = 0; k < nv; ++k) {
      a.expand_v.push_back(user_v + k), a.ratio_v.push_back(l.ratio);
      if (follower) a.followers.push_back(n.nvx + k);
      else a.own_v[std::size_t(user_v + k)] = n.nvx + k;
    }
    n.nqx += nq, n.nvx += nv, user_q += nq, user_v += nv;
    body_parent = Index(a.bodies.size());
    before = rotation_only(transpose(Z));
    a.bodies.push_back(b);
    a.joint_placement.push_back(X);
  }
  r.last_body = body_parent;
  r.C = before.R;
}

void Compiler::add_parts(const JointEntry& e, JointRecord& r) {
  r.first_part = Index(a.parts.size()), r.parts = Index(e.parts.size());
  for (const JointPart& p : e.parts) {
    PartRecord part{};
    part.type = p.type, part.pitch = p.pitch;
    std::copy(p.axis.begin(), p.axis.end(), part.axis);
    std::copy(p.axis2.begin(), p.axis2.end(), part.axis2);
    store_se3(p.before, part.placement);
    a.parts.push_back(part);
  }
}

// A follower's rotor turns with its leader.
void Compiler::add_coefficients(const JointSpec& s, const Leader& l, JointRecord& r) {
  for_each_effect([&]<class E>() {
    if constexpr (effect::HasCoefficient<E>) {
      if (spec_nv(s) != 1) return put(E::of(s), E::of(a), r.idx_v);
      E::of(r) = E::own(s);
      if constexpr (!effect::OfConfiguration<E>) E::of(a)[std::size_t(r.idx_v)] += E::reflected(l.ratio, E::of(r));
    }
  });
  if (spec_nq(s) == 1) {
    r.spring_reference = s.spring_reference.empty() ? 0 : s.spring_reference[0];
    // two springs are one: stiffness and moment about q = 0 add up
    double &k = a.stiffness[std::size_t(r.idx_v)], &at = a.spring_reference[std::size_t(r.idx_q)];
    const double added = l.ratio * l.ratio * r.stiffness, rest = (r.spring_reference - l.offset) / l.ratio;
    if (added > 0) at = k > 0 ? (k * at + added * rest) / (k + added) : rest, k += added;
  } else {
    put(s.spring_reference, a.spring_reference, r.idx_q);
    if (spec_nv(s) == 1) a.stiffness[std::size_t(r.idx_v)] = r.stiffness;
  }
}

}  // namespace dyn
