#include "recording.hpp"

#include <algorithm>
#include <cmath>

#include "../stepping.hpp"

namespace cli::page {

namespace {

constexpr std::size_t max_bytes = 2'500'000;
constexpr double moment = 1.0 / 60;

struct Pose {
  double x[3], turn[4];
};

// The joint's, from that of a frame it carries: X_WJ = X_WF X_JF^-1; the rotation as a quaternion (x, y, z, w).
Pose joint_pose(const double world[12], const double local[12]) {
  double r[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r[i][j] = world[i] * local[j] + world[i + 3] * local[j + 3] + world[i + 6] * local[j + 6];
  Pose out;
  for (int i = 0; i < 3; ++i) out.x[i] = world[9 + i] - (r[i][0] * local[9] + r[i][1] * local[10] + r[i][2] * local[11]);
  // Shepperd 1978: the largest component first
  const double trace[4] = {r[0][0] - r[1][1] - r[2][2], r[1][1] - r[2][2] - r[0][0], r[2][2] - r[0][0] - r[1][1],
                           r[0][0] + r[1][1] + r[2][2]};
  const auto k = static_cast<int>(std::max_element(trace, trace + 4) - trace);
  double* t = out.turn;
  if (k == 3) {
    t[3] = 1 + trace[3], t[0] = r[2][1] - r[1][2], t[1] = r[0][2] - r[2][0], t[2] = r[1][0] - r[0][1];
  } else {
    const int a = k, b = (k + 1) % 3, c = (k + 2) % 3;
    t[a] = 1 + trace[k], t[b] = r[a][b] + r[b][a], t[c] = r[c][a] + r[a][c], t[3] = r[c][b] - r[b][c];
  }
  const double norm = std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2] + t[3] * t[3]);
  for (double& x : out.turn) x /= norm;
  return out;
}

}  // namespace

std::vector<std::string> coordinate_names(const Robot& robot, bool of_q) {
  std::vector<std::string> out(static_cast<std::size_t>(of_q ? robot.nq : robot.nv));
  for (int j = 1; j < robot.njoints; ++j) {
    const dynJointInfo joint = robot.joint(j);
    const int first = of_q ? joint.idx_q : joint.idx_v, n = of_q ? joint.nq : joint.nv;
    for (int k = 0; k < n; ++k)
      out[static_cast<std::size_t>(first + k)] = joint.name + (n > 1 ? "[" + std::to_string(k) + "]" : std::string());
  }
  return out;
}

Recording::Recording(const Robot& robot, std::uint32_t effects)
    : robot_(robot),
      mind_(robot, DYN_PART_KINEMATICS | DYN_PART_COM, effects),
      frame_of_(static_cast<std::size_t>(robot.njoints), 0),
      muscle_of_(static_cast<std::size_t>(dyn_model_ntendons(robot)), -1),
      every_(moment) {
  for (int f = robot.nframes - 1; f >= 0; --f) frame_of_[static_cast<std::size_t>(robot.frame(f).joint)] = f;
  for (int k = 0; k < dyn_model_nactuators(robot); ++k) {
    dynActuator a{};
    a.struct_size = sizeof a;
    check(dyn_model_actuator_info(robot, k, &a));
    if (a.type == DYN_ACTUATOR_TYPE_MUSCLE && a.transmission == DYN_TRANSMISSION_TENDON)
      muscle_of_[static_cast<std::size_t>(a.tendon)] = a.idx_act;
  }
}

void Recording::poses(const double* q, Vector& positions, Vector& turns, Vector& com) const {
  com.assign(3, 0);
  check(dyn_com(robot_, mind_, q, nullptr, nullptr, com.data(), nullptr, nullptr));
  check(dyn_forward_kinematics(robot_, mind_, q, nullptr, nullptr));
  for (int j = 1; j < robot_.njoints; ++j) {
    double world[12];
    const int f = frame_of_[static_cast<std::size_t>(j)];
    check(dyn_frame_placement(robot_, mind_, f, world));
    const Pose pose = joint_pose(world, robot_.frame(f).placement);
    positions.insert(positions.end(), pose.x, pose.x + 3), turns.insert(turns.end(), pose.turn, pose.turn + 4);
  }
}

