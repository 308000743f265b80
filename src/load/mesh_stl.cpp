// STL: binary (80 bytes, a count, 50 bytes a triangle) and ASCII.
#include <algorithm>
#include <charconv>

#include "mesh.hpp"
#include "mesh_soup.hpp"
#include "words.hpp"

namespace dyn::load {

namespace {

bool is_word(std::string_view word, std::string_view lower) {
  return word.size() == lower.size() && std::equal(word.begin(), word.end(), lower.begin(), [](char a, char b) {
           return (a >= 'A' && a <= 'Z' ? char(a - 'A' + 'a') : a) == b;
         });
}

// 5 bits a channel, where bit 15 is set.
std::uint32_t facet_colour(std::uint16_t x) {
  if (!(x & 0x8000u)) return 0;
  return packed_rgb({(x >> 10 & 31u) / 31.0, (x >> 5 & 31u) / 31.0, (x & 31u) / 31.0});
}

// Programs write decimal numbers: those of up to seven digits are restored exactly.
double from_decimal(float x) {
  char digits[32];
  const char* end = std::to_chars(digits, digits + sizeof digits, x).ptr;
  double value = x;
  std::from_chars(digits, end, value);
  return value;
}

Soup read_binary(std::string_view bytes) {
  Soup out;
  const std::size_t count = (bytes.size() - 84) / 50;
  out.vertices.reserve(9 * count), out.triangles.reserve(3 * count), out.colours.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    const char* facet = bytes.data() + 84 + 50 * t;
    for (std::size_t k = 0; k < 9; ++k) out.vertices.push_back(from_decimal(little_endian<float>(facet + 12 + 4 * k)));
    for (std::size_t k = 0; k < 3; ++k) out.triangles.push_back(std::int32_t(3 * t + k));
    out.colours.push_back(facet_colour(little_endian<std::uint16_t>(facet + 48)));
  }
  return out;
}

Soup read_ascii(std::string_view text, const Report& report) {
  Soup out;
  Words words(text);
  std::size_t corners = 0;  // of this facet
  for (std::string_view w = words.next(); !w.empty(); w = words.next()) {
    if (is_word(w, "solid") || is_word(w, "endsolid")) {
      words.skip_line();  // a name
    } else if (is_word(w, "vertex")) {
      for (int k = 0; k < 3; ++k) out.vertices.push_back(mesh_number(words.next(), "vertex", words.line(), report));
      ++corners;
    } else if (is_word(w, "endfacet")) {
      if (corners != 3)
        report.fail(DYN_ERROR_PARSE, words.line(), "a facet has " + std::to_string(corners) + " vertices, and a triangle has 3");
      check_mesh_size(out.vertex_count(), out.triangle_count() + 1, report);
      for (std::int32_t k = 3; k > 0; --k) out.triangles.push_back(std::int32_t(out.vertex_count()) - k);
      out.colours.push_back(0);
      corners = 0;
    }
  }
  if (corners != 0) report.fail(DYN_ERROR_PARSE, words.line(), "the last facet has no 'endfacet': the file is cut off");
  return out;
}

}  // namespace

Soup read_stl(std::string_view bytes, const Report& report) {
  const bool binary =
      bytes.size() >= 84 && bytes.size() == 84 + std::size_t(50) * little_endian<std::uint32_t>(bytes.data() + 80);
  return binary ? read_binary(bytes) : read_ascii(bytes, report);
}

}  // namespace dyn::load
