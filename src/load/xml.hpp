// Well-formed XML of bearable size, with line numbers.
#pragma once

#include <tinyxml2.h>

#include <string>

#include "report.hpp"

namespace dyn::load {

using Element = tinyxml2::XMLElement;

inline constexpr size_t max_file_bytes = size_t(128) << 20;

// One pass over the text, before any parser sees it: refuses what parsers choke on (a document type with its entities,
// zero bytes, nesting, sizes), and what only xacro understands. Throws through report.
void check_xml(const std::string& text, const Report& report);

// Name of the first element, or "" when there is none: what kind of file this is.
std::string root_element(const std::string& text);

// The parsed document; check_xml first.
class Document {
 public:
  Document(const std::string& text, const Report& report);
  const Element& root() const { return *xml_.RootElement(); }
  Element& root() { return *xml_.RootElement(); }

 private:
  tinyxml2::XMLDocument xml_;
};

// First element child with this name, or nullptr; next one with the same name.
inline const Element* first(const Element& e, const char* name = nullptr) { return e.FirstChildElement(name); }
inline const Element* next(const Element& e, const char* name = nullptr) { return e.NextSiblingElement(name); }
inline int line(const Element& e) { return e.GetLineNum(); }

}  // namespace dyn::load
