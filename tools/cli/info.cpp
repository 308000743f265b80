// dyn info: sizes, joints, frames, shapes, masses, effects and why, the load report, bytes of model and data.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "files.hpp"
#include "page/recording.hpp"
#include "stepping.hpp"

namespace cli {
namespace {

json joint_json(const Robot& robot, int id) {
  const dynJointInfo j = robot.joint(id);
  const auto slice = [&](dynModelArray which, int first, int n) { return vector_json(dyn_model_array(robot, which) + first, n); };
  json out = {{"name", j.name},     {"type", id == 0 ? "universe" : joint_type_name(j.type)},
              {"parent", j.parent}, {"idx_q", j.idx_q},
              {"idx_v", j.idx_v},   {"nq", j.nq},
              {"nv", j.nv}};
  out["limits"] = {{"lower", slice(DYN_MODEL_ARRAY_LOWER_LIMIT, j.idx_q, j.nq)},  // an infinite limit is null
                   {"upper", slice(DYN_MODEL_ARRAY_UPPER_LIMIT, j.idx_q, j.nq)},
                   {"velocity", slice(DYN_MODEL_ARRAY_VELOCITY_LIMIT, j.idx_v, j.nv)},
                   {"effort", slice(DYN_MODEL_ARRAY_EFFORT_LIMIT, j.idx_v, j.nv)}};
  if (j.mimic_leader >= 0)
    out["mimic"] = {
        {"leader", dyn_model_joint_name(robot, j.mimic_leader)}, {"ratio", j.mimic_ratio}, {"offset", j.mimic_offset}};
  return out;
}

// Lengths are those of the initial configuration.
json tendons_json(const Robot& robot) {
  const int n = dyn_model_ntendons(robot);
  json out = json::array();
  if (n == 0) return out;
  const Data data(robot, DYN_PART_KINEMATICS);
  Vector length(static_cast<std::size_t>(n));
  check(dyn_tendons(robot, data, nullptr, nullptr, length.data(), nullptr, nullptr));
  for (int k = 0; k < n; ++k) {
    dynTendon t{};
    t.struct_size = sizeof t;
    check(dyn_model_tendon_info(robot, k, &t));
    json item = {{"name", dyn_model_tendon_name(robot, k)},
                 {"type", name_of("dynTendonType", t.type)},
                 {"length", length[static_cast<std::size_t>(k)]},
                 {"stiffness", t.stiffness},
                 {"rest", vector_json(t.rest, 2)},
                 {"damping", t.damping},
                 {"friction", t.friction},
                 {"armature", t.armature},
                 {"range", vector_json(t.range, 2)},
                 {"elements", json::array()}};
    for (int i = 0; i < t.elements; ++i) {
      dynTendonElement e{};
      e.struct_size = sizeof e;
      check(dyn_model_tendon_element(robot, k, i, &e));
      json element = {{"type", name_of("dynTendonElementType", e.type)}};
      if (e.name) element["name"] = e.name;
      if (e.type != DYN_TENDON_ELEMENT_TYPE_SITE) element["value"] = e.value;
      if (e.side) element["side"] = e.side;
      item["elements"].push_back(std::move(element));
    }
    out.push_back(std::move(item));
  }
  return out;
}

json actuators_json(const Robot& robot) {
  json out = json::array();
  for (int k = 0; k < dyn_model_nactuators(robot); ++k) {
    dynActuator a{};
    a.struct_size = sizeof a;
    check(dyn_model_actuator_info(robot, k, &a));
    const bool on_joint = a.transmission == DYN_TRANSMISSION_JOINT || a.transmission == DYN_TRANSMISSION_AXES;
    const char* target = on_joint                                    ? dyn_model_joint_name(robot, a.joint)
                         : a.transmission == DYN_TRANSMISSION_TENDON ? dyn_model_tendon_name(robot, a.tendon)
                                                                     : dyn_model_frame_name(robot, a.frame);
    json item = {{"name", dyn_model_actuator_name(robot, k)},
                 {"type", name_of("dynActuatorType", a.type)},
                 {"transmission", name_of("dynTransmission", a.transmission)},
                 {"target", target}};
    if (a.transmission == DYN_TRANSMISSION_JOINT) item["component"] = a.component;
    if (a.reference >= 0) item["reference"] = dyn_model_frame_name(robot, a.reference);
    if (a.controls != 1) item["controls"] = a.controls;
    if (a.activations > 0) item["activations"] = a.activations;
    out.push_back(std::move(item));
  }
  return out;
}

json sensors_json(const Robot& robot) {
  json out = json::array();
  for (int k = 0; k < dyn_model_nsensors(robot); ++k) {
    dynSensor s{};
    s.struct_size = sizeof s;
    check(dyn_model_sensor_info(robot, k, &s));
    const std::string quantity = name_of("dynQuantity", s.quantity);
    json item = {{"name", dyn_model_sensor_name(robot, k)}, {"quantity", quantity}, {"idx", s.idx}, {"size", s.size}};
    const auto side_name = [&](dynSide side, int id) {
      if (side != DYN_SIDE_SHAPE) return dyn_model_frame_name(robot, id);
      dynShapeInfo shape{};
      shape.struct_size = sizeof shape;
      check(dyn_model_shape_info(robot, id, &shape));
      return shape.name;
    };
    if (s.object >= 0)
      item["object"] = s.side != DYN_SIDE_ANY ? side_name(s.side, s.object) :
 quantity.starts_with("joint") || quantity.starts_with("ball") ? dyn_model_joint_name(robot, s.object)
                       : quantity.starts_with("tendon")                              ? dyn_model_tendon_name(robot, s.object)
                       : quantity.starts_with("actuator") ? dyn_model_actuator_name(robot, s.object)
                                                          : dyn_model_frame_name(robot, s.object);
    if (s.reference >= 0) item["reference"] = side_name(s.other_side, s.reference);
    if (s.delay > 0) item["delay"] = s.delay;
    out.push_back(std::move(item));
  }
  return out;
}

json mocaps_json(const Robot& robot) {
  json out = json::array();
  for (int k = 0; k < dyn_model_nmocaps(robot); ++k) out.push_back(dyn_model_frame_name(robot, dyn_model_mocap_frame(robot, k)));
  return out;
}

json info_json(const Robot& robot) {
  json out = {{"name", dyn_model_name(robot)}, {"nq", robot.nq}, {"nv", robot.nv}};
  out["gravity"] = vector_json(dyn_model_array(robot, DYN_MODEL_ARRAY_GRAVITY), 3);
  out["total_mass"] = dyn_model_total_mass(robot);
  out["joints"] = json::array();
  for (int i = 0; i < robot.njoints; ++i) out["joints"].push_back(joint_json(robot, i));
  out["frames"] = json::array();
  for (int i = 0; i < robot.nframes; ++i) {
    const dynFrameInfo f = robot.frame(i);
    out["frames"].push_back({{"name", f.name}, {"type", frame_type_name(f.type)}, {"joint", f.joint}, {"mass", f.mass}});
  }
  out["shapes"] = json::array();
  for (int i = 0; i < dyn_model_nshapes(robot); ++i) {
    dynShapeInfo s{};
    s.struct_size = sizeof s;
    check(dyn_model_shape_info(robot, i, &s));
    out["shapes"].push_back({{"name", s.name},
                             {"type", shape_type_name(s.type)},
                             {"role", s.role == DYN_SHAPE_ROLE_COLLISION ? "collision" : "visual"},
                             {"frame", s.frame},
                             {"size", vector_json(s.size, 3)},
                             {"mesh", s.mesh}});
  }
  out["tendons"] = tendons_json(robot), out["actuators"] = actuators_json(robot), out["sensors"] = sensors_json(robot);
  out["mocaps"] = mocaps_json(robot);
  out["configurations"] = json::array();
  for (int i = 0; i < dyn_model_nconfigurations(robot); ++i)
    out["configurations"].push_back(dyn_model_configuration_name(robot, i));
  out["disabled_pairs"] = json::array();
  for (int i = 0; i < dyn_model_ndisabled_pairs(robot); ++i) {
    int frame1, frame2;
    const char* reason;
    check(dyn_model_disabled_pair(robot, i, &frame1, &frame2, &reason));
    out["disabled_pairs"].push_back(
        {{"frame1", dyn_model_frame_name(robot, frame1)}, {"frame2", dyn_model_frame_name(robot, frame2)}, {"reason", reason}});
  }
  out["effects"] = effects(robot);
  out["report"] = json::array();
  for (int i = 0; i < dyn_model_report_count(robot); ++i) {
    dynReportEntry e{};
    e.struct_size = sizeof e;
    check(dyn_model_report_entry(robot, i, &e));
    out["report"].push_back({{"level", name_of("dynReportLevel", e.level)}, {"message", e.message}, {"line", e.line}});
  }
  out["model_bytes"] = dyn_model_size(robot);
  out["data_bytes"] = dyn_data_size(robot, DYN_PART_ALL);
  return out;
}

std::string limit_text(const json& limits) {
  std::string out;
  const auto number = [](const json& x) { return short_number(x.get<double>(), 5); };
  for (std::size_t i = 0; i < limits["lower"].size(); ++i)
    out += (i ? " " : "") + ("[" + number(limits["lower"][i]) + ", " + number(limits["upper"][i]) + "]");
  return out;
}

}  // namespace

std::string table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> width;
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i == width.size()) width.push_back(0);
      width[i] = std::max(width[i], row[i].size());
    }
  std::string out;
  for (const auto& row : rows) {
    std::string line = " ";
    for (std::size_t i = 0; i < row.size(); ++i) line += " " + row[i] + std::string(width[i] - row[i].size() + 1, ' ');
    out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return out;
}

