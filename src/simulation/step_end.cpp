// The linearised step (step_linearisation.hpp): its end on the group.
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

// The end of the step, q' = q (+) displacement, into x.by.
void StepJacobian::write() const {
  const Index nu = m.n.nu;
  const auto to = [&](std::ptrdiff_t column) {  // of the result: q, v, tau, controls
    const std::ptrdiff_t at = column < 2 * nv ? column : column < mixed ? column + nv : column - nu;
    return x.by + 2 * nv * at;
  };
  const auto own = [&](Index at, Index k, std::ptrdiff_t column) { return column == at + k ? 1.0 : 0.0; };
  for (std::ptrdiff_t c = 0; c < columns; ++c) {
    double* const out = to(c);
    for (Index k = 0; k < nv; ++k) out[k] = displacement(k)[c] + own(0, k, c), out[nv + k] = state(k)[c];
  }
  for_each_factor(
      m, [](Index, Index, Index) {},
      [&]<class J>(const Body& b) {
        if constexpr (J::nv > 1)
          for (std::ptrdiff_t c = 0; c < columns; ++c) end_of_joint<J>(b, c, to(c));
      });
}

template <class J>
void StepJacobian::end_of_joint(const Body& b, std::ptrdiff_t c, double* out) const {
  const Index at = b.user_v;
  double own[J::nv] = {};
  if (c >= at && c < at + J::nv) own[c - at] = 1;
  const Vec3<double> turn = column_of(y.displacement, at + J::nv - 3, c);
  if constexpr (J::nv == 3) {
    const Vec3<double> w =
        load3(static_cast<const double*>(x.v_end + at)) * h + load3(static_cast<const double*>(y.correction + at));
    store3(exp3(w * -1.0) * load3(static_cast<const double*>(own)) + Jexp3(w) * turn, out + at);
  } else {
    const Motion<double> v = load_motion(static_cast<const double*>(x.v_end + at)),
                         correction = load_motion(static_cast<const double*>(y.correction + at));
    const auto end = integrator::FlightEnd<double>::of(b.m > 0 ? b.h * (1 / b.m) : Vec3<double>::zero(), v, correction, h);
    const Motion<double> dv{column_of(y.state, at, c), column_of(y.state, at + 3, c)},
        by = Motion<double>{column_of(y.displacement, at, c), turn} - dv * h;
    const auto change = end.change(load_motion(static_cast<const double*>(own)), dv, by);
    store6(change.q, out + at), store6(change.v, out + nv + at);
  }
}

}  // namespace dyn::simulation
