// Contact points that a step can meet.
#include <utility>

#include "collision/pair_contacts.hpp"
#include "collision/pair_search.hpp"
#include "collision/surface_distance.hpp"
#include "collision/sweep.hpp"
#include "simulation/step.hpp"

namespace dyn::simulation {

namespace {

using namespace tuning;
using collision::comes_before;
using collision::Geom;
using collision::Manifold;
using collision::Pose;

// Bound on the speed of any point of the shape (m/s).
double fastest(const Data<double>& d, Index geom) {
  const Geom& g = d.geoms[geom];
  if (g.body == 0) return 0;
  const Vec3<double> u = velocity_at(d, g.body, d.geom_poses[geom].p), &w = d.step->root_velocity[g.body].angular;
  const double reach = g.bounding_radius < shape::infinity ? g.bounding_radius : 0;
  return shape::norm(u) + shape::norm(w) * reach;
}

// Appends a contact. When the list is full, the contact with the largest distance is dropped.
void append(const Model& m, Workspace& w, const dynContact& c) {
  if (w.contact_count + w.sleep.sleeping_contact_count >= m.n.contacts) {
    if (w.sleep.sleeping_contact_count > 0) return void(w.sleep.contacts_full = true);
    ++w.report.dropped;
    Index shallowest = 0;
    for (Index k = 1; k < w.contact_count; ++k)
      if (w.contacts[k].contact.distance > w.contacts[shallowest].contact.distance) shallowest = k;
    if (!(c.distance < w.contacts[shallowest].contact.distance)) return;
    std::copy(w.contacts + shallowest + 1, w.contacts + w.contact_count, w.contacts + shallowest);
    --w.contact_count;
  }
  dynContactForce& f = w.contacts[w.contact_count++];
  f = {};
  f.contact = c;
}

// Ball that contains the shape in every configuration: chains of revolute and spherical joints keep their lengths.
struct Ball {
  Vec3<double> center;
  double radius;
};
Ball within(const Model& m, const Data<double>& d, Index geom) {
  const Geom& g = d.geoms[geom];
  if (g.body == 0) return {g.X.p, collision::on_mocap(m, geom) ? shape::infinity : g.bounding_radius};
  double radius = shape::norm(g.X.p) + g.bounding_radius;
  for (Index i = g.body;; i = m.bodies()[i].parent) {
    const Body& b = m.bodies()[i];
    if (b.type != BodyType::Revolute && b.type != BodyType::RevoluteUnbounded && b.type != BodyType::Spherical)
      return {d.p[i], shape::infinity};
    if (b.parent == 0) return {d.p[i], radius};
    radius += shape::norm(d.p[i] - d.p[b.parent]);
  }
}

// Lists the enabled pairs that can ever meet, and their shapes. If they are too many, the broad phase finds them.
void find_pairs(const Model& m, const Data<double>& d) {
  Workspace& w = *d.step;
  w.pair_count = w.geom_count = 0, w.awake_pair_count = w.row_count = -1, w.by_boxes = false;
  std::fill_n(w.speeds, m.n.geoms, 0.0);
  const auto room = Index(pair_capacity(m));
  const auto add = [&](Index a, Index b, Index number) {
    const Ball A = within(m, d, a), B = within(m, d, b);
    const double near = search::near * std::min(d.geoms[a].bounding_radius, d.geoms[b].bounding_radius);
    if (shape::norm(A.center - B.center) > A.radius + B.radius + near) return;
    if (w.pair_count < room) w.pairs[w.pair_count] = {a, b, number}, w.speeds[a] = w.speeds[b] = 1;
    ++w.pair_count;
  };
  if (lists_pairs(m)) {
    for (Index k = 0; k < m.n.pairs && w.pair_count <= room; ++k)
      if (d.pair_states[k] == DYN_PAIR_REASON_TESTED) add(m.pairs()[k].a, m.pairs()[k].b, k);
  } else if (w.advancement_cache.enabled) {
    Index pair;
    for (Index a = 0; a < m.n.geoms; ++a)
      for (Index b = a + 1; b < m.n.geoms && w.pair_count <= room; ++b)
        if ((d.geoms[a].body || d.geoms[b].body) && collision::is_tested(m, d, a, b, pair)) add(a, b, pair);
  } else {
    w.pair_count = room + 1;
  }
  w.by_boxes = w.pair_count > room;
  for (Index k = 0; k < m.n.geoms; ++k)
    if (w.speeds[k] > 0) w.geoms[w.geom_count++] = k;
  if (w.by_boxes) std::fill_n(w.speeds, m.n.geoms, 0.0), w.geom_count = 0;
}

}  // namespace

// Shares the search margin of a pair between its two boxes.
double box_margin(const Workspace& w, const Data<double>& d, Index geom, double h) {
  return 0.5 * tuning::search::near * d.geoms[geom].bounding_radius + tuning::search::speed_margin * h * w.speeds[geom];
}

namespace {

// Finds the contact points of all pairs and stores them in the workspace.
struct Search {
  const Model& m;
  Data<double>& d;
  const double h;
  Workspace& w = *d.step;
  static constexpr collision::Options options = [] {
    collision::Options o;
    o.says_unique = false;
    return o;
  }();
  Manifold found{}, end{};
  double min_distance = shape::infinity, fast = 0;  // fast: of the shapes placed (m/s)

