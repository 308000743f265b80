// Well-formed XML of bounded size, with line numbers.
#pragma once

#include <tinyxml2.h>

#include <string>

#include "file.hpp"

namespace dyn::load {

using Element = tinyxml2::XMLElement;

inline constexpr int max_depth = 80;           // of elements; tinyxml2 stops at 100, and real files stay below 20
inline constexpr int max_split_depth = 10010;  // of a text that split_deep divides

// Checks a text before parsing. Refuses document types with entities, zero bytes, excessive nesting and sizes, and xacro macros.
// Throws through the report. Returns an estimate of the memory that the text and its document take.
std::int64_t check_xml(const std::string& text, const Report& report, int deepest = max_depth);

// Divides a checked text that is nested deeper than the parser allows. Each element at a depth that is a multiple of 64 becomes a
// text of its own, with its line number, and <dyn:part n="its number"/> stands for it. The first text is the main one; a shallow
// text is alone.
inline constexpr const char* part_name = "dyn:part";
std::vector<std::string> split_deep(const std::string& text, const Report& report);

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
// Text of an attribute, or "" if it is missing.
inline std::string attribute(const Element& e, const char* name) { return e.Attribute(name) ? e.Attribute(name) : ""; }

}  // namespace dyn::load
