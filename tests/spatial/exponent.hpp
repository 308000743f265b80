// References of the smallest and largest vectors where Quad has no more exponents than double has (common/twice.hpp).
#pragma once

#include "common/eigen.hpp"

namespace dyn_test {

// x = x 2^e with components up to 1: exact, and their squares have all their digits. Returns e.
template <class V>
int take_exponent(V& x) {
  int e;
  std::frexp(x.cwiseAbs().maxCoeff(), &e);
  for (double& c : x) c = std::ldexp(c, -e);
  return e;
}

}  // namespace dyn_test
