// dyn eval: quantities of a robot in a state.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <map>

#include "cli.hpp"
#include "effect_choice.hpp"

namespace cli {
namespace {

struct EvalOptions {
  RobotOptions robot;
  StateOptions state;
  std::vector<std::string> compute;
  std::string frame, reference = "LOCAL";
  EffectOptions effects{"armature", ""};
  ContactOptions contacts;
};

// What the quantities are computed from.
struct Context {
  const Robot& robot;
  const Data& data;
  const State& state;
  int frame;  // -1: none given
  dynReference reference;
  const double *q, *v, *a, *tau;

  json vector(dynStatus status, const char* name) const {
    check(status);
    return field(robot, data, name);
  }
  json matrix(dynStatus status, const char* name, int rows) const {
    check(status);
    const Vector values = field(robot, data, name);
    return matrix_json(values.data(), rows, robot.nv);
  }
  void kinematics() const { check(dyn_forward_kinematics(robot, data, q, v, a)); }
  template <class F>
  json frame_vector(F call) const {
    kinematics();
    double out[6];
    check(call(robot, data, frame, reference, out));
    return vector_json(out, 6);
  }
  template <class F>
  json frame_matrix(F call) const {
    kinematics();
    Vector out(6 * static_cast<std::size_t>(robot.nv));
    check(call(robot, data, frame, reference, out.data()));
    return matrix_json(out.data(), 6, robot.nv);
  }
};

json energy(const Context& c) {
  double kinetic, potential;
  check(dyn_energy(c.robot, c.data, c.q, c.v, &kinetic, &potential));
  return {{"kinetic", kinetic}, {"potential", potential}, {"mechanical", kinetic + potential}};
}

// A name that several frames share stands for the one that dyn_model_frame_id finds; the others say their type.
json placements(const Context& c) {
  c.kinematics();
  std::map<std::string, int> bearers;
  for (int i = 0; i < c.robot.nframes; ++i) ++bearers[c.robot.frame(i).name];
  json out = json::object();
  for (int i = 0; i < c.robot.nframes; ++i) {
    if (c.frame >= 0 && i != c.frame) continue;
    double X[12];
    check(dyn_frame_placement(c.robot, c.data, i, X));
    const dynFrameInfo info = c.robot.frame(i);
    std::string key = info.name;
    if (c.frame < 0 && bearers[key] > 1 && dyn_model_frame_id(c.robot, info.name) != i)
      key += std::string(" [") + frame_type_name(info.type) + "]";
    out[key] = {{"translation", vector_json(X + 9, 3)}, {"rotation", matrix_json(X, 3, 3)}};
  }
  return out;
}

json subtree_com(const Context& c) {
  check(dyn_com(c.robot, c.data, c.q, nullptr, nullptr, nullptr, nullptr, nullptr));
  json out = json::object();
  for (int i = 0; i < c.robot.njoints; ++i) {
    double com[3], mass;
    check(dyn_subtree_com(c.robot, c.data, i, com, &mass));
    out[dyn_model_joint_name(c.robot, i)] = {{"com", vector_json(com, 3)}, {"mass", mass}};
  }
  return out;
}

json center_of_mass(const Context& c, const char* name) {
  return c.vector(dyn_com(c.robot, c.data, c.q, c.v, c.a, nullptr, nullptr, nullptr), name);
}

// The inertia of the whole about its centre of mass, axes of the world.
json centroidal_inertia(const Context& c) {
  check(dyn_centroidal_map(c.robot, c.data, c.q, c.v, nullptr, nullptr, nullptr));
  const Vector Ig = field(c.robot, c.data, "Ig");
  double inertia[9];
  for (int k = 0; k < 9; ++k) inertia[k] = Ig[static_cast<std::size_t>(21 + k % 3 + 6 * (k / 3))];
  return {{"mass", Ig[0]}, {"com", center_of_mass(c, "com")}, {"inertia", matrix_json(inertia, 3, 3)}};
}


json forward_derivative(const Context& c, const char* name) {
  return c.matrix(dyn_aba_derivatives(c.robot, c.data, c.q, c.v, c.tau, nullptr, nullptr), name, c.robot.nv);
}

json by_q(const Context& c, dynStatus (*call)(const dynModel*, dynData*, int, dynReference, double*, double*, double*)) {
  return c.frame_matrix([call](const dynModel* m, dynData* d, int frame, dynReference r, double* out) {
    return call(m, d, frame, r, out, nullptr, nullptr);
  });
}
json by_v(const Context& c, dynStatus (*call)(const dynModel*, dynData*, int, dynReference, double*, double*, double*)) {
  return c.frame_matrix([call](const dynModel* m, dynData* d, int frame, dynReference r, double* out) {
    return call(m, d, frame, r, nullptr, out, nullptr);
  });
}

// By q_k: [k] is the derivative of the frame's Jacobian.
json kinematic_hessian(const Context& c) {
  c.kinematics();
  const std::size_t page = 6 * static_cast<std::size_t>(c.robot.nv);
  Vector H(page * static_cast<std::size_t>(c.robot.nv));
  check(dyn_frame_kinematic_hessian(c.robot, c.data, c.frame, c.reference, H.data()));
  json out = json::array();
  for (std::size_t k = 0; k < H.size(); k += page) out.push_back(matrix_json(H.data() + k, 6, c.robot.nv));
  return out;
}

// [i] is the matrix of tau_i.
json second_order(const Context& c, int which) {
  const std::size_t square = static_cast<std::size_t>(c.robot.nv) * static_cast<std::size_t>(c.robot.nv);
  Vector tensor(square * static_cast<std::size_t>(c.robot.nv));
  double* x[4] = {};
  x[which] = tensor.data();
  const dynSecondOrderDerivatives wanted = {sizeof wanted, x[0], x[1], x[2], x[3]};
  check(dyn_rnea_second_order_derivatives(c.robot, c.data, c.q, c.v, c.a, nullptr, &wanted));
  json out = json::array();
  for (std::size_t i = 0; i < tensor.size(); i += square) out.push_back(matrix_json(tensor.data() + i, c.robot.nv, c.robot.nv));
  return out;
}

int parameter_count(const Context& c) { return 10 * (c.robot.njoints - 1); }

// The ten of each joint's body.
json inertial_parameters(const Context& c) {
  Vector pi(static_cast<std::size_t>(parameter_count(c)));
  check(dyn_model_inertial_parameters(c.robot, pi.data()));
  json out = json::object();
  for (int joint = 1; joint < c.robot.njoints; ++joint)
    out[dyn_model_joint_name(c.robot, joint)] = vector_json(pi.data() + 10 * (joint - 1), 10);
  return out;
}

// J has a row of nv for each.
json tendons(const Context& c) {
  const int n = dyn_model_ntendons(c.robot), nv = c.robot.nv;
  Vector length(static_cast<std::size_t>(n)), velocity(length), J(length.size() * static_cast<std::size_t>(nv));
  check(dyn_tendons(c.robot, c.data, c.q, c.v, length.data(), velocity.data(), J.data()));
  json out = json::object();
  for (int k = 0; k < n; ++k) {
    Vector arms;
    for (std::size_t i = static_cast<std::size_t>(k); i < J.size(); i += length.size()) arms.push_back(J[i]);
    out[dyn_model_tendon_name(c.robot, k)] = {{"length", length[static_cast<std::size_t>(k)]},
                                              {"velocity", velocity[static_cast<std::size_t>(k)]},
                                              {"J", arms}};
  }
  return out;
}

json sensors(const Context& c) {
  Vector values(static_cast<std::size_t>(dyn_model_nsensordata(c.robot)));
  check(dyn_sensors(c.robot, c.data, c.q, c.v, c.a, values.data()));
  json out = json::object();
  for (int k = 0; k < dyn_model_nsensors(c.robot); ++k) {
    dynSensor s{};
    s.struct_size = sizeof s;
    check(dyn_model_sensor_info(c.robot, k, &s));
    out[dyn_model_sensor_name(c.robot, k)] = Vector(values.begin() + s.idx, values.begin() + s.idx + s.size);
  }
  return out;
}

// Every tested pair.
json distances(const Context& c) {
  check(dyn_distances(c.robot, c.data, c.q, nullptr));
  json out = json::array();
  for (const int pair : tested_pairs(c.robot, c.data)) out.push_back(distance_json(c.robot, c.data, pair));
  return out;
}
// Those that touch or overlap.
json collisions(const Context& c) {
  json out = json::array();
  for (const json& d : distances(c))
    if (d["distance"].get<double>() <= 0) out.push_back(d);
  return out;
}
// In the order of distances.
json distance_gradients(const Context& c) {
  check(dyn_distances(c.robot, c.data, c.q, nullptr));
  const int pairs = dyn_model_npairs(c.robot);
  Vector all(static_cast<std::size_t>(pairs) * static_cast<std::size_t>(c.robot.nv));
  check(dyn_distance_gradients(c.robot, c.data, all.data()));
  json out = json::array();
  for (const int pair : tested_pairs(c.robot, c.data)) {
    Vector row;
    for (int k = 0; k < c.robot.nv; ++k)
      row.push_back(all[static_cast<std::size_t>(pair) + static_cast<std::size_t>(k) * static_cast<std::size_t>(pairs)]);
    out.push_back(row);
  }
  return out;
}

struct Quantity {
  const char* name;
  dynParts parts;  // what is not needed is not allocated: M of a chain of 10,000 would be 800 MB; 0: Robot::forward_parts
  bool needs_frame;
  std::function<json(const Context&)> compute;
};

// A field of data by the algorithm that produces it.
json produced(const Context& c, dynAlgorithm algorithm, const char* name) {
  dynBatchArrays arrays;
  dyn_batch_arrays_init(&arrays);
  arrays.q = c.q, arrays.v = c.v, arrays.a = c.a, arrays.tau = c.tau;
  check(dyn_algorithm_run(c.robot, c.data, algorithm, &arrays));
  dynArray shape{};
  shape.struct_size = sizeof shape;
  check(dyn_data_array(c.robot, c.data, dyn_field_id(name), &shape));
  const Vector values = field(c.robot, c.data, name);
  return shape.cols == 1 ? json(values) : matrix_json(values.data(), shape.rows, shape.cols);
}

// All fields that one call of an algorithm makes of q, v, a and tau, but those that the table has.
void add_fields(std::vector<Quantity>& table) {
  for (const Choice& choice : choices("dynAlgorithm")) {
    const auto algorithm = static_cast<dynAlgorithm>(choice.value);
    dynAlgorithmInfo info{};
    info.struct_size = sizeof info;
    check(dyn_algorithm_info(nullptr, algorithm, &info));
    if (std::string(info.inputs).find('b') != std::string::npos) continue;  // a vector of its own
    for (dynField k = 0; k < dyn_field_count(); ++k) {
      dynFieldInfo made{};
      made.struct_size = sizeof made;
      check(dyn_field_info(k, &made));
      const bool known =
          std::any_of(table.begin(), table.end(), [&](const Quantity& x) { return std::string(x.name) == made.name; });
      if (known || made.producer != std::string("dyn_") + info.name) continue;
      table.push_back({made.name, made.part, false,
                       [algorithm, name = made.name](const Context& c) { return produced(c, algorithm, name); }});
    }
  }
}

std::vector<Quantity> listed() {
  using C = const Context&;
  std::vector<Quantity> table = {
      {"ddq", 0, false, [](C c) { return c.vector(dyn_aba(c.robot, c.data, c.q, c.v, c.tau, nullptr, nullptr), "ddq"); }},
      {"ddq_dtau", DYN_PART_FORWARD_DERIVATIVES, false, [](C c) { return forward_derivative(c, "Minv"); }},
      {"com", DYN_PART_COM, false, [](C c) { return center_of_mass(c, "com"); }},
      {"vcom", DYN_PART_COM, false, [](C c) { return center_of_mass(c, "vcom"); }},
      {"acom", DYN_PART_COM, false, [](C c) { return center_of_mass(c, "acom"); }},
      {"subtree_com", DYN_PART_COM, false, subtree_com},
      {"energy", DYN_PART_ENERGY, false, energy},
      {"placements", DYN_PART_KINEMATICS, false, placements},
      {"J", DYN_PART_JACOBIANS, false,
       [](C c) {
         return c.frame >= 0 ? c.frame_matrix(dyn_frame_jacobian)
                             : c.matrix(dyn_joint_jacobians(c.robot, c.data, c.q, nullptr), "J", 6);
       }},
      {"dJ", DYN_PART_JACOBIANS, false,
       [](C c) {
         return c.frame >= 0 ? c.frame_matrix(dyn_frame_jacobian_time_variation)
                             : c.matrix(dyn_joint_jacobians_time_variation(c.robot, c.data, c.q, c.v, nullptr), "dJ", 6);
       }},
      {"frame_velocity", DYN_PART_KINEMATICS, true, [](C c) { return c.frame_vector(dyn_frame_velocity); }},
      {"frame_acceleration", DYN_PART_KINEMATICS, true, [](C c) { return c.frame_vector(dyn_frame_acceleration); }},
      {"frame_classical_acceleration", DYN_PART_KINEMATICS, true,
       [](C c) { return c.frame_vector(dyn_frame_classical_acceleration); }},
      {"dv_dq", DYN_PART_KINEMATICS, true,
       [](C c) {
         return c.frame_matrix([](const dynModel* m, dynData* d, int frame, dynReference r, double* out) {
           return dyn_frame_velocity_derivatives(m, d, frame, r, out, nullptr);
         });
       }},
      {"da_dq", DYN_PART_KINEMATICS, true, [](C c) { return by_q(c, dyn_frame_acceleration_derivatives); }},
      {"da_dv", DYN_PART_KINEMATICS, true, [](C c) { return by_v(c, dyn_frame_acceleration_derivatives); }},
      {"dclassical_dq", DYN_PART_KINEMATICS, true, [](C c) { return by_q(c, dyn_frame_classical_acceleration_derivatives); }},
      {"dclassical_dv", DYN_PART_KINEMATICS, true, [](C c) { return by_v(c, dyn_frame_classical_acceleration_derivatives); }},
      {"kinematic_hessian", DYN_PART_JACOBIANS, true, kinematic_hessian},
      {"d2tau_dqdq", DYN_PART_SECOND_ORDER, false, [](C c) { return second_order(c, 0); }},
      {"d2tau_dvdv", DYN_PART_SECOND_ORDER, false, [](C c) { return second_order(c, 1); }},
      {"d2tau_dqdv", DYN_PART_SECOND_ORDER, false, [](C c) { return second_order(c, 2); }},
      {"d2tau_dadq", DYN_PART_SECOND_ORDER, false, [](C c) { return second_order(c, 3); }},
      {"Ig", DYN_PART_CENTROIDAL | DYN_PART_COM, false, centroidal_inertia},
      {"inertial_parameters", DYN_PART_KINEMATICS, false, inertial_parameters},
      {"tendons", DYN_PART_KINEMATICS, false, tendons},
      {"sensors", DYN_PART_KINEMATICS | DYN_PART_SIMULATION | DYN_PART_ENERGY, false, sensors},
      {"distances", DYN_PART_COLLISION, false, distances},
      {"collisions", DYN_PART_COLLISION, false, collisions},
      {"constrained_ddq", DYN_PART_CONSTRAINTS, false,
       [](C c) { return constrained_json(c.robot, c.data, c.q, c.v, c.tau, false); }},
      {"lambda", DYN_PART_CONSTRAINTS, false, [](C c) { return constrained_json(c.robot, c.data, c.q, c.v, c.tau, true); }},
      {"delassus", DYN_PART_CONSTRAINTS, false, [](C c) { return delassus_json(c.robot, c.data, c.q); }},
      {"constraint_error", DYN_PART_CONSTRAINTS, false,
       [](C c) { return constraint_terms_json(c.robot, c.data, c.q, c.v, "C"); }},
      {"constraint_jacobian", DYN_PART_CONSTRAINTS, false,
       [](C c) { return constraint_terms_json(c.robot, c.data, c.q, c.v, "J"); }},
      {"distance_gradients", DYN_PART_COLLISION, false, distance_gradients},
  };
  add_fields(table);
  return table;
}

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> table = listed();
  return table;
}

std::vector<const Quantity*> select(const EvalOptions& options) {
  std::vector<const Quantity*> out;
  for (const std::string& list : options.compute) {
    for (const std::string& word : list_of("--compute", list)) {
      const auto& table = quantities();
      const auto found = std::find_if(table.begin(), table.end(), [&](const Quantity& x) { return word == x.name; });
      if (found == table.end()) {
        std::vector<std::string> known;
        for (const auto& x : table) known.push_back(x.name);
        bad_usage("--compute: unknown name \"" + shown(word) + "\"" + did_you_mean(word, known) +
                  "; 'dyn eval --help' lists the names.");
      }
      if (found->needs_frame && options.frame.empty()) bad_usage("--compute: \"" + word + "\" needs --frame.");
      if (std::find(out.begin(), out.end(), &*found) == out.end()) out.push_back(&*found);
    }
  }
  if (out.empty()) bad_usage("--compute: the list is empty.");
  return out;
}

// name, then a vector on one line, a matrix by rows, a tensor by matrices, an object by keys.
void append_text(std::string& out, const std::string& name, const json& value, const std::string& indent) {
  const auto row = [](const json& numbers) {
    std::string line;
    for (const auto& x : numbers) {
      const std::string text = short_number(x.get<double>(), 9);
      line += std::string(text.size() < 15 ? 15 - text.size() : 1, ' ') + text;
    }
    return line;
  };
  if (value.is_number()) {
    out += indent + name + ": " + short_number(value.get<double>(), 9) + "\n";
  } else if (value.is_object()) {
    out += indent + name + "\n";
    for (const auto& [key, inner] : value.items()) append_text(out, key, inner, indent + "  ");
  } else if (!value.empty() && value.front().is_array() && !value.front().empty() && value.front().front().is_array()) {
    for (std::size_t k = 0; k < value.size(); ++k) append_text(out, name + "[" + std::to_string(k) + "]", value[k], indent);
  } else if (!value.empty() && value.front().is_array()) {
    out += indent + name + "\n";
    for (const auto& r : value) out += indent + row(r) + "\n";
  } else {
    out += indent + name + "\n" + indent + row(value) + "\n";
  }
}

void run_eval(const EvalOptions& options) {
  const auto reference = static_cast<dynReference>(value_of("dynReference", "--reference", options.reference, &Choice::capital));
  const auto wanted = select(options);
  parse_effects(options.effects);

  check_lists(options.state);
  const Robot robot(options.robot, contact_count(options.contacts));
  const std::uint32_t on = effects_on(robot, options.effects);
  dynParts parts = DYN_PART_KINEMATICS;
  for (const Quantity* quantity : wanted) parts |= quantity->parts ? quantity->parts : robot.forward_parts();
  const Data data(robot, parts, on);
  if (parts & DYN_PART_CONSTRAINTS) set_contacts(robot, data, options.contacts);
  const State state = read_state(robot, options.state);
  int frame = -1;
  if (!options.frame.empty() && (frame = dyn_model_frame_id(robot, options.frame.c_str())) < 0) fail(library_error());

  const Context context{robot,          data,           state,          frame,           reference,
                        state.q.data(), state.v.data(), state.a.data(), state.tau.data()};
  json answer = json::object();
  for (const Quantity* quantity : wanted) answer[quantity->name] = quantity->compute(context);
  if (options.robot.json) return print(json_text(answer));
  std::string text;
  for (const auto& [name, value] : answer.items()) append_text(text, name, value, "");
  print(text);
}

}  // namespace

void add_eval(CLI::App& app) {
  auto options = std::make_shared<EvalOptions>();
  CLI::App* command = app.add_subcommand("eval", "Quantities of a robot in a state");
  add_robot_options(*command, options->robot);
  std::vector<std::string> names;
  for (const auto& quantity : quantities()) names.push_back(quantity.name);
  complete(command->add_option("--compute", options->compute, "Quantities, separated by commas: " + join(names))
               ->required()
               ->allow_extra_args(false)
               ->type_name("LIST"),
           {names, true});
  add_state_options(*command, options->state, true);
  command->add_option("--frame", options->frame, "Frame of J, dJ, placements, frame_velocity, frame_acceleration, ...")
      ->check(not_empty);
  std::vector<std::string> references;
  for (const Choice& c : choices("dynReference")) references.push_back(c.capital);
  complete(command->add_option("--reference", options->reference, one_of("dynReference", &Choice::capital))->capture_default_str(),
           {references});
  add_effects_option(*command, options->effects);
  add_contact_options(*command, options->contacts);
  command->callback([options] { run_eval(*options); });
}

}  // namespace cli
