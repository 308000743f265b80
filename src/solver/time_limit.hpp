// A deadline that is kept: work stops when its next unit, and what is done after the last one, would end behind it.
// Both are known from earlier units and steps.
#pragma once

#include <algorithm>

#include "solver/tuning.hpp"

namespace dyn::solver {

struct TimeLimit {
  enum class Unit { Sweep, Segments, Matrix };  // a sweep; a factorization by segments; an iteration with the dense matrix
  double (*seconds)() = nullptr;  // a monotonic clock; null: no limit, and nothing reads a clock
  double began, end, last;        // s; last: the last reading
  double stopped;                 // s, when a sweep or a matrix no longer fitted; 0 before
  double rest;                    // s, after the last unit
  double price[3];                // s, of a unit over its size
  Unit unit;                      // what is_up asks for
  double size;
  bool runs;                      // a unit, since the last reading

  void start(double (*clock)(), double budget) {
    seconds = clock, stopped = 0, began = last = clock(), end = began + budget;
    expect(Unit::Sweep, 0);
  }
  void expect(Unit next, double next_size) { unit = next, size = next_size, runs = false; }
  // Returns whether the next unit would end too late. Call it before each unit.
  bool is_up() {
    if (!seconds) return false;
    if (stopped > 0) return true;
    const double now = seconds();
    double& cost = price[int(unit)];
    if (runs && size > 0) cost = std::max(tuning::time_fading * cost, (now - last) / size);
    last = now, runs = now + cost * size + rest < end;
    if (!runs && unit != Unit::Segments) stopped = now;  // where a factorization is too long a sweep may fit
    return !runs;
  }
  // After the last unit of an island.
  void leave() {
    if (seconds && stopped == 0) last = seconds(), runs = false;
  }
  double elapsed() const { return seconds ? seconds() - began : 0; }
  // Whether as much again as `duration` fits. Then work may begin anew.
  bool restarts(double duration) {
    if (seconds && !(seconds() + duration < end)) return false;
    return stopped = 0, runs = false, true;
  }
  void finish() {
    if (seconds) rest = std::max(tuning::time_fading * rest, seconds() - (stopped > 0 ? stopped : last));
    seconds = nullptr;
  }
};

}  // namespace dyn::solver
