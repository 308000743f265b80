// The lists that everything else walks: dispatch reaches each primitive once, and the enumeration of user joints is complete.
#include <set>
#include <string>

#include "table/names.hpp"
#include "common/random_tree.hpp"
#include "joint/list.hpp"
#include "table/enums.hpp"

namespace dyn_test {
namespace {

TEST(List, VisitReachesTheNamedPrimitive) {
  int count = 0;
#define DYN_TEST_VISIT(X)                                                                     \
  {                                                                                           \
    bool seen = false;                                                                        \
    visit(BodyType::X, [&]<class J>() { seen = std::is_same_v<J, X>; });                      \
    EXPECT_TRUE(seen) << #X;                                                                  \
    EXPECT_EQ(count++, int(BodyType::X)) << "the list and the enumeration must be in one order"; \
  }
  DYN_PRIMITIVES(DYN_TEST_VISIT)
}

TEST(List, EveryUserJointTypeHasANameSizesAndATest) {
  std::set<std::string> names;
  for (const dynJointType type : every<dynJointType>("dynJointType")) {
    names.insert(name_of(type));
    if (type == DYN_JOINT_TYPE_FIXED || type == DYN_JOINT_TYPE_COMPOSITE) continue;
    EXPECT_GT(joint_nv(type), 0);
    EXPECT_GE(joint_nq(type), joint_nv(type));
    EXPECT_EQ(std::size_t(joint_nq(type)), lengths([&] { JointSpec s; s.type = type; return s; }(), true).size());
  }
  EXPECT_EQ(std::size_t(Members<dynJointType>::count), names.size());
  EXPECT_STREQ("unknown", name_of(dynJointType(Members<dynJointType>::last + 1)));
}

}  // namespace
}  // namespace dyn_test
