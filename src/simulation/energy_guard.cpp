#include "simulation/energy_guard.hpp"

#include <algorithm>
#include <complex>

#include "algorithm/actuators.hpp"
#include "algorithm/effects.hpp"
#include "algorithm/external_forces.hpp"
#include "algorithm/constrained/constrained_dynamics.hpp"
#include "algorithm/kinematics.hpp"

namespace dyn::simulation {

namespace {

// Whether no size of x[0 .. n-1] is more than `most`, or not a number.
bool all_within(const double* x, Index n, double most) {
  Index k = 0;
  bool within = true;
  if (n >= Double4::lanes) {
    auto all_of_them = abs(Double4::load(x + n - Double4::lanes)) <= Double4(most);
    for (; k + Double4::lanes < n; k += Double4::lanes) all_of_them &= abs(Double4::load(x + k)) <= Double4(most);
    return all(all_of_them);
  }
  for (; k < n; ++k) within &= std::abs(x[k]) <= most;
  return within;
}

bool flies_alone(const Model& m, Index i) {
  return m.bodies()[i].type == BodyType::FreeFlyer && m.bodies()[i].parent == 0 && m.subtree_end()[i] == i + 1;
}

// Whether joints turn by more than guarded_motion rad, or slide by that share of the length scale. Free bodies keep their momentum,
// and gain no energy up to a third of a turn.
bool moves_far(const Model& m, const Data<double>& d, const double* v, double h) {
  static constexpr Index sizes[] = {1, 1, 1, 1, 3, 6};  // degrees of freedom by BodyType
  const double motion = d.step->guarded_motion;
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    if (flies_alone(m, i)) {
      const Vec3<double> turn = load3(v + b.user_v + 3) * h;
      if (!(dot(turn, turn) <= tuning::guard::turn * tuning::guard::turn)) return true;
      continue;
    }
    const double unit = b.type == BodyType::Prismatic ? d.step->length : 1;
    const Index first = b.type == BodyType::FreeFlyer ? 3 : 0;
    for (Index k = b.user_v + first, end = b.user_v + sizes[Index(b.type)]; k < end; ++k)
      if (!(std::abs(v[k]) * h <= motion * unit)) return true;
  }
  return false;
}

[[gnu::cold, gnu::noinline]] bool may_gain_at_speed(const Model& m, const Data<double>& d, double h) {
  return d.step->rows_add_energy || moves_far(m, d, d.v, h) || moves_far(m, d, d.backup + m.n.nq, h);
}

// Gains and damping of an actuator's force at its end, as those of a joint.
struct Gains {
  double stiffness, damping;
};
Gains gains_of(const ActuatorRecord& r, const Data<double>& d) {
  const double gear = r.spec.gear * r.spec.gear, f = actuator_force(r, d);
  if (f <= r.spec.force_range[0] || f >= r.spec.force_range[1]) return {0, 0};
  return {r.q >= 0 ? gear * std::max(0.0, -r.bias[1]) : 0, gear * std::max(0.0, -r.bias[2])};
}

// Energy of what drives: -integral of f dl of its part that depends on the length alone, f = f0 + b l. At the end of its range
// f is constant.
double actuator_energy(const ActuatorRecord& r, const Data<double>& d) {
  const double l = r.spec.gear * d.q[r.q], b = r.bias[1], total = actuator_force(r, d);
  const double f = unbounded_force(r, d, r.act >= 0 ? d.act[r.act] : command(r, d), d.q[r.q], 0.0), f0 = f - b * l;
  if (total > r.spec.force_range[0] && total < r.spec.force_range[1]) return -f0 * l - 0.5 * b * l * l;
  const double joined = b != 0 ? (total - f0) / b : 0;  // the length at which the range ends
  return -total * l + (b != 0 ? 0.5 * b * joined * joined : 0);
}

}  // namespace

double guarded_motion(const Model& m, double* subtree) {
  double ratio = 1;
  for (Index i = 1; i < m.n.bodies; ++i) subtree[i - 1] = m.bodies()[i].m;
  for (Index i = m.n.bodies - 1; i > 0; --i) {
    const Body& b = m.bodies()[i];
    if (b.m > 0) ratio = std::max(ratio, subtree[i - 1] / b.m);
    if (b.parent > 0) subtree[b.parent - 1] += subtree[i - 1];
  }
  return tuning::guard::motion * std::min(1.0, tuning::guard::usual_ratio / ratio);
}

bool may_gain_energy(const Model& m, Data<double>& d, double h) {
  Workspace& w = *d.step;
  const bool looks = w.ends_fast | w.rows_add_energy;
  const double most = w.guarded_motion / h;
  bool slow = true;
  with_active_trees(d, [&](const auto& part) {
    part.for_each_group(m, [&](const Trees& t) { slow &= all_within(d.v + t.v, t.v_end - t.v, most); });
  });
  w.ends_fast = !slow;
  if (slow && !looks) [[likely]] return false;
  return may_gain_at_speed(m, d, h);
}

bool moves(const Model& m, const Data<double>& d, double h) {
  const double least = tuning::slop * std::min(1.0, d.step->length) / h;
  return !std::all_of(d.v, d.v + m.n.nv, [&](double v) { return std::abs(v) <= least; });
}

