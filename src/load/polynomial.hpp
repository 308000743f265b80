// Polynomials of joint equalities.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace dyn::load {

// From the coefficients of powers of (x - at) to those of powers of x. c has five numbers at most.
inline void shift_polynomial(std::span<const double> c, double at, double* out) {
  std::fill_n(out, 5, 0.0);
  for (std::size_t k = c.size(); k-- > 0;) {  // Horner: out = out (x - at) + c_k
    for (std::size_t j = 4; j > 0; --j) out[j] = out[j - 1] - at * out[j];
    out[0] = c[k] - at * out[0];
  }
}

}  // namespace dyn::load
