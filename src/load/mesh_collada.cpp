// COLLADA: polygons and their diffuse colours, placed by the nodes of the scene. Other libraries are not opened.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <unordered_map>

#include "mesh_soup.hpp"
#include "words.hpp"
#include "xml.hpp"

namespace dyn::load {

namespace {

// Elements of nodes that are visited: nodes refer to one another, so that a short file may have any number of paths.
constexpr int max_visited = 5000000;
constexpr std::size_t max_transform = 4096;              // characters
constexpr int max_stride = 64;                           // inputs of a polygon's corner, numbers of a source's element
constexpr double radian = 3.14159265358979323846 / 180;  // of a degree

std::string text_of(const Element& e) {
  std::string out;
  for (const tinyxml2::XMLNode* n = e.FirstChild(); n; n = n->NextSibling())
    if (n->ToText()) out += n->Value();
  return out;
}

// Numbers of a source: element i has component k at values[offset + stride i + at[k]].
struct Source {
  std::shared_ptr<const std::vector<double>> values;
  std::int64_t count = 0, offset = 0, stride = 1;
  std::int64_t at[3] = {0, 1, 2};

  double number(std::int64_t i, int k) const { return (*values)[std::size_t(offset + stride * i + at[k])]; }
};

// The triangles of a <geometry> in its own frame, and what its materials are called.
struct Geometry {
  Soup soup;
  std::vector<std::string> symbols;   // of its primitives
  std::vector<std::uint16_t> symbol;  // of each triangle
  std::vector<Rgb> factors;           // of each triangle: the mean of its corners' colours; none: all are white
};

struct Collada {
  const Report& report;
  std::unordered_map<std::string_view, const Element*> ids = {};
  std::unordered_map<const Element*, std::shared_ptr<const std::vector<double>>> arrays = {};
  std::unordered_map<const Element*, Geometry> geometries = {};
  std::unordered_map<const Element*, Source> sources = {};
  std::unordered_map<const Element*, std::optional<Rgb>> materials = {};
  std::int64_t all_vertices = 0;  // of all geometries
  int visited = 0;

  [[noreturn]] void fail(const Element& e, const std::string& message, dynStatus status = DYN_ERROR_PARSE) const {
    report.fail(status, line(e), "<" + std::string(e.Name()).substr(0, 60) + ">" + message);
  }

  void index(const Element& e) {
    if (const char* id = e.Attribute("id")) ids.try_emplace(id, &e);
    for (const Element* c = first(e); c; c = next(*c)) index(*c);
  }

  const Element& child(const Element& e, const char* name) const {
    const Element* c = first(e, name);
    if (!c) fail(e, " has no <" + std::string(name) + ">");
    return *c;
  }

  // The element that an attribute refers to: "#its id".
  const Element* refers(const Element& e, const char* attribute) const {
    const char* url = e.Attribute(attribute);
    if (!url || *url != '#') fail(e, " has no " + std::string(attribute) + "=\"#...\" of an element of this file");
    const auto at = ids.find(url + 1);
    return at == ids.end() ? nullptr : at->second;
  }
  const Element& target(const Element& e, const char* attribute, std::string_view kind) const {
    const Element* t = refers(e, attribute);
    if (!t || t->Name() != kind)
      fail(e, " " + std::string(attribute) + "=" + in_quotes(e.Attribute(attribute)) + ": there is no <" + std::string(kind) +
                  "> of this id");
    return *t;
  }

  std::int64_t whole(const Element& e, const char* attribute, std::int64_t most,
                     std::optional<std::int64_t> otherwise = {}) const {
    const char* text = e.Attribute(attribute);
    if (!text && otherwise) return *otherwise;
    if (!text) fail(e, " has no attribute " + std::string(attribute));
    std::int64_t x = -1;
    const std::string_view digits = Words(text).next();
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
    if (error != std::errc() || end != digits.data() + digits.size() || x < 0 || x > most)
      fail(e, " " + std::string(attribute) + "=" + in_quotes(text) + ": a whole number from 0 to " + std::to_string(most) +
                  " is expected");
    return x;
  }

  std::vector<double> numbers(const Element& e, std::size_t count) const {
    const std::string text = text_of(e);
    if (text.size() > max_transform) fail(e, " has more than " + std::to_string(max_transform) + " characters", DYN_ERROR_LIMIT);
    Words words(text, line(e));
    std::vector<double> out;
    for (std::size_t k = 0; k < count; ++k)
      out.push_back(mesh_number(words.next(), (std::string("<") + e.Name() + ">").c_str(), words.line(), report));
    if (!words.next().empty()) fail(e, " has more than " + std::to_string(count) + " numbers");
    return out;
  }

