// dyn ik: a configuration in which frames are where they should be.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "cli.hpp"

namespace cli {
namespace {

struct IkOptions {
  RobotOptions robot;
  StateOptions state;
  std::vector<std::string> frames, targets;
  std::string com;
  bool stay = false, no_limits = false, best = false;
  int restarts = 20, max_iterations = 500;
  std::uint64_t seed = 0;
  double tolerance = 1e-6;
};

dynIkTask task(dynIkTaskType type, int frame) {
  dynIkTask out;
  dyn_ik_task_init(&out);
  out.type = type, out.frame = frame;
  return out;
}

// Columns of the rotation of a quaternion (x, y, z, w).
void rotate(const double* quaternion, double* R) {
  double n = 0;
  for (int k = 0; k < 4; ++k) n = std::hypot(n, quaternion[k]);
  if (!(n > 0)) bad_usage("--target: the quaternion is zero.");
  const double x = quaternion[0] / n, y = quaternion[1] / n, z = quaternion[2] / n, w = quaternion[3] / n;
  const double columns[9] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w),     2 * (x * z - y * w),
                             2 * (x * y - z * w),     1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
                             2 * (x * z + y * w),     2 * (y * z - x * w),     1 - 2 * (x * x + y * y)};
  std::copy_n(columns, 9, R);
}

// 3 numbers: a position; 4: a quaternion; 7: both.
dynIkTask frame_task(int frame, const std::string& target) {
  const Vector x = parse_list("--target", {target});
  if (x.size() != 3 && x.size() != 4 && x.size() != 7)
    bad_usage("--target: \"" + target + "\" has " + std::to_string(x.size()) +
              " numbers; give 3 (position), 4 (quaternion x y z w) or 7 (position, then quaternion).");
  dynIkTask out = task(x.size() == 3   ? DYN_IK_TASK_TYPE_POSITION
                       : x.size() == 4 ? DYN_IK_TASK_TYPE_ORIENTATION
                                       : DYN_IK_TASK_TYPE_POSE,
                       frame);
  if (x.size() != 4) std::copy_n(x.data(), 3, out.target + 9);
  if (x.size() != 3) rotate(x.data() + x.size() - 4, out.target);
  return out;
}

const char* reason_name(dynIkReason reason) {
  switch (reason) {
    case DYN_IK_REASON_CONVERGED: return "converged";
    case DYN_IK_REASON_LIMITS: return "limits";
    case DYN_IK_REASON_SINGULAR: return "singular";
    case DYN_IK_REASON_LOCAL_MINIMUM: return "local minimum";
    case DYN_IK_REASON_MAX_ITERATIONS: return "iterations";
  }
  return "?";
}

std::string sentence(const Robot& robot, const dynIkResult& r) {
  switch (r.reason) {
    case DYN_IK_REASON_LIMITS:
      return "a limit of joint '" + std::string(dyn_model_joint_name(robot, r.joint)) + "' holds the tasks back";
    case DYN_IK_REASON_SINGULAR: return "no joint moves along the error: the target may be out of reach";
    case DYN_IK_REASON_LOCAL_MINIMUM:
      return "no motion lowers the error: the tasks contradict each other, or --restarts is too small";
    default: return "--max-iterations is too small";
  }
}

