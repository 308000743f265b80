// What need not be looked for again. After contacts were looked for and nothing was near, no two shapes meet before the joints have moved by
// what was between the nearest two: a joint moves what it carries by at most its lever times its change. A step within that is left out, and
// with it placements, pairs and rows; its result is the same to the last bit. Of trees of joints with one coordinate.
#pragma once

#include "dyn/model/data.hpp"

namespace dyn::simulation {

struct LimitRun {
  Index q, dof, count;
};

struct Clearance {
  double between;        // what is left, m; not above 0: unknown
  double *q, *lever;     // where that was; of degrees of freedom
  LimitRun* limit_runs;  // coordinates one after another
  Index runs;
  bool possible;
};

// Neither limits nor contacts act in a step of h with the free velocity v (one for each degree of freedom).
bool all_clear(const Model& m, const Data<double>& d, const double* v, double h);

// After contacts were looked for in vain, with nothing nearer than that.
void note_clearance(const Model& m, Data<double>& d, const double* v, double h, double between);

// Of a new data.
void place_clearance(const Model& m, Clearance& c);

}  // namespace dyn::simulation
