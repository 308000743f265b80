// A hinge between limits.
#pragma once

#include "common/random_tree.hpp"
#include "common/work.hpp"
#include "simulation/workspace.hpp"

namespace dyn_test {

// A hinge, a radian away from each of its limits.
struct Hinge {
  static constexpr double gap = 1;
  ModelPtr model = build();
  Work<double> w{*model};
  static ModelPtr build() {
    Tree t;
    JointSpec s;
    s.name = "hinge", s.lower = {-gap}, s.upper = {gap};
    t.joints.push_back(s);
    BodySpec b;
    b.name = "arm", b.parent = "hinge";
    t.bodies.push_back(b);
    return t.build();
  }
};

}  // namespace dyn_test
