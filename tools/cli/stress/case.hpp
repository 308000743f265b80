// A hard case: what is computed, what it is compared with, and how far the two may be apart.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "dyn.hpp"

namespace cli::stress {

using dyn::Vector;
using dyn::Vector3;

struct Curve {
  std::string name;
  std::vector<double> x, y;
  void add(double at, double value) { x.push_back(at), y.push_back(value); }
};
struct Picture {
  std::string x, y;  // what the axes are
  bool logarithmic = false;
  std::vector<Curve> curves;
};

// What a case gives: numbers, those they should be, and the error in the case's metric.
struct Outcome {
  Vector reference, result;
  double error = 0;
  Picture picture;

  // The error is the largest difference of all numbers compared, each divided by scale.
  Outcome& compare(double expected, double found, double scale = 1) {
    reference.push_back(expected), result.push_back(found);
    return off_by(std::abs(found - expected) / scale);
  }
  Outcome& off_by(double e) {
    if (!(e <= error)) error = e;  // also NaN
    return *this;
  }
  Curve& curve(const std::string& name) { return picture.curves.emplace_back(Curve{name, {}, {}}); }
};

struct Case {
  const char *name, *theme;
  const char* metric;     // what the error is, with its unit
  const char* source;     // of the reference
  double tolerance;
  const char* sentence;   // what is hard about it
  bool slow;              // runs with --long, or by its name
  Outcome (*run)();
};
const std::vector<Case>& cases();  // table.cpp

}  // namespace cli::stress
