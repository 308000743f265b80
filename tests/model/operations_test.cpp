// Operations on whole robots: copied, locked, attached and taken apart, they move and weigh as they did.
#include <cstring>
#include <map>

#include "common/random_tree.hpp"
#include "common/results.hpp"
#include "common/work.hpp"

namespace dyn_test {
namespace {

// Numbers for all that a model can hold.
Tree furnished(std::uint64_t seed, int joints = 0) {
  TreeOptions options;
  options.joints = joints;
  Tree t = random_tree(seed, options);
  Dice dice(seed + 5);
  for (JointSpec& s : t.joints) {
    if (s.type == DYN_JOINT_TYPE_FIXED) continue;
    const std::size_t nv = std::size_t(spec_nv(s));
    for (auto* x : {&s.damping, &s.friction, &s.velocity, &s.effort})
      for (std::size_t k = 0; k < nv; ++k) x->push_back(dice.in(0, 3));
    if (nv == 1) s.rotor_inertia = dice.in(0, 0.01), s.gear_ratio = dice.in(1, 5);
  }
  return t;
}

void add_body(Builder& b, const BodySpec& s) {
  b.body(s.name, {s.parent, 0}, placement(s.placement), s.mass, array3(s.com), array9(s.inertia));
}

// The tree on a joint of the builder, its names behind a prefix.
void add(Builder& b, const Tree& t, const std::string& prefix = "", const std::string& root = "") {
  Dice dice(6);
  for (JointSpec s : t.joints) {
    s.name = prefix + s.name, s.parent.name = s.parent.name.empty() ? root : prefix + s.parent.name;
    if (!s.mimic.empty()) s.mimic = prefix + s.mimic;
    b.joint(s);
  }
  for (BodySpec s : t.bodies) {
    s.name = prefix + s.name, s.parent = prefix + s.parent;
    add_body(b, s);
    if (dice.chance(0.3))
      b.shape({prefix + "of_" + s.name,
               DYN_SHAPE_TYPE_MESH,
               DYN_SHAPE_ROLE_VISUAL,
               s.name,
               placement(dice.pose()),
               {1, 2, 3},
               "x.stl"});
  }
  for (const BodySpec& s : t.frames)
    b.frame(prefix + s.name, {prefix + s.parent, 0}, placement(s.placement), DYN_FRAME_TYPE_SENSOR);
}
ModelPtr model_of(const Tree& t, std::uint64_t seed) {
  Builder b("robot");
  b.gravity(array3(t.gravity));
  add(b, t);
  b.report(DYN_REPORT_LEVEL_WARNING, 7, "a remark");
  const ModelPtr m = b.finish();
  const State x(*m, seed);
  b.configuration("home", {x.q.begin(), x.q.end()});
  return b.finish();
}

std::string name_of(const Model& m, Index joint) { return m.string(m.joints()[joint].name); }
Index joint_id(const Model& m, const std::string& name) {
  for (Index j = 1; j < m.n.joints; ++j)
    if (name_of(m, j) == name) return j;
  return -1;
}
Index frame_id(const Model& m, const std::string& name, int types = ~0) {
  for (Index f = 0; f < m.n.frames; ++f)
    if (m.string(m.frames()[f].name) == name && (m.frames()[f].type & types)) return f;
  return -1;
}

// Where each coordinate of one model is in another; names behind a prefix there. Joints that the other lacks are left out.
struct Match {
  std::vector<std::pair<Index, Index>> q, v;
  Match(const Model& a, const Model& b, const std::string& prefix = "") {
    for (Index j = 1; j < a.n.joints; ++j) {
      const Index k = joint_id(b, prefix + name_of(a, j));
      if (k < 0) continue;
      const JointRecord &x = a.joints()[j], &y = b.joints()[k];
      EXPECT_EQ(x.nq, y.nq);
      for (Index i = 0; i < x.nq; ++i) q.emplace_back(x.idx_q + i, y.idx_q + i);
      for (Index i = 0; i < x.nv; ++i) v.emplace_back(x.idx_v + i, y.idx_v + i);
    }
  }
};

// a is b, or what b is but for joints that are at q, at rest: same frames, same M, same tau. X: a's world in b's.
void expect_same(const Model& a, const Model& b, VectorXd q, std::uint64_t seed, const std::string& prefix = "",
                 const M4& X = M4::Identity()) {
  const Match match(a, b, prefix);
  ASSERT_EQ(std::size_t(a.n.nq), match.q.size());
  ASSERT_EQ(std::size_t(a.n.nv), match.v.size());
  Dice dice(seed);
  VectorXd qa(a.n.nq), va(a.n.nv), aa(a.n.nv), v = VectorXd::Zero(b.n.nv), acceleration = v;
  for (auto [i, k] : match.q) qa[i] = q[k];
  for (auto [i, k] : match.v) va[i] = v[k] = dice.in(-1, 1), aa[i] = acceleration[k] = dice.in(-1, 1);
  const Results x(a, qa, va, aa), y(b, q, v, acceleration);
  const double scale = std::max(1.0, largest(y.tau)), scale_M = std::max(1.0, largest(y.M));
  for (auto [i, k] : match.v) {
    EXPECT_NEAR(x.tau[i], y.tau[k], 1e-12 * scale);
    for (auto [j, l] : match.v) EXPECT_NEAR(x.M(i, j), y.M(k, l), 1e-12 * scale_M);
    EXPECT_EQ(a.armature()[i], b.armature()[k]);
    EXPECT_EQ(a.damping()[i], b.damping()[k]);
    EXPECT_EQ(a.friction()[i], b.friction()[k]);
    EXPECT_EQ(a.velocity_limit()[i], b.velocity_limit()[k]);
    EXPECT_EQ(a.effort_limit()[i], b.effort_limit()[k]);
  }
  for (auto [i, k] : match.q) {
    EXPECT_EQ(a.lower_limit()[i], b.lower_limit()[k]);
    EXPECT_EQ(a.upper_limit()[i], b.upper_limit()[k]);
  }
  for (Index f = 1; f < a.n.frames; ++f) {
    const int type = a.frames()[f].type;
    const int types = type == DYN_FRAME_TYPE_FIXED_JOINT ? DYN_FRAME_TYPE_FIXED_JOINT | DYN_FRAME_TYPE_JOINT : type;
    const Index g = frame_id(b, prefix + a.string(a.frames()[f].name), types);
    ASSERT_GE(g, 0) << a.string(a.frames()[f].name);
    EXPECT_LE(gap(X * x.frames[std::size_t(f)], y.frames[std::size_t(g)]),
              1e-13 * std::max(1.0, largest(y.frames[std::size_t(g)])));
    EXPECT_EQ(a.frames()[f].link < 0, b.frames()[g].link < 0);
    if (type != DYN_FRAME_TYPE_BODY) continue;
    EXPECT_EQ(a.links()[a.frames()[f].link].mass, b.links()[b.frames()[g].link].mass);
  }
}

TEST(Operations, ACopyIsTheSameModel) {
  for (std::uint64_t seed = 1; seed <= tree_count; ++seed) {
    const ModelPtr m = model_of(furnished(seed), seed), copy = Builder(*m).finish();
    ASSERT_EQ(m->bytes, copy->bytes);
    copy->id = m->id;
    EXPECT_EQ(0, std::memcmp(m.get(), copy.get(), m->bytes)) << "seed " << seed;
  }
}

TEST(Operations, LockedJointsAreAtRest) {
  int followers = 0, composites = 0;
  for (std::uint64_t seed = 1; seed <= tree_count; ++seed) {
    const ModelPtr m = model_of(furnished(seed), seed);
    Dice dice(seed + 11);
    const State x(*m, seed + 3);
    std::vector<std::string> names;
    for (Index j = 1; j < m->n.joints; ++j) {
      const JointRecord& r = m->joints()[j];
      if (r.leader >= 0 || !dice.chance(0.4)) continue;
      names.push_back(name_of(*m, j));
      composites += r.type == DYN_JOINT_TYPE_COMPOSITE;
      for (Index k = 1; k < m->n.joints; ++k) followers += m->joints()[k].leader == j;
    }
    Builder b(*m);
    b.lock(names, {x.q.begin(), x.q.end()});
    const ModelPtr reduced = b.finish();
    for (const std::string& name : names) {
      EXPECT_LT(joint_id(*reduced, name), 0);
      EXPECT_EQ(DYN_FRAME_TYPE_FIXED_JOINT, reduced->frames()[frame_id(*reduced, name)].type);
    }
    EXPECT_EQ(m->n.frames, reduced->n.frames);
    EXPECT_EQ(m->n.shapes, reduced->n.shapes);
    EXPECT_EQ(m->n.links, reduced->n.links);
    expect_same(*reduced, *m, x.q, seed);
    const Match match(*reduced, *m);
    for (auto [i, k] : match.q) EXPECT_EQ(m->configurations()[m->n.nq + k], reduced->configurations()[reduced->n.nq + i]);
  }
  EXPECT_GT(followers, 20);
  EXPECT_GT(composites, 20);
}

TEST(Operations, AttachedIsBuiltInOneGo) {
  std::vector<dynJointType> types = moving_types();
  types.push_back(DYN_JOINT_TYPE_FIXED);
  for (std::uint64_t seed = 1; seed <= 3 * types.size(); ++seed) {
    const dynJointType type = types[seed % types.size()];
    const Tree left = furnished(seed, 7), right = furnished(seed + 1000, 9);
    const ModelPtr arm = model_of(left, seed), hand = model_of(right, seed + 1);
    Dice dice(seed + 2);
    JointSpec socket;
    if (type == DYN_JOINT_TYPE_FIXED) socket.type = type, socket.placement = placement(dice.pose());
    else socket = random_joint(dice, type);
    socket.name = "socket", socket.parent.name = "f3";
    const BodySpec hub = random_body(dice, "hub", "socket");

    Builder attached(*arm), whole("robot");
    attached.attach(*hand, "hand_", &socket);
    whole.gravity(array3(left.gravity));
    add(whole, left);
    whole.joint(socket);
    add(whole, right, "hand_", "socket");
    for (Builder* b : {&attached, &whole}) add_body(*b, hub);
    const ModelPtr a = attached.finish(), w = whole.finish();
    EXPECT_EQ(w->n.frames, a->n.frames);
    EXPECT_EQ(w->n.shapes, a->n.shapes);
    for (Index k = 0; k < a->n.shapes; ++k)
      EXPECT_STREQ(w->string(w->frames()[w->shapes()[k].frame].name), a->string(a->frames()[a->shapes()[k].frame].name));
    EXPECT_EQ(2, a->n.reports);
    expect_same(*a, *w, State(*w, seed).q, seed);
    expect_same(*w, *a, State(*a, seed).q, seed);

    // both were at home: now they are, with the socket neutral
    ASSERT_EQ(2, a->n.configurations);
    VectorXd home = VectorXd::Map(a->neutral(), a->n.nq);
    for (auto [i, k] : Match(*arm, *a).q) home[k] = arm->configurations()[arm->n.nq + i];
    for (auto [i, k] : Match(*hand, *a, "hand_").q) home[k] = hand->configurations()[hand->n.nq + i];
    EXPECT_EQ(home, VectorXd(VectorXd::Map(a->configurations() + a->n.nq, a->n.nq)));
  }
}

// Shapes of the attached model's own world are where its world is: on a link of the joint's name, or in the world.
TEST(Operations, AttachedWorldKeepsItsShapes) {
  Builder scene("scene");
  dyn::Shape floor;
  floor.name = "floor", floor.body = "universe", floor.type = DYN_SHAPE_TYPE_BOX, floor.size = {1, 1, 0.1};
  scene.shape(floor);
  const ModelPtr m = scene.finish();
  Builder in_place("robot"), carried("robot");
  for (Builder* b : {&in_place, &carried}) {
    JointSpec s;
    s.name = "slide", s.type = DYN_JOINT_TYPE_PRISMATIC;
    b->joint(s);
    b->body("sledge", {"slide", 0}, identity_placement, 1, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1});
  }
  in_place.attach(*m, "its_", nullptr);
  EXPECT_EQ(0, in_place.finish()->shapes()[0].frame);
  JointSpec mount;
  mount.name = "mount", mount.type = DYN_JOINT_TYPE_FIXED, mount.parent.name = "sledge", mount.placement[9] = 2;
  carried.attach(*m, "its_", &mount);
  const ModelPtr c = carried.finish();
  const FrameRecord& link = c->frames()[c->shapes()[0].frame];
  EXPECT_STREQ("mount", c->string(link.name));
  EXPECT_EQ(DYN_FRAME_TYPE_BODY, link.type);
  EXPECT_EQ(1, link.joint);
  EXPECT_EQ(2, link.placement[9]);
  Builder copy(*c);
  EXPECT_EQ(c->bytes, copy.finish()->bytes);
}

TEST(Operations, TakenApartAndPutTogetherAgain) {
  int tried = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Tree tree = furnished(seed, 12);
    if (seed % 2)
      for (JointSpec& s : tree.joints) s.mimic.clear();
    const ModelPtr m = model_of(tree, seed);
    for (Index j = 1; j < m->n.joints; ++j) {
      Builder part(*m), rest(*m);
      try {
        part.subtree(name_of(*m, j)), rest.remove(name_of(*m, j));
      } catch (const dyn::Error& e) {
        EXPECT_NE(std::string::npos, std::string(e.what()).find("lock the leader first")) << e.what();
        continue;
      }
      JointSpec seat;
      seat.type = DYN_JOINT_TYPE_FIXED, seat.name = "seat",
      seat.parent = {name_of(*m, m->joints()[j].parent), DYN_FRAME_TYPE_JOINT};
      if (m->joints()[j].parent == 0) seat.parent = {};
      ModelPtr subtree;
      try {
        subtree = part.finish();
        (void)rest.finish();
      } catch (const dyn::Error& e) {  // what carried mass for another
        EXPECT_NE(std::string::npos, std::string(e.what()).find("nothing resists it")) << e.what();
        continue;
      }
      rest.attach(*subtree, "", &seat);
      const ModelPtr again = rest.finish();
      expect_same(*m, *again, State(*again, seed).q, seed);
      EXPECT_EQ(m->n.shapes, again->n.shapes);
      ++tried;

      // the subtree alone is the robot whose other joints are at rest, seen from where they hold it
      const State x(*m, seed + 1);
      std::vector<std::string> others;
      for (Index k = 1; k < m->n.joints; ++k)
        if (joint_id(*subtree, name_of(*m, k)) < 0 && m->joints()[k].leader < 0) others.push_back(name_of(*m, k));
      Builder held(*m);
      held.lock(others, {x.q.begin(), x.q.end()});
      const ModelPtr still = held.finish();
      const Results at(*m, x.q, VectorXd::Zero(m->n.nv), VectorXd::Zero(m->n.nv));
      const M4 X = m->joints()[j].parent
                       ? at.frames[std::size_t(frame_id(*m, name_of(*m, m->joints()[j].parent), DYN_FRAME_TYPE_JOINT))]
                       : M4::Identity();
      Builder turned(*subtree);
      turned.gravity(array3(X.topLeftCorner<3, 3>().transpose() * tree.gravity));
      VectorXd q(still->n.nq);
      for (auto [i, k] : Match(*m, *still).q) q[k] = x.q[i];
      expect_same(*turned.finish(), *still, q, seed, "", X);
    }
  }
  EXPECT_GT(tried, 200);
}