Vector Recording::tendons(const Data& simulated, const double* q) const {
  Vector out;
  if (muscle_of_.empty()) return out;
  check(dyn_tendons(robot_, mind_, q, nullptr, nullptr, nullptr, nullptr));
  for (std::size_t t = 0; t < muscle_of_.size(); ++t) {
    const int count = dyn_tendon_path(robot_, mind_, static_cast<int>(t), 0, nullptr, nullptr);
    if (count < 0) fail(library_error());
    Vector points(3 * static_cast<std::size_t>(count));
    std::vector<std::int32_t> begins(static_cast<std::size_t>(count));
    dyn_tendon_path(robot_, mind_, static_cast<int>(t), count, points.data(), begins.data());
    const double activation = muscle_of_[t] < 0 ? -1 : field(robot_, simulated, "act")[static_cast<std::size_t>(muscle_of_[t])];
    for (std::size_t k = 1; k < begins.size(); ++k) {
      if (begins[k]) continue;
      const auto from = points.begin() + 3 * static_cast<std::ptrdiff_t>(k - 1);
      out.insert(out.end(), from, from + 6);
      out.push_back(activation);
    }
  }
  return out;
}

Recording::Sample Recording::sample_of(const Data& simulated, const Moment& m) const {
  Sample s{m.time,
           {},
           {},
           {},
           Vector(m.q, m.q + robot_.nq),
           Vector(m.v, m.v + robot_.nv),
           Vector(m.tau, m.tau + robot_.nv),
           {},
           {m.kinetic, m.potential, m.kinetic + m.potential},
           {},
           {},
           tendons(simulated, m.q),
           {}};
  poses(m.q, s.positions, s.turns, s.com);
  if (dyn_model_nactuators(robot_)) s.actuators = field(robot_, simulated, "actuator_force");
  int count = 0;
  check(dyn_data_step_contacts(robot_, simulated, nullptr, 0, &count));
  std::vector<dynContactForce> contacts(static_cast<std::size_t>(count));
  check(dyn_data_step_contacts(robot_, simulated, contacts.data(), count, &count));
  for (const dynContactForce& c : contacts) {
    Contact k{
        {}, {}, c.contact.distance, static_cast<std::uint32_t>(c.contact.shape_a), static_cast<std::uint32_t>(c.contact.shape_b)};
    std::copy(c.contact.position, c.contact.position + 3, k.position), std::copy(c.force_on_b, c.force_on_b + 3, k.force);
    s.contacts.push_back(k);
  }
  return s;
}

void Recording::add(const Data& simulated, const Moment& m, const Ledger* ledger, double step_s) {
  Sample s = sample_of(simulated, m);
  dynStepReport report{};
  report.struct_size = sizeof report;
  check(dyn_data_step_report(robot_, simulated, &report));
  s.solver = {report.residual, report.penetration, double(report.contacts), double(report.iterations), 1e6 * step_s};
  if (ledger) s.ledger = ledger->sums_so_far();
  contacts_ += s.contacts.size(), pieces_ += s.tendons.size();
  samples_.push_back(std::move(s));
  next_ = std::max(next_ + every_, m.time);  // steps longer than a moment: each of them
  if (numbers() > max_bytes) thin();
}

std::size_t Recording::numbers() const {
  const Sample& s = samples_.front();
  const std::size_t each = 4 + 2 * (s.positions.size() + s.turns.size() + 3 + s.q.size() + s.v.size() + s.tau.size() +
                                    s.actuators.size() + s.energy.size() + s.solver.size() + s.ledger.size());
  return each * samples_.size() + 24 * contacts_ + 2 * pieces_;
}

// Every second moment goes, and only every second one comes.
void Recording::thin() {
  std::vector<Sample> kept;
  contacts_ = pieces_ = 0;
  for (std::size_t k = 0; k < samples_.size(); k += 2)
    contacts_ += samples_[k].contacts.size(), pieces_ += samples_[k].tendons.size(),
        kept.push_back(std::move(samples_[k]));
  samples_ = std::move(kept);
  every_ *= 2;
  next_ = samples_.back().time + every_;
}