namespace {

// The forces of a tendon itself, and what drives it, for people.
std::string tendon_note(const json& tendon, const json& actuators) {
  std::vector<std::string> words;
  for (const char* what : {"stiffness", "damping", "friction", "armature"})
    if (const double x = tendon[what]; x != 0) words.push_back(what + (" " + short_number(x, 5)));
  if (const double low = tendon["range"][0], high = tendon["range"][1]; std::isfinite(low) || std::isfinite(high))
    words.push_back("within [" + short_number(low, 5) + ", " + short_number(high, 5) + "]");
  for (const json& a : actuators)
    if (a["transmission"] == "tendon" && a["target"] == tendon["name"])
      words.push_back("driven by " + a["name"].get<std::string>());
  return join(words);
}

std::string tendons_text(const json& info) {
  const auto str = [](const json& x) { return x.get<std::string>(); };
  std::string out;
  std::vector<std::vector<std::string>> rows = {{"tendon", "name", "type", "length", ""}};
  for (const json& t : info["tendons"])
    rows.push_back({std::to_string(rows.size() - 1), str(t["name"]), str(t["type"]), short_number(t["length"].get<double>()),
                    tendon_note(t, info["actuators"])});
  if (rows.size() > 1) out += "\ntendons\n" + table(rows);
  rows = {{"actuator", "name", "type", "acts on", ""}};
  for (const json& a : info["actuators"])
    rows.push_back({std::to_string(rows.size() - 1), str(a["name"]), str(a["type"]),
                    str(a["transmission"]) + " " + str(a["target"]),
                    a.contains("reference") ? "against " + str(a["reference"]) : ""});
  if (rows.size() > 1) out += "\nactuators\n" + table(rows);
  rows = {{"sensor", "name", "quantity", "of", ""}};
  for (const json& s : info["sensors"])
    rows.push_back({std::to_string(rows.size() - 1), str(s["name"]), str(s["quantity"]),
                    s.contains("object") ? str(s["object"]) : "", s.contains("reference") ? "in " + str(s["reference"]) : ""});
  if (rows.size() > 1) out += "\nsensors\n" + table(rows);
  return out;
}

std::string info_text(const json& info) {
  const auto str = [](const json& x) { return x.get<std::string>(); };
  const auto num = [](const json& x) { return std::to_string(x.get<long long>()); };
  std::string out = str(info["name"]) + ": nq " + num(info["nq"]) + ", nv " + num(info["nv"]) + ", " +
                    short_number(info["total_mass"].get<double>()) + " kg, " + std::to_string(info["shapes"].size()) +
                    " shapes; model " + num(info["model_bytes"]) + " bytes, data " + num(info["data_bytes"]) + " bytes\n";
  std::vector<std::vector<std::string>> rows = {{"joint", "name", "type", "parent", "q", "v", "limits"}};
  int id = 0;
  for (const auto& j : info["joints"]) {
    const auto range = [&](const char* first, const char* n) {
      const int i = j[first], k = j[n];
      return k == 0 ? std::string("-") : k == 1 ? std::to_string(i) : std::to_string(i) + ".." + std::to_string(i + k - 1);
    };
    std::string note = limit_text(j["limits"]);
    if (j.contains("mimic"))
      note = "= " + short_number(j["mimic"]["ratio"].get<double>()) + " * " + str(j["mimic"]["leader"]) + " + " +
             short_number(j["mimic"]["offset"].get<double>());
    rows.push_back({std::to_string(id++), str(j["name"]), str(j["type"]), num(j["parent"]), range("idx_q", "nq"),
                    range("idx_v", "nv"), note});
  }
  out += "\njoints\n" + table(rows);
  rows = {{"frame", "name", "type", "joint", "kg"}};
  id = 0;
  for (const auto& f : info["frames"]) {
    const double mass = f["mass"];
    rows.push_back({std::to_string(id++), str(f["name"]), str(f["type"]), num(f["joint"]), mass != 0 ? short_number(mass) : ""});
  }
  out += "\nframes\n" + table(rows);
  out += tendons_text(info);
  rows.clear();
  for (const auto& e : info["effects"])
    rows.push_back({str(e["name"]), e["active"].get<bool>() ? "on" : "off", num(e["bytes"]) + " bytes", str(e["reason"])});
  out += "\neffects\n" + table(rows);
  if (info["configurations"].size() > 1) {
    out += "\nconfigurations\n ";
    for (const auto& name : info["configurations"]) out += " " + str(name);
    out += "\n";
  }
  if (!info["disabled_pairs"].empty())
    out +=
        "\ndisabled pairs\n  " + std::to_string(info["disabled_pairs"].size()) + " pairs of links are not tested for collision\n";
  if (info.contains("meshes")) out += "\nmeshes\n" + meshes_text(info["meshes"]);
  if (info.contains("pairs")) {
    rows.clear();
    for (const auto& p : info["pairs"])
      rows.push_back({str(p["a"]), str(p["b"]), p["tested"].get<bool>() ? "tested" : "not tested: " + str(p["reason"])});
    out += "\npairs of collision shapes\n" + (rows.empty() ? "  none\n" : table(rows));
    const bool any =
        std::any_of(info["pairs"].begin(), info["pairs"].end(), [](const json& p) { return p["tested"].get<bool>(); });
    if (!rows.empty() && !any) out += "  warning: none of them is tested\n";
  }
  rows.clear();
  for (const auto& e : info["report"])
    rows.push_back({str(e["level"]), e["line"] == 0 ? "" : "line " + num(e["line"]), str(e["message"])});
  out += "\nload report\n" + (rows.empty() ? "  nothing: everything in the file is used\n" : table(rows));
  return out;
}

void write_html(const std::string& path, const std::string& html, const RobotOptions& options, const Robot& robot,
                const json& info) {
  page::Pack pack;
  SteppingOptions start;
  json notes = json::array();
  json head = page::still("model", options, robot, start_of(robot, start, notes),
                          std::uint32_t(DYN_EFFECT_DEFAULT) | of_the_whole, pack, notes);
  head["info"] = info;
  page::write_file(path, page::filled(html, head, pack));
}

}  // namespace

void add_info(CLI::App& app) {
  auto options = std::make_shared<RobotOptions>();
  auto pairs = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("info", "Sizes, joints, frames, masses, effects, the load report");
  command->footer("Joint 0 and frame 0 are the universe (the world). A joint with parent 0 is attached to the world.");
  add_robot_options(*command, *options);
  auto meshes = std::make_shared<bool>(false);
  command->add_flag("--meshes", *meshes, "Read the robot's mesh files, too: volume, defects, convexity");
  command->add_flag("--pairs", *pairs, "List the pairs of collision shapes: tested, or the reason why not");
  auto html = std::make_shared<std::string>();
  command->add_option("--html", *html, "Write a page with the robot and this information to this file")->check(not_empty);
  command->callback([options, pairs, meshes, html] {
    check_outputs({{"--html", *html}}, inputs_of(*options));
    const std::string page = html->empty() ? "" : page::page_template();
    const Robot robot(*options);
    json info = info_json(robot);
    if (*pairs) info["pairs"] = pairs_json(robot);
    if (*meshes) info["meshes"] = meshes_json(robot, options->package_dirs);
    if (!html->empty()) write_html(*html, page, *options, robot, info);
    print(options->json ? json_text(info) : info_text(info));
  });
}

}  // namespace cli
