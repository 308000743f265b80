// Simulates a soak scene: steps under changing controls, checks of the state, a hash.
#pragma once

#include "soak/scenes.hpp"

namespace soak {

// A simulated scene.
class Simulation {
 public:
  explicit Simulation(const Scene& scene)
      : s(scene), m(scene.build()), q(std::size_t(dyn_model_nq(m))), tau_(std::size_t(dyn_model_nv(m))), turns_(tau_.size()) {
    check(dyn_data_new(m, DYN_PART_SIMULATION | DYN_PART_ENERGY, &d));
    dynStepOptions o;
    dyn_step_options_init(&o);
    o.integrator = s.integrator, o.solver = s.solver, o.dt = s.dt;
    check(dyn_data_set_step_options(m, d, &o));
    check(dyn_data_set_effects(m, d, 0, DYN_EFFECT_DEFAULT | DYN_EFFECT_DAMPING | DYN_EFFECT_FRICTION));
    check(dyn_model_configuration(m, "neutral", q.data()));
    s.place(m, q.data());
    check(dyn_data_set_state(m, d, q.data(), nullptr, nullptr, nullptr));
    q_ = array("q"), v_ = array("v");
    for (int j = 1; j < dyn_model_njoints(m); ++j)
      if (const dynJointInfo info = joint(j); info.type == DYN_JOINT_TYPE_FREE_FLYER)
        for (int k = 3; k < 6; ++k) turns_[std::size_t(info.idx_v + k)] = 1;
  }
  Simulation(const Simulation&) = delete;
  ~Simulation() { dyn_data_free(d), dyn_model_free(m); }

  // One step; controls change every `hold` steps.
  dynStatus step() {
    if (steps % s.hold == 0) {
      for (std::size_t k = 0; k < tau_.size(); ++k) tau_[k] = (turns_[k] ? 0.01 : 1) * s.push * dice();
      check(dyn_data_set_state(m, d, nullptr, nullptr, nullptr, tau_.data()));
    }
    ++steps;
    const dynStatus status = dyn_step(m, d);
    if (status != DYN_OK) return status;
    if (steps % 16 == 0) mix();
    return DYN_OK;
  }
  // Returns what is wrong with the state, or nullptr.
  const char* violation() const {
    dynStepReport r{};
    r.struct_size = sizeof r;
    check(dyn_data_step_report(m, d, &r));
    if (r.penetration > s.bounds.penetration) return "penetration";
    if (r.dropped > 0) return "dropped contacts";
    for (int k = 0; k < dyn_model_nv(m); ++k)
      if (!(v_[k] <= s.bounds.speed && v_[k] >= -s.bounds.speed)) return "speed";
    for (int k = 0; k < dyn_model_nq(m); ++k)
      if (!(q_[k] <= s.bounds.height && q_[k] >= -s.bounds.height)) return "place";
    for (int j = 1; j < dyn_model_njoints(m); ++j) {
      const dynJointInfo info = joint(j);
      if (info.type != DYN_JOINT_TYPE_FREE_FLYER && info.type != DYN_JOINT_TYPE_SPHERICAL) continue;
      const double* x = q_ + info.idx_q + info.nq - 4;
      const double norm = x[0] * x[0] + x[1] * x[1] + x[2] * x[2] + x[3] * x[3];
      if (!(norm > 1 - 1e-12 && norm < 1 + 1e-12)) return "quaternion";
    }
    return nullptr;
  }
  std::uint64_t hash() const { return hash_; }

  // All state that later steps depend on.
  struct Snapshot {
    std::vector<char> memory;
    Dice dice;
    long steps;
    std::uint64_t hash;
  };
  Snapshot save() const {
    Snapshot x{std::vector<char>(dyn_model_state_size(m)), dice, steps, hash_};
    check(dyn_data_save_state(m, d, x.memory.data(), x.memory.size()));
    return x;
  }
  void restore(const Snapshot& x) {
    check(dyn_data_restore_state(m, d, x.memory.data(), x.memory.size()));
    dice = x.dice, steps = x.steps, hash_ = x.hash;
  }

  const Scene& s;
  dynModel* m;
  dynData* d = nullptr;
  Dice dice;
  std::vector<double> q;
  long steps = 0;

 private:
  const double *q_ = nullptr, *v_ = nullptr;
  std::vector<double> tau_;
  std::vector<char> turns_;  // 1: a moment on a free body
  std::uint64_t hash_ = 0xcbf29ce484222325u;

  dynJointInfo joint(int j) const {
    dynJointInfo info{};
    info.struct_size = sizeof info;
    check(dyn_model_joint_info(m, j, &info));
    return info;
  }
  const double* array(const char* name) const {
    dynArray a{};
    a.struct_size = sizeof a;
    check(dyn_data_array(m, d, dyn_field_id(name), &a));
    return a.data;
  }
  // FNV-1a of the state
  void mix() {
    const auto add = [&](const double* x, int n) {
      for (int k = 0; k < n; ++k) {
        std::uint64_t bits;
        __builtin_memcpy(&bits, x + k, 8);
        hash_ = (hash_ ^ bits) * 0x100000001b3u;
      }
    };
    add(q_, dyn_model_nq(m)), add(v_, dyn_model_nv(m));
  }
};

}  // namespace soak
