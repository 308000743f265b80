// <equality> as constraints, and <contact> <pair>. MuJoCo's are springs (solref, solimp); these are rigid unless
// steps take them as the file has them.
#include <algorithm>
#include <cmath>
#include <map>

#include "mjcf_robot.hpp"
#include "polynomial.hpp"

namespace dyn::load {

namespace {

using Pose = SE3<double>;

const MjcfBody& body_named(const MjcfRobot& robot, const MjcfEquality& e, const std::string& name) {
  if (const MjcfBody* const b = find_body(robot, name)) return *b;
  std::vector<const std::string*> names;
  for (const MjcfBody& b : robot.bodies) names.push_back(&b.name);
  e.place.fail(DYN_ERROR_NAME, "there is no body " + load::in_quotes(name) + did_you_mean(name, names));
}

// Initial pose of a body in the world.
Pose initial_pose(const MjcfRobot& robot, const MjcfBody& body) {
  Pose X = body.X;
  for (int p = body.parent; p >= 0; p = robot.bodies[size_t(p)].parent) X = robot.bodies[size_t(p)].X * X;
  return X;
}

const MjcfJoint& joint_named(const MjcfRobot& robot, const MjcfEquality& e, const std::string& name) {
  if (const MjcfJoint* const j = find_joint(robot, name)) return *j;
  e.place.fail(DYN_ERROR_NAME, "there is no joint " + load::in_quotes(name));
}

const std::string& site_frame(const MjcfRobot& robot, const MjcfEquality& e, const std::string& name) {
  if (const MjcfSite* const s = find_site(robot, name)) return s->frame;
  e.place.fail(DYN_ERROR_NAME, "there is no site " + load::in_quotes(name));
}

// The body itself, or the one that it is welded to; 0: the world.
int moving_body(const MjcfRobot& robot, const MjcfBody& b) {
  const MjcfBody* x = &b;
  while (x->parent >= 0 && x->joints.empty()) x = &robot.bodies[size_t(x->parent)];
  return int(x - robot.bodies.data());
}

Parent frame_of(const MjcfBody& b) { return b.parent < 0 ? Parent{"", 0} : Parent{b.name, DYN_FRAME_TYPE_BODY}; }

// A model has those that hold alone.
void add_tendon_equality(Builder& builder, MjcfRobot& robot, const MjcfEquality& e) {
  for (const std::string& name : {e.first, e.second}) {
    if (name.empty() || find_tendon(robot, name)) continue;
    if (!robot.lost_tendons.count(name)) e.place.fail(DYN_ERROR_NAME, "there is no tendon " + load::in_quotes(name));
    return e.place.physics("it is left out: a tendon is missing from the model");
  }
  if (!e.enabled) return e.place.physics("it is not active, and tendons can't be coupled later: it is left out");
  if (!robot.closed) return;
  std::array<double, 5> polynomial;
  std::copy_n(e.numbers.begin(), 5, polynomial.begin());
  with_location(e.place, [&] { builder.couple_tendons(e.name, e.first, e.second, polynomial, e.compliance); });
}

Pose relative_pose(const std::vector<double>& x) { return {from_quaternion(x[3], x[4], x[5], x[6]), load3(x.data())}; }

}  // namespace

void read_mjcf_equality(MjcfFile& file, Element& e, const MjcfContext& context) {
  const std::string kind = e.Name();
  file.defaults.apply(file.source, e, "equality", context.childclass);
  std::string name = context.name(attribute(e, "name"));
  if (name.empty()) name = kind + "_" + std::to_string(file.robot.equalities.size());
  const Reader reader = file.source.reader(e, "equality " + load::in_quotes(name));
  MjcfEquality x{{&reader.report, line(e), reader.owner}, name, kind, {}, {}, {}, {}, true, false};
  if (kind != "connect" && kind != "weld" && kind != "joint" && kind != "tendon") {
    x.place.physics("<" + kind.substr(0, 60) + "> is not supported: its parts stay unconnected");
    return;
  }
  reader.unread(e,
                {"name", "class", "active", "solref", "solimp", "body1", "body2", "site1", "site2", "anchor", "relpose",
                 "torquescale", "joint1", "joint2", "tendon1", "tendon2", "polycoef"},
                {});
  x.compliance = read_mjcf_compliance(reader, e, "solref", "solimp");
  x.compliance.scale = reader.optional_number(e, "torquescale").value_or(1);
  if (!(x.compliance.scale >= 0)) reader.bad_numbers(e, "torquescale", "it is negative");
  x.enabled = read_switch(reader, e, "active", true).value_or(true);
  const auto end = [&](const char* of, const std::string& part) { return file.copies.name(context, of, part); };
  if (kind == "joint" || kind == "tendon") {
    x.first = end(kind.c_str(), reader.name(e, (kind + "1").c_str()));
    x.second = end(kind.c_str(), attribute(e, (kind + "2").c_str()));
    x.numbers = reader.numbers(e, "polycoef").value_or(std::vector<double>());
    if (x.numbers.size() > 5) reader.bad_numbers(e, "polycoef", "five numbers are expected");
    for (size_t k = x.numbers.size(); k < 5; ++k) x.numbers.push_back(k == 1);
  } else if (e.Attribute("site1")) {
    x.sites = true;
    x.first = end("site", reader.name(e, "site1")), x.second = end("site", reader.name(e, "site2"));
  } else {
    x.first = end("body", reader.name(e, "body1"));
    x.second = e.Attribute("body2") ? end("body", attribute(e, "body2")) : "world";
    if (kind == "connect") x.anchor = reader.vector3(e, "anchor");
    else x.anchor = reader.vector3(e, "anchor").value_or(std::array<double, 3>{0, 0, 0});
    if (!x.anchor) reader.fail(DYN_ERROR_INVALID, e, "<connect> has no anchor");
    if (const auto pose = reader.numbers(e, "relpose", 7)) x.numbers = *pose;
  }
  file.source.charge(&Budget::add_rows, kind == "connect" ? 3 : kind == "weld" ? 6 : 1, e);
  file.robot.equalities.push_back(std::move(x));
}

void add_mjcf_equalities(Builder& builder, MjcfRobot& robot) {
  for (const MjcfEquality& e : robot.equalities) {
    if (e.kind == "tendon") {
      add_tendon_equality(builder, robot, e);
      continue;
    }
    dynConstraint c = default_constraint(e.kind == "connect" ? DYN_CONSTRAINT_TYPE_CONNECT
                                         : e.kind == "weld"  ? DYN_CONSTRAINT_TYPE_WELD
                                                             : DYN_CONSTRAINT_TYPE_COUPLING);
    c.enabled = e.enabled && robot.closed;
    if (robot.has_lost(e.first) || robot.has_lost(e.second)) {
      e.place.physics("it is left out: what it connects is missing from the model");
      continue;
    }
    if (e.kind == "joint") {
      const MjcfJoint& first = joint_named(robot, e, e.first);
      if (e.second.empty()) std::fill_n(c.coefficients, 5, 0.0), c.coefficients[0] = e.numbers[0];
      else shift_polynomial(e.numbers, joint_named(robot, e, e.second).reference, c.coefficients);
      c.coefficients[0] += first.reference;
      const std::string second = e.second.empty() ? "universe" : e.second;
      with_location(e.place, [&] { builder.constraint(e.name, c, {e.first, 0}, {second, 0}, e.compliance); });
      continue;
    }
    if (e.sites) {
      const auto frame = [&](const std::string& site) { return Parent{site_frame(robot, e, site), DYN_FRAME_TYPE_OP_FRAME}; };
      with_location(e.place, [&] { builder.constraint(e.name, c, frame(e.first), frame(e.second), e.compliance); });
      continue;
    }
    const MjcfBody &a = body_named(robot, e, e.first), &b = body_named(robot, e, e.second);
    if (moving_body(robot, a) == moving_body(robot, b)) {
      e.place.info("it has no effect: both bodies are fixed to one another");
      continue;
    }
    const Pose X_ab = initial_pose(robot, a).inverse() * initial_pose(robot, b);
    const Vec3<double> anchor = load3(e.anchor->data());
    Pose in_a = {Mat3<double>::identity(), anchor}, in_b = in_a;
    if (e.kind == "connect") {
      in_b.p = X_ab.inverse().act(anchor);
    } else {  // a weld's anchor is in the second body
      const bool given =
          e.numbers.size() == 7 && (e.numbers[3] != 0 || e.numbers[4] != 0 || e.numbers[5] != 0 || e.numbers[6] != 0);
      in_a = given ? relative_pose(e.numbers) : X_ab * in_b;
    }
    store_se3(in_a, c.placement1), store_se3(in_b, c.placement2);
    // exchange the two if the first is fixed to the world, which gives the same constraint
    with_location(e.place, [&] { builder.constraint(e.name, c, frame_of(a), frame_of(b), e.compliance); });
  }
}

void read_mjcf_pair(MjcfFile& file, Element& e, const MjcfContext& context) {
  file.defaults.apply(file.source, e, "pair", context.childclass);
  const Reader reader = file.source.reader(e, "<pair>");
  reader.unread(
      e, {"name", "class", "geom1", "geom2", "condim", "friction", "solref", "solreffriction", "solimp", "gap", "margin"}, {});
  const auto geom = [&](const char* end) { return file.copies.name(context, "geom", reader.name(e, end)); };
  MjcfPair pair{{&reader.report, line(e), reader.owner},
                {geom("geom1"), geom("geom2")},
                shape::default_material()};
  std::vector<double> f = {1, 1, 0.005, 0.0001, 0.0001};  // whatever the geoms have
  if (const auto given = reader.numbers(e, "friction"))
    for (size_t k = 0; k < std::min<size_t>(given->size(), 5); ++k) f[k] = (*given)[k];
  for (const double x : f)
    if (x < 0) reader.bad_numbers(e, "friction", "coefficients are not negative");
  if (f[0] != f[1] || f[3] != f[4]) pair.place.physics("friction differs by direction: the first of each is used");
  pair.material.restitution = mjcf_rebound(reader, e);
  pair.material.friction = f[0], pair.material.torsion = f[2], pair.material.rolling = f[3];
  pair.latent = mjcf_latent(reader, e), pair.material = shape::acting(pair.material, pair.latent);
  pair.compliance = read_mjcf_compliance(reader, e, "solref", "solimp");
  if (const auto across = reader.numbers(e, "solreffriction"))
    std::copy_n(across->begin(), std::min<size_t>(across->size(), 2), pair.compliance.across);
  pair.margin = reader.optional_number(e, "margin").value_or(0);
  pair.compliance.margin = std::max(0.0, pair.margin);
  file.robot.pairs.push_back(std::move(pair));
}

void mark_mjcf_pairs(MjcfRobot& robot) {
  std::set<std::string> named;
  for (const MjcfPair& p : robot.pairs) named.insert({p.geoms[0], p.geoms[1]});
  std::map<std::string, double> margins;
  for (const MjcfBody& b : robot.bodies)
    for (const MjcfGeom& g : b.geoms) margins[g.shape.name] = g.margin;
  for (MjcfBody& b : robot.bodies)
    for (MjcfGeom& g : b.geoms)
      if (g.shape.role == DYN_SHAPE_ROLE_VISUAL && named.count(g.shape.name)) g.shape.role = DYN_SHAPE_ROLE_COLLISION;
  for (const MjcfPair& p : robot.pairs)
    if (const double of_geoms = margins[p.geoms[0]] + margins[p.geoms[1]]; p.margin != of_geoms)
      p.place.physics("its margin is not used: the sum of its geoms' margins acts instead, but in steps as the file has it the "
                      "smaller one");
}

void add_mjcf_pairs(Builder& builder, const MjcfRobot& robot) {
  if (!robot.contacts) return;
  std::map<std::string, int> carriers;  // moving bodies by their geoms
  for (const MjcfBody& b : robot.bodies)
    for (const MjcfGeom& g : b.geoms) carriers[g.shape.name] = moving_body(robot, b);
  for (const MjcfPair& p : robot.pairs)
    if (robot.has_lost(p.geoms[0]) || robot.has_lost(p.geoms[1]))
      p.place.physics("it is left out: a geom is missing from the model");
    else if (p.geoms[0] != p.geoms[1] && carriers.count(p.geoms[0]) && carriers.count(p.geoms[1]) &&
             carriers[p.geoms[0]] == carriers[p.geoms[1]])
      p.place.info("it has no effect: both geoms are fixed to one another");
    else with_location(p.place, [&] { builder.pair(p.geoms[0], p.geoms[1], &p.material, p.compliance); });
}

}  // namespace dyn::load
