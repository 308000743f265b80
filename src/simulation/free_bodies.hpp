// Bodies that fly by themselves: free flyers that carry nothing, on which contacts, gravity and the force at their own joint alone act. An Euler
// step moves four of them side by side, without a recursion, by the equations of integrator/free_flight.hpp: with c the centre of mass, f and t the
// applied force and its moment there,
//   v_c' = v_c + h (g + f / m)     I w' = exp(-h w') (I w + h t)     c' = c + h v_c'     R' = R exp(h w')
#pragma once

#include "base/wide.hpp"
#include "model/data.hpp"
#include "simulation/trees.hpp"

namespace dyn::simulation {

struct FreeBodySet {
  Index body[Wide::lanes], q[Wide::lanes], v[Wide::lanes];  // beyond the last body it again
  unsigned active_lanes;                                          // a bit for each lane that steps go through
  Wide inverse_mass;
  Vec3<Wide> c;
  Mat3<Wide> I, inverse;  // about the centre of mass
};

// What articulated inertias leave of one (aba.hpp), in its axes.
struct FreeBodyColumns {
  Force<double> U[6];
  double Dinv[6];
};

struct FreeBodies {
  Index count;
  bool batched;          // in this step
  std::uint64_t step;
  FreeBodySet* sets;
  Index* active_sets;        // those of which something acts
  Index active_set_count;
  Index* number;        // of bodies, among these; -1
  FreeBodyColumns* columns;
  std::uint64_t* has_columns;  // the step for which it has
  Index* touched;        // bodies that have, in this step
  Index touched_count;
  Trees* trees;         // of the model
  Index tree_count;
  ChosenTrees others;   // that steps go through
  TreeBuffers buffers;        // of these
};

struct Workspace;

void set_up_free_bodies(const Model& m, FreeBodies& l);
// After trees fell asleep or woke.
void list_free_bodies(const Model& m, Workspace& w);

// Whether they fly in the step that begins.
void begin_free_body_step(Data<double>& d);
// To the free velocities of a step of h, in the axes that it begins in: d.v; of placements and velocities what contacts ask for.
void integrate_velocity(const Model& m, Data<double>& d, double h);
// d.S, d.U_root and d.Dinv of a body that may be one of them.
void ensure_columns(const Model& m, Data<double>& d, Index body);
void ensure_all_columns(const Model& m, Data<double>& d);
// To the configuration, and to velocities in the axes of where the step ends. correction: nullptr, none.
void integrate_position(Data<double>& d, double h, const double* correction);

}  // namespace dyn::simulation
