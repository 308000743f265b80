// Errors of the tasks of inverse kinematics, and their exact derivatives along the step.
// A step d moves q as dyn_integrate does, but for the position of a free flyer, to which the linear part is added in the axes of
// its joint's frame: limits of that position are then bounds on the step.
#pragma once

#include "algorithm/least_squares.hpp"
#include "algorithm/center_of_mass.hpp"
#include "algorithm/configuration.hpp"
#include "base/struct_array.hpp"

namespace dyn {

inline dynIkTask default_ik_task() {
  dynIkTask t{};
  t.type = DYN_IK_TASK_TYPE_POSE;
  t.target[0] = t.target[4] = t.target[8] = 1;
  t.weight = 1;
  return t;
}

struct IkTasks : StructArray<dynIkTask> {
  IkTasks(const dynIkTask* tasks, Index ntasks) : StructArray{tasks, ntasks, default_ik_task} {}
};

// Numbers of the error: [begin, end) of [linear; angular].
struct IkRows {
  int begin, end;
};
inline IkRows rows_of(dynIkTaskType type) {
  return {type == DYN_IK_TASK_TYPE_ORIENTATION ? 3 : 0,
          type == DYN_IK_TASK_TYPE_POSE || type == DYN_IK_TASK_TYPE_ORIENTATION ? 6 : 3};
}
inline Index row_count(const Model& m, dynIkTaskType type) {
  return type == DYN_IK_TASK_TYPE_POSTURE ? m.n.nv : rows_of(type).end - rows_of(type).begin;
}

struct IkResidual {
  double linear = 0, angular = 0;
  void add(double e, bool angle) { (angle ? angular : linear) += e * e; }
  void root() { linear = std::sqrt(linear), angular = std::sqrt(angular); }
};

// out = q moved by d; out may be q.
template <class T>
void ik_retract(const Model& m, const T* q, const T* d, T* out) {
  for_each_leader(m, [&]<class J>(const Body& b) DYN_INLINE_LAMBDA {
    if constexpr (J::nv == 6) {
      for (int k = 0; k < 3; ++k) out[b.user_q + k] = q[b.user_q + k] + d[b.user_v + k];
      Spherical::integrate(q + b.user_q + 3, d + b.user_v + 3, out + b.user_q + 3);
    } else {
      J::integrate(q + b.user_q, d + b.user_v, out + b.user_q);
    }
  });
}

// Three columns of height h by the body's velocity, to those by the position of a free flyer at q.
template <class T>
void turn_columns(const T* q, Index h, T* columns) {
  const Mat3<T> R = rotation(load_quaternion(q + 3));
  for (Index i = 0; i < h; ++i) {
    const Vec3<T> row = R * Vec3<T>::make(columns[i], columns[i + h], columns[i + 2 * h]);
    for (int k = 0; k < 3; ++k) columns[i + h * k] = row[k];
  }
}

// Error of a task of a frame or of the centre of mass; of a frame, also X_TF and where the frame is.
template <class T>
struct IkError {
  Motion<T> e;
  SE3<T> X;
  FramePose<T> F;
};
template <class T>
IkError<T> ik_error(const Model& m, const Data<T>& d, const dynIkTask& t) {
  IkError<T> x{};
  const Vec3<T> target = cast<T>(load3(t.target + 9));
  x.e = Motion<T>::zero();
  if (t.type == DYN_IK_TASK_TYPE_COM) {
    x.e.linear = load3(d.com) - target;
    return x;
  }
  x.F = frame_pose(m, d, t.frame);
  if (t.type == DYN_IK_TASK_TYPE_POSITION) {
    x.e.linear = x.F.p - target;
    return x;
  }
  const Mat3<T> R = cast<T>(load33(t.target));
  x.X = {transpose(R) * x.F.R, transpose_times(R, x.F.p - target)};
  if (t.type == DYN_IK_TASK_TYPE_POSE) x.e = log6(x.X);
  else x.e.angular = log3(x.X.R);
  return x;
}
inline double ik_weight(const dynIkTask& t, Index k) { return t.weights ? t.weight * t.weights[k] : t.weight; }

// f(J, body, e, weights) with the error of a posture at each joint.
template <class T, class F>
void for_posture(const Model& m, const T* q, const dynIkTask& t, F&& f) {
  for_each_leader(m, [&]<class J>(const Body& b) {
    T reference[J::nq], e[J::nv];
    for (int k = 0; k < J::nq; ++k) reference[k] = T(t.posture[b.user_q + k]);
    J::difference(b, reference, q + b.user_q, e);
    f.template operator()<J>(b, reference, e);
  });
}

// The weighted sum of squares of a task at d.q, halved; and how large its error is.
template <class T>
T ik_cost(const Model& m, const Data<T>& d, const dynIkTask& t, IkResidual& residual) {
  T sum = T(0);
  residual = {};
  if (t.type == DYN_IK_TASK_TYPE_POSTURE) {
    for_posture(m, d.q, t, [&]<class J>(const Body& b, const T*, const T* e) {
      for (int k = 0; k < J::nv; ++k) {
        const T w = T(ik_weight(t, b.user_v + k));
        if (w == T(0)) continue;
        sum += w * w * e[k] * e[k];
        residual.add(double(e[k]), J::rotates_at(k));
      }
    });
  } else {
    const IkError<T> x = ik_error(m, d, t);
    const IkRows rows = rows_of(t.type);
    bool whole = true;
    for (int k = rows.begin; k < rows.end; ++k) {
      const T w = T(ik_weight(t, k - rows.begin)), e = k < 3 ? x.e.linear[k] : x.e.angular[k - 3];
      sum += w * w * e * e;
      if (w != T(0)) residual.add(double(e), k >= 3);
      else whole = false;
    }
    // the linear part of log6 is not yet the distance while the axes differ
    if (whole && t.type == DYN_IK_TASK_TYPE_POSE) residual.linear = double(dot(x.X.p, x.X.p));
  }
  residual.root();
  return sum * T(0.5);
}

// Rows of a task, weighted and times scale, into s. Needs positions (and Stage::Com) of d.q.
template <class T>
void ik_linearise(const Model& m, Data<T>& d, const dynIkTask& t, T scale, LeastSquares<T>& s) {
  T e[6];
  if (t.type == DYN_IK_TASK_TYPE_POSTURE) {
    for_posture(m, d.q, t, [&]<class J>(const Body& b, const T* reference, T* error) {
      T by_0[36] = {}, by_q[36] = {}, columns[36];
      Index list[6];
      J::difference_jacobians(b, reference, d.q + b.user_q, Block<T>{by_0, 6}, Block<T>{by_q, 6});
      for (int k = 0; k < J::nv; ++k) {
        const T w = scale * T(ik_weight(t, b.user_v + k));
        error[k] *= w;
        list[k] = b.user_v + k;
        for (int c = 0; c < J::nv; ++c) columns[k + J::nv * c] = w * by_q[k + 6 * c];
      }
      if constexpr (J::nv == 6) turn_columns(d.q + b.user_q, 6, columns);
      s.add(J::nv, error, columns, list, J::nv);
    });
    return;
  }
  const IkError<T> x = ik_error(m, d, t);
  const IkRows rows = rows_of(t.type);
  const int h = rows.end - rows.begin;
  T w[6] = {};
  for (int k = rows.begin; k < rows.end; ++k) {
    w[k] = scale * T(ik_weight(t, k - rows.begin));
    e[k - rows.begin] = w[k] * (k < 3 ? x.e.linear[k] : x.e.angular[k - 3]);
  }
  Index* list = d.ik_indices;
  if (t.type == DYN_IK_TASK_TYPE_COM) {
    center_of_mass_jacobian(m, d, Index(0), d.ik_columns);
    for (Index k = 0; k < m.n.nv; ++k) {
      list[k] = k;
      for (int i = 0; i < 3; ++i) d.ik_columns[3 * k + i] *= w[i];
    }
    for_each_leader(m, [&]<class J>(const Body& b) {
      if constexpr (J::nv == 6) turn_columns(d.q + b.user_q, 3, d.ik_columns + 3 * b.user_v);
    });
    s.add(3, e, d.ik_columns, list, m.n.nv);
    return;
  }
  // of [linear; angular] velocities of the frame's origin in world axes: linear part A l + B w, angular part C w
  Mat3<T> A = Mat3<T>::identity(), B = Mat3<T>::zero(), C = B;
  const Mat3<T> Rt = transpose(x.F.R);
  if (t.type == DYN_IK_TASK_TYPE_POSE) {
    const Mat6<T> J = Jlog6(x.e);
    A = J.ll * Rt, B = J.la * Rt, C = J.aa * Rt;
  } else if (t.type == DYN_IK_TASK_TYPE_ORIENTATION) {
    C = Jlog3(x.e.angular) * Rt;
  }
  const Mat3<T> linear = Mat3<T>::diagonal(w[0], w[1], w[2]), angular = Mat3<T>::diagonal(w[3], w[4], w[5]);
  A = linear * A, B = linear * B, C = angular * C;

  // the columns of the joints that carry the frame; followers add to their leaders'
  Index* slot = list + m.n.nv;
  if (m.has_mimic) std::fill_n(slot, m.n.nv, Index(-1));
  Index count = 0;
  for (Index i = x.F.body; i != 0; i = m.bodies()[i].parent) {
    const Body& b = m.bodies()[i];
    const Vec3<T> to_frame = x.F.p - d.p[i];
    visit(b.type, [&]<class J>() {
      for (int k = 0; k < J::nv; ++k) {
        const Motion<T> v = shift(J::column(b, d.R[i], k), to_frame) * T(b.ratio);
        T column[6];
        store6(Motion<T>{A * v.linear + B * v.angular, C * v.angular}, column);
        Index at = m.has_mimic ? slot[b.user_v + k] : Index(-1);
        const bool first = at < 0;
        if (first) at = count++, list[at] = b.user_v + k;
        if (m.has_mimic) slot[b.user_v + k] = at;
        for (int r = 0; r < h; ++r) d.ik_columns[h * at + r] = column[rows.begin + r] + (first ? T(0) : d.ik_columns[h * at + r]);
      }
      if constexpr (J::nv == 6) turn_columns(d.q + b.user_q, h, d.ik_columns + h * (count - 6));
    });
  }
  s.add(h, e, d.ik_columns, list, count);
}

}  // namespace dyn