  // ------------------------------------------------------------------------------------------------ sources

  std::shared_ptr<const std::vector<double>> array(const Element& e) {
    auto& known = arrays[&e];
    if (known) return known;
    const std::string text = text_of(e);
    const std::int64_t stated = whole(e, "count", std::int64_t(1) << 40);
    auto out = std::make_shared<std::vector<double>>();
    out->reserve(std::size_t(std::min<std::int64_t>(stated, std::int64_t(text.size() / 2) + 1)));
    Words words(text, line(e));
    for (std::string_view w = words.next(); !w.empty(); w = words.next())
      out->push_back(mesh_number(w, "<float_array>", words.line(), report));
    if (std::int64_t(out->size()) != stated)
      fail(e, " states a count of " + std::to_string(stated) + ", and holds " + std::to_string(out->size()) + " numbers");
    return known = out;
  }

  // names: of the components, as "XYZ"
  const Source& source(const Element& e, const char* names) {
    const auto [known, added] = sources.try_emplace(&e);
    Source& s = known->second;
    if (!added) return s;
    const Element& accessor = child(child(e, "technique_common"), "accessor");
    s.values = array(target(accessor, "source", "float_array"));
    const std::int64_t size = std::int64_t(s.values->size());
    s.count = whole(accessor, "count", size), s.offset = whole(accessor, "offset", size, 0);
    s.stride = whole(accessor, "stride", max_stride, 1);
    std::int64_t at = 0;
    for (const Element* p = first(accessor, "param"); p && at < s.stride; p = next(*p, "param"), ++at)
      if (const char* name = p->Attribute("name"))
        for (int k = 0; k < 3; ++k)
          if (name[0] == names[k] && !name[1]) s.at[k] = at;
    for (const std::int64_t k : s.at)
      if (k >= s.stride) fail(accessor, " has a stride of " + std::to_string(s.stride) + ": three numbers are needed");
    if (s.count > 0 && s.offset + s.stride * s.count > size)
      fail(accessor, " states " + std::to_string(s.count) + " elements of " + std::to_string(s.stride) +
                         " numbers, and its array has " + std::to_string(size) + " numbers");
    return s;
  }

  // ------------------------------------------------------------------------------------------------ polygons

  struct Inputs {
    std::int64_t stride = 1;
    std::optional<std::int64_t> vertex, colour;  // their offsets
    Source colours = {};
  };

  Inputs inputs(const Element& primitive, const Element& vertices) {
    Inputs in;
    for (const Element* i = first(primitive, "input"); i; i = next(*i, "input")) {
      const std::string semantic = attribute(*i, "semantic");
      const std::int64_t offset = whole(*i, "offset", max_stride - 1);
      in.stride = std::max(in.stride, offset + 1);
      if (semantic == "VERTEX" && &target(*i, "source", "vertices") == &vertices) in.vertex = offset;
      if (semantic == "COLOR" && !in.colour) in.colour = offset, in.colours = source(target(*i, "source", "source"), "RGB");
    }
    if (!in.vertex) fail(primitive, " has no <input semantic=\"VERTEX\"> of the vertices of its mesh");
    return in;
  }

  // One corner's indices, one after the other. Returns false at the end.
  struct Indices {
    const Collada& reader;
    const Element& e;
    const Inputs& in;
    std::int64_t vertices;
    std::string text = text_of(e);
    Words words = Words(text, line(e));

    bool next(std::int32_t& vertex, std::int32_t& colour) {
      for (std::int64_t k = 0; k < in.stride; ++k) {
        const std::string_view w = words.next();
        if (w.empty()) {
          if (k > 0) reader.fail(e, " ends within a corner of " + std::to_string(in.stride) + " indices");
          return false;
        }
        std::int64_t i = -1;
        const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), i);
        if (error != std::errc() || end != w.data() + w.size())
          reader.report.fail(DYN_ERROR_PARSE, words.line(),
                             "<p>: " + in_quotes(std::string(w.substr(0, 60))) + " is not an index");
        const auto check = [&](std::int64_t count, const char* what) {
          if (i < 0 || i >= count)
            reader.report.fail(DYN_ERROR_PARSE, words.line(),
                               "<p>: index " + std::to_string(i) + " is not one of the " + std::to_string(count) + what);
        };
        if (k == *in.vertex) check(vertices, " vertices"), vertex = std::int32_t(i);
        if (in.colour && k == *in.colour) check(in.colours.count, " colours"), colour = std::int32_t(i);
      }
      return true;
    }
  };