  bool sleeps(Index geom) const { return w.sleep.sleeps(d.geoms[geom].body); }
  void place(Index k) {
    if (sleeps(k)) return;
    d.geom_poses[k] = SE3<double>{d.R[d.geoms[k].body], d.p[d.geoms[k].body]} * d.geoms[k].X;
    w.clearances.move(k, d.geom_poses[k], d.geoms[k].bounding_radius);
    w.speeds[k] = fastest(d, k), fast = std::max(fast, w.speeds[k]);
  }

  // Velocity of B relative to A at a point along the normal; positive: opening.
  double opening(Index ia, Index ib, const Vec3<double>& at) const {
    return dot(found.normal, velocity_at(d, d.geoms[ib].body, at) - velocity_at(d, d.geoms[ia].body, at));
  }
  static bool may_pass_by(const Geom& a, const Geom& b) {
    const auto plain = [](const Geom& g) {
      return g.shape.type != shape::Type::HalfSpace && !collision::is_surface(g.shape.type);
    };
    return plain(a) && plain(b);
  }
  collision::Moving moving(Index geom) const {
    const Pose& X = d.geom_poses[geom];
    const Index body = d.geoms[geom].body;
    return {d.geoms[geom].shape, X, velocity_at(d, body, X.p), d.step->root_velocity[body].angular};
  }
  // A gap that closes along its normal need not close: shapes can pass each other, or slide onto a flush surface.
  // So an open pair without contact at the end of the step and on the way there is dropped.
  // If the pair only grazes at the end, the normal of the end counts, with gaps extrapolated back from there.
  void see_where_it_leads(Index ia, Index ib, double near, double gap) {
    bool closes = false;
    for (int i = 0; i < found.count; ++i)
      closes = closes || found.points[i].distance + h * opening(ia, ib, found.points[i].position) < 0;
    if (!closes) return;
    const collision::Moving a = moving(ia), b = moving(ib);
    collision::contacts(a.shape, a.at(h), b.shape, b.at(h), near, *d.collision_workspace, end, options);
    if (end.count > 0) {
      double deepest = shape::infinity;
      for (int i = 0; i < end.count; ++i) deepest = std::min(deepest, end.points[i].distance);
      if (dot(end.normal, found.normal) > search::same_normal || deepest < -search::graze * h * shape::norm(b.v - a.v)) return;
      found = end;
      for (int i = 0; i < found.count; ++i) {
        auto& point = found.points[i];
        const Vec3<double> of_a = velocity_at(d, d.geoms[ia].body, point.position),
                           of_b = velocity_at(d, d.geoms[ib].body, point.position);
        point.distance -= h * dot(found.normal, of_b - of_a), point.position = point.position - (of_a + of_b) * (0.5 * h);
      }
    } else if (gap > near) {
      collision::SweepOptions options;
      options.max_steps = search::sweep_steps;
      if (collision::sweep(a, b, h, *d.collision_workspace, options).status == collision::Impact::Status::None) found.count = 0;
    }
  }

