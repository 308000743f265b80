// Files that are refused: the status, and a message with the line, the element, and what to do.
#include "load/urdf.hpp"

namespace dyn_test::urdf_bad_test {
namespace {

struct Case {
  const char* name;
  std::string text;
  dynStatus status;
  std::vector<std::string> fragments;
  Options options = Options();
};

// Columns of the table below.
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

std::string inertial(const std::string& inside) { return robot(link("a", "\n<inertial>" + inside + "</inertial>")); }
std::string inertia(const std::string& xx, const std::string& yy, const std::string& zz, const std::string& mass = "1") {
  return "<mass value=\"" + mass + "\"/><inertia ixx=\"" + xx + "\" ixy=\"0\" ixz=\"0\" iyy=\"" + yy + "\" iyz=\"0\" izz=\"" +
         zz + "\"/>";
}
std::string hinge(const std::string& inside) { return robot(ab + joint("j", "revolute", "a", "b", inside)); }
std::string hinge_limit(const std::string& attributes) { return hinge("<axis xyz=\"0 0 1\"/><limit " + attributes + "/>"); }
std::string limit_of(const std::string& lower, const std::string& upper) {
  return "<limit lower=\"" + lower + "\" upper=\"" + upper + "\" effort=\"1\" velocity=\"1\"/>";
}
std::string shape(const std::string& inside) {
  return robot(link("a", solid + "\n<collision><geometry>" + inside + "</geometry></collision>"));
}
std::string mimics(const std::string& type1, const std::string& mimic1, const std::string& type2 = "revolute",
                   const std::string& mimic2 = "") {
  const std::string axis = "<axis xyz=\"0 0 1\"/>" + limit;
  return robot(ab + link("c") + joint("j1", type1, "a", "b", axis + mimic1) + joint("j2", type2, "b", "c", axis + mimic2));
}
std::string nested(int depth) {
  std::string open, close;
  for (int i = 0; i < depth; ++i) open += "<g>", close += "</g>";
  return robot(link("a") + "<gazebo>" + open + close + "</gazebo>");
}
std::string many_attributes() {
  std::string all = "<link name=\"a\"";
  for (int i = 0; i < 100; ++i) all += " a" + std::to_string(i) + "=\"1\"";
  return robot(all + "/>");
}

const Case cases[] = {
    // not a URDF at all
    {"Empty", "", DYN_ERROR_PARSE, {"empty"}},
    {"Blank", " \n\t ", DYN_ERROR_PARSE, {"empty"}},
    {"Words", "hello\nworld", DYN_ERROR_PARSE, {"not XML"}},
    {"Path", "models/robot.urdf", DYN_ERROR_PARSE, {"not XML", "load a path as a file"}},
    {"Mjcf", "<?xml version=\"1.0\"?><!-- x --><mujocoinclude/>", DYN_ERROR_PARSE, {"MJCF", "include"}},
    {"Sdf", "<sdf version=\"1.6\"/>", DYN_ERROR_UNSUPPORTED, {"SDF"}},
    {"OtherRoot", "\n<robots/>", DYN_ERROR_PARSE, {"line 2", "<robots>", "<robot>"}},
    {"Dynb", "DYNB\x01\x02", DYN_ERROR_PARSE, {"damaged", "header"}},
    {"Zip", "PK\x03\x04 zip", DYN_ERROR_UNSUPPORTED, {"binary"}},
    {"Utf16", "\xFF\xFE<", DYN_ERROR_PARSE, {"UTF-16", "UTF-8"}},
    {"Xacro", robot("<xacro:macro name=\"leg\"/>"), DYN_ERROR_UNSUPPORTED, {"line 2", "xacro:macro", "run xacro first"}},
    {"XacroNumber",
     hinge_limit("lower=\"${-pi}\" upper=\"1\" effort=\"1\" velocity=\"1\""),
     DYN_ERROR_PARSE,
     {"line 4", "${-pi}", "run xacro"}},
    {"XacroWithoutResult", "<robot name=\"r\" xmlns:xacro=\"x\"/>", DYN_ERROR_INVALID, {"line 1", "no links", "xacro"}},
    {"Version", "<robot name=\"r\" version=\"2.0\"/>", DYN_ERROR_UNSUPPORTED, {"line 1", "2.0"}},

    // XML
    {"CutOff", "<robot name=\"r\">\n<link name=\"a\">", DYN_ERROR_PARSE, {"line "}},
    {"CutOffTag", "<robot name=\"r\">\n<link name=\"a\"", DYN_ERROR_PARSE, {"line 2", "never closed"}},
    {"CutOffComment", "<robot name=\"r\">\n\n<!-- no end", DYN_ERROR_PARSE, {"line 3", "never closed"}},
    {"WrongEnd", "<robot name=\"r\">\n<link name=\"a\"></links>\n</robot>", DYN_ERROR_PARSE, {"line 2"}},
    {"NoQuotes", "<robot name=\"r\">\n<link name=a/>\n</robot>", DYN_ERROR_PARSE, {"line 2", "attribute"}},
    {"RepeatedAttribute",
     "<robot name=\"r\">\n<link name=\"a\" name=\"b\"/>\n</robot>",
     DYN_ERROR_PARSE,
     {"line 2", "attribute"}},
    {"TwoRoots",
     "<robot name=\"r\"><link name=\"a\"/></robot>\n<robot name=\"s\"/>",
     DYN_ERROR_PARSE,
     {"line 2", "outside the root"}},
    {"TextAfterRoot", "<robot name=\"r\"><link name=\"a\"/></robot>\nrest", DYN_ERROR_PARSE, {"line 2"}},
    {"Doctype", "<!DOCTYPE robot [<!ENTITY a \"aaaaaaaaaa\">\n]>" + robot(link("a")), DYN_ERROR_PARSE, {"line 1", "entities"}},
    {"Entity",
     "<?xml version=\"1.0\"?>\n<!ENTITY x SYSTEM \"file:///etc/passwd\">" + robot(link("a")),
     DYN_ERROR_PARSE,
     {"line 2", "entities"}},
    {"Nesting", nested(200), DYN_ERROR_LIMIT, {"line 3", "nested", "limit"}},
    {"Attributes", many_attributes(), DYN_ERROR_LIMIT, {"line 2", "attributes", "limit"}},

    // names and tree
    {"NoLinks", robot(""), DYN_ERROR_INVALID, {"line 1", "no links"}},
    {"UnnamedLink", robot("<link/>"), DYN_ERROR_PARSE, {"line 2", "<link>", "no attribute name"}},
    {"EmptyName", robot("<link name=\"\"/>"), DYN_ERROR_PARSE, {"line 2", "empty"}},
    {"UnnamedJoint",
     robot(ab + "<joint type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>"),
     DYN_ERROR_PARSE,
     {"line 4", "no attribute name"}},
    {"LinkTwice", robot(link("a") + link("b") + link("a")), DYN_ERROR_NAME, {"line 4", "link 'a'", "line 2"}},
    {"JointTwice",
     robot(ab + link("c") + joint("j", "fixed", "a", "b") + joint("j", "fixed", "b", "c")),
     DYN_ERROR_NAME,
     {"line 6", "joint 'j'", "line 5"}},
    {"NamedUniverse", robot(link("universe")), DYN_ERROR_NAME, {"line 2", "'universe'", "rename"}},
    {"JointUniverse", robot(ab + joint("universe", "revolute", "a", "b")), DYN_ERROR_NAME, {"line 4", "'universe'", "rename"}},
    {"Latin1Name", robot(link("bein\xE4")), DYN_ERROR_NAME, {"line 2", "UTF-8"}},
    {"ControlName", robot(link("a&#10;b")), DYN_ERROR_NAME, {"line 2", "control character"}},
    {"UnknownParent",
     robot(ab + joint("j", "fixed", "aa", "b")),
     DYN_ERROR_NAME,
     {"line 4", "joint 'j'", "parent link 'aa'", "did you mean 'a'"}},
    {"UnknownChild",
     robot(ab + joint("j", "fixed", "a", "nothing_like_it")),
     DYN_ERROR_NAME,
     {"line 4", "joint 'j'", "child link 'nothing_like_it'"}},
    {"NoParent",
     robot(ab + "<joint name=\"j\" type=\"fixed\"><child link=\"b\"/></joint>"),
     DYN_ERROR_PARSE,
     {"line 4", "joint 'j'", "<parent"}},
    {"NoChild",
     robot(ab + "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/></joint>"),
     DYN_ERROR_PARSE,
     {"line 4", "joint 'j'", "<child"}},
    {"ParentWithoutLink",
     robot(ab + "<joint name=\"j\" type=\"fixed\"><parent name=\"a\"/><child link=\"b\"/></joint>"),
     DYN_ERROR_PARSE,
     {"line 4", "<parent>", "link"}},
    {"TwoParents",
     robot(ab + link("c") + joint("j1", "fixed", "a", "c") + joint("j2", "fixed", "b", "c")),
     DYN_ERROR_INVALID,
     {"line 6", "joint 'j2'", "'c'", "'j1'", "line 5"}},
    {"SelfLoop", robot(ab + joint("j", "fixed", "a", "a")), DYN_ERROR_INVALID, {"line 4", "joint 'j'", "'a'", "itself"}},
    {"Cycle",
     robot(ab + joint("j1", "fixed", "a", "b") + joint("j2", "fixed", "b", "a")),
     DYN_ERROR_INVALID,
     {"cycle", "'a' -> 'b'"}},
    {"CycleBesideTree",
     robot(ab + link("c") + joint("j1", "fixed", "b", "c") + joint("j2", "fixed", "c", "b")),
     DYN_ERROR_INVALID,
     {"cycle", "'b'", "'c'"}},
    {"TwoRootLinks", robot(ab), DYN_ERROR_INVALID, {"line 2", "2 root links", "'a' at line 2", "'b' at line 3"}},

    // numbers
    {"Comma",
     hinge_limit("lower=\"0,5\" upper=\"1\" effort=\"1\" velocity=\"1\""),
     DYN_ERROR_PARSE,
     {"line 4", "joint 'j'", "<limit>", "lower=\"0,5\"", "point"}},
    {"Nan",
     hinge_limit("lower=\"nan\" upper=\"1\" effort=\"1\" velocity=\"1\""),
     DYN_ERROR_PARSE,
     {"line 4", "'nan'", "not finite"}},
    {"Inf", inertial(inertia("inf", "1", "1")), DYN_ERROR_PARSE, {"line 3", "link 'a'", "<inertia> ixx", "not finite"}},
    {"MinusInfinity",
     hinge_limit("lower=\"-Infinity\" upper=\"1\" effort=\"1\" velocity=\"1\""),
     DYN_ERROR_PARSE,
     {"line 4", "not finite"}},
    {"LowerInfinite",
     hinge("\n" + limit_of("inf", "1")),
     DYN_ERROR_PARSE,
     {"line 5", "joint 'j'", "<limit> lower=\"inf\"", "not finite"}},
    {"UpperMinusInfinite",
     hinge("\n" + limit_of("-1", "-inf")),
     DYN_ERROR_PARSE,
     {"line 5", "joint 'j'", "<limit> upper=\"-inf\"", "not finite"}},
    {"Overflow", inertial(inertia("1", "1", "1", "1e999")), DYN_ERROR_PARSE, {"line 3", "<mass> value=\"1e999\"", "too large"}},
    {"TrailingGarbage", inertial(inertia("1", "1", "1", "1kg")), DYN_ERROR_PARSE, {"line 3", "'1kg'", "not a number"}},
    {"Hexadecimal", inertial(inertia("1", "1", "1", "0x10")), DYN_ERROR_PARSE, {"line 3", "'0x10'"}},
    {"TwoSigns", inertial(inertia("1", "1", "1", "+-1")), DYN_ERROR_PARSE, {"line 3", "'+-1'"}},
    {"EmptyNumber", inertial(inertia("1", "1", "1", "")), DYN_ERROR_PARSE, {"line 3", "<mass>", "0 numbers"}},
    {"TwoNumbers", inertial(inertia("1", "1", "1", "1 2")), DYN_ERROR_PARSE, {"line 3", "2 numbers", "1 is expected"}},
    {"TwoOfThree",
     hinge("<origin xyz=\"1 2\"/>"),
     DYN_ERROR_PARSE,
     {"line 4", "<origin> xyz=\"1 2\"", "2 numbers", "3 are expected"}},
    {"FourOfThree", hinge("<origin rpy=\"1 2 3 4\"/>"), DYN_ERROR_PARSE, {"line 4", "<origin> rpy", "4 numbers"}},
    {"CommasBetween", hinge("<origin xyz=\"1,2,3\"/>"), DYN_ERROR_PARSE, {"line 4", "spaces between"}},
    {"RotationTwice", hinge("<origin rpy=\"0 0 0\" quat_xyzw=\"0 0 0 1\"/>"), DYN_ERROR_INVALID, {"line 4", "twice"}},
    {"ZeroQuaternion", hinge("<origin quat_xyzw=\"0 0 0 0\"/>"), DYN_ERROR_INVALID, {"line 4", "zero"}},

    // inertials
    {"NegativeMass", inertial(inertia("1", "1", "1", "-1")), DYN_ERROR_INVALID, {"line 3", "link 'a'", "negative", "-1"}},
    {"NoMass",
     inertial("<inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>"),
     DYN_ERROR_INVALID,
     {"line 3", "link 'a'", "<mass"}},
    {"MassAsText", inertial("<mass>5</mass>"), DYN_ERROR_PARSE, {"line 3", "link 'a'", "<mass>", "value"}},
    {"NoInertia", inertial("<mass value=\"1\"/>"), DYN_ERROR_INVALID, {"line 3", "link 'a'", "<inertia>", "ixx"}},
    {"NoIyy",
     inertial("<mass value=\"1\"/><inertia ixx=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>"),
     DYN_ERROR_PARSE,
     {"line 3", "<inertia>", "iyy"}},
    {"NegativeInertia",
     robot(ab + joint("j", "revolute", "a", "c") + link("c", "\n<inertial>" + inertia("-0.1", "0.2", "0.2") + "</inertial>") +
           joint("k", "revolute", "c", "b")),
     DYN_ERROR_STRICT,
     {"line 6", "link 'c'", "principal moments", "-0.1", "negative", "nearest possible"},
     Options(DYN_BASE_FIXED, true)},
    {"HugeInertia",
     inertial("<origin rpy=\"1 1 1\"/><mass value=\"1\"/><inertia ixx=\"1e308\" ixy=\"1e308\" ixz=\"1e308\" iyy=\"1e308\" "
              "iyz=\"1e308\" izz=\"1e308\"/>"),
     DYN_ERROR_INVALID,
     {"link 'a'"}},
    {"Triangle",
     inertial(inertia("0.1", "0.1", "0.5")),
     DYN_ERROR_STRICT,
     {"line 3", "link 'a'", "principal moments", "0.1, 0.1, 0.5", "nearest possible"},
     Options(DYN_BASE_FIXED, true)},

    // joints
    {"NoType",
     robot(ab + "<joint name=\"j\"><parent link=\"a\"/><child link=\"b\"/></joint>"),
     DYN_ERROR_PARSE,
     {"line 4", "joint 'j'", "no attribute type"}},
    {"UnknownType",
     robot(ab + joint("j", "hinge", "a", "b")),
     DYN_ERROR_INVALID,
     {"line 4", "joint 'j'", "'hinge'", "revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical"}},
    {"CapitalType", robot(ab + joint("j", "Revolute", "a", "b")), DYN_ERROR_INVALID, {"line 4", "'Revolute'"}},
    {"ZeroAxis",
     hinge("<axis xyz=\"0 0 0\"/>" + limit),
     DYN_ERROR_INVALID,
     {"line 4", "joint 'j'", "axis is zero", "xyz=\"0 0 1\""}},
    {"ZeroPlanarAxis",
     robot(ab + joint("j", "planar", "a", "b", "<axis xyz=\"0 -0 0\"/>")),
     DYN_ERROR_INVALID,
     {"line 4", "axis is zero"}},
    {"AxisWithoutXyz", hinge("<axis/>" + limit), DYN_ERROR_PARSE, {"line 4", "joint 'j'", "<axis>", "xyz"}},
    {"LowerAboveUpper",
     hinge_limit("lower=\"1\" upper=\"-1\" effort=\"1\" velocity=\"1\""),
     DYN_ERROR_INVALID,
     {"line 4", "joint 'j'", "lower 1", "upper -1"}},
    {"LowerAboveDefault",
     hinge_limit("lower=\"1\" effort=\"1\" velocity=\"1\""),
     DYN_ERROR_INVALID,
     {"line 4", "lower 1", "upper 0"}},
    {"NegativeEffort",
     hinge_limit("lower=\"-1\" upper=\"1\" effort=\"-5\" velocity=\"1\""),
     DYN_ERROR_INVALID,
     {"line 4", "joint 'j'", "effort", "negative", "-5"}},
    {"NegativeVelocity",
     hinge_limit("lower=\"-1\" upper=\"1\" effort=\"5\" velocity=\"-1\""),
     DYN_ERROR_INVALID,
     {"line 4", "velocity", "negative"}},
    {"NegativeDamping",
     hinge(limit + "<dynamics damping=\"-0.1\"/>"),
     DYN_ERROR_INVALID,
     {"line 4", "joint 'j'", "damping", "negative"}},
    {"NegativeFriction", hinge(limit + "<dynamics friction=\"-0.1\"/>"), DYN_ERROR_INVALID, {"line 4", "friction", "negative"}},

    // mimic
    {"MimicUnknown",
     mimics("revolute", "<mimic joint=\"j3\"/>"),
     DYN_ERROR_NAME,
     {"line 5", "joint 'j1'", "'j3'", "did you mean"}},
    {"MimicForgottenPrefix",
     robot(ab + link("c") + joint("Left_index_q1", "revolute", "a", "b") +
           joint("Left_index_q2", "revolute", "b", "c", limit + "<mimic joint=\"index_q1\"/>")),
     DYN_ERROR_NAME,
     {"line 6", "'index_q1'", "did you mean 'Left_index_q1'"}},
    {"MimicWithoutJoint", mimics("revolute", "<mimic multiplier=\"2\"/>"), DYN_ERROR_PARSE, {"line 5", "<mimic>", "joint"}},
    {"MimicItself", mimics("revolute", "<mimic joint=\"j1\"/>"), DYN_ERROR_INVALID, {"line 5", "joint 'j1'", "itself"}},
    {"MimicCycle",
     mimics("revolute", "<mimic joint=\"j2\"/>", "revolute", "<mimic joint=\"j1\"/>"),
     DYN_ERROR_INVALID,
     {"line 5", "cycle", "'j1' -> 'j2' -> 'j1'"}},
    {"MimicOfFixed",
     mimics("fixed", "", "revolute", "<mimic joint=\"j1\"/>"),
     DYN_ERROR_INVALID,
     {"line 6", "joint 'j2'", "'j1'", "fixed"}},
    {"MimicOfFloating",
     mimics("floating", "", "revolute", "<mimic joint=\"j1\"/>"),
     DYN_ERROR_INVALID,
     {"line 6", "'j1'", "floating"}},
    {"FloatingMimics",
     mimics("revolute", "", "floating", "<mimic joint=\"j1\"/>"),
     DYN_ERROR_INVALID,
     {"line 6", "joint 'j2'", "floating", "cannot mimic"}},
    {"PlanarMimics",
     mimics("revolute", "", "planar", "<mimic joint=\"j1\"/>"),
     DYN_ERROR_INVALID,
     {"line 6", "planar", "cannot mimic"}},
    {"MimicNan",
     mimics("revolute", "", "revolute", "<mimic joint=\"j1\" multiplier=\"NaN\"/>"),
     DYN_ERROR_PARSE,
     {"line 6", "multiplier", "not finite"}},

    // geometry
    {"NegativeBox", shape("<box size=\"1 -1 1\"/>"), DYN_ERROR_INVALID, {"line 3", "link 'a'", "<box>", "-1"}},
    {"NegativeSphere", shape("<sphere radius=\"-1\"/>"), DYN_ERROR_INVALID, {"line 3", "<sphere>", "radius"}},
    {"NegativeCylinder", shape("<cylinder radius=\"1\" length=\"-2\"/>"), DYN_ERROR_INVALID, {"line 3", "<cylinder>", "length"}},
    {"CylinderWithoutLength", shape("<cylinder radius=\"1\"/>"), DYN_ERROR_PARSE, {"line 3", "<cylinder>", "length"}},
    {"BoxWithoutSize", shape("<box/>"), DYN_ERROR_PARSE, {"line 3", "<box>", "size"}},
    {"MeshWithoutName", shape("<mesh/>"), DYN_ERROR_PARSE, {"line 3", "<mesh>", "filename"}},
    {"FlatMesh", shape("<mesh filename=\"a.stl\" scale=\"1 0 1\"/>"), DYN_ERROR_INVALID, {"line 3", "scale"}},
    {"OneScale",
     shape("<mesh filename=\"a.stl\" scale=\"0.001\"/>"),
     DYN_ERROR_PARSE,
     {"line 3", "scale=\"0.001\"", "3 are expected"}},

    // the base
    {"NoBase", robot(link("a")), DYN_ERROR_BASE, {"line 2", "'a'", "base fixed or base floating"}, Options(DYN_BASE_UNSPECIFIED)},
    {"FloatingTwice",
     robot(link("world", "") + link("a") + joint("j", "floating", "world", "a", "")),
     DYN_ERROR_BASE,
     {"line 4", "joint 'j'", "floating already", "base fixed"},
     Options(DYN_BASE_FLOATING)},
    {"FloatingNothing",
     robot(link("base", "") + link("a") + joint("j", "revolute", "base", "a")),
     DYN_ERROR_BASE,
     {"line 2", "'base'", "no mass"},
     Options(DYN_BASE_FLOATING)},
    {"RootJointTaken",
     robot(ab + joint("root_joint", "revolute", "a", "b")),
     DYN_ERROR_NAME,
     {"line 4", "root_joint", "rename"},
     Options(DYN_BASE_FLOATING)},

    // strict
    {"StrictDampingElement",
     hinge(limit + "<dynamics>\n<damping>0.1</damping></dynamics>"),
     DYN_ERROR_STRICT,
     {"strict", "line 5", "joint 'j'", "<damping>"},
     Options(DYN_BASE_FIXED, true)},
    {"StrictMisspelled",
     robot("<link name=\"a\">\n<inertail/></link>"),
     DYN_ERROR_STRICT,
     {"line 3", "link 'a'", "<inertail>"},
     Options(DYN_BASE_FIXED, true)},
    {"StrictAttribute",
     hinge(limit + "<dynamics damping=\"1\" stiffness=\"3\"/>"),
     DYN_ERROR_STRICT,
     {"line 4", "stiffness=\"3\""},
     Options(DYN_BASE_FIXED, true)},
    {"StrictUnknownElement",
     robot(link("a") + "<loop_joint name=\"x\"/>"),
     DYN_ERROR_STRICT,
     {"line 3", "<loop_joint>"},
     Options(DYN_BASE_FIXED, true)},
    {"StrictGazeboLoop",
     robot(link("a") + "<gazebo>\n<joint name=\"x\"><parent>a</parent></joint></gazebo>"),
     DYN_ERROR_STRICT,
     {"line 4", "loop"},
     Options(DYN_BASE_FIXED, true)},
    {"StrictMesh",
     shape("<mesh filename=\"package://nowhere/a.stl\"/>"),
     DYN_ERROR_STRICT,
     {"line 3", "package://nowhere/a.stl", "package_dirs"},
     Options(DYN_BASE_FIXED, true)},
    {"StrictSecondInertial",
     robot(link("a", solid + "\n" + solid)),
     DYN_ERROR_STRICT,
     {"line 3", "second <inertial>"},
     Options(DYN_BASE_FIXED, true)},
};

class BadUrdf : public testing::TestWithParam<Case> {};

TEST_P(BadUrdf, IsRefusedWithReason) {
  const Case& c = GetParam();
  const Loaded l = load(c.text, c.options);
  EXPECT_EQ(c.status, l.status) << dyn_status_name(l.status) << ": " << l.error;
  for (const std::string& fragment : c.fragments)
    EXPECT_NE(std::string::npos, l.error.find(fragment)) << "'" << fragment << "' is not in: " << l.error;
  EXPECT_EQ(std::string::npos, l.error.find('\n')) << l.error;
}

INSTANTIATE_TEST_SUITE_P(Load, BadUrdf, testing::ValuesIn(cases), [](const auto& info) { return std::string(info.param.name); });

// Any prefix of a valid file is refused or read, and never crashes the loader.
TEST(BadUrdfs, EveryPrefix) {
  const std::string text = hinge("<origin xyz=\"0 0 1\" rpy=\"0 0 0\"/>" + limit + "<dynamics damping=\"1\"/>");
  for (size_t n = 0; n < text.size(); ++n) {
    const Loaded l = load(text.substr(0, n));
    EXPECT_EQ(l.status == DYN_OK, l.error.empty()) << n;
  }
}

TEST(BadUrdfs, EveryByteReplaced) {
  const std::string text = hinge("<origin xyz=\"0 0 1\" rpy=\"0 0 0\"/>" + limit + "<mimic joint=\"j\"/>");
  for (size_t n = 0; n < text.size(); ++n)
    for (const char c : {'<', '>', '"', '\'', '&', '/', '!', '-', '9', 'e', '\xFF', '\n'}) {
      std::string changed = text;
      changed[n] = c;
      const Loaded l = load(changed);
      EXPECT_EQ(l.status == DYN_OK, l.error.empty()) << n << " " << c;
    }
}

}  // namespace
}  // namespace dyn_test::urdf_bad_test
