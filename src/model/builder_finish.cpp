// Compiles what a builder has collected into a model: depth-first order, internal frames with z along each axis, merged
// inertias, the expanded coordinates of mimic joints, and one block of memory.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <numeric>

#include "builder_impl.hpp"
#include "dyn/algorithm/aba.hpp"
#include "dyn/algorithm/cholesky.hpp"
#include "dyn/algorithm/crba.hpp"

namespace dyn {

namespace {

// Depth from which CRBA by columns is the faster one (measured on chains).
constexpr Index deep_from = 10;

// All strings of the model, each once at its end.
struct Text {
  std::string pool = std::string(1, '\0');
  Index add(const std::string& s) {
    if (s.empty()) return 0;
    const Index at = Index(pool.size());
    pool.append(s.c_str(), s.size() + 1);
    return at;
  }
};

// The model's arrays on their way into one block.
struct Arrays {
#define FIELD(type, name, count, sentence) std::vector<type> name;
#include "dyn/model/model_fields.def"
#undef FIELD
};

struct Leader {
  int joint;
  double ratio, offset;
};

// Follows mimic of mimic to the joint that moves by itself.
std::vector<Leader> resolve_mimic(const std::vector<JointEntry>& joints) {
  std::unordered_map<std::string, int> index;
  for (std::size_t j = 0; j < joints.size(); ++j) index[joints[j].spec.name] = int(j);
  const int n = int(joints.size());
  std::vector<Leader> leader(joints.size(), {-2, 1, 0});  // -2: not resolved yet
  std::vector<int> path;
  for (int j = 0; j < n; ++j) {
    path.clear();
    int at = j;
    while (leader[std::size_t(at)].joint == -2 && !joints[std::size_t(at)].spec.mimic.empty()) {
      if (int(path.size()) > n || std::find(path.begin(), path.end(), at) != path.end())
        throw Error(DYN_ERROR_INVALID, "joint '" + joints[std::size_t(at)].spec.name + "': mimic goes round in a circle: one joint of it must move by itself");
      path.push_back(at);
      const JointSpec& s = joints[std::size_t(at)].spec;
      const auto it = index.find(s.mimic);
      if (it == index.end())
        throw Error(DYN_ERROR_NAME, "joint '" + s.name + "': mimics '" + s.mimic + "', which is no moving joint of this model");
      at = it->second;
      if (path.size() > 1000) throw Error(DYN_ERROR_LIMIT, "joint '" + s.name + "': mimic of mimic more than 1000 deep");
    }
    Leader base = leader[std::size_t(at)];
    if (base.joint < 0) base = {at, 1, 0};
    if (path.empty()) {
      leader[std::size_t(at)] = {-1, 1, 0};
      continue;
    }
    if (spec_nq(joints[std::size_t(base.joint)].spec) != 1)
      throw Error(DYN_ERROR_INVALID, "joint '" + joints[std::size_t(j)].spec.name + "': mimics '" + joints[std::size_t(base.joint)].spec.name +
                                         "', which has more than one coordinate: only joints with one can lead");
    for (auto k = path.rbegin(); k != path.rend(); ++k) {
      const JointSpec& s = joints[std::size_t(*k)].spec;
      base = {base.joint, s.mimic_ratio * base.ratio, s.mimic_ratio * base.offset + s.mimic_offset};
      leader[std::size_t(*k)] = base;
    }
  }
  for (Leader& l : leader)
    if (l.joint == -2) l.joint = -1;
  return leader;
}

// Joints depth first, siblings in the order of addition.
std::vector<int> depth_first(const std::vector<JointEntry>& joints) {
  const std::size_t n = joints.size();
  std::vector<int> first_child(n + 1, -1), next(n, -1), last_child(n + 1, -1), order;
  for (std::size_t j = 0; j < n; ++j) {
    const std::size_t p = std::size_t(joints[j].parent + 1);
    (last_child[p] < 0 ? first_child[p] : next[std::size_t(last_child[p])]) = int(j);
    last_child[p] = int(j);
  }
  order.reserve(n);
  std::vector<int> stack;
  int at = first_child[0];
  while (at >= 0 || !stack.empty()) {
    if (at < 0) {
      at = next[std::size_t(stack.back())];
      stack.pop_back();
      continue;
    }
    order.push_back(at);
    stack.push_back(at);
    at = first_child[std::size_t(at) + 1];
  }
  return order;
}

SE3<double> rotation_only(const Mat3<double>& R) { return {R, Vec3<double>::zero()}; }

int primitive_nq(BodyType t) {
  int n = 0;
  visit(t, [&]<class J>() { n = J::nq; });
  return n;
}
int primitive_nv(BodyType t) {
  int n = 0;
  visit(t, [&]<class J>() { n = J::nv; });
  return n;
}

std::atomic<std::uint64_t> next_id{1};

// Elimination tree of M (Liu 1990): with mimic joints the pattern is that of G^T M_x G.
void elimination_tree(const Model& m, std::vector<Index>& parent) {
  const Index nv = m.n.nv;
  parent.assign(std::size_t(nv), -1);
  const Body* bodies = m.bodies();
  if (!m.has_mimic) {
    std::vector<Index> last(std::size_t(m.n.bodies), -1);  // last degree of freedom at or above a body
    for (Index i = 1; i < m.n.bodies; ++i) {
      Index before = last[std::size_t(bodies[i].parent)];
      const Index end = i + 1 < m.n.bodies ? bodies[i + 1].idx_v : nv;
      for (Index k = bodies[i].idx_v; k < end; ++k) parent[std::size_t(k)] = before, before = k;
      last[std::size_t(i)] = before;
    }
    return;
  }
  // It is enough to join each degree of freedom with what carries it, up to the first that is no follower: elimination
  // fills in the rest.
  std::vector<std::vector<Index>> row(static_cast<std::size_t>(nv));  // columns j < i of each row
  auto join = [&](Index a, Index b) {
    if (a != b) row[std::size_t(std::max(a, b))].push_back(std::min(a, b));
  };
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = bodies[i];
    const Index nvb = first_dof(m, i + 1) - b.idx_v;
    for (Index k = 1; k < nvb; ++k) join(b.user_v + k, b.user_v + k - 1);
    for (Index s = b.parent; s != 0; s = bodies[s].parent) {
      for (Index k = 0; k < nvb; ++k)
        for (Index x = 0; x < first_dof(m, s + 1) - bodies[s].idx_v; ++x) join(b.user_v + k, bodies[s].user_v + x);
      if (!bodies[s].follower) break;
    }
  }
  std::size_t filled = 0;
  for (Index i = nv - 1; i >= 0; --i) {
    auto& r = row[std::size_t(i)];
    std::sort(r.begin(), r.end());
    r.erase(std::unique(r.begin(), r.end()), r.end());
    if (r.empty()) continue;
    parent[std::size_t(i)] = r.back();
    auto& up = row[std::size_t(r.back())];
    up.insert(up.end(), r.begin(), r.end() - 1);
    if ((filled += r.size()) > 100000000) throw Error(DYN_ERROR_LIMIT, "the model has too many mimic joints for its depth: M has no sparse factor");
    std::vector<Index>().swap(r);
  }
}

// Principal moments about the centre of mass by Jacobi's method; ascending.
std::array<double, 3> principal_moments(const Body& b) {
  const Vec3<double> c = b.m > 0 ? b.h * (1 / b.m) : Vec3<double>::zero();
  double A[3][3];
  const Mat3<double> K = b.I - (Mat3<double>::identity() * dot(c, c) - outer(c, c)) * b.m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) A[i][j] = 0.5 * (K(i, j) + K(j, i));
  for (int sweep = 0; sweep < 50; ++sweep) {
    const double off = std::abs(A[0][1]) + std::abs(A[0][2]) + std::abs(A[1][2]);
    if (off == 0) break;
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (A[p][q] == 0) continue;
        const double theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
        const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::hypot(theta, 1));
        const double c1 = 1 / std::hypot(t, 1), s1 = t * c1;
        for (int k = 0; k < 3; ++k) {
          const double x = A[k][p], y = A[k][q];
          A[k][p] = c1 * x - s1 * y, A[k][q] = s1 * x + c1 * y;
        }
        for (int k = 0; k < 3; ++k) {
          const double x = A[p][k], y = A[q][k];
          A[p][k] = c1 * x - s1 * y, A[q][k] = s1 * x + c1 * y;
        }
      }
  }
  std::array<double, 3> moments = {A[0][0], A[1][1], A[2][2]};
  std::sort(moments.begin(), moments.end());
  return moments;
}