void run_ik(const IkOptions& options) {
  if (options.frames.size() != options.targets.size())
    bad_usage("there are " + std::to_string(options.frames.size()) + " --frame and " + std::to_string(options.targets.size()) +
              " --target: give one target for each frame.");
  if (options.frames.empty() && options.com.empty()) bad_usage("nothing to reach: give --frame and --target, or --com.");
  check_lists(options.state);
  std::vector<std::string> names = options.frames;
  std::vector<dynIkTask> tasks;
  for (const std::string& target : options.targets) tasks.push_back(frame_task(0, target));
  if (!options.com.empty()) {
    const Vector x = parse_list("--com", {options.com});
    if (x.size() != 3) bad_usage("--com: \"" + options.com + "\" has " + std::to_string(x.size()) + " numbers, but needs 3.");
    tasks.push_back(task(DYN_IK_TASK_TYPE_COM, 0));
    std::copy_n(x.data(), 3, tasks.back().target + 9);
    names.push_back("centre of mass");
  }
  const Robot robot(options.robot);
  for (std::size_t k = 0; k < options.frames.size(); ++k)
    if ((tasks[k].frame = dyn_model_frame_id(robot, options.frames[k].c_str())) < 0) fail(library_error());
  const Data data(robot, DYN_PART_IK);
  const State state = read_state(robot, options.state);
  if (options.stay) {
    tasks.push_back(task(DYN_IK_TASK_TYPE_POSTURE, 0));
    tasks.back().posture = state.q.data(), tasks.back().priority = 1;
    names.push_back("start");
  }
  dynIkOptions o;
  dyn_ik_options_init(&o);
  o.restarts = options.restarts, o.max_iterations = options.max_iterations, o.seed = options.seed;
  o.tolerance_linear = o.tolerance_angular = options.tolerance, o.limits = !options.no_limits;
  dynIkResult result{};
  result.struct_size = sizeof result;
  Vector q(static_cast<std::size_t>(robot.nq)), residuals(2 * tasks.size());
  const dynIkOutput out = {sizeof out, q.data(), residuals.data(), &result};
  check(dyn_ik(robot, data, state.q.data(), tasks.data(), static_cast<int>(tasks.size()), &o, &out));
  if (result.reason != DYN_IK_REASON_CONVERGED && !options.best)
    fail("not reached: " + sentence(robot, result) + ". The error is " + short_number(result.residual_linear, 3) + " m and " +
         short_number(result.residual_angular, 3) + " rad; --best answers the best configuration.");

  json list = json::array();
  for (std::size_t k = 0; k < tasks.size(); ++k)
    list.push_back({{"name", names[k]}, {"linear", residuals[2 * k]}, {"angular", residuals[2 * k + 1]}});
  if (options.robot.json) {
    print(json_text({{"converged", result.reason == DYN_IK_REASON_CONVERGED},
                     {"reason", reason_name(result.reason)},
                     {"q", vector_json(q.data(), robot.nq)},
                     {"tasks", list},
                     {"iterations", result.iterations},
                     {"restarts", result.restarts},
                     {"joint", result.joint < 0 ? json() : json(dyn_model_joint_name(robot, result.joint))},
                     {"cost", result.cost},
                     {"optimality", result.optimality}}));
  } else {
    std::string text = std::string(reason_name(result.reason)) + " after " + std::to_string(result.iterations) +
                       " iterations and " + std::to_string(result.restarts) + " restarts\nq";
    for (double x : q) text += " " + short_number(x, 9);
    for (const json& t : list)
      text += "\n" + t["name"].get<std::string>() + ": " + short_number(t["linear"].get<double>(), 3) + " m, " +
              short_number(t["angular"].get<double>(), 3) + " rad";
    print(text + "\n");
  }
}

}  // namespace

void add_ik(CLI::App& app) {
  auto options = std::make_shared<IkOptions>();
  CLI::App* command = app.add_subcommand("ik", "Inverse kinematics: a configuration that puts frames at targets");
  add_robot_options(*command, options->robot);
  add_state_options(*command, options->state, false);
  command->add_option("--frame", options->frames, "A frame; one for each --target")->allow_extra_args(false);
  command
      ->add_option("--target", options->targets,
                   "Target of the frame: position (3), quaternion x y z w (4), or both (7), separated by commas; world axes, m")
      ->allow_extra_args(false)
      ->type_name("NUMBERS");
  command->add_option("--com", options->com, "Target of the centre of mass: 3 numbers, m")->type_name("NUMBERS");
  command->add_flag("--stay", options->stay, "Stay as near to the start (--q, --state) as the targets allow");
  command->add_option("--tolerance", options->tolerance, "Error of a met target, m and rad")
      ->check(decimal)
      ->capture_default_str();
  command->add_option("--restarts", options->restarts, "Random starts after the given one")->check(whole)->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the random starts")->check(whole)->capture_default_str();
  command->add_option("--max-iterations", options->max_iterations, "Iterations of each start")
      ->check(whole)
      ->capture_default_str();
  command->add_flag("--best", options->best, "Print the best configuration when the targets are out of reach");
  command->add_flag("--no-limits", options->no_limits, "Ignore joint limits");
  command->callback([options] { run_ik(*options); });
}

}  // namespace cli
