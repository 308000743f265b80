// How the cost grows with the robot, in counted operations: O(n) for the recursions, O(n depth) for what has an entry for each
// pair of degrees of freedom of which one supports the other.
#include <functional>

#include "algorithm/trees.hpp"
#include "common/counted.hpp"
#include "algorithm/crba.hpp"
#include "algorithm/forward_dynamics.hpp"
#include "algorithm/rnea.hpp"
#include "algorithm/rnea_derivatives.hpp"

namespace dyn_test {
namespace {

// Revolute joints with a body each; parent(k) is the number of joint k's, 0 the universe.
ModelPtr robot(int n, const std::function<int(int)>& parent) {
  Dice dice(1);
  Builder b("robot");
  for (int k = 1; k <= n; ++k) {
    JointSpec s = random_joint(dice, DYN_JOINT_TYPE_REVOLUTE);
    const std::string name = std::to_string(k), above = parent(k) ? std::to_string(parent(k)) : "universe";
    s.name = "joint" + name, s.parent = {parent(k) ? "joint" + above : "", 0};
    b.joint(s);
    const BodySpec body = random_body(dice, name, s.name);
    b.body(body.name, {body.parent, 0}, placement(body.placement), body.mass, array3(body.com), array9(body.inertia));
  }
  return b.finish();
}
ModelPtr long_chain(int n) {
  return robot(n, [](int k) { return k - 1; });
}
ModelPtr star(int n) {
  return robot(n, [](int) { return 0; });
}
ModelPtr binary_tree(int leaves) {
  return robot(2 * leaves - 1, [](int k) { return k / 2; });
}

// pairs of degrees of freedom of which one supports the other or is it: the sum of their depths
double pairs(const Model& m) {
  double sum = 0;
  for (Index i = 0; i < m.n.nvx; ++i) sum += m.dof_end()[i] - i;
  return sum;
}

struct Costs {
  double n, pairs, rnea, aba, crba, rnea_derivatives;

  explicit Costs(const ModelPtr& model) : n(model->n.nv), pairs(dyn_test::pairs(*model)) {
    Work<Counted> w(*model, DYN_PART_INVERSE | DYN_PART_FORWARD | DYN_PART_MASS | DYN_PART_INVERSE_DERIVATIVES);
    const State x(*model, 1);
    w.q(x.q).v(x.v).a(x.a).tau(x.tau);
    auto count = [&](auto&& algorithm) {
      Counted::operations = 0;
      algorithm();
      return double(Counted::operations);
    };
    rnea = count([&] { inverse_dynamics<Counted>(*model, w.d, w.d.v, w.d.a, nullptr, w.d.tau); });
    aba = count([&] { EXPECT_EQ(0, (forward_dynamics<Counted>(*model, w.d, w.d.v, w.d.tau_applied, nullptr, w.d.ddq))); });
    crba = count([&] { dyn::crba(*model, w.d); });
    rnea_derivatives = count([&] { dyn::rnea_derivatives<Counted>(*model, w.d, w.d.v, w.d.a, nullptr); });
  }
};

TEST(Scaling, RecursionsAreLinear) {
  for (const auto& shape : {long_chain, star, binary_tree}) {
    const Costs small(shape(100)), large(shape(1000));
    EXPECT_NEAR(large.rnea / large.n, small.rnea / small.n, 0.02 * small.rnea / small.n);
    EXPECT_NEAR(large.aba / large.n, small.aba / small.n, 0.02 * small.aba / small.n);
  }
}

// On a star every depth is one: the cost of a joint does not depend on how many there are.
TEST(Scaling, OfAThousandLeavesAtTheRoot) {
  const Costs small(star(100)), large(star(1000));
  EXPECT_EQ(1000, large.pairs);
  EXPECT_NEAR(large.crba / 1000, small.crba / 100, 0.02 * small.crba / 100);
  EXPECT_NEAR(large.rnea_derivatives / 1000, small.rnea_derivatives / 100, 0.02 * small.rnea_derivatives / 100);
}

// a n + b pairs, from two chains
struct Law {
  double per_joint, per_pair;
  Law(const Costs& a, const Costs& b, double Costs::*cost) {
    const double determinant = a.n * b.pairs - b.n * a.pairs;
    per_joint = (a.*cost * b.pairs - b.*cost * a.pairs) / determinant;
    per_pair = (a.n * (b.*cost) - b.n * (a.*cost)) / determinant;
  }
};

TEST(Scaling, OfAChainOfAThousand) {
  const Costs a(long_chain(100)), b(long_chain(200)), c(long_chain(1000));
  EXPECT_EQ(500500, c.pairs);
  for (double Costs::*cost : {&Costs::crba, &Costs::rnea_derivatives}) {
    const Law law(a, b, cost);
    EXPECT_GT(law.per_joint, 0);
    EXPECT_GT(law.per_pair, 0);
    EXPECT_NEAR(c.*cost, law.per_joint * c.n + law.per_pair * c.pairs, 0.01 * c.*cost);
  }
}

// A thousand leaves at depth 10 or 11. Entries are computed four rows by four columns, of which few are pairs where subtrees are
// small: no more than four times the pairs, where all entries would be 200 times as many.
TEST(Scaling, OfABinaryTreeOfAThousandLeaves) {
  const Costs a(long_chain(100)), b(long_chain(200)), tree(binary_tree(1000));
  EXPECT_EQ(1999, tree.n);
  EXPECT_LT(tree.pairs, 11 * tree.n);
  for (double Costs::*cost : {&Costs::crba, &Costs::rnea_derivatives}) {
    const Law law(a, b, cost);
    EXPECT_LE(tree.*cost, law.per_joint * tree.n + 4 * law.per_pair * tree.pairs);
  }
}

}  // namespace
}  // namespace dyn_test
