// Implicit differentiation of a step of SEMI_IMPLICIT_EULER or IMPLICIT_FAST. With v' its velocity in the axes of its beginning,
// N = M + h D + .. its inertia, delta the correction of free flyers (free_flight.hpp) and a = (v' - v - delta) / h:
//   N a + nle(q, v) = tau + J^T lambda / h
// So with H the derivatives of inverse dynamics at a, contact forces included (Carpentier and Mansard 2018):
//   N dv' = N (dv + ddelta) - h (H_q dq + H_v dv - dtau) + J^T dlambda
// Each row in its mode gives one equation. With c its velocity and G = J N^-1 J^T:
//   pressed       dc + dbias + compliance dlambda = 0
//   sticks        dc = 0
//   slides        lambda_t = -mu lambda_n u / |u|, differentiated
// Redundant rows make G singular. Their equations are consistent: independent ones determine the motion.
#pragma once

#include "simulation/contact_geometry.hpp"

namespace dyn::simulation {

enum class JacobianRowKind : Index { Normal, Stick, Slide, Limit, Equality };

struct JacobianRow {
  JacobianRowKind kind;
  Index of;    // contact or limit
  Index axis;  // of the contact: 0, 1 tangents, 2 normal
  double lambda;
};

// A pressed contact.
struct JacobianContact {
  Index contact, body_a, body_b, first;  // first: its normal row, then the two tangents if it has friction
  double sliding;                        // m/s
  double direction[2];                   // of sliding, along the tangents
  Vec3<double> force;                    // impulse on B, N s
  Vec3<double> position, slip_a, slip_b;
  Motion<double> relative;  // of B against A at the point, at the end of the step
  ContactGeometry geometry;
};

// A row of the correction of positions, in the order of its sweeps.
struct CorrectionRow {
  Index row;            // of J
  Index contact;        // of JacobianContact; -1: a limit
  Index exact;          // its number among those that were pushed, or -1
  double wrong, slope;  // what is to be removed, and its derivative by the gap at the end of the step
  double mu, compliance;
  Index end = 0;  // of the first row of an island: one past its last
  int sweeps = 0;
};

struct JacobianArrays {
  double *a, *diagonal, *diagonal_by_v, *correction;
  Motion<double>*twists, *twists_before;  // of bodies, at their trees' roots
  double *state, *J, *Z, *K, *factor, *scale, *E, *rate, *wanted, *lambda, *rest, *displacement;
  JacobianRow* rows;
  JacobianContact* contacts;
  CorrectionRow* corrections;
  double *G, *dG, *turned, *W;
  Index *pivots, *unknowns;
};

// More rows than four a degree of freedom press in heaps alone, and then in ways that forces do not determine.
inline Index jacobian_rows(const Model& m) {
  return std::min(3 * m.n.contacts + m.n.limits + m.n.constraint_rows, std::clamp(4 * m.n.nv, tuning::default_solve::small_rows, tuning::island::dense_rows));
}

// Calls f(array, numbers) for each. Matrices lie row by row: state nv x columns, J and Z rows x nv, K rows x rows, E rows x 2 nv
// (by q and v), wanted, lambda and rest rows x columns, displacement nv x columns.
template <class F>
void jacobian_arrays(const Model& m, std::ptrdiff_t columns, JacobianArrays& x, F&& f) {
  const std::ptrdiff_t nv = m.n.nv, rows = jacobian_rows(m);
  f(x.a, nv), f(x.diagonal, nv), f(x.diagonal_by_v, nv), f(x.correction, nv), f(x.twists, m.n.bodies),
      f(x.twists_before, m.n.bodies);
  f(x.state, nv * columns), f(x.J, rows * nv), f(x.Z, rows * nv), f(x.K, rows * rows), f(x.factor, rows * rows), f(x.scale, rows);
  f(x.E, rows * 2 * nv), f(x.rate, rows * nv), f(x.wanted, rows * columns), f(x.lambda, rows * columns),
      f(x.rest, rows * columns), f(x.displacement, nv * columns);
  f(x.rows, rows), f(x.contacts, rows), f(x.pivots, rows), f(x.unknowns, rows);
  const std::ptrdiff_t exact = std::min<std::ptrdiff_t>(rows, tuning::island::exact_rows);
  f(x.corrections, rows), f(x.G, rows * rows), f(x.dG, exact * exact * nv), f(x.turned, nv * nv), f(x.W, nv * nv);
}

}  // namespace dyn::simulation
