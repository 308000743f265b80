// Model to MJCF: sensors. Those of frames are on sites.
#include "save_mjcf.hpp"
#include "table/names.hpp"
#include "table/sensors.hpp"

namespace dyn::load {

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
    if (s.quantity == DYN_QUANTITY_MAGNETOMETER) put(section("option"), "magnetic", std::span(s.field));  // one of a file
    const auto place = [&](Index frame, const double (&X)[12], const char* ending) {
      return site(frame, X, name + ending);
    };
    XmlElement& e = *section("sensor").InsertNewChildElement(name_of(s.quantity));
    put(e, "name", name);
    switch (row.object) {
      case SensorObject::None: break;
      case SensorObject::Joint: put(e, "joint", piece(s.object, 0).simple.name); break;
      case SensorObject::Tendon: put(e, "tendon", std::string(m.string(m.tendons()[s.object].name))); break;
      case SensorObject::Actuator: put(e, "actuator", std::string(m.string(m.actuators()[s.object].name))); break;
      case SensorObject::Frame:
        if (s.quantity >= DYN_QUANTITY_ACCELEROMETER) {
          put(e, "site", place(s.object, s.placement, "_site"));
        } else {
          put(e, "objtype", std::string("site")), put(e, "objname", place(s.object, s.placement, "_site"));
          if (s.reference >= 0)
            put(e, "reftype", std::string("site")), put(e, "refname", place(s.reference, s.reference_placement, "_reference"));
        }
    }
    if (s.cutoff > 0) put(e, "cutoff", s.cutoff);
    if (s.noise > 0) put(e, "noise", s.noise);
  }
}

}  // namespace dyn::load
