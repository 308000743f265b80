// What the builder makes: order, merged links, frames, limits, armature, named configurations, the elimination tree.
#include "table/names.hpp"
#include "common/random_tree.hpp"
#include "common/work.hpp"

namespace dyn_test::builder_test {
namespace {

constexpr std::array<double, 9> unit_inertia = {1, 0, 0, 0, 1, 0, 0, 0, 1};

JointSpec hinge(const std::string& name, const std::string& parent = "") {
  JointSpec s;
  s.name = name, s.parent.name = parent;
  return s;
}
void link(Builder& b, const std::string& parent) {
  b.body(parent + "_link", {parent, 0}, identity_placement, 1, {0.1, 0, 0}, unit_inertia);
}
std::vector<std::string> joint_names(const Model& m) {
  std::vector<std::string> out;
  for (Index j = 1; j < m.n.joints; ++j) out.push_back(m.string(m.joints()[j].name));
  return out;
}
const FrameRecord& frame(const Model& m, const std::string& name) {
  for (Index f = 0; f < m.n.frames; ++f)
    if (m.string(m.frames()[f].name) == name) return m.frames()[f];
  throw std::runtime_error("no frame " + name);
}

// q_a = 2 q_b + 1, q_b = 3 q_c + 5, whichever is added first.
TEST(Builder, MimicOfMimicInAnyOrder) {
  std::vector<std::string> order = {"a", "b", "c"};
  do {
    Builder b("chain");
    for (const std::string& name : order) {
      JointSpec s = hinge(name);
      if (name == "a") s.mimic = "b", s.mimic_ratio = 2, s.mimic_offset = 1;
      if (name == "b") s.mimic = "c", s.mimic_ratio = 3, s.mimic_offset = 5;
      b.joint(s), link(b, name);
    }
    const ModelPtr m = b.finish();
    EXPECT_EQ(1, m->n.nv) << order[0] << order[1] << order[2];
    for (Index j = 1; j < m->n.joints; ++j) {
      const JointRecord& r = m->joints()[j];
      const char name = *m->string(r.name);
      EXPECT_EQ(name == 'c', r.leader < 0) << order[0] << order[1] << order[2];
      EXPECT_EQ(name == 'a' ? 6 : name == 'b' ? 3 : 1, r.ratio);
      EXPECT_EQ(name == 'a' ? 11 : name == 'b' ? 5 : 0, r.offset);
    }
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(Builder, DepthFirstChildrenInTheOrderOfAddition) {
  Builder b("order");
  for (const auto& [name, parent] : std::vector<std::pair<std::string, std::string>>{
           {"z", ""}, {"a", ""}, {"z2", "z"}, {"a1", "a"}, {"z1", "z"}, {"z21", "z2"}, {"b", ""}}) {
    b.joint(hinge(name, parent));
    link(b, name);
  }
  const ModelPtr m = b.finish();
  EXPECT_EQ((std::vector<std::string>{"z", "z2", "z21", "z1", "a", "a1", "b"}), joint_names(*m));
  std::vector<Index> parents;
  for (Index j = 1; j < m->n.joints; ++j) parents.push_back(m->joints()[j].parent);
  EXPECT_EQ((std::vector<Index>{0, 1, 2, 1, 0, 5, 0}), parents);
  EXPECT_EQ((std::vector<Index>{8, 5, 4, 4, 5, 7, 7, 8}), std::vector<Index>(m->subtree_end(), m->subtree_end() + 8));
}

TEST(Builder, OrderOfRandomTrees) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const ModelPtr m = random_tree(seed).build();
    for (Index j = 1; j < m->n.joints; ++j) EXPECT_LT(m->joints()[j].parent, j);
    for (Index i = 1; i < m->n.bodies; ++i) {
      const Body& body = m->bodies()[i];
      EXPECT_LT(body.parent, i);
      // depth first: the parent is the body before or an ancestor of it
      bool ancestor = false;
      for (Index k = i - 1;; k = m->bodies()[k].parent) {
        if (k == body.parent) ancestor = true;
        if (k == 0) break;
      }
      EXPECT_TRUE(ancestor);
      EXPECT_GT(m->subtree_end()[body.parent], i);
    }
    // runs cover the bodies once, each a chain of one type on which others stand at its end only; none can be longer
    std::vector<int> others(std::size_t(m->n.bodies), 0);  // children of a body that are not the next one
    for (Index i = 1; i < m->n.bodies; ++i)
      if (m->bodies()[i].parent != i - 1) ++others[std::size_t(m->bodies()[i].parent)];
    Index next = 1;
    for (Index k = 0; k < m->n.joint_runs; ++k) {
      const dyn::JointRun& run = m->joint_runs()[k];
      const dyn::Body &first = m->bodies()[run.first], &before = m->bodies()[run.first - 1];
      EXPECT_EQ(next, run.first);
      EXPECT_LT(run.first, run.last);
      EXPECT_EQ(first.parent, run.parent);
      EXPECT_EQ(first.idx_q, run.idx_q);
      EXPECT_EQ(first.idx_v, run.idx_v);
      for (Index i = run.first; i < run.last; ++i) {
        EXPECT_EQ(run.type, m->bodies()[i].type);
        if (i == run.first) continue;
        EXPECT_EQ(i - 1, m->bodies()[i].parent);
        EXPECT_EQ(0, others[std::size_t(i - 1)]);
      }
      EXPECT_TRUE(k == 0 || first.type != before.type || run.parent != run.first - 1 || others[std::size_t(run.parent)] ||
                  (run.first - 1) % dyn::CacheBlock::size == 0);
      next = run.last;
    }
    // chunks cover the runs once, and hold the angles of their bodies
    Index next_run = 0;
    for (Index k = 0; k < m->n.cache_blocks; ++k) {
      const dyn::CacheBlock& chunk = m->cache_blocks()[k];
      EXPECT_EQ(next_run, chunk.first_run);
      EXPECT_EQ(m->joint_runs()[chunk.first_run].first, chunk.first);
      EXPECT_LE(m->joint_runs()[chunk.last_run - 1].last - chunk.first, dyn::CacheBlock::size);
      EXPECT_LE(chunk.last_q - chunk.first_q, m->n.sweep);
      EXPECT_GE(chunk.first_q, 0);
      EXPECT_LE(chunk.first_q + (chunk.last_q - chunk.first_q + 3) / 4 * 4,
                (m->n.nqx + 7) / 8 * 8);  // of what an array is padded to
      for (Index l = chunk.first_run; l < chunk.last_run; ++l)
        dyn::visit(m->joint_runs()[l].type, [&]<class J>() {
          if (!J::angle) return;
          EXPECT_GE(m->joint_runs()[l].idx_q, chunk.first_q);
          EXPECT_LE(m->joint_runs()[l].idx_q + m->joint_runs()[l].last - m->joint_runs()[l].first, chunk.last_q);
        });
      next_run = chunk.last_run;
    }
    EXPECT_EQ(m->n.joint_runs, next_run);
    EXPECT_EQ(m->n.bodies, next);
    // Euclidean spans and manifold joints hold every coordinate of the user's once; only joints of vector spaces are in the spans
    std::vector<int> in_q(std::size_t(m->n.nq), 0), in_v(std::size_t(m->n.nv), 0);
    std::vector<bool> flat(std::size_t(m->n.nv), false);
    for (Index k = 0; k < m->n.euclidean_spans; ++k)
      for (Index i = 0; i < m->euclidean_spans()[k].count; ++i) {
        ++in_q[std::size_t(m->euclidean_spans()[k].first_q + i)], ++in_v[std::size_t(m->euclidean_spans()[k].first_v + i)];
        flat[std::size_t(m->euclidean_spans()[k].first_v + i)] = true;
      }
    for (Index k = 0; k < m->n.manifold_joints; ++k) {
      const dyn::Body& b = m->bodies()[m->manifold_joints()[k]];
      dyn::visit(b.type, [&]<class J>() {
        for (int i = 0; i < J::nq; ++i) ++in_q[std::size_t(b.user_q + i)];
        for (int i = 0; i < J::nv; ++i) ++in_v[std::size_t(b.user_v + i)];
      });
    }
    EXPECT_EQ(std::vector<int>(in_q.size(), 1), in_q);
    EXPECT_EQ(std::vector<int>(in_v.size(), 1), in_v);
    for (Index i = 1; i < m->n.bodies; ++i) {
      const dyn::Body& b = m->bodies()[i];
      if (b.follower) continue;
      const bool vector_space =
          b.type == dyn::BodyType::Revolute || b.type == dyn::BodyType::Prismatic || b.type == dyn::BodyType::Helical;
      EXPECT_EQ(vector_space && !b.wraps, bool(flat[std::size_t(b.user_v)]));
    }
  }
}

TEST(Builder, MergedLinksKeepFrameNameAndOwnInertia) {
  Dice dice(2);
  const M4 A = dice.pose(), B = dice.pose(), C = dice.pose();
  Builder b("merge");
  b.joint(hinge("j"));
  const BodySpec own = random_body(dice, "own", "j"), tool = random_body(dice, "tool", "weld"),
                 tip = random_body(dice, "tip", "weld2");
  auto add = [&](const BodySpec& s) {
    b.body(s.name, {s.parent, 0}, placement(s.placement), s.mass, array3(s.com), array9(s.inertia));
  };
  add(own);
  JointSpec weld = hinge("weld", "own");
  weld.type = DYN_JOINT_TYPE_FIXED, weld.placement = placement(A);
  b.joint(weld);
  add(tool);
  weld.name = "weld2", weld.parent.name = "tool", weld.placement = placement(B);
  b.joint(weld);
  add(tip);
  b.frame("sensor", {"tip", 0}, placement(C), DYN_FRAME_TYPE_SENSOR);
  const ModelPtr m = b.finish();
  EXPECT_EQ(2, m->n.joints);
  EXPECT_EQ(3, m->n.links);
  EXPECT_EQ(DYN_FRAME_TYPE_FIXED_JOINT, frame(*m, "weld").type);
  EXPECT_EQ(DYN_FRAME_TYPE_SENSOR, frame(*m, "sensor").type);
  // where they are in the joint's frame
  const M4 X_own = own.placement, X_tool = X_own * A * tool.placement, X_tip = X_tool * B * tip.placement;
  EXPECT_LE(gap(eigen(frame(*m, "weld").placement), X_own * A), 4e-15);
  EXPECT_LE(gap(eigen(frame(*m, "tool").placement), X_tool), 4e-15);
  EXPECT_LE(gap(eigen(frame(*m, "weld2").placement), X_tool * B), 4e-15);
  EXPECT_LE(gap(eigen(frame(*m, "tip").placement), X_tip), 4e-15);
  EXPECT_LE(gap(eigen(frame(*m, "sensor").placement), X_tip * C), 4e-15);
  // as they were given, and what the joint carries is their sum
  double mass = 0;
  M6 total = M6::Zero();
  for (const BodySpec* s : {&own, &tool, &tip}) {
    const FrameRecord& f = frame(*m, s->name);
    const LinkRecord& link = m->links()[f.link];
    EXPECT_EQ(s->mass, link.mass);
    EXPECT_EQ(0, gap(V3(link.com), s->com));
    EXPECT_EQ(0, gap(M3(link.inertia), s->inertia));
    const M6 X = motion_matrix(eigen(f.placement)).inverse();
    M6 I;
    I << s->mass * M3::Identity(), -s->mass * hat(s->com), s->mass * hat(s->com),
        s->inertia - s->mass * hat(s->com) * hat(s->com);
    total += X.transpose() * I * X, mass += s->mass;
  }
  const Body& body = m->bodies()[1];
  M6 sum;
  sum << body.m * M3::Identity(), -hat(eigen(body.h)), hat(eigen(body.h)), eigen(body.I);
  EXPECT_LE(gap(sum, total), 1e-14 * largest(total));  // axis z: internal and joint frame are the same
  EXPECT_LE(std::abs(m->total_mass - mass), 1e-15);
}

TEST(Builder, WhatIsWeldedToTheWorldDoesNotCount) {
  Builder b("fixed");
  b.body("ground", {"", 0}, identity_placement, 100, {0, 0, 0}, unit_inertia);
  b.joint(hinge("j", "ground"));
  link(b, "j");
  EXPECT_EQ(1, b.finish()->total_mass);
}

TEST(Builder, InternalFramesAreInvisible) {
  // the same robot with every joint's axis given as z of a turned frame instead of an axis in an unturned one
  Dice dice(4);
  for (dynJointType type : {DYN_JOINT_TYPE_REVOLUTE, DYN_JOINT_TYPE_PRISMATIC, DYN_JOINT_TYPE_HELICAL, DYN_JOINT_TYPE_CYLINDRICAL,
                            DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED}) {
    ModelPtr models[2];
    const V3 axis = dice.direction();
    M4 turn = M4::Identity();
    turn.topLeftCorner<3, 3>() = Eigen::Quaterniond::FromTwoVectors(V3::UnitZ(), axis).toRotationMatrix();
    const M4 at = dice.pose();
    const BodySpec link1 = random_body(dice, "l1", "j1"), link2 = random_body(dice, "l2", "j2");
    for (int turned : {0, 1}) {
      Builder b("frames");
      JointSpec s = hinge("j1");
      s.type = type, s.pitch = 0.2;
      s.axis = turned ? std::array<double, 3>{0, 0, 1} : array3(axis);
      s.placement = placement(turned ? M4(at * turn) : at);
      b.joint(s);
      const M4 back = turned ? M4(turn.inverse()) : M4::Identity();
      auto add = [&](const BodySpec& x, const M4& before) {
        b.body(x.name, {x.parent, 0}, placement(before * x.placement), x.mass, array3(x.com), array9(x.inertia));
      };
      add(link1, back);
      JointSpec next = hinge("j2", "j1");
      next.axis = array3(V3(0, 1, 1)), next.placement = placement(back * at);
      b.joint(next);
      add(link2, M4::Identity());
      models[turned] = b.finish();
    }
    const State x(*models[0], 9);
    VectorXd tau[2] = {x.tau, x.tau}, ddq[2] = {x.tau, x.tau};
    M4 hand[2];
    for (int k : {0, 1}) {
      Work<double> w(*models[k]);
      w.q(x.q).v(x.v).a(x.a);
      inverse_dynamics<double>(w.m, w.d, w.d.v, w.d.a, nullptr, tau[k].data());
      ASSERT_EQ(0, (forward_dynamics<double>(w.m, w.d, w.d.v, x.tau.data(), nullptr, ddq[k].data())));
      forward_kinematics<0>(w.m, w.d);
      double X[12];
      frame_placement(w.m, w.d, w.m.n.frames - 1, X);
      hand[k] = eigen(X);
    }
    EXPECT_LE(gap(hand[0], hand[1]), 4e-15) << name_of(type);
    EXPECT_LE(gap(tau[0], tau[1]), 1e-13 * largest(tau[0])) << name_of(type);
    EXPECT_LE(gap(ddq[0], ddq[1]), 1e-12 * largest(ddq[0])) << name_of(type);  // cond(M) below 100
  }
}

TEST(Builder, NamesResolveJointsBeforeLinks) {
  Builder b("names");
  b.joint(hinge("same"));
  JointSpec other = hinge("j2", "same");
  other.placement[9] = 1;
  b.body("same", {"same", 0}, placement([] { M4 X = M4::Identity(); X(0, 3) = 5; return X; }()), 1, {0, 0, 0}, unit_inertia);
  b.joint(other);                                                                              // on the joint, not on the link
  b.frame("on_link", {"same", DYN_FRAME_TYPE_BODY}, identity_placement, DYN_FRAME_TYPE_OP_FRAME);  // on the link
  link(b, "j2");
  const ModelPtr m = b.finish();
  EXPECT_EQ(1, m->joints()[2].placement[9]);
  EXPECT_EQ(5, frame(*m, "on_link").placement[9]);
}

TEST(Builder, LimitsAndTheRestArePerCoordinate) {
  Builder b("numbers");
  JointSpec s = hinge("c");
  s.type = DYN_JOINT_TYPE_CYLINDRICAL;
  s.lower = {-1, -2}, s.upper = {3, 4}, s.velocity = {5, 6}, s.effort = {7, 8}, s.armature = {0.1, 0.2}, s.damping = {0.3, 0.4},
  s.friction = {0.5, 0.6};
  b.joint(s);
  link(b, "c");
  JointSpec rotor = hinge("r", "c");
  rotor.armature = {0.5}, rotor.rotor_inertia = 2e-5, rotor.gear_ratio = -100;
  b.joint(rotor);
  link(b, "r");
  const ModelPtr m = b.finish();
  auto all = [](const double* x, int n) { return std::vector<double>(x, x + n); };
  EXPECT_EQ((std::vector<double>{-1, -2, -infinity}), all(m->lower_limit(), 3));
  EXPECT_EQ((std::vector<double>{3, 4, infinity}), all(m->upper_limit(), 3));
  EXPECT_EQ((std::vector<double>{5, 6, infinity}), all(m->velocity_limit(), 3));
  EXPECT_EQ((std::vector<double>{7, 8, infinity}), all(m->effort_limit(), 3));
  EXPECT_EQ((std::vector<double>{0.3, 0.4, 0}), all(m->damping(), 3));
  EXPECT_EQ((std::vector<double>{0.5, 0.6, 0}), all(m->friction(), 3));
  EXPECT_EQ(0.1, m->armature()[0]);
  EXPECT_EQ(0.2, m->armature()[1]);
  EXPECT_DOUBLE_EQ(0.7, m->armature()[2]);  // 0.5 + 2e-5 * 100^2
}

TEST(Builder, NamedConfigurations) {
  Builder b("configurations");
  JointSpec s = hinge("ball");
  s.type = DYN_JOINT_TYPE_SPHERICAL;
  b.joint(s);
  link(b, "ball");
  b.configuration("home", {0.5, 0.5, 0.5, 0.5});
  const ModelPtr m = b.finish();
  ASSERT_EQ(2, m->n.configurations);
  EXPECT_STREQ("neutral", m->string(m->configuration_names()[0]));
  EXPECT_STREQ("home", m->string(m->configuration_names()[1]));
  EXPECT_EQ((std::vector<double>{0, 0, 0, 1, 0.5, 0.5, 0.5, 0.5}),
            std::vector<double>(m->configurations(), m->configurations() + 8));
}

TEST(Builder, NamedConfigurationsAreNormalised) {
  Builder b("configurations");
  JointSpec s = hinge("ball"), wheel = hinge("wheel");
  s.type = DYN_JOINT_TYPE_SPHERICAL, wheel.type = DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED;
  b.joint(s);
  link(b, "ball");
  b.joint(wheel);
  link(b, "wheel");
  for (double scale : {3.0, 1e-200, 1e300}) b.configuration(std::to_string(scale), {scale, -scale, scale, scale, 0, -scale});
  const ModelPtr m = b.finish();
  for (int k = 1; k < 4; ++k)
    EXPECT_EQ((std::vector<double>{0.5, -0.5, 0.5, 0.5, 0, -1}),
              std::vector<double>(m->configurations() + 6 * k, m->configurations() + 6 * k + 6))
        << k;
}

TEST(Builder, EliminationTreeCoversThePatternOfM) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    const ModelPtr m = random_tree(seed).build();
    Work<double> w(*m);
    crba(*m, w.q(State(*m, seed).q).d);
    const Index n = m->n.nv;
    const MatrixXd M = matrix(w.d.M, n, n);
    for (Index i = 0; i < n; ++i) {
      std::vector<bool> ancestor(std::size_t(n), false);
      for (Index k = i; k >= 0; k = m->dof_parent()[k]) {
        ASSERT_LT(m->dof_parent()[k], k);
        ancestor[std::size_t(k)] = true;
      }
      for (Index j = 0; j < i; ++j) {
        if (!ancestor[std::size_t(j)]) {
          EXPECT_EQ(0, M(i, j)) << i << ", " << j;
        }
        EXPECT_EQ(i < m->dof_descendants_end()[j], bool(ancestor[std::size_t(j)])) << i << ", " << j;
      }
      EXPECT_EQ(Index(std::count(ancestor.begin(), ancestor.end(), true)), m->dof_depth()[i] + 1);
    }
  }
}

