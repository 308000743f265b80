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
//
// So the derivative is a product of matrices: forces F, N^-1, equations of rows, corrections, the end on the group. linearise()
// makes them. They are applied to all columns of the identity (A, B), to one direction (forward), or transposed (reverse).
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
  double approach;                       // m/s: normal velocity before the step, of those that rebound
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
  double wrong_adjoint;
  double mu, compliance;
  Index end = 0;  // of the first row of an island: one past its last
  int sweeps = 0;
};

// What a direction changes beside q, v, tau and controls; or the gradient by it.
struct StepChange {
  double *force, *velocity;  // nv: h times a force at fixed impulses; the velocity before the impulses
  double *row, *slide;       // of a row: its velocity; along the sliding direction, lambda_t + mu lambda_n
  double* displacement;      // nv
  double* end;               // 2 nv: of q' and v'
  double* wrong;             // of corrections: what is to be removed
  double* G;                 // of those whose matrix is differentiated
};

struct JacobianArrays {
  double *a, *impulse, *diagonal, *diagonal_by_v, *correction;
  Motion<double>*twists, *twists_before;  // of bodies, at their trees' roots
  double *force, *flight;  // derivatives of forces at fixed impulses, times h; of delta of free flyers
  double *direction, *adjoint;  // of q, v, controls and tau
  StepChange given, gradient;
  double *moved, *state_adjoint, *displacement_adjoint, *row_adjoint;
  double *state, *J, *Z, *K, *factor, *scale, *row_scale, *E, *rate, *wanted, *lambda, *rest, *displacement, *drift_factor;
  JacobianRow* rows;
  JacobianContact* contacts;
  CorrectionRow* corrections;
  double *G, *dG, *mu, *turned, *W;
  Index *pivots, *unknowns, *drift_pivots, *drift_unknowns;
};

inline constexpr Index flight_columns = 18;     // q, v and forces of a free flyer
// More rows than four a degree of freedom press in heaps alone, and then in ways that forces do not determine.
inline Index jacobian_rows(const Model& m) {
  const Index usual = std::clamp(4 * m.n.nv, tuning::default_solve::small_rows, tuning::island::dense_rows);
  return std::min(3 * m.n.contacts + m.n.limits + m.n.constraint_rows, usual);
}

// Rows of corrections whose matrix is differentiated, too.
inline Index exact_corrections(const Model& m) {
  return std::min(jacobian_rows(m), tuning::island::exact_rows);
}

// Calls f(array, numbers) for each.
template <class F>
void change_arrays(const Model& m, StepChange& x, F&& f) {
  const std::ptrdiff_t nv = m.n.nv, rows = jacobian_rows(m), exact = exact_corrections(m);
  f(x.force, nv), f(x.velocity, nv), f(x.row, rows), f(x.slide, rows), f(x.displacement, nv), f(x.end, 2 * nv);
  f(x.wrong, rows), f(x.G, exact * exact);
}

// Calls f(array, numbers) for each. Matrices lie row by row: force nv x (q, v, controls), flight nv x 18, state nv x (q, v, tau),
// J and Z rows x nv, K rows x rows, E rows x 2 nv (by q and v), wanted, lambda and rest rows x (q, v, tau), displacement nv x
// (q, v, tau), or forces of a row, G rows x rows, or vectors that the rows do not determine.
template <class F>
void jacobian_arrays(const Model& m, std::ptrdiff_t columns, JacobianArrays& x, F&& f) {
  const std::ptrdiff_t nv = m.n.nv, rows = jacobian_rows(m), exact = exact_corrections(m);
  const std::ptrdiff_t drifting = std::min<std::ptrdiff_t>(rows, m.n.constraint_rows);
  f(x.a, nv), f(x.impulse, nv), f(x.diagonal, nv), f(x.diagonal_by_v, nv), f(x.correction, nv), f(x.twists, m.n.bodies),
      f(x.twists_before, m.n.bodies);
  f(x.force, nv * (columns - nv)), f(x.flight, nv * flight_columns);
  f(x.state, nv * 3 * nv), f(x.J, rows * nv), f(x.Z, rows * nv), f(x.K, rows * rows), f(x.factor, rows * rows);
  f(x.scale, rows), f(x.row_scale, rows), f(x.drift_factor, drifting * drifting);
  f(x.direction, columns), f(x.adjoint, columns), f(x.moved, nv), f(x.state_adjoint, nv), f(x.displacement_adjoint, nv);
  f(x.row_adjoint, rows);
  change_arrays(m, x.given, f), change_arrays(m, x.gradient, f);
  f(x.E, rows * 2 * nv), f(x.rate, rows * nv), f(x.wanted, rows * 3 * nv), f(x.lambda, rows * 3 * nv), f(x.rest, rows * 3 * nv),
      f(x.displacement, nv * columns);
  f(x.rows, rows), f(x.contacts, rows), f(x.pivots, rows), f(x.unknowns, rows);
  f(x.drift_pivots, drifting), f(x.drift_unknowns, drifting);
  f(x.corrections, rows), f(x.G, rows * rows), f(x.dG, exact * exact * nv);
  f(x.mu, rows * tuning::sweeps::correction_sweeps), f(x.turned, nv * nv), f(x.W, nv * nv);
}

}  // namespace dyn::simulation
