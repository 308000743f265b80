// Tests what happens when memory, disk or time to live end: an error that says so, nothing lost, nothing half written.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "capi/surfaces.hpp"
#include "rt/interposed.hpp"

namespace dyn_test {
namespace {

namespace fs = std::filesystem;

std::string content(const std::string& path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

class Faults : public testing::Test {
 protected:
  fs::path folder = fs::temp_directory_path() / ("dyn_faults_" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  std::string file(const char* name) const { return (folder / name).string(); }
};

// f, which gives back what it makes, with no memory after k allocations, for k = 0, 1, ... until it succeeds: DYN_ERROR_MEMORY,
// and no block is lost.
int without_memory(const char* what, const std::function<dynStatus()>& f) {
  // what is made once for all, and handles: the slots of freed ones are used again after 256 others
  for (int k = 0; k < 300; ++k) EXPECT_EQ(DYN_OK, f()) << what << ": " << dyn_last_error();
  for (int k = 0;; ++k) {
    const long before = blocks;
    refused_urdfdom = false;
    until_no_memory = k;
    const dynStatus status = f();
    until_no_memory = -1;
    if (status == DYN_OK) return k;
    EXPECT_EQ(DYN_ERROR_MEMORY, status) << what << ", allocation " << k << ": " << dyn_last_error();
    if (!refused_urdfdom) {
      EXPECT_EQ(before, blocks) << what << ", allocation " << k << ": " << dyn_last_error();
    }
    if (::testing::Test::HasFailure()) return k;
  }
}

dynStatus load(const std::string& text, dynBase base, dynModel** m) {
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = base;
  return dyn_model_load_string(text.c_str(), &options, m);
}

const std::string mjcf =
    R"(<mujoco><default><geom friction="0.5"/></default><worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 1"><freejoint/><geom size="0.1"/>
  <body pos="0.2 0 0"><joint name="hinge" damping="0.1" range="-1 1" limited="true"/><geom type="capsule" size="0.02 0.1"/></body></body></worldbody>
  <actuator><motor joint="hinge"/></actuator><keyframe><key qpos="0 0 1 1 0 0 0 0.2"/></keyframe></mujoco>)";

TEST_F(Faults, NoMemoryWhileLoading) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  const std::string urdf = content(std::string(DYN_MODELS_DIR) + "/robots/double_pendulum.urdf");
  const Model robot = dyn_test::robot("double_pendulum");
  ASSERT_EQ(DYN_OK, dyn_model_save(robot, file("m.dynb").c_str(), nullptr));
  const auto freed = [](dynModel* m, dynStatus s) { return dyn_model_free(m), s; };
  int counts[3] = {};
  counts[0] = without_memory("URDF", [&] {
    dynModel* m = nullptr;
    const dynStatus s = load(urdf, DYN_BASE_FIXED, &m);
    return freed(m, s);
  });
  counts[1] = without_memory("MJCF", [&] {
    dynModel* m = nullptr;
    const dynStatus s = load(mjcf, DYN_BASE_UNSPECIFIED, &m);
    return freed(m, s);
  });
  const std::string saved = file("m.dynb");
  counts[2] = without_memory(".dynb", [&] {
    dynModel* m = nullptr;
    const dynStatus s = dyn_model_load(saved.c_str(), nullptr, &m);
    return freed(m, s);
  });
  for (const int n : counts) EXPECT_GT(n, 50);
}

TEST_F(Faults, NoMemoryWhileSaving) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  const Model m = robot("gripper");
  for (const char* name : {"m.urdf", "m.xml", "m.dynb"}) {
    const std::string path = file(name);
    ASSERT_EQ(DYN_OK, dyn_model_save(m, path.c_str(), nullptr)) << dyn_last_error();
    const std::string good = content(path);
    without_memory(name, [&] { return dyn_model_save(m, path.c_str(), nullptr); });
    EXPECT_TRUE(good == content(path));
    const Model other = robot("double_pendulum");
    until_no_memory = 3;
    const dynStatus status = dyn_model_save(other, path.c_str(), nullptr);
    until_no_memory = -1;
    EXPECT_EQ(DYN_ERROR_MEMORY, status);
    EXPECT_TRUE(good == content(path)) << name;
  }
}

TEST_F(Faults, NoMemoryWhileCreating) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  const Model m = robot("go2", DYN_BASE_FLOATING);
  without_memory("data", [&] {
    dynData* d = nullptr;
    const dynStatus s = dyn_data_new(m, 0, &d);
    return dyn_data_free(d), s;
  });
  without_memory("contact solver", [&] {
    dynContactSolver* s = nullptr;
    const dynStatus status = dyn_contact_solver_new(12, &s);
    return dyn_contact_solver_free(s), status;
  });
  without_memory("planner", [&] {
    dynPlanner* p = nullptr;
    const dynStatus status = dyn_planner_new(m, 3, DYN_PLAN_INPUT_TAU, &p);
    return dyn_planner_free(p), status;
  });
  without_memory("broad phase", [&] {
    dynBroadPhase* b = nullptr;
    const dynStatus s = dyn_broad_phase_new(100, 1000, 0.1, &b);
    return dyn_broad_phase_free(b), s;
  });
  without_memory("mesh", [&] {
    const double vertices[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const std::int32_t triangles[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    dynMesh* mesh = nullptr;
    const dynStatus s = dyn_mesh_from_arrays(vertices, 4, triangles, 4, &mesh);
    return dyn_mesh_free(mesh), s;
  });
  without_memory("builder", [&] {
    dynBuilder* b = nullptr;
    dynModel* made = nullptr;
    const double com[3] = {0, 0, 0.1};
    const Spec joint("joint", DYN_JOINT_TYPE_REVOLUTE);
    dynStatus s = dyn_builder_new("built", &b);
    if (s == DYN_OK) s = dyn_builder_add_joint(b, &joint);
    if (s == DYN_OK) s = dyn_builder_add_body(b, "body", "joint", nullptr, 1, com, some_inertia);
    if (s == DYN_OK) s = dyn_builder_finish(b, &made);
    return dyn_model_free(made), dyn_builder_free(b), s;
  });
}

// A file that can be opened and not read.
TEST_F(Faults, ReadErrorsAreSaid) {
  dynModel* m = nullptr;
  for (const std::string& path : {std::string("/proc/self/mem"), folder.string(), file("none.urdf")}) {
    EXPECT_EQ(DYN_ERROR_FILE, dyn_model_load(path.c_str(), nullptr, &m)) << path;
    EXPECT_NE(nullptr, std::strstr(dyn_last_error(), path.c_str())) << dyn_last_error();
  }
  EXPECT_EQ(nullptr, m);
}

// f in a process of its own: its exit status.
int in_a_child(const std::function<int()>& f) {
  const pid_t child = fork();
  if (child == 0) _exit(f());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// A disk with no room for the whole of a file: the old one stays, and no part of the new one.
TEST_F(Faults, AFullDiskLeavesTheOldFile) {
  const Model small = robot("double_pendulum"), large = robot("humanoid", DYN_BASE_FLOATING);
  for (const char* name : {"m.urdf", "m.xml", "m.dynb"}) {
    ASSERT_EQ(DYN_OK, dyn_model_save(small, file(name).c_str(), nullptr));
    const std::string good = content(file(name));
    EXPECT_EQ(0, in_a_child([&] {
      signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{4096, 4096};
      setrlimit(RLIMIT_FSIZE, &limit);
      return dyn_model_save(large, file(name).c_str(), nullptr) == DYN_ERROR_FILE && std::strstr(dyn_last_error(), name) ? 0 : 1;
    })) << name;
    EXPECT_TRUE(good == content(file(name))) << name;
  }
  EXPECT_EQ(3, std::distance(fs::directory_iterator(folder), fs::directory_iterator())) << "something was left behind";
}

// Killed at any moment, the file is one of the two that were saved, whole.
TEST_F(Faults, KilledWhileSaving) {
  const Model one = robot("double_pendulum"), other = robot("humanoid", DYN_BASE_FLOATING);
  const std::string path = file("m.dynb");
  ASSERT_EQ(DYN_OK, dyn_model_save(other, path.c_str(), nullptr));
  const std::string b = content(path);
  ASSERT_EQ(DYN_OK, dyn_model_save(one, path.c_str(), nullptr));
  const std::string a = content(path);
  int ones = 0, others = 0;
  for (int round = 0; round < 100; ++round) {
    int ready[2];
    ASSERT_EQ(0, pipe(ready));
    const pid_t child = fork();
    if (child == 0) {
      for (char go = 0;;) {
        dyn_model_save(other, path.c_str(), nullptr), dyn_model_save(one, path.c_str(), nullptr);
        if (!go++ && write(ready[1], &go, 1) != 1) _exit(1);
      }
    }
    char byte;
    ASSERT_EQ(1, read(ready[0], &byte, 1));
    usleep(useconds_t(97 * round % 2000));
    kill(child, SIGKILL), waitpid(child, nullptr, 0), close(ready[0]), close(ready[1]);
    const std::string left = content(path);
    ASSERT_TRUE(left == a || left == b) << "round " << round << ": " << left.size() << " bytes";
    ++(left == a ? ones : others);
  }
  EXPECT_GT(ones + others, 99);
  EXPECT_EQ(DYN_OK, dyn_model_save(one, path.c_str(), nullptr));  // over what was left of the last
  EXPECT_TRUE(a == content(path));
}

// What a save replaces is the file that links lead to, with its permissions; files beside it are the user's own.
TEST_F(Faults, SavingReplacesOneFileAlone) {
  const Model one = robot("double_pendulum"), other = robot("humanoid", DYN_BASE_FLOATING);
  const auto save = [&](const Model& m, const char* name) { return dyn_model_save(m, file(name).c_str(), nullptr); };
  for (const char* name : {"m.urdf.part", "m.urdf.part0"}) std::ofstream(file(name)) << "mine";
  ASSERT_EQ(DYN_OK, save(one, "m.urdf")) << dyn_last_error();
  const std::string before = content(file("m.urdf"));
  fs::permissions(file("m.urdf"), fs::perms(0642));
  fs::create_symlink("m.urdf", file("link.urdf")), fs::create_symlink("new.dynb", file("dangling.dynb")),
      fs::create_directory(file("folder.xml"));
  ASSERT_EQ(DYN_OK, save(other, "link.urdf")) << dyn_last_error();
  ASSERT_EQ(DYN_OK, save(one, "dangling.dynb")) << dyn_last_error();
  EXPECT_TRUE(fs::is_symlink(file("link.urdf")) && fs::is_symlink(file("dangling.dynb")) &&
              fs::is_regular_file(file("new.dynb")));
  EXPECT_TRUE(before != content(file("m.urdf")));
  EXPECT_EQ(fs::perms(0642), fs::status(file("m.urdf")).permissions());
  EXPECT_EQ(DYN_ERROR_FILE, save(one, "folder.xml"));
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "not a regular file"));
  for (const char* name : {"m.urdf.part", "m.urdf.part0"}) EXPECT_EQ("mine", content(file(name)));
  EXPECT_EQ(7, std::distance(fs::directory_iterator(folder), fs::directory_iterator())) << "something was left behind";
}

TEST_F(Faults, WhatMayNotBeWrittenStays) {
  const Model m = robot("double_pendulum");
  std::ofstream(file("m.urdf")) << "mine";
  fs::permissions(file("m.urdf"), fs::perms(0444)), fs::permissions(folder, fs::perms::all);
  const int refused = in_a_child([&] {
    if (getuid() == 0 && setuid(65534) != 0) return 2;  // root may write anything
    return dyn_model_save(m, file("m.urdf").c_str(), nullptr) == DYN_ERROR_FILE &&
                   std::strstr(dyn_last_error(), "Permission denied")
               ? 0
               : 1;
  });
  EXPECT_EQ(0, refused);
  EXPECT_EQ("mine", content(file("m.urdf")));
  EXPECT_EQ(1, std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

// ---------------------------------------------------------------------------------------------------- capacities

// f(buffer, capacity, count) into 0, 1, n - 1, n and n + 1 elements of T: the first of them, nothing behind them, and how many
// there are.
template <class T, class F>
void expect_within(const char* what, F&& f) {
  std::int64_t n = 0;
  ASSERT_EQ(DYN_OK, f(static_cast<T*>(nullptr), 0, &n)) << what << ": " << dyn_last_error();
  ASSERT_GT(n, 2) << what;
  std::vector<T> all(static_cast<std::size_t>(n));
  ASSERT_EQ(DYN_OK, f(all.data(), n, &n));
  for (const std::int64_t capacity : {std::int64_t(0), std::int64_t(1), n - 1, n, n + 1}) {
    std::vector<T> out(static_cast<std::size_t>(n + 3));
    std::memset(static_cast<void*>(out.data()), 0x5a, out.size() * sizeof(T));
    std::int64_t count = 0;
    ASSERT_EQ(DYN_OK, f(out.data(), capacity, &count)) << what << ", room for " << capacity;
    EXPECT_EQ(n, count) << what;
    const std::size_t written = std::size_t(std::min(capacity, n));
    EXPECT_EQ(0, std::memcmp(out.data(), all.data(), written * sizeof(T))) << what << ", room for " << capacity;
    const unsigned char* behind = reinterpret_cast<const unsigned char*>(out.data() + written);
    EXPECT_TRUE(std::all_of(behind, reinterpret_cast<const unsigned char*>(out.data() + out.size()),
                            [](unsigned char c) { return c == 0x5a; }))
        << what << ", room for " << capacity;
  }
}

// All or nothing: f(buffer, size) with less than n bytes is DYN_ERROR_SIZE and writes nothing.
template <class F>
void expect_whole(const char* what, std::size_t n, F&& f) {
  for (const std::size_t size : {std::size_t(0), std::size_t(1), n - 1, n, n + 1}) {
    std::vector<unsigned char> memory(n + 64, 0x5a);
    const dynStatus s = f(memory.data(), size);
    EXPECT_EQ(size < n ? DYN_ERROR_SIZE : DYN_OK, s) << what << ", " << size << " of " << n << " bytes: " << dyn_last_error();
    const std::size_t from = size < n ? 0 : n;
    EXPECT_TRUE(std::all_of(memory.begin() + std::ptrdiff_t(from), memory.end(), [](unsigned char c) { return c == 0x5a; }))
        << what << ", " << size;
  }
}

TEST(Capacities, NothingIsWrittenBehindThem) {
  Builder b;
  b.body("ground", nullptr, 0, {0, 0, 0}, no_inertia).shape("ground", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0});
  for (const char* name : {"one", "two", "three"}) {
    b.joint(Spec((std::string(name) + "_joint").c_str(), DYN_JOINT_TYPE_FREE_FLYER))
        .body(name, (std::string(name) + "_joint").c_str());
    b.shape(name, DYN_SHAPE_TYPE_BOX, {0.4, 0.4, 0.4});
  }
  const Model m = b.finish();
  const Data d(m);
  Numbers q(std::size_t(m.nq()));
  ASSERT_EQ(DYN_OK, dyn_configuration_neutral(m, q.data()));
  for (std::size_t k = 0; k < 3; ++k) q[7 * k] = 0.39 * double(k), q[7 * k + 2] = 0.19;
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, q.data(), nullptr, nullptr, nullptr));
  ASSERT_EQ(DYN_OK, dyn_step(m, d));
  ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, q.data(), nullptr, nullptr, nullptr));
  const auto as_int = [](auto&& call) {
    return [call](auto* out, std::int64_t capacity, std::int64_t* count) {
      int n = 0;
      const dynStatus s = call(out, int(capacity), &n);
      return *count = n, s;
    };
  };
  expect_within<int>("dyn_collisions", as_int([&](int* out, int capacity, int* n) {
                       return dyn_collisions(m, d, nullptr, 0.01, out, capacity, n);
                     }));
  expect_within<dynContact>("dyn_contacts", as_int([&](dynContact* out, int capacity, int* n) {
                              return dyn_contacts(m, d, nullptr, 0.01, out, capacity, n);
                            }));
  expect_within<dynContactForce>("dyn_data_step_contacts", as_int([&](dynContactForce* out, int capacity, int* n) {
                                   return dyn_data_step_contacts(m, d, out, capacity, n);
                                 }));
  dynBroadPhase* boxes = nullptr;
  ASSERT_EQ(DYN_OK, dyn_broad_phase_new(8, 64, 0, &boxes));
  const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
  for (int k = 0, id; k < 8; ++k) ASSERT_EQ(DYN_OK, dyn_broad_phase_insert(boxes, low, high, &id));
  int id = 0;
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_broad_phase_insert(boxes, low, high, &id));  // the ninth of eight
  expect_within<std::array<int, 2>>("dyn_broad_phase_pairs",
                                    [&](std::array<int, 2>* out, std::int64_t capacity, std::int64_t* n) {
                                      return dyn_broad_phase_pairs(boxes, reinterpret_cast<int*>(out), capacity, n);
                                    });
  dyn_broad_phase_free(boxes);

  std::size_t size = 0;
  ASSERT_EQ(DYN_OK, dyn_model_save_memory(m, DYN_FORMAT_URDF, nullptr, nullptr, 0, &size));
  expect_whole("dyn_model_save_memory", size,
               [&](void* to, std::size_t n) { return dyn_model_save_memory(m, DYN_FORMAT_URDF, nullptr, to, n, &size); });
  ASSERT_EQ(DYN_OK, dyn_model_image(m, 0, nullptr, 0, &size));
  expect_whole("dyn_model_image", size, [&](void* to, std::size_t n) { return dyn_model_image(m, 0, to, n, &size); });
  expect_whole("dyn_data_save_state", dyn_model_state_size(m),
               [&](void* to, std::size_t n) { return dyn_data_save_state(m, d, to, n); });
  const std::size_t whole = dyn_data_size(m, DYN_PART_KINEMATICS);
  for (const std::size_t n : {std::size_t(0), std::size_t(1), whole - 1, whole}) {
    std::vector<unsigned char> memory(whole + 64, 0x5a);
    dynData* placed = nullptr;
    EXPECT_EQ(n < whole ? DYN_ERROR_SIZE : DYN_OK, dyn_data_init(m, DYN_PART_KINEMATICS, memory.data(), n, &placed));
    EXPECT_TRUE(std::all_of(memory.begin() + std::ptrdiff_t(whole), memory.end(), [](unsigned char c) { return c == 0x5a; }));
  }
}

}  // namespace
}  // namespace dyn_test
