#include "reader.hpp"

#include <algorithm>
#include <cmath>

#include "number.hpp"
#include "spatial/rpy.hpp"
#include "spatial/se3.hpp"

namespace dyn::load {

namespace {

std::string shown(std::string_view s) {
  constexpr size_t longest = 60;
  std::string out(s.substr(0, longest));
  return s.size() > longest ? out + "..." : out;
}

// Hints to other programs that do not describe the robot.
const std::initializer_list<std::string_view> harmless = {"verbose", "dont_collapse", "self_filter", "collision_checking",
                                                          "self_collision_checking"};

bool among(std::initializer_list<std::string_view> list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

Placement from_rpy(const std::array<double, 3>& xyz, double roll, double pitch, double yaw) {
  Placement out;
  store_se3(SE3<double>{rotation_of_rpy(roll, pitch, yaw), load3(xyz.data())}, out.data());
  return out;
}

Placement from_quaternion(const std::array<double, 3>& xyz, double x, double y, double z, double w) {
  const double s = 2 / (x * x + y * y + z * z + w * w);
  return {1 - s * (y * y + z * z), s * (x * y + w * z),     s * (x * z - w * y),  //
          s * (x * y - w * z),     1 - s * (x * x + z * z), s * (y * z + w * x),  //
          s * (x * z + w * y),     s * (y * z - w * x),     1 - s * (x * x + y * y), xyz[0], xyz[1], xyz[2]};
}

}  // namespace

std::string Reader::at(const Element& e, const char* attribute) const {
  return owner + ": <" + e.Name() + (attribute ? std::string(" ") + attribute + ">" : ">");
}

std::string Reader::name(const Element& e, const char* attribute) const {
  const char* value = e.Attribute(attribute);
  if (!value) report.fail(DYN_ERROR_PARSE, line(e), at(e) + " has no attribute " + attribute);
  if (!*value) report.fail(DYN_ERROR_PARSE, line(e), at(e, attribute) + " is empty");
  return value;
}

void Reader::bad_numbers(const Element& e, const char* attribute, const std::string& what) const {
  const tinyxml2::XMLAttribute* a = e.FindAttribute(attribute);
  report.fail(DYN_ERROR_PARSE, a->GetLineNum(), at(e) + " " + attribute + "=\"" + shown(a->Value()) + "\": " + what);
}

std::optional<std::vector<double>> Reader::numbers(const Element& e, const char* attribute) const {
  const char* all = e.Attribute(attribute);
  if (!all) return std::nullopt;
  const auto parts = split(all);
  std::vector<double> values(parts.size());
  for (size_t i = 0; i < parts.size(); ++i)
    if (const std::string wrong = parse_number(parts[i], values[i]); !wrong.empty())
      bad_numbers(e, attribute, "'" + shown(parts[i]) + "' " + wrong);
  return values;
}

std::optional<std::vector<double>> Reader::numbers(const Element& e, const char* attribute, size_t count) const {
  auto values = numbers(e, attribute);
  if (values && values->size() != count)
    bad_numbers(e, attribute,
                std::to_string(values->size()) + (values->size() == 1 ? " number where " : " numbers where ") +
                    std::to_string(count) + (count == 1 ? " is expected" : " are expected"));
  return values;
}

std::optional<double> Reader::optional_number(const Element& e, const char* attribute) const {
  const auto v = numbers(e, attribute, 1);
  return v ? std::optional<double>((*v)[0]) : std::nullopt;
}

double Reader::number(const Element& e, const char* attribute) const {
  const auto v = optional_number(e, attribute);
  if (!v) report.fail(DYN_ERROR_PARSE, line(e), at(e) + " has no attribute " + attribute);
  return *v;
}

std::optional<std::array<double, 3>> Reader::vector3(const Element& e, const char* attribute) const {
  const auto v = numbers(e, attribute, 3);
  return v ? std::optional<std::array<double, 3>>({(*v)[0], (*v)[1], (*v)[2]}) : std::nullopt;
}

const Element* Reader::only(const Element& e, const char* child) const {
  const Element* c = first(e, child);
  if (c)
    for (const Element* more = next(*c, child); more; more = next(*more, child))
      report.physics(line(*more),
                     owner + ": a second <" + child + "> is not used: the first one is at line " + std::to_string(line(*c)));
  return c;
}

void Reader::unread(const Element& e, std::initializer_list<std::string_view> attributes,
                    std::initializer_list<std::string_view> children, bool physics) const {
  const auto drop = [&](int at_line, std::string_view name, const std::string& message) {
    if (physics && !among(harmless, name))
      report.physics(at_line, message);
    else
      report.info(at_line, message);
  };
  for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next()) {
    const std::string_view name = a->Name();
    if (!among(attributes, name) && !name.starts_with("xmlns"))
      drop(a->GetLineNum(), name, at(e) + ": attribute " + shown(name) + "=\"" + shown(a->Value()) + "\" is not used");
  }
  for (const tinyxml2::XMLNode* n = e.FirstChild(); n; n = n->NextSibling()) {
    if (const Element* c = n->ToElement()) {
      if (!among(children, c->Name()) && std::string_view(c->Name()) != part_name)
        drop(line(*c), c->Name(), at(e) + ": element <" + shown(c->Name()) + "> is not used" +
                                      (std::string_view(c->Name()).starts_with("xacro:") ? ": xacro did not know this macro" : ""));
    } else if (n->ToText()) {
      if (const auto words = split(n->Value()); !words.empty())
        drop(n->GetLineNum(), "", at(e) + ": the text '" + shown(words[0]) + "' is not used");
    }
  }
}

Placement Reader::origin(const Element& e, bool physics) const {
  const Element* o = only(e, "origin");
  if (!o) return identity_placement;
  unread(*o, {"xyz", "rpy", "quat_xyzw"}, {}, physics);
  const auto xyz = vector3(*o, "xyz").value_or(std::array<double, 3>{0, 0, 0});
  const auto rpy = vector3(*o, "rpy");
  if (const auto q = numbers(*o, "quat_xyzw", 4)) {
    if (rpy) fail(DYN_ERROR_INVALID, *o, "<origin> gives the rotation twice: keep one of rpy and quat_xyzw");
    double largest = 0;
    for (double c : *q) largest = std::max(largest, std::abs(c));
    if (largest == 0) fail(DYN_ERROR_INVALID, *o, "<origin quat_xyzw> is zero: for the identity give \"0 0 0 1\"");
    return from_quaternion(xyz, (*q)[0] / largest, (*q)[1] / largest, (*q)[2] / largest, (*q)[3] / largest);
  }
  return rpy ? from_rpy(xyz, (*rpy)[0], (*rpy)[1], (*rpy)[2]) : from_rpy(xyz, 0, 0, 0);
}

}  // namespace dyn::load
