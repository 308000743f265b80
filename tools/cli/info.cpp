// dyn info: sizes, joints, frames, shapes, masses, effects and why, the load report, bytes of model and data.
#include <CLI/CLI.hpp>
#include <algorithm>
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
