// Lengths of tendons, and of what else actuators act through, with their moment arms J = dl/dq and rates J v. A path's first
// variation needs only what its end points do: with u the unit vector of a straight piece from a to b,
//   dl = u . (db - da)
// and a curve that is shortest on a surface adds nothing (it is stationary). So each piece is a pair of opposite unit forces on two
// bodies, and J is what they give the joints.
#pragma once

#include "algorithm/declarations.hpp"
#include "algorithm/wrapping.hpp"
#include "joint/list.hpp"
#include "spatial/explog.hpp"

namespace dyn {

// A point of a path and its body.
template <class T>
struct PathPoint {
  Vec3<T> x;  // W
  Index body;
};

template <class T>
const Vec3<T>& origin_of(const Data<T>& d, Index place) { return d.p[place]; }
template <class T>
const Mat3<T>& axes_of(const Data<T>& d, Index place) { return d.R[place]; }

// f(point a, point b) for each straight piece of a SPATIAL path with its divisor, and f.arc(wrap) for each arc: see PathPieces.
template <class T, class Places = Data<T>>
struct PathPieces {
  const Model& m;
  const Places& d;

  Vec3<T> position(Index place, const Vec3<double>& at) const { return origin_of(d, place) + axes_of(d, place) * cast<T>(at); }
  PathPoint<T> site(const PathElement& e) const { return {position(e.place, e.X.p), e.body}; }

