// States between this library and others. A joint's place in the other's state is in state_layout.hpp.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "state_layout.hpp"
#include "reflection.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

constexpr const char* function = "dyn_state_layout_convert";

struct Arrays {
  const double *q, *v, *a, *tau;
};
struct Outputs {
  double *q, *v, *a, *tau;
};

constexpr double most = 1e300;  // sums of as many forces as there can be don't overflow

class Conversion {
 public:
  Conversion(const Layout& layout, const Arrays& in, const Outputs& out) : l(layout), m(layout.model()), in(in), out(out) {}

  // Twice over: first to see that all is well, then to write.
  dynStatus run(dynDirection direction) {
    for (const bool write : {false, true}) {
      if (write && direction == DYN_DIRECTION_FROM_PEER && out.tau) std::fill_n(out.tau, m.n.nv, 0.0);
      const dynStatus s = l.each(
          [&](const Item& item) { return direction == DYN_DIRECTION_TO_PEER ? to_peer(item, write) : from_peer(item, write); });
      if (s != DYN_OK) return s;
    }
    return DYN_OK;
  }

 private:
  const Layout& l;
  const Model& m;
  const Arrays in;
  const Outputs out;

  static void get(const double* from, std::int64_t at, int n, double* to) {
    for (int k = 0; k < n; ++k) to[k] = from ? from[at + k] : 0;
  }
  static void put(const double* from, int n, std::int64_t at, double* to) {
    for (int k = 0; to && k < n; ++k) to[at + k] = from[k];
  }
  dynStatus bounded(const char* what, const double* x, int n, Index joint) const {
    for (int k = 0; k < n; ++k)
      if (!(std::abs(x[k]) <= most))
        return fail(DYN_ERROR_NUMERIC, "%s: the %s of joint '%.200s' overflows: the inputs are too large for double precision",
                    function, what, l.name(joint));
    return DYN_OK;
  }
  dynStatus bounded(const peer::Coordinates& x, peer::Size n, Index joint) const {
    const struct {
      const char* what;
      const double* x;
      int n;
    } rows[] = {{"configuration", x.q, n.nq}, {"velocity", x.v, n.nv}, {"acceleration", x.a, n.nv}, {"force", x.tau, n.nv}};
    for (const auto& r : rows)
      if (const dynStatus s = bounded(r.what, r.x, r.n, joint)) return s;
    return DYN_OK;
  }

  dynStatus to_peer(const Item& item, bool write) const {
    const JointRecord& r = m.joints()[item.joint];
    const peer::Ends ends = l.ends(item.joint);
    std::int64_t q = r.idx_q, v = r.idx_v, at_q = item.q, at_v = item.v;
    dynStatus status = DYN_OK;
    l.parts(item.joint, [&](peer::Form form, peer::Size ours) {
      if (status != DYN_OK) return;
      peer::Coordinates x{}, y{};
      get(in.q, q, ours.nq, x.q), get(in.v, v, ours.nv, x.v), get(in.a, v, ours.nv, x.a), get(in.tau, v, ours.nv, x.tau);
      if (l.follows(item.joint)) x.q[0] = r.ratio * x.q[0] + r.offset, x.v[0] *= r.ratio, x.a[0] *= r.ratio, x.tau[0] = 0;
      peer::to_peer(form, ends, x, y);
      const peer::Size n = peer::size(form, ours);
      if (!write) status = bounded(y, n, item.joint);
      else put(y.q, n.nq, at_q, out.q), put(y.v, n.nv, at_v, out.v), put(y.a, n.nv, at_v, out.a), put(y.tau, n.nv, at_v, out.tau);
      q += ours.nq, v += ours.nv, at_q += n.nq, at_v += n.nv;
    });
    return status;
  }

  dynStatus from_peer(const Item& item, bool write) const {
    const JointRecord& r = m.joints()[item.joint];
    const peer::Ends ends = l.ends(item.joint);
    const bool follower = l.follows(item.joint);
    std::int64_t q = r.idx_q, v = r.idx_v, at_q = item.q, at_v = item.v;
    dynStatus status = DYN_OK;
    l.parts(item.joint, [&](peer::Form form, peer::Size ours) {
      if (status != DYN_OK) return;
      const peer::Size n = peer::size(form, ours);
      peer::Coordinates x{}, y{};
      get(in.q, at_q, n.nq, y.q), get(in.v, at_v, n.nv, y.v), get(in.a, at_v, n.nv, y.a), get(in.tau, at_v, n.nv, y.tau);
      if (!write) status = readable(form, ours, item.joint, y, at_q, at_v, follower);
      if (status != DYN_OK) return;
      if (follower) {
        x.tau[0] = r.ratio * y.tau[0];
        if (!write) status = bounded("force", x.tau, 1, item.joint);
      } else {
        peer::from_peer(form, ends, y, x);
        if (!write) status = bounded(x, ours, item.joint);
        else put(x.q, ours.nq, q, out.q), put(x.v, ours.nv, v, out.v), put(x.a, ours.nv, v, out.a);
      }
      for (int k = 0; write && out.tau && k < ours.nv; ++k) out.tau[v + k] += x.tau[k];
      q += ours.nq, v += ours.nv, at_q += n.nq, at_v += n.nv;
    });
    return status;
  }

