#include "run.hpp"

#include <algorithm>
#include <cmath>

#include "../system/system.hpp"

namespace cli::accuracy {

namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

void place(const Robot& robot, const Data& data, Sample& s) {
  s.places.resize(12 * static_cast<std::size_t>(robot.nframes));
  check(dyn_forward_kinematics(robot, data, s.q.data(), nullptr, nullptr));
  check(dyn_frame_placements(robot, data, s.places.data()));
  check(dyn_com(robot, data, s.q.data(), nullptr, nullptr, s.com, nullptr, nullptr));
}

Sample look(const Robot& robot, const Data& data) {
  Sample s;
  const double* q = state_view(robot, data, "q");
  s.q.assign(q, q + robot.nq);
  place(robot, data, s);
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

json json_of(const JointRun& r) {
  return {{"wall_s", r.wall_s},     {"evaluations", r.evaluations},
          {"steps", r.steps},       {"penetration", r.penetration},
          {"residual", r.residual}, {"rows", r.rows},
          {"error", r.error},       {"samples", json_of(r.samples)}};
}

JointRun run_of(const Robot& robot, const json& x) {
  JointRun r;
  r.wall_s = x.at("wall_s"), r.evaluations = x.at("evaluations"), r.steps = x.at("steps"), r.penetration = x.at("penetration"),
  r.residual = x.at("residual");
  r.rows = x.at("rows"), r.error = x.at("error"), r.samples = samples_of(robot, x.at("samples"));
  return r;
}

}  // namespace

json json_of(const Samples& samples) {
  json out = json::array();
  for (const Sample& s : samples) out.push_back({s.q, s.energy, s.momentum, s.com});
  return out;
}

Samples samples_of(const Robot& robot, const json& x) {
  const Data data(robot, DYN_PART_FRAMES | DYN_PART_COM);
  Samples out;
  for (const json& s : x) {
    Sample y;
    y.q = s.at(0).get<Vector>(), y.energy = s.at(1);
    if (y.q.size() != static_cast<std::size_t>(robot.nq)) fail("a sample has " + std::to_string(y.q.size()) + " numbers in q.");
    for (std::size_t k = 0; k < 3; ++k) y.momentum[k] = s.at(2).at(k);
    place(robot, data, y);
    for (std::size_t k = 0; k < 3 && s.size() > 3; ++k) y.com[k] = s.at(3).at(k);  // of means: not that of q
    out.push_back(std::move(y));
  }
  return out;
}

JointRun run(const Scene& scene, const Setting& setting) {
  const Robot& robot = scene.robot;
  const Data data(robot, DYN_PART_SIMULATION | DYN_PART_ENERGY | DYN_PART_FRAMES | DYN_PART_CENTROIDAL | DYN_PART_COM,
                  scene.effects);
  set_start(robot, data, scene.start);
  JointRun out;
  const double part = scene.duration / samples, call = part / setting.parts;
  const bool adaptive = setting.accuracy > 0;
  set_stepping(robot, data, setting.integrator.id, adaptive || setting.dt <= 0 ? call : setting.dt,
               adaptive ? setting.accuracy / (samples * setting.parts) : 0, {setting.solver, setting.tolerance});
  Clock::duration wall{};
  for (int k = 0; k < samples; ++k) {
    for (int i = 0; i < setting.parts; ++i) {
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

JointRun run_within(const Scene& scene, const Setting& setting, double most_s) {
  const auto text = compute_apart(
      [&] {
        try {
          return json_of(run(scene, setting)).dump();
        } catch (const Failure& failure) {
          JointRun ended;
          ended.error = failure.message;
          return json_of(ended).dump();
        }
      },
      most_s);
  JointRun out;
  if (!text) return out.error = too_long, out.wall_s = most_s, out;
  try {
    return run_of(scene.robot, json::parse(*text));
  } catch (const json::exception&) {
    return out.error = "its process ended early", out;
  }
}

Error error_between(const Robot& robot, const Samples& a, const Samples& b) {
  Error e;
  const bool end_alone = b.size() == 1;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    const Sample &x = end_alone ? a.back() : a[k], &y = b[k];
    for (int f = 1; f < robot.nframes; ++f) {
      const double *A = x.places.data() + 12 * f, *B = y.places.data() + 12 * f;
      e.m = std::max(e.m, std::hypot(A[9] - B[9], A[10] - B[10], A[11] - B[11]));
      e.rad = std::max(e.rad, angle(A, B));
    }
    e.energy = std::max(e.energy, std::abs(x.energy - y.energy));
    e.momentum = std::max(
        e.momentum, std::hypot(x.momentum[0] - y.momentum[0], x.momentum[1] - y.momentum[1], x.momentum[2] - y.momentum[2]));
  }
  return e;
}

Error statistics_between(const Samples& a, const Samples& b) {
  Error e;
  const auto far = [](const double* x, const double* y) { return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]); };
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    e.m = std::max(e.m, far(a[k].com, b[k].com));
    e.energy = std::max(e.energy, std::abs(a[k].energy - b[k].energy));
    e.momentum = std::max(e.momentum, far(a[k].momentum, b[k].momentum));
  }
  return e;
}

}  // namespace cli::accuracy
