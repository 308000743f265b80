// glTF 2.0, as text (.gltf) and binary (.glb): the triangles of the scene's nodes, and base colours.
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "json.hpp"
#include "mesh.hpp"
#include "mesh_soup.hpp"

namespace dyn::load {

namespace {

constexpr std::uint64_t max_buffers = std::uint64_t(1) << 30;  // bytes of all together
constexpr std::int64_t max_whole = std::int64_t(1) << 40;

std::string from_base64(std::string_view text, bool& good) {
  std::string out;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int x = c >= 'A' && c <= 'Z'   ? c - 'A'
                  : c >= 'a' && c <= 'z' ? c - 'a' + 26
                  : c >= '0' && c <= '9' ? c - '0' + 52
                  : c == '+'             ? 62
                  : c == '/'             ? 63
                                         : -1;
    if (x < 0) return good = false, out;
    bits = bits << 6 | std::uint32_t(x), count += 6;
    if (count >= 8) count -= 8, out += char(bits >> count & 255u);
  }
  return out;
}

// %20 and the like
std::string decoded(const std::string& uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const auto hex = [&](std::size_t k) { return k < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[k])); };
    if (uri[i] == '%' && hex(i + 1) && hex(i + 2))
      out += char(std::stoi(uri.substr(i + 1, 2), nullptr, 16)), i += 2;
    else
      out += uri[i];
  }
  return out;
}

