#include "run.hpp"

#include <algorithm>
#include <cmath>

namespace cli::accuracy {

namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

Sample look(const Robot& robot, const Data& data) {
  Sample s;
  const double* q = state_view(robot, data, "q");
  s.q.assign(q, q + robot.nq);
  s.places.resize(12 * static_cast<std::size_t>(robot.nframes));
  check(dyn_forward_kinematics(robot, data, nullptr, nullptr, nullptr));
  check(dyn_frame_placements(robot, data, s.places.data()));
  double kinetic, potential, momentum[6];
  check(dyn_energy(robot, data, nullptr, nullptr, &kinetic, &potential));
  check(dyn_centroidal_momentum(robot, data, nullptr, nullptr, momentum));
  s.energy = kinetic + potential;
  std::copy(momentum, momentum + 3, s.momentum);
  return s;
}

// Angle of A^T B, from the sine's norm and the cosine: accurate where it is small.
double angle(const double* A, const double* B) {
  double R[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      R[i + 3 * j] = 0;
      for (int k = 0; k < 3; ++k) R[i + 3 * j] += A[k + 3 * i] * B[k + 3 * j];
    }
  const double s = std::hypot(R[5] - R[7], R[6] - R[2], R[1] - R[3]) / 2, c = (R[0] + R[4] + R[8] - 1) / 2;
  return std::atan2(s, c);
}

}  // namespace

Run run(const Scene& scene, const Setting& setting, int split, double most_s) {
  const Robot& robot = scene.robot;
  const Data data(robot, DYN_PART_SIMULATION | DYN_PART_ENERGY | DYN_PART_FRAMES | DYN_PART_CENTROIDAL, scene.effects);
  set_start(robot, data, scene.start);
  Run out;
  const double part = scene.duration / samples, call = part / split;
  const bool adaptive = setting.accuracy > 0;
  set_stepping(robot, data, setting.integrator.id, adaptive || setting.dt <= 0 ? call : setting.dt, adaptive ? setting.accuracy / (samples * split) : 0,
               {setting.solver, setting.tolerance});
  Clock::duration wall{};
  for (int k = 0; k < samples; ++k) {
    for (int i = 0; i < split; ++i) {
      const auto before = Clock::now();
      const dynStatus status = dyn_advance(robot, data, call);
      wall += Clock::now() - before;
      dynStepReport report{};
      report.struct_size = sizeof report;
      if (status == DYN_OK) {
        check(dyn_data_step_report(robot, data, &report));
        out.evaluations += report.evaluations, out.steps += report.steps;
        out.penetration = std::max(out.penetration, report.penetration), out.residual = std::max(out.residual, report.residual);
        out.rows = std::max(out.rows, int(report.rows));
      } else {
        out.error = dyn_last_error();
      }
      if (out.error.empty() && seconds(wall) > most_s) out.error = "it took longer than what is left of the budget";
      if (!out.error.empty()) return out.wall_s = seconds(wall), out;
    }
    try {
      out.samples.push_back(look(robot, data));
    } catch (const Failure& failure) {  // a state so large that its energy is none
      out.error = failure.message;
      return out.wall_s = seconds(wall), out;
    }
  }
  out.wall_s = seconds(wall);
  return out;
}

Error error_between(const Robot& robot, const Run& a, const Run& b) {
  Error e;
  const bool end_alone = b.samples.size() == 1;
  for (std::size_t k = 0; k < std::min(a.samples.size(), b.samples.size()); ++k) {
    const Sample &x = end_alone ? a.samples.back() : a.samples[k], &y = b.samples[k];
    for (int f = 1; f < robot.nframes; ++f) {
      const double *A = x.places.data() + 12 * f, *B = y.places.data() + 12 * f;
      e.m = std::max(e.m, std::hypot(A[9] - B[9], A[10] - B[10], A[11] - B[11]));
      e.rad = std::max(e.rad, angle(A, B));
    }
    e.energy = std::max(e.energy, std::abs(x.energy - y.energy));
    e.momentum = std::max(e.momentum, std::hypot(x.momentum[0] - y.momentum[0], x.momentum[1] - y.momentum[1], x.momentum[2] - y.momentum[2]));
  }
  return e;
}

}  // namespace cli::accuracy
