// The range of lengths of a muscle, by coordinate descent within the limits of joints. MuJoCo pulls at the actuator in a
// simulation and takes the lengths where it ends.
#include "mjcf_length.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <new>
#include <optional>

#include "polynomial.hpp"

namespace dyn::load {

namespace {

constexpr dynParts parts = DYN_PART_FORWARD | DYN_PART_KINEMATICS;
constexpr int sweeps = 40, halvings = 50, samples = 6;

// A joint of one coordinate that moves a muscle, within its limits.
struct Coordinate {
  Index q, v;
  double low, high;
};
// A joint that follows another by an equality: q = sum of c_k q_leader^k.
struct Follower {
  Index q, v, leader_q, leader_v;
  std::array<double, 5> c;
};

std::vector<Follower> followers_of(const Model& m, const MjcfRobot& robot) {
  std::vector<Follower> out;
  std::map<std::string, double> references;
  for (const MjcfBody& b : robot.bodies)
    for (const MjcfJoint& j : b.joints)
      if (joint_nq(j.spec.type) == 1) references[j.spec.name] = j.reference;
  for (const MjcfEquality& e : robot.equalities) {
    const auto first = references.find(e.first), second = references.find(e.second);
    if (e.kind != "joint" || !e.enabled || !robot.closed || first == references.end() || second == references.end()) continue;
    const JointRecord &own = model_joint(m, e.first), &leader = model_joint(m, e.second);
    Follower f{own.idx_q, own.idx_v, leader.idx_q, leader.idx_v, {}};
    shift_polynomial(e.numbers, second->second, f.c.data());
    f.c[0] += first->second;
    out.push_back(f);
  }
  return out;
}

// l(q) of an actuator, as a function of the coordinates that nothing else follows.
struct Length {
  MeasuredModel& at;
  const ActuatorRecord& motor;
  std::vector<Follower> followers;
  std::vector<double> q, arms;

