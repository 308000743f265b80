// OBJ: vertices with their colours, polygons, and the diffuse colours of materials.
#include <charconv>
#include <map>
#include <optional>

#include "mesh.hpp"
#include "mesh_soup.hpp"
#include "number.hpp"

namespace dyn::load {

namespace {

constexpr std::uint64_t max_mtl_bytes = std::uint64_t(16) << 20;

// Calls f(words, line) for each line that holds words; a backslash joins it to the next. Stops where f returns false.
template <class F>
void for_each_line(std::string_view text, const F& f) {
  std::string joined;
  int line = 1;
  for (std::size_t at = 0; at < text.size();) {
    joined.clear();
    std::string_view words;
    const int begin = line;
    for (bool more = true; more && at < text.size();) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      words = text.substr(at, end - at);
      at = end + 1, ++line;
      if (words.ends_with('\r')) words.remove_suffix(1);
      more = words.ends_with('\\');
      if (more) words.remove_suffix(1);
      if (more || !joined.empty()) joined.append(words).append(" ");
    }
    if (!joined.empty()) words = joined;
    words = words.substr(0, words.find('#'));
    if (const auto parts = split(words); !parts.empty()) f(parts, begin);
  }
}

using Parts = std::vector<std::string_view>;
using Materials = std::map<std::string, std::optional<Rgb>, std::less<>>;

// The rest of a line from a word on: names may have blanks.
std::string rest(const Parts& parts) {
  return parts.size() < 2
             ? ""
             : std::string(parts[1].data(), std::size_t(parts.back().data() + parts.back().size() - parts[1].data()));
}

// A file that is missing or damaged gives no colours: they only affect looks. White is the factor of a texture.
void read_mtl(const std::string& name, const Report& report, Materials& out) {
  std::string text;
  try {
    text = read_beside(report, name, max_mtl_bytes);
  } catch (const Error&) {
    return;
  }
  std::optional<Rgb>* material = nullptr;
  bool texture = false;
  const auto finish = [&] {
    if (material && texture && *material == Rgb{1, 1, 1}) material->reset();
    texture = false;
  };
  for_each_line(text, [&](const Parts& parts, int) {
    if (parts[0] == "newmtl") {
      finish();
      material = &out[rest(parts)];
    } else if (parts[0] == "map_Kd") {
      texture = true;
    } else if (material && parts[0] == "Kd" && parts.size() >= 4) {
      Rgb c{};
      for (std::size_t k = 0; k < 3; ++k)
        if (!parse_number(parts[k + 1], c[k]).empty()) return;
      *material = c;
    }
  });
  finish();
}

struct Obj {
  const Report& report;
  Soup out = {};
  std::vector<Rgb> colours = {};  // of the vertices; white: none
  bool coloured = false;

  void vertex(const Parts& parts, int line) {
    if (parts.size() < 4)
      report.fail(DYN_ERROR_PARSE, line, "a vertex has " + std::to_string(parts.size() - 1) + " numbers, and needs 3");
    for (std::size_t k = 1; k <= 3; ++k) out.vertices.push_back(mesh_number(parts[k], "vertex", line, report));
    Rgb c = {1, 1, 1};
    if (parts.size() >= 7) {
      coloured = true;
      for (std::size_t k = 0; k < 3; ++k) c[k] = mesh_number(parts[k + 4], "colour of a vertex", line, report);
    }
    colours.push_back(c);
  }

  // The vertex of "7", "7/2", "7//3" or "7/2/3"; -1 is the last one so far.
  std::int32_t corner(std::string_view word, std::int64_t so_far, int line) const {
    const std::string_view digits = word.substr(0, word.find('/'));
    std::int64_t i = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), i);
    const std::int64_t count = out.vertex_count(), at = i < 0 ? so_far + i : i - 1;
    if (error != std::errc() || end != digits.data() + digits.size() || at < 0 || at >= count)
      report.fail(
          DYN_ERROR_PARSE, line,
          "corner " + in_quotes(std::string(word.substr(0, 60))) + " is not one of the " + std::to_string(count) + " vertices");
    return std::int32_t(at);
  }

  void face(const std::vector<std::int32_t>& corners, const std::optional<Rgb>& material) {
    check_mesh_size(0, out.triangle_count() + std::int64_t(corners.size()), report);
    std::size_t t = out.triangles.size();
    add_polygon(out.vertices, corners, out.triangles);
    for (; t < out.triangles.size(); t += 3) {
      if (!material && !coloured) {
        out.colours.push_back(0);
        continue;
      }
      Rgb c = material.value_or(Rgb{1, 1, 1});
      for (std::size_t k = 0; k < 3; ++k) {
        double sum = 0;
        for (std::size_t i = t; i < t + 3; ++i) sum += colours[std::size_t(out.triangles[i])][k];
        c[k] *= sum / 3;
      }
      out.colours.push_back(packed_rgb(c));
    }
  }
};

}  // namespace

Soup read_obj(std::string_view text, const Report& report) {
  Obj obj{report};
  Materials materials;
  for_each_line(text, [&](const Parts& parts, int line) {
    if (parts[0] == "v")
      check_mesh_size(obj.out.vertex_count() + 1, 0, report), obj.vertex(parts, line);
    else if (parts[0] == "mtllib")
      read_mtl(rest(parts), report, materials);
  });
  if (obj.out.vertices.empty()) report.fail(DYN_ERROR_PARSE, 0, "this is not an OBJ: it has no vertex ('v')");
  // faces may name vertices that come later
  std::int64_t so_far = 0;
  std::optional<Rgb> material;
  std::vector<std::int32_t> corners;
  for_each_line(text, [&](const Parts& parts, int line) {
    if (parts[0] == "v") ++so_far;
    if (parts[0] == "usemtl") {
      const auto known = materials.find(rest(parts));
      material = known == materials.end() ? std::nullopt : known->second;
    }
    if (parts[0] != "f" && parts[0] != "l" && parts[0] != "p") return;
    corners.clear();
    for (std::size_t k = 1; k < parts.size(); ++k) corners.push_back(obj.corner(parts[k], so_far, line));
    if (parts[0] == "f" && corners.size() >= 3)
      obj.face(corners, material);
    else if (parts[0] == "l" && corners.size() >= 2)
      obj.out.skipped += std::int64_t(corners.size()) - 1;
    else
      obj.out.skipped += std::int64_t(parts[0] == "p" ? corners.size() : 1);
  });
  return std::move(obj.out);
}

}  // namespace dyn::load