// Names of the links that make up a joint's body.
std::string links_of(const std::vector<FrameEntry>& frames, int joint) {
  std::string names;
  int count = 0;
  for (const FrameEntry& f : frames)
    if (f.type == DYN_FRAME_BODY && f.joint == joint && ++count <= 4) names += (names.empty() ? "'" : ", '") + f.name + "'";
  return names.empty() ? "no link" : count > 4 ? names + ", ..." : names;
}

// A configuration off the singular ones, the same for each trial.
std::vector<double> generic_configuration(const Model& m, std::uint64_t trial) {
  std::vector<double> q(std::size_t(m.n.nq));
  Random g{trial};
  const std::vector<double> low(7, -1), high(7, 1);
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    if (!b.follower) visit(b.type, [&]<class J>() { J::random(g, low.data(), high.data(), q.data() + b.user_q); });
  }
  return q;
}

struct Workspace {
  std::unique_ptr<void, void (*)(void*)> memory;
  Data<double> d;
  Workspace(const Model& m, dynParts parts) : memory(std::aligned_alloc(64, data_bytes<double>(m, parts)), std::free) {
    if (!memory) throw std::bad_alloc();
    data_layout(m, parts, memory.get(), d);
  }
};

// What is left of the diagonal of M after elimination, relative to it; the largest over some configurations.
std::vector<double> factor_pivots(const Model& m) {
  Workspace work(m, DYN_PART_FACTOR);
  Data<double>& d = work.d;
  std::vector<double> best(std::size_t(m.n.nv), 0);
  for (std::uint64_t trial = 1; trial <= 3; ++trial) {
    const auto q = generic_configuration(m, trial);
    std::copy(q.begin(), q.end(), d.q);
    ++d.version[input_q];
    crba(m, d);
    const Index failed = factorize(m, d);
    for (Index k = failed; k < m.n.nv; ++k)
      best[std::size_t(k)] = std::max(best[std::size_t(k)], 1 / (d.D[k] * d.M[k + std::ptrdiff_t(k) * m.n.nv]));
  }
  return best;
}

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
    ++d.version[input_q];
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
          const double armature = m.armature()[b.user_v + k], scale = dot(s, before[std::size_t(i)] * s) + armature;
          const Force<double> U = Y * s;
          const double D = dot(s, U) + armature;
          const double pivot = scale > 0 ? D / scale : 0;
          best[std::size_t(b.user_v + k)] = std::max(best[std::size_t(b.user_v + k)], pivot);
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

