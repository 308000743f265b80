// Instructions of mj_step in the steady state of each scene given as a file. Built by bench/effects.py.
#include <mujoco/mujoco.h>

#include <cstdio>

#include "count.hpp"

int main(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    char error[500] = "";
    mjModel* m = mj_loadXML(argv[k], nullptr, error, sizeof error);
    if (!m) return std::fprintf(stderr, "%s: %s\n", argv[k], error), 1;
    mjData* d = mj_makeData(m);
    for (int i = 0; i < 5; ++i) mj_step(m, d);
    std::printf("%ld\n", bench::instructions([&] { mj_step(m, d); }));
    mj_deleteData(d), mj_deleteModel(m);
  }
}
