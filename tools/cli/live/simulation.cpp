#include "simulation.hpp"

#include <cmath>

#include "../effect_choice.hpp"

namespace cli::live {

namespace {

constexpr double share = 0.8;  // of the wall time, at most, goes into steps: the rest is for pages

double number(const json& command, const char* key) {
  const double x = command.at(key).get<double>();
  if (!std::isfinite(x)) throw json::out_of_range::create(406, key, nullptr);
  return x;
}

Robot load(const SteppingOptions& options) {
  Robot robot(options.robot);
  if (options.ground) robot.add_ground();
  return robot;
}

}  // namespace

Simulation::Simulation(const SteppingOptions& options)
    : options_(options),
      robot_(load(options)),
      start_(start_of(robot_, options, notes_)),
      effects_(effects_on(robot_, options.effects)),
      poses_(robot_, effects_) {
  complete_stepping(robot_, options_);
  begin(start_);
}

void Simulation::begin(const State& state) {
  data_.emplace(robot_, DYN_PART_SIMULATION | DYN_PART_ENERGY, effects_);
  set_start(robot_, *data_, state);
  set_stepping(robot_, *data_, integrator_named(options_.integrator).id, options_.dt, 0,
               {solver_named(options_.solver).id, options_.tolerance});
  failure_.clear();
}

void Simulation::go_on(double wall) {
  using Clock = std::chrono::steady_clock;
  if (paused_) return;
  const auto began = Clock::now();
  const auto spent = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
  owed_ += wall * speed_;
  int steps = 0;
  for (; owed_ >= options_.dt && spent() < share * wall; ++steps, owed_ -= options_.dt)
    if (dyn_step(robot_, *data_) != DYN_OK) {
      failure_ = dyn_last_error(), paused_ = true;
      break;
    }
  if (steps) step_s_ = spent() / steps;
  rate_ = steps * options_.dt / wall;
  if (owed_ >= options_.dt) owed_ = 0;  // what cannot be kept up with is not made up for
  time_ = before_ + *state_view(robot_, *data_, "time");
}

void Simulation::push(const json& command) {
  double point[3], wrench[6] = {};
  for (std::size_t i = 0; i < 3; ++i)
    point[i] = command.at("point").at(i).get<double>(), wrench[i] = command.at("force").at(i).get<double>();
  check(dyn_data_clear_wrenches(robot_, *data_));
  if (wrench[0] != 0 || wrench[1] != 0 || wrench[2] != 0)
    check(
        dyn_data_apply_wrench(robot_, *data_, command.at("frame").get<int>(), point, wrench, DYN_REFERENCE_LOCAL_WORLD_ALIGNED));
}

std::string Simulation::obey(const json& command) {
  try {
    const std::string what = command.at("do");
    if (what == "pause") {
      paused_ = command.at("on").get<bool>();
    } else if (what == "reset") {
      before_ = time_ = 0;
      begin(start_);
    } else if (what == "push") {
      push(command);
    } else if (what == "speed") {
      speed_ = std::clamp(number(command, "factor"), 0.01, 100.0);
    } else if (what == "effects") {
      State now = start_;
      const double *q = state_view(robot_, *data_, "q"), *v = state_view(robot_, *data_, "v");
      now.q.assign(q, q + robot_.nq), now.v.assign(v, v + robot_.nv);
      EffectOptions options = options_.effects;
      options.without = command.at("without").get<std::string>();
      effects_ = effects_on(robot_, options);
      before_ = time_;
      begin(now);
    } else {
      return "there is no command \"" + shown(what) + "\"";
    }
  } catch (const Failure& failure) {
    return failure.message;
  } catch (const json::exception& error) {
    return error.what();
  }
  return "";
}

std::vector<float> Simulation::state() const {
  dynStepReport report{};
  report.struct_size = sizeof report;
  check(dyn_data_step_report(robot_, *data_, &report));
  double kinetic = 0, potential = 0;
  const double *q = state_view(robot_, *data_, "q"), *v = state_view(robot_, *data_, "v");
  check(dyn_energy(robot_, *data_, nullptr, nullptr, &kinetic, &potential));
  Vector positions, turns, com;
  poses_.poses(q, positions, turns, com);
  int count = 0;
  check(dyn_data_step_contacts(robot_, *data_, nullptr, 0, &count));
  std::vector<dynContactForce> contacts(static_cast<std::size_t>(count));
  check(dyn_data_step_contacts(robot_, *data_, contacts.data(), count, &count));

  std::vector<float> out;
  const auto put = [&](const auto&... x) { (out.push_back(static_cast<float>(x)), ...); };
  const auto put_all = [&](const double* x, std::size_t n) { out.insert(out.end(), x, x + n); };
  put(time_, paused_, speed_, rate_, kinetic, potential, report.residual, report.penetration, 1e6 * step_s_, count);
  put_all(positions.data(), positions.size()), put_all(turns.data(), turns.size()), put_all(com.data(), 3);
  put_all(q, static_cast<std::size_t>(robot_.nq)), put_all(v, static_cast<std::size_t>(robot_.nv));
  for (const dynContactForce& c : contacts)
    put_all(c.contact.position, 3), put_all(c.force_on_b, 3), put(c.contact.distance, c.contact.shape_a, c.contact.shape_b);
  const Vector tendons = poses_.tendons(*data_, q);
  put_all(tendons.data(), tendons.size());
  return out;
}

json Simulation::head(page::Pack& pack) const {
  json out = page::still("live", options_.robot, robot_, start_, effects_, pack, notes_);
  json names = json::array();
  for (const json& e : effects(robot_, effects_on(robot_, options_.effects)))
    if (e["active"].get<bool>() && e["name"] != "mimic") names.push_back(e["name"]);
  out["effects"] = names, out["dt"] = options_.dt;
  return out;
}

}  // namespace cli::live
