// Hostile files: each is refused with a line and a reason, or read for what it says.
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "load/urdf.hpp"

namespace dyn_test {
namespace {

std::string with_mass(const std::string& value) {
  return robot("<link name=\"a\"><inertial>\n<mass value=\"" + value +
               "\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>\n");
}
std::string pendulum(const std::string& name = "j", const std::string& parent = "a") {
  return robot(link(parent) + link("b") + joint(name, "revolute", parent, "b"));
}
std::string wide(const std::string& text, int bytes, bool little) {
  std::string out;
  for (const char c : text) {
    std::string unit(std::size_t(bytes), '\0');
    unit[little ? 0 : std::size_t(bytes) - 1] = c;
    out += unit;
  }
  return out;
}

std::string times(int n, const std::string& text) {
  std::string out;
  for (int i = 0; i < n; ++i) out += text;
  return out;
}

struct Case {
  const char* name;
  std::string text;
  dynStatus status;
  std::vector<std::string> fragments;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

const std::string zero(1, '\0');

const Case refused[] = {
    // characters at which parsers truncate a text, or which they drop
    {"ZeroReference", with_mass("1&#0;5"), DYN_ERROR_PARSE, {":3: ", "'&#0;'", "not a character of XML"}},
    {"HexZeroReference", with_mass("1&#x0;5"), DYN_ERROR_PARSE, {":3: ", "'&#x0;'"}},
    {"EmptyReference", with_mass("1&#;5"), DYN_ERROR_PARSE, {":3: ", "'&#;'"}},
    {"ReferenceBeyondUnicode", robot("<link name=\"&#x110000;\"/>"), DYN_ERROR_PARSE, {":2: ", "&#x110000;"}},
    {"ReferenceWraps", with_mass("1&#4294967344;5"), DYN_ERROR_PARSE, {":3: ", "&#4294967344;"}},
    {"SurrogateReference", robot("<link name=\"&#xD800;\"/>"), DYN_ERROR_PARSE, {":2: ", "&#xD800;"}},
    {"UnclosedReference", with_mass("1&#48"), DYN_ERROR_PARSE, {":3: ", "&#48"}},
    {"ReferenceInText", robot(link("a") + "<gazebo>\n&#1;</gazebo>"), DYN_ERROR_PARSE, {":4: ", "&#1;"}},
    {"ZeroByteEarly", "<robot name=\"r\">\n<link name=\"a" + zero + "\"/></robot>", DYN_ERROR_PARSE, {":2: ", "zero byte"}},
    {"Overlong", robot("<link name=\"\xC0\xAE\"/>"), DYN_ERROR_NAME, {":2: ", "link name", "UTF-8"}},
    {"Latin1Declared",
     "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n" + robot("<link name=\"b\xE4r\"/>"),
     DYN_ERROR_NAME,
     {":3: ", "'b?r'", "save the file as UTF-8"}},
    {"Utf16", "\xFF\xFE" + wide(pendulum(), 2, true), DYN_ERROR_PARSE, {"UTF-16", "UTF-8"}},
    {"Utf16WithoutMark", wide(pendulum(), 2, false), DYN_ERROR_PARSE, {"UTF-16"}},
    {"Utf32", "\xFF\xFE" + zero + zero + wide(pendulum(), 4, true), DYN_ERROR_PARSE, {"UTF-32"}},
    {"ControlNames", robot(link("a\x1B[31m")), DYN_ERROR_NAME, {":2: ", "'a [31m'", "control character"}},

    // elements
    {"NeverClosed", "<robot name=\"r\">\n<link name=\"a\"/>\n", DYN_ERROR_PARSE, {":1: ", "<robot> is never closed"}},
    {"ClosesNothing", robot(link("a")) + "</robot>", DYN_ERROR_PARSE, {":4: ", "</robot> closes nothing"}},
    {"Crossing",
     "<robot name=\"r\">\n<link name=\"a\">\n</robot></link>",
     DYN_ERROR_PARSE,
     {":3: ", "</robot> where <link> of line 2 is still open"}},
    {"CommentInATag", robot("<link <!-- x --> name=\"a\"/>"), DYN_ERROR_PARSE, {":2: ", "never closed"}},
    {"TagInATag", robot("<link name=\"a\"\n<link name=\"b\"/>"), DYN_ERROR_PARSE, {":2: ", "never closed"}},
    {"BlankBeforeTheName", robot("< link name=\"a\"/>"), DYN_ERROR_PARSE, {":2: ", "malformed element"}},
    {"AttributeTwice",
     robot(link("a") + link("b") + joint("j", "revolute", "a", "b", "<limit lower=\"-1\" upper=\"1\" lower=\"-2\"/>")),
     DYN_ERROR_PARSE,
     {":4: ", "repeated attribute"}},
    {"RootInCapitals", "<Robot name=\"r\"><Link name=\"a\"/></Robot>", DYN_ERROR_PARSE, {":1: ", "<Robot>", "<robot>"}},
    {"MillionOpen", "<robot name=\"r\">\n" + times(1000000, "<g>"), DYN_ERROR_LIMIT, {":2: ", "nested"}},

    // numbers
    {"TooLarge", with_mass("1e400"), DYN_ERROR_PARSE, {":3: ", "'1e400'", "too large"}},
    {"NanWithAWord", with_mass("nan(0x1)"), DYN_ERROR_PARSE, {":3: ", "not finite"}},
    {"HexFloat", with_mass("0x1.8p3"), DYN_ERROR_PARSE, {":3: ", "'0x1.8p3' is not a number"}},
    {"FortranExponent", with_mass("1d0"), DYN_ERROR_PARSE, {":3: ", "'1d0'"}},
    {"Underscore", with_mass("1_000"), DYN_ERROR_PARSE, {":3: ", "'1_000'"}},
    {"FullWidthDigit", with_mass("\xEF\xBC\x91"), DYN_ERROR_PARSE, {":3: ", "not a number"}},
    {"MinusSign",
     with_mass("\xE2\x88\x92"
               "1"),
     DYN_ERROR_PARSE,
     {":3: ", "not a number"}},
    {"NoBreakSpace", with_mass("1\xC2\xA0"), DYN_ERROR_PARSE, {":3: ", "not a number"}},
    {"PointAlone", with_mass("."), DYN_ERROR_PARSE, {":3: ", "'.'"}},
    {"LongNumber", with_mass(std::string(400, '9')), DYN_ERROR_PARSE, {":3: ", "...", "too large"}},

    // mechanics
    {"HugeRatio",
     robot(link("a") + link("b") + link("c") + joint("j", "revolute", "a", "b") +
           joint("k", "revolute", "b", "c", "<axis xyz=\"0 0 1\"/>" + limit + "<mimic joint=\"j\" multiplier=\"1e200\"/>")),
     DYN_ERROR_INVALID,
     {"joint 'j'", "overflows", "mimic ratios"}},
    {"FarCentre",
     robot(link("a") + joint("j", "revolute", "a", "b") + link("b", "<inertial><origin xyz=\"1e200 0 0\"/>" + solid.substr(10))),
     DYN_ERROR_INVALID,
     {"joint 'j'", "'b'", "overflows"}},
    {"ThreeMimicInACircle",
     robot(link("a") + link("b") + link("c") + link("d") + joint("j", "revolute", "a", "b", limit + "<mimic joint=\"l\"/>") +
           joint("k", "revolute", "b", "c", limit + "<mimic joint=\"j\"/>") +
           joint("l", "revolute", "c", "d", limit + "<mimic joint=\"k\"/>")),
     DYN_ERROR_INVALID,
     {":6: ", "cycle", "'j' -> 'l' -> 'k' -> 'j'"}},
};

class Hostile : public testing::TestWithParam<Case> {};
TEST_P(Hostile, IsRefusedWithReason) {
  const Case& c = GetParam();
  const std::string file =
      testing::TempDir() + "dyn_hostile_" + c.name + "_" + std::to_string(getpid());  // zero bytes would end a text in memory
  std::ofstream(file, std::ios::binary) << c.text;
  const Loaded l = load_path(file);
  std::filesystem::remove(file);
  EXPECT_EQ(c.status, l.status) << dyn_status_name(l.status) << ": " << l.error;
  for (const std::string& fragment : c.fragments)
    EXPECT_NE(std::string::npos, l.error.find(fragment)) << "'" << fragment << "' is not in: " << l.error;
  for (const char e : l.error) EXPECT_GE(static_cast<unsigned char>(e), 0x20) << l.error;
}
INSTANTIATE_TEST_SUITE_P(Load, Hostile, testing::ValuesIn(refused),
                         [](const auto& info) { return std::string(info.param.name); });

// Unusual but valid files are read correctly.
TEST(Odd, Numbers) {
  const std::pair<std::string, double> rows[] = {{"+1", 1},
                                                 {" 1 ", 1},
                                                 {"\t1\n", 1},
                                                 {"007", 7},
                                                 {"&#49;", 1},
                                                 {"&#x31;", 1},
                                                 {"1e-400", 0},
                                                 {"-0", 0},
                                                 {"0." + std::string(5000, '0') + "1", 0},
                                                 {std::string(400, '9') + "e-400", 1},
                                                 {"1." + std::string(100000, '3'), 4.0 / 3},
                                                 {"4.9e-324", 4.9e-324},
                                                 {"1.7976931348623157e308", 1.7976931348623157e308}};
  for (const auto& [text, value] : rows) EXPECT_EQ(value, frame(good(with_mass(text)), "a").mass) << text.substr(0, 20);
}

TEST(Odd, Encodings) {
  const std::string text = pendulum();
  std::string crlf, cr;
  for (const char c : text) crlf += c == '\n' ? "\r\n" : std::string(1, c), cr += c == '\n' ? '\r' : c;
  for (const std::string& odd : {"\xEF\xBB\xBF" + text, crlf, cr, "<!-- \xE4 &#0; <b> -->" + text,
                                 "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>" + text, text + "<!-- </robot> -->",
                                 "\xEF\xBB\xBF\n \t<?xml version=\"1.0\"?>" + text}) {
    const Loaded l = good(odd);
    EXPECT_EQ(1, dyn_model_nv(l.model.get()));
  }
  const Loaded l = load("<robot name=\"r\">\r\n\r\n\r\n<link/>\r\n</robot>");
  EXPECT_NE(std::string::npos, l.error.find("line 4: ")) << l.error;
}

TEST(Odd, Names) {
  for (const std::string name : {"a b", " a", "a'b", "a/b", "a\\b", "%s%n%d", "$(rm)", "..", "--fixed", "a,b", "[a]", "NULL",
                                 "Universe", "neutral", "\xF0\x9F\xA4\x96"}) {
    const Loaded l = good(pendulum(name, "the " + name));
    EXPECT_EQ(1, dyn_model_joint_id(l.model.get(), name.c_str())) << name;
    EXPECT_GT(dyn_model_frame_id(l.model.get(), ("the " + name).c_str()), 0) << name;
  }
  const Loaded l = good(pendulum("a&quot;&lt;&amp;b"));
  EXPECT_STREQ("a\"<&b", dyn_model_joint_name(l.model.get(), 1));
  const std::string huge(3000000, 'n');
  EXPECT_EQ(1, dyn_model_joint_id(good(pendulum(huge)).model.get(), huge.c_str()));
  EXPECT_LT(load(robot(link(huge) + link(huge))).error.size(), 1000u);
}

TEST(Odd, Shapes) {
  for (const std::string mesh :
       {"/dev/zero", "package://", "package://../../etc/passwd", "file://", "file://%00%ff%zz%", "m/\xFF.stl"}) {
    const Loaded l = good(robot(link("a", solid + "<visual><geometry><mesh filename=\"" + mesh + "\"/></geometry></visual>")));
    EXPECT_EQ(1, dyn_model_nshapes(l.model.get())) << mesh;
    EXPECT_EQ(1, l.warnings()) << mesh;
  }
}

TEST(Odd, ManyFollowersOfOneLeader) {
  std::string text = "<robot name=\"r\">" + link("l0");
  for (int i = 1; i <= 2000; ++i) {
    const std::string n = std::to_string(i);
    text += link("l" + n) + joint("j" + n, "revolute", "l" + std::to_string(i - 1), "l" + n,
                                  "<axis xyz=\"0 1 0\"/>" + limit + (i > 1 ? "<mimic joint=\"j1\"/>" : ""));
  }
  EXPECT_EQ(1, dyn_model_nv(good(text + "</robot>").model.get()));
}

// Paths with unusual names. Messages keep the reason and stay on one line.
TEST(Odd, Paths) {
  namespace fs = std::filesystem;
  std::string folder = (fs::temp_directory_path() / "dyn_hostile_XXXXXX").string();
  ASSERT_NE(nullptr, mkdtemp(folder.data()));
  const auto refuse = [](const std::string& path, dynStatus status, const std::string& reason) {
    const Loaded l = load_path(path);
    EXPECT_EQ(status, l.status) << path.substr(0, 100);
    EXPECT_NE(std::string::npos, l.error.find(reason)) << l.error;
    EXPECT_EQ(std::string::npos, l.error.find('\n')) << l.error;
  };
  refuse("/dev/null", DYN_ERROR_FILE, "this is a device, no regular file");
  refuse("/dev/zero", DYN_ERROR_FILE, "this is a device, no regular file");
  refuse(folder, DYN_ERROR_FILE, "this is a directory");
  refuse("/tmp/" + std::string(5000, 'x'), DYN_ERROR_FILE, "cannot be opened: File name too long");
  refuse(folder + "/a\nb%s%n.urdf", DYN_ERROR_FILE, "a b%s%n.urdf: cannot be opened");
  fs::create_symlink(folder + "/loop", folder + "/loop");
  refuse(folder + "/loop", DYN_ERROR_FILE, "cannot be opened");
  const std::string pipe = folder + "/pipe";
  ASSERT_EQ(0, mkfifo(pipe.c_str(), 0600));
  std::thread writer([&] { std::ofstream(pipe) << pendulum(); });
  EXPECT_EQ(DYN_OK, load_path(pipe).status);
  writer.join();
  fs::remove_all(folder);
}

}  // namespace
}  // namespace dyn_test
