// Scenes of which a step's instructions are counted: a free body, a chain of ten links, and what may be in a scene without
// acting.
#pragma once

#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "count.hpp"
#include "dyn.h"

namespace bench {

inline std::string scene(const std::string& world, const char* gravity = "0 0 -9.81") {
  return std::string("<mujoco><option gravity='") + gravity + "'/><worldbody>" + world + "</worldbody></mujoco>";
}
inline std::string free_body(const char* mask) {
  return std::string("<body pos='0 0 1'><freejoint/><geom type='box' size='.1 .1 .1' mass='1' ") + mask + "/></body>";
}
// Hinges about y, all with the attributes; the first link level.
inline std::string chain(int links, const char* joint, const char* mask) {
  std::string text;
  for (int k = links - 1; k >= 0; --k)
    text = std::string("<body pos='") + (k ? ".1" : "0") + " 0 0'><joint axis='0 1 0' " + joint +
           "/><geom type='capsule' fromto='0 0 0 .1 0 0' size='.02' mass='.1' " + mask + "/>" + text + "</body>";
  return text;
}
// Boxes that nothing comes near, and that no ball about all of them hides.
inline std::string far_boxes(int n) {
  std::string text;
  for (int k = 0; k < n; ++k) {
    char box[160];
    std::snprintf(box, sizeof box, "<geom type='box' contype='0' conaffinity='1' size='.1 .1 .1' pos='%d %d %d'/>", 10 + k % 10,
                  (k / 10) % 10 - 5, k / 100 - 5);
    text += box;
  }
  return text;
}
inline const char *masked = "contype='0' conaffinity='0'", *touching = "contype='1' conaffinity='0'",
                  *limited = "limited='true' range='-170 170'", *damped = "damping='.1'";

// A model and a data in which a few steps have been made.
struct Counted {
  dynModel* m = nullptr;
  dynData* d = nullptr;
  std::string error;
  Counted(const std::string& text, std::uint32_t effects = DYN_EFFECT_ALL & ~DYN_EFFECT_SLEEPING) {
    dynLoadOptions load;
    dyn_load_options_init(&load);
    if (dyn_model_load_string(text.c_str(), &load, &m) || dyn_data_new(m, DYN_PART_SIMULATION, &d) ||
        dyn_data_set_effects(m, d, 0, effects))
      error = dyn_last_error();
  }
  Counted(const Counted&) = delete;
  ~Counted() { dyn_data_free(d), dyn_model_free(m); }
  void warm() {
    for (int k = 0; k < 5 && error.empty(); ++k)
      if (dyn_step(m, d)) error = dyn_last_error();
  }
  // Of the next step; -1: not to be counted.
  long step() {
    warm();
    return error.empty() ? instructions([this] { dyn_step(m, d); }) : -1;
  }
  // Of forward dynamics and an integration alone.
  long bare() {
    const std::size_t nv = std::size_t(dyn_model_nv(m)), nq = std::size_t(dyn_model_nq(m));
    std::vector<double> q(nq), q1(nq), v(nv, 0.1), tau(nv, 0), hv(nv, 1e-4);
    std::vector<double> ddq(nv);
    if (dyn_configuration_neutral(m, q.data())) return -1;
    auto run = [&] {
      dyn_aba(m, d, q.data(), v.data(), tau.data(), nullptr, ddq.data());
      for (std::size_t k = 0; k < nv; ++k) hv[k] = 1e-3 * (v[k] += 1e-3 * ddq[k]);
      dyn_integrate(m, q.data(), hv.data(), q1.data());
    };
    run();
    return instructions(run);
  }
};

}  // namespace bench
