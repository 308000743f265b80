// Transposed matrices, column-major, in blocks of 4 x 4.
#pragma once

#include <algorithm>

#include "base/simd_shuffle.hpp"

namespace dyn {

// b = factor a^T, a rows x columns: b[k + ldb * c] = factor a[c + lda * k]
template <class T>
inline void transpose(const T* a, std::ptrdiff_t lda, std::ptrdiff_t rows, std::ptrdiff_t columns, T factor, T* b,
                      std::ptrdiff_t ldb) {
  using P = Simd<T, 4>;
  auto one_by_one = [&](std::ptrdiff_t c0, std::ptrdiff_t c1, std::ptrdiff_t k0, std::ptrdiff_t k1) {
    for (std::ptrdiff_t c = c0; c < c1; ++c)
      for (std::ptrdiff_t k = k0; k < k1; ++k) b[k + ldb * c] = factor * a[c + lda * k];
  };
  std::ptrdiff_t k = 0;
  for (; k + 4 <= columns; k += 4) {
    std::ptrdiff_t c = 0;
    for (; c + 4 <= rows; c += 4) {
      const T* from = a + c + lda * k;
      T* to = b + k + ldb * c;
      P x, y, z, w;
      transpose4(P::load(from) * factor, P::load(from + lda) * factor, P::load(from + 2 * lda) * factor,
                 P::load(from + 3 * lda) * factor, x, y, z, w);
      x.store(to), y.store(to + ldb), z.store(to + 2 * ldb), w.store(to + 3 * ldb);
    }
    one_by_one(c, rows, k, k + 4);
  }
  one_by_one(0, rows, k, columns);
}
// Copies the upper triangle of an n x n matrix to the lower one.
template <class T>
inline void mirror_upper(T* M, std::ptrdiff_t n) {
  for (std::ptrdiff_t j0 = 0; j0 < n; j0 += 16) {
    const std::ptrdiff_t width = std::min<std::ptrdiff_t>(16, n - j0);
    transpose(M + n * j0, n, j0, width, T(1), M + j0, n);
    for (std::ptrdiff_t j = j0; j < j0 + width; ++j)
      for (std::ptrdiff_t i = j0; i < j; ++i) M[j + n * i] = M[i + n * j];
  }
}

}  // namespace dyn
