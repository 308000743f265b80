// A C++ user of the installed library: loads a robot and checks that forward dynamics undoes inverse dynamics.
#include <dyn.hpp>

#include <cmath>
#include <cstdio>

int main(int argc, char** argv) try {
  if (argc != 2) return 2;
  const auto model = dyn::Model::load(argv[1], dyn::LoadOptions().base(DYN_BASE_FIXED));
  dyn::Data data(model);
  const dyn::Vector q = model.random(1), v(static_cast<std::size_t>(model.nv()), 0.5), a(v.size(), -0.25);
  const dyn::Vector tau = data.rnea(q, v, a).copy();
  const dyn::View ddq = data.aba(q, v, tau);
  double error = 0;
  for (std::size_t i = 0; i < a.size(); ++i) error = std::fmax(error, std::fabs(ddq[i] - a[i]));
  std::printf("libdyn %s, nq %d, nv %d, ABA(RNEA) %s\n", dyn_version(), model.nq(), model.nv(),
              error < 1e-9 ? "agrees" : "disagrees");
  return error < 1e-9 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