  double move(std::vector<double> to) {
    q = std::move(to);
    for (const Follower& f : followers) {
      const double x = q[size_t(f.leader_q)];
      q[size_t(f.q)] = f.c[0] + x * (f.c[1] + x * (f.c[2] + x * (f.c[3] + x * f.c[4])));
    }
    at.place(q), arms = at.arms(motor);
    for (auto f = followers.rbegin(); f != followers.rend(); ++f) {
      const double x = q[size_t(f->leader_q)];
      arms[size_t(f->leader_v)] += arms[size_t(f->v)] * (f->c[1] + x * (2 * f->c[2] + x * (3 * f->c[3] + x * 4 * f->c[4])));
      arms[size_t(f->v)] = 0;
    }
    return at.length(motor);
  }
  double move(const Coordinate& c, double x) {
    std::vector<double> to = q;
    to[size_t(c.q)] = x;
    return move(std::move(to));
  }
};

// The smallest value of sign l from the configuration q: along each coordinate to where l is stationary, or to a limit.
double descend(Length& length, const std::vector<Coordinate>& coordinates, double sign, const std::vector<double>& start) {
  double least = sign * length.move(start);
  for (int k = 0; k < sweeps; ++k) {
    const double before = least;
    for (const Coordinate& c : coordinates) {
      const double from = length.q[size_t(c.q)], slope = sign * length.arms[size_t(c.v)], end = slope > 0 ? c.low : c.high;
      if (slope == 0 || from == end) continue;
      double value = sign * length.move(c, end), near = from, far = end, x = end;
      const bool falls_to_the_end = slope * sign * length.arms[size_t(c.v)] > 0 && value <= least;
      for (int i = 0; i < halvings && !falls_to_the_end; ++i) {
        x = (near + far) / 2, value = sign * length.move(c, x);
        (slope * sign * length.arms[size_t(c.v)] > 0 && value <= least ? near : far) = x;
      }
      if (value <= least) least = value;
      else length.move(c, from);
    }
    if (before - least <= 1e-12 * std::max(1.0, std::abs(before))) break;
  }
  return least;
}

// The initial configuration, the middle of the limits, their ends, and points between (Halton 1960).
std::vector<std::vector<double>> starts(const std::vector<double>& initial, const std::vector<Coordinate>& coordinates) {
  constexpr int primes[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29};
  const auto place = [&](auto&& share) {
    std::vector<double> q = initial;
    for (size_t i = 0; i < coordinates.size(); ++i) {
      const auto& [at, v, low, high] = coordinates[i];
      q[size_t(at)] = low + share(i) * (high - low);
    }
    return q;
  };
  const auto halton = [&](int k, int base) {
    double x = 0;
    for (double digit = 1.0 / base; k > 0; k /= base, digit /= base) x += digit * (k % base);
    return x;
  };
  std::vector<std::vector<double>> out = {initial};
  for (const double share : {0.5, 0.0, 1.0}) out.push_back(place([&](size_t) { return share; }));
  for (int k = 1; k <= samples; ++k) out.push_back(place([&](size_t i) { return halton(k, primes[i % std::size(primes)]); }));
  return out;
}

// The coordinates within their limits, but for followers.
std::vector<Coordinate> limited_coordinates(const Model& m, const std::vector<Follower>& followers) {
  std::vector<Coordinate> out;
  for (Index j = 1; j < m.n.joints; ++j) {
    const JointRecord& r = m.joints()[j];
    if (r.nq != 1 || std::any_of(followers.begin(), followers.end(), [&](const Follower& f) { return f.q == r.idx_q; })) continue;
    const double low = m.lower_limit()[r.idx_q], high = m.upper_limit()[r.idx_q];
    if (std::isfinite(low) && std::isfinite(high)) out.push_back({r.idx_q, r.idx_v, low, high});
  }
  return out;
}

// Limits of the joint or tendon itself.
std::array<double, 2> limits_of_target(const Model& m, MjcfRobot& robot, const MjcfActuator& a) {
  if (a.spec.transmission == DYN_TRANSMISSION_JOINT) {
    const Index q = model_joint(m, a.target).idx_q;
    return {m.lower_limit()[q], m.upper_limit()[q]};
  }
  if (a.spec.transmission == DYN_TRANSMISSION_SITE) return {-HUGE_VAL, HUGE_VAL};
  return std::to_array(find_tendon(robot, a.target)->spec.range);
}

// The smallest and the largest length; empty where a joint that moves it has no limits.
std::optional<std::array<double, 2>> searched_range(MeasuredModel& at, const ActuatorRecord& motor, const MjcfRobot& robot) {
  Length length{at, motor, followers_of(at.m, robot), {}, {}};
  std::vector<Coordinate> coordinates = limited_coordinates(at.m, length.followers);
  const std::vector<std::vector<double>> from = starts(at.initial, coordinates);
  std::vector<double> largest(size_t(at.m.n.nv));  // moment arm of each degree of freedom
  for (const std::vector<double>& q : from) {
    length.move(q);
    for (size_t v = 0; v < largest.size(); ++v) largest[v] = std::max(largest[v], std::abs(length.arms[v]));
  }
  const double least = 1e-9 * (largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end()));
  std::erase_if(coordinates, [&](const Coordinate& c) { return !(largest[size_t(c.v)] > least); });
  for (const Coordinate& c : coordinates) largest[size_t(c.v)] = 0;
  if (std::any_of(largest.begin(), largest.end(), [&](double arm) { return arm > least; })) return std::nullopt;
  double shortest = HUGE_VAL, longest = -HUGE_VAL;
  for (const std::vector<double>& q : from)
    shortest = std::min(shortest, descend(length, coordinates, 1, q)),
    longest = std::max(longest, -descend(length, coordinates, -1, q));
  return std::array<double, 2>{shortest, longest};
}

}  // namespace

const JointRecord& model_joint(const Model& m, const std::string& name) {
  const Index* const by_name = m.joints_by_name();
  return m.joints()[*std::lower_bound(by_name, by_name + m.n.joints, name, [&](Index j, const std::string& n) {
    return std::strcmp(m.string(m.joints()[j].name), n.c_str()) < 0;
  })];
}