  // corners, colours: of a polygon. Its triangles have the mean colour of their corners.
  void add(const Inputs& in, const std::vector<std::int32_t>& corners, const std::vector<std::int32_t>& colours, Geometry& g) {
    if (corners.size() < 3) return void(++g.soup.skipped);
    check_mesh_size(0, g.soup.triangle_count() + std::int64_t(corners.size()), report);
    std::size_t t = g.soup.triangles.size();
    add_polygon(g.soup.vertices, corners, g.soup.triangles);
    std::unordered_map<std::int32_t, std::int32_t> colour;  // of the corners
    for (std::size_t k = 0; in.colour && k < corners.size(); ++k) colour.emplace(corners[k], colours[k]);
    for (; t < g.soup.triangles.size(); t += 3) {
      g.symbol.push_back(std::uint16_t(g.symbols.size() - 1));
      if (!in.colour) continue;
      g.factors.resize(t / 3, Rgb{1, 1, 1});  // of those before
      Rgb mean{};
      for (std::size_t k = 0; k < 3; ++k)
        for (int c = 0; c < 3; ++c) mean[std::size_t(c)] += in.colours.number(colour[g.soup.triangles[t + k]], c) / 3;
      g.factors.push_back(mean);
    }
  }

  void add_primitive(const Element& e, const Element& vertices, std::int64_t count, Geometry& g) {
    const std::string_view kind = e.Name();
    const bool lines = kind == "lines" || kind == "linestrips";
    const bool strips = kind == "tristrips", fans = kind == "trifans";
    if (!lines && !strips && !fans && kind != "triangles" && kind != "polylist" && kind != "polygons") return;
    const std::int64_t stated = whole(e, "count", std::int64_t(1) << 40);
    if (stated == 0 && !first(e, "p")) return;
    if (lines) return void(g.soup.skipped += std::min<std::int64_t>(stated, 1 << 24));
    const Inputs in = inputs(e, vertices);
    if (g.symbols.size() > UINT16_MAX) fail(e, " is the 65537th of its <mesh>", DYN_ERROR_LIMIT);
    g.symbols.push_back(attribute(e, "material"));
    if (const Element* holes = first(e, "ph")) fail(*holes, ": polygons with holes are not supported", DYN_ERROR_UNSUPPORTED);

    std::int64_t made = 0;
    const std::string sizes_text = kind == "polylist" ? text_of(child(e, "vcount")) : "";
    Words sizes(sizes_text);
    std::vector<std::int32_t> corners, colours;
    for (const Element* p = first(e, "p"); p; p = next(*p, "p")) {
      Indices indices{*this, *p, in, count};
      std::int32_t vertex = 0, colour = 0;
      corners.clear(), colours.clear();
      const auto finish = [&] { add(in, corners, colours, g), corners.clear(), colours.clear(), ++made; };
      if (kind == "polylist") {
        for (std::string_view w = sizes.next(); !w.empty(); w = sizes.next()) {
          std::int64_t n = -1;
          const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), n);
          if (error != std::errc() || end != w.data() + w.size() || n < 0)
            fail(e, ": <vcount> holds " + in_quotes(std::string(w.substr(0, 60))) + ", which is no number of corners");
          for (std::int64_t k = 0; k < n; ++k) {
            if (!indices.next(vertex, colour)) fail(e, ": <vcount> asks for more corners than <p> holds");
            corners.push_back(vertex), colours.push_back(colour);
          }
          finish();
        }
        if (indices.next(vertex, colour)) fail(e, ": <p> holds more corners than <vcount> asks for");
        break;
      }
      while (indices.next(vertex, colour)) {
        corners.push_back(vertex), colours.push_back(colour);
        const std::size_t n = corners.size();
        if (kind == "triangles" && n == 3) finish();
        if ((strips || fans) && n == 3) {
          const std::vector<std::int32_t> c = corners, k = colours;
          const bool odd = strips && (made++ & 1);
          odd ? add(in, {c[1], c[0], c[2]}, {k[1], k[0], k[2]}, g) : add(in, c, k, g);
          corners = {fans ? c[0] : c[1], c[2]}, colours = {fans ? k[0] : k[1], k[2]};
        }
      }
      if (strips || fans)
        made = 0;
      else if (kind == "polygons")
        finish();
      else if (!corners.empty())
        fail(*p, " ends within a triangle");
    }
    if (!strips && !fans && made != stated)
      fail(e, " states a count of " + std::to_string(stated) + ", and holds " + std::to_string(made) + " polygons");
  }

  const Geometry& geometry(const Element& e) {
    const auto [at, added] = geometries.try_emplace(&e);
    Geometry& g = at->second;
    const Element* mesh = first(e, "mesh");
    if (!added || !mesh) return g;  // splines and the like have no polygons
    const Element* v = first(*mesh, "vertices");
    if (!v) return g;
    const Element* position = nullptr;
    for (const Element* i = first(*v, "input"); i && !position; i = next(*i, "input"))
      if (attribute(*i, "semantic") == "POSITION") position = i;
    if (!position) fail(*v, " has no <input semantic=\"POSITION\">");
    const Source points = source(target(*position, "source", "source"), "XYZ");
    check_mesh_size(all_vertices += points.count, 0, report);
    for (std::int64_t i = 0; i < points.count; ++i)
      for (int k = 0; k < 3; ++k) g.soup.vertices.push_back(points.number(i, k));
    for (const Element* p = first(*mesh); p; p = next(*p)) add_primitive(*p, *v, points.count, g);
    if (!g.factors.empty()) g.factors.resize(g.symbol.size(), Rgb{1, 1, 1});
    return g;
  }

  // ------------------------------------------------------------------------------------------------ materials

  // The diffuse colour of a material; textures are not read.
  std::optional<Rgb> diffuse(const Element* material) {
    if (!material || material->Name() != std::string_view("material")) return {};
    const auto [at, added] = materials.try_emplace(material);
    return added ? at->second = read_diffuse(material) : at->second;
  }
  std::optional<Rgb> read_diffuse(const Element* material) const {
    const Element* instance = first(*material, "instance_effect");
    const Element* e = instance ? refers(*instance, "url") : nullptr;
    for (const char* step : {"profile_COMMON", "technique"}) e = e ? first(*e, step) : nullptr;
    for (const Element* shader = e ? first(*e) : nullptr; shader; shader = next(*shader))
      if (const Element* d = first(*shader, "diffuse"))
        if (const Element* color = first(*d, "color")) {
          const std::string text = text_of(*color);
          Words words(text, line(*color));
          Rgb c;
          for (double& x : c) x = mesh_number(words.next(), "<color>", words.line(), report);
          return c;
        }
    return {};
  }

  const Element* by_id(const std::string& id) const {
    const auto at = ids.find(id);
    return at == ids.end() ? nullptr : at->second;
  }

  // The colours of a geometry's symbols where a node places it.
  std::vector<std::optional<Rgb>> colours_of(const Element& instance, const Geometry& g) {
    std::unordered_map<std::string, const Element*> bound;
    const Element* b = first(instance, "bind_material");
    const Element* common = b ? first(*b, "technique_common") : nullptr;
    for (const Element* m = common ? first(*common, "instance_material") : nullptr; m; m = next(*m, "instance_material"))
      visit(*m), bound[attribute(*m, "symbol")] = refers(*m, "target");
    std::vector<std::optional<Rgb>> out;
    for (const std::string& symbol : g.symbols) {
      visit(instance);
      const auto at = bound.find(symbol);
      out.push_back(diffuse(at != bound.end() ? at->second : by_id(symbol)));
    }
    return out;
  }

  // ------------------------------------------------------------------------------------------------ nodes

  void visit(const Element& e) {
    if (++visited > max_visited)
      fail(e, ": more than " + std::to_string(max_visited) + " parts of the scene, which is the limit: does a node hold itself?",
           DYN_ERROR_LIMIT);
  }

  Affine transform(const Element& e) const {
    const std::string_view kind = e.Name();
    Affine X;
    if (kind == "matrix") {
      const std::vector<double> m = numbers(e, 16);
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) X.A[r][c] = m[std::size_t(4 * r + c)];
        X.p[r] = m[std::size_t(4 * r + 3)];
      }
    } else if (kind == "translate") {
      const std::vector<double> t = numbers(e, 3);
      for (int r = 0; r < 3; ++r) X.p[r] = t[std::size_t(r)];
    } else if (kind == "scale") {
      const std::vector<double> s = numbers(e, 3);
      for (int r = 0; r < 3; ++r) X.A[r][r] = s[std::size_t(r)];
    } else if (kind == "rotate") {
      const std::vector<double> a = numbers(e, 4);
      const double n = std::hypot(a[0], a[1], a[2]), angle = a[3] * radian, c = std::cos(angle), s = std::sin(angle);
      if (angle == 0) return X;
      if (!(n > 0)) fail(e, " has a zero axis");
      const double u[3] = {a[0] / n, a[1] / n, a[2] / n};
      for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 3; ++k) X.A[r][k] = (1 - c) * u[r] * u[k] + (r == k ? c : 0);
      for (int r = 0; r < 3; ++r) {
        X.A[(r + 1) % 3][r] += s * u[(r + 2) % 3];
        X.A[r][(r + 1) % 3] -= s * u[(r + 2) % 3];
      }
    } else if (kind == "lookat" || kind == "skew") {
      fail(e, " of a node is not supported: give <matrix>", DYN_ERROR_UNSUPPORTED);
    }
    return X;
  }

  void place(const Element& instance, const Element& e, const Affine& X, Soup& out) {
    const Geometry& g = geometry(e);
    Soup part;
    part.colours.reserve(g.symbol.size());
    const std::vector<std::optional<Rgb>> colours = colours_of(instance, g);
    for (std::size_t t = 0; t < g.symbol.size(); ++t) {
      const std::optional<Rgb>& c = colours[g.symbol[t]];
      if (!c && g.factors.empty()) {
        part.colours.push_back(0);
        continue;
      }
      Rgb sum = c.value_or(Rgb{1, 1, 1});
      for (std::size_t k = 0; k < 3 && !g.factors.empty(); ++k) sum[k] *= g.factors[t][k];
      part.colours.push_back(packed_rgb(sum));
    }
    const std::size_t first_colour = out.colours.size();
    add_placed(g.soup, X, out, report);
    out.colours.resize(first_colour);
    out.colours.insert(out.colours.end(), part.colours.begin(), part.colours.end());
  }

  Soup scene(const Element& root, Affine X) {
    const Element& instance = child(child(root, "scene"), "instance_visual_scene");
    struct Placed {
      const Element* node;
      Affine X;
    };
    std::vector<Placed> todo = {{&target(instance, "url", "visual_scene"), X}};
    Soup out;
    while (!todo.empty()) {
      const Placed at = todo.back();
      todo.pop_back();
      Affine Y = at.X;
      std::vector<const Element*> inside;
      for (const Element* c = first(*at.node); c; c = next(*c)) {
        const std::string_view kind = c->Name();
        visit(*c);
        Y = Y * transform(*c);
        if (kind == "node") inside.push_back(c);
        if (kind == "instance_node") inside.push_back(&target(*c, "url", "node"));
        if (kind == "instance_geometry") place(*c, target(*c, "url", "geometry"), Y, out);
        if (kind == "instance_controller")  // a skin, undeformed
          if (const Element* skin = first(target(*c, "url", "controller"), "skin"))
            if (const Element* of = refers(*skin, "source"); of && of->Name() == std::string_view("geometry"))
              place(*c, *of, Y, out);
      }
      for (auto n = inside.rbegin(); n != inside.rend(); ++n) todo.push_back({*n, Y});
    }
    return out;
  }
};

