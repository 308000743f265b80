// The linearised step (step_linearisation.hpp): its end on the group, q' = q (+) displacement.
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

namespace {

// How a joint of several degrees of freedom ends the step.
template <class J>
struct JointEnd;

template <class J>
  requires(J::nv == 3)
struct JointEnd<J> {
  Mat3<double> back, by;
  JointEnd(const StepJacobian& s, const Body& b) {
    const Vec3<double> w = load3(static_cast<const double*>(s.x.v_end + b.user_v)) * s.h +
                           load3(static_cast<const double*>(s.y.correction + b.user_v));
    back = exp3(w * -1.0), by = Jexp3(w);
  }
  // own: of q. v holds dv' already.
  void operator()(const double* own, const double*, const double* moved, double* q, double*) const {
    store3(back * load3(own) + by * load3(moved), q);
  }
};

template <class J>
  requires(J::nv == 6)
struct JointEnd<J> {
  integrator::FlightEnd<double> end;
  JointEnd(const StepJacobian& s, const Body& b)
      : end(integrator::FlightEnd<double>::of(b.m > 0 ? b.h * (1 / b.m) : Vec3<double>::zero(),
                                              load_motion(static_cast<const double*>(s.x.v_end + b.user_v)),
                                              load_motion(static_cast<const double*>(s.y.correction + b.user_v)), s.h)) {}
  void operator()(const double* own, const double* dv, const double* moved, double* q, double* v) const {
    const Motion<double> dv1 = load_motion(dv);
    const auto change = end.change(load_motion(own), dv1, load_motion(moved) - dv1 * end.h);
    store6(change.q, q), store6(change.v, v);
  }
};

}  // namespace

// All columns in the order q, v, tau, controls; or one.
void StepJacobian::write(double* by) const {
  const auto to = [&](std::ptrdiff_t column) { return by + 2 * nv * column; };
  const auto own = [&](Index k, std::ptrdiff_t c) { return along ? y.direction[k] : k == c ? 1.0 : 0.0; };
  for (std::ptrdiff_t c = 0; c < columns; ++c) {
    double* const out = to(c);
    for (Index k = 0; k < nv; ++k) out[k] = displacement(k)[c] + own(k, c), out[nv + k] = state(k)[c];
  }
  for_each_factor(
      m, [](Index, Index, Index) {},
      [&]<class J>(const Body& b) {
        if constexpr (J::nv > 1) {
          const JointEnd<J> end{*this, b};
          for (std::ptrdiff_t c = 0; c < columns; ++c) {
            double dq[J::nv], dv[J::nv], moved[J::nv];
            for (int k = 0; k < J::nv; ++k) {
              const Index at = b.user_v + k;
              dq[k] = own(at, c), dv[k] = state(at)[c], moved[k] = displacement(at)[c];
            }
            end(dq, dv, moved, to(c) + b.user_v, to(c) + nv + b.user_v);
          }
        }
      });
  if (along) return add_row(by, y.given.end, 1, 2 * nv);
  // controls act by what they add to tau
  std::fill_n(to(columns), 2 * nv * m.n.nu, 0.0);
  for (Index k = 0; k < nv; ++k)
    for (Index u = 0; u < m.n.nu; ++u)
      if (const double f = force(k)[2 * nv + u]; f != 0) add_row(to(columns + u), to(2 * nv + k), f / h, 2 * nv);
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
          const JointEnd<J> end{*this, b};
          const Index at = b.user_v;
          double unit[3 * J::nv] = {}, by[3 * J::nv];
          for (int k = 0; k < 3 * J::nv; ++k) {
            double q[J::nv], v[J::nv];
            unit[k] = 1;
            std::copy_n(unit + J::nv, J::nv, v);  // of joints whose v' is dv'
            end(unit, unit + J::nv, unit + 2 * J::nv, q, v);
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

}  // namespace dyn::simulation
