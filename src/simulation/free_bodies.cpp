#include "simulation/free_bodies.hpp"

#include <limits>

#include "effect/list.hpp"
#include "integrator/free_flight.hpp"
#include "joint/free_flyer.hpp"
#include "simulation/workspace.hpp"
#include "spatial/explog.hpp"

namespace dyn::simulation {

namespace {

constexpr int lanes = Double4::lanes;

// Dinv[0] is 0 if some articulated inertia is not positive.
FreeBodyColumns columns_of(const Body& b) {
  FreeBodyColumns out{};
  ArticulatedInertia<double> IA = ArticulatedInertia<double>::rigid({b.m, b.h, Sym3<double>::from(b.I)});
  for (int k = 5; k >= 0; --k) {
    const Motion<double> s = FreeFlyer::column(b, Mat3<double>::identity(), k);
    const Force<double> U = IA * s;
    const double D = dot(s, U);
    if (!(D > 0)) break;
    out.U[k] = U, out.Dinv[k] = 1 / D;
    IA = IA.minus_outer(U, 1 / D);
  }
  return out;
}

bool is_identity(const SE3<double>& X) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      if (X.R(r, c) != (r == c)) return false;
  return X.p[0] == 0 && X.p[1] == 0 && X.p[2] == 0;
}

static_assert(effect_bits([]<class E>() { return !effect::HasCoefficient<E>; }) ==
                  (DYN_EFFECT_LIMITS | DYN_EFFECT_ACTUATORS | DYN_EFFECT_FLUID | DYN_EFFECT_FLUID_ELLIPSOIDS |
                   DYN_EFFECT_GRAVITY_COMPENSATION | DYN_EFFECT_SLEEPING | DYN_EFFECT_TENDONS),
              "an effect that acts at a joint or on its link keeps a body from being a free body: list it below");
bool is_free_body(const Model& m, Index i) {
  const Body& b = m.bodies()[i];
  if (b.type != BodyType::FreeFlyer || b.parent != 0 || m.subtree_end()[i] != i + 1 || !(b.m > 0)) return false;
  if (!is_identity(m.joint_placement()[i])) return false;  // the joint's coordinates must be the pose in the world
  bool passive = true;
  for_each_effect([&]<class E>() {
    if constexpr (effect::HasCoefficient<E>)
      for (int k = 0; k < 6; ++k) passive = passive && E::of(m)[b.user_v + k] == 0;
  });
  if (!passive) return false;
  for (Index k = 0; k < m.n.actuators; ++k)
    if (m.actuators()[k].spec.joint == b.joint) return false;
  for (Index k = 0; k < m.n.path_dofs; ++k)
    if (m.path_dofs()[k] >= b.user_v && m.path_dofs()[k] < b.user_v + 6) return false;
  for (Index k = 0; k < m.n.gravity_compensations; ++k)
    if (m.gravity_compensations()[k].body == i) return false;
  return columns_of(b).Dinv[0] > 0;
}

template <class F>
void for_each_free_body(const Model& m, F&& f) {
  if (m.has_mimic) return;
  for (Index i = 1; i < m.n.bodies; ++i)
    if (is_free_body(m, i)) f(i);
}

void set(Vec3<Double4>& a, int lane, const Vec3<double>& b) {
  for (int i = 0; i < 3; ++i) a.v[i].set(lane, b[i]);
}
void set(Mat3<Double4>& A, int lane, const Mat3<double>& B) { set(A.x, lane, B.x), set(A.y, lane, B.y), set(A.z, lane, B.z); }

void fill(const Model& m, FreeBodySet& e, int lane, Index i) {
  const Body& b = m.bodies()[i];
  e.body[lane] = i, e.q[lane] = b.user_q, e.v[lane] = b.user_v;
  const Vec3<double> c = b.h * (1 / b.m);
  const Mat3<double> I = b.I - (Mat3<double>::identity() * dot(c, c) - outer(c, c)) * b.m;
  const Vec3<double> yz = cross(I.y, I.z), zx = cross(I.z, I.x), xy = cross(I.x, I.y);
  e.inverse_mass.set(lane, 1 / b.m);
  set(e.c, lane, c), set(e.I, lane, I), set(e.inverse, lane, transpose(Mat3<double>{yz, zx, xy} * (1 / dot(I.x, yz))));
}

struct LanePoses {
  Vec3<Double4> p;
  Quaternion<Double4> a;
  Mat3<Double4> R;
};

Vec3<Double4> first3(const Double4* x) { return Vec3<Double4>::make(x[0], x[1], x[2]); }

// Normalizes the quaternions of lanes whose squares could overflow or lose digits.
[[gnu::cold, gnu::noinline]] Quaternion<Double4> no_overflow_lanes(Quaternion<Double4> a, const Double4::Mask& bad) {
  for (int k = 0; k < lanes; ++k) {
    if (!bad[k]) continue;
    const Quaternion<double> one =
        normalized(Quaternion<double>{Vec3<double>::make(a.v.v[0][k], a.v.v[1][k], a.v.v[2][k]), a.w[k]});
    set(a.v, k, one.v), a.w.set(k, one.w);
  }
  return a;
}

DYN_INLINE LanePoses poses_of(const double* q, const FreeBodySet& e) {
  Double4 x[7];
  gather<7>(q, e.q, x);
  const Vec3<Double4> p = first3(x);
  Quaternion<Double4> a = {first3(x + 3), x[6]};
  Double4 square = dot(a.v, a.v) + a.w * a.w;
  if (const Double4::Mask bad = ~((square > tuning::min_norm2) & (square < 1 / tuning::min_norm2)); any(bad)) [[unlikely]]
    a = no_overflow_lanes(a, bad), square = dot(a.v, a.v) + a.w * a.w;
  return {p, a, rotation(a, Double4(2.0) / square)};
}

struct HalfAngle {
  Double4 sinc, cos;
};
[[gnu::cold, gnu::noinline]] HalfAngle far_lanes(HalfAngle of, const Double4& h2, const Double4::Mask& far) {
  for (int k = 0; k < lanes; ++k) {
    if (!far[k]) continue;
    const double h = std::sqrt(h2[k]);
    of.sinc.set(k, math::sin(h) / h), of.cos.set(k, math::cos(h));
  }
  return of;
}

// Rotation by exp(w): applied to a vector, or its inverse.
struct RotationExp {
  Vec3<Double4> w;
  HalfAngle half;
  Double4 a, b;  // sin t / t, (1 - cos t) / t^2

