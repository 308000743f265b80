// latency_mujoco CALLS arm.xml quadruped.xml landed.xml scene.xml...
#include <mujoco/mujoco.h>

#include "latency.hpp"

int main(int argc, char** argv) {
  if (argc < 5) return 2;
  const std::int64_t calls = std::atoll(argv[1]);
  char error[500] = "";
  const char* names[2][3] = {{"arm RNEA", "arm ABA", "arm CRBA"}, {"quadruped RNEA", "quadruped ABA", "quadruped CRBA"}};
  for (int robot = 0; robot < 2; ++robot) {
    mjModel* m = mj_loadXML(argv[2 + robot], nullptr, error, sizeof error);
    if (!m) return std::fprintf(stderr, "%s\n", error), 1;
    m->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_CONSTRAINT;
    mjData* d = mj_makeData(m);
    std::vector<double> out(std::size_t(m->nv) * std::size_t(m->nv));
    const int first = m->nq > m->nv ? 7 : 0;
    const auto change = [&](int k) {
      for (int i = first; i < m->nq; ++i) d->qpos[i] = latency::input(k, i);
      for (int i = 0; i < m->nv; ++i)
        d->qvel[i] = latency::input(k, i + 3), d->qacc[i] = d->qfrc_applied[i] = latency::input(k, i + 5);
    };
    // from q, v to the result, by the functions that it takes
    latency::measure(names[robot][0], calls, change,
                     [&] { mj_kinematics(m, d), mj_comPos(m, d), mj_comVel(m, d), mj_rne(m, d, 1, out.data()); });
    latency::measure(names[robot][1], calls, change, [&] { mj_forward(m, d); });
    latency::measure(names[robot][2], calls, change,
                     [&] { mj_kinematics(m, d), mj_comPos(m, d), mj_makeM(m, d), mj_fullM(m, d, out.data()); });
    mj_deleteData(d), mj_deleteModel(m);
  }
  for (int k = 4; k < argc; ++k) {
    const bool landed = k == 4;
    mjModel* m = mj_loadXML(argv[k], nullptr, error, sizeof error);
    if (!m) return std::fprintf(stderr, "%s\n", error), 1;
    mjData *d = mj_makeData(m), *start = mj_makeData(m);
    for (int i = 0; landed && i < 200; ++i) mj_step(m, d);
    mj_copyData(start, m, d);
    latency::measure(
        landed ? "step in contact" : latency::row_of(argv[k]).c_str(), landed ? calls / 10 : latency::scene_calls(calls),
        [&](int i) {
          if (i % (landed ? 100 : latency::scene_steps) == 0) mj_copyData(d, m, start);
        },
        [&] { mj_step(m, d); });
    mj_deleteData(start), mj_deleteData(d), mj_deleteModel(m);
  }
}
