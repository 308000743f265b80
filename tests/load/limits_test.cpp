// Short files that ask for much: each is refused before it is expanded, or loaded in a time and a memory that grow with its size.
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "common/mutants.hpp"
#include "load/urdf.hpp"

namespace dyn_test {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t memory = std::uint64_t(1) << 30;

const std::string ball = "<geom type=\"sphere\" size=\"0.1\"/>";

std::string repeated(int n, const std::string& s) {
  std::string out;
  for (int k = 0; k < n; ++k) out += s;
  return out;
}
std::string numbered(int n, const std::string& before, const std::string& after) {
  std::string out;
  for (int k = 0; k < n; ++k) out += before + std::to_string(k) + after;
  return out;
}
std::string mjcf(const std::string& world, const std::string& rest = "") {
  return "<mujoco><worldbody>" + world + "</worldbody>" + rest + "</mujoco>";
}
const std::string free_ball = "<body name=\"a\"><freejoint/>" + ball + "</body>";

void refuse(const std::string& name, const std::string& text, const std::vector<std::string>& words,
            dynStatus status = DYN_ERROR_LIMIT, const Options& options = Options()) {
  SCOPED_TRACE(name);
  in_child(memory, 10, [&] {
    const Loaded l = load(text, options);
    EXPECT_EQ(status, l.status) << dyn_status_name(l.status) << ": " << l.error.substr(0, 300);
    for (const std::string& w : words) EXPECT_NE(l.error.npos, l.error.find(w)) << "'" << w << "' is not in: " << l.error;
  });
}
void accept(const std::string& name, const std::string& text, const Options& options = Options()) {
  SCOPED_TRACE(name);
  in_child(memory, 30, [&] {
    const Loaded l = load(text, options);
    EXPECT_EQ(DYN_OK, l.status) << l.error.substr(0, 300);
  });
}

// Nine replicates of ten in one another: 10^9 bodies of 500 bytes.
TEST(LoadLimits, ReplicasInReplicas) {
  const auto nested = [](int depth, const std::string& inside) {
    return repeated(depth, "<replicate count=\"10\">") + inside + repeated(depth, "</replicate>");
  };
  refuse("bodies", mjcf(nested(9, "<body><freejoint/>" + ball + "</body>")), {"line 1: ", "copies", "max_bodies"});
  refuse("geoms", mjcf(nested(9, ball)), {"copies", "the limits are 200000 bodies and 200000 shapes"});
  refuse("nothing", mjcf(nested(9, "")), {"copies"});
  Options few;
  few.max_shapes = 2000;
  refuse("one", mjcf("<replicate count=\"3000\">" + ball + "</replicate>"), {"more than 2000 shapes, which is the limit"},
         DYN_ERROR_LIMIT, few);
  few.max_bodies = 5;
  refuse("few", mjcf(nested(1, "<body/>")), {"more than 5 bodies", "max_bodies"}, DYN_ERROR_LIMIT, few);
  accept("some", mjcf(nested(2, "<body>" + ball + "</body>")));
}

TEST(LoadLimits, CopiesThatMultiply) {
  // each part attaches the two after it
  std::string parts;
  for (int k = 0; k < 60; ++k) {
    const std::string next = std::to_string(k + 1);
    parts += "<frame name=\"f" + std::to_string(k) + "\"><attach frame=\"f" + next + "\" prefix=\"a\"/><attach frame=\"f" + next +
             "\" prefix=\"b\"/></frame>";
  }
  refuse("attach", mjcf(parts + "<frame name=\"f60\"/>"), {"which is the limit"});
  // a class of defaults that holds much is written into each element
  const std::string much(1000000, '1');
  refuse("defaults",
         "<mujoco><default><geom user=\"" + much + "\"/></default><worldbody>" + repeated(5000, ball) + "</worldbody></mujoco>",
         {"bytes of memory", "max_bytes"});
  refuse("classes",
         "<mujoco><default><geom user=\"" + much + "\"/>" + numbered(5000, "<default class=\"c", "\"/>") +
             "</default><worldbody/></mujoco>",
         {"bytes of memory", "max_bytes"});
  const std::string prefix(1000000, 'p');
  refuse("names", mjcf("<replicate count=\"5000\" sep=\"" + prefix + "\"><body name=\"b\"/></replicate>"), {"bytes of memory"});
}

TEST(LoadLimits, RowsOfConstraints) {
  refuse("connect", mjcf(free_ball, "<equality>" + repeated(5000, "<connect body1=\"a\" anchor=\"0 0 0\"/>") + "</equality>"),
         {"more than 6000 rows of constraints", "max_constraint_rows"});
  Options more;
  more.max_constraint_rows = 3;
  accept("one", mjcf(free_ball, "<equality><connect body1=\"a\" anchor=\"0 0 0\"/></equality>"), more);
  const std::string constraint = "<first link=\"b\"/></constraint>";
  refuse("urdf",
         robot(ab + joint("j", "revolute", "a", "b") + "<libdyn>" +
               numbered(3001, "<constraint type=\"connect\" name=\"c", "\">" + constraint) + "</libdyn>"),
         {"more than 6000 rows of constraints"});
}

TEST(LoadLimits, Keys) {
  const auto keys = [](int n) { return mjcf(free_ball, "<keyframe>" + repeated(n, "<key/>") + "</keyframe>"); };
  refuse("many", keys(200000), {"more than 10000 named configurations", "max_keys"});
  accept("some", keys(9999));
  Options more;
  more.max_keys = 100000;
  accept("more", keys(50000), more);
  // few keys of many joints
  refuse("large",
         mjcf("<replicate count=\"20000\">"
              "<body><freejoint/>" +
                  ball + "</body></replicate>",
              "<keyframe>" + repeated(9000, "<key/>") + "</keyframe>"),
         {"bytes of memory"});
}

std::string chain_of(int n, const std::string& type) {
  std::string text = "<robot name=\"r\">" + link("l0");
  for (int i = 1; i <= n; ++i)
    text += link("l" + std::to_string(i)) + joint("j" + std::to_string(i), type, "l" + std::to_string(i - 1),
                                                  "l" + std::to_string(i), type == "fixed" ? "" : "<axis xyz=\"0 1 0\"/>");
  return text + "</robot>";
}

TEST(LoadLimits, Links) {
  accept("fixed", chain_of(50000, "fixed"));
  accept("moving", chain_of(8000, "continuous"));
  Options few;
  few.max_bodies = 99;
  refuse("few", chain_of(100, "fixed"), {"more than 99 bodies"}, DYN_ERROR_LIMIT, few);
  few.max_bodies = 0, few.max_bytes = 100000;
  refuse("bytes", chain_of(100, "fixed"), {"more than 100000 bytes of memory"}, DYN_ERROR_LIMIT, few);
  few.max_bytes = 0, few.max_seconds = 1e-6;
  refuse("seconds", chain_of(1000, "fixed"), {"more than 1e-06 s of processor time"}, DYN_ERROR_LIMIT, few);
}

// Names are looked up in time that does not grow with the number of parts.
TEST(LoadLimits, ManyNames) {
  const int n = 20000;
  std::string world, actuators, sensors, excludes;
  for (int k = 0; k < n; ++k) {
    const std::string i = std::to_string(k);
    world += "<body name=\"b" + i + "\" pos=\"" + i + " 0 0\"><joint name=\"j" + i + "\"/>" + ball + "</body>";
    actuators += "<motor joint=\"j" + i + "\" name=\"m" + i + "\"/>";
    sensors += "<jointpos joint=\"j" + i + "\" name=\"s" + i + "\"/>";
    if (k > 0) excludes += "<exclude body1=\"b0\" body2=\"b" + i + "\"/>";
  }
  Options options;
  options.meshes = DYN_MESH_USE_NONE;
  accept("names",
         mjcf(world, "<actuator>" + actuators + "</actuator><sensor>" + sensors + "</sensor><contact>" + excludes + "</contact>"),
         options);
}

TEST(LoadLimits, FilesAreRegular) {
  std::string folder = (fs::temp_directory_path() / "dyn_limits_XXXXXX").string();
  ASSERT_NE(nullptr, mkdtemp(folder.data()));
  ASSERT_EQ(0, mkfifo((folder + "/pipe.xml").c_str(), 0600));
  ASSERT_EQ(0, mkfifo((folder + "/pipe.stl").c_str(), 0600));
  const auto written = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder + "/" + name) << text;
    return folder + "/" + name;
  };
  const auto refuse_file = [&](const std::string& path, const std::string& words, bool confined = false) {
    SCOPED_TRACE(path);
    in_child(memory, 10, [&] {
      alarm(10);  // a pipe that nobody writes would wait
      Options options;
      options.confined = confined;
      const Loaded l = load_path(path, options);
      EXPECT_EQ(DYN_ERROR_FILE, l.status) << l.error;
      EXPECT_NE(l.error.npos, l.error.find(words)) << l.error;
    });
  };
  for (const char* part : {"pipe.xml", "pipe.stl"}) {
    const std::string file = folder + "/" + part;
    refuse_file(written("include.xml", "<mujoco><include file=\"" + std::string(part) + "\"/></mujoco>"),
                file + ": this is a pipe, no regular file");
  }
  refuse_file(written("mesh.xml",
                      "<mujoco><asset><mesh name=\"m\" file=\"pipe.stl\"/></asset><worldbody><body><freejoint/><geom "
                      "type=\"mesh\" mesh=\"m\"/></body></worldbody></mujoco>"),
              "pipe.stl");
  refuse_file(written("field.xml",
                      "<mujoco><asset><hfield name=\"m\" file=\"pipe.stl\" size=\"1 1 1 1\"/></asset><worldbody><geom "
                      "type=\"hfield\" hfield=\"m\"/></worldbody></mujoco>"),
              "this is a pipe, no regular file");
  refuse_file(written("folder.xml", "<mujoco><include file=\".\"/></mujoco>"), "this is a directory");
  refuse_file(written("device.xml", "<mujoco><include file=\"/dev/zero\"/></mujoco>"), "this is a device, no regular file");
  refuse_file(folder + "/pipe.xml", "this is a pipe, no regular file", true);  // a robot file may be one, unless confined
  refuse_file("/dev/zero", "this is a device, no regular file");
  fs::remove_all(folder);
}

TEST(LoadLimits, OptionsAreChecked) {
  const auto refused = [](const auto& change, const std::string& name) {
    Options options;
    change(options);
    const Loaded l = load(robot(link("a")), options);
    EXPECT_EQ(DYN_ERROR_ARGUMENT, l.status) << name;
    EXPECT_NE(l.error.npos, l.error.find(name + " is no limit: give a positive number, or 0 for the default")) << l.error;
  };
  refused([](Options& o) { o.max_bodies = -1; }, "max_bodies");
  refused([](Options& o) { o.max_shapes = -1; }, "max_shapes");
  refused([](Options& o) { o.max_constraint_rows = -1; }, "max_constraint_rows");
  refused([](Options& o) { o.max_keys = -1; }, "max_keys");
  refused([](Options& o) { o.max_bytes = -1; }, "max_bytes");
  refused([](Options& o) { o.max_seconds = -1; }, "max_seconds");
  refused([](Options& o) { o.max_seconds = std::numeric_limits<double>::quiet_NaN(); }, "max_seconds");
}

}  // namespace
}  // namespace dyn_test
