// Joints in the order of the model that will be made, and configurations by joints.
#include <algorithm>

#include "builder_impl.hpp"
#include "joint/list.hpp"

namespace dyn {

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

int own_nq(const JointEntry& joint) { return joint.spec.mimic.empty() ? spec_nq(joint.spec) : 0; }
int own_nv(const JointEntry& joint) { return joint.spec.mimic.empty() ? spec_nv(joint.spec) : 0; }

std::vector<double> neutral_of(const JointEntry& joint) {
  std::vector<double> q(std::size_t(spec_nq(joint.spec)));
  double* at = q.data();
  for (const PlacedElement& e : joint.elements)
    visit(e.element.type, [&]<class J>() {
      J::neutral(at);
      at += J::nq;
    });
  return q;
}

std::vector<std::vector<double>> by_joint(const std::vector<JointEntry>& joints, const std::vector<double>& x,
                                          int (*size)(const JointEntry&)) {
  std::vector<std::vector<double>> own(joints.size());
  auto at = x.begin();
  for (int j : depth_first(joints)) {
    const int n = size(joints[std::size_t(j)]);
    own[std::size_t(j)].assign(at, at + n);
    at += n;
  }
  return own;
}

void Builder::Impl::split_configurations() {
  std::size_t nq = 0;
  for (const JointEntry& j : joints) nq += std::size_t(own_nq(j));
  for (ConfigurationEntry& c : configurations) {
    if (c.split) continue;
    if (c.whole.size() != nq)
      throw Error(DYN_ERROR_SIZE, "configuration '" + c.name + "' has " + std::to_string(c.whole.size()) +
                                      " numbers, but what is built so far has nq = " + std::to_string(nq) +
                                      ": name configurations after the last joint");
    c.by_joint = by_joint(joints, c.whole);
    c.whole.clear(), c.split = true;
  }
}

}  // namespace dyn