  // The way from a to b around the element.
  Wrap<T> around(const PathElement& e, const PathPoint<T>& a, const PathPoint<T>& b) const {
    const Mat3<T> R = axes_of(d, e.place) * cast<T>(e.X.R);
    const Vec3<T> centre = position(e.place, e.X.p);
    const auto local = [&](const Vec3<T>& x) { return transpose_times(R, x - centre); };
    Vec3<T> side = Vec3<T>::zero();
    if (e.side_id >= 0) side = local(position(e.side_place, e.side));
    Wrap<T> w = wrap_around(e.type == DYN_TENDON_ELEMENT_TYPE_CYLINDER, local(a.x), local(b.x), T(e.value),
                            e.side_id >= 0 ? &side : nullptr);
    w.first = centre + R * w.first, w.last = centre + R * w.last;
    return w;
  }
  // straight(a, b, divisor), arc(wrap, element, divisor) and begin() along the path.
  template <class Begin, class Straight, class Bent>
  void walk(const PathRecord& p, Begin&& begin, Straight&& straight, Bent&& arc) const {
    const PathElement* const all = m.path_elements() + p.first;
    T divisor = T(1);
    for (Index k = 0; k < p.elements;) {
      const PathElement& e = all[k];
      if (e.type == DYN_TENDON_ELEMENT_TYPE_PULLEY) {
        divisor = T(e.value), ++k;
        continue;
      }
      PathPoint<T> a = site(e);
      begin(a);
      for (++k; k < p.elements && all[k].type != DYN_TENDON_ELEMENT_TYPE_PULLEY; ++k) {
        if (all[k].type == DYN_TENDON_ELEMENT_TYPE_SITE) {
          const PathPoint<T> b = site(all[k]);
          straight(a, b, divisor), a = b;
          continue;
        }
        const PathElement& wrap = all[k++];
        const PathPoint<T> b = site(all[k]);
        const Wrap<T> w = around(wrap, a, b);
        if (w.touches) {
          straight(a, PathPoint<T>{w.first, wrap.body}, divisor);
          arc(w, wrap, divisor);
          straight(PathPoint<T>{w.last, wrap.body}, b, divisor);
        } else {
          straight(a, b, divisor);
        }
        a = b;
      }
    }
  }
};

// Unit vector from a to b. Where they coincide any direction is as good.
template <class T>
Vec3<T> direction(const Vec3<T>& a, const Vec3<T>& b) {
  using std::sqrt;
  const Vec3<T> along = b - a;
  const T far = sqrt(dot(along, along));
  return far > T(detail::smallest_wrap) ? along * (T(1) / far) : Vec3<T>::make(T(1), T(0), T(0));
}

// Adds what a force and a moment (W, about the point x) on a body, and the opposite force and moment about `y` on another, give
// the joints to row, by the user's degrees of freedom. Joints that carry both take no part.
template <class T>
void add_pair(const Model& m, const Data<T>& d, const Vec3<T>& force, const Vec3<T>& moment, const PathPoint<T>& a,
              const PathPoint<T>& b, T* row) {
  const auto add = [&](Index i, const Vec3<T>& x, T sign) {
    const Body& body = m.bodies()[i];
    const Vec3<T> about = moment + cross(x - d.p[i], force);
    visit(body.type, [&]<class J>() {
      for (int k = 0; k < J::nv; ++k) {
        const Motion<T> s = J::column(body, d.R[i], k);
        row[body.user_v + k] += sign * T(body.ratio) * (dot(s.linear, force) + dot(s.angular, about));
      }
    });
    return body.parent;
  };
  for (Index i = a.body, j = b.body; i != j;) {
    if (i > j) i = add(i, a.x, T(1));
    else j = add(j, b.x, T(-1));
  }
}

namespace detail {

// Each returns the length and adds dl/dq to row.
template <class T>
T fixed_path(const Model& m, const Data<T>& d, const PathRecord& p, T* row) {
  T length = T(0);
  for (const PathElement *e = m.path_elements() + p.first, *end = e + p.elements; e != end; ++e) {
    const JointRecord& j = m.joints()[e->id];
    length += T(e->value) * (T(j.ratio) * d.q[e->q] + T(j.offset));
    row[e->dof] += T(e->value * j.ratio);
  }
  return length;
}

template <class T>
T spatial_path(const Model& m, const Data<T>& d, const PathRecord& p, T* row) {
  using std::sqrt;
  T length = T(0);
  PathPieces<T>{m, d}.walk(
      p, [](const PathPoint<T>&) {},
      [&](const PathPoint<T>& a, const PathPoint<T>& b, T divisor) {
        const Vec3<T> along = b.x - a.x;
        length += sqrt(dot(along, along)) / divisor;
        if (a.body == b.body) return;
        add_pair(m, d, direction(a.x, b.x) * (T(1) / divisor), Vec3<T>::zero(), b, a, row);
      },
      [&](const Wrap<T>& w, const PathElement&, T divisor) { length += w.length / divisor; });
  return length;
}

template <class T>
T site_path(const Model& m, const Data<T>& d, const PathRecord& p, T* row) {
  const PathElement* const e = m.path_elements() + p.first;
  const PathPieces<T> at{m, d};
  const PathPoint<T> site = at.site(e[0]);
  const bool referred = p.elements > 1;
  const PathPoint<T> reference = referred ? at.site(e[1]) : PathPoint<T>{Vec3<T>::zero(), 0};
  const Mat3<T> R = d.R[e[referred].place] * cast<T>(e[referred].X.R);
  const auto wrench = [&](int i) { return Vec3<T>::make(T(p.wrench[i]), T(p.wrench[i + 1]), T(p.wrench[i + 2])); };
  add_pair(m, d, R * wrench(0), R * wrench(3), site, reference, row);
  if (!referred) return T(0);
  const Mat3<T> turned = transpose(R) * (d.R[e[0].place] * cast<T>(e[0].X.R));
  return dot(wrench(0), transpose_times(R, site.x - reference.x)) + dot(wrench(3), log3(turned));
}

// A moment on a ball joint, or a force (W) and a moment on a free joint.
template <class T>
T axes_path(const Model& m, const Data<T>& d, const PathRecord& p, T* row) {
  const PathElement& e = m.path_elements()[p.first];
  const bool ball = m.joints()[e.id].type == DYN_JOINT_TYPE_SPHERICAL, in_parent = p.kind == PathKind::AxesInParent;
  const auto wrench = [&](int i) { return Vec3<T>::make(T(p.wrench[i]), T(p.wrench[i + 1]), T(p.wrench[i + 2])); };
  const Mat3<T> R = rotation(load_quaternion(d.q + e.q + (ball ? 0 : 3)));
  const auto turned = [&](const Vec3<T>& x) { return in_parent ? transpose_times(R, x) : x; };
  const auto put = [&](const Vec3<T>& x, int at) {
    for (int i = 0; i < 3; ++i) row[e.dof + at + i] += x[i];
  };
  if (!ball) return put(transpose_times(R, wrench(0)), 0), put(turned(wrench(3)), 3), T(0);
  const Vec3<T> moment = turned(wrench(0));
  put(moment, 0);
  return dot(moment, log3(R));
}

// A rod between the first element's origin and a slider on the z axis of the second.
template <class T>
T slider_path(const Model& m, const Data<T>& d, const PathRecord& p, T* row) {
  using std::sqrt;
  const PathElement* const e = m.path_elements() + p.first;
  const PathPieces<T> at{m, d};
  const PathPoint<T> pin = at.site(e[0]), slider = at.site(e[1]);
  const Vec3<T> axis = (d.R[e[1].place] * cast<T>(e[1].X.R)).z, x = pin.x - slider.x;
  const T along = dot(axis, x), square = along * along + T(p.wrench[0] * p.wrench[0]) - dot(x, x);
  const bool reaches = square > T(0);
  const T root = reaches ? sqrt(square) : T(1), slope = reaches ? T(1) - along / root : T(1);
  const Vec3<T> by_x = axis * slope + x * (reaches ? T(1) / root : T(0));
  // a motion of all together leaves l alone: what the slider takes is the opposite force, at the pin
  add_pair(m, d, by_x, Vec3<T>::zero(), pin, PathPoint<T>{pin.x, slider.body}, row);
  return reaches ? along - root : along;
}

// L1 - L1_0 - p(L2 - L2_0)
template <class T>
T coupled_path(const Model& m, const Data<T>& d, const PathRecord& p, T* row) {
  const auto add = [&](Index tendon, T factor) {
    const PathRecord& t = m.paths()[tendon];
    for (Index k = 0; k < t.dofs; ++k) row[m.path_dofs()[t.first_dof + k]] += factor * d.path_moment[t.first_dof + k];
  };
  const T x = p.elements >= 0 ? d.path_length[p.elements] - T(p.neutral[1]) : T(0);
  T value = T(0), slope = T(0);
  for (int k = 4; k >= 0; --k) slope = slope * x + value, value = value * x + T(p.polynomial[k]);
  add(p.first, T(1));
  if (p.elements >= 0) add(p.elements, -slope);
  return d.path_length[p.first] - T(p.neutral[0]) - value;
}

}  // namespace detail

// Lengths, rates and moment arms at d.q, d.v, with the placements in d.
template <class T>
void measure_paths(const Model& m, Data<T>& d) {
  T* const row = d.path_row;
  for (Index k = 0; k < m.n.paths; ++k) {
    const PathRecord& p = m.paths()[k];
    const Index* const dofs = m.path_dofs() + p.first_dof;
    for (Index i = 0; i < p.dofs; ++i) row[dofs[i]] = T(0);
    switch (p.kind) {
      case PathKind::Fixed: d.path_length[k] = detail::fixed_path(m, d, p, row); break;
      case PathKind::Spatial: d.path_length[k] = detail::spatial_path(m, d, p, row); break;
      case PathKind::Site: d.path_length[k] = detail::site_path(m, d, p, row); break;
      case PathKind::Coupling: d.path_length[k] = detail::coupled_path(m, d, p, row); break;
      case PathKind::Axes:
      case PathKind::AxesInParent: d.path_length[k] = detail::axes_path(m, d, p, row); break;
      case PathKind::SliderCrank: d.path_length[k] = detail::slider_path(m, d, p, row); break;
      case PathKind::Adhesion: d.path_length[k] = d.path_velocity[k] = T(0); continue;  // simulation/adhesion.hpp
    }
    T rate = T(0);
    for (Index i = 0; i < p.dofs; ++i) d.path_moment[p.first_dof + i] = row[dofs[i]], rate += row[dofs[i]] * d.v[dofs[i]];
    d.path_velocity[k] = rate;
  }
}

// The same where the state in d was changed directly.
template <class T>
void place_paths(const Model& m, Data<T>& d) {
  if (m.n.paths_in_space > 0) forward_kinematics<0>(m, d);
  measure_paths(m, d);
}

// tau += J^T f
template <class T>
void add_path_force(const Model& m, const Data<T>& d, Index path, T force, T* tau) {
  const PathRecord& p = m.paths()[path];
  for (Index k = p.first_dof; k < p.first_dof + p.dofs; ++k) tau[m.path_dofs()[k]] += force * d.path_moment[k];
}

}  // namespace dyn