  dynStatus readable(peer::Form form, peer::Size ours, Index joint, const peer::Coordinates& y, std::int64_t at_q,
                     std::int64_t at_v, bool follower) const {
    const peer::Size n = peer::size(form, ours);
    const struct {
      const char* name;
      const double* x;
      int n;
      std::int64_t at;
    } rows[] = {{"tau", y.tau, n.nv, at_v}, {"q", y.q, n.nq, at_q}, {"v", y.v, n.nv, at_v}, {"a", y.a, n.nv, at_v}};
    for (const auto& row : rows) {
      if (follower && row.x != y.tau) break;
      if (const Index k = finite_count(row.x, row.n); k < row.n)
        return fail(DYN_ERROR_NONFINITE, "%s: %s[%lld] (joint '%.200s') is %s: give a finite number", function, row.name,
                    static_cast<long long>(row.at + k), l.name(joint), row.x[k] != row.x[k] ? "NaN" : "infinite");
    }
    if (!follower && peer::zero_norm(form, ours, y.q))
      return fail(DYN_ERROR_QUATERNION, "%s: the quaternion or (cos, sin) of joint '%.200s' in q is zero: give one of norm 1",
                  function, l.name(joint));
    return DYN_OK;
  }
};

dynStatus check_arrays(const Arrays& in, const Outputs& out) {
  if (!in.q) return fail(DYN_ERROR_ARGUMENT, "%s: q is NULL: it is required", function);
  if (in.a && !in.v)
    return fail(DYN_ERROR_ARGUMENT, "%s: a is given without v, on which the peer's acceleration depends: give v", function);
  const struct {
    const char* name;
    const double *in, *out;
  } rows[] = {{"v", in.v, out.v}, {"a", in.a, out.a}, {"tau", in.tau, out.tau}};
  for (const auto& r : rows)
    if (r.out && !r.in) return fail(DYN_ERROR_ARGUMENT, "%s: %s of the output is given without %s", function, r.name, r.name);
  return DYN_OK;
}

// Ours: all of it is read.
dynStatus check_ours(const Model& m, const Arrays& in) {
  const struct {
    const char* name;
    const double* x;
    Index n;
  } rows[] = {{"q", in.q, m.n.nq}, {"v", in.v, m.n.nv}, {"a", in.a, m.n.nv}, {"tau", in.tau, m.n.nv}};
  for (const auto& r : rows) {
    if (!r.x) continue;
    if (const Index k = finite_count(r.x, r.n); k < r.n)
      return fail(DYN_ERROR_NONFINITE, "%s: %s[%d] is %s: give a finite number", function, r.name, int(k),
                  r.x[k] != r.x[k] ? "NaN" : "infinite");
  }
  if (const Index j = zero_norm_joint(m, in.q))
    return fail(DYN_ERROR_QUATERNION, "%s: the quaternion or (cos, sin) of joint '%.200s' in q is zero: give one of norm 1",
                function, m.string(m.joints()[j].name));
  return DYN_OK;
}

}  // namespace

template <>
dynStateLayout capi::defaults() {
  return {};
}

template <>
dynStateInput capi::defaults() {
  return {};
}

template <>
dynStateOutput capi::defaults() {
  return {};
}

extern "C" {

dynStatus dyn_state_layout_sizes(const dynModel* model, const dynStateLayout* layout, int* nq, int* nv) {
  const Layout l(model, layout);
  if (l.status != DYN_OK) return l.status;
  if (nq) *nq = int(l.nq());
  if (nv) *nv = int(l.nv());
  return DYN_OK;
}

dynStatus dyn_state_layout_convert(const dynModel* model, const dynStateLayout* layout, dynDirection direction,
                                   const dynStateInput* input, const dynStateOutput* output) {
  const DefaultFloatingPoint settings;
  const Layout l(model, layout);
  if (l.status != DYN_OK) return l.status;
  if (const dynStatus s = check_value(direction, function, "direction")) return s;
  const Given<dynStateInput> given(function, input);
  if (given.status != DYN_OK) return given.status;
  const Given<dynStateOutput> wanted(function, output);
  if (wanted.status != DYN_OK) return wanted.status;
  const Arrays in = {given->q, given->v, given->a, given->tau};
  const Outputs out = {wanted->q, wanted->v, wanted->a, wanted->tau};
  if (const dynStatus s = check_arrays(in, out)) return s;
  if (direction == DYN_DIRECTION_TO_PEER)
    if (const dynStatus s = check_ours(l.model(), in)) return s;
  return Conversion(l, in, out).run(direction);
}

}  // extern "C"
