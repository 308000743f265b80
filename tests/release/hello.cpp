// The torques that hold a robot against gravity at its neutral configuration.
#include <cstdio>
#include <dyn.hpp>
#include <exception>
#include <vector>

int main(int count, char** words) try {
  if (count != 2) return 2;
  dyn::LoadOptions options;
  options.base(DYN_BASE_FLOATING);
  const dyn::Model model = dyn::Model::load(words[1], options);
  dyn::Data data(model);
  const std::vector<double> zero(model.nv());
  std::vector<double> tau(model.nv());
  dyn::check(dyn_rnea(model.get(), data.get(), model.neutral().data(), zero.data(), zero.data(), nullptr, tau.data()));
  std::printf("C++: libdyn %s, nv %d, weight %.3f N\n", dyn_version(), model.nv(), tau[2]);
  return tau[2] > 0 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
