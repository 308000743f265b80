// Derivatives of a step by its state, its forces and its controls, on the tangent space.
// Two methods: implicit differentiation of the step in its modes (step_jacobian.cpp), and central differences (here), which cover
// every step. The state stays as it is.
#pragma once

#include "simulation/step_jacobian.hpp"

namespace dyn::simulation {

// Columns of the result: q, v, tau, controls. Rows: q', v'.
inline std::ptrdiff_t derivative_count(const Model& m) { return 3 * std::ptrdiff_t(m.n.nv) + m.n.nu; }

// Contacts of a step in their order, with their modes.
struct StepModes {
  dynContactForce* contacts;
  dynContactMode* modes;
  std::int32_t* degenerate;
  Index count;
};

struct StepDerivatives {
  // the state before: restored at the end
  double *q, *v, *act, *limit_forces, *actuator_force;
  dynContactForce* contacts;
  Index contact_count;
  double time, growth;
  dynStepOptions options;
  dynStepReport report;
  bool ledger;
  // the step: its result, its velocity before it is turned into the axes of its end, and its modes
  double *q_next, *v_next, *v_end;
  StepModes modes;
  Index degenerate;  // limits and actuators beside the contacts
  Index steps;
  // 2 nv x (3 nv + nu), by columns
  double* by;
  // of differences
  double *direction, *plus, *minus;
  JacobianArrays jacobian;
  const char* reason;  // why the analytic method does not cover the step, or nullptr
  bool refused;        // a parameter has no central differences
};

std::size_t derivative_bytes(const Model& m);
// In memory of that size, aligned to 64 bytes.
StepDerivatives* place_derivatives(const Model& m, void* memory);

// Options of a step to be differentiated: contacts solved to 1e-12, nothing that depends on a clock, no ledger.
void solve_exactly(Workspace& w);
// Saves the state and makes a step. Returns 0 or what integrator::step returns, or not_finite. The state is then that of the end
// of the step, and restore_state must be called in any case.
inline constexpr Index not_finite = -5;
Index begin_derivatives(const Model& m, Data<double>& d, StepDerivatives& x);
Index step_once(const Model& m, Data<double>& d);
void start_from(const Model& m, Data<double>& d, const StepDerivatives& x);  // sets q, v and activations alone
void restore_state(const Model& m, Data<double>& d, const StepDerivatives& x);
// Directly after begin_derivatives: finds the modes of the contacts. margin: see dynStepDerivativeOptions.
void find_modes(const Model& m, Data<double>& d, StepDerivatives& x, double margin);
// To the nearer limit of the record's joint.
inline double limit_gap(const Model& m, const double* q, Index limit) {
  const Index k = m.limits()[limit].q;
  return std::min(q[k] - m.lower_limit()[k], m.upper_limit()[k] - q[k]);
}
// Numbers of a parameter.
inline Index parameter_size(dynStepParameterType type) {
  return type == DYN_STEP_PARAMETER_TYPE_INERTIA ? 10 : type == DYN_STEP_PARAMETER_TYPE_GRAVITY ? 3 : 1;
}
struct StepParameter {
  dynStepParameterType type;
  Index index;
};
// The derivative by parameters, and products of that by all inputs, in the order q, v, tau, controls, parameters: see
// dynStepDerivatives.
struct StepProducts {
  const dynStepParameterType* parameters = nullptr;
  const std::int32_t* parameter_index = nullptr;
  Index parameter_count = 0, numbers = 0;
  double* P = nullptr;
  const double* tangents = nullptr;
  double* jvp = nullptr;
  Index tangent_count = 0;
  const double* cotangents = nullptr;
  double* vjp = nullptr;
  Index cotangent_count = 0;
  // Calls f(parameter, its first number) for each.
  template <class F>
  void for_each_parameter(F&& f) const {
    for (Index k = 0, first = 0; k < parameter_count; first += parameter_size(parameters[k++]))
      f(StepParameter{parameters[k], parameter_index ? Index(parameter_index[k]) : 0}, first);
  }
};
// What is wanted: matrices and products.
struct Wanted {
  bool state, tau, control;
  StepProducts products{};
  bool matrices() const { return state || tau || control; }
};
// Fills x.by by central differences. Marks contacts as degenerate whose mode changes. Returns as begin_derivatives.
Index step_differences(const Model& m, Data<double>& d, StepDerivatives& x, double epsilon, const Wanted& wanted);

// Fills x.by and the products by implicit differentiation, or sets x.reason (step_jacobian.cpp).
void step_jacobian(const Model& m, Data<double>& d, StepDerivatives& x, double margin, const Wanted& wanted);
// The products with x.by (step_products.cpp).
void multiply(const Model& m, const StepDerivatives& x, const StepProducts& p);
// Adds a column by a number of the parameters to all that is wanted (step_products.cpp).
void add_column(const Model& m, const StepProducts& p, Index number, const double* column);
// Adds the columns of parameters by central differences, or sets x.refused. Returns as begin_derivatives.
Index parameter_columns(const Model& m, Data<double>& d, StepDerivatives& x, double epsilon, const StepProducts& p,
                        bool time_step_alone);

struct DerivativeSettings {
  dynDerivativeMethod method;
  double epsilon, margin;
};
// All of this: a step from the state in d, and its derivatives in x by the method `used`. Returns as begin_derivatives, and
// restore_state must be called in any case. Method ANALYTIC does not cover the step if x.reason is set.
Index differentiate_step(const Model& m, Data<double>& d, StepDerivatives& x, const DerivativeSettings& settings,
                         const Wanted& wanted, dynDerivativeMethod& used);

}  // namespace dyn::simulation