// Linear light to sRGB: IEC 61966-2-1.
double from_linear(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

enum Component { Byte = 5120, UnsignedByte = 5121, Short = 5122, UnsignedShort = 5123, UnsignedInt = 5125, Float = 5126 };
std::int64_t size_of(std::int64_t component) {
  switch (component) {
    case Byte:
    case UnsignedByte:
      return 1;
    case Short:
    case UnsignedShort:
      return 2;
    case UnsignedInt:
    case Float:
      return 4;
  }
  return 0;
}

struct Accessor {
  std::int64_t count, component, stride;
  const char* data;
  bool normalized;
  int width;  // components of an element

  const char* at(std::int64_t i, int k) const { return data + i * stride + k * size_of(component); }
  double number(std::int64_t i, int k) const {
    if (component == Float) return little_endian<float>(at(i, k));
    return double(index(i, k)) / (normalized ? component == UnsignedByte ? 255 : 65535 : 1);
  }
  std::uint32_t index(std::int64_t i, int k = 0) const {
    return component == UnsignedByte    ? little_endian<std::uint8_t>(at(i, k))
           : component == UnsignedShort ? little_endian<std::uint16_t>(at(i, k))
                                        : little_endian<std::uint32_t>(at(i, k));
  }
};

struct Gltf {
  const Report& report;
  const Json& root;
  std::string_view chunk;  // the buffer of a binary file
  std::map<std::string_view, const Json*> sections = {};
  std::vector<std::string> buffers = {};
  std::vector<char> loaded = {};
  std::uint64_t bytes = 0;
  std::int64_t all_vertices = 0;  // of all meshes
  std::vector<std::optional<Soup>> meshes = {};

  [[noreturn]] void fail(const std::string& message, dynStatus status = DYN_ERROR_PARSE) const {
    report.fail(status, 0, message);
  }

  // ------------------------------------------------------------------------------------------------ values

  static std::string called(const char* kind, std::int64_t i) { return std::string(kind) + "[" + std::to_string(i) + "]"; }

  // A whole number from 0 to most; what names the object: "accessors[3]".
  std::int64_t whole(const Json& o, const char* key, std::int64_t most, const std::string& what,
                     std::optional<std::int64_t> otherwise = {}) const {
    const Json* x = o.find(key);
    if (!x && otherwise) return *otherwise;
    if (!x || x->kind != Json::Kind::Number || x->number != std::floor(x->number) ||
        !(x->number >= 0 && x->number <= double(most)))
      fail(what + "." + key + (x ? " is" : " is missing, and") + " no whole number from 0 to " + std::to_string(most));
    return std::int64_t(x->number);
  }
  const std::vector<Json>& list(const Json& o, const char* key, const std::string& what) const {
    static const std::vector<Json> none;
    const Json* x = o.find(key);
    if (!x) return none;
    if (x->kind != Json::Kind::Array) fail(what + "." + key + " is no array");
    return x->items;
  }
  const std::vector<Json>& section(const char* kind) const {
    static const std::vector<Json> none;
    const auto at = sections.find(kind);
    if (at == sections.end()) return none;
    if (at->second->kind != Json::Kind::Array) fail(std::string("its ") + kind + " are no array");
    return at->second->items;
  }
  // An element of a list of the file by its number, which another object states.
  const Json& item(const char* kind, std::int64_t i) const {
    const Json& x = section(kind)[std::size_t(i)];
    if (x.kind != Json::Kind::Object) fail(called(kind, i) + " is no object");
    return x;
  }
  std::int64_t count_of(const char* kind) const { return std::int64_t(section(kind).size()); }
  std::optional<std::int64_t> reference(const Json& o, const char* key, const char* kind, const std::string& what) const {
    if (!o.find(key)) return {};
    if (count_of(kind) == 0) fail(what + "." + key + ": the file has no " + kind);
    return whole(o, key, count_of(kind) - 1, what);
  }
  std::vector<double> numbers(const Json& o, const char* key, std::size_t count, const std::string& what) const {
    std::vector<double> out;
    for (const Json& x : list(o, key, what)) {
      if (x.kind != Json::Kind::Number) fail(what + "." + key + " holds something that is no number");
      out.push_back(x.number);
    }
    if (o.find(key) && out.size() != count)
      fail(what + "." + key + " has " + std::to_string(out.size()) + " numbers, and needs " + std::to_string(count));
    return out;
  }

  // ------------------------------------------------------------------------------------------------ buffers

  std::string_view buffer(std::int64_t i) {
    const std::string what = called("buffers", i);
    const Json& b = item("buffers", i);
    const std::int64_t length = whole(b, "byteLength", max_whole, what);
    const Json* uri = b.find("uri");
    if (!uri) {
      if (i != 0 || chunk.empty()) fail(what + " has no uri, and the file has no binary chunk for it");
      if (std::uint64_t(length) > chunk.size())
        fail(what + " states " + std::to_string(length) + " bytes, and the binary chunk has " + std::to_string(chunk.size()));
      return chunk;
    }
    buffers.resize(std::size_t(count_of("buffers"))), loaded.resize(buffers.size());
    std::string& out = buffers[std::size_t(i)];
    if (loaded[std::size_t(i)]) return out;
    loaded[std::size_t(i)] = 1;
    if (uri->kind != Json::Kind::String) fail(what + ".uri is no text");
    if (uri->text.starts_with("data:")) {
      const std::size_t comma = uri->text.find(";base64,");
      bool good = comma != uri->text.npos;
      if (good) out = from_base64(std::string_view(uri->text).substr(comma + 8), good);
      if (!good) fail(what + ".uri is not base64");
    } else {
      if (uri->text.find(':') != uri->text.npos) fail(what + ".uri is no file beside this one", DYN_ERROR_FILE);
      try {
        out = read_beside(report, decoded(uri->text), max_buffers - bytes);
      } catch (const Error& e) {
        fail(what + ": " + e.what(), e.status);
      }
    }
    if ((bytes += out.size()) > max_buffers)
      fail("its buffers have more than " + std::to_string(max_buffers) + " bytes, which is the limit", DYN_ERROR_LIMIT);
    if (std::uint64_t(length) > out.size())
      fail(what + " states " + std::to_string(length) + " bytes, and has " + std::to_string(out.size()) + ": it is cut off");
    return out;
  }

  // type: "VEC3" or "SCALAR"; or: another type that will do.
  Accessor accessor(std::int64_t i, const std::string& type, int width, const std::string& other = std::string()) {
    const std::string what = called("accessors", i);
    const Json& a = item("accessors", i);
    const Json* stated = a.find("type");
    const bool wider = stated && !other.empty() && stated->text == other;
    if (!stated || (stated->text != type && !wider)) fail(what + ".type is not " + type);
    if (a.find("sparse")) fail(what + " is sparse, which is not supported", DYN_ERROR_UNSUPPORTED);
    Accessor out{};
    out.count = whole(a, "count", max_whole, what), out.component = whole(a, "componentType", 65535, what);
    out.normalized = a.find("normalized") && a.find("normalized")->number != 0;
    out.width = wider ? width + 1 : width;
    const std::int64_t size = size_of(out.component) * out.width;
    if (size == 0) fail(what + ".componentType is unknown");
    const auto view = reference(a, "bufferView", "bufferViews", what);
    if (!view) fail(what + " has no bufferView (compressed meshes are not supported)", DYN_ERROR_UNSUPPORTED);
    const std::string which = called("bufferViews", *view);
    const Json& v = item("bufferViews", *view);
    const auto of = reference(v, "buffer", "buffers", which);
    if (!of) fail(which + " has no buffer");
    const std::string_view data = buffer(*of);
    const std::int64_t from = whole(v, "byteOffset", max_whole, which, 0), length = whole(v, "byteLength", max_whole, which),
                       offset = whole(a, "byteOffset", max_whole, what, 0);
    if (from + length > std::int64_t(data.size()))
      fail(which + " ends at byte " + std::to_string(from + length) + ", and its buffer has " + std::to_string(data.size()));
    out.stride = whole(v, "byteStride", 252, which, size);
    if (out.stride < size) fail(which + ".byteStride is less than an element of " + what);
    if (out.count > 0 && offset + (out.count - 1) * out.stride + size > length)
      fail(what + " states " + std::to_string(out.count) + " elements, and " + which + " has " + std::to_string(length) +
           " bytes");
    out.data = data.data() + from + offset;
    return out;
  }

  // ------------------------------------------------------------------------------------------------ meshes

  // sRGB, or none. White is the factor of a texture.
  std::optional<Rgb> base_colour(std::int64_t i) const {
    const std::string what = called("materials", i) + ".pbrMetallicRoughness";
    const Json* pbr = item("materials", i).find("pbrMetallicRoughness");
    if (!pbr) return {};
    const std::vector<double> f = numbers(*pbr, "baseColorFactor", 4, what);
    if (pbr->find("baseColorTexture") && (f.empty() || (f[0] == 1 && f[1] == 1 && f[2] == 1))) return {};
    return f.empty() ? Rgb{1, 1, 1} : Rgb{f[0], f[1], f[2]};
  }

  void add_primitive(const Json& p, const std::string& what, Soup& out) {
    const Json* attributes = p.find("attributes");
    if (!attributes) fail(what + " has no attributes");
    const auto position = reference(*attributes, "POSITION", "accessors", what);
    if (!position) return;
    const Accessor points = accessor(*position, "VEC3", 3);
    if (points.component != Float)
      fail(called("accessors", *position) + ": positions that are no floats are not supported", DYN_ERROR_UNSUPPORTED);
    const std::int64_t mode = whole(p, "mode", 6, what, 4);
    std::optional<Accessor> indices, colours;
    if (const auto i = reference(p, "indices", "accessors", what)) indices = accessor(*i, "SCALAR", 1);
    if (indices && indices->component != UnsignedByte && indices->component != UnsignedShort && indices->component != UnsignedInt)
      fail(what + ".indices are no unsigned integers");
    if (const auto c = reference(*attributes, "COLOR_0", "accessors", what)) colours = accessor(*c, "VEC3", 3, "VEC4");
    if (colours && (colours->count < points.count ||
                    (colours->component != Float && colours->component != UnsignedByte && colours->component != UnsignedShort)))
      fail(what + ".COLOR_0 has not a colour for each vertex");
    const std::int64_t n = indices ? indices->count : points.count;
    if (mode < 4) return void(out.skipped += mode == 0 ? n : mode == 1 ? n / 2 : n);
    if (mode == 4 && n % 3 != 0) fail(what + " has " + std::to_string(n) + " corners, and triangles have three each");
    check_mesh_size(all_vertices += points.count, 0, report);
    const std::int64_t triangles = mode == 4 ? n / 3 : std::max<std::int64_t>(n - 2, 0);
    check_mesh_size(0, out.triangle_count() + triangles, report);

    const std::int64_t first = out.vertex_count();
    for (std::int64_t i = 0; i < points.count; ++i)
      for (int k = 0; k < 3; ++k) out.vertices.push_back(points.number(i, k));
    std::optional<Rgb> material;
    if (const auto m = reference(p, "material", "materials", what)) material = base_colour(*m);
    const auto corner = [&](std::int64_t i) {
      const std::int64_t v = indices ? std::int64_t(indices->index(i)) : i;
      if (v >= points.count)
        fail(what + ": index " + std::to_string(v) + " is not one of the " + std::to_string(points.count) + " vertices");
      return v;
    };
    for (std::int64_t t = 0; t < triangles; ++t) {
      std::int64_t c[3];
      for (std::int64_t k = 0; k < 3; ++k) c[k] = corner(mode == 4 ? 3 * t + k : mode == 6 && k == 0 ? 0 : t + k);
      if (mode == 5 && t & 1) std::swap(c[0], c[1]);
      for (const std::int64_t v : c) out.triangles.push_back(std::int32_t(first + v));
      out.colours.push_back(0);
      if (!material && !colours) continue;
      Rgb sum = material.value_or(Rgb{1, 1, 1});
      for (int k = 0; k < 3; ++k) {
        if (colours) sum[std::size_t(k)] *= (colours->number(c[0], k) + colours->number(c[1], k) + colours->number(c[2], k)) / 3;
        sum[std::size_t(k)] = from_linear(sum[std::size_t(k)]);
      }
      out.colours.back() = std::isfinite(sum[0] + sum[1] + sum[2]) ? packed_rgb(sum) : 0;
    }
  }

  const Soup& mesh(std::int64_t i) {
    meshes.resize(std::size_t(count_of("meshes")));
    std::optional<Soup>& out = meshes[std::size_t(i)];
    if (out) return *out;
    out.emplace();
    std::int64_t k = 0;
    const std::string what = called("meshes", i);
    for (const Json& p : list(item("meshes", i), "primitives", what))
      add_primitive(p, what + "." + called("primitives", k++), *out);
    return *out;
  }

  // ------------------------------------------------------------------------------------------------ nodes

  Affine transform(const Json& node, const std::string& what) const {
    Affine X;
    if (const std::vector<double> m = numbers(node, "matrix", 16, what); !m.empty()) {  // by columns
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) X.A[r][c] = m[std::size_t(4 * c + r)];
        X.p[r] = m[std::size_t(12 + r)];
      }
      return X;
    }
    if (const std::vector<double> u = numbers(node, "rotation", 4, what); !u.empty()) {
      const double n = u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + u[3] * u[3];
      if (!(n > 0) || !std::isfinite(n)) fail(what + ".rotation is no quaternion");
      const double s = 2 / n, x = u[0], y = u[1], z = u[2], w = u[3];
      const double R[3][3] = {{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
                              {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
                              {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}};
      std::memcpy(X.A, R, sizeof R);
    }
    if (const std::vector<double> s = numbers(node, "scale", 3, what); !s.empty())
      for (auto& row : X.A)
        for (std::size_t c = 0; c < 3; ++c) row[c] *= s[c];
    if (const std::vector<double> t = numbers(node, "translation", 3, what); !t.empty())
      for (std::size_t r = 0; r < 3; ++r) X.p[r] = t[r];
    return X;
  }

  Soup scene(const Affine& X) {
    struct Placed {
      std::int64_t node;
      Affine X;
    };
    std::vector<Placed> todo;
    std::vector<char> seen(std::size_t(count_of("nodes")));
    const auto add = [&](const Json& o, const char* key, const std::string& what, const Affine& Y) {
      const std::vector<Json>& all = list(o, key, what);
      for (auto n = all.rbegin(); n != all.rend(); ++n) {
        if (n->kind != Json::Kind::Number || !(n->number >= 0 && n->number < double(seen.size())) ||
            n->number != std::floor(n->number))
          fail(what + "." + key + " holds something that is no node");
        char& before = seen[std::size_t(n->number)];
        if (before) fail(called("nodes", std::int64_t(n->number)) + " has two parents: nodes are a tree");
        before = 1;
        todo.push_back({std::int64_t(n->number), Y});
      }
    };
    if (count_of("scenes") == 0) fail("it has no scene");
    const std::int64_t which = whole(root, "scene", count_of("scenes") - 1, "the file", 0);
    add(item("scenes", which), "nodes", called("scenes", which), X);
    Soup out;
    while (!todo.empty()) {
      const Placed at = todo.back();
      todo.pop_back();
      const std::string what = called("nodes", at.node);
      const Json& node = item("nodes", at.node);
      const Affine Y = at.X * transform(node, what);
      if (const auto m = reference(node, "mesh", "meshes", what)) add_placed(mesh(*m), Y, out, report);
      add(node, "children", what, Y);
    }
    return out;
  }
};

void check_version(const Json& root, const Report& report) {
  const Json* asset = root.find("asset");
  const Json* version = asset ? asset->find("version") : nullptr;
  if (!version || !version->text.starts_with("2"))
    report.fail(DYN_ERROR_UNSUPPORTED, 0,
                "asset.version is " + in_quotes(version ? version->text : "missing") + ": glTF 2.0 is read");
  if (const Json* needed = root.find("extensionsRequired"))
    for (const Json& x : needed->items)
      if (x.text.find("compression") != x.text.npos || x.text.find("quantization") != x.text.npos ||
          x.text.find("instancing") != x.text.npos)
        report.fail(DYN_ERROR_UNSUPPORTED, 0, "it needs the extension " + in_quotes(x.text) + ", which is not supported");
}

}  // namespace

