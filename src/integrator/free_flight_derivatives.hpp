// Derivatives of free_flight and end_flight (free_flight.hpp) of one free flyer.
#pragma once

#include "integrator/free_flight.hpp"

namespace dyn::integrator {

// Change of v + h ddq by free_flight: v' = v + h ddq + delta(v, ddq). Of a body with children delta is h (w x u + w x (w x c)),
// in its linear part alone.
template <class T>
struct FlightCorrection {
  Vec3<T> u, w, c;
  T h;

  Vec3<T> value() const { return (cross(w, u) + cross(w, cross(w, c))) * h; }
  // Along a change of u and w.
  Vec3<T> change(const Vec3<T>& du, const Vec3<T>& dw) const {
    return (cross(dw, u) + cross(w, du) + cross(dw, cross(w, c)) + cross(w, cross(dw, c))) * h;
  }
  Vec3<T> by_centre(const Vec3<T>& dc) const { return cross(w, cross(w, dc)) * h; }
};

// The same of a body without children: I w' = exp(-h w') L with L = I (w + h dw) + h w x I w.
template <class T>
struct FreeBodyFlight {
  FlightCorrection<T> linear;
  Mat3<T> I;
  Vec3<T> w1;  // its angular velocity after free_flight

  struct Change {
    Vec3<T> linear, angular;
  };
  // Of delta along changes of v and of ddq.
  Change change(const Vec3<T>& du, const Vec3<T>& dw, const Vec3<T>& of_a) const {
    const Vec3<T>& w = linear.w;
    const T h = linear.h;
    const Vec3<T> y = I * w1;
    const Vec3<T> by = I * (dw + of_a * h) + (cross(dw, I * w) + cross(w, I * dw)) * h;
    const Vec3<T> dw1 = solve3(I - skew(y) * Jexp3(w1 * h) * h, exp3(w1 * -h) * by);
    const Vec3<T> turned = dw1 - dw - of_a * h;
    return {linear.change(du, dw) - cross(turned, linear.c), turned};
  }
  // Of delta along changes of c and I.
  Change by_inertia(const Vec3<T>& dc, const Mat3<T>& dI) const {
    const Vec3<T>& w = linear.w;
    const T h = linear.h;
    const Vec3<T> y = I * w1, wh = solve3(I, exp3(w1 * h) * y - cross(w, I * w) * h);  // w + h dw
    const Vec3<T> by = exp3(w1 * -h) * (dI * wh + cross(w, dI * w) * h) - dI * w1;
    const Vec3<T> dw1 = solve3(I - skew(y) * Jexp3(w1 * h) * h, by);
    return {linear.by_centre(dc) - cross(w1 - wh, dc) - cross(dw1, linear.c), dw1};
  }
};

// The end of a step: R = R0 exp(phi) with phi = h w + dphi, the centre of mass moves by h v_c + dp + dphi x c.
template <class T>
struct FlightEnd {
  Vec3<T> c, moved, vc;
  Mat3<T> Et, J;  // exp(-phi), and the right Jacobian of exp
  T h;

  // linear, angular: v before end_flight; correction: dp, dphi.
  static FlightEnd of(const Vec3<T>& c, const Motion<T>& v, const Motion<T>& correction, T h) {
    const Vec3<T> phi = v.angular * h + correction.angular, vc = v.linear + cross(v.angular, c);
    return {c, vc * h + correction.linear + cross(correction.angular, c), vc, exp3(phi * T(-1)), Jexp3(phi), h};
  }
  struct Change {
    Motion<T> q, v;
  };
  // Along a change of c. w: angular velocity before end_flight.
  Change by_centre(const Vec3<T>& dc, const Vec3<T>& w, const Vec3<T>& phi) const {
    const Vec3<T> o = Vec3<T>::zero();
    return {{Et * (dc + cross(phi, dc)) - dc, o}, {Et * cross(w, dc) - cross(w, dc), o}};
  }
  Change change(const Motion<T>& dq, const Motion<T>& dv, const Motion<T>& by) const {
    const Vec3<T> turn = J * (dv.angular * h + by.angular), dvc = dv.linear + cross(dv.angular, c);
    const Vec3<T> dmoved = dvc * h + by.linear + cross(by.angular, c), theta = Et * dq.angular + turn;
    const Vec3<T> step = Et * (dq.linear + cross(dq.angular, c + moved) + dmoved) - cross(theta, c);
    return {{step, theta}, {Et * dvc + cross(Et * vc, turn) - cross(dv.angular, c), dv.angular}};
  }
};

}  // namespace dyn::integrator