  // Whether contacts between the two bodies pressed when contacts were found last.
  bool pressed(Index ia, Index ib) const {
    const Index a = d.geoms[ia].body, b = d.geoms[ib].body;
    return std::any_of(w.previous, w.previous + w.previous_count, [&](const dynContactForce& f) {
      const auto body = [&](Index shape) { return d.geoms[collision::geom_of_shape(m, shape)].body; };
      const Index x = body(f.contact.shape_a), y = body(f.contact.shape_b);
      return is_active(f) && ((x == a && y == b) || (x == b && y == a));
    });
  }
  // Velocity of the center of a shape as another one sees it that moves with `by`, and a bound on what turning adds for its points.
  struct Seen {
    Vec3<double> center;
    double turning;
  };
  Seen seen(Index by, Index geom) const {
    const Geom &g = d.geoms[geom], &from = d.geoms[by];
    const Vec3<double>& center = d.geom_poses[geom].p;
    const Vec3<double> turning = d.step->root_velocity[g.body].angular - d.step->root_velocity[from.body].angular;
    return {velocity_at(d, g.body, center) - velocity_at(d, from.body, center),
            g.shape.type == shape::Type::Sphere ? 0 : shape::norm(turning) * g.bounding_radius};
  }
  // The least f(by, geom) of the two, where what `by` sees is bounded.
  template <class F>
  double least_seen(Index ia, Index ib, F&& f) const {
    if (!(d.geoms[ia].bounding_radius < shape::infinity)) return f(ia, ib);
    if (!(d.geoms[ib].bounding_radius < shape::infinity)) return f(ib, ia);
    return std::min(f(ia, ib), f(ib, ia));
  }
  // Bound on the speed of points of one shape as the other sees them.
  double relative_speed(Index ia, Index ib) const {
    return least_seen(ia, ib, [&](Index by, Index geom) {
      const Seen x = seen(by, geom);
      return shape::norm(x.center) + x.turning;
    });
  }
  // The same of what passes. Along a half space nothing does.
  double passing_speed(Index ia, Index ib) const {
    return least_seen(ia, ib, [&](Index by, Index geom) {
      const Seen x = seen(by, geom);
      const bool flat = d.geoms[by].shape.type == shape::Type::HalfSpace;
      return (!flat ? shape::norm(x.center) : pressed(ia, ib) ? 0 : std::abs(dot(d.geom_poses[by].R.z, x.center))) + x.turning;
    });
  }

