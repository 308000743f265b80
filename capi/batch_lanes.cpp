#if !defined(__clang__)
#pragma GCC diagnostic ignored "-Waggressive-loop-optimizations"  // counts that no memory holds
#endif
#include "batch_lanes.hpp"

#include <new>
#include <vector>

#include "algorithm/aba_derivatives.hpp"
#include "algorithm/jacobian.hpp"
#include "base/lane.hpp"
#include "base/transpose.hpp"
#include "handles.hpp"
#include "simulation/data_layout.hpp"

namespace dyn::capi {

static constexpr int lanes = Lane::count;

struct Lanes::State {
  struct Free {
    void operator()(void* p) const { ::operator delete(p, std::align_val_t(64)); }
  };
  explicit State(const Model& model) : m(model) {}

  const Model& m;
  Data<Lane> d{};
  std::unique_ptr<void, Free> memory;
  std::vector<Lane> fext;
  Lane placement[12];

  // rows of some states to lanes; from null: zeros
  void load(const double* from, std::ptrdiff_t stride, const int* of, Index n, Lane* to) const {
    if (n == 0) return;
    if (!from || stride == 0) return void(std::fill_n(to, n, Lane(0.0)));
    if (of[0] == 0 && of[lanes - 1] == lanes - 1)
      return transpose(from, stride, n, lanes, 1.0, reinterpret_cast<double*>(to), lanes);
    for (Index i = 0; i < n; ++i)
      for (int l = 0; l < lanes; ++l) to[i].x.set(l, from[stride * of[l] + i]);
  }
  // some lanes to rows of states
  void store(const Lane* from, std::ptrdiff_t stride, const int* lane, const int* of, int count, double* to) const {
    const double* const x = reinterpret_cast<const double*>(from);
    if (count == lanes && of[lanes - 1] == lanes - 1) return transpose(x, lanes, lanes, stride, 1.0, to, stride);
    for (int k = 0; k < count; ++k)
      for (std::ptrdiff_t i = 0; i < stride; ++i) to[stride * of[k] + i] = x[lanes * i + lane[k]];
  }
};

namespace {

struct LaneAlgorithm {
  dynAlgorithm algorithm;
  dynParts part;
  Index most;  // degrees of freedom beyond which lanes are slower than single states, by what the algorithm keeps for each
  // Returns whether it succeeded in all lanes, and where the results lie.
  bool (*run)(Lanes::State& s, const dynBatchArrays& x, const Lane* fext, const Lane* (&out)[4]);
};

constexpr Index vectors = 128, matrices = 64, few = 16;  // few: where writing the result takes most of the time

const LaneAlgorithm algorithms[] = {
    {DYN_ALGORITHM_FRAME_PLACEMENT, DYN_PART_KINEMATICS, few,
     [](Lanes::State& s, const dynBatchArrays& x, const Lane*, const Lane* (&out)[4]) {
       forward_kinematics<0>(s.m, s.d), frame_placement(s.m, s.d, x.frame, s.placement);
       return out[0] = s.placement, true;
     }},
    {DYN_ALGORITHM_JOINT_JACOBIANS, DYN_PART_JACOBIANS, few,
     [](Lanes::State& s, const dynBatchArrays&, const Lane*, const Lane* (&out)[4]) {
       joint_jacobians(s.m, s.d);
       return out[0] = s.d.J, true;
     }},
    {DYN_ALGORITHM_RNEA, DYN_PART_INVERSE, vectors,
     [](Lanes::State& s, const dynBatchArrays&, const Lane* fext, const Lane* (&out)[4]) {
       inverse_dynamics<Lane>(s.m, s.d, s.d.v, s.d.a, fext, s.d.tau);
       return out[0] = s.d.tau, true;
     }},
    {DYN_ALGORITHM_NLE, DYN_PART_INVERSE, vectors,
     [](Lanes::State& s, const dynBatchArrays&, const Lane*, const Lane* (&out)[4]) {
       inverse_dynamics<Lane>(s.m, s.d, s.d.v, s.d.zero, nullptr, s.d.nle);
       return out[0] = s.d.nle, true;
     }},
    {DYN_ALGORITHM_GRAVITY_TORQUE, DYN_PART_INVERSE, vectors,
     [](Lanes::State& s, const dynBatchArrays&, const Lane*, const Lane* (&out)[4]) {
       inverse_dynamics<Lane>(s.m, s.d, s.d.zero, s.d.zero, nullptr, s.d.g);
       return out[0] = s.d.g, true;
     }},
    {DYN_ALGORITHM_ABA, DYN_PART_FORWARD, vectors,
     [](Lanes::State& s, const dynBatchArrays&, const Lane* fext, const Lane* (&out)[4]) {
       out[0] = s.d.ddq;
       return forward_dynamics<Lane>(s.m, s.d, s.d.v, s.d.tau_applied, fext, s.d.ddq) == 0;
     }},
    {DYN_ALGORITHM_CRBA, DYN_PART_MASS, few,
     [](Lanes::State& s, const dynBatchArrays&, const Lane*, const Lane* (&out)[4]) {
       crba(s.m, s.d);
       return out[0] = s.d.M, true;
     }},
    {DYN_ALGORITHM_MINV, DYN_PART_MINV, matrices,
     [](Lanes::State& s, const dynBatchArrays&, const Lane*, const Lane* (&out)[4]) {
       out[0] = s.d.Minv;
       return minverse(s.m, s.d) == 0;
     }},
    {DYN_ALGORITHM_RNEA_DERIVATIVES, DYN_PART_INVERSE_DERIVATIVES, matrices,
     [](Lanes::State& s, const dynBatchArrays&, const Lane* fext, const Lane* (&out)[4]) {
       rnea_derivatives<Lane>(s.m, s.d, s.d.v, s.d.a, fext);
       return out[0] = s.d.dtau_dq, out[1] = s.d.dtau_dv, true;
     }},
    {DYN_ALGORITHM_ABA_DERIVATIVES, DYN_PART_FORWARD_DERIVATIVES, matrices,
     [](Lanes::State& s, const dynBatchArrays&, const Lane* fext, const Lane* (&out)[4]) {
       out[0] = s.d.ddq_dq, out[1] = s.d.ddq_dv, out[2] = s.d.Minv;
       return aba_derivatives<Lane>(s.m, s.d, s.d.v, s.d.tau_applied, fext) == 0;
     }},
};

const LaneAlgorithm* find(dynAlgorithm algorithm) {
  for (const LaneAlgorithm& a : algorithms)
    if (a.algorithm == algorithm) return &a;
  return nullptr;
}

constexpr dynParts all_parts = [] {
  dynParts parts = 0;
  for (const dynParts part : {DYN_PART_KINEMATICS, DYN_PART_JACOBIANS, DYN_PART_INVERSE, DYN_PART_FORWARD, DYN_PART_MASS,
                              DYN_PART_CHOLESKY, DYN_PART_MINV, DYN_PART_INVERSE_DERIVATIVES, DYN_PART_FORWARD_DERIVATIVES})
    parts |= part;
  return complete_parts(parts);
}();

// Whether norms of all quaternions have a square and its inverse, so that rotations take one branch.
bool is_ordinary(const Model& m, const double* q) {
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    if (b.type != BodyType::Spherical && b.type != BodyType::FreeFlyer) continue;
    const double* const u = q + b.user_q + (b.type == BodyType::FreeFlyer ? 3 : 0);
    const double square = u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + u[3] * u[3];
    if (!(square > 1e-100 && square < 1e100)) return false;
  }
  return zero_norm_joint(m, q) == 0;
}

}  // namespace

