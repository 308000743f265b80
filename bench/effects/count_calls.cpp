// Instructions of calls, one by one, of an arm and a quadruped: name and count a line.
//   dyn_count_calls ARM.urdf QUADRUPED.urdf
// With LD_LIBRARY_PATH those of another build of the library: what -DDYN_REPRODUCIBLE=ON costs, for one.
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "count.hpp"
#include "dyn.h"
#include "latency/latency.hpp"

namespace {

void check(dynStatus s) {
  if (s != DYN_OK) std::fprintf(stderr, "%s\n", dyn_last_error()), std::exit(1);
}

dynModel* load(const char* path, dynBase base) {
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = base, options.constraint_slots = 0;
  dynModel* m = nullptr;
  check(dyn_model_load(path, &options, &m));
  return m;
}

dynModel* on_floor(const dynModel* robot) {
  dynBuilder* b = nullptr;
  check(dyn_builder_from_model(robot, &b));
  dynShapeSpec floor;
  dyn_shape_spec_init(&floor);
  floor.type = DYN_SHAPE_HALF_SPACE, floor.name = "floor";
  check(dyn_builder_shape(b, &floor));
  dynModel* m = nullptr;
  check(dyn_builder_finish(b, &m));
  dyn_builder_free(b);
  return m;
}

// Of a call on an input that is new, after one on another.
void count(const std::string& name, const std::function<void(int)>& input, const std::function<void()>& call) {
  input(0), call(), input(1);
  std::printf("%s\t%ld\n", name.c_str(), bench::instructions(call));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "dyn_count_calls ARM.urdf QUADRUPED.urdf\n"), 2;
  std::printf("%s\n", dyn_build_info());
  for (const bool legged : {false, true}) {
    dynModel* m = load(argv[1 + legged], legged ? DYN_BASE_FLOATING : DYN_BASE_FIXED);
    dynData* d = nullptr;
    check(dyn_data_new(m, DYN_PART_ALL, &d)), check(dyn_warmup(m, d));
    const int nq = dyn_nq(m), nv = dyn_nv(m);
    std::vector<double> q(static_cast<std::size_t>(nq)), v(static_cast<std::size_t>(nv)), a = v, out(std::size_t(nv) * std::size_t(nv));
    check(dyn_neutral(m, q.data()));
    const auto input = [&](int k) {
      for (int i = legged ? 7 : 0; i < nq; ++i) q[std::size_t(i)] = latency::input(k, i);
      for (int i = 0; i < nv; ++i) v[std::size_t(i)] = latency::input(k, i + 3), a[std::size_t(i)] = latency::input(k, i + 5);
    };
    const std::string robot = legged ? "quadruped, " : "arm, ";
    count(robot + "forward kinematics", input, [&] { check(dyn_forward_kinematics(m, d, q.data(), nullptr, nullptr)); });
    count(robot + "RNEA", input, [&] { check(dyn_rnea(m, d, q.data(), v.data(), a.data(), nullptr, out.data())); });
    count(robot + "ABA", input, [&] { check(dyn_aba(m, d, q.data(), v.data(), a.data(), nullptr, out.data())); });
    count(robot + "CRBA", input, [&] { check(dyn_crba(m, d, q.data(), out.data())); });
    dyn_data_free(d);
    if (legged) {
      dynModel* landing = on_floor(m);
      check(dyn_data_new(landing, DYN_PART_ALL, &d));
      for (int leg = 0; leg < 4; ++leg) q[std::size_t(7 + 3 * leg)] = 0, q[std::size_t(8 + 3 * leg)] = 0.8, q[std::size_t(9 + 3 * leg)] = -1.5;
      q[2] = 0.331;
      check(dyn_data_set_state(landing, d, q.data(), nullptr, nullptr, nullptr));
      for (int k = 0; k < 50; ++k) check(dyn_step(landing, d));
      count(robot + "step with contacts", [](int) {}, [&] { check(dyn_step(landing, d)); });
      dyn_data_free(d), dyn_model_free(landing);
    }
    dyn_model_free(m);
  }
}
