// Instructions of calls, one by one, of an arm and a quadruped, and of steps with contacts: name and count a line.
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
  floor.type = DYN_SHAPE_TYPE_HALF_SPACE, floor.name = "floor";
  check(dyn_builder_add_shape(b, &floor));
  dynModel* m = nullptr;
  check(dyn_builder_finish(b, &m));
  dyn_builder_free(b);
  return m;
}

// Boxes of 0.1 m, one on another, on a floor.
dynModel* stack(int boxes) {
  dynBuilder* b = nullptr;
  check(dyn_builder_new("stack", &b));
  dynShapeSpec shape;
  dyn_shape_spec_init(&shape);
  shape.type = DYN_SHAPE_TYPE_HALF_SPACE;
  check(dyn_builder_add_shape(b, &shape));
  for (int k = 0; k < boxes; ++k) {
    const std::string name = "box" + std::to_string(k), link = "link_" + name;
    dynJointSpec joint;
    dyn_joint_spec_init(&joint);
    joint.name = name.c_str(), joint.type = DYN_JOINT_TYPE_FREE_FLYER;
    const double com[3] = {}, I[9] = {1e-2 / 6, 0, 0, 0, 1e-2 / 6, 0, 0, 0, 1e-2 / 6};
    check(dyn_builder_add_joint(b, &joint)), check(dyn_builder_add_body(b, link.c_str(), name.c_str(), nullptr, 1, com, I));
    dyn_shape_spec_init(&shape);
    shape.body = link.c_str(), shape.type = DYN_SHAPE_TYPE_BOX;
    for (double& x : shape.size) x = 0.1;
    check(dyn_builder_add_shape(b, &shape));
  }
  dynModel* m = nullptr;
  check(dyn_builder_finish(b, &m));
  dyn_builder_free(b);
  return m;
}

// Of a step, the mean of 10 after 50 that settle: the solver's iterations differ from step to step.
void count_steps(const std::string& name, const dynModel* m, const double* q) {
  dynData* d = nullptr;
  check(dyn_data_new(m, DYN_PART_SIMULATION, &d)), check(dyn_data_warm_up(m, d)),
      check(dyn_data_set_state(m, d, q, nullptr, nullptr, nullptr));
  for (int k = 0; k < 50; ++k) check(dyn_step(m, d));
  const long ten = bench::instructions([&] { for (int k = 0; k < 10; ++k) check(dyn_step(m, d)); });
  dynStepReport r{};
  r.struct_size = sizeof r;
  int iterations = 0;
  for (int k = 0; k < 10; ++k) check(dyn_step(m, d)), check(dyn_data_step_report(m, d, &r)), iterations += int(r.iterations);
  std::printf("%s\t%ld\t%d contacts, %.1f iterations\n", name.c_str(), ten / 10, r.contacts, iterations / 10.0);
  dyn_data_free(d);
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
    check(dyn_data_new(m, DYN_PART_ALL, &d)), check(dyn_data_warm_up(m, d));
    const int nq = dyn_model_nq(m), nv = dyn_model_nv(m);
    std::vector<double> q(static_cast<std::size_t>(nq)), v(static_cast<std::size_t>(nv)), a = v,
                                                                                          out(std::size_t(nv) * std::size_t(nv));
    check(dyn_configuration_neutral(m, q.data()));
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
      dynModel* standing = on_floor(m);
      for (int leg = 0; leg < 4; ++leg)
        q[std::size_t(7 + 3 * leg)] = 0, q[std::size_t(8 + 3 * leg)] = 0.8, q[std::size_t(9 + 3 * leg)] = -1.5;
      q[2] = 0.331;
      count_steps(robot + "step with contacts", standing, q.data());
      dyn_model_free(standing);
    }
    dyn_model_free(m);
  }
  constexpr int boxes = 5;
  dynModel* m = stack(boxes);
  std::vector<double> q(std::size_t(7 * boxes));
  check(dyn_configuration_neutral(m, q.data()));
  for (int k = 0; k < boxes; ++k) q[std::size_t(7 * k + 2)] = 0.05 + 0.1 * k;
  count_steps("stack of 5 boxes, step", m, q.data());
  dyn_model_free(m);
}
