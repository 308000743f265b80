// Mesh files by assimp: the triangles of all nodes, in the scene's frame.
#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>

#include "model/colour.hpp"
#include "parts.hpp"

namespace dyn::mesh {

namespace {

// y = A x + p
struct Affine {
  double A[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, p[3] = {0, 0, 0};

  friend Affine operator*(const Affine& X, const Affine& Y) {
    Affine Z;
    for (int r = 0; r < 3; ++r) {
      Z.p[r] = X.p[r];
      for (int c = 0; c < 3; ++c) {
        Z.A[r][c] = 0;
        for (int k = 0; k < 3; ++k) Z.A[r][c] += X.A[r][k] * Y.A[k][c];
        Z.p[r] += X.A[r][c] * Y.p[c];
      }
    }
    return Z;
  }
  double determinant() const {
    return A[0][0] * (A[1][1] * A[2][2] - A[1][2] * A[2][1]) - A[0][1] * (A[1][0] * A[2][2] - A[1][2] * A[2][0]) +
           A[0][2] * (A[1][0] * A[2][1] - A[1][1] * A[2][0]);
  }
};

std::string lower_extension(std::string_view path) {
  const std::size_t dot = path.find_last_of("./");
  std::string out(dot == path.npos || path[dot] == '/' ? "" : path.substr(dot + 1));
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  return out;
}

// assimp stores single precision. Numbers of up to seven digits are restored exactly.
double from_decimal(float x) {
  char digits[32];
  const char* end = std::to_chars(digits, digits + sizeof digits, x).ptr;
  double value = x;
  std::from_chars(digits, end, value);
  return value;
}

// Diffuse colour of the file, or none. Ignores assimp's default grey and materials of its own, and white, which is the factor of
// a texture.
std::optional<aiColor4D> diffuse(const aiMaterial& material) {
  aiColor4D c;
  const std::string name = material.GetName().C_Str();
  if (name.empty() || name == AI_DEFAULT_MATERIAL_NAME || material.Get(AI_MATKEY_COLOR_DIFFUSE, c) != aiReturn_SUCCESS) return {};
  if (c == aiColor4D(0.6f, 0.6f, 0.6f, 1) || (material.GetTextureCount(aiTextureType_DIFFUSE) && c == aiColor4D(1, 1, 1, 1)))
    return {};
  return c;
}

// Linear light to sRGB: IEC 61966-2-1.
double from_linear(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

struct Reading {
  bool decimal;  // not glTF
  Triangles out;

  double number(ai_real x) const { return decimal ? from_decimal(float(x)) : double(x); }

  Affine placement(const aiMatrix4x4& m) const {
    Affine X;
    for (unsigned r = 0; r < 3; ++r) {
      for (unsigned c = 0; c < 3; ++c) X.A[r][c] = number(m[r][c]);
      X.p[r] = number(m[r][3]);
    }
    return X;
  }

  // Material colour times the mean of the corner colours.
  std::uint32_t colour(const aiMesh& mesh, const std::optional<aiColor4D>& material, const aiFace& face) const {
    if (!material && !mesh.HasVertexColors(0)) return 0;
    aiColor4D sum(1, 1, 1, 1);
    if (mesh.HasVertexColors(0)) {
      sum = aiColor4D(0, 0, 0, 0);
      for (unsigned k = 0; k < 3; ++k) sum = sum + mesh.mColors[0][face.mIndices[k]] * (1 / 3.0f);
    }
    if (material) sum = sum * *material;
    double rgba[4] = {number(sum.r), number(sum.g), number(sum.b), 1};
    for (int i = 0; i < 3; ++i) {
      if (!std::isfinite(rgba[i])) return 0;
      if (!decimal) rgba[i] = from_linear(rgba[i]);
    }
    return packed_colour(rgba);
  }

  void add(const aiMesh& mesh, const aiMaterial* has, const Affine& X) {
    const std::optional<aiColor4D> material = has ? diffuse(*has) : std::nullopt;
    const std::size_t first = out.vertices.size() / 3;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const double v[3] = {number(mesh.mVertices[i].x), number(mesh.mVertices[i].y), number(mesh.mVertices[i].z)};
      for (int c = 0; c < 3; ++c)
        if (!std::isfinite(v[c]))
          throw Refusal(DYN_ERROR_NONFINITE, "vertex " + std::to_string(first + i) + " has " + "xyz"[c] + " = " +
                                                 (std::isnan(v[c]) ? "NaN" : "infinity") + ": export the mesh again");
      for (int r = 0; r < 3; ++r) out.vertices.push_back(X.A[r][0] * v[0] + X.A[r][1] * v[1] + X.A[r][2] * v[2] + X.p[r]);
    }
    const bool mirrored = X.determinant() < 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) {
        ++out.skipped;
        continue;
      }
      for (unsigned k = 0; k < 3; ++k) {
        const unsigned i = face.mIndices[mirrored ? 2 - k : k];
        if (i >= mesh.mNumVertices)
          throw Refusal(DYN_ERROR_PARSE,
                        "a face refers to vertex " + std::to_string(i) + " of " + std::to_string(mesh.mNumVertices));
        out.corners.push_back(std::int32_t(first + i));
      }
      out.colours.push_back(colour(mesh, material, face));
    }
  }
};

// Restricts files that a mesh names (materials, buffers) to its own folder and below.
class OneFolder : public Assimp::DefaultIOSystem {
 public:
  explicit OneFolder(const char* path)
      : folder_(std::filesystem::weakly_canonical(std::filesystem::absolute(path)).parent_path()) {}
  bool Exists(const char* file) const override { return within(file) && DefaultIOSystem::Exists(file); }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return within(file) ? DefaultIOSystem::Open(file, mode) : nullptr;
  }