// Forward dynamics must be defined: M positive at some configurations off the singular ones.
void check_dynamics(const Model& m, const std::vector<int>& order, const std::vector<JointEntry>& joints, const std::vector<FrameEntry>& frames) {
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    const auto moments = principal_moments(b);
    const Vec3<double> c = b.m > 0 ? b.h * (1 / b.m) : Vec3<double>::zero();
    const double scale = std::max({std::abs(moments[0]), moments[2], 1e-6 * b.m * dot(c, c)});
    if (moments[0] < -1e-6 * scale)
      throw Error(DYN_ERROR_INVALID, "joint '" + joints[std::size_t(order[std::size_t(b.joint - 1)])].spec.name + "': the inertia of its body (" +
                                         links_of(frames, order[std::size_t(b.joint - 1)]) + ") has a negative principal moment " + number(moments[0]) +
                                         " kg m^2: no mass distribution has that; correct the file");
  }
  if (m.n.nv == 0) return;
  const std::vector<double> pivots = m.has_mimic ? factor_pivots(m) : articulated_pivots(m);
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    if (b.follower) continue;  // its leader carries it
    for (Index k = 0; k < primitive_nv(b.type); ++k)
      if (!(pivots[std::size_t(b.user_v + k)] > 1e-13)) {
        const int joint = order[std::size_t(b.joint - 1)];
        throw Error(DYN_ERROR_INVALID, "joint '" + joints[std::size_t(joint)].spec.name + "': nothing resists it: " + links_of(frames, joint) +
                                           " and what hangs on it have no mass or inertia in its direction, so that forward dynamics is undefined; "
                                           "give the links an inertial, give the joint an armature, or make it fixed");
      }
  }
}

}  // namespace

void ModelDeleter::operator()(Model* m) const { std::free(m); }

