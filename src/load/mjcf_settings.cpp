#include "mjcf_settings.hpp"

#include <cmath>
#include <limits>

#include "base/portable.hpp"
#include "spatial/quaternion.hpp"

namespace dyn::load {

namespace {

using Vec = Vec3<double>;
using Mat = Mat3<double>;

constexpr double min_length = 1e-10;  // shortest vector that counts as a direction

Vec unit(const Reader& reader, const Element& e, const char* attribute, const Vec& a) {
  const double length = std::sqrt(dot(a, a));
  if (!(length > min_length)) reader.bad_numbers(e, attribute, "this is no direction: it is zero");
  return a * (1 / length);
}

Mat rotation_about(const Vec& axis, double angle) {
  const double s = math::sin(angle / 2);
  return from_quaternion(math::cos(angle / 2), axis[0] * s, axis[1] * s, axis[2] * s);
}

}  // namespace

Mat3<double> from_quaternion(double w, double x, double y, double z) {
  return rotation(Quaternion<double>{Vec::make(x, y, z), w});
}

std::optional<bool> read_switch(const Reader& reader, const Element& e, const char* attribute, std::optional<bool> missing) {
  const char* text = e.Attribute(attribute);
  if (!text) return missing;
  const std::string_view value = text;
  if (value == "true" || value == "enable") return true;
  if (value == "false" || value == "disable") return false;
  if (value == "auto") return std::nullopt;
  reader.fail(DYN_ERROR_PARSE, e,
              "<" + std::string(e.Name()) + " " + attribute + "> is " + load::in_quotes(text) + ": true or false is expected");
}

std::optional<std::array<double, 2>> read_limits(const Reader& reader, const Element& e, const char* attribute,
                                                 const char* limited, bool autolimits) {
  const auto pair = reader.numbers(e, attribute, 2);
  const std::optional<bool> on = read_switch(reader, e, limited, std::nullopt);
  const bool ball = e.Attribute("type", "ball");
  if (!pair) {
    if (on.value_or(false) && ball) return std::array<double, 2>{0, 0};
    if (on.value_or(false)) reader.fail(DYN_ERROR_INVALID, e, std::string(limited) + "=\"true\" needs " + attribute);
    return std::nullopt;
  }
  if (!on && !autolimits && ((*pair)[0] != 0 || (*pair)[1] != 0))
    reader.fail(
        DYN_ERROR_INVALID, e,
        std::string(attribute) + " without " + limited + ", and <compiler autolimits> is false: add " + limited + "=\"true\"");
  if (!on.value_or((*pair)[0] != 0 || (*pair)[1] != 0)) return std::nullopt;
  if (!((*pair)[0] < (*pair)[1]) && !(ball && (*pair)[0] == (*pair)[1]))
    reader.bad_numbers(e, attribute, "the lower end is not below the upper one");
  return std::array<double, 2>{(*pair)[0], (*pair)[1]};
}

double read_bound(double x) {
  return std::abs(x) < std::numeric_limits<double>::max() ? x : std::copysign(std::numeric_limits<double>::infinity(), x);
}

double read_coefficient(const Reader& reader, const Element& e, const char* attribute) {
  const auto terms = reader.numbers(e, attribute);
  if (!terms) return 0;
  if (terms->empty()) reader.bad_numbers(e, attribute, "a number is expected");
  for (size_t k = 1; k < terms->size(); ++k)
    if ((*terms)[k] != 0) {
      reader.report.physics(line(e), reader.owner + ": <" + e.Name() + " " + attribute + ">: terms of higher order are not used");
      break;
    }
  if ((*terms)[0] < 0) reader.bad_numbers(e, attribute, "it is negative");
  return (*terms)[0];
}

void read_compiler(MjcfSource& source, Element& e, MjcfCompiler& compiler) {
  const Reader reader = source.reader(e, "the model");
  reader.unread(e, {"angle",        "eulerseq",     "autolimits",       "inertiafromgeom", "inertiagrouprange", "boundmass",
                    "boundinertia", "settotalmass", "balanceinertia",   "discardvisual",   "meshdir",           "assetdir",
                    "texturedir",   "strippath",    "coordinate",       "fusestatic",      "usethread",         "fitaabb",
                    "saveinertial", "alignfree",    "exactmeshinertia", "convexhull"},
                {"lengthrange"});
  if (const char* angle = e.Attribute("angle")) {
    const std::string_view unit = angle;
    if (unit != "degree" && unit != "radian")
      reader.fail(DYN_ERROR_PARSE, e, "<compiler angle> is " + load::in_quotes(angle) + ": degree or radian is expected");
    compiler.angle = unit == "radian" ? 1 : MjcfCompiler().angle;
  }
  if (const char* sequence = e.Attribute("eulerseq")) {
    compiler.euler = sequence;
    if (compiler.euler.size() != 3 || compiler.euler.find_first_not_of("xyzXYZ") != std::string::npos)
      reader.fail(DYN_ERROR_PARSE, e,
                  "<compiler eulerseq> is " + load::in_quotes(sequence) +
                      ": three of x, y, z (turned axes), X, Y, Z (fixed ones) are expected");
  }
  compiler.align_free = *read_switch(reader, e, "alignfree", compiler.align_free);
  if (const char* frame = e.Attribute("coordinate"); frame && std::string_view(frame) != "local")
    reader.fail(DYN_ERROR_UNSUPPORTED, e,
                "<compiler coordinate> is " + load::in_quotes(frame) + ": local coordinates alone are read");
  compiler.autolimits = *read_switch(reader, e, "autolimits", compiler.autolimits);
  if (e.Attribute("inertiafromgeom")) {
    const auto from = read_switch(reader, e, "inertiafromgeom", std::nullopt);
    compiler.masses.from_geoms = !from ? FromGeoms::WhenMissing : *from ? FromGeoms::Always : FromGeoms::Never;
  }
  if (const auto range = reader.numbers(e, "inertiagrouprange", 2))
    compiler.masses.groups[0] = (*range)[0], compiler.masses.groups[1] = (*range)[1];
  compiler.masses.min_mass = reader.optional_number(e, "boundmass").value_or(compiler.masses.min_mass);
  compiler.masses.min_inertia = reader.optional_number(e, "boundinertia").value_or(compiler.masses.min_inertia);
  compiler.total_mass = reader.optional_number(e, "settotalmass").value_or(compiler.total_mass);
  compiler.masses.balance = *read_switch(reader, e, "balanceinertia", compiler.masses.balance);
  compiler.discard_visual = *read_switch(reader, e, "discardvisual", compiler.discard_visual);
  compiler.fit_bounds = *read_switch(reader, e, "fitaabb", compiler.fit_bounds);
  compiler.strip_path = *read_switch(reader, e, "strippath", compiler.strip_path);
  if (const Element* length = reader.only(e, "lengthrange")) {
    compiler.length_given = read_switch(reader, *length, "useexisting", compiler.length_given).value_or(true);
    compiler.length_of_limits = read_switch(reader, *length, "uselimit", compiler.length_of_limits).value_or(false);
    if (const char* mode = length->Attribute("mode")) compiler.length_computed = std::string_view(mode) != "none";
  }
  if (const char* folder = e.Attribute("assetdir")) compiler.mesh_folder = folder;
  if (const char* folder = e.Attribute("meshdir")) compiler.mesh_folder = folder;
}

bool has_rotation(const Element& e) {
  for (const char* name : rotation_attributes)
    if (e.Attribute(name)) return true;
  return false;
}

// The smallest rotation that takes z to a; half a turn about x for -z.
Mat3<double> turn_z_to(const Vec3<double>& a) {
  const Vec axis = cross(Vec::make(0, 0, 1), a);
  const double s = std::sqrt(dot(axis, axis));
  if (s < min_length) return a[2] > 0 ? Mat::identity() : rotation_about(Vec::make(1, 0, 0), 3.14159265358979324);
  return rotation_about(axis * (1 / s), math::atan2(s, a[2]));
}

Mat3<double> from_euler(const std::array<double, 3>& angles, const MjcfCompiler& compiler) {
  Mat R = Mat::identity();
  for (size_t i = 0; i < 3; ++i) {
    const char c = compiler.euler[i];
    const bool fixed = c >= 'X' && c <= 'Z';
    const int k = fixed ? c - 'X' : c - 'x';
    const Mat turn = rotation_about(Vec::make(k == 0, k == 1, k == 2), angles[i] * compiler.angle);
    R = fixed ? turn * R : R * turn;
  }
  return R;
}

SE3<double> read_rotation(const Reader& reader, const Element& e, const MjcfCompiler& compiler) {
  SE3<double> X = SE3<double>::identity();
  const char* given = nullptr;
  for (const char* name : rotation_attributes)
    if (e.Attribute(name)) {
      if (given)
        reader.fail(DYN_ERROR_INVALID, e,
                    "<" + std::string(e.Name()) + "> gives the rotation twice: keep one of " + given + " and " + name);
      given = name;
    }
  if (const auto q = reader.numbers(e, "quat", 4)) {
    double largest = 0;
    for (double c : *q) largest = std::max(largest, std::abs(c));
    if (largest == 0) reader.bad_numbers(e, "quat", "this is no rotation: it is zero");
    X.R = from_quaternion((*q)[0] / largest, (*q)[1] / largest, (*q)[2] / largest, (*q)[3] / largest);
  } else if (const auto a = reader.numbers(e, "axisangle", 4)) {
    X.R = rotation_about(unit(reader, e, "axisangle", load3(a->data())), (*a)[3] * compiler.angle);
  } else if (const auto angles = reader.vector3(e, "euler")) {
    X.R = from_euler(*angles, compiler);
  } else if (const auto xy = reader.numbers(e, "xyaxes", 6)) {
    X.R.x = unit(reader, e, "xyaxes", load3(xy->data()));
    const Vec y = load3(xy->data() + 3);
    X.R.y = unit(reader, e, "xyaxes", y - X.R.x * dot(X.R.x, y));
    X.R.z = cross(X.R.x, X.R.y);
  } else if (const auto z = reader.vector3(e, "zaxis")) {
    X.R = turn_z_to(unit(reader, e, "zaxis", load3(z->data())));
  }
  return X;
}

SE3<double> read_pose(const Reader& reader, const Element& e, const MjcfCompiler& compiler) {
  SE3<double> X = read_rotation(reader, e, compiler);
  if (const auto p = reader.vector3(e, "pos")) X.p = load3(p->data());
  return X;
}

}  // namespace dyn::load