  explicit DYN_INLINE RotationExp(const Vec3<Double4>& by) : w(by) {
    const Double4 t2 = dot(w, w), h2 = t2 * Double4(0.25);
    half_angle_series(h2, half.sinc, half.cos);
    if (const Double4::Mask far = ~(t2 < 1.0); any(far)) [[unlikely]]
      half = far_lanes(half, h2, far);
    a = half.sinc * half.cos, b = half.sinc * half.sinc * Double4(0.5);
  }
  DYN_INLINE Quaternion<Double4> quaternion() const { return {w * (half.sinc * Double4(0.5)), half.cos}; }
  DYN_INLINE Vec3<Double4> operator()(const Vec3<Double4>& x) const {
    const Vec3<Double4> wx = cross(w, x);
    return x + wx * a + cross(w, wx) * b;
  }
  DYN_INLINE Vec3<Double4> inverse(const Vec3<Double4>& x) const {
    const Vec3<Double4> wx = cross(w, x);
    return x - wx * a + cross(w, wx) * b;
  }
};

// Solves the lanes in which the fixed-point iteration is slow.
[[gnu::cold, gnu::noinline]] void solve_lanes_by_newton(const FreeBodySet& e, const Vec3<Double4>& L, double h,
                                                        const Vec3<Double4>& guess, const Double4::Mask& far, Vec3<Double4>& w) {
  const auto lane = [](const Vec3<Double4>& x, int k) { return Vec3<double>::make(x.v[0][k], x.v[1][k], x.v[2][k]); };
  for (int k = 0; k < lanes; ++k)
    if (far[k])
      set(w, k,
          integrator::implicit_angular_velocity_newton(Mat3<double>{lane(e.I.x, k), lane(e.I.y, k), lane(e.I.z, k)}, lane(L, k),
                                                       h, lane(guess, k)));
}

// Solves I w' = exp(-h w') L by fixed-point iteration, in each lane while its change is half the last. Converged lanes stay as they
// are.
DYN_INLINE Vec3<Double4> implicit_angular_velocity(const FreeBodySet& e, const Vec3<Double4>& L, double step,
                                                   const Vec3<Double4>& guess) {
  const Double4 h(step);
  Vec3<Double4> w = guess;
  Double4::Mask going = ~Double4::Mask{}, slow{};
  for (Double4 last(std::numeric_limits<double>::infinity()); any(going);) {
    const Vec3<Double4> next = e.inverse * RotationExp(w * h).inverse(L), change = next - w;
    for (int i = 0; i < 3; ++i) w.v[i] = select(going, next.v[i], w.v[i]);
    const Double4 square = dot(change, change);
    going &= square > Double4(integrator::rounding_square<double>()) * dot(w, w);
    slow |= going & (Double4(4.0) * square >= last), going &= ~slow;
    last = square;
  }
  if (any(slow)) [[unlikely]]
    solve_lanes_by_newton(e, L, step, guess, slow, w);
  const Double4::Mask finite = dot(w, w) < std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) w.v[i] = select(finite, w.v[i], guess.v[i]);
  return w;
}

