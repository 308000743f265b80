#include "xml.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "budget.hpp"

namespace dyn::load {

namespace {

constexpr int max_attributes = 64;        // of one element; parsers compare them pairwise
constexpr size_t max_elements = 5000000;  // about 1 GB in memory
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
constexpr std::string_view name_end = " \t\r\n/>";

// What xacro always replaces: the file did not run through it. Of a macro that it does not know it leaves the call.
bool is_xacro_definition(std::string_view element) {
  for (const std::string_view name : {"xacro:macro", "xacro:include", "xacro:property", "xacro:arg", "xacro:if", "xacro:unless",
                                      "xacro:insert_block", "xacro:call", "xacro:element", "xacro:attribute"})
    if (element == name) return true;
  return false;
}

// Scans the markup of a text: comments, declarations, tags.
struct Markup {
  enum Kind { end, other, doctype, open, close, unclosed };

  std::string_view text;
  size_t at = 0;     // position of the scan
  size_t begin = 0;  // start of the item found
  std::string_view name;
  int attributes = 0;
  bool empty = false;  // <a/>

  Kind past(std::string_view terminator, Kind kind) {
    const size_t found = text.find(terminator, at);
    if (found == text.npos) return unclosed;
    at = found + terminator.size();
    return kind;
  }

  Kind next() {
    begin = text.find('<', at);
    if (begin == text.npos) return end;
    at = begin + 1;
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("!--")) return at += 3, past("-->", other);
    if (rest.starts_with("![CDATA[")) return past("]]>", other);
    if (rest.starts_with("!")) return doctype;
    if (rest.starts_with("?")) return past("?>", other);
    if (rest.starts_with("/")) {
      name = rest.substr(1, rest.find_first_of(name_end, 1) - 1);
      return past(">", close);
    }
    return tag();
  }

  Kind tag() {
    name = text.substr(at, text.find_first_of(name_end, at) - at);
    attributes = 0;
    while ((at = text.find_first_of("\"'<>=", at)) != text.npos) {
      const char c = text[at++];
      if (c == '<') break;  // the next tag
      if (c == '>') {
        empty = text[at - 2] == '/';
        return open;
      }
      if (c == '=') {
        ++attributes;
      } else if ((at = text.find(c, at)) == text.npos) {
        break;  // an unclosed quote
      } else {
        ++at;
      }
    }
    at = text.size();
    return unclosed;
  }
};

// Returns whether the text begins with a reference such as "&#38;" or "&#x26;" to a character of XML 1.0.
bool good_reference(std::string_view text) {
  text = text.substr(0, std::min(text.find(';'), text.size() - 1) + 1);
  const bool hexadecimal = text.starts_with("&#x");
  const char *digits = text.data() + (hexadecimal ? 3 : 2), *last = text.data() + text.size() - 1;
  unsigned long c = 0;
  const auto [end, error] = std::from_chars(digits, last, c, hexadecimal ? 16 : 10);
  if (*last != ';' || end != last || end == digits || error != std::errc()) return false;
  return c == '\t' || c == '\n' || c == '\r' || (c >= 0x20 && c < 0xD800) || (c >= 0xE000 && c < 0xFFFE) ||
         (c >= 0x10000 && c < 0x110000);
}

std::string shown_name(std::string_view name) { return std::string(name.substr(0, 60)); }

int line_at(std::string_view text, size_t at) {
  return 1 + int(std::count(text.begin(), text.begin() + std::min(at, text.size()), '\n'));
}

}  // namespace

std::int64_t check_xml(const std::string& text, const Report& report, int deepest) {
  const auto fail = [&](dynStatus status, size_t at, const std::string& message) {
    report.fail(status, line_at(text, at), message);
  };
  if (text.size() > max_file_bytes)
    report.fail(DYN_ERROR_LIMIT, 0,
                std::to_string(text.size()) + " bytes, and the limit is " + std::to_string(max_file_bytes) + " bytes");
  if (const size_t zero = text.find('\0'); zero != text.npos) fail(DYN_ERROR_PARSE, zero, "zero byte: this is not a text file");

  // parsers truncate or misread invalid references
  const auto check_references = [&](size_t from, size_t to) {
    const std::string_view part = std::string_view(text).substr(from, to - from);
    for (size_t at = part.find("&#"); at != part.npos; at = part.find("&#", at + 2))
      if (!good_reference(part.substr(at)))
        fail(DYN_ERROR_PARSE, from + at,
             "'" + std::string(part.substr(at, std::min<size_t>(part.find(';', at) - at, 20) + 1)) +
                 "' is not a character of XML");
  };

  Markup m;
  m.text = text;
  size_t elements = 0, attributes = 0;
  struct Opened {
    size_t at;
    std::string_view name;
  };
  std::vector<Opened> opened;
  for (;;) {
    const size_t before = m.at;
    const Markup::Kind kind = m.next();
    check_references(before, std::min(m.begin, text.size()));
    switch (kind) {
      case Markup::end:
        if (!opened.empty())
          fail(DYN_ERROR_PARSE, opened.back().at,
               "<" + shown_name(opened.back().name) + "> is never closed: the file is cut off or an end tag is missing");
        return std::int64_t(2 * text.size()) + bytes_of_element * std::int64_t(elements) +
               bytes_of_attribute * std::int64_t(attributes);
      case Markup::other:
        break;
      case Markup::doctype:
        fail(DYN_ERROR_PARSE, m.begin, "document types and entities (<!...>) are not allowed: remove the declaration");
        break;
      case Markup::unclosed:
        fail(DYN_ERROR_PARSE, m.begin, "markup that begins here is never closed: the file is cut off or a quote is missing");
        break;
      case Markup::close:
        if (opened.empty()) fail(DYN_ERROR_PARSE, m.begin, "</" + shown_name(m.name) + "> closes nothing: remove it");
        if (m.name != opened.back().name)
          fail(DYN_ERROR_PARSE, m.begin, "</" + shown_name(m.name) + "> where <" + shown_name(opened.back().name) + "> of line " +
                                             std::to_string(line_at(text, opened.back().at)) + " is still open");
        opened.pop_back();
        break;
      case Markup::open:
        if (m.name.empty()) fail(DYN_ERROR_PARSE, m.begin, "malformed element: a name follows '<' at once");
        check_references(m.begin, m.at);
        attributes += size_t(m.attributes);
        if (++elements > max_elements)
          fail(DYN_ERROR_LIMIT, m.begin, "more than " + std::to_string(max_elements) + " elements, which is the limit");
        if (m.attributes > max_attributes)
          fail(DYN_ERROR_LIMIT, m.begin,
               "an element has more than " + std::to_string(max_attributes) + " attributes, which is the limit");
        if (is_xacro_definition(m.name))
          fail(DYN_ERROR_UNSUPPORTED, m.begin,
               "<" + shown_name(m.name) +
                   "> is a xacro macro: run xacro first (xacro FILE > robot.urdf) and load its output");
        if (m.empty) break;
        opened.push_back({m.begin, m.name});
        if (int(opened.size()) > deepest)
          fail(DYN_ERROR_LIMIT, m.begin,
               "elements are nested more than " + std::to_string(deepest) + " deep, which is the limit");
    }
  }
}

