// Which differences explain how far two motions are apart.
#pragma once

#include "log.hpp"
#include "side.hpp"

namespace cli::compare {

struct Difference {
  std::string what;       // "joint 'elbow': damping"
  json a, b;              // of both sides; null: there is none
  double explained = -1;  // share; below zero: not measured
};

// A kind of difference: a group of quantities, or step, integrator, start, controls, effects, structure.
struct Cause {
  std::string name;
  double explained = 0;  // share of the divergence that goes with it
  double alone = 0;      // change of the first side by it alone, at the end, m or rad
  bool measured = true;  // false: it cannot be given to the other side
  Vector remaining;      // divergence at the moments when the first side has it, too
  std::vector<Difference> differences;
};

struct Comparison {
  double every = 0;                 // s between moments
  Vector divergence;                // at moments, from the start on
  Vector error_a, error_b;          // each side's own, of integration; empty: not known
  std::string where;                // frame or column that is farthest apart at the end
  double begins = -1, beyond = -1;  // s: first moment at which there is a divergence, and one beyond both errors; -1: none
  std::vector<Cause> causes;        // the first explains most
  double unexplained = 0;           // share that is left when all of them are given
  std::vector<std::string> notes;
};

// Mean over moments of what is left: 1 - left / all, each moment counts alike.
double share(const Vector& all, const Vector& left);
void find_begin(Comparison& c);
// Twice the distance from a run at half the step.
Vector own_error(const Robot& robot, const Stepping& stepping, const State& start, double every, int moments, const Path& path);

Comparison explain_models(const Side& a, const Side& b, double duration);
// Side a is a log of states; b a model, from the log's first state or, with own_start, from its own.
Comparison explain_log(const Log& log, const Side& b, bool own_start);
Comparison explain_tables(const Table& a, const Table& b);

}  // namespace cli::compare
