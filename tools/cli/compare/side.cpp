#include "side.hpp"

#include <algorithm>
#include <cmath>

namespace cli::compare {

namespace {

// Angle between rotations, from the chord: 2 asin(|A - B|_F / (2 sqrt 2)).
double turn(const double* A, const double* B) {
  double sum = 0;
  for (int i = 0; i < 9; ++i) sum += (A[i] - B[i]) * (A[i] - B[i]);
  return 2 * std::asin(std::min(1.0, std::sqrt(sum / 8)));
}

}  // namespace

Side::Side(const RobotOptions& options, bool ground) : robot_(options) {
  if (ground) robot_.add_ground();
  dynBuilder* made = nullptr;
  check(dyn_builder_from_model(robot_, &made));
  builder_.reset(made);
  const int count = dyn_builder_parameter_count(made);
  for (int k = 0; k < count; ++k) {
    dynParameter p{};
    p.struct_size = sizeof p;
    check(dyn_builder_parameter(made, k, &p));
    quantities_.push_back(
        {k, name_of("dynParameterGroup", p.group), p.object, p.name, p.quantity, Vector(p.values, p.values + p.count)});
    by_key_.try_emplace(quantities_.back().key(), quantities_.size() - 1);
  }
}

const Quantity* Side::find(const std::string& key) const {
  const auto at = by_key_.find(key);
  return at == by_key_.end() ? nullptr : &quantities_[at->second];
}

std::unique_ptr<Robot> Side::with(const Changes& changes) const {
  const auto set = [&](int index, const Vector& values) {
    check(dyn_builder_set_parameter(builder_.get(), index, values.data(), values.size()));
  };
  const auto restore = [&] {
    for (const auto& [index, values] : changes) set(index, quantities_[static_cast<std::size_t>(index)].values);
  };
  dynModel* made = nullptr;
  try {
    for (const auto& [index, values] : changes) set(index, values);
    check(dyn_builder_finish(builder_.get(), &made));
  } catch (const Failure&) {
    restore();
    throw;
  }
  restore();
  return std::make_unique<Robot>(made);
}

State moved(const Robot& from, const Robot& to, const State& state) {
  State out{to.neutral(), Vector(to.nv), Vector(to.nv), Vector(to.nv), Vector(dyn_model_nu(to))};
  out.has_tau = state.has_tau;
  for (int j = 1; j < to.njoints; ++j) {
    const dynJointInfo b = to.joint(j);
    const int id = dyn_model_joint_id(from, b.name);
    if (id < 1) continue;
    const dynJointInfo a = from.joint(id);
    if (a.nq != b.nq || a.nv != b.nv) continue;
    std::copy_n(state.q.begin() + a.idx_q, a.nq, out.q.begin() + b.idx_q);
    std::copy_n(state.v.begin() + a.idx_v, a.nv, out.v.begin() + b.idx_v);
    std::copy_n(state.tau.begin() + a.idx_v, a.nv, out.tau.begin() + b.idx_v);
  }
  for (int k = 0; k < dyn_model_nactuators(to); ++k) {
    const int id = dyn_model_actuator_id(from, dyn_model_actuator_name(to, k));
    if (id < 0) continue;
    dynActuator a{}, b{};
    a.struct_size = b.struct_size = sizeof a;
    check(dyn_model_actuator_info(from, id, &a)), check(dyn_model_actuator_info(to, k, &b));
    std::copy_n(state.ctrl.begin() + a.idx_u, std::min(a.controls, b.controls), out.ctrl.begin() + b.idx_u);
  }
  return out;
}

Shared shared_frames(const Robot& a, const Robot& b) {
  Shared out;
  for (int f = 1; f < a.nframes; ++f) {
    const dynFrameInfo info = a.frame(f);
    const int other = dyn_model_frame_id_of_type(b, info.name, info.type);
    if (other > 0) out.frames.emplace_back(f, other), out.names.push_back(info.name);
  }
  return out;
}

Vector places_of(const Robot& robot, const Data& data, const double* q) {
  Vector out(12 * static_cast<std::size_t>(robot.nframes));
  check(dyn_forward_kinematics(robot, data, q, nullptr, nullptr));
  check(dyn_frame_placements(robot, data, out.data()));
  return out;
}

Path run(const Robot& robot, const Stepping& stepping, const State& start, double every, int moments) {
  const Data data(robot, DYN_PART_SIMULATION, stepping.effects), mind(robot, DYN_PART_FRAMES);
  set_start(robot, data, start);
  set_stepping(robot, data, stepping.integrator, stepping.dt, 0, stepping.solver);
  const double* q = state_view(robot, data, "q");
  Path out;
  out.places.push_back(places_of(robot, mind, q));
  for (int k = 1; k < moments; ++k) {
    if (dyn_advance(robot, data, every) != DYN_OK) {
      out.error = dyn_last_error();
      break;
    }
    out.places.push_back(places_of(robot, mind, q));
  }
  return out;
}

double distance(const Shared& shared, const Vector& a, const Vector& b, int* frame) {
  double most = 0;
  for (std::size_t k = 0; k < shared.frames.size(); ++k) {
    const double *A = a.data() + 12 * shared.frames[k].first, *B = b.data() + 12 * shared.frames[k].second;
    const double far = std::max(std::hypot(A[9] - B[9], A[10] - B[10], A[11] - B[11]), turn(A, B));
    if (far > most) {
      most = far;
      if (frame) *frame = static_cast<int>(k);
    }
  }
  return most;
}

Vector distances(const Shared& shared, const Path& a, const Path& b, int moments) {
  Vector out(static_cast<std::size_t>(moments), HUGE_VAL);
  for (std::size_t k = 0; k < std::min({a.places.size(), b.places.size(), out.size()}); ++k)
    out[k] = distance(shared, a.places[k], b.places[k]);
  return out;
}

}  // namespace cli::compare
