// version2.dynb: `dyn convert` of a build of version 2 wrote it from an MJCF file: a hinge with damping 0.5 drawn at 30 degrees,
// a motor, a key.
// version3.dynb: a build of version 3 wrote it from an MJCF file: two hinges with the effects of joints, of which springs are
// switched off in steps, a motor, a key with velocities.
#include <fstream>
#include <sstream>

#include "load/dynb.hpp"
#include "model/load.hpp"
#include "model/model.hpp"
#include "save/same.hpp"

namespace dyn_test {
namespace {

std::string older_file(int version) {
  std::ifstream in(DYN_MODELS_DIR "/../tests/save/version" + std::to_string(version) + ".dynb", std::ios::binary);
  std::stringstream out;
  out << in.rdbuf();
  return out.str();
}

TEST(OlderDynb, Version2IsReadWithTheStepsOfThatVersion) {
  const ModelPtr m = load_string(older_file(2), {});
  EXPECT_STREQ("second", m->string(m->model_name));
  EXPECT_EQ(1, m->n.nq);
  EXPECT_EQ(0.5, m->damping()[0]);
  ASSERT_EQ(3, m->n.configurations);
  EXPECT_STREQ("qpos0", m->string(m->configuration_names()[m->simulation()->initial]));
  EXPECT_NEAR(0.5235987755982988, m->configurations()[m->simulation()->initial], 1e-15);
  EXPECT_EQ(1e-3, m->simulation()->dt);
  EXPECT_EQ(DYN_EFFECT_ALL & ~std::uint32_t(DYN_EFFECT_SLEEPING), m->simulation()->effects);
  for (int k = 0; k < 3; ++k)
    for (Index i = 0; i < m->n.nv + m->n.nu + m->n.na + 1; ++i) EXPECT_EQ(0, m->configuration_state(k)[i]);
}

TEST(OlderDynb, Version3IsReadWithItsEffectsAndStates) {
  const ModelPtr m = load_string(older_file(3), {});
  EXPECT_STREQ("third", m->string(m->model_name));
  ASSERT_EQ(2, m->n.nv);
  const double expected[][2] = {{0.01, 0}, {0.5, 0.25}, {0.1, 0}, {3, 0}};
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(expected[0][k], m->armature()[k]);
    EXPECT_EQ(expected[1][k], m->damping()[k]);
    EXPECT_EQ(expected[2][k], m->friction()[k]);
    EXPECT_EQ(expected[3][k], m->stiffness()[k]);
    EXPECT_EQ(expected[3][k], m->joints()[k + 1].stiffness);
  }
  EXPECT_NEAR(20 * M_PI / 180, m->spring_reference()[0], 1e-15);
  EXPECT_NEAR(20 * M_PI / 180, m->joints()[1].spring_reference, 1e-15);
  EXPECT_EQ(2e-3, m->simulation()->dt);
  EXPECT_EQ(DYN_INTEGRATOR_IMPLICIT_FAST, m->simulation()->integrator);
  EXPECT_EQ(DYN_EFFECT_ALL & ~std::uint32_t(DYN_EFFECT_SPRINGS | DYN_EFFECT_SLEEPING), m->simulation()->effects);
  ASSERT_EQ(2, m->n.configurations);
  EXPECT_STREQ("bent", m->string(m->configuration_names()[1]));
  EXPECT_EQ(1, m->configuration_state(1)[0]);
  EXPECT_EQ(2, m->configuration_state(1)[1]);
  EXPECT_EQ(0, m->simulation()->initial);
}

TEST(OlderDynb, IsWrittenAsThisVersion) {
  for (int version : {2, 3}) {
    const std::string again = save_dynb(*load_string(older_file(version), {}));
    EXPECT_EQ(dynb_version, reinterpret_cast<const DynbHeader*>(again.data())->version);
    EXPECT_TRUE(again == save_dynb(*load_string(again, {})));
  }
}

TEST(OlderDynb, DamageIsAnErrorWhereverItIs) {
  for (int version : {2, 3}) {
    const std::string good = older_file(version);
    ASSERT_GT(good.size(), sizeof(DynbHeader));
    for (std::size_t k = 0; k < good.size(); ++k) {
      std::string bad = good;
      bad[k] = char(bad[k] ^ 0x5a);
      EXPECT_THROW(load_string(bad, {}), Error) << k << " of version " << version;
    }
  }
}

}  // namespace
}  // namespace dyn_test
