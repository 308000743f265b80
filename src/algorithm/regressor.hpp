// Regressors: forces, energies and the centre of mass are linear in the inertial parameters pi of the joints' bodies (Atkeson,
// An, Hollerbach 1986, "Estimation of inertial parameters of manipulator loads and links"; parameters:
// spatial/inertial_parameters.hpp).
#pragma once

#include "algorithm/jacobian.hpp"
#include "spatial/inertial_parameters.hpp"

namespace dyn {

// The ten columns F of Y, 6 x 10: the force that moves a body is Y pi. pi refers to the axes e_k that are the columns of E and to
// an origin with the classical acceleration a, gravity taken off; the force is at that origin, in the axes of w, dw, a and E.
//   f = m a + dw x h + w x (w x h)      n = h x a + I dw + w x (I w)
template <class T>
DYN_INLINE void body_regressor(const Mat3<T>& E, const Vec3<T>& w, const Vec3<T>& dw, const Vec3<T>& a, Force<T>* F) {
  const Vec3<T> zero = Vec3<T>::zero();
  const Mat3<T> Et = transpose(E), turned = cross(w, E);
  const Vec3<T> wE = Et * w, dwE = Et * dw;
  // n of an I that is 1 in row i of column j alone
  auto moment = [&](int i, int j) DYN_INLINE_LAMBDA { return E[i] * dwE[j] + turned[i] * wE[j]; };
  F[0] = {a, zero};
  F[1] = {cross(dw, E.x) + cross(w, turned.x), cross(E.x, a)};
  F[2] = {cross(dw, E.y) + cross(w, turned.y), cross(E.y, a)};
  F[3] = {cross(dw, E.z) + cross(w, turned.z), cross(E.z, a)};
  F[4] = {zero, moment(0, 0)};
  F[5] = {zero, moment(0, 1) + moment(1, 0)};
  F[6] = {zero, moment(1, 1)};
  F[7] = {zero, moment(0, 2) + moment(2, 0)};
  F[8] = {zero, moment(1, 2) + moment(2, 1)};
  F[9] = {zero, moment(2, 2)};
}

// Y of a body that moves with a frame: pi and the force in its axes, at its origin.
template <class T>
void frame_body_regressor(const Data<T>& d, const FramePose<T>& P, T* Y) {
  const Mat3<T> Rt = transpose(P.R);
  const Motion<T> a = frame_classical_acceleration(P, d);
  Force<T> F[10];
  body_regressor(Mat3<T>::identity(), Rt * d.omega[P.body], Rt * a.angular, Rt * (a.linear - load3(d.world_gravity)), F);
  for (int c = 0; c < 10; ++c) store6(F[c], Y + 6 * c);
}
// The joint's frame, as its body carries it.
template <class T>
inline FramePose<T> joint_pose(const Model& m, const Data<T>& d, Index joint) {
  const JointRecord& j = m.joints()[joint];
  return {j.last_body, d.R[j.last_body] * cast<T>(j.C), d.p[j.last_body], Vec3<T>::zero()};
}

// Placements, with level 1 velocities in d.omega_centroidal and d.vel_centroidal; and f(body, first parameter, axes E of the
// joint's frame) for each joint's body on the way.
template <int level, class T, class F>
DYN_INLINE void forward_joints(const Model& m, Data<T>& d, F&& f) {
  const T* v = level >= 1 ? d.expand(m, d.v, d.vx) : nullptr;
  const Motions<T> x = {d.omega_centroidal, d.vel_centroidal, nullptr, nullptr};
  place_forward(m, d, Pose<T>(d), [&]<class J>(Index i, Index, const SE3<T>& X, Pose<T>& s) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const JointRecord& joint = m.joints()[b.joint];
    const Vec3<T> r = s.place(d, i, X);
    move_body<level, J>(b, i, x, s.R, r, v, v);
    if (joint.last_body == i) f(i, 10 * std::ptrdiff_t(b.joint - 1), s.R * cast<T>(joint.C));
  }).done(d);
}

// d.static_regressor, 3 x 10 (njoints - 1): com = Y pi, the whole mass being that of the model.
template <class T>
void static_regressor(const Model& m, Data<T>& d) {
  const T inverse = m.total_mass > 0 ? T(1) / T(m.total_mass) : T(0);
  forward_joints<0>(m, d, [&](Index i, std::ptrdiff_t first, const Mat3<T>& E) DYN_INLINE_LAMBDA {
    T* columns = d.static_regressor + 3 * first;
    store3(d.p[i] * inverse, columns);
    store33(E * inverse, columns + 3);
    for (int k = 12; k < 30; ++k) columns[k] = T(0);
  });
  d.mark_fresh(Stage::StaticRegressor);
}

// d.kinetic_energy_regressor y, 10 (njoints - 1): v^T (M - armature) v / 2 = y . pi.
template <class T>
void kinetic_energy_regressor(const Model& m, Data<T>& d) {
  forward_joints<1>(m, d, [&](Index i, std::ptrdiff_t first, const Mat3<T>& E) DYN_INLINE_LAMBDA {
    const Mat3<T> Et = transpose(E);
    const Vec3<T> u = Et * d.vel_centroidal[i], w = Et * d.omega_centroidal[i];
    store_parameters<T>({T(0.5) * dot(u, u), cross(u, w), {hadamard(w, w) * T(0.5), hadamard(w, yzx(w))}},
                        d.kinetic_energy_regressor + first);
  });
  d.mark_fresh(Stage::KineticRegressor);
}

// d.potential_energy_regressor y, 10 (njoints - 1): -m g . com = y . pi.
template <class T>
void potential_energy_regressor(const Model& m, Data<T>& d) {
  const Vec3<T> g = load3(d.world_gravity);
  forward_joints<0>(m, d, [&](Index i, std::ptrdiff_t first, const Mat3<T>& E) DYN_INLINE_LAMBDA {
    store_parameters<T>({-dot(g, d.p[i]), -transpose_times(E, g), Sym3<T>::zero()}, d.potential_energy_regressor + first);
  });
  d.mark_fresh(Stage::PotentialRegressor);
}

// pi of every joint's body in the joint's frame, 10 x (njoints - 1): links that were merged into it are part of it.
template <class T>
void inertial_parameters(const Model& m, T* pi) {
  for (Index joint = 1; joint < m.n.joints; ++joint) {
    const JointRecord& j = m.joints()[joint];
    const Inertia<T> Y = world_inertia(m.bodies()[j.last_body], transpose(cast<T>(j.C)));
    store_parameters(Y, pi + 10 * (joint - 1));
  }
}

}  // namespace dyn