ModelPtr Builder::finish() const {
  const Impl& in = *impl;
  const std::vector<int> order = depth_first(in.joints);
  const std::vector<Leader> leaders = resolve_mimic(in.joints);
  std::vector<Index> id(in.joints.size());  // of each added joint in the model
  for (std::size_t k = 0; k < order.size(); ++k) id[std::size_t(order[k])] = Index(k + 1);

  Arrays a;
  Text text;
  ModelSizes n{};
  n.joints = Index(order.size() + 1);

  // the universe
  Body world{};
  world.F = Mat3<double>::identity();
  world.r = world.h = Vec3<double>::zero();
  world.I = Mat3<double>::zero();
  world.ratio = 1, world.angle = -1;
  a.bodies.push_back(world);
  JointRecord universe{};
  universe.C = Mat3<double>::identity();
  universe.name = text.add("universe");
  universe.type = DYN_JOINT_FIXED;
  universe.leader = -1, universe.ratio = 1;
  store_se3(SE3<double>::identity(), universe.placement);
  a.joints.push_back(universe);

  // coordinates of the user: followers have none
  std::vector<Index> idx_q(in.joints.size()), idx_v(in.joints.size());
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
  if (std::size_t(n.nv) > 1000000) throw Error(DYN_ERROR_LIMIT, "the model has more than 1,000,000 degrees of freedom");
  constexpr double inf = std::numeric_limits<double>::infinity();
  a.armature.assign(std::size_t(n.nv), 0), a.damping = a.friction = a.armature;
  a.velocity_limit.assign(std::size_t(n.nv), inf), a.effort_limit = a.velocity_limit;
  a.lower_limit.assign(std::size_t(n.nq), -inf), a.upper_limit.assign(std::size_t(n.nq), inf);
  a.neutral.assign(std::size_t(n.nq), 0);

  bool mimic = false;
  for (int j : order) {
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

    // the chain of primitives, each with its axis turned to z; C: axes of the user's frame in the internal one
    const JointRecord& parent = a.joints[std::size_t(r.parent)];
    SE3<double> before = rotation_only(parent.C) * e.placement;
    Index body_parent = parent.last_body, user_q = r.idx_q, user_v = r.idx_v;
    for (const JointEntry::Part& part : e.elements) {
      const Mat3<double> Z = z_to(part.element.axis);
      const SE3<double> X = before * part.before * rotation_only(Z);
      Body b{};
      b.F = X.R, b.r = X.p;
      b.h = Vec3<double>::zero(), b.I = Mat3<double>::zero();
      b.pitch = part.element.pitch, b.wraps = part.element.wraps;
      b.ratio = l.ratio, b.offset = l.offset, b.follower = follower;
      b.type = part.element.type;
      b.parent = body_parent;
      b.idx_q = n.nqx, b.idx_v = n.nvx;
      b.user_q = user_q, b.user_v = user_v;
      b.joint = Index(a.joints.size());
      b.angle = -1;
      visit(b.type, [&]<class J>() {
        if (J::angle) b.angle = n.angles++, a.angle_q.push_back(b.idx_q);
        if (!follower) J::neutral(a.neutral.data() + user_q);
      });
      const Index nq = primitive_nq(b.type), nv = primitive_nv(b.type);
      for (Index k = 0; k < nq; ++k) a.expand_q.push_back(user_q + k), a.ratio_q.push_back(l.ratio), a.offset_q.push_back(l.offset);
      for (Index k = 0; k < nv; ++k) a.expand_v.push_back(user_v + k), a.ratio_v.push_back(l.ratio);
      n.nqx += nq, n.nvx += nv, user_q += nq, user_v += nv;
      body_parent = Index(a.bodies.size());
      before = rotation_only(transpose(Z));
      a.bodies.push_back(b);
    }
    r.last_body = body_parent;
    r.C = before.R;
    a.joints.push_back(r);

    // per degree of freedom; a follower's rotor turns with its leader
    const JointSpec& s = e.spec;
    auto put = [](const std::vector<double>& from, std::vector<double>& to, Index at) {
      std::copy(from.begin(), from.end(), to.begin() + at);
    };
    const double rotor = s.rotor_inertia * s.gear_ratio * s.gear_ratio;
    if (follower) {
      a.armature[std::size_t(r.idx_v)] += l.ratio * l.ratio * (rotor + (s.armature.empty() ? 0 : s.armature[0]));
      a.damping[std::size_t(r.idx_v)] += l.ratio * l.ratio * (s.damping.empty() ? 0 : s.damping[0]);
      a.friction[std::size_t(r.idx_v)] += std::abs(l.ratio) * (s.friction.empty() ? 0 : s.friction[0]);
    } else {
      for (std::size_t k = 0; k < s.armature.size(); ++k) a.armature[std::size_t(r.idx_v) + k] += s.armature[k];
      for (std::size_t k = 0; k < s.damping.size(); ++k) a.damping[std::size_t(r.idx_v) + k] += s.damping[k];
      for (std::size_t k = 0; k < s.friction.size(); ++k) a.friction[std::size_t(r.idx_v) + k] += s.friction[k];
      if (rotor != 0) a.armature[std::size_t(r.idx_v)] += rotor;
      put(s.lower, a.lower_limit, r.idx_q), put(s.upper, a.upper_limit, r.idx_q);
      put(s.velocity, a.velocity_limit, r.idx_v), put(s.effort, a.effort_limit, r.idx_v);
    }
  }
  n.bodies = Index(a.bodies.size());
  if (mimic) {
    n.mimic_q = n.nqx, n.mimic_v = n.nvx;
  } else {
    a.expand_q.clear(), a.ratio_q.clear(), a.offset_q.clear(), a.expand_v.clear(), a.ratio_v.clear();
  }

  // frames, and the inertia of what they carry
  for (const FrameEntry& f : in.frames) {
    const JointRecord& joint = a.joints[f.joint < 0 ? 0 : std::size_t(id[std::size_t(f.joint)])];
    FrameRecord r{};
    r.X = rotation_only(joint.C) * f.X;
    r.name = text.add(f.name);
    r.type = f.type;
    r.joint = f.joint < 0 ? 0 : id[std::size_t(f.joint)];
    r.body = joint.last_body;
    store_se3(f.X, r.placement);
    r.mass = f.mass;
    std::copy(f.com.begin(), f.com.end(), r.com);
    std::copy(f.inertia.begin(), f.inertia.end(), r.inertia);
    a.frames.push_back(r);
    n.links += f.type == DYN_FRAME_BODY;
    Body& b = a.bodies[std::size_t(r.body)];
    const Inertia<double> Y = f.Y.rotated(joint.C);
    b.m += Y.m, b.h += Y.h, b.I = b.I + Y.I.full();
  }
  n.frames = Index(a.frames.size());
  for (const ShapeEntry& s : in.shapes) {
    ShapeRecord r{};
    r.name = text.add(s.shape.name), r.mesh = text.add(s.shape.mesh);
    r.type = s.shape.type, r.role = s.shape.role;
    r.frame = Index(s.frame);
    std::copy(s.shape.placement.begin(), s.shape.placement.end(), r.placement);
    std::copy(s.shape.size.begin(), s.shape.size.end(), r.size);
    a.shapes.push_back(r);
  }
  n.shapes = Index(a.shapes.size());
  for (const ReportEntry& r : in.reports) a.reports.push_back({r.level, Index(r.line), text.add(r.message)});
  n.reports = Index(a.reports.size());

  // configurations; "neutral" is the first
  a.configuration_names.push_back(text.add("neutral"));
  a.configurations = a.neutral;
  for (const auto& [name, q] : in.configurations) {
    if (Index(q.size()) != n.nq)
      throw Error(DYN_ERROR_SIZE, "configuration '" + name + "' has " + std::to_string(q.size()) + " numbers, the model needs nq = " + std::to_string(n.nq));
    a.configuration_names.push_back(text.add(name));
    a.configurations.insert(a.configurations.end(), q.begin(), q.end());
  }
  n.configurations = Index(a.configuration_names.size());

  // runs of one type, subtrees
  a.subtree_end.assign(std::size_t(n.bodies), 0);
  for (Index i = 1; i < n.bodies; ++i) {
    const Body& b = a.bodies[std::size_t(i)];
    if (a.runs.empty() || a.runs.back().type != b.type) a.runs.push_back({b.type, i, i});
    a.runs.back().last = i + 1;
  }
  for (Index i = n.bodies - 1; i >= 0; --i) {
    Index& end = a.subtree_end[std::size_t(i)];
    end = std::max(end, i + 1);
    if (i) {
      Index& up = a.subtree_end[std::size_t(a.bodies[std::size_t(i)].parent)];
      up = std::max(up, end);
    }
  }
  n.runs = Index(a.runs.size());

  // ids by name
  auto precedence = [&](Index k) { return a.frames[std::size_t(k)].type == DYN_FRAME_BODY ? 1 : 0; };
  a.joints_by_name.resize(std::size_t(n.joints)), a.frames_by_name.resize(std::size_t(n.frames));
  std::iota(a.joints_by_name.begin(), a.joints_by_name.end(), 0);
  std::iota(a.frames_by_name.begin(), a.frames_by_name.end(), 0);
  const char* pool = text.pool.data();
  std::sort(a.joints_by_name.begin(), a.joints_by_name.end(),
            [&](Index x, Index y) { return std::strcmp(pool + a.joints[std::size_t(x)].name, pool + a.joints[std::size_t(y)].name) < 0; });
  std::sort(a.frames_by_name.begin(), a.frames_by_name.end(), [&](Index x, Index y) {
    const int c = std::strcmp(pool + a.frames[std::size_t(x)].name, pool + a.frames[std::size_t(y)].name);
    return c != 0 ? c < 0 : precedence(x) < precedence(y);
  });
  const Index name = text.add(in.name);
  a.text.assign(text.pool.begin(), text.pool.end());
  n.text = Index(a.text.size());
  a.dof_parent.assign(std::size_t(n.nv), -1), a.dof_run = a.dof_parent;  // filled in below

  // one block
  std::uint64_t bytes = (sizeof(Model) + 63) / 64 * 64;
  std::uint64_t offset[std::size_t(Model::Field::count_)];
#define FIELD(type, field, count, sentence)                                                  \
  if (a.field.size() != std::size_t(count)) throw Error(DYN_ERROR_INTERNAL, "model field " #field " has a wrong size"); \
  offset[std::size_t(Model::Field::field)] = bytes;                                           \
  bytes = (bytes + a.field.size() * sizeof(type) + 63) / 64 * 64;
#include "dyn/model/model_fields.def"
#undef FIELD
  ModelPtr model(static_cast<Model*>(std::aligned_alloc(64, bytes)));
  if (!model) throw std::bad_alloc();
  std::memset(static_cast<void*>(model.get()), 0, bytes);
  model->magic = Model::magic_value;
  model->bytes = bytes;
  model->id = next_id++;
  model->n = n;
  model->model_name = name;
  model->has_mimic = mimic;
  std::vector<Index> depth(std::size_t(n.bodies), 0);  // degrees of freedom that support a body
  for (Index i = 1; i < n.bodies; ++i)
    depth[std::size_t(i)] = depth[std::size_t(a.bodies[std::size_t(i)].parent)] + primitive_nv(a.bodies[std::size_t(i)].type);
  model->deep = *std::max_element(depth.begin(), depth.end()) > deep_from;
  std::copy(in.gravity.begin(), in.gravity.end(), model->gravity);
  for (Index i = 1; i < n.bodies; ++i) model->total_mass += a.bodies[std::size_t(i)].m;
  std::copy(std::begin(offset), std::end(offset), model->offset);
  char* base = reinterpret_cast<char*>(model.get());
#define FIELD(type, field, count, sentence) \
  if (!a.field.empty()) std::memcpy(base + offset[std::size_t(Model::Field::field)], a.field.data(), a.field.size() * sizeof(type));
#include "dyn/model/model_fields.def"
#undef FIELD
  elimination_tree(*model, a.dof_parent);
  for (std::size_t k = 0; k < std::size_t(n.nv); ++k)
    a.dof_run[k] = k > 0 && a.dof_parent[k] == Index(k) - 1 ? a.dof_run[k - 1] : Index(k);
  std::copy(a.dof_parent.begin(), a.dof_parent.end(), reinterpret_cast<Index*>(base + offset[std::size_t(Model::Field::dof_parent)]));
  std::copy(a.dof_run.begin(), a.dof_run.end(), reinterpret_cast<Index*>(base + offset[std::size_t(Model::Field::dof_run)]));
  check_dynamics(*model, order, in.joints, in.frames);
  return model;
}

}  // namespace dyn
