// On the PC: writes the models of the images and the reference results.   dyn_board_tables MODELS_DIR OUT_DIR
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "boards/distances.hpp"
#include "boards/figures.hpp"
#include "boards/worst.hpp"
#include "guard.hpp"
#include "model/block.hpp"

namespace {

void check(dynStatus status) {
  if (status == DYN_OK) return;
  std::fprintf(stderr, "%s\n", dyn_last_error());
  std::exit(1);
}

dynModel* load(const std::string& path, dynBase base) {
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = base, options.constraint_slots = 0;
  dynModel* m = nullptr;
  check(dyn_model_load(path.c_str(), &options, &m));
  return m;
}

// A robot above a floor, which lies at some height, and its configuration there.
dynModel* on_floor(const dynModel* robot, const std::vector<double>& q, double height = 0) {
  dynBuilder* b = nullptr;
  check(dyn_builder_from_model(robot, &b));
  dynShapeSpec floor;
  dyn_shape_spec_init(&floor);
  floor.type = DYN_SHAPE_TYPE_HALF_SPACE, floor.name = "floor";
  floor.placement[11] = height;
  check(dyn_builder_add_shape(b, &floor));
  check(dyn_builder_add_configuration(b, "standing", q.data(), q.size()));
  dynModel* m = nullptr;
  check(dyn_builder_finish(b, &m));
  return m;
}

// A free body for each convex shape but hulls.
dynModel* shapes() {
  struct {
    const char* name;
    dynShapeType type;
    double size[3];
  } const all[] = {{"sphere", DYN_SHAPE_TYPE_SPHERE, {0.08, 0, 0}},         {"capsule", DYN_SHAPE_TYPE_CAPSULE, {0.04, 0.2, 0}},
                   {"box", DYN_SHAPE_TYPE_BOX, {0.1, 0.16, 0.2}},           {"cylinder", DYN_SHAPE_TYPE_CYLINDER, {0.07, 0.2, 0}},
                   {"cone", DYN_SHAPE_TYPE_CONE, {0.09, 0.2, 0}},           {"ellipsoid", DYN_SHAPE_TYPE_ELLIPSOID, {0.05, 0.08, 0.12}}};
  const double com[3] = {}, inertia[9] = {0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01};
  dynBuilder* b = nullptr;
  check(dyn_builder_new("shapes", &b));
  for (const auto& x : all) {
    const std::string joint = std::string(x.name) + "_joint";
    dynJointSpec free;
    dyn_joint_spec_init(&free);
    free.name = joint.c_str(), free.type = DYN_JOINT_TYPE_FREE_FLYER;
    check(dyn_builder_add_joint(b, &free));
    check(dyn_builder_add_body(b, x.name, joint.c_str(), nullptr, 1, com, inertia));
    dynShapeSpec shape;
    dyn_shape_spec_init(&shape);
    shape.name = shape.body = x.name, shape.type = x.type;
    for (int i = 0; i < 3; ++i) shape.size[i] = x.size[i];
    check(dyn_builder_add_shape(b, &shape));
  }
  dynModel* m = nullptr;
  check(dyn_builder_finish(b, &m));
  return m;
}

// As dyn convert does: 64-bit words.
void write_image(std::FILE* f, const dynModel* m, std::uint32_t flags) {
  std::size_t size = 0;
  check(dyn_model_image(m, flags, nullptr, 0, &size));
  std::vector<unsigned long long> image(size / 8);
  check(dyn_model_image(m, flags, image.data(), size, &size));
  std::fprintf(f, "alignas(64) constexpr unsigned long long image[] = {");
  for (std::size_t k = 0; k < image.size(); ++k) std::fprintf(f, "%s0x%llx,", k % 8 ? " " : "\n", image[k]);
  std::fprintf(f, "\n};\n");
}

// The robot, and what run(out) computes.
template <class Run>
void write(const std::string& dir, const char* name, const dynModel* m, std::size_t bytes, Run&& run,
           const std::vector<double>& start = {}) {
  std::FILE* f = std::fopen((dir + "/" + name + ".hpp").c_str(), "w");
  if (!f) std::perror(dir.c_str()), std::exit(1);
  std::fprintf(f, "#if DYN_LANES != 4\n");
  write_image(f, m, DYN_IMAGE_NARROW | DYN_IMAGE_NAMELESS);
  std::fprintf(f, "#else\n");
  write_image(f, m, DYN_IMAGE_NAMELESS);
  std::fprintf(f, "#endif\nconstexpr double figures[] = {");
  int n = 0;
  run([&](double x) { std::fprintf(f, "%s%a,", n++ % 8 ? " " : "\n", x); });
  std::fprintf(f, "\n};\nconstexpr unsigned long data_bytes = %zu;\n", bytes);
  if (!start.empty()) std::fprintf(f, "constexpr double start[] = {");
  for (double x : start) std::fprintf(f, "%a, ", x);
  if (!start.empty()) std::fprintf(f, "};\n");
  std::fclose(f);
  std::printf("%s: model %zu bytes, data %zu, %d figures\n", name, std::size_t(m->m->bytes), bytes, n);
}
template <class X, class Figures>
void write(const std::string& dir, const char* name, const dynModel* handle, Figures&& figures) {
  const dyn::Model& m = *handle->m;  // with names: what they are is no figure
  const dyn::Zeros zeros(X::bytes(m));
  write(dir, name, handle, X::bytes(m), [&](auto&& out) {
    figures(m, zeros.memory, out, [](const char*, int calls, auto&& call) {
      while (calls--) call();
    });
  });
}

// A robot of the table of worst cases, with the steps from start.
void write_worst(const std::string& dir, const char* name, const dynModel* m, const std::vector<double>& start) {
  dynData* d = nullptr;
  check(dyn_data_new(m, boards::worst_parts_of_steps, &d));
  write(
      dir, name, m, dyn_data_size(m, boards::worst_parts_of_steps),
      [&](auto&& out) { check(boards::worst_figures(m, d, start.data(), out, [](const char*, auto&& call) { return call(); })); },
      start);
  dyn_data_free(d);
}

void write_distances(const std::string& dir, const dynModel* m) {
  dynData* d = nullptr;
  check(dyn_data_new(m, boards::parts_of_distances, &d));
  write(dir, "distances_shapes", m, dyn_data_size(m, boards::parts_of_distances),
        [&](auto&& out) { check(boards::distance_figures(m, d, out, [](auto&& call) { return call(); })); });
  dyn_data_free(d);
}

}  // namespace