// What the operation says, and that the builder is as before.
template <class F>
void refuse(const Model& m, dynStatus status, const std::vector<std::string>& fragments, F&& f) {
  Builder b(m);
  try {
    f(b);
    ADD_FAILURE() << "accepted: " << fragments.front();
  } catch (const dyn::Error& e) {
    EXPECT_EQ(status, e.status);
    for (const std::string& fragment : fragments) EXPECT_NE(std::string::npos, std::string(e.what()).find(fragment)) << e.what();
  }
  const ModelPtr same = b.finish();
  same->id = m.id;
  ASSERT_EQ(m.bytes, same->bytes);
  EXPECT_EQ(0, std::memcmp(&m, same.get(), m.bytes));
}

TEST(Operations, Refusals) {
  Dice dice(3);
  Builder b("arm");
  for (const char* name : {"a", "b", "c"}) {
    JointSpec s = random_joint(dice, name[0] == 'b' ? DYN_JOINT_TYPE_SPHERICAL : DYN_JOINT_TYPE_REVOLUTE);
    s.name = name;
    if (name[0] != 'a') s.parent.name = std::string(1, char(name[0] - 1));
    if (name[0] == 'c') s.mimic = "a", s.mimic_ratio = 2, s.lower = {-1}, s.upper = {1};
    b.joint(s);
    add_body(b, random_body(dice, std::string("link_") + name, name));
  }
  const ModelPtr m = b.finish();
  const std::vector<double> q = {0.1, 0, 0, 0, 1};
  const double nan = std::nan("");
  refuse(*m, DYN_ERROR_NAME, {"lock", "no moving joint 'x'"}, [&](Builder& r) { r.lock({"x"}, q); });
  refuse(*m, DYN_ERROR_NAME, {"'a'", "twice"}, [&](Builder& r) { r.lock({"a", "b", "a"}, q); });
  refuse(*m, DYN_ERROR_NAME, {"no moving joint 'link_a'"}, [&](Builder& r) { r.lock({"link_a"}, q); });
  refuse(*m, DYN_ERROR_INVALID, {"joint 'c' follows 'a'", "lock 'a'"}, [&](Builder& r) { r.lock({"b", "c"}, q); });
  refuse(*m, DYN_ERROR_INVALID, {"joint 'a' is at 3.5", "-3 to 3"}, [&](Builder& r) { r.lock({"a"}, {3.5, 0, 0, 0, 1}); });
  refuse(*m, DYN_ERROR_NONFINITE, {"q[0] is nan"}, [&](Builder& r) { r.lock({"b"}, {nan, 0, 0, 0, 1}); });
  refuse(*m, DYN_ERROR_QUATERNION, {"joint 'b'", "normalize"}, [&](Builder& r) { r.lock({"b"}, {0, 0, 0, 0, 1.1}); });
  refuse(*m, DYN_ERROR_QUATERNION, {"joint 'b'", "normalize"}, [&](Builder& r) { r.lock({"a"}, {0, 0, 0, 0, 0}); });
  refuse(*m, DYN_ERROR_SIZE, {"q has 4 numbers", "nq = 5"}, [&](Builder& r) { r.lock({"b"}, {0, 0, 0, 1}); });
  refuse(*m, DYN_ERROR_INVALID, {"'c' stays and follows 'a'"}, [&](Builder& r) { r.subtree("b"); });
  refuse(*m, DYN_ERROR_NAME, {"no moving joint 'x'"}, [&](Builder& r) { r.remove("x"); });
  refuse(*m, DYN_ERROR_NAME, {"attach 'arm'", "its joint", "joint of 'arm'", "'a'", "prefix"},
         [&](Builder& r) { r.attach(*m, "", nullptr); });
  JointSpec seat;
  seat.name = "seat", seat.type = DYN_JOINT_TYPE_FIXED, seat.parent.name = "nowhere";
  refuse(*m, DYN_ERROR_NAME, {"joint 'seat'", "'nowhere'"}, [&](Builder& r) { r.attach(*m, "left_", &seat); });
  seat.parent.name = "link_c", seat.name = "left_a";
  refuse(*m, DYN_ERROR_NAME, {"its joint", "fixed joint of 'arm'", "'left_a'", "another prefix"},
         [&](Builder& r) { r.attach(*m, "left_", &seat); });
  // the builder that was given it knows a follower's limits
  refuse(*m, DYN_ERROR_INVALID, {"joint 'c' is at 2", "-1 to 1"}, [&](Builder&) { b.lock({"a"}, {1, 0, 0, 0, 1}); });
  // a configuration that is not whole yet
  b.configuration("home", {0, 0});
  refuse(*m, DYN_ERROR_SIZE, {"'home' has 2 numbers", "nq = 5"}, [&](Builder&) { b.lock({"a"}, q); });
  Builder locked(*m);
  locked.lock({"a"}, q);
  EXPECT_EQ(2, locked.finish()->n.joints);  // the universe and b: c went with a
  locked.lock({"b"}, {0, 0, 0, 1});
  EXPECT_EQ(0, locked.finish()->n.nv);
}

}  // namespace
}  // namespace dyn_test
