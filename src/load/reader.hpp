// Reads attributes and children of one thing of the file, and reports what it does not read.
#pragma once

#include <initializer_list>
#include <optional>

#include "xml.hpp"

namespace dyn::load {

struct Reader {
  Report& report;
  std::string owner;  // what messages call the thing: "joint 'elbow'"

  // Names in messages: "joint 'elbow': <limit lower>".
  std::string at(const Element& e, const char* attribute = nullptr) const;
  [[noreturn]] void fail(dynStatus status, const Element& e, const std::string& message) const {
    report.fail(status, line(e), owner + ": " + message);
  }

  // The attribute's text; missing or empty is an error.
  std::string name(const Element& e, const char* attribute) const;
  // One number; missing is an error.
  double number(const Element& e, const char* attribute) const;
  std::optional<double> optional_number(const Element& e, const char* attribute) const;
  // The numbers of an attribute, or nullopt when it is missing.
  std::optional<std::vector<double>> numbers(const Element& e, const char* attribute) const;
  // The same, count of them.
  std::optional<std::vector<double>> numbers(const Element& e, const char* attribute, size_t count) const;
  std::optional<std::array<double, 3>> vector3(const Element& e, const char* attribute) const;

  // The first child of this name, or nullptr; more of them are reported.
  const Element* only(const Element& e, const char* child) const;
  // Everything that stands in e and is not named here goes into the report: as dropped physics or as something harmless.
  void unread(const Element& e, std::initializer_list<std::string_view> attributes,
              std::initializer_list<std::string_view> children, bool physics = true) const;

  [[noreturn]] void bad_numbers(const Element& e, const char* attribute, const std::string& what) const;

  // Rotation and translation of e's <origin>; the identity when there is none.
  Placement origin(const Element& e, bool physics = true) const;
};

}  // namespace dyn::load
