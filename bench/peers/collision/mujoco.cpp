// MuJoCo: mj_geomDistance of two geoms of a compiled model, and the function of their types that steps call for contacts. Its
// default tolerance.
#include <mujoco/mujoco.h>

#include <cstdio>
#include <stdexcept>
#include <string>

#include "engine.hpp"

namespace dyn_bench {
namespace {

std::string numbers(std::initializer_list<double> x) {
  std::string s;
  char text[32];
  for (double v : x) std::snprintf(text, sizeof text, "%.17g ", v), s += text;
  return s;
}

// mesh assets go to `assets`; empty: no such shape
std::string geom(const Solid& s, const std::string& name, std::string& assets) {
  const Vec& h = s.shape.size;
  auto plain = [&](const char* type, std::initializer_list<double> size) {
    return "<geom name='" + name + "' type='" + type + "' size='" + numbers(size) + "'/>";
  };
  switch (s.shape.type) {
    case Type::HalfSpace: return plain("plane", {0, 0, 1});
    case Type::Sphere: return plain("sphere", {s.shape.radius});
    case Type::Capsule: return plain("capsule", {s.shape.radius, h[2]});
    case Type::Box: return plain("box", {h[0], h[1], h[2]});
    case Type::Cylinder: return plain("cylinder", {h[0], h[2]});
    case Type::Ellipsoid: return plain("ellipsoid", {h[0], h[1], h[2]});
    case Type::Convex: break;
    default: return "";  // MuJoCo lacks cones, and takes the hull of a mesh
  }
  const shape::Hull& hull = s.hull->hull;
  std::string vertices;
  for (Index i = 0; i < hull.vertices; ++i) vertices += numbers({hull.x[i], hull.y[i], hull.z[i]});
  assets += "<mesh name='" + name + "' inertia='convex' vertex='" + vertices + "'/>";
  return "<geom name='" + name + "' type='mesh' mesh='" + name + "'/>";
}

struct MuJoCo : Engine {
  mjModel* m = nullptr;
  mjData* d = nullptr;
  struct Placed {
    double position[2][3], rotation[2][9], reach;
  };
  std::vector<Placed> poses;

  ~MuJoCo() override { clear(); }
  const char* name() const override { return "MuJoCo"; }
  void clear() {
    mj_deleteData(d), mj_deleteModel(m);
    d = nullptr, m = nullptr;
  }
  bool load(const Solid& a, const Solid& b) override {
    clear();
    std::string assets;
    const std::string x = geom(a, "a", assets), y = geom(b, "b", assets);
    if (x.empty() || y.empty()) return false;
    const bool plane = a.shape.type == Type::HalfSpace;  // belongs to the world
    const std::string xml = "<mujoco><asset>" + assets + "</asset><worldbody>" +
                            (plane ? x : "<body mocap='true'>" + x + "</body>") + "<body mocap='true'>" + y +
                            "</body></worldbody></mujoco>";
    char error[500] = "";
    mjSpec* spec = mj_parseXMLString(xml.c_str(), nullptr, error, sizeof error);
    m = spec ? mj_compile(spec, nullptr) : nullptr;
    const std::string why = spec ? mjs_getError(spec) : error;
    mj_deleteSpec(spec);
    if (!m) throw std::runtime_error("MuJoCo: " + why);
    d = mj_makeData(m);
    mj_forward(m, d);
    return true;
  }
  void place(const std::vector<Scene>& scenes) override {
    poses.clear();
    for (const Scene& s : scenes) {
      Placed p;
      p.reach = 10 * (size_of(s.a) + size_of(s.b) + shape::norm(s.B.p - s.A.p));
      for (int k = 0; k < 2; ++k) {
        const Pose& X = k ? s.B : s.A;
        for (int i = 0; i < 3; ++i) p.position[k][i] = X.p[i];
        for (int i = 0; i < 9; ++i) p.rotation[k][i] = X.R(i / 3, i % 3);
        if (m->geom_type[k] != mjGEOM_MESH) continue;
        // a mesh's frame is that of its inertia
        const int mesh = m->geom_dataid[k];
        double offset[3], turn[9], turned[9];
        mju_mulMatVec3(offset, p.rotation[k], m->mesh_pos + 3 * mesh);
        mju_addTo3(p.position[k], offset);
        mju_quat2Mat(turn, m->mesh_quat + 4 * mesh);
        mju_mulMatMat(turned, p.rotation[k], turn, 3, 3, 3);
        mju_copy(p.rotation[k], turned, 9);
      }
      poses.push_back(p);
    }
  }
  void set(const Placed& p) {
    for (int k = 0; k < 2; ++k) {
      for (int i = 0; i < 3; ++i) d->geom_xpos[3 * k + i] = p.position[k][i];
      for (int i = 0; i < 9; ++i) d->geom_xmat[9 * k + i] = p.rotation[k][i];
    }
  }
  bool contacts(double* out) override {
    const bool exchanged = m->geom_type[0] > m->geom_type[1];
    const mjfCollision collide = mjCOLLISIONFUNC[m->geom_type[exchanged]][m->geom_type[!exchanged]];
    mjPreContact found[mjMAXCONPAIR];
    for (const Placed& p : poses) {
      set(p);
      const int count = collide(m, d, found, exchanged, !exchanged, 0);
      double least = shape::infinity;
      for (int i = 0; i < count; ++i) least = std::min(least, double(found[i].dist));
      *out++ = least;
    }
    return true;
  }
  void ask(double* out) override {
    for (const Placed& p : poses) {
      set(p);
      double fromto[6];
      *out++ = mj_geomDistance(m, d, 0, 1, p.reach, fromto);
    }
  }
};

}  // namespace

std::unique_ptr<Engine> make_mujoco() { return std::make_unique<MuJoCo>(); }

}  // namespace dyn_bench
