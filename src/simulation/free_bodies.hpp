// Free rigid bodies, SIMD-batched: free flyers without children on which only contacts, gravity and their own joint force act.
// An Euler step integrates four of them side by side, without a recursion, by the equations of integrator/free_flight.hpp.
// With the centre of mass c, the applied force f and its moment t about c:
//   v_c' = v_c + h (g + f / m)     I w' = exp(-h w') (I w + h t)     c' = c + h v_c'     R' = R exp(h w')
#pragma once

#include "base/simd_memory.hpp"
#include "model/data.hpp"
#include "algorithm/tree_groups.hpp"

namespace dyn::simulation {

struct FreeBodySet {
  Index body[Double4::lanes], q[Double4::lanes], v[Double4::lanes];  // the last body fills unused lanes
  unsigned active_lanes;                                          // bit mask of lanes that steps visit
  Double4 inverse_mass;
  Vec3<Double4> c;
  Mat3<Double4> I, inverse;  // about the centre of mass
};

// Articulated inertia columns of one body (aba.hpp), in its axes.
struct FreeBodyColumns {
  Force<double> U[6];
  double Dinv[6];
};

struct FreeBodies {
  Index count;
  bool batched;          // bodies are integrated in batches in this step
  std::uint64_t step;
  FreeBodySet* sets;
  Index* active_sets;        // indices of sets with at least one active lane
  Index active_set_count;
  Index* number;        // of a body among the free bodies, -1 if it is none
  FreeBodyColumns* columns;
  std::uint64_t* has_columns;  // number of the step in which d.S, d.U_root, d.Dinv were set
  Index* touched;        // bodies whose columns were set in this step
  Index touched_count;
  Trees* trees;         // of the model
  Index tree_count;
  ChosenTrees others;   // trees that steps visit beside the batches
  TreeBuffers buffers;        // of `others`
};

struct Workspace;

void set_up_free_bodies(const Model& m, FreeBodies& l);
// Updates the lanes and trees after bodies fell asleep or woke.
void list_free_bodies(const Model& m, Workspace& w);

// Decides whether bodies are integrated in batches in the step that begins.
void begin_free_body_step(Data<double>& d);
// Sets d.v to the free velocities after h, in the axes at the beginning of the step, and the poses and twists that contacts need.
void integrate_velocity(const Model& m, Data<double>& d, double h);
// Sets d.S, d.U_root and d.Dinv of a body if it is batched.
void ensure_columns(const Model& m, Data<double>& d, Index body);
void ensure_all_columns(const Model& m, Data<double>& d);
// Integrates q over h and refers v to the axes at the end of the step. correction: displacement beside h v, or nullptr.
void integrate_position(Data<double>& d, double h, const double* correction);

}  // namespace dyn::simulation