std::vector<std::string> split_deep(const std::string& text, const Report& report) {
  constexpr size_t part_depth = 64, max_lines = 10000000;  // lines of all parts, which are kept as empty ones
  struct Part {
    size_t number, from, begin;  // from: where the text goes on that no part has yet
  };
  std::vector<std::string> out(1);
  std::vector<Part> open = {{0, 0, 0}};
  size_t depth = 0, lines = 0;
  const auto pad = [&](size_t part, size_t n) {
    if ((lines += n) > max_lines)
      report.fail(DYN_ERROR_LIMIT, 0,
                  "too many lines for elements that are nested more than " + std::to_string(part_depth) + " deep");
    out[part].append(n, '\n');
  };
  Markup m;
  m.text = text;
  for (Markup::Kind kind = m.next(); kind != Markup::end; kind = m.next()) {
    if (kind == Markup::open && m.name == part_name)
      report.fail(DYN_ERROR_PARSE, line_at(text, m.begin), "<" + std::string(part_name) + "> is not an element of MJCF");
    if (kind == Markup::open && !m.empty && ++depth % part_depth == 0) {
      const size_t number = out.size();
      out[open.back().number].append(text, open.back().from, m.begin - open.back().from);
      out[open.back().number] += "<" + std::string(part_name) + " n=\"" + std::to_string(number) + "\"/>";
      out.emplace_back(), pad(number, size_t(line_at(text, m.begin)) - 1);
      open.push_back({number, m.begin, m.begin});
    }
    if (kind == Markup::close && depth-- % part_depth == 0) {
      const Part part = open.back();
      out[part.number].append(text, part.from, m.at - part.from);
      open.pop_back();
      pad(open.back().number,
          size_t(std::count(text.begin() + std::ptrdiff_t(part.begin), text.begin() + std::ptrdiff_t(m.at), '\n')));
      open.back().from = m.at;
    }
  }
  out[0].append(text, open[0].from);
  return out;
}

std::string root_element(const std::string& text) {
  Markup m;
  m.text = text;
  for (;;) {
    switch (m.next()) {
      case Markup::open:
        return std::string(m.name.substr(0, 100));
      case Markup::other:
        break;
      case Markup::doctype:
        m.past(">", Markup::other);
        break;
      default:
        return "";
    }
  }
}

Document::Document(const std::string& text, const Report& report) : xml_(true, tinyxml2::PRESERVE_WHITESPACE) {
  std::string_view body = text;
  if (body.starts_with(byte_order_mark)) body.remove_prefix(byte_order_mark.size());
  if (xml_.Parse(body.data(), body.size()) != tinyxml2::XML_SUCCESS) {
    const char* what = "malformed XML";
    switch (xml_.ErrorID()) {
      case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
        what = "no XML element";
        break;
      case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
        what = "an element is closed by another's end tag, or never";
        break;
      case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
        what = "malformed or repeated attribute";
        break;
      case tinyxml2::XML_ERROR_PARSING_ELEMENT:
        what = "malformed element";
        break;
      case tinyxml2::XML_ERROR_PARSING_TEXT:
        what = "malformed text, or an element that is never closed";
        break;
      case tinyxml2::XML_ERROR_PARSING_COMMENT:
        what = "malformed comment";
        break;
      case tinyxml2::XML_ERROR_PARSING_DECLARATION:
        what = "malformed or misplaced <?...?> declaration";
        break;
      case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
        report.fail(DYN_ERROR_LIMIT, xml_.ErrorLineNum(), "elements are nested too deep");
      default:
        break;
    }
    report.fail(DYN_ERROR_PARSE, xml_.ErrorLineNum(), what);
  }
  const Element* root = xml_.RootElement();
  if (!root) report.fail(DYN_ERROR_PARSE, 0, "no XML element");
  for (const tinyxml2::XMLNode* n = xml_.FirstChild(); n; n = n->NextSibling()) {
    const bool stray_text = n->ToText() && std::string_view(n->Value()).find_first_not_of(" \t\r\n") != std::string_view::npos;
    if (stray_text || (n->ToElement() && n != root))
      report.fail(DYN_ERROR_PARSE, n->GetLineNum(), "content outside the root element, which XML does not allow: remove it");
  }
}

}  // namespace dyn::load
