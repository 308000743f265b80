// <sensor>: what a model measures.
#include <algorithm>
#include <sstream>

#include "mjcf_robot.hpp"
#include "mjcf_words.hpp"
#include "table/names.hpp"
#include "table/sensors.hpp"

namespace dyn::load {

namespace {

// The frame of an object, and its pose there. Empty: not in the model.
struct Seat {
  std::string frame;
  SE3<double> X;
  bool oriented;  // its axes are MuJoCo's
};

Seat seat_on(const MjcfRobot& robot, const std::vector<MjcfMass>& masses, const std::string& kind, const std::string& name) {
  const auto link = [](const MjcfBody& b) { return b.parent < 0 ? std::string("universe") : b.name; };
  if (kind == "site") {
    const MjcfSite* const s = find_site(robot, name);
    return s ? Seat{s->frame, SE3<double>::identity(), true} : Seat{};
  }
  if (kind == "geom") {
    const MjcfGeom* const g = name.empty() ? nullptr : find_geom(robot, name);
    return g ? Seat{link(robot.bodies[size_t(g->body)]), g->X, !g->mesh} : Seat{};  // axes of a mesh are those of its inertia
  }
  const MjcfBody* const b = find_body(robot, name);
  if (!b) return {};
  if (kind == "xbody") return {link(*b), SE3<double>::identity(), true};
  return {link(*b), {Mat3<double>::identity(), masses[size_t(b - robot.bodies.data())].com}, false};
}

// Bits of a list of words in their order.
template <size_t n>
std::uint32_t read_values(const Reader& reader, const Element& e, const std::pair<std::string_view, std::uint32_t> (&words)[n]) {
  std::istringstream given(attribute(e, "data"));
  std::uint32_t bits = 0;
  size_t next = 0;
  for (std::string word; given >> word;) {
    while (next < n && words[next].first != word) ++next;
    if (next == n) {
      std::string all;
      for (const auto& [known, bit] : words) all += (all.empty() ? "" : ", ") + std::string(known);
      reader.fail(DYN_ERROR_PARSE, e, "data has " + load::in_quotes(word) + ": words of " + all + " in this order are expected");
    }
    bits |= words[next++].second;
  }
  return bits;
}
constexpr std::pair<const char*, dynSide> side_attributes[] = {
    {"geom", DYN_SIDE_SHAPE}, {"body", DYN_SIDE_LINK}, {"subtree", DYN_SIDE_SUBTREE}, {"site", DYN_SIDE_ZONE}};

bool reads_axes(dynQuantity q) { return q >= DYN_QUANTITY_FRAMEQUAT && q <= DYN_QUANTITY_FRAMEZAXIS; }

}  // namespace

void read_mjcf_sensor(MjcfFile& file, Element& e, const MjcfContext& context) {
  const std::string kind = e.Name(), given = attribute(e, "name");
  const std::string name = context.name(given.empty() ? "sensor_" + std::to_string(file.robot.sensors.size()) : given);
  const Reader reader = file.source.reader(e, "sensor " + load::in_quotes(name));
  const MjcfPlace place{&reader.report, line(e), reader.owner};
  MjcfSensor s{place, name, {}, "", "", "", ""};
  (dyn_sensor_init)(&s.spec, sizeof s.spec, DYN_QUANTITY_JOINTPOS);
  if (!value_of(kind, s.spec.quantity))
    return reader.report.count("<sensor>: <" + kind.substr(0, 60) + "> is not supported", line(e));
  const SensorRow& row = sensor_row(s.spec.quantity);
  std::copy(file.robot.magnetic.begin(), file.robot.magnetic.end(), s.spec.field);
  s.spec.noise = reader.optional_number(e, "noise").value_or(0), s.spec.cutoff = reader.optional_number(e, "cutoff").value_or(0);
  if (s.spec.noise < 0) reader.bad_numbers(e, "noise", "it is negative");
  if (s.spec.cutoff < 0) reader.bad_numbers(e, "cutoff", "it is negative");
  const auto named = [&](const std::string& what, const char* attribute) {
    return file.copies.name(context, what == "xbody" ? "body" : what, reader.name(e, attribute));
  };
  s.spec.delay = reader.optional_number(e, "delay").value_or(0);
  if (s.spec.delay < 0) reader.bad_numbers(e, "delay", "it is negative");
  if (reader.optional_number(e, "interval").value_or(0) > 0)
    reader.report.count("<sensor>: interval is not used: values are those of the moment", line(e));
  const auto read_side = [&](const char* number, dynSide& side, std::string& on, std::string& name) {
    for (const auto& [kind, value] : side_attributes)
      if (const std::string attribute = kind + std::string(number); e.Attribute(attribute.c_str()))
        side = value, on = kind, name = named(value == DYN_SIDE_SUBTREE ? "body" : kind, attribute.c_str());
  };
  if (row.object == SensorObject::Sides) {
    const bool contact = s.spec.quantity == DYN_QUANTITY_CONTACT;
    read_side("1", s.spec.side, s.on, s.object), read_side("2", s.spec.other_side, s.to, s.reference);
    if (contact && e.Attribute("site")) s.spec.side = DYN_SIDE_ZONE, s.on = "site", s.object = named("site", "site");
    if (!contact && (s.object.empty() || s.reference.empty()))
      reader.fail(DYN_ERROR_PARSE, e, "geom1 or body1, and geom2 or body2 are expected");
    if (const std::string data = attribute(e, "data"); data.find("linvel") != data.npos || data.find("angvel") != data.npos)
      return reader.report.count("<sensor>: linvel and angvel of <contact> are not supported", line(e));
    s.spec.values = contact ? read_values(reader, e, contact_words) : 0;
    s.spec.count = int(reader.optional_number(e, "num").value_or(1));
    if (const std::string reduce = attribute(e, "reduce"); !reduce.empty() && !value_of(reduce, s.spec.reduction))
      reader.fail(DYN_ERROR_PARSE, e,
                  "reduce is " + load::in_quotes(reduce) + ": none, mindist, maxforce or netforce is expected");
  } else if (s.spec.quantity == DYN_QUANTITY_USER) {
    s.spec.count = int(reader.optional_number(e, "dim").value_or(1));
  } else if (s.spec.quantity == DYN_QUANTITY_RANGEFINDER && e.Attribute("camera")) {
    return reader.report.count("<sensor>: <rangefinder> of a camera is not supported", line(e));
  } else if (e.Attribute("objtype")) {
    s.on = attribute(e, "objtype"), s.object = named(s.on, "objname");
    if (s.on != "body" && s.on != "xbody" && s.on != "geom" && s.on != "site")
      return reader.report.count("<sensor>: objects of type " + s.on.substr(0, 60) + " are not supported", line(e));
  } else if (row.object != SensorObject::None) {
    s.on = row.object == SensorObject::Joint      ? "joint"
           : row.object == SensorObject::Tendon   ? "tendon"
           : row.object == SensorObject::Actuator ? "actuator"
           : e.Attribute("body")                  ? "body"
                                                  : "site";
    s.object = named(s.on, s.on.c_str());
    if (s.on == "body") s.on = "xbody";
  }
  if (s.spec.quantity == DYN_QUANTITY_RANGEFINDER) s.spec.values = read_values(reader, e, ray_words);
  if (s.spec.quantity == DYN_QUANTITY_INSIDESITE) {
    s.to = "site", s.reference = named("site", "site");
  } else if (e.Attribute("reftype")) {
    s.to = attribute(e, "reftype"), s.reference = named(s.to, "refname");
    if (s.to != "body" && s.to != "xbody" && s.to != "geom" && s.to != "site")
      return reader.report.count("<sensor>: references of type " + s.to.substr(0, 60) + " are not supported", line(e));
  }
  reader.unread(e,
                {"name", "noise", "cutoff", "user", "delay", "nsample", "interval", "interp", "objtype",
                 "objname", "reftype", "refname",
                 "joint", "tendon", "actuator", "site", "body", "geom1", "geom2", "body1", "body2", "subtree1", "subtree2",
                 "camera", "data", "reduce", "num", "dim", "datatype", "needstage"},
                {}, false);
  file.robot.sensors.push_back(std::move(s));
}

void add_mjcf_sensors(Builder& builder, const MjcfRobot& robot, const std::vector<MjcfMass>& masses) {
  const auto set = [](const SE3<double>& X, double* to) { store33(X.R, to), store3(X.p, to + 9); };
  const auto type = [](const Seat& s, const std::string& kind) {
    return kind == "site" || s.frame == "universe" ? int(DYN_FRAME_TYPE_OP_FRAME) : int(DYN_FRAME_TYPE_BODY);
  };
  std::set<std::string> inert;
  for (const MjcfActuator& a : robot.actuators)
    if (a.inert) inert.insert(a.name);
  for (const MjcfSensor& s : robot.sensors) {
    dynSensor spec = s.spec;
    std::string object = s.object, reference;
    const auto lost = [&](const std::string& name) {
      return robot.has_lost(name) || robot.lost_tendons.count(name) || inert.count(name);
    };
    if (lost(s.object) || lost(s.reference)) {
      s.place.info("it is left out: what it is on is missing from the model");
      continue;
    }
    if (sensor_row(spec.quantity).object == SensorObject::Sides) {
      bool lacks = false;
      const auto side = [&](const std::string& kind, const std::string& name) -> std::string {
        if (kind.empty()) return "";
        if (kind == "site") return find_site(robot, name) ? find_site(robot, name)->frame : "";
        if (kind != "geom") return find_body(robot, name) ? name == "world" ? "universe" : name : "";
        const MjcfGeom* const g = find_geom(robot, name);
        lacks = lacks || !g || g->discarded || g->shape.role != DYN_SHAPE_ROLE_COLLISION;
        return g ? g->shape.name : "";
      };
      object = side(s.on, s.object), reference = side(s.to, s.reference);
      if (lacks) {
        s.place.report->count("<sensor>: geoms that do not collide are not supported in " + std::string(name_of(spec.quantity)),
                              s.place.line);
        continue;
      }
      if (object.empty() != s.object.empty())
        s.place.fail(DYN_ERROR_NAME, "there is no " + s.on + " " + load::in_quotes(s.object));
      if (reference.empty() != s.reference.empty())
        s.place.fail(DYN_ERROR_NAME, "there is no " + s.to + " " + load::in_quotes(s.reference));
      if (const MjcfSite* const zone = find_site(robot, s.object); zone && spec.side == DYN_SIDE_ZONE)
        spec.shape = zone->shape, std::copy(zone->extent.begin(), zone->extent.end(), spec.extent);
    }
    if (sensor_row(spec.quantity).object == SensorObject::Frame) {
      const Seat seat = seat_on(robot, masses, s.on, s.object);
      if (seat.frame.empty()) s.place.fail(DYN_ERROR_NAME, "there is no " + s.on + " " + load::in_quotes(s.object));
      if (!seat.oriented && reads_axes(spec.quantity)) {
        s.place.report->count("<sensor>: axes of inertias are not supported: use objtype xbody", s.place.line);
        continue;
      }
      object = seat.frame, spec.object = type(seat, s.on), set(seat.X, spec.placement);
      if (spec.quantity >= DYN_QUANTITY_SUBTREECOM && spec.quantity <= DYN_QUANTITY_SUBTREEANGMOM && object == "universe") {
        s.place.report->count("<sensor>: the subtree of the world is not supported", s.place.line);
        continue;
      }
      if (!s.reference.empty()) {
        const Seat other = seat_on(robot, masses, s.to, s.reference);
        if (other.frame.empty()) s.place.fail(DYN_ERROR_NAME, "there is no " + s.to + " " + load::in_quotes(s.reference));
        if (!other.oriented) {
          s.place.report->count("<sensor>: axes of inertias are not supported: use reftype xbody", s.place.line);
          continue;
        }
        reference = other.frame, spec.reference = type(other, s.to), set(other.X, spec.reference_placement);
      }
      const bool inside = spec.quantity == DYN_QUANTITY_INSIDESITE;
      if (const MjcfSite* const zone = find_site(robot, inside ? s.reference : s.object))
        spec.shape = zone->shape, std::copy(zone->extent.begin(), zone->extent.end(), spec.extent);
    }
    with_location(s.place, [&] { builder.sensor(s.name, spec, object, reference); });
  }
}

}  // namespace dyn::load
