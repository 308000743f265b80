// Rows of a step on the lengths of paths. The lengths, rates and forces in d are those of the beginning of the step.
#pragma once

#include "simulation/path_forces.hpp"
#include "simulation/step.hpp"

namespace dyn::simulation {

// Whether tendons can make velocities jump.
bool paths_may_jump(const Model& m, const Data<double>& d);
// Whether no row would act in a step of h.
bool paths_inactive(const Model& m, const Data<double>& d, double h);
// Lists the rows that act; limits within `reached`, or where that is 0 within what the step moves. Returns their number.
Index list_path_rows(const Model& m, const Data<double>& d, double h, double reached, PathRow* rows);
// The row itself, but for its rate.
RowKind set_path_row(const Model& m, const Data<double>& d, Index row, Index path, double h, ConstraintInstance<double>& s);

}  // namespace dyn::simulation