MeasuredModel::MeasuredModel(const Model& model) : m(model), zeros(data_bytes<double>(m, parts)) {
  if (!zeros.memory) throw std::bad_alloc();
  data_layout(m, parts, zeros.memory, d);
  for (Index k = 0; k < m.n.configurations; ++k)
    if (m.string(m.configuration_names()[k]) == std::string_view("qpos0"))
      std::copy_n(m.configurations() + std::ptrdiff_t(k) * m.n.nq, m.n.nq, d.q);
  initial.assign(d.q, d.q + m.n.nq);
}

void MeasuredModel::place(const std::vector<double>& q) {
  std::copy(q.begin(), q.end(), d.q);
  d.changed(input_q);
  if (m.n.paths_in_space > 0) forward_kinematics<0>(m, d);
}

// As measure_paths, one path alone.
void MeasuredModel::measure(Index path) {
  const PathRecord& p = m.paths()[path];
  const Index* const dofs = m.path_dofs() + p.first_dof;
  for (Index i = 0; i < p.dofs; ++i) d.path_row[dofs[i]] = 0;
  d.path_length[path] = p.kind == PathKind::Fixed     ? detail::fixed_path(m, d, p, d.path_row)
                        : p.kind == PathKind::Spatial ? detail::spatial_path(m, d, p, d.path_row)
                                                      : detail::site_path(m, d, p, d.path_row);
  for (Index i = 0; i < p.dofs; ++i) d.path_moment[p.first_dof + i] = d.path_row[dofs[i]];
}

std::vector<double> MeasuredModel::path_arms(Index path) {
  measure(path);
  std::vector<double> out(size_t(m.n.nv));
  add_path_force(m, d, path, 1.0, out.data());
  return out;
}

std::vector<double> MeasuredModel::arms(const ActuatorRecord& a) {
  std::vector<double> out = a.path >= 0 ? path_arms(a.path) : std::vector<double>(size_t(m.n.nv));
  if (a.path < 0) out[size_t(a.v)] = 1;
  for (double& x : out) x *= a.spec.gear;
  return out;
}

double MeasuredModel::length(const ActuatorRecord& a) {
  if (a.path >= 0) measure(a.path);
  return a.spec.gear * (a.path >= 0 ? d.path_length[a.path] : d.q[a.q]);
}

bool needs_length_range(const MjcfActuator& a) {
  return a.spec.type == DYN_ACTUATOR_TYPE_MUSCLE && !(a.spec.muscle.length_range[0] < a.spec.muscle.length_range[1]);
}

void set_length_range(MeasuredModel& at, const ActuatorRecord& motor, MjcfRobot& robot, MjcfActuator& muscle) {
  const auto give_up = [&](const char* why) { make_mjcf_actuator_inert(muscle, std::string(why) + ": give lengthrange"); };
  if (!robot.compiler.length_computed) return give_up("its range of lengths is missing");
  const std::array<double, 2> limits = limits_of_target(at.m, robot, muscle);
  const bool limited = std::isfinite(limits[0]) && std::isfinite(limits[1]);
  const double gear = motor.spec.gear;
  std::array<double, 2> range = limits;
  if (!limited || !robot.compiler.length_of_limits) {
    const std::optional<std::array<double, 2>> found = searched_range(at, motor, robot);
    if (!found && !limited)
      return give_up("its range of lengths is missing, and a joint that moves it has no limits");
    const double ends[2] = {gear * limits[gear < 0], gear * limits[gear > 0]};
    range = found ? *found : std::to_array(ends);
    for (double& x : range) x = std::clamp(x, ends[0], ends[1]);
  }
  if (!(range[0] < range[1])) return give_up("its range of lengths is empty");
  std::copy(range.begin(), range.end(), muscle.spec.muscle.length_range);
}

}  // namespace dyn::load
