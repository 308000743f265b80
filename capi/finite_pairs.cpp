// Matrices over pairs of degrees of freedom, checked in the time of the pairs: entries of unrelated joints are zero for good, and
// the others are sums of products of columns that the data holds.
#include "checks.hpp"
#include "algorithm/tiles.hpp"

namespace dyn::capi {
namespace {

constexpr Index few = 32;  // degrees of freedom up to which all entries are looked at in less time

template <class V>  // Motion, Force or Vec3: numbers side by side; nine products of such as are below 2^500 do not overflow
bool small(const V* columns, std::ptrdiff_t n) {
  return !any_beyond(reinterpret_cast<const double*>(columns), n * std::ptrdiff_t(sizeof(V) / sizeof(double)), 500);
}

}  // namespace

bool small_columns(const Call& call) {
  const Model& m = call.m();
  const Data<double>& d = call.d();
  const std::ptrdiff_t n = m.n.nvx;
  return n > few && !m.has_mimic && small(d.S, n) && small(d.dS, n) && small(d.ddS, n) && small(d.W, n) && small(d.F, n) &&
         small(d.Fq, n) && small(d.Fv, n) && small(d.Q, n);
}

bool numeric_pairs(Call& call, const double* x, const char* what, Stage stage, bool small_columns) {
  const Model& m = call.m();
  const std::ptrdiff_t n = m.n.nv;
  bool known = small_columns;
  // what is added to the products lies on the diagonal or in the columns of one joint
  for (std::ptrdiff_t k = 0; known && k < n; ++k) known = finite_count(x + k + n * k, 1) == 1;
  if (known)
    for_each_block(m, [&](Index, std::ptrdiff_t first, int nv) {
      for (int k = 0; k < nv; ++k) known = known && finite_count(x + first + n * (first + k), nv) == nv;
    });
  return known || call.numeric(x, n * n, what, stage);
}

}  // namespace dyn::capi
