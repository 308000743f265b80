// What every subcommand of `dyn` shares. The command uses nothing but dyn.h: what it can do, every caller can.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "dyn.h"
#include "names.hpp"

namespace CLI {
class App;
}

namespace cli {

using json = nlohmann::ordered_json;
using Vector = std::vector<double>;

// ---------------------------------------------------------------------------------------------------- failing

// Ends the command. 1: the operation failed (it depends on the robot or on files); 2: the command line alone is wrong.
struct Failure {
  int exit_status;
  std::string message;
};
std::string one_line(std::string text);  // without control characters
[[noreturn]] inline void fail(const std::string& message) { throw Failure{1, one_line(message)}; }
[[noreturn]] inline void bad_usage(const std::string& message) { throw Failure{2, one_line(message)}; }
// The library's last error, with options of the command for options of loading: "--fixed" for "base fixed".
std::string library_error();
// Fails with the library's sentence.
inline void check(dynStatus status) {
  if (status != DYN_OK) fail(library_error());
}

// Checks of options, which say what is wrong: an empty text is none; a number in decimals; seconds, more than none; a whole number,
// 0 or more.
std::string not_empty(const std::string& text);
std::string decimal(const std::string& text);
std::string seconds(const std::string& text);
std::string whole(const std::string& text);

// ---------------------------------------------------------------------------------------------------- the robot

// Options of every subcommand that takes a robot.
struct RobotOptions {
  std::string file;
  std::vector<std::string> package_dirs;
  std::string srdf;
  std::string meshes = "auto";
  int contact_capacity = 0;
  int max_bodies = 0, max_shapes = 0, max_constraint_rows = 0, max_keys = 0;  // limits of loading; 0: the default
  std::int64_t max_bytes = 0;
  double max_seconds = 0;
  bool fixed = false, floating = false, strict = false, cos_sin = false, confined = false, json = false;
};
void add_robot_options(CLI::App& command, RobotOptions& options);

template <auto free>
struct Deleter {
  template <class T>
  void operator()(T* handle) const {
    free(handle);
  }
};

struct Robot {
  explicit Robot(const RobotOptions& options, int contacts = 0);
  explicit Robot(dynModel* made);  // owns it
  void add_ground();  // the half-space below z = 0, its friction that of what touches it
  std::unique_ptr<dynModel, Deleter<dyn_model_free>> handle;
  int nq, nv, njoints, nframes;
  bool has_mimic = false;
  operator const dynModel*() const { return handle.get(); }
  dynJointInfo joint(int id) const;
  dynFrameInfo frame(int id) const;
  Vector neutral() const;
  dynParts forward_parts() const;  // what forward dynamics and steps need
};

// Effects that are no bits of dyn.h.
inline constexpr std::uint32_t has_gravity = 1u << 16, has_contact = 1u << 17, has_constraints = 1u << 18,
                               of_the_whole = has_gravity | has_contact | has_constraints;

struct Data {
  Data(const Robot& robot, dynParts parts, std::uint32_t effects = std::uint32_t(DYN_EFFECT_DEFAULT) | of_the_whole);
  std::unique_ptr<dynData, Deleter<dyn_data_free>> handle;
  operator dynData*() const { return handle.get(); }
};
// A copy of a field, column by column.
Vector field(const Robot& robot, const Data& data, const char* name);

inline const char* joint_type_name(dynJointType type) { return name_of("dynJointType", type); }  // "revolute"
inline const char* shape_type_name(dynShapeType type) { return name_of("dynShapeType", type); }  // "half_space"
inline const char* frame_type_name(dynFrameType type) { return capital_name_of("dynFrameType", type); }  // "FIXED_JOINT"

// [{"name", "active", "reason", "bytes"}]: which effects the robot calls for, as far as they are switched on.
json effects(const Robot& robot,
             std::uint32_t on = (std::uint32_t(DYN_EFFECT_ALL) & ~std::uint32_t(DYN_EFFECT_SLEEPING)) | of_the_whole);
// Options --effects and --without: names with commas between.
struct EffectOptions {
  std::string with = "all", without;
};
void add_effects_option(CLI::App& command, EffectOptions& options);
std::uint32_t parse_effects(const EffectOptions& options);
void apply_effects(const Robot& robot, dynData* data, std::uint32_t effects);

// Contacts with the ground, in spare slots.
struct ContactOptions {
  std::vector<std::string> points, faces;
};
void add_contact_options(CLI::App& command, ContactOptions& options);
int contact_count(const ContactOptions& options);
void set_contacts(const Robot& robot, const Data& data, const ContactOptions& options);
// What is said of rows that are redundant but for a misalignment, and of a mechanism that one locks. At q: of an open loop, too.
std::vector<std::string> misalignment_notes(const Robot& robot, const dynConstraintReport& report);
std::vector<std::string> misalignment_notes(const Robot& robot, const double* q);
// Constrained acceleration or forces; the Delassus matrix; C or J of the constraints.
json constrained_json(const Robot& robot, const Data& data, const double* q, const double* v, const double* tau, bool forces);
json delassus_json(const Robot& robot, const Data& data, const double* q);
json constraint_terms_json(const Robot& robot, const Data& data, const double* q, const double* v, const char* what);

// {"pair", "a", "b", "shape_a", "shape_b"}: a pair of collision shapes; with "tested" and "reason": all there could be; with
// "distance", "status", "normal", "point_a", "point_b", "unique": after dyn_distances.
json pair_json(const Robot& robot, int pair);
json pairs_json(const Robot& robot);
json distance_json(const Robot& robot, const Data& data, int pair);
std::vector<int> tested_pairs(const Robot& robot, const Data& data);

// ---------------------------------------------------------------------------------------------------- the state

// Options that give a state: a file, or lists of numbers.
struct StateOptions {
  std::string file;
  std::vector<std::string> q, v, a, tau;
};
void add_state_options(CLI::App& command, StateOptions& options, bool with_acceleration);

struct State {
  Vector q, v, a, tau, ctrl;
  bool has_tau = false;
  bool in_configuration = false;  // activations and time are those of this configuration; "": of new data
  std::string configuration = {};
};
void check_lists(const StateOptions& options);  // what is wrong with the lists whatever the robot
// Numbers from words that hold one or several each, separated by commas or spaces, within [ ] or without; option is named in the
// refusal.
Vector parse_list(const std::string& option, const std::vector<std::string>& words);
State read_state(const Robot& robot, const StateOptions& options);
std::string read_text(const std::string& file, const char* what);  // what: for messages

// ---------------------------------------------------------------------------------------------------- text

json vector_json(const double* data, int n);
json matrix_json(const double* data, int rows, int cols);  // column-major in, list of rows out
// One key of the object a line, and one element a line where a list holds objects.
std::string json_text(const json& object);
// 17 significant digits, whatever the locale.
void append_number(std::string& out, double x);
// %g with so many digits.
std::string short_number(double x, int digits = 6);
// The answer, to standard output; fails when it cannot be written.
void print(const std::string& answer);
// Why a text is no decimal number, or "": then x is it.
std::string number_of(const std::string& text, double& x);
// What stands between commas or spaces; option is named in the refusal of empty places.
std::vector<std::string> list_of(const std::string& option, const std::string& text);
// Shortened, when it is absurdly long.
std::string shown(const std::string& name);
// Columns one below another.
std::string table(const std::vector<std::vector<std::string>>& rows);
std::string join(const std::vector<std::string>& words, const char* separator = ", ");

// ---------------------------------------------------------------------------------------------------- the subcommands

// What dyn_mesh_info says of each of the robot's meshes, or why it cannot be read.
json meshes_json(const Robot& robot, const std::vector<std::string>& package_dirs);
std::string meshes_text(const json& meshes);

void add_info(CLI::App& app);
void add_eval(CLI::App& app);
void add_ik(CLI::App& app);
void add_distance(CLI::App& app);
void add_check(CLI::App& app);
void add_sim(CLI::App& app);
void add_bench(CLI::App& app);
void add_effects(CLI::App& app);
void add_accuracy(CLI::App& app);
void add_compare(CLI::App& app);
void add_stress(CLI::App& app);
void add_view(CLI::App& app);
void add_convert(CLI::App& app);
void add_manual(CLI::App& app);

}  // namespace cli