int main(int count, char** argument) {
  if (count != 3) return std::fprintf(stderr, "dyn_board_tables MODELS_DIR OUT_DIR\n"), 2;
  const std::string models = argument[1], out = argument[2];
  using namespace boards;
  const auto rnea = [](auto&&... x) { rnea_figures(x...); };
  const auto dynamics = [](auto&&... x) { dynamics_figures(x...); };
  const auto contact = [](auto&&... x) { contact_figures(x...); };
  dynModel* const arm = load(models + "/robots/panda.urdf", DYN_BASE_FIXED);
  dynModel* const quadruped = load(models + "/robots/go2.urdf", DYN_BASE_FLOATING);
  dynModel* const humanoid = load(models + "/robots/humanoid.urdf", DYN_BASE_FLOATING);
  const std::vector<double> reaching = {0, 0.6, 0, -2.2, 0, 2.8, 0.8, 0.02};
  std::vector<double> landing = {0, 0, 0.331, 0, 0, 0, 1}, standing = {0, 0, 0.926, 0, 0, 0, 1};
  for (int leg = 0; leg < 4; ++leg) landing.insert(landing.end(), {0, 0.8, -1.5});
  standing.resize(std::size_t(dyn_model_nq(humanoid)));
  dynModel* const quadruped_on_floor = on_floor(quadruped, landing);
  write<Rnea>(out, "rnea_arm", arm, rnea);
  write<Dynamics>(out, "dynamics_arm", arm, dynamics);
  write<Dynamics>(out, "dynamics_quadruped", quadruped, dynamics);
  write<Steps>(out, "contact_quadruped", quadruped_on_floor, contact);
  write_distances(out, shapes());
  write_worst(out, "worst_arm", on_floor(arm, reaching, -0.01), reaching);
  write_worst(out, "worst_quadruped", quadruped_on_floor, landing);
  write_worst(out, "worst_humanoid", on_floor(humanoid, standing), standing);
  return 0;
}