int Lanes::width() { return lanes; }

bool Lanes::has(const Model& m, dynAlgorithm algorithm, dynParts parts) {
  const LaneAlgorithm* const a = find(algorithm);
  if (!a || m.n.nv == 0 || m.n.nvx > a->most) return false;
  const dynParts needed = a->part | (m.has_mimic && (a->part & DYN_PART_FORWARD) ? dynParts(DYN_PART_CHOLESKY) : 0);
  return (parts & needed) == needed;
}

Lanes::Lanes(const Model& m, dynParts parts) : s(new State(m)) {
  dynParts wanted = DYN_PART_KINEMATICS;
  for (const LaneAlgorithm& a : algorithms)
    if (has(m, a.algorithm, parts)) wanted |= a.part | (m.has_mimic ? dynParts(DYN_PART_CHOLESKY) : 0);
  const std::size_t bytes = data_bytes<Lane, all_parts>(m, wanted);
  s->memory.reset(::operator new(bytes, std::align_val_t(64)));
  std::memset(s->memory.get(), 0, bytes);
  data_layout<all_parts>(m, wanted, s->memory.get(), s->d);
  s->fext.resize(6 * std::size_t(m.n.joints));
}
Lanes::Lanes(Lanes&&) noexcept = default;
Lanes::~Lanes() = default;

