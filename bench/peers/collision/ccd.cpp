// libccd: MPR at the tolerance that MuJoCo used it with, on libdyn's support functions. It knows depths alone.
#include <ccd/ccd.h>

#include "engine.hpp"

namespace dyn_bench {
namespace {

struct Object {
  const Shape* shape;
  Pose X;
};

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const Object& o = *static_cast<const Object*>(object);
  const Vec d = load3(direction->v);
  Vec p = Vec::zero();
  shape::visit(*o.shape, [&]<class S>(const S& s) {
    if constexpr (S::type != Type::HalfSpace) p = s.support(transpose_times(o.X.R, d));
  });
  store3(o.X.act(p) + d * (o.shape->radius / shape::norm(d)), out->v);
}
void center(const void* object, ccd_vec3_t* out) {
  const Object& o = *static_cast<const Object*>(object);
  store3(o.shape->hull ? o.X.act(o.shape->hull->center) : o.X.p, out->v);
}

struct Ccd : Engine {
  std::vector<std::pair<Object, Object>> placed;
  ccd_t ccd;

  Ccd() {
    CCD_INIT(&ccd);
    ccd.support1 = ccd.support2 = support, ccd.center1 = ccd.center2 = center;
    ccd.max_iterations = 500, ccd.mpr_tolerance = 1e-6;
  }
  const char* name() const override { return "libccd"; }
  bool load(const Solid& a, const Solid& b) override {
    return std::min(a.shape.type, b.shape.type) > Type::HalfSpace && std::max(a.shape.type, b.shape.type) <= Type::Convex;
  }
  void place(const std::vector<Scene>& scenes) override {
    placed.clear();
    for (const Scene& s : scenes) placed.push_back({{&s.a.shape, s.A}, {&s.b.shape, s.B}});
  }
  void ask(double* out) override {
    for (const auto& p : placed) {
      double depth = 0;
      ccd_vec3_t direction, position;
      *out++ = ccdMPRPenetration(&p.first, &p.second, &ccd, &depth, &direction, &position) == 0 ? -depth : shape::infinity;
    }
  }
  bool depths_only() const override { return true; }
};

}  // namespace

std::unique_ptr<Engine> make_ccd() { return std::make_unique<Ccd>(); }

}  // namespace dyn_bench
