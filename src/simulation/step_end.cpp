// The linearised step (step_linearisation.hpp): its end on the group, q' = q (+) displacement.
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

// All columns in the order q, v, tau, controls; or one.
void StepJacobian::write(double* by) const {
  const Index nu = m.n.nu;
  const auto to = [&](std::ptrdiff_t column) {
    const std::ptrdiff_t at = along || column < 2 * nv ? column : column < mixed ? column + nv : column - nu;
    return by + 2 * nv * at;
  };
  const auto own = [&](Index k, std::ptrdiff_t c) { return along ? y.direction[k] : k == c ? 1.0 : 0.0; };
  for (std::ptrdiff_t c = 0; c < columns; ++c) {
    double* const out = to(c);
    for (Index k = 0; k < nv; ++k) out[k] = displacement(k)[c] + own(k, c), out[nv + k] = state(k)[c];
  }
  for_each_factor(
      m, [](Index, Index, Index) {},
      [&]<class J>(const Body& b) {
        if constexpr (J::nv > 1)
          for (std::ptrdiff_t c = 0; c < columns; ++c) {
            double dq[J::nv], dv[J::nv], moved[J::nv];
            for (int k = 0; k < J::nv; ++k) {
              const Index at = b.user_v + k;
              dq[k] = own(at, c), dv[k] = state(at)[c], moved[k] = displacement(at)[c];
            }
            end_of_joint<J>(b, dq, dv, moved, to(c) + b.user_v, to(c) + nv + b.user_v);
          }
      });
  for (std::ptrdiff_t k = 0; along && k < 2 * nv; ++k) by[k] += y.given.end[k];
}

// The gradients by q, dv' and the displacement.
void StepJacobian::transpose_end(const double* gradient) const {
  std::copy_n(gradient, 2 * nv, y.gradient.end);
  for (Index k = 0; k < nv; ++k) y.adjoint[k] += gradient[k];
  std::copy_n(gradient, nv, y.displacement_adjoint), std::copy_n(gradient + nv, nv, y.state_adjoint);
  for_each_factor(
      m, [](Index, Index, Index) {},
      [&]<class J>(const Body& b) {
        if constexpr (J::nv > 1) {
          const Index at = b.user_v;
          double unit[3 * J::nv] = {}, by[3 * J::nv];
          for (int k = 0; k < 3 * J::nv; ++k) {
            double q[J::nv], v[J::nv];
            unit[k] = 1;
            std::copy_n(unit + J::nv, J::nv, v);  // of joints whose v' is dv'
            end_of_joint<J>(b, unit, unit + J::nv, unit + 2 * J::nv, q, v);
            unit[k] = 0;
            by[k] = inner(q, gradient + at, J::nv) + inner(v, gradient + nv + at, J::nv);
          }
          for (int k = 0; k < J::nv; ++k) {
            y.adjoint[at + k] += by[k] - gradient[at + k];
            y.state_adjoint[at + k] = by[J::nv + k], y.displacement_adjoint[at + k] = by[2 * J::nv + k];
          }
        }
      });
}

// own: of q. v holds dv' already.
template <class J>
void StepJacobian::end_of_joint(const Body& b, const double* own, const double* dv, const double* moved, double* q,
                                double* v) const {
  const Index at = b.user_v;
  if constexpr (J::nv == 3) {
    const Vec3<double> w =
        load3(static_cast<const double*>(x.v_end + at)) * h + load3(static_cast<const double*>(y.correction + at));
    store3(exp3(w * -1.0) * load3(own) + Jexp3(w) * load3(moved), q);
  } else {
    const Motion<double> before = load_motion(static_cast<const double*>(x.v_end + at)),
                         correction = load_motion(static_cast<const double*>(y.correction + at)), dv1 = load_motion(dv);
    const auto end = integrator::FlightEnd<double>::of(b.m > 0 ? b.h * (1 / b.m) : Vec3<double>::zero(), before, correction, h);
    const auto change = end.change(load_motion(own), dv1, load_motion(moved) - dv1 * h);
    store6(change.q, q), store6(change.v, v);
  }
}

}  // namespace dyn::simulation