// y = A x that takes the file's up axis to z, as its readers turn it: X_UP stands on its side first.
Affine upright(const std::string& axis) {
  if (axis == "Z_UP") return {};
  if (axis == "X_UP") return y_to_z * Affine{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}, {0, 0, 0}};
  return y_to_z;
}

}  // namespace

Soup read_collada(const std::string& text, bool up_z, const Report& report) {
  check_xml(text, report);
  const Document document(text, report);
  const Element& root = document.root();
  if (root.Name() != std::string_view("COLLADA"))
    report.fail(DYN_ERROR_PARSE, line(root), "this is not COLLADA: its root is <" + std::string(root.Name()).substr(0, 60) + ">");
  Collada reader{report};
  reader.index(root);
  Affine X;
  double metre = 1;
  std::string up = "Y_UP";
  if (const Element* asset = first(root, "asset")) {
    if (const Element* unit = first(*asset, "unit"); unit && unit->Attribute("meter"))
      metre = mesh_number(Words(unit->Attribute("meter")).next(), "<unit meter>", line(*unit), report);
    if (!(metre > 0))
      report.fail(DYN_ERROR_INVALID, line(*asset), "<unit meter> is " + dyn::load::text(metre) + ": give a positive number");
    if (const Element* axis = first(*asset, "up_axis")) {
      const std::string name = text_of(*axis);
      up = std::string(Words(name).next());
    }
  }
  for (int k = 0; k < 3; ++k) X.A[k][k] = metre;
  return reader.scene(root, up_z ? upright(up) * X : X);
}

}  // namespace dyn::load
