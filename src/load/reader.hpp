// Reads attributes and children of one element, and reports those it does not read.
#pragma once

#include <initializer_list>
#include <optional>

#include "xml.hpp"

namespace dyn::load {

struct Reader {
  Report& report;
  std::string owner;  // name in messages: "joint 'elbow'"

  // Location in messages: "joint 'elbow': <limit lower>".
  std::string at(const Element& e, const char* attribute = nullptr) const;
  [[noreturn]] void fail(dynStatus status, const Element& e, const std::string& message) const {
    report.fail(status, line(e), owner + ": " + message);
  }

  // Text of an attribute. Missing or empty is an error.
  std::string name(const Element& e, const char* attribute) const;
  // One number. Missing is an error.
  double number(const Element& e, const char* attribute) const;
  std::optional<double> optional_number(const Element& e, const char* attribute) const;
  // Numbers of an attribute, or nullopt if it is missing.
  std::optional<std::vector<double>> numbers(const Element& e, const char* attribute) const;
  // The same with a required count.
  std::optional<std::vector<double>> numbers(const Element& e, const char* attribute, size_t count) const;
  std::optional<std::array<double, 3>> vector3(const Element& e, const char* attribute) const;

  // First child of this name, or null. Reports further ones.
  const Element* only(const Element& e, const char* child) const;
  // Reports everything in e that is not listed here, as dropped physics or as harmless.
  void unread(const Element& e, std::initializer_list<std::string_view> attributes,
              std::initializer_list<std::string_view> children, bool physics = true) const;

  [[noreturn]] void bad_numbers(const Element& e, const char* attribute, const std::string& what) const;

  // Pose of e's <origin>; identity if there is none.
  Placement origin(const Element& e, bool physics = true) const;
};

}  // namespace dyn::load