StepEnergy step_energy(const Model& m, Data<double>& d, double* memory) {
  d.invalidate(Stage::Position), d.invalidate(Stage::Velocity);
  const double* const fext = forces_on_bodies(m, d);
  forward_kinematics<0>(m, d);
  auto* const vectors = reinterpret_cast<Vec3<double>*>((reinterpret_cast<std::uintptr_t>(memory) + 63) / 64 * 64);
  const Motions<double> motions{vectors, vectors + m.n.bodies, nullptr, nullptr};
  motions.omega[0] = motions.vel[0] = Vec3<double>::zero();
  const double* const v = d.expand(m, static_cast<const double*>(d.v), d.vx);
  const Vec3<double> g = load3(d.world_gravity);
  StepEnergy out{};
  Index largest = 1;
  double most = 0;
  forward(m, [&]<class J>(Index i) {
    const Body& b = m.bodies()[i];
    const Mat3<double>& R = d.R[i];
    move_body<1, J>(b, i, motions, R, d.p[i] - d.p[b.parent], v, static_cast<const double*>(nullptr));
    const Vec3<double> h = R * b.h, u = motions.vel[i], w = motions.omega[i], wB = transpose_times(R, w);
    const double kinetic = 0.5 * (b.m * dot(u, u) + 2 * dot(u, cross(w, h)) + dot(wB, b.I * wB));
    out.kinetic += kinetic, out.gravity -= dot(g, d.p[i] * b.m + h);
    out.falling += dot(g, u * b.m + cross(w, h));
    if (kinetic > most) most = kinetic, largest = i;
  });
  for (Index k = 0; k < m.n.nv; ++k) out.kinetic += 0.5 * d.armature[k] * d.v[k] * d.v[k];
  if (d.acting & DYN_EFFECT_SPRINGS) out.springs = spring_energy(m, d);
  if (m.n.paths > 0) measure_paths(m, d), take_limits(m, d);
  out.springs += tendon_energy(m, d), out.kinetic += tendon_kinetic_energy(m, d);
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index) {
    if (r.q >= 0) out.actuators += actuator_energy(r, d);
    out.driving += std::max(0.0, r.spec.gear * actuator_force(r, d) * stroke_of(r, d).v);
  });
  for (Index j = 1; fext && j < m.n.joints; ++j) {
    const Index body = m.joints()[j].last_body;
    const Mat3<double> R = d.R[body] * m.joints()[j].C;
    out.power += dot(R * load3(fext + 6 * j), motions.vel[body]) + dot(R * load3(fext + 6 * j + 3), motions.omega[body]);
  }
  for (Index j = 1; j < m.n.joints; ++j)
    if (m.joints()[j].last_body <= largest) out.fastest = j;
  d.invalidate(Stage::Position), d.invalidate(Stage::Velocity);
  return out;
}

void add_gain(const Model& m, const Data<double>& d, const StepEnergy& before, const StepEnergy& after, const double* v0,
              double h, bool stored, EnergyGain& sum) {
  const double* const v = d.v;
  const auto work = [&](double force, Index k) { return std::max(0.0, h * force * (v0[k] + v[k]) / 2); };
  double given = d.step->rows_work + h * std::max({0.0, before.power, after.power});
  given += std::max(before.actuators - after.actuators, h * std::max(before.driving, after.driving));
  const double released = before.springs - after.springs;
  given += std::max(0.0, released);
  for (Index k = 0; k < m.n.nv; ++k) given += work(d.tau_applied[k], k);
  const double rounding = tuning::guard::rounding * (std::abs(before.potential()) + std::abs(after.potential()));
  const double rise = stored ? std::max(0.0, after.springs + after.actuators - before.springs - before.actuators) : 0;
  const double fallen = std::max({before.gravity - after.gravity, h * before.falling, h * after.falling});
  given += std::max(0.0, fallen);
  sum.base += given, sum.gain += after.kinetic - before.kinetic + rise - given - rounding, sum.taken += std::max(0.0, -fallen);
  if (!stored && !d.step->corrected) sum.taken += std::max(0.0, -released);
}

void forget_forces(Workspace& w) {
  for (Index k = 0; k < w.contact_count; ++k) copy_force(w.contacts[k], nullptr);
  std::fill_n(w.limit_forces, w.limits, 0.0);
}

Index unstable_joint(const Model& m, const Data<double>& d, double h, std::span<const double> R, double& length) {
  constexpr std::uint32_t stiff = DYN_EFFECT_SPRINGS | DYN_EFFECT_ACTUATORS | effect_bits([]<class E>() {
    if constexpr (effect::OfVelocity<E>) return !E::bounded;
    else return false;
  });
  if (!(d.acting & stiff) || m.has_mimic) return 0;
  const auto amplification = [&](std::complex<double> z) {
    std::complex<double> sum = 0;
    for (std::size_t k = R.size(); k-- > 0;) sum = sum * z + R[k];
    return std::abs(sum);
  };
  for (Index j = 1; j < m.n.joints; ++j) {
    for (Index k = m.joints()[j].idx_v; k < m.joints()[j].idx_v + m.joints()[j].nv; ++k) {
      double stiffness = d.acting & DYN_EFFECT_SPRINGS ? d.stiffness[k] : 0;
      double damping = 0;
      for_each_velocity_law(d, [&]<class E>(const double* c) {
        if constexpr (!E::bounded) damping += E::slope(c[k], d.v[k]);
      });
      for_each_actuator(m, d, [&](const ActuatorRecord& r, Index) {
        if (r.v == k) stiffness += gains_of(r, d).stiffness, damping += gains_of(r, d).damping;
      });
      const double Dinv = d.Dinv[k], half = damping * Dinv / 2;
      const std::complex<double> root = std::sqrt(std::complex<double>(half * half - stiffness * Dinv));
      const std::complex<double> s = -half - root;  // the faster one
      if (amplification(h * s) <= tuning::guard::amplification) continue;
      double low = 0, high = h;  // bisection of the longest stable step
      for (int n = 0; n < 20; ++n) {
        const double middle = 0.5 * (low + high);
        (amplification(middle * s) <= tuning::guard::amplification ? low : high) = middle;
      }
      return length = low, j;
    }
  }
  return 0;
}

}  // namespace dyn::simulation