json Recording::packed(Pack& pack, json& notes) const {
  if (every_ > moment)
    notes.push_back("the recording is thinned to " + short_number(1 / every_, 3) + " moments a second, for the page's size");
  const auto all = [&](Vector Sample::*what) {
    Vector out;
    for (const Sample& s : samples_) out.insert(out.end(), (s.*what).begin(), (s.*what).end());
    return out;
  };
  const std::size_t joints = static_cast<std::size_t>(robot_.njoints) - 1;
  Vector time;
  for (const Sample& s : samples_) time.push_back(s.time);
  json out = {{"moments", samples_.size()},
              {"time", pack.f32(time)},
              {"positions", pack.q16(all(&Sample::positions), 3 * joints)},
              {"turns", pack.q16(all(&Sample::turns), 4 * joints)},
              {"com", pack.q16(all(&Sample::com), 3)}};
  json plots = json::array();
  // columns of what, the first of them and as many as there are names
  const auto plot = [&](const char* title, const char* unit, const std::vector<std::string>& names, Vector Sample::* what,
                        std::size_t first = 0) {
    if (names.empty()) return;
    Vector values;
    for (const Sample& s : samples_)
      values.insert(values.end(), (s.*what).begin() + static_cast<std::ptrdiff_t>(first),
                    (s.*what).begin() + static_cast<std::ptrdiff_t>(first + names.size()));
    plots.push_back({{"title", title}, {"unit", unit}, {"names", names}, {"values", pack.q16(values, names.size())}});
  };
  plot("energy", "J", {"kinetic", "potential", "mechanical"}, &Sample::energy);
  plot("q", "rad, m", coordinate_names(robot_, true), &Sample::q);
  plot("v", "rad/s, m/s", coordinate_names(robot_, false), &Sample::v);
  plot("tau", "N m, N", coordinate_names(robot_, false), &Sample::tau);
  std::vector<std::string> actuators;
  for (int k = 0; k < dyn_model_nactuators(robot_); ++k) actuators.emplace_back(dyn_model_actuator_name(robot_, k));
  plot("actuators", "N m, N", actuators, &Sample::actuators);
  plot("residual", "of the contact solver", {"residual"}, &Sample::solver);
  plot("penetration", "m", {"penetration"}, &Sample::solver, 1);
  plot("contacts", "points; iterations of the solver", {"contacts", "iterations"}, &Sample::solver, 2);
  plot("time of a step", "us", {"time"}, &Sample::solver, 4);
  if (!samples_.front().ledger.empty()) plot("ledger", "J", Ledger::sum_names(), &Sample::ledger);
  out["plots"] = std::move(plots);

  Vector position, force, distance;
  std::vector<std::uint32_t> first = {0}, shapes;
  for (const Sample& s : samples_) {
    for (const Contact& c : s.contacts) {
      position.insert(position.end(), c.position, c.position + 3), force.insert(force.end(), c.force, c.force + 3),
          distance.push_back(c.distance);
      shapes.insert(shapes.end(), {c.a, c.b});
    }
    first.push_back(static_cast<std::uint32_t>(distance.size()));
  }
  out["contacts"] = {{"first", pack.indices(first)},
                     {"position", pack.q16(position, 3)},
                     {"force", pack.f32(force)},
                     {"distance", pack.q16(distance, 1)},
                     {"shapes", pack.indices(shapes)}};
  if (pieces_ == 0) return out;
  std::vector<std::uint32_t> begins = {0};
  for (const Sample& s : samples_) begins.push_back(begins.back() + static_cast<std::uint32_t>(s.tendons.size() / 7));
  out["tendons"] = {{"first", pack.indices(begins)}, {"pieces", pack.q16(all(&Sample::tendons), 7)}};
  return out;
}

json head(const char* kind, const RobotOptions& options, const Robot& robot, const Recording& recording, Pack& pack, json notes) {
  json out = {{"kind", kind}, {"file", options.file}, {"version", dyn_version()}, {"build", dyn_build_info()}};
  out["model"] = model_json(robot, options.package_dirs, pack, notes);
  out["recording"] = recording.packed(pack, notes);
  out["notes"] = std::move(notes);
  return out;
}

json still(const char* kind, const RobotOptions& options, const Robot& robot, const State& state, std::uint32_t effects,
           Pack& pack, const json& notes) {
  const Data data(robot, DYN_PART_SIMULATION | DYN_PART_ENERGY, effects);
  set_start(robot, data, state);
  Recording recording(robot, effects);
  double kinetic, potential;
  check(dyn_energy(robot, data, nullptr, nullptr, &kinetic, &potential));
  recording.add(data, {0, kinetic, potential, state.q.data(), state.v.data(), state.tau.data()}, nullptr, 0);
  return head(kind, options, robot, recording, pack, notes);
}

}  // namespace cli::page
