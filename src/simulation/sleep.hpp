// Sleep. A tree is slow when its velocity stays below sleep_speed; it is at rest when it and all that rows join it to
// were slow for sleep_time and a step would change its velocity by no more than sleep_speed / sleep_time * h.
// The step of an island at rest sets v' = 0 and q' = q; contact forces stay if solving again gives the same ones.
// Two such steps leave the state bit for bit as it was, and so does every later step with the same inputs.
// The island then sleeps: steps leave it out until an awake body touches it or an input changes.
#pragma once

#include "algorithm/tree_groups.hpp"

namespace dyn::simulation {

enum class Sleeper : std::uint8_t { Awake, Asleep, Touched };

// Only `slow_time` is state: two steps find the rest again from it.
struct Sleep {
  Index count;         // of trees; 0: nothing can rest
  Index* number;       // tree of a body; -1: the world
  // by trees
  Trees* trees;
  double* slow_time;       // s, how long it has been slow
  double* max_force;     // largest contact force on its island in this step (N, N m)
  std::uint8_t* rest_steps;  // consecutive steps at rest that changed nothing, up to two
  Sleeper* state;
  // next: ring of trees that sleep together. island: of this step. awake_trees: list
  Index *next, *island, *awake_trees;
  std::uint8_t* flags;          // of islands of this step
  Index awake_count, islands;   // islands: sleeping islands
  bool enabled;           // in this step
  bool unconstrained;          // no constraint is enabled: trees may be left out
  bool any_asleep;           // some trees sleep and are left out
  // nothing that a step starts from was changed since the last step, except q, v and tau, which have versions
  bool inputs_known;
  // touched: an awake body touches a sleeping one in this step. contacts_full: no room for its contacts
  bool touched, contacts_full;
  std::uint64_t version[input_count];
  double h;
  double *tau, *ctrl;  // of the last step
  ChosenTrees awake;
  TreeBuffers buffers;       // of `awake`
  dynContactForce* sleeping_contacts;  // contacts of sleeping trees, in order
  Index sleeping_contact_count;

  bool sleeps(Index body) const { return any_asleep && body != 0 && state[number[body]] != Sleeper::Awake; }
};

// Before a step of h: decides which trees it visits. end_sleep: after a step that succeeded; otherwise call invalidate_sleep.
void begin_sleep(const Model& m, Data<double>& d, double h);
void end_sleep(const Model& m, Data<double>& d, double h);
// Wakes all trees; steps visit all of them.
void wake_all(const Model& m, Data<double>& d);
// Wakes the touched trees and restores the state from which the step begins.
void wake_touched(const Model& m, Data<double>& d);
// After impulses and corrections (dq, or nullptr): finds the islands that are at rest at the end of the step. v0: velocity before
// it.
void detect_rest(const Model& m, Data<double>& d, const double* v0, const double* dq, double h);
// Sets q = q0 and v = 0 for the trees at rest.
void hold_at_rest(const Model& m, Data<double>& d, const double* q0);

}  // namespace dyn::simulation