bool Lanes::set_effects(const Data<double>& single) {
  Data<Lane>& d = s->d;
  for (Index j = 0; j < s->m.n.joints; ++j) d.effects[j] = single.chosen_effects[j] & std::uint32_t(DYN_EFFECT_ALL);
  apply_effects(s->m, d);
  return !resists(d);
}

unsigned Lanes::run(dynAlgorithm algorithm, const dynBatchArrays& x, std::int64_t first, int count, const BatchStrides& stride) {
  const Model& m = s->m;
  Data<Lane>& d = s->d;
  const auto row = [&](const double* array, std::ptrdiff_t size) { return array ? array + first * size : nullptr; };
  const std::ptrdiff_t nfext = 6 * std::ptrdiff_t(m.n.joints);
  const double *q = row(x.q, m.n.nq), *v = row(x.v, stride.v), *a = row(x.a, stride.a), *tau = row(x.tau, stride.tau),
               *fext = row(x.fext, nfext);
  const auto finite = [](const double* p, std::ptrdiff_t size, int k, Index n) {
    return !p || size == 0 || finite_count(p + size * k, n) == n;
  };
  int of[lanes], good = 0;
  for (int k = 0; k < count; ++k)
    if (finite(q, m.n.nq, k, m.n.nq) && finite(v, stride.v, k, m.n.nv) && finite(a, stride.a, k, m.n.nv) &&
        finite(tau, stride.tau, k, m.n.nv) && finite(fext, nfext, k, Index(nfext)) && is_ordinary(m, q + m.n.nq * k))
      of[good++] = k;
  unsigned done = 0;
  // of the first n of `states`; the lanes beyond repeat the first one
  const auto compute = [&](const int* states, int n) {
    int in[lanes];
    for (int l = 0; l < lanes; ++l) in[l] = states[l < n ? l : 0];
    s->load(q, m.n.nq, in, m.n.nq, d.q), s->load(v, stride.v, in, m.n.nv, d.v);
    if (d.a) s->load(a, stride.a, in, m.n.nv, d.a);
    if (d.tau_applied) s->load(tau, stride.tau, in, m.n.nv, d.tau_applied);
    if (fext) s->load(fext, nfext, in, Index(nfext), s->fext.data());
    for (const Input which : {input_q, input_v, input_a, input_tau}) d.changed(which);
    const Lane* out[4] = {};
    if (!find(algorithm)->run(*s, x, fext ? s->fext.data() : nullptr, out)) return false;
    Lane::Numbers sum = Lane::Numbers::zero();  // 0 times what is not finite is not a number
    for (int o = 0; o < 4; ++o)
      for (std::ptrdiff_t i = 0; out[o] && i < stride.out[o]; ++i) sum = sum + out[o][i].x * 0.0;
    int finite = 0, lane[lanes];
    for (int l = 0; l < n; ++l)
      if (sum[l] == 0) done |= 1u << in[l], lane[finite] = l, in[finite++] = in[l];
    for (int o = 0; o < 4; ++o)
      if (out[o] && x.out[o]) s->store(out[o], stride.out[o], lane, in, finite, x.out[o] + first * stride.out[o]);
    return true;
  };
  if (good > 0 && !compute(of, good))
    for (int k = 0; k < good; ++k) compute(of + k, 1);
  return done;
}

}  // namespace dyn::capi