  // Whether a plane separates the shapes where they are apart, and support points tell how far.
  static bool parts(const Geom& a, const Geom& b) {
    return collision::has_support(a.shape.type) && collision::has_support(b.shape.type);
  }
  // is_tested(pair): returns whether the pair is enabled, and sets its number.
  template <class F>
  void look(Index ia, Index ib, F&& is_tested) {
    const Geom &a = d.geoms[ia], &b = d.geoms[ib];
    const Pose &A = d.geom_poses[ia], &B = d.geom_poses[ib];
    // impulses change velocities within the step, so shapes as near as this always count
    const double smaller = std::min(a.bounding_radius, b.bounding_radius),
                 near = std::min(search::near * smaller, contact_margin(w, h, fast, smaller));
    double margin = near + search::speed_margin * h * (w.speeds[ia] + w.speeds[ib]);
    if (!(near < shape::infinity) ||
        (w.sleep.any_asleep && (sleeps(ia) || !d.geoms[ia].body) && (sleeps(ib) || !d.geoms[ib].body)))
      return;
    double bound = collision::sphere_lower_bound(a, A, b, B);
    Clearances::Known* const known = bound <= margin ? w.clearances.find(ia, ib) : nullptr;
    if (known) bound = std::max(bound, w.clearances.bound(*known));
    if (!known && bound <= margin) bound = collision::by_boxes(bound, a, A, b, B);
    if (bound <= margin && margin > 2 * near)  // slower shapes: it would cost more than it saves
      margin = std::min(margin, near + search::speed_margin * h * relative_speed(ia, ib));
    if (known && bound <= margin)
      bound = std::max(bound, w.clearances.bound_along_axis(*known, d.geoms, d.geom_poses, margin));
    if (known && bound <= margin) bound = collision::by_boxes(bound, a, A, b, B);
    Index pair = -1;
    const bool near_enough = bound <= margin && is_tested(pair);
    if (near_enough) {
      collision::Options limited = options;
      limited.max_distance = margin;
      const collision::Result nearest = collision::distance(a.shape, A, b.shape, B, *d.collision_workspace, limited);
      collision::contacts(a.shape, A, b.shape, B, nearest, margin, found);
      if (nearest.distance > margin) {
        bound = nearest.distance - nearest.residual;
        w.clearances.learn(ia, ib, bound, parts(a, b) ? transpose_times(A.R, nearest.normal) : Vec3<double>::zero());
      } else {
        w.clearances.forget_axis(ia, ib);
      }
    }
    min_distance = std::min(min_distance, bound - near);
    if (!near_enough || found.count == 0) return;
    double gap = shape::infinity;
    for (int i = 0; i < found.count; ++i) gap = std::min(gap, found.points[i].distance);
    if (w.options.accuracy > 0) {
      const double way = gap > search::near * smaller ? std::max(gap, search::min_pass * smaller) : smaller;
      w.time_to_pass = std::min(w.time_to_pass, way / passing_speed(ia, ib));
    }
    if (gap > search::touching * smaller && w.options.accuracy == 0 && may_pass_by(a, b)) see_where_it_leads(ia, ib, near, gap);
    for (int i = 0; i < found.count; ++i) {
      const auto& point = found.points[i];
      if (point.distance > near && point.distance + h * opening(ia, ib, point.position) > 0) continue;
      dynContact c = collision::contact_of(found, i);
      c.pair = int(pair), c.shape_a = int(m.geoms()[ia].shape), c.shape_b = int(m.geoms()[ib].shape);
      append(m, w, c);
      for (const Index geom : {ia, ib})
        if (sleeps(geom)) w.sleep.state[w.sleep.number[d.geoms[geom].body]] = Sleeper::Touched, w.sleep.touched = true;
    }
  }
  bool still(Index geom) const { return !d.geoms[geom].body || sleeps(geom); }
  void list_awake() {
    w.awake_pair_count = w.awake_geom_count = 0;
    for (Index i = 0; i < w.geom_count; ++i)
      if (!still(w.geoms[i])) w.awake_geoms[w.awake_geom_count++] = w.geoms[i];
    for (Index n = 0; n < w.pair_count; ++n)
      if (!still(w.pairs[n].a) || !still(w.pairs[n].b)) w.awake_pairs[w.awake_pair_count++] = w.pairs[n];
  }
  void enter_center(Index geom) {
    double* const x = w.centers + geom;
    const std::ptrdiff_t next = geom_capacity(m);
    const Vec3<double>& p = d.geom_poses[geom].p;
    x[0] = p[0], x[next] = p[1], x[2 * next] = p[2], x[3 * next] = d.geoms[geom].bounding_radius;
  }
  void list_rows(const NearPair* pairs, Index count) {
    w.row_count = 0;
    for (Index n = 0; n < count; ++n) {
      const NearPair& p = pairs[n];
      if (PairRow* const last = w.row_count ? w.rows + w.row_count - 1 : nullptr;
          last && last->a == p.a && last->b + last->count == p.b)
        ++last->count;
      else w.rows[w.row_count++] = {p.a, p.b, n, 1};
    }
    for (Index i = 0; i < w.geom_count; ++i) place(w.geoms[i]), enter_center(w.geoms[i]);  // once, for shapes that do not move
  }
  // Bit mask of the next four pairs of a row, from k on, that look() would not reject by bounding spheres.
  unsigned near_of(const PairRow& row, Index k) {
    const Geom& a = d.geoms[row.a];
    const Pose& A = d.geom_poses[row.a];
    const std::ptrdiff_t next = geom_capacity(m);
    const double* const x = w.centers + row.b + k;
    const Vec3<Double4> to =
        Vec3<Double4>::make(Double4::load(x) - A.p[0], Double4::load(x + next) - A.p[1], Double4::load(x + 2 * next) - A.p[2]);
    const Double4 reach = Double4::load(x + 3 * next);
    const auto along = [&](const Vec3<double>& axis) { return to.v[0] * axis[0] + to.v[1] * axis[1] + to.v[2] * axis[2]; };
    Double4 distance;
    if (a.shape.type == shape::Type::HalfSpace) {
      distance = along(A.R.z) - a.shape.radius - reach;
    } else if (a.shape.type == shape::Type::Box) {
      const auto beyond = [&](const Vec3<double>& axis, int i) {
        const Double4 x = along(axis);
        return max(max(x, Double4(0.0) - x) - a.shape.size[i], 0.0);
      };
      const Vec3<Double4> off = Vec3<Double4>::make(beyond(A.R.x, 0), beyond(A.R.y, 1), beyond(A.R.z, 2));
      distance = sqrt(dot(off, off)) - a.shape.radius - reach;
    } else {
      distance = sqrt(dot(to, to)) - a.bounding_radius - reach;
    }
    const Double4 smaller = min(reach, a.bounding_radius),
                  near = min(smaller * search::near, contact_margin(w, h, fast, smaller));
    const Double4 margin = near + (Double4::load(w.speeds + row.b + k) + w.speeds[row.a]) * (search::speed_margin * h);
    const unsigned lanes = (1u << std::min<Index>(row.count - k, Double4::lanes)) - 1, far = bits_of(distance > margin);
    if (w.advancement_cache.enabled) {
      const Double4 left = distance - near;
      for_each_bit(far & lanes, [&](int l) { min_distance = std::min(min_distance, left[l]); });
    }
    return ~far & lanes;
  }
  void by_list() {
    if (w.sleep.any_asleep && w.awake_pair_count < 0) list_awake();
    const NearPair* const pairs = w.sleep.any_asleep ? w.awake_pairs : w.pairs;
    if (w.row_count < 0) list_rows(pairs, w.sleep.any_asleep ? w.awake_pair_count : w.pair_count);
    const Index *const geoms = w.sleep.any_asleep ? w.awake_geoms : w.geoms,
                       geom_count = w.sleep.any_asleep ? w.awake_geom_count : w.geom_count;
    for (Index i = 0; i < geom_count; ++i)
      if (d.geoms[geoms[i]].body) place(geoms[i]), enter_center(geoms[i]);
    for (Index r = 0; r < w.row_count; ++r)
      for (Index k = 0; k < w.rows[r].count; k += Double4::lanes)
        for_each_bit(near_of(w.rows[r], k), [&](int l) {
          const NearPair& p = pairs[w.rows[r].first + k + l];
          look(p.a, p.b, [&](Index& pair) { return pair = p.number, true; });
        });
  }
  void set_up(collision::PairSearch& search) {
    search.set_up(m, d);
    for (Index k = 0; w.sleep.any_asleep && k < search.moving_count; ++k)
      if (const Index geom = search.moving_geoms[k]; sleeps(geom)) search.put_to_sleep(d, geom, box_margin(w, d, geom, h));
    search.list_active();
  }
  void by_boxes() {
    collision::PairSearch& search = *collision::PairSearch::of(d);
    if (!search.ready) set_up(search);
    bool near = search.moving->count() > 1;
    for (Index k = 0; k < search.active_count; ++k) {
      const Index geom = search.moving_geoms[search.active[k]];
      place(geom);
      near |= !search.place(d, search.active[k], box_margin(w, d, geom, h));
    }
    min_distance = 0;  // nothing is known of the pairs the broad phase rejects
    for (Index k = 0; k < search.unbounded_count; ++k) {
      if (d.geoms[search.unbounded_geoms[k]].body == 0) continue;
      place(search.unbounded_geoms[k]);
      near = true;
    }
    if (!near) return;
    const bool ascending = search.for_each(
        d, [&](Index a, Index b) { look(a, b, [&](Index& pair) { return collision::is_tested(m, d, a, b, pair); }); });
    const auto before = [](const dynContactForce& x, const dynContactForce& y) { return comes_before(x.contact, y.contact); };
    if (!ascending) std::sort(w.contacts, w.contacts + w.contact_count, before);
  }
};

}  // namespace

Index find_contacts(const Model& m, Data<double>& d, double h, double& min_distance) {
  Workspace& w = *d.step;
  std::swap(w.contacts, w.previous);
  w.previous_count = w.contact_count, w.contact_count = 0, w.time_to_pass = shape::infinity;
  if (w.pair_count < 0) find_pairs(m, d);
  Search search{m, d, h};
  w.by_boxes ? search.by_boxes() : search.by_list();
  min_distance = search.min_distance;
  take_previous_forces(m, d);
  return w.contact_count;
}

}  // namespace dyn::simulation
