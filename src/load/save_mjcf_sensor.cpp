// Model to MJCF: sensors. Those of frames are on sites.
#include <cmath>

#include "mjcf_words.hpp"
#include "save_mjcf.hpp"
#include "table/names.hpp"
#include "table/sensors.hpp"

namespace dyn::load {

namespace {

template <std::size_t n>
std::string words_of(const dynSensor& s, const std::pair<std::string_view, std::uint32_t> (&words)[n]) {
  std::string out;
  for (const auto& [word, bit] : words)
    if (s.values & bit) out += (out.empty() ? "" : " ") + std::string(word);
  return out;
}

}  // namespace

void MjcfWriter::put_sides(XmlElement& e, const dynSensor& s) {
  const auto put_side = [&](const char* number, dynSide side, Index x) {
    if (side == DYN_SIDE_ANY) return;
    const std::string kind = side == DYN_SIDE_SHAPE ? "geom" : side == DYN_SIDE_LINK ? "body" : "subtree";
    const std::string name = side == DYN_SIDE_SHAPE ? geom_names[x] : x == 0 ? "world" : body_names[x];
    put(e, (kind + number).c_str(), name);
  };
  put_side("1", s.side, s.object), put_side("2", s.other_side, s.reference);
  if (s.quantity != DYN_QUANTITY_CONTACT) return;
  if (s.values) put(e, "data", words_of(s, contact_words));
  if (s.count != 1) put(e, "num", double(s.count));
  if (s.reduction != DYN_REDUCTION_NONE) put(e, "reduce", std::string(name_of(s.reduction)));
}

void MjcfWriter::add_sensors() {
  for (Index k = 0; k < m.n.sensors; ++k) {
    const dynSensor& s = m.sensors()[k].spec;
    const std::string name = m.string(m.sensors()[k].name);
    const SensorRow& row = sensor_row(s.quantity);
    if (s.quantity == DYN_QUANTITY_TOUCH || s.quantity == DYN_QUANTITY_INSIDESITE) {
      losses.loss("sensors with a zone", name);
      continue;
    }
    if (s.quantity >= DYN_QUANTITY_SUBTREECOM && s.quantity <= DYN_QUANTITY_SUBTREEANGMOM) {
      losses.loss("sensors of what a link carries", name);
      continue;
    }
    const auto is_written = [&](dynSide side, Index x) { return side != DYN_SIDE_SHAPE || geom_names.count(x) > 0; };
    if (row.object == SensorObject::Sides &&
        (s.side == DYN_SIDE_ZONE || !is_written(s.side, s.object) || !is_written(s.other_side, s.reference))) {
      losses.loss("sensors of contacts in a zone, and of shapes that are not written", name);
      continue;
    }
    if (s.quantity == DYN_QUANTITY_MAGNETOMETER) put(section("option"), "magnetic", std::span(s.field));  // one of a file
    const auto place = [&](Index frame, const double (&X)[12], const char* ending) {
      return site(frame, X, name + ending);
    };
    XmlElement& e = *section("sensor").InsertNewChildElement(name_of(s.quantity));
    put(e, "name", name);
    switch (row.object) {
      case SensorObject::None:
        if (s.quantity == DYN_QUANTITY_USER) put(e, "dim", double(s.count));
        break;
      case SensorObject::Sides: put_sides(e, s); break;
      case SensorObject::Joint: put(e, "joint", piece(s.object, 0).simple.name); break;
      case SensorObject::Tendon: put(e, "tendon", std::string(m.string(m.tendons()[s.object].name))); break;
      case SensorObject::Actuator: put(e, "actuator", std::string(m.string(m.actuators()[s.object].name))); break;
      case SensorObject::Frame:
        if (s.quantity == DYN_QUANTITY_RANGEFINDER && s.values) put(e, "data", words_of(s, ray_words));
        if (s.quantity >= DYN_QUANTITY_ACCELEROMETER) {
          put(e, "site", place(s.object, s.placement, "_site"));
        } else {
          put(e, "objtype", std::string("site")), put(e, "objname", place(s.object, s.placement, "_site"));
          if (s.reference >= 0)
            put(e, "reftype", std::string("site")), put(e, "refname", place(s.reference, s.reference_placement, "_reference"));
        }
    }
    if (s.delay > 0) put(e, "delay", s.delay), put(e, "nsample", std::ceil(s.delay / m.simulation()->dt) + 1);
    if (s.cutoff > 0) put(e, "cutoff", s.cutoff);
    if (s.noise > 0) put(e, "noise", s.noise);
  }
}

}  // namespace dyn::load
