// Parts of an MJCF model by their names.
#include <unordered_map>

#include "mjcf_robot.hpp"

namespace dyn::load {

struct MjcfNames {
  using Map = std::unordered_map<std::string_view, std::pair<size_t, size_t>>;  // number of the body, and in it
  Map bodies, joints, geoms, sites;

  explicit MjcfNames(const MjcfRobot& robot) {
    for (size_t i = 0; i < robot.bodies.size(); ++i) {
      const MjcfBody& b = robot.bodies[i];
      bodies.try_emplace(b.name, i, 0);
      for (size_t k = 0; k < b.joints.size(); ++k) joints.try_emplace(b.joints[k].spec.name, i, k);
      for (size_t k = 0; k < b.geoms.size(); ++k) geoms.try_emplace(b.geoms[k].shape.name, i, k);
      for (size_t k = 0; k < b.sites.size(); ++k) sites.try_emplace(b.sites[k].name, i, k);
    }
  }
};

namespace {

const std::pair<size_t, size_t>* place_of(MjcfRobot& robot, MjcfNames::Map MjcfNames::* kind, const std::string& name) {
  if (!robot.names) robot.names = std::make_shared<const MjcfNames>(robot);
  const MjcfNames::Map& all = (*robot.names).*kind;
  const auto at = all.find(name);
  return at == all.end() ? nullptr : &at->second;
}

}  // namespace

MjcfBody* find_body(MjcfRobot& robot, const std::string& name) {
  const auto at = place_of(robot, &MjcfNames::bodies, name);
  return at ? &robot.bodies[at->first] : nullptr;
}
MjcfJoint* find_joint(MjcfRobot& robot, const std::string& name) {
  const auto at = place_of(robot, &MjcfNames::joints, name);
  return at ? &robot.bodies[at->first].joints[at->second] : nullptr;
}
MjcfGeom* find_geom(MjcfRobot& robot, const std::string& name) {
  const auto at = place_of(robot, &MjcfNames::geoms, name);
  return at ? &robot.bodies[at->first].geoms[at->second] : nullptr;
}
MjcfSite* find_site(MjcfRobot& robot, const std::string& name) {
  const auto at = place_of(robot, &MjcfNames::sites, name);
  return at ? &robot.bodies[at->first].sites[at->second] : nullptr;
}
MjcfTendon* find_tendon(MjcfRobot& robot, const std::string& name) {
  const auto at = robot.tendon_numbers.find(name);
  return at == robot.tendon_numbers.end() ? nullptr : &robot.tendons[at->second];
}

std::string suggestion(const MjcfRobot& robot, const char* kind, const std::string& name) {
  const std::string_view of = kind;
  std::vector<const std::string*> names;
  for (const MjcfBody& b : robot.bodies) {
    if (of == "joint")
      for (const MjcfJoint& x : b.joints) names.push_back(&x.spec.name);
    if (of == "geom")
      for (const MjcfGeom& x : b.geoms) names.push_back(&x.shape.name);
    if (of == "site")
      for (const MjcfSite& x : b.sites) names.push_back(&x.name);
  }
  return did_you_mean(name, names);
}

}  // namespace dyn::load