Soup read_gltf(std::string_view bytes, bool binary, bool up_z, const Report& report) {
  std::string_view json = bytes, chunk;
  if (binary) {
    // magic, version, length; then chunks of length, type, bytes: JSON first, then a buffer
    const auto word = [&](std::size_t at) { return little_endian<std::uint32_t>(bytes.data() + at); };
    if (!bytes.starts_with("glTF")) report.fail(DYN_ERROR_PARSE, 0, "this is not a binary glTF: it does not begin with 'glTF'");
    if (bytes.size() < 20 || word(8) != bytes.size() || word(12) > bytes.size() - 20)
      report.fail(DYN_ERROR_PARSE, 0,
                  "its header states another size than the " + std::to_string(bytes.size()) +
                      " bytes of the file: it is cut off or damaged");
    if (word(4) != 2) report.fail(DYN_ERROR_UNSUPPORTED, 0, "version " + std::to_string(word(4)) + ": binary glTF 2 is read");
    const std::size_t end = 20 + std::size_t(word(12));
    json = bytes.substr(20, end - 20);
    if (bytes.size() - end >= 8) {
      const std::size_t length = word(end);
      if (length > bytes.size() - end - 8) report.fail(DYN_ERROR_PARSE, 0, "its binary chunk is cut off");
      chunk = bytes.substr(end + 8, length);
    }
  }
  const Json root = parse_json(json, report);
  check_version(root, report);
  Gltf gltf{report, root, chunk};
  for (std::size_t k = 0; k < root.keys.size(); ++k) gltf.sections.emplace(root.keys[k], &root.items[k]);
  return gltf.scene(up_z ? y_to_z : Affine());
}

}  // namespace dyn::load
