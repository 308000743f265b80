// solref and solimp, for steps with DYN_CONTACT_MODEL_AS_FILE.
#include "mjcf_robot.hpp"

namespace dyn::load {

Compliance read_mjcf_compliance(const Reader& reader, const Element& e, const char* reference, const char* impedance) {
  Compliance out;
  if (e.Attribute(reference) || e.Attribute(impedance))
    reader.report.count("solref and solimp: not used in rigid steps, the default; steps with contact_model as_file use them",
                        line(e));
  if (const auto given = reader.numbers(e, reference)) {
    for (size_t k = 0; k < std::min<size_t>(given->size(), 2); ++k) out.reference[k] = (*given)[k];
    if ((out.reference[0] > 0) != (out.reference[1] > 0) && out.reference[0] * out.reference[1] != 0)
      reader.bad_numbers(e, reference, "both numbers are positive, or neither");
  }
  if (const auto given = reader.numbers(e, impedance)) {
    for (size_t k = 0; k < std::min<size_t>(given->size(), 5); ++k) out.impedance[k] = (*given)[k];
    for (const double x : out.impedance)
      if (!(x >= 0)) reader.bad_numbers(e, impedance, "the numbers are not negative");
  }
  return out;
}

}  // namespace dyn::load
