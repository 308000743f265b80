// Tests dyn_model_save and dyn_model_save_memory at the boundary: arguments, the report, strict, what stays when nothing is
// written.
#include <filesystem>
#include <fstream>

#include "capi/support.hpp"

namespace dyn_test {
namespace {

namespace fs = std::filesystem;

struct Lines {
  std::vector<std::pair<dynReportLevel, std::string>> all;
  static void add(void* context, dynReportLevel level, const char* message) {
    static_cast<Lines*>(context)->all.emplace_back(level, message);
  }
  bool lost() const {
    for (const auto& l : all)
      if (l.first == DYN_REPORT_LEVEL_DROPPED) return true;
    return false;
  }
};

class Save : public testing::Test {
 protected:
  fs::path folder = fs::temp_directory_path() / ("dyn_save_" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  std::string file(const char* name) const { return (folder / name).string(); }
};

TEST_F(Save, EveryFormatIsReadAgain) {
  const Model m = all_types();
  for (const char* name : {"m.urdf", "m.dynb"}) {
    ASSERT_EQ(DYN_OK, dyn_model_save(m, file(name).c_str(), nullptr)) << dyn_last_error();
    dynLoadOptions options;
    dyn_load_options_init(&options);
    if (std::string_view(name) == "m.urdf") options.base = DYN_BASE_FIXED;
    dynModel* back = nullptr;
    ASSERT_EQ(DYN_OK, dyn_model_load(file(name).c_str(), &options, &back)) << dyn_last_error();
    EXPECT_DOUBLE_EQ(dyn_model_total_mass(m), dyn_model_total_mass(back));
    dyn_model_free(back);
  }
  EXPECT_EQ(2, std::distance(fs::directory_iterator(folder), fs::directory_iterator())) << "nothing else is left behind";
}

TEST_F(Save, ArgumentsAreChecked) {
  const Model m = chain(2);
  size_t size = 7;
  char byte;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_save(m, nullptr, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_save(m, file("m.sdf").c_str(), nullptr));
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), ".urdf"));
  EXPECT_EQ(DYN_ERROR_FILE, dyn_model_save(m, "/nowhere/m.urdf", nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_save_memory(m, DYN_FORMAT_URDF, nullptr, nullptr, 0, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_save_memory(m, DYN_FORMAT_URDF, nullptr, nullptr, 5, &size));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_save_memory(m, dynFormat(0), nullptr, nullptr, 0, &size));
  EXPECT_EQ(7u, size);
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_model_save_memory(m, DYN_FORMAT_URDF, nullptr, &byte, 1, &size));
  EXPECT_GT(size, 100u);
  std::vector<char> text(size);
  ASSERT_EQ(DYN_OK, dyn_model_save_memory(m, DYN_FORMAT_URDF, nullptr, text.data(), text.size(), &size));
  EXPECT_EQ(text.size(), size);
  EXPECT_EQ('<', text[0]);
}

TEST_F(Save, StrictWritesNothing) {
  const Model m = all_types();
  Lines lines, strict;
  ASSERT_EQ(DYN_OK, dyn_model_save(m, file("m.xml").c_str(), with<dynSaveOptions>({0, 0, Lines::add, &lines})))
      << dyn_last_error();
  ASSERT_TRUE(lines.lost());
  const auto before = fs::file_size(file("m.xml"));
  EXPECT_EQ(DYN_ERROR_STRICT, dyn_model_save(m, file("m.xml").c_str(), with<dynSaveOptions>({0, 1, Lines::add, &strict})));
  EXPECT_EQ(lines.all, strict.all);
  EXPECT_EQ(before, fs::file_size(file("m.xml")));
  EXPECT_EQ(DYN_ERROR_STRICT, dyn_model_save(m, file("other.xml").c_str(), with<dynSaveOptions>({0, 1, nullptr, nullptr})));
  EXPECT_FALSE(fs::exists(file("other.xml")));
}

}  // namespace
}  // namespace dyn_test
