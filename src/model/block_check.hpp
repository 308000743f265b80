// Whether a block that came from elsewhere is a model: parts of Checker in block_check*.cpp. Each returns whether nothing was
// wrong, and what comes after may rely on it. What the builder derives (builder_finish.cpp) is derived once more, without memory.
#pragma once

#include <cmath>

#include "joint/list.hpp"
#include "model/dynb.hpp"

namespace dyn {

class BlockChecker {
 public:
  explicit BlockChecker(const Model& model) : m(model), n(model.n) {}

  Damage damage;

  bool layout(std::size_t bytes);
  bool names();
  bool joints();             // and bodies
  bool expanded();           // coordinates of followers
  bool order();              // what follows from the tree of bodies: ends of subtrees, runs, cache blocks
  bool coordinates();        // Euclidean spans, limits
  bool elimination();        // the elimination tree of M, and its groups
  bool coefficients();       // numbers of coordinates and of the whole
  bool frames();             // and links, weights, drag boxes
  bool surfaces();
  bool shapes();             // and pairs
  bool constraints(), compliances();
  bool actuators();
  bool tendons();            // and all paths
  bool sensors();            // after actuators and tendons
  bool rest();

 private:
  const Model& m;
  const ModelSizes& n;

  bool require(bool good, const char* what) {
    if (!good) damage = {DYN_ERROR_PARSE, what};
    return good;
  }
  bool index(std::int64_t i, std::int64_t count, const char* what) {
    if (i >= 0 && i < count) return true;
    damage = {DYN_ERROR_PARSE, what, i, count};
    return false;
  }
  bool text(Index at) { return index(at, n.text, "place of a name"); }
  // All of f(i), i = first .. last - 1.
  template <class F>
  static bool each(Index first, Index last, F&& f) {
    for (Index i = first; i < last; ++i)
      if (!f(i)) return false;
    return true;
  }
  template <class F>
  static bool each(Index count, F&& f) {
    return each(0, count, f);
  }
  template <class Ok>
  bool numbers(const double* x, std::int64_t count, const char* what, Ok&& ok) {
    for (std::int64_t k = 0; k < count; ++k)
      if (!ok(x[k])) return require(false, what);
    return true;
  }
  static bool is_finite(double x) { return std::isfinite(x); }
  static bool is_known(double x) { return !std::isnan(x); }
  static bool is_coefficient(double x) { return std::isfinite(x) && x >= 0; }
  static bool is_finite(const Vec3<double>& x) { return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]); }
  static bool is_finite(const Mat3<double>& A) { return is_finite(A.x) && is_finite(A.y) && is_finite(A.z); }
  static bool is_finite(const SE3<double>& X) { return is_finite(X.R) && is_finite(X.p); }
  template <std::size_t N>
  static bool are_finite(const double (&x)[N]) {
    for (const double e : x)
      if (!std::isfinite(e)) return false;
    return true;
  }

  bool simple(dynJointType type);
  bool joint(Index j, Index& q, Index& v, Index& qx, Index& vx);
  bool joined(Index a, Index b);

  template <class T, class F>
  bool surface(const Stored<T>& s, F&& f);
  bool hull(const Stored<shape::Hull>& s);
  bool tree(const Stored<shape::TriangleTree>& s);
  bool grid(const Stored<shape::Grid>& s);
  bool lists(const Index* start, Index lists, const Index* entry, Index total, Index most);
  bool shape(Index k);
  bool path(Index k);
  bool path_element(const PathElement& e);
  Index carrier(Index geom) const { return m.frames()[m.shapes()[m.geoms()[geom].shape].frame].joint; }
};

inline Index nq_of(BodyType type) {
  Index out = 0;
  visit(type, [&]<class J>() { out = J::nq; });
  return out;
}
inline Index nv_of(BodyType type) {
  Index out = 0;
  visit(type, [&]<class J>() { out = J::nv; });
  return out;
}

}  // namespace dyn
