// Cost of constrained dynamics in counted operations: a chain with two contacts is O(n).
#include "algorithm/trees.hpp"
#include "common/counted.hpp"
#include "algorithm/constrained/constrained_dynamics.hpp"

namespace dyn_test {
namespace {

struct Costs {
  double dynamics = 0, delassus = 0;

  explicit Costs(int n) {
    TreeOptions options;
    options.joints = n, options.types = {DYN_JOINT_TYPE_REVOLUTE}, options.branch = options.mimic = options.massless = 0;
    const ModelPtr model = random_tree(1, options).build();
    const Model& m = *model;
    Work<Counted> w(m, DYN_PART_CONSTRAINTS);
    const State x(m, 1);
    w.q(x.q).v(x.v).tau(x.tau);
    auto set = [&](Index slot, Index joint) {
      dynConstraint c = default_constraint(DYN_CONSTRAINT_TYPE_POINT);
      c.first = joint_frame(m, joint);
      set_constraint(m, w.d, slot, c);
    };
    set(0, Index(n)), set(1, Index(n / 2)), number_rows(m, w.d);
    auto count = [&](auto&& algorithm) {
      Counted::operations = 0;
      algorithm();
      return double(Counted::operations);
    };
    dynConstraintResult result{};
    dynamics = count([&] {
      EXPECT_EQ(0, constrained_dynamics<Counted>(m, w.d, w.d.v, w.d.tau_applied, nullptr, ProximalOptions{}, w.d.constraint_ddq,
                                                 result));
    });
    EXPECT_EQ(6, result.rank);
    delassus = count([&] {
      EXPECT_EQ(0, constraint_factor(m, w.d));
      evaluate_rows<Counted>(m, w.d, nullptr, nullptr);
      propagate_rows(m, w.d);
      dyn::delassus(m, w.d, 6, w.d.row_matrix);
    });
  }
};

// The cost of a link is independent of the chain's length.
TEST(ConstraintScaling, OfAChainWithTwoContacts) {
  const Costs a(100), b(200), c(1000);
  EXPECT_NEAR((c.dynamics - b.dynamics) / 800, (b.dynamics - a.dynamics) / 100, 0.02 * (b.dynamics - a.dynamics) / 100);
  EXPECT_NEAR((c.delassus - b.delassus) / 800, (b.delassus - a.delassus) / 100, 0.02 * (b.delassus - a.delassus) / 100);
}

}  // namespace
}  // namespace dyn_test
