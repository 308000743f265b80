// What rests, and what of it steps leave out. A tree that has been slower than sleep_speed for sleep_time, with all that rows join it to, is at
// rest: where a step would change its velocity by no more than at sleep_speed in sleep_time, v' = 0 and q' = q, and what its contacts exert stays if it
// is solved for again to the same.
// That is part of the step. Of what was at rest before, such a step leaves everything as it was, bit for bit, and so does the next one while
// nothing that it begins from has changed: the island sleeps, and steps do without it until something that is awake meets it.
#pragma once

#include "simulation/trees.hpp"

namespace dyn::simulation {

enum class Sleeper : std::uint8_t { Awake, Asleep, Touched };

// The state is `still` alone: the rest is found again in two steps.
struct Sleep {
  Index count;         // of trees; 0: nothing can rest
  Index* number;       // of a body's tree; -1: the world
  // by trees
  Trees* trees;
  double* slow_time;       // s, that it has been slow
  double* max_force;     // of the forces on an island, of this step
  std::uint8_t* rest_steps;  // at rest, that left everything as it was: up to two
  Sleeper* state;
  Index *next, *island, *awake_trees;  // of those that sleep together, a ring; of this step; those that are awake
  std::uint8_t* flags;          // of islands of this step
  Index awake_count, islands;   // islands that sleep
  bool enabled;           // in this step
  bool unconstrained;          // no constraint is enabled: some trees may be left out
  bool any_asleep;           // are
  bool inputs_known;          // since the last step nothing was called that may change what steps begin from, but for q, v and tau, which have versions
  bool touched, contacts_full;       // in this step something that sleeps is met; there is no room for contacts
  std::uint64_t version[input_count];
  double h;
  double *tau, *ctrl;  // of those that sleep
  ChosenTrees awake;
  TreeBuffers buffers;       // of these
  dynContactForce* sleeping_contacts;  // contacts of those that sleep, in order
  Index sleeping_contact_count;

  bool sleeps(Index body) const { return any_asleep && body != 0 && state[number[body]] != Sleeper::Awake; }
};

// Before a step of h: which trees it goes through. Afterwards, if it was made; if it was not, nothing is known.
void begin_sleep(const Model& m, Data<double>& d, double h);
void end_sleep(const Model& m, Data<double>& d, double h);
// All trees are awake, and steps go through them all.
void wake_all(const Model& m, Data<double>& d);
// Those that were met, with the state they begin the step from.
void wake_touched(const Model& m, Data<double>& d);
// After impulses and corrections (dq, or nullptr): which islands are at rest at the end of the step. v0: before it.
void detect_rest(const Model& m, Data<double>& d, const double* v0, const double* dq, double h);
// These keep q0, and have no velocity.
void hold_at_rest(const Model& m, Data<double>& d, const double* q0);

}  // namespace dyn::simulation