// Writes the numbers of each active lane to to(lane).
template <class To>
DYN_INLINE void scatter_four(const FreeBodySet& e, const Double4& a, const Double4& b, const Double4& c, const Double4& d,
                             To&& to) {
  for_each_lane(a, b, c, d, [&](int lane, const auto& four) DYN_INLINE_LAMBDA {
    if (e.active_lanes >> lane & 1u) four.store(to(lane));
  });
}
DYN_INLINE void scatter_velocity(const FreeBodySet& e, const Motion<Double4>& v, double* to) {
  const Double4(&u)[3] = v.linear.v, (&w)[3] = v.angular.v;
  scatter_four(e, u[0], u[1], u[2], w[0], [&](int l) { return to + e.v[l]; });
  scatter_four(e, u[2], w[0], w[1], w[2], [&](int l) { return to + e.v[l] + 2; });
}
template <class To>
DYN_INLINE void scatter_vector(const FreeBodySet& e, const Vec3<Double4>& x, To&& to) {
  for_each_lane(x.v[0], x.v[1], x.v[2], Double4(0.0), [&](int lane, const auto& four) DYN_INLINE_LAMBDA {
    if (e.active_lanes >> lane & 1u) std::memcpy(&to(e.body[lane]), &four, sizeof(Vec3<double>));
  });
}

template <class F>
DYN_INLINE void for_each_active(const FreeBodies& l, F&& f) {
  for (Index k = 0; k < l.active_set_count; ++k) f(l.sets[l.active_sets[k]]);
}

}  // namespace

void set_up_free_bodies(const Model& m, FreeBodies& l) {
  std::fill_n(l.number, m.n.bodies, -1);
  l.count = 0;
  for_each_free_body(m, [&](Index i) {
    FreeBodySet& e = l.sets[l.count / lanes];
    const int lane = l.count % lanes;
    for (int k = lane; k < lanes; ++k) fill(m, e, k, i);
    e.active_lanes |= 1u << lane;
    l.columns[l.count] = columns_of(m.bodies()[i]);
    l.number[i] = l.count++;
  });
  l.tree_count = list_trees(m, l.trees);
}

void list_free_bodies(const Model& m, Workspace& w) {
  FreeBodies& l = w.free_bodies;
  if (l.count == 0) return;
  Index groups = 0;
  for (Index k = 0; k * lanes < l.count; ++k) l.sets[k].active_lanes = 0;
  for (Index t = 0; t < l.tree_count; ++t) {
    const Index i = l.trees[t].first, number = l.number[i];
    if (w.sleep.sleeps(i)) continue;
    if (number < 0) append_tree(l.trees[t], l.buffers.groups, groups);
    else l.sets[number / lanes].active_lanes |= 1u << number % lanes;
  }
  l.others = choose_trees(m, l.buffers, groups);
  l.active_set_count = 0;
  for (Index k = 0; k * lanes < l.count; ++k)
    if (l.sets[k].active_lanes) l.active_sets[l.active_set_count++] = k;
}

void begin_free_body_step(Data<double>& d) {
  FreeBodies& l = d.step->free_bodies;
  l.batched = l.count > 0 && !(d.acting & (std::uint32_t(DYN_EFFECT_FLUID | DYN_EFFECT_FLUID_ELLIPSOIDS) | acting_wrenches));
  ++l.step, l.touched_count = 0;
}