TEST(Builder, CanBeExtendedAndFinishedAgain) {
  Builder b("twice");
  b.joint(hinge("a"));
  link(b, "a");
  const ModelPtr one = b.finish();
  b.joint(hinge("b", "a"));
  link(b, "b");
  const ModelPtr two = b.finish();
  EXPECT_EQ(1, one->n.nv);
  EXPECT_EQ(2, two->n.nv);
  EXPECT_NE(one->id, two->id);
}

TEST(Builder, TheModelIsOneBlockThatCanBeMoved) {
  const ModelPtr m = random_tree(12).build();
  std::unique_ptr<void, void (*)(void*)> copy(std::aligned_alloc(64, (m->bytes + 63) / 64 * 64), std::free);
  std::memcpy(copy.get(), m.get(), m->bytes);
  const Model& moved = *static_cast<const Model*>(copy.get());
  const State x(*m, 3);
  VectorXd tau[2] = {x.tau, x.tau};
  for (const Model* model : {static_cast<const Model*>(m.get()), &moved}) {
    Work<double> w(*model);
    inverse_dynamics<double>(*model, w.q(x.q).d, x.v.data(), x.a.data(), nullptr, tau[model == &moved].data());
  }
  EXPECT_EQ(0, gap(tau[0], tau[1]));
  for (const void* p : {static_cast<const void*>(m->bodies()), static_cast<const void*>(m->joints()),
                        static_cast<const void*>(m->joint_placement())})
    EXPECT_EQ(0u, reinterpret_cast<std::uintptr_t>(p) % 64);  // vectors on lines of the cache
  EXPECT_EQ(0u, reinterpret_cast<std::uintptr_t>(m->neutral()) % alignof(double));
}

TEST(Builder, AnEmptyModelIsAModel) {
  const ModelPtr m = Builder("nothing").finish();
  EXPECT_EQ(0, m->n.nv);
  EXPECT_EQ(1, m->n.joints);
  Work<double> w(*m);
  crba(*m, w.d);
  center_of_mass(*m, w.d, 2);
  EXPECT_EQ(0, largest(matrix(w.d.com, 3)));
}

}  // namespace
}  // namespace dyn_test::builder_test
