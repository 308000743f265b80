// Tests that what a caller can do wrong is never called an internal error: sizes and names beyond all bounds.
#include <filesystem>
#include <functional>

#include "capi/support.hpp"

namespace dyn_test {
namespace {

struct Case {
  const char* name;
  dynStatus status;
  std::function<dynStatus()> call;
};

TEST(Limits, CallersMistakesAreNoInternalErrors) {
  const Model m = chain(2);
  Builder b;
  b.joint(Spec("a", DYN_JOINT_TYPE_REVOLUTE)).body("l", "a");
  const std::string longest(1 << 20, 'x'), path = "/" + longest + ".stl", urdf = "/" + longest + ".urdf";
  const double q[2] = {};
  const char* name = "a";
  const char* const* names = &name;
  dynMesh* mesh = nullptr;
  dynModel* model = nullptr;
  dynBatch* batch = nullptr;
  dynBroadPhase* boxes = nullptr;
  const double corner[3] = {};
  dynLoadOptions load;
  dyn_load_options_init(&load);
  load.package_dirs = names, load.package_dirs_count = SIZE_MAX;
  dynLoadOptions srdf;
  dyn_load_options_init(&srdf);
  srdf.srdf = urdf.c_str();
  dynMeshOptions options, relative;
  dyn_mesh_options_init(&options), dyn_mesh_options_init(&relative);
  options.package_dirs = names, options.package_dirs_count = SIZE_MAX;
  relative.relative_to = urdf.c_str();
  const std::string remote =
      "<robot name='r'><link name='a'><collision><geometry><mesh filename='" + path + "'/></geometry></collision></link></robot>";
  dynLoadOptions hulls;
  dyn_load_options_init(&hulls);
  hulls.meshes = DYN_MESH_USE_HULL;
  const Case cases[] = {
      {"dyn_builder_add_configuration", DYN_ERROR_SIZE, [&] { return dyn_builder_add_configuration(b, "c", q, SIZE_MAX); }},
      {"dyn_builder_add_configuration, 2^60", DYN_ERROR_SIZE,
       [&] { return dyn_builder_add_configuration(b, "c", q, std::size_t(1) << 60); }},
      {"dyn_builder_lock: q", DYN_ERROR_SIZE, [&] { return dyn_builder_lock(b, names, 1, q, SIZE_MAX); }},
      {"dyn_builder_lock: joints", DYN_ERROR_SIZE, [&] { return dyn_builder_lock(b, names, SIZE_MAX, q, 1); }},
      {"dyn_mesh_load: path", DYN_ERROR_FILE, [&] { return dyn_mesh_load(path.c_str(), nullptr, &mesh); }},
      {"dyn_mesh_load: package://", DYN_ERROR_FILE,
       [&] { return dyn_mesh_load(("package://p" + path).c_str(), nullptr, &mesh); }},
      {"dyn_mesh_load: relative_to", DYN_ERROR_FILE, [&] { return dyn_mesh_load("m.stl", &relative, &mesh); }},
      {"dyn_mesh_load: package_dirs_count", DYN_ERROR_LIMIT, [&] { return dyn_mesh_load("m.stl", &options, &mesh); }},
      {"dyn_mesh_from_arrays", DYN_ERROR_LIMIT, [&] { return dyn_mesh_from_arrays(corner, SIZE_MAX, nullptr, 0, &mesh); }},
      {"dyn_model_load: path", DYN_ERROR_FILE, [&] { return dyn_model_load(urdf.c_str(), nullptr, &model); }},
      {"dyn_model_load_string: srdf", DYN_ERROR_FILE,
       [&] { return dyn_model_load_string("<robot name='r'><link name='a'/></robot>", &srdf, &model); }},
      {"dyn_model_load_string: package_dirs_count", DYN_ERROR_LIMIT,
       [&] { return dyn_model_load_string("<robot name='r'><link name='a'/></robot>", &load, &model); }},
      {"dyn_model_load_string: mesh", DYN_ERROR_FILE, [&] { return dyn_model_load_string(remote.c_str(), &hulls, &model); }},
      {"dyn_model_save", DYN_ERROR_FILE, [&] { return dyn_model_save(m, urdf.c_str(), nullptr); }},
      {"dyn_batch_new", DYN_ERROR_LIMIT, [&] { return dyn_batch_new(m, 0, INT32_MAX, &batch); }},
      {"dyn_broad_phase_new", DYN_ERROR_LIMIT, [&] { return dyn_broad_phase_new(INT32_MAX, INT64_MAX, 0, &boxes); }},
  };
  for (const Case& c : cases) {
    const dynStatus status = c.call();
    EXPECT_EQ(c.status, status) << c.name << ": " << dyn_status_name(status) << ": " << dyn_last_error();
    EXPECT_GT(std::strlen(dyn_last_error()), 20u) << c.name;
  }
}

}  // namespace
}  // namespace dyn_test