void integrate_velocity(const Model&, Data<double>& d, double h) {
  const Double4 dt(h);
  const Vec3<Double4> gravity = Vec3<Double4>::make(d.world_gravity[0], d.world_gravity[1], d.world_gravity[2]);
  Motion<double>* const V = d.step->root_velocity;
  for_each_active(d.step->free_bodies, [&](const FreeBodySet& e) {
    const LanePoses X = poses_of(d.q, e);
    Double4 v[6], tau[6];
    gather<6>(d.v, e.v, v), gather<6>(d.tau_applied, e.v, tau);
    const Vec3<Double4> u = first3(v), w = first3(v + 3), f = first3(tau), t = first3(tau + 3) - cross(e.c, f), L = e.I * w;
    const Vec3<Double4> vc = u + cross(w, e.c) + (transpose_times(X.R, gravity) + f * e.inverse_mass) * dt;
    const Vec3<Double4> w1 = implicit_angular_velocity(e, L + t * dt, h, w + e.inverse * (t - cross(w, L)) * dt);
    const Motion<Double4> v1 = {vc - cross(w1, e.c), w1};
    scatter_velocity(e, v1, d.v);
    if (!V) return;
    scatter_vector(e, X.R.x, [&](Index i) -> auto& { return d.R[i].x; });
    scatter_vector(e, X.R.y, [&](Index i) -> auto& { return d.R[i].y; });
    scatter_vector(e, X.R.z, [&](Index i) -> auto& { return d.R[i].z; });
    scatter_vector(e, X.p, [&](Index i) -> auto& { return d.p[i]; });
    scatter_vector(e, Vec3<Double4>::zero(), [&](Index i) -> auto& { return d.rel[i]; });
    scatter_vector(e, X.R * v1.linear, [&](Index i) -> auto& { return V[i].linear; });
    scatter_vector(e, X.R * v1.angular, [&](Index i) -> auto& { return V[i].angular; });
  });
}

void ensure_columns(const Model& m, Data<double>& d, Index body) {
  FreeBodies& l = d.step->free_bodies;
  if (!l.batched || l.number[body] < 0 || l.has_columns[l.number[body]] == l.step) return;
  const Body& b = m.bodies()[body];
  const FreeBodyColumns& x = l.columns[l.number[body]];
  const Mat3<double>& R = d.R[body];
  for (int k = 0; k < 6; ++k) {
    d.S[b.idx_v + k] = FreeFlyer::column(b, R, k);
    d.U_root[b.idx_v + k] = {R * x.U[k].linear, R * x.U[k].angular};
    d.Dinv[b.idx_v + k] = x.Dinv[k];
  }
  l.has_columns[l.number[body]] = l.step, l.touched[l.touched_count++] = body;
}

void ensure_all_columns(const Model& m, Data<double>& d) {
  for_each_active(d.step->free_bodies, [&](const FreeBodySet& e) {
    for (int k = 0; k < lanes; ++k)
      if (e.active_lanes >> k & 1u) ensure_columns(m, d, e.body[k]);
  });
}

void integrate_position(Data<double>& d, double h, const double* correction) {
  const Double4 dt(h);
  for_each_active(d.step->free_bodies, [&](const FreeBodySet& e) {
    const LanePoses X = poses_of(d.q, e);
    Double4 v[6];
    gather<6>(d.v, e.v, v);
    const Vec3<Double4> w = first3(v + 3), vc = first3(v) + cross(w, e.c);
    Vec3<Double4> moved = vc * dt, turned = w * dt;
    if (correction) {
      Double4 x[6];
      gather<6>(correction, e.v, x);
      moved = moved + first3(x) + cross(first3(x + 3), e.c), turned = turned + first3(x + 3);
    }
    const RotationExp turn(turned);
    const Vec3<Double4> p = X.p + X.R * (e.c + moved - turn(e.c));
    const Quaternion<Double4> a = X.a * turn.quaternion();
    const Double4 r = Double4(1.0) / sqrt(dot(a.v, a.v) + a.w * a.w);
    const Vec3<Double4> n = a.v * r;
    scatter_four(e, p.v[0], p.v[1], p.v[2], n.v[0], [&](int l) { return d.q + e.q[l]; });
    scatter_four(e, n.v[0], n.v[1], n.v[2], a.w * r, [&](int l) { return d.q + e.q[l] + 3; });
    scatter_velocity(e, {turn.inverse(vc) - cross(w, e.c), w}, d.v);
  });
}

}  // namespace dyn::simulation
