// Tests what a model says of itself: names and near misses, ids, info structs and their sizes, arrays, permutations, errors.
#include <thread>

#include "capi/support.hpp"
#include "common/every.hpp"

namespace dyn_test {
namespace {

TEST(Errors, NamesOfStatuses) {
  for (int s = DYN_OK; s <= DYN_ERROR_CANCELLED; ++s) {
    const std::string name = dyn_status_name(dynStatus(s));
    EXPECT_EQ(0u, name.find(s == 0 ? "DYN_OK" : "DYN_ERROR_")) << s;
    EXPECT_NE("DYN_ERROR_UNKNOWN", name) << s;
    for (int t = 0; t < s; ++t) EXPECT_NE(name, dyn_status_name(dynStatus(t)));
  }
  for (int s : {22, 31}) EXPECT_STREQ("DYN_ERROR_UNKNOWN", dyn_status_name(dynStatus(s)));
  EXPECT_STREQ("1.0.0", dyn_version());
  EXPECT_TRUE(says({"libdyn 1.0.0", "compiler"}, dyn_build_info()));
}

TEST(Errors, OnePerThread) {
  EXPECT_EQ(-1, dyn_model_nq(nullptr));
  const std::string mine = dyn_last_error();
  std::string before = "?", after;
  std::thread([&] {
    before = dyn_last_error();
    dyn_field_id("nothing");
    after = dyn_last_error();
  }).join();
  EXPECT_EQ("", before);
  EXPECT_TRUE(says({"nothing"}, after));
  EXPECT_EQ(mine, dyn_last_error());
  // success leaves it
  const Model m = chain(1);
  EXPECT_EQ(1, dyn_model_nq(m));
  EXPECT_EQ(mine, dyn_last_error());
}

// A message is one line of bounded length whatever the names in it.
TEST(Errors, LongNames) {
  const Model m = chain(2);
  const std::string name(100000, 'x');
  EXPECT_EQ(-1, dyn_model_joint_id(m, name.c_str()));
  EXPECT_LT(std::strlen(dyn_last_error()), 1024u);
  EXPECT_EQ(-1, dyn_field_id(name.c_str()));
  EXPECT_LT(std::strlen(dyn_last_error()), 1024u);
  dynModel* none = nullptr;
  EXPECT_EQ(DYN_ERROR_FILE, dyn_model_load(name.c_str(), nullptr, &none));
  EXPECT_LT(std::strlen(dyn_last_error()), 1024u);
  Builder b;
  const Spec spec(name.c_str(), DYN_JOINT_TYPE_REVOLUTE, name.c_str());
  EXPECT_EQ(DYN_ERROR_NAME, dyn_builder_add_joint(b, &spec));
  EXPECT_LT(std::strlen(dyn_last_error()), 1024u);
}

TEST(Names, UnknownOnesListNearMisses) {
  const Model m = all_types();
  EXPECT_EQ(-1, dyn_model_joint_id(m, "Hinge"));
  EXPECT_TRUE(says({"no joint 'Hinge'", "did you mean 'hinge'?"}));
  EXPECT_EQ(-1, dyn_model_joint_id(m, "sli"));
  EXPECT_TRUE(says({"no joint 'sli'", "'slider'"}));
  EXPECT_EQ(-1, dyn_model_frame_id(m, "the tool frame"));
  EXPECT_TRUE(says({"no frame 'the tool frame'", "'tool'"}));
  EXPECT_EQ(-1, dyn_model_joint_id(m, "quite different"));
  EXPECT_TRUE(says({"no joint 'quite different'"}));
  EXPECT_FALSE(says({"did you mean"}));
  EXPECT_EQ(-1, dyn_model_joint_id(m, ""));
  EXPECT_EQ(-1, dyn_model_frame_id(m, ""));
  for (const char* none : {static_cast<const char*>(nullptr)}) {
    EXPECT_EQ(-1, dyn_model_joint_id(m, none));
    EXPECT_TRUE(says({"dyn_model_joint_id", "name is NULL"}));
    EXPECT_EQ(-1, dyn_model_frame_id(m, none));
    EXPECT_EQ(-1, dyn_model_frame_id_of_type(m, none, DYN_FRAME_TYPE_BODY));
    EXPECT_EQ(-1, dyn_field_id(none));
  }
  // a joint is not a body, a fixed joint no joint
  EXPECT_EQ(-1, dyn_model_joint_id(m, "trunk"));
  EXPECT_EQ(-1, dyn_model_joint_id(m, "weld"));
  EXPECT_GE(dyn_model_frame_id(m, "weld"), 0);
}

TEST(Names, IdsRoundTrip) {
  for (const Model& m : {all_types(), robot("panda"), robot("humanoid", DYN_BASE_FLOATING)}) {
    for (int j = 0; j < m.njoints(); ++j) EXPECT_EQ(j, dyn_model_joint_id(m, dyn_model_joint_name(m, j)));
    for (int f = 0; f < m.nframes(); ++f) {
      dynFrameInfo info{};
      info.struct_size = sizeof info;
      ASSERT_EQ(DYN_OK, dyn_model_frame_info(m, f, &info));
      EXPECT_STREQ(dyn_model_frame_name(m, f), info.name);
      EXPECT_EQ(f, dyn_model_frame_id_of_type(m, info.name, info.type)) << info.name;
    }
  }
}

TEST(Names, FrameTypes) {
  Builder b;
  b.joint(Spec("arm", DYN_JOINT_TYPE_REVOLUTE)).body("arm", "arm");  // a link and a joint of one name
  const Model m = b.finish();
  const int joint = dyn_model_frame_id_of_type(m, "arm", DYN_FRAME_TYPE_JOINT),
            body = dyn_model_frame_id_of_type(m, "arm", DYN_FRAME_TYPE_BODY);
  EXPECT_TRUE(joint > 0 && body > 0 && joint != body);
  EXPECT_EQ(joint, dyn_model_frame_id(m, "arm"));
  EXPECT_EQ(-1, dyn_model_frame_id_of_type(m, "arm", DYN_FRAME_TYPE_SENSOR));
  EXPECT_TRUE(says({"dyn_model_frame_id_of_type", "arm", "no SENSOR frame", "dyn_model_frame_id"}));
  for (int bad : {0, 3, -1, 32}) {
    dynFrameType type;
    std::memcpy(&type, &bad, sizeof type);
    EXPECT_EQ(-1, dyn_model_frame_id_of_type(m, "arm", type)) << bad;
    EXPECT_TRUE(says({"dyn_model_frame_id_of_type", std::to_string(bad), "dynFrameType"}));
  }
}

template <class Info>
void check_info(dynStatus (*call)(const dynModel*, int, Info*), const dynModel* m, int count, const char* function) {
  Info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, call(m, 0, nullptr)) << function;
  EXPECT_TRUE(says({function, "NULL"}));
  for (std::uint32_t size : {0u, 4u, std::uint32_t(sizeof info) - 1}) {
    Info small, before;
    std::memset(static_cast<void*>(&small), 0x3c, sizeof small), std::memset(static_cast<void*>(&before), 0x3c, sizeof before);
    small.struct_size = before.struct_size = size;
    EXPECT_EQ(DYN_ERROR_SIZE, call(m, 0, &small)) << function;
    EXPECT_TRUE(says({function, "struct_size is " + std::to_string(size), "sizeof"}));
    EXPECT_EQ(0, std::memcmp(&small, &before, sizeof small)) << function;
  }
  for (int index : {-1, count, count + 1000, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    Info kept, before;
    std::memset(static_cast<void*>(&kept), 0x3c, sizeof kept), std::memset(static_cast<void*>(&before), 0x3c, sizeof before);
    kept.struct_size = before.struct_size = sizeof kept;
    EXPECT_EQ(DYN_ERROR_ARGUMENT, call(m, index, &kept)) << function;
    EXPECT_TRUE(says({function, std::to_string(index), "does not exist"}));
    EXPECT_EQ(0, std::memcmp(&kept, &before, sizeof kept)) << function;
  }
  EXPECT_EQ(count ? DYN_OK : DYN_ERROR_ARGUMENT, call(m, count - 1, &info)) << function;
  EXPECT_EQ(sizeof info, info.struct_size);
  // a larger struct of a later version is fine
  struct {
    Info info;
    double more[4] = {1, 2, 3, 4};
  } later;
  later.info = info, later.info.struct_size = sizeof later;
  if (count) {
    EXPECT_EQ(DYN_OK, call(m, 0, &later.info));
    EXPECT_TRUE(later.info.struct_size == sizeof later && later.more[0] == 0 && later.more[3] == 0);
  }
}

TEST(Info, SizesAndIndices) {
  const Model m = robot("panda");
  check_info(dyn_model_joint_info, m, m.njoints(), "dyn_model_joint_info");
  check_info(dyn_model_frame_info, m, m.nframes(), "dyn_model_frame_info");
  check_info(dyn_model_shape_info, m, dyn_model_nshapes(m), "dyn_model_shape_info");
  check_info(dyn_model_report_entry, m, dyn_model_report_count(m), "dyn_model_report_entry");
  for (int bad : {-1, m.njoints(), 1 << 30}) EXPECT_EQ(nullptr, dyn_model_joint_name(m, bad));
  EXPECT_TRUE(says({"dyn_model_joint_name", "does not exist"}));
  for (int bad : {-1, m.nframes(), 1 << 30}) EXPECT_EQ(nullptr, dyn_model_frame_name(m, bad));
  for (int bad : {-1, dyn_model_nconfigurations(m), 1 << 30}) EXPECT_EQ(nullptr, dyn_model_configuration_name(m, bad));
}

TEST(Info, Arrays) {
  const Model m = all_types();
  const auto all = every<dynModelArray>("dynModelArray");
  for (const dynModelArray which : all) EXPECT_NE(nullptr, dyn_model_array(m, which)) << which;
  for (int bad : {-1, int(all.size()), 1000}) {
    dynModelArray which;
    std::memcpy(&which, &bad, sizeof which);
    EXPECT_EQ(nullptr, dyn_model_array(m, which));
    EXPECT_TRUE(says({"dyn_model_array", std::to_string(bad)}));
  }
}

TEST(NamedConfigurations, NamesAndOutputs) {
  Builder b;
  b.joint(Spec("j", DYN_JOINT_TYPE_REVOLUTE)).body("l", "j");
  const double q[1] = {0.5};
  ASSERT_EQ(DYN_OK, dyn_builder_add_configuration(b, "Home", q, 1));
  const Model m = b.finish();
  double out[1] = {7};
  EXPECT_EQ(2, dyn_model_nconfigurations(m));
  EXPECT_STREQ("neutral", dyn_model_configuration_name(m, 0));
  EXPECT_STREQ("Home", dyn_model_configuration_name(m, 1));
  EXPECT_EQ(DYN_ERROR_NAME, dyn_model_configuration(m, "home", out));
  EXPECT_TRUE(says({"no configuration 'home'", "did you mean 'Home'?"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_configuration(m, nullptr, out));
  EXPECT_TRUE(says({"dyn_model_configuration", "name is NULL"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_configuration(m, "Home", nullptr));
  EXPECT_TRUE(says({"dyn_model_configuration", "q is NULL"}));
  EXPECT_EQ(7, out[0]);
  EXPECT_EQ(DYN_OK, dyn_model_configuration(m, "Home", out));
  EXPECT_EQ(0.5, out[0]);
}

TEST(Permutation, Refusals) {
  const Model m = all_types();
  std::int32_t iq[3] = {-7, -7, -7}, iv[3] = {-7, -7, -7};
  auto refused = [&](std::vector<const char*> names, dynStatus status, const std::vector<std::string>& fragments) {
    EXPECT_EQ(status, dyn_model_q_permutation(m, names.data(), names.size(), iq, iv));
    EXPECT_TRUE(says(fragments));
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(iq[k] == -7 && iv[k] == -7);
  };
  refused({"hinge", "ball", "hinge"}, DYN_ERROR_NAME, {"'hinge'", "twice"});
  refused({"hinge", "Ball"}, DYN_ERROR_NAME, {"no joint 'Ball'", "did you mean 'ball'?"});
  refused({"hinge", nullptr}, DYN_ERROR_ARGUMENT, {"dyn_model_q_permutation", "names[1] is NULL"});
  refused({"universe"}, DYN_ERROR_NAME, {"universe", "no coordinates"});
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_q_permutation(m, nullptr, 2, iq, iv));
  EXPECT_EQ(DYN_OK, dyn_model_q_permutation(m, nullptr, 0, iq, iv));
  const char* names[] = {"dial", "free", "hinge"};
  EXPECT_EQ(DYN_OK, dyn_model_q_permutation(m, names, 3, nullptr, iv));
  EXPECT_EQ(DYN_OK, dyn_model_q_permutation(m, names, 3, iq, nullptr));
  for (int k = 0; k < 3; ++k) {
    dynJointInfo info{};
    info.struct_size = sizeof info;
    ASSERT_EQ(DYN_OK, dyn_model_joint_info(m, dyn_model_joint_id(m, names[k]), &info));
    EXPECT_TRUE(iq[k] == info.idx_q && iv[k] == info.idx_v) << names[k];
  }
  // more joints than one pass of the search for repetitions holds
  const Model large = chain(5000);
  std::vector<std::string> text;
  for (int k = 0; k < 5000; ++k) text.push_back("j" + std::to_string(4999 - k));
  std::vector<const char*> all;
  for (const auto& t : text) all.push_back(t.c_str());
  std::vector<std::int32_t> at(5001, -7);
  EXPECT_EQ(DYN_OK, dyn_model_q_permutation(large, all.data(), all.size(), at.data(), nullptr));
  for (std::int32_t k = 0; k < 5000; ++k) ASSERT_EQ(4999 - k, at[std::size_t(k)]);
  all.push_back(text[2].c_str());
  EXPECT_EQ(DYN_ERROR_NAME, dyn_model_q_permutation(large, all.data(), all.size(), at.data(), nullptr));
  EXPECT_TRUE(says({"'j4997'", "twice"}));
}

TEST(Loading, Arguments) {
  dynModel* m = nullptr;
  const std::string path = std::string(DYN_MODELS_DIR) + "/robots/panda.urdf";
  auto refused = [&](dynStatus expected, dynStatus s, const std::vector<std::string>& fragments) {
    EXPECT_EQ(expected, s);
    EXPECT_TRUE(says(fragments));
    EXPECT_EQ(nullptr, m);
  };
  dynLoadOptions o;
  dyn_load_options_init(nullptr);
  dyn_load_options_init(&o);
  o.base = DYN_BASE_FIXED;
  refused(DYN_ERROR_ARGUMENT, dyn_model_load(nullptr, &o, &m), {"dyn_model_load", "path is NULL"});
  refused(DYN_ERROR_ARGUMENT, dyn_model_load(path.c_str(), &o, nullptr), {"dyn_model_load", "model is NULL"});
  refused(DYN_ERROR_ARGUMENT, dyn_model_load_string(nullptr, &o, &m), {"dyn_model_load_string", "text is NULL"});
  refused(DYN_ERROR_ARGUMENT, dyn_model_load_string("<robot/>", &o, nullptr), {"dyn_model_load_string", "model is NULL"});
  refused(DYN_ERROR_FILE, dyn_model_load("/nowhere/robot.urdf", &o, &m), {"/nowhere/robot.urdf"});
  for (std::uint32_t size : {0u, 8u, std::uint32_t(sizeof o) - 1}) {
    dynLoadOptions small = o;
    small.struct_size = size;
    refused(DYN_ERROR_SIZE, dyn_model_load(path.c_str(), &small, &m), {"struct_size", "dyn_load_options_init"});
  }
  dynLoadOptions bad = o;
  for (int base : {-1, 3, 1000}) {
    std::memcpy(&bad.base, &base, sizeof base);
    refused(DYN_ERROR_ARGUMENT, dyn_model_load(path.c_str(), &bad, &m), {"base is " + std::to_string(base), "_FIXED"});
  }
  bad = o, bad.package_dirs_count = 1;
  refused(DYN_ERROR_ARGUMENT, dyn_model_load(path.c_str(), &bad, &m), {"package_dirs is NULL"});
  const char* dirs[] = {nullptr};
  bad.package_dirs = dirs;
  refused(DYN_ERROR_ARGUMENT, dyn_model_load(path.c_str(), &bad, &m), {"package_dirs[0] is NULL"});
  for (double g : {nan, inf, -inf}) {
    bad = o, bad.gravity[1] = g;
    refused(DYN_ERROR_NONFINITE, dyn_model_load(path.c_str(), &bad, &m), {"gravity[1]", "finite"});
  }
}

TEST(FieldInfo, Refusals) {
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_field_info(0, nullptr));
  for (dynField f : {-1, dyn_field_count(), 1 << 30}) {
    dynFieldInfo info{};
    info.struct_size = sizeof info;
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_field_info(f, &info));
    EXPECT_TRUE(says({"dyn_field_info", "field " + std::to_string(f)}));
    EXPECT_EQ(nullptr, info.name);
  }
  for (std::uint32_t size : {0u, std::uint32_t(sizeof(dynFieldInfo)) - 1}) {
    dynFieldInfo info{};
    info.struct_size = size;
    EXPECT_EQ(DYN_ERROR_SIZE, dyn_field_info(0, &info));
    EXPECT_TRUE(says({"struct_size", "sizeof(dynFieldInfo)"}));
    EXPECT_EQ(nullptr, info.name);
  }
  EXPECT_EQ(-1, dyn_field_id("Q"));
  EXPECT_TRUE(says({"no field 'Q'", "dyn_field_info"}));
}

}  // namespace
}  // namespace dyn_test
