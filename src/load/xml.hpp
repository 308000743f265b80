// Well-formed XML of bounded size, with line numbers.
#pragma once

#include <tinyxml2.h>

#include <string>

#include "report.hpp"

namespace dyn::load {

using Element = tinyxml2::XMLElement;

inline constexpr size_t max_file_bytes = size_t(128) << 20;

// Checks a text before parsing. Refuses document types with entities, zero bytes, excessive nesting and sizes, and xacro macros.
// Throws through the report.
void check_xml(const std::string& text, const Report& report);

// Name of the first element, or "" if there is none.
std::string root_element(const std::string& text);

// The parsed document. Call check_xml first.
class Document {
 public:
  Document(const std::string& text, const Report& report);
  const Element& root() const { return *xml_.RootElement(); }
  Element& root() { return *xml_.RootElement(); }

 private:
  tinyxml2::XMLDocument xml_;
};

// First child element of this name, or null; next element of this name.
inline const Element* first(const Element& e, const char* name = nullptr) { return e.FirstChildElement(name); }
inline const Element* next(const Element& e, const char* name = nullptr) { return e.NextSiblingElement(name); }
inline int line(const Element& e) { return e.GetLineNum(); }

}  // namespace dyn::load