 private:
  bool within(const char* file) const {
    std::error_code bad;
    const auto path = std::filesystem::weakly_canonical(std::filesystem::absolute(file, bad), bad);
    return !bad && std::mismatch(folder_.begin(), folder_.end(), path.begin(), path.end()).first == folder_.end();
  }
  std::filesystem::path folder_;
};

// Splits quadrilaterals at the shorter diagonal, as readers of OBJ files do. assimp begins at a corner that it takes for concave.
void split_quadrilaterals(aiMesh& mesh) {
  const auto is_split = [&](const aiFace& face) {
    return face.mNumIndices == 4 &&
           std::all_of(face.mIndices, face.mIndices + 4, [&](unsigned k) { return k < mesh.mNumVertices; });
  };
  const auto count = static_cast<unsigned>(std::count_if(mesh.mFaces, mesh.mFaces + mesh.mNumFaces, is_split));
  if (count == 0) return;
  aiFace* const faces = new aiFace[mesh.mNumFaces + count];  // the mesh owns them
  aiFace* to = faces;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (!is_split(face)) {
      *to++ = face;
      continue;
    }
    unsigned* const corner = face.mIndices;
    const auto square = [&](int i, int j) { return (mesh.mVertices[corner[i]] - mesh.mVertices[corner[j]]).SquareLength(); };
    if (!(square(0, 2) < square(1, 3))) std::rotate(corner, corner + 1, corner + 4);
    for (const int second : {1, 2}) {
      to->mNumIndices = 3;
      to->mIndices = new unsigned[3]{corner[0], corner[second], corner[second + 1]};
      ++to;
    }
  }
  delete[] mesh.mFaces;
  mesh.mFaces = faces, mesh.mNumFaces += count;
  mesh.mPrimitiveTypes |= aiPrimitiveType_TRIANGLE;
  if (std::all_of(faces, faces + mesh.mNumFaces, [](const aiFace& face) { return face.mNumIndices <= 3; }))
    mesh.mPrimitiveTypes &= ~unsigned(aiPrimitiveType_POLYGON);
}

struct Placed {
  const aiNode* node;
  Affine X;
};

}  // namespace

Triangles read_assimp(const char* path, bool up_z, std::int64_t max_triangles) {
  const std::string kind = lower_extension(path);
  const bool collada = kind == "dae", gltf = kind == "gltf" || kind == "glb";
  Assimp::Importer importer;
  importer.SetIOHandler(new OneFolder(path));  // the importer owns it
  // assimp's convention is y up; it converts COLLADA to that
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, !up_z);
  const aiScene* scene = importer.ReadFile(path, 0);
  for (unsigned i = 0; scene && kind == "obj" && i < scene->mNumMeshes; ++i) split_quadrilaterals(*scene->mMeshes[i]);
  if (scene) scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (!scene || !scene->mRootNode) {
    const std::string why = importer.GetErrorString();
    throw Refusal(DYN_ERROR_PARSE, why.empty() ? "it cannot be read" : why);
  }

  Affine root;
  if (up_z && (collada || gltf)) root = {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {0, 0, 0}};
  std::vector<Placed> all = {{scene->mRootNode, root}};
  Reading reading{!(kind == "glb" || kind == "gltf"), {}};
  std::int64_t triangles = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const aiNode& node = *all[k].node;
    all[k].X = all[k].X * reading.placement(node.mTransformation);
    for (unsigned c = 0; c < node.mNumChildren; ++c) all.push_back({node.mChildren[c], all[k].X});
    for (unsigned i = 0; i < node.mNumMeshes; ++i) triangles += scene->mMeshes[node.mMeshes[i]]->mNumFaces;
  }
  if (triangles > max_triangles)
    throw Refusal(DYN_ERROR_LIMIT, std::to_string(triangles) + " triangles, and the limit is " + std::to_string(max_triangles));
  for (const Placed& p : all)
    for (unsigned i = 0; i < p.node->mNumMeshes; ++i) {
      const aiMesh& mesh = *scene->mMeshes[p.node->mMeshes[i]];
      reading.add(mesh, mesh.mMaterialIndex < scene->mNumMaterials ? scene->mMaterials[mesh.mMaterialIndex] : nullptr, p.X);
    }
  return std::move(reading.out);
}

}  // namespace dyn::mesh
