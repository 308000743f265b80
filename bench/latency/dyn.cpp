// latency_dyn CALLS arm.urdf quadruped.urdf landed.xml scene.xml...
#include "dyn.h"
#include "latency.hpp"

static void check(dynStatus s) {
  if (s != DYN_OK) std::fprintf(stderr, "%s\n", dyn_last_error()), std::exit(1);
}

static dynModel* load(const char* path, dynBase base) {
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = base, options.meshes = DYN_MESH_USE_HULL;
  dynModel* m = nullptr;
  check(dyn_model_load(path, &options, &m));
  return m;
}

int main(int argc, char** argv) {
  if (argc < 5) return 2;
  const std::int64_t calls = std::atoll(argv[1]);
  const char* names[2][3] = {{"arm RNEA", "arm ABA", "arm CRBA"}, {"quadruped RNEA", "quadruped ABA", "quadruped CRBA"}};
  for (int robot = 0; robot < 2; ++robot) {
    dynModel* m = load(argv[2 + robot], robot ? DYN_BASE_FLOATING : DYN_BASE_FIXED);
    dynData* d = nullptr;
    check(dyn_data_new(m, DYN_PART_ALL, &d)), check(dyn_data_warm_up(m, d));
    const int nq = dyn_model_nq(m), nv = dyn_model_nv(m), first = nq - nv ? 7 : 0;
    std::vector<double> q(static_cast<std::size_t>(nq)), v(static_cast<std::size_t>(nv)), a = v,
                                                                                          out(std::size_t(nv) * std::size_t(nv));
    check(dyn_configuration_neutral(m, q.data()));
    const auto change = [&](int k) {
      for (int i = first; i < nq; ++i) q[std::size_t(i)] = latency::input(k, i);
      for (int i = 0; i < nv; ++i) v[std::size_t(i)] = latency::input(k, i + 3), a[std::size_t(i)] = latency::input(k, i + 5);
    };
    latency::measure(names[robot][0], calls, change, [&] { dyn_rnea(m, d, q.data(), v.data(), a.data(), nullptr, out.data()); });
    latency::measure(names[robot][1], calls, change, [&] { dyn_aba(m, d, q.data(), v.data(), a.data(), nullptr, out.data()); });
    latency::measure(names[robot][2], calls, change, [&] { dyn_crba(m, d, q.data(), out.data()); });
  }
  for (int k = 4; k < argc; ++k) {
    const bool landed = k == 4;  // steps of a scene that rests, or of one from its beginning
    dynModel* m = load(argv[k], DYN_BASE_UNSPECIFIED);
    dynData* d = nullptr;
    check(dyn_data_new(m, DYN_PART_SIMULATION, &d)), check(dyn_data_warm_up(m, d));
    std::vector<double> q(static_cast<std::size_t>(dyn_model_nq(m)));
    check(dyn_model_configuration(m, "qpos0", q.data())), check(dyn_data_set_state(m, d, q.data(), nullptr, nullptr, nullptr));
    std::vector<char> start(dyn_model_state_size(m));
    for (int i = 0; landed && i < 200; ++i) check(dyn_step(m, d));
    check(dyn_data_save_state(m, d, start.data(), start.size()));
    latency::measure(
        landed ? "step in contact" : latency::row_of(argv[k]).c_str(), landed ? calls / 10 : latency::scene_calls(calls),
        [&](int i) {
          if (i % (landed ? 100 : latency::scene_steps) == 0) check(dyn_data_restore_state(m, d, start.data(), start.size()));
        },
        [&] { check(dyn_step(m, d)); });
    dyn_data_free(d), dyn_model_free(m);
  }
}
