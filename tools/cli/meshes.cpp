// dyn info --meshes: what each mesh file of the robot bounds.
#include <algorithm>
#include <cmath>
#include <memory>

#include "cli.hpp"

namespace cli {
namespace {

json mesh_json(const dynMeshInfo& i) {
  json out = {{"vertices", i.vertices},
              {"triangles", i.triangles},
              {"welded", i.welded},
              {"degenerate", i.degenerate},
              {"duplicates", i.duplicates},
              {"skipped", i.skipped},
              {"lower", vector_json(i.lower, 3)},
              {"upper", vector_json(i.upper, 3)},
              {"area", i.area},
              {"components", i.components},
              {"open_edges", i.open_edges},
              {"flipped_edges", i.flipped_edges},
              {"nonmanifold_edges", i.nonmanifold_edges},
              {"closed", i.closed != 0},
              {"orientation", i.orientation}};
  const auto number = [](double x) { return std::isfinite(x) ? json(x) : json(); };
  out["volume"] = number(i.volume);
  out["com"] = i.orientation ? vector_json(i.com, 3) : json();
  out["inertia"] = i.orientation ? matrix_json(i.inertia, 3, 3) : json();
  out["hull_volume"] = number(i.hull_volume);
  out["hull_volume_ratio"] = number(i.hull_volume_ratio);
  out["hull_depth"] = number(i.hull_depth);
  out["convex"] = i.convex < 0 ? json() : json(i.convex != 0);
  return out;
}

}  // namespace

json meshes_json(const Robot& robot, const std::vector<std::string>& package_dirs) {
  json out = json::array();
  std::vector<const char*> folders;
  for (const auto& d : package_dirs) folders.push_back(d.c_str());
  for (int k = 0; k < dyn_model_nshapes(robot); ++k) {
    dynShapeInfo s{};
    s.struct_size = sizeof s;
    check(dyn_model_shape_info(robot, k, &s));
    if (!*s.mesh) continue;
    json entry = {{"shape", k},
                  {"link", dyn_model_frame_name(robot, s.frame)},
                  {"role", s.role == DYN_SHAPE_ROLE_COLLISION ? "collision" : "visual"},
                  {"mesh", s.mesh}};
    dynMeshOptions options;
    dyn_mesh_options_init(&options);
    std::copy(s.size, s.size + 3, options.scale);
    options.package_dirs = folders.empty() ? nullptr : folders.data(), options.package_dirs_count = folders.size();
    dynMesh* mesh = nullptr;
    dynMeshInfo info{};
    info.struct_size = sizeof info;
    dynStatus status = dyn_mesh_load(s.mesh, &options, &mesh);
    const std::unique_ptr<dynMesh, Deleter<dyn_mesh_free>> owner(mesh);
    if (status == DYN_OK) status = dyn_mesh_info(mesh, &info);
    if (status == DYN_OK) entry["info"] = mesh_json(info);
    else entry["error"] = dyn_last_error();
    out.push_back(entry);
  }
  return out;
}

std::string meshes_text(const json& meshes) {
  if (meshes.empty()) return "  none\n";
  std::vector<std::vector<std::string>> rows = {{"link", "role", "triangles", "m^3", "hull/mesh", "convex", "", "file"}};
  for (const auto& m : meshes) {
    const std::string link = m["link"], role = m["role"], file = m["mesh"];
    if (m.contains("error")) {
      rows.push_back({link, role, "", "", "", "", m["error"].get<std::string>(), file});
      continue;
    }
    const json& i = m["info"];
    const auto number = [](const json& x) { return x.is_null() ? std::string("-") : short_number(x.get<double>(), 5); };
    std::vector<std::string> notes;
    const auto note = [&](const char* key, const char* what) {
      if (const auto n = i[key].get<long long>(); n > 0) notes.push_back(std::to_string(n) + " " + what);
    };
    if (i["components"].get<int>() > 1) note("components", "parts");
    note("open_edges", "open edges"), note("flipped_edges", "flipped edges"),
        note("nonmanifold_edges", "edges of more than two triangles");
    note("degenerate", "degenerate triangles dropped"), note("duplicates", "double triangles dropped"),
        note("skipped", "points and lines skipped");
    if (i["orientation"].get<int>() < 0) notes.push_back("inside out");
    rows.push_back({link, role, std::to_string(i["triangles"].get<int>()), number(i["volume"]), number(i["hull_volume_ratio"]),
                    i["convex"].is_null() ? "?" : i["convex"].get<bool>() ? "yes" : "no", join(notes), file});
  }
  return table(rows);
}

}  // namespace cli
