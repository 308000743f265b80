// Compliance of contacts, limits and equalities as an MJCF file states it: solref, solimp, solmix.
#pragma once

#include <cmath>

#include "base/types.hpp"

namespace dyn {

// Defaults are MuJoCo's.
struct Compliance {
  // time constant (s) and damping ratio; or, both negative, stiffness and damping of a unit mass
  double reference[2] = {0.02, 1};
  double impedance[5] = {0.9, 0.95, 0.001, 0.5, 2};  // dmin, dmax, width (m or rad), midpoint, power
  double mix = 1;                                    // weight of a shape's numbers in a contact
  double across[2] = {0, 0};                         // reference of the friction rows of a pair; zeros: that of its normal row
  double scale = 1;                                  // torquescale of a weld
  double margin = 0;                                 // of a shape, by which its surface is raised, or of a pair
};

// weight: inverse inertia (1/kg, 1/(kg m^2)) at the initial configuration along the row, or of the shape's link for forces and
// moments; of a constraint between frames that of both links.
struct ComplianceRecord {
  Compliance law;
  double weight[2];
  double ratio;      // impratio of the file
  double pyramidal;  // 1: the file's friction cones are pyramids
};

// Whether the numbers are ones that the file may have.
inline bool is_valid(const Compliance& x) {
  for (const double v : {x.reference[0], x.reference[1], x.across[0], x.across[1]})
    if (!std::isfinite(v)) return false;
  const auto positive = [](double v) { return v >= 0 && v <= 1e15; };
  for (const double v : x.impedance)
    if (!positive(v)) return false;
  if (!positive(x.mix) || !positive(x.scale) || !positive(x.margin)) return false;
  return (x.reference[0] > 0) == (x.reference[1] > 0) || x.reference[0] * x.reference[1] == 0;
}

}  // namespace dyn
