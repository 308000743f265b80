// Thousands of damaged robot files a format (DYN_MUTANTS), each loaded in a process with 1 GB of memory: an error with a
// sentence, or a model.
#include <chrono>
#include <filesystem>
#include <fstream>

#include "common/mutants.hpp"
#include "load/urdf.hpp"

namespace dyn_test {
namespace {

const std::string seed_scene = R"(<mujoco model="m">
<compiler angle="radian"/><option timestep="0.001" integrator="implicitfast"><flag contact="enable"/></option>
<default><geom density="500"/><default class="c"><joint damping="0.1" range="-1 1"/></default></default>
<asset><mesh name="tetra" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><hfield name="h" nrow="2" ncol="2" elevation="0 1 1 0" size="1 1 1 1"/>
<material name="red" rgba="1 0 0 1"/></asset>
<worldbody><geom type="plane" size="1 1 1"/><geom type="hfield" hfield="h"/><site name="s0"/>
<replicate count="3" offset="1 0 0" sep="_"><body name="r"><freejoint name="f"/>
<geom name="g" type="capsule" fromto="0 0 0 0 0 1" size="0.1"/></body></replicate>
<body name="a" pos="0 0 1" childclass="c"><joint name="j" axis="0 1 0"/>
<geom type="box" size="0.1 0.2 0.3" material="red"/><site name="s1" pos="0 0 1"/>
<frame euler="0 0 1"><body name="b" pos="1 0 0"><joint name="k" type="slide" stiffness="3"/>
<geom type="mesh" mesh="tetra" mass="2"/><site name="s2"/></body></frame></body>
</worldbody>
<contact><exclude body1="a" body2="b"/></contact>
<tendon><spatial name="t" stiffness="5"><site site="s0"/><site site="s1"/>
<pulley divisor="2"/><site site="s1"/><site site="s2"/></spatial>
<fixed name="u"><joint joint="j" coef="1"/><joint joint="k" coef="-2"/></fixed></tendon>
<equality><connect name="e" body1="a" body2="b" anchor="0 0 1"/><weld body1="r_0" relpose="0 0 0 1 0 0 0"/>
<joint joint1="j" joint2="k" polycoef="0 1 2 3 4"/></equality>
<actuator><motor joint="j" gear="2"/><position joint="k" kp="3" dampratio="1"/><muscle tendon="t"/></actuator>
<sensor><jointpos joint="j"/><touch site="s1"/><framepos objtype="body" objname="a"/></sensor>
<keyframe><key name="home" qpos="0 0 0 1 0 0 0 0 0 0 1 0 0 0 0 0 0 1 0 0 0 0.1 0.2" qvel="1 2 3"/></keyframe></mujoco>)";

std::string seed_robot() {
  return robot(link("a", solid + "<collision><geometry><box size=\"1 2 3\"/></geometry></collision><visual><geometry><cylinder "
                                 "radius=\"1\" length=\"2\"/>"
                                 "</geometry><material name=\"m\"><color rgba=\"1 0 0 1\"/></material></visual>") +
               link("b") + link("c") + link("d") +
               joint("j", "revolute", "a", "b",
                     "<origin xyz=\"1 2 3\" rpy=\"0.1 0.2 0.3\"/><axis xyz=\"0 1 0\"/>" + limit +
                         "<dynamics damping=\"0.1\" friction=\"0.2\"/>") +
               joint("k", "prismatic", "b", "c", limit + "<mimic joint=\"j\" multiplier=\"2\" offset=\"1\"/>") +
               joint("l", "fixed", "c", "d", "") +
               "<libdyn><constraint name=\"pin\" type=\"connect\"><first link=\"d\"><origin xyz=\"1 0 "
               "0\"/></first></constraint></libdyn>");
}

const std::string seed_states =
    "<robot name=\"r\"><group name=\"g\"><joint name=\"j\"/></group><group_state name=\"home\" group=\"g\"><joint name=\"j\" "
    "value=\"0.5\"/>"
    "</group_state><disable_collisions link1=\"a\" link2=\"b\" reason=\"Adjacent\"/><virtual_joint name=\"v\" type=\"fixed\" "
    "parent_frame=\"w\" child_link=\"a\"/><disable_default_collisions link=\"c\"/></robot>";

void load_mutants(const std::string& name, const std::string& good, bool srdf = false) {
  const std::uint64_t count = mutant_count(300), per_process = 500;
  for (std::uint64_t first = 1; first <= count; first += per_process)
    in_child(std::uint64_t(1) << 30, 300, [&] {
      std::string folder = (std::filesystem::temp_directory_path() / "dyn_mutants_XXXXXX").string();
      ASSERT_NE(nullptr, mkdtemp(folder.data()));
      const std::string path = folder + "/" + name, robot_path = folder + "/robot.urdf";
      std::ofstream(robot_path) << seed_robot();
      for (std::uint64_t seed = first; seed < first + per_process && seed <= count; ++seed) {
        std::ofstream(path, std::ios::binary) << mutant(good, seed);
        Options options;
        options.confined = 1;
        if (srdf) options.srdf = path.c_str();
        if (name.ends_with(".dynb")) options.base = DYN_BASE_UNSPECIFIED;
        const auto begin = std::chrono::steady_clock::now();
        const Loaded l = load_path(srdf ? robot_path : path, options);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        EXPECT_LT(seconds, 10) << name << ", seed " << seed;
        EXPECT_TRUE(l.status != DYN_ERROR_INTERNAL && l.status != DYN_ERROR_MEMORY)
            << name << ", seed " << seed << ": " << l.error;
        EXPECT_TRUE(l.status == DYN_OK || !l.error.empty()) << name << ", seed " << seed;
      }
      std::filesystem::remove_all(folder);
    });
}

TEST(LoadMutants, Urdf) { good(seed_robot()), load_mutants("m.urdf", seed_robot()); }
TEST(LoadMutants, Mjcf) { good(seed_scene), load_mutants("m.xml", seed_scene); }
TEST(LoadMutants, Srdf) { load_mutants("m.srdf", seed_states, true); }
TEST(LoadMutants, Dynb) {
  const Loaded l = good(seed_scene);
  std::size_t size = 0;
  dyn_model_save_memory(l.model.get(), DYN_FORMAT_DYNB, nullptr, nullptr, 0, &size);
  std::string bytes(size, '\0');
  ASSERT_EQ(DYN_OK, dyn_model_save_memory(l.model.get(), DYN_FORMAT_DYNB, nullptr, bytes.data(), size, &size))
      << dyn_last_error();
  load_mutants("m.dynb", bytes);
}

}  // namespace
}  // namespace dyn_test
