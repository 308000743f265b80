// The initial configuration and <keyframe>, as named configurations with velocity, controls, activations and time.
#include <algorithm>

#include "mjcf_robot.hpp"
#include "spatial/quaternion.hpp"

namespace dyn::load {

namespace {

using ByJoint = std::vector<std::pair<std::string, std::vector<double>>>;

// qpos at the initial configuration.
std::vector<double> initial_qpos(const MjcfRobot& robot) {
  std::vector<double> qpos;
  for (const MjcfBody& body : robot.bodies)
    for (const MjcfJoint& j : body.joints) {
      const size_t n = size_t(joint_nq(j.spec.type));
      if (n == 1) {
        qpos.push_back(j.reference);
        continue;
      }
      if (n == 7) qpos.insert(qpos.end(), {body.X.p[0], body.X.p[1], body.X.p[2]});
      const Quaternion<double> u = n == 7 ? quaternion(body.X.R) : Quaternion<double>::identity();
      qpos.insert(qpos.end(), {u.w, u.v[0], u.v[1], u.v[2]});
    }
  return qpos;
}

bool is_neutral(const MjcfRobot& robot) {
  for (const MjcfBody& body : robot.bodies)
    for (const MjcfJoint& j : body.joints)
      if (j.reference != 0 || j.spec.type == DYN_JOINT_TYPE_FREE_FLYER) return false;
  return true;
}

// By joints. MuJoCo's quaternions are (w, x, y, z), and a zero one is the identity.
ByJoint coordinates(const MjcfRobot& robot, const std::vector<double>& qpos) {
  ByJoint out;
  auto at = qpos.begin();
  for (const MjcfBody& body : robot.bodies)
    for (const MjcfJoint& j : body.joints) {
      std::vector<double> q(at, at + joint_nq(j.spec.type));
      at += joint_nq(j.spec.type);
      if (q.size() >= 4) {
        std::rotate(q.end() - 4, q.end() - 3, q.end());
        if (std::all_of(q.end() - 4, q.end(), [](double x) { return x == 0; })) q.back() = 1;
      }
      out.emplace_back(j.spec.name, std::move(q));
    }
  return out;
}

// By joints. MuJoCo's linear velocity of a free joint is in world axes, ours in those of the body.
ByJoint velocities(const MjcfRobot& robot, const ByJoint& q, const std::vector<double>& qvel) {
  ByJoint out;
  auto at = qvel.begin();
  auto where = q.begin();
  for (const MjcfBody& body : robot.bodies)
    for (const MjcfJoint& j : body.joints) {
      std::vector<double> v(at, at + joint_nv(j.spec.type));
      at += joint_nv(j.spec.type);
      if (j.spec.type == DYN_JOINT_TYPE_FREE_FLYER) {
        const double* const u = where->second.data() + 3;
        store3(transpose(from_quaternion(u[3], u[0], u[1], u[2])) * load3(v.data()), v.data());
      }
      out.emplace_back(j.spec.name, std::move(v)), ++where;
    }
  return out;
}

// The key's numbers, followed by those of `otherwise` that it leaves out.
std::vector<double> filled(const MjcfKey& key, const char* what, const std::vector<double>& given, std::vector<double> otherwise,
                           const char* symbol) {
  const std::string sizes = std::string(what) + " has " + std::to_string(given.size()) + " numbers, and the model has " + symbol +
                            " = " + std::to_string(otherwise.size());
  if (given.size() > otherwise.size()) key.place.fail(DYN_ERROR_SIZE, sizes);
  if (!given.empty() && given.size() < otherwise.size()) key.place.warning(sizes + ": the rest is as in the drawn pose");
  std::copy(given.begin(), given.end(), otherwise.begin());
  return otherwise;
}

// Mocap bodies in the order of the file. A zero quaternion is the identity.
std::vector<std::pair<std::string, Placement>> mocaps_of(const MjcfRobot& robot, const MjcfKey& key) {
  std::vector<double> mpos, mquat;
  for (const MjcfBody& body : robot.bodies)
    if (body.mocap) {
      const Quaternion<double> u = quaternion(body.X.R);
      mpos.insert(mpos.end(), {body.X.p[0], body.X.p[1], body.X.p[2]});
      mquat.insert(mquat.end(), {u.w, u.v[0], u.v[1], u.v[2]});
    }
  mpos = filled(key, "mpos", key.mpos, mpos, "3 nmocap"), mquat = filled(key, "mquat", key.mquat, mquat, "4 nmocap");
  std::vector<std::pair<std::string, Placement>> out;
  if (key.mpos.empty() && key.mquat.empty()) return out;
  const double *p = mpos.data(), *u = mquat.data();
  for (const MjcfBody& body : robot.bodies) {
    if (!body.mocap) continue;
    const bool none = u[0] == 0 && u[1] == 0 && u[2] == 0 && u[3] == 0;
    Placement X;
    store_se3(SE3<double>{none ? Mat3<double>::identity() : from_quaternion(u[0], u[1], u[2], u[3]), load3(p)}, X.data());
    out.emplace_back(body.name, X);
    p += 3, u += 4;
  }
  return out;
}

ConfigurationState state_of(const MjcfRobot& robot, const MjcfKey& key, const ByJoint& q) {
  size_t nv = 0, na = 0, nu = 0;
  for (const MjcfBody& body : robot.bodies)
    for (const MjcfJoint& j : body.joints) nv += size_t(joint_nv(j.spec.type));
  for (const MjcfActuator& a : robot.actuators) na += a.activations, nu += size_t(controls_of(a.spec));
  const auto of = [&](const char* what, const std::vector<double>& given, size_t size, const char* symbol) {
    return filled(key, what, given, std::vector<double>(size), symbol);
  };
  const std::vector<double> qvel = of("qvel", key.qvel, nv, "nv"), act = of("act", key.act, na, "na"),
                            ctrl = of("ctrl", key.ctrl, nu, "nu");
  ConfigurationState state;
  if (!key.qvel.empty()) state.v = velocities(robot, q, qvel);
  state.time = key.time;
  const double *next_act = act.data(), *next_control = ctrl.data();
  for (const MjcfActuator& a : robot.actuators) {
    ConfigurationState::Actuator x;
    const size_t controls = size_t(controls_of(a.spec));
    std::copy_n(next_control, controls, x.control.begin());
    if (!a.inert) std::copy_n(next_act, a.activations, x.activation.begin());
    next_act += a.activations, next_control += controls;
    if (!a.inert || nv > 0) state.actuators.emplace_back(a.name, x);
  }
  state.mocaps = mocaps_of(robot, key);
  return state;
}

}  // namespace

void read_mjcf_keys(MjcfFile& file, Element& e, const MjcfContext& context) {
  for (Element* c : file.source.children(e, "key")) {
    std::string name = c->Attribute("name") ? c->Attribute("name") : "";
    if (name.empty()) name = "key_" + std::to_string(file.robot.keys.size());
    name = context.name(name);
    const Reader reader = file.source.reader(*c, "key " + load::in_quotes(name));
    reader.unread(*c, {"name", "class", "qpos", "time", "qvel", "act", "ctrl", "mpos", "mquat"}, {});
    MjcfKey key{{&reader.report, line(*c), reader.owner}, name, {}};
    const auto read = [&](const char* attribute, std::vector<double>& to) {
      to = reader.numbers(*c, attribute).value_or(std::vector<double>());
    };
    read("qpos", key.qpos), read("qvel", key.qvel), read("act", key.act), read("ctrl", key.ctrl);
    read("mpos", key.mpos), read("mquat", key.mquat);
    key.time = reader.optional_number(*c, "time").value_or(0);
    file.source.charge(&Budget::add_keys, 1, *c);
    file.robot.keys.push_back(std::move(key));
  }
}

void add_mjcf_initial_configuration(Builder& builder, const MjcfRobot& robot) {
  if (is_neutral(robot)) return;
  with_location(robot.bodies[0].place,
                [&] { builder.configuration_of_joints("qpos0", coordinates(robot, initial_qpos(robot))); });
}

void add_mjcf_keys(Builder& builder, const MjcfRobot& robot) {
  const std::vector<double> initial = initial_qpos(robot);
  std::int64_t bytes = bytes_of_part;  // of a key
  for (const MjcfBody& body : robot.bodies) bytes += 200 * std::int64_t(body.joints.size()) + (body.mocap ? 300 : 0);
  bytes += 150 * std::int64_t(robot.actuators.size());
  for (const MjcfKey& key : robot.keys) {
    if (!robot.lost_names.empty() && key.qpos.size() != initial.size()) {
      key.place.physics("it is left out: its joints are missing from the model");
      continue;
    }
    if (robot.budget) robot.budget->add_bytes(bytes, *key.place.report, key.place.line);
    const ByJoint q = coordinates(robot, filled(key, "qpos", key.qpos, initial, "nq"));
    with_location(key.place, [&] { builder.configuration_of_joints(key.name, q, state_of(robot, key, q)); });
  }
  if (!is_neutral(robot)) builder.initial_configuration("qpos0");
}

}  // namespace dyn::load
