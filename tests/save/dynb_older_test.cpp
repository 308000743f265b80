// version2.dynb: `dyn convert` of a build of version 2 wrote it from an MJCF file: a hinge with damping 0.5 drawn at 30 degrees,
// a motor, a key.
#include <fstream>
#include <sstream>

#include "load/dynb.hpp"
#include "model/load.hpp"
#include "model/model.hpp"
#include "save/same.hpp"

namespace dyn_test {
namespace {

std::string older_file() {
  std::ifstream in(DYN_MODELS_DIR "/../tests/save/version2.dynb", std::ios::binary);
  std::stringstream out;
  out << in.rdbuf();
  return out.str();
}

TEST(OlderDynb, IsReadWithTheStepsOfThatVersion) {
  const ModelPtr m = load_string(older_file(), {});
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

TEST(OlderDynb, IsWrittenAsThisVersion) {
  const std::string again = save_dynb(*load_string(older_file(), {}));
  EXPECT_EQ(dynb_version, reinterpret_cast<const DynbHeader*>(again.data())->version);
  EXPECT_TRUE(again == save_dynb(*load_string(again, {})));
}

TEST(OlderDynb, DamageIsAnErrorWhereverItIs) {
  const std::string good = older_file();
  ASSERT_GT(good.size(), sizeof(DynbHeader));
  for (std::size_t k = 0; k < good.size(); ++k) {
    std::string bad = good;
    bad[k] = char(bad[k] ^ 0x5a);
    EXPECT_THROW(load_string(bad, {}), Error) << k;
  }
}

}  // namespace
}  // namespace dyn_test
