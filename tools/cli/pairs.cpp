// Pairs of collision shapes, as info, eval and distance tell them.
#include <map>
#include <set>

#include "cli.hpp"

namespace cli {

namespace {

std::string link_of(const Robot& robot, int shape) {
  dynShapeInfo s{};
  s.struct_size = sizeof s;
  check(dyn_model_shape_info(robot, shape, &s));
  return robot.frame(s.frame).name;
}

json names(const Robot& robot, int shape_a, int shape_b) {
  return {{"a", link_of(robot, shape_a)}, {"b", link_of(robot, shape_b)}, {"shape_a", shape_a}, {"shape_b", shape_b}};
}

const char* reason_text(dynPairReason reason) {
  switch (reason) {
    case DYN_PAIR_REASON_TESTED: return "tested";
    case DYN_PAIR_REASON_OVERLAPS: return "they overlap in the neutral configuration and in nearly all others";
    case DYN_PAIR_REASON_MESH: return "one is a mesh, of which only the file's name is known: see --collision-meshes";
    case DYN_PAIR_REASON_OFF: return "switched off";
    case DYN_PAIR_REASON_DISABLED: return "disabled in the SRDF";
    case DYN_PAIR_REASON_MASK: return "neither is in a group that the other collides with";
  }
  return "unknown";
}

}  // namespace

json pair_json(const Robot& robot, int pair) {
  int a, b;
  check(dyn_model_pair(robot, pair, &a, &b, nullptr));
  json out = {{"pair", pair}};
  out.update(names(robot, a, b));
  return out;
}

json pairs_json(const Robot& robot) {
  std::vector<int> shapes, joint;
  for (int k = 0; k < dyn_model_nshapes(robot); ++k) {
    dynShapeInfo s{};
    s.struct_size = sizeof s;
    check(dyn_model_shape_info(robot, k, &s));
    if (s.role == DYN_SHAPE_ROLE_COLLISION) shapes.push_back(k), joint.push_back(robot.frame(s.frame).joint);
  }
  std::map<std::pair<int, int>, dynPairReason> listed;
  for (int k = 0; k < dyn_model_npairs(robot); ++k) {
    int a, b;
    dynPairReason reason;
    check(dyn_model_pair(robot, k, &a, &b, &reason));
    listed[{a, b}] = reason;
  }
  json out = json::array();
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (std::size_t j = i + 1; j < shapes.size(); ++j) {
      const auto found = listed.find({shapes[i], shapes[j]});
      json row = names(robot, shapes[i], shapes[j]);
      row["tested"] = found != listed.end() && found->second == DYN_PAIR_REASON_TESTED;
      row["reason"] = found != listed.end()  ? reason_text(found->second)
                      : joint[i] == joint[j] ? "they belong to one body"
                                             : "a body and its parent";
      out.push_back(row);
    }
  return out;
}

json distance_json(const Robot& robot, const Data& data, int pair) {
  static constexpr const char* statuses[] = {"separated", "touching", "penetrating", "failed"};
  dynDistance d{};
  d.struct_size = sizeof d;
  check(dyn_pair_distance(robot, data, pair, &d));
  json out = pair_json(robot, pair);
  out["distance"] = d.distance;
  out["status"] = statuses[d.status];
  out["normal"] = vector_json(d.normal, 3);
  out["point_a"] = vector_json(d.point_a, 3), out["point_b"] = vector_json(d.point_b, 3);
  out["unique"] = d.unique != 0;
  return out;
}

std::vector<int> tested_pairs(const Robot& robot, const Data& data) {
  std::vector<int> out;
  for (int k = 0; k < dyn_model_npairs(robot); ++k) {
    dynPairReason reason;
    check(dyn_data_pair(robot, data, k, &reason));
    if (reason == DYN_PAIR_REASON_TESTED) out.push_back(k);
  }
  return out;
}

}  // namespace cli
