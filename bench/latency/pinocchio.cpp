// latency_pinocchio CALLS arm.urdf quadruped.urdf
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/parsers/urdf.hpp>

#include "latency.hpp"

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  const std::int64_t calls = std::atoll(argv[1]);
  const char* names[2][3] = {{"arm RNEA", "arm ABA", "arm CRBA"}, {"quadruped RNEA", "quadruped ABA", "quadruped CRBA"}};
  for (int robot = 0; robot < 2; ++robot) {
    pinocchio::Model m;
    if (robot) pinocchio::urdf::buildModel(argv[3], pinocchio::JointModelFreeFlyer(), m);
    else pinocchio::urdf::buildModel(argv[2], m);
    pinocchio::Data d(m);
    Eigen::VectorXd q = pinocchio::neutral(m), v(m.nv), a(m.nv);
    const int first = m.nq > m.nv ? 7 : 0;
    const auto change = [&](int k) {
      for (int i = first; i < m.nq; ++i) q[i] = latency::input(k, i);
      for (int i = 0; i < m.nv; ++i) v[i] = latency::input(k, i + 3), a[i] = latency::input(k, i + 5);
    };
    latency::measure(names[robot][0], calls, change, [&] { pinocchio::rnea(m, d, q, v, a); });
    latency::measure(names[robot][1], calls, change, [&] { pinocchio::aba(m, d, q, v, a); });
    latency::measure(names[robot][2], calls, change, [&] { pinocchio::crba(m, d, q); });
  }
}
