// Rows of a step as an MJCF file states them for MuJoCo (its documentation, "Computation": constraint model, solver parameters).
// With the row's error r, its velocity v at the beginning of the step and its impulse lambda = h f:
//   a_ref = -b v - k d(r) r        R = (1 - d(r)) / d(r) W        J a + R f = a_ref, f within its bounds or its cone
// so c + R lambda + bias = 0 with bias = -(1 - h b) v + h k d(r) r. The bias of a connect or weld has h J' v, too. W is
// the inverse inertia of the model's initial configuration.
#include "base/portable.hpp"
#include "simulation/island.hpp"

namespace dyn::simulation {

namespace {

constexpr double least_impedance = 1e-4, largest_impedance = 0.9999, least = 1e-15;  // MuJoCo's mjMINIMP, mjMAXIMP, mjMINVAL

// d(r): dmin at r = 0, dmax from |r| = width on.
double impedance(const Compliance& law, double r) {
  const auto within = [](double x) { return std::clamp(x, least_impedance, largest_impedance); };
  const double low = within(law.impedance[0]), high = within(law.impedance[1]), width = law.impedance[2],
               middle = within(law.impedance[3]), power = std::max(1.0, law.impedance[4]);
  if (low == high || !(width > least)) return (low + high) / 2;
  const double x = std::min(1.0, std::abs(r) / width);
  const auto curve = [&](double part, double of) { return part > 0 ? part * math::pow(part / of, power - 1) : 0; };
  const double y = x <= middle ? curve(x, middle) : 1 - curve(1 - x, 1 - middle);
  return low + y * (high - low);
}

// Acceleration per error and per velocity, and the inverse stiffness of the row's impulse.
struct Soft {
  double k, b, d, R;
  // r: by which the impedance goes. weight: W.
  Soft(const Compliance& law, const double (&reference)[2], double r, double weight, double h) {
    const double high = std::clamp(law.impedance[1], least_impedance, largest_impedance);
    const bool times = reference[0] > 0;  // a time constant: two steps at least
    const double time = times ? std::max(reference[0], 2 * h) : 0;
    k = times ? 1 / std::max(least, high * high * time * time * reference[1] * reference[1]) : -reference[0] / (high * high);
    b = reference[1] > 0 ? 2 / std::max(least, high * time) : -reference[1] / high;
    d = impedance(law, r), R = std::max(least, (1 - d) / d * weight);
  }
  double bias(double h, double error, double rate) const { return h * k * d * error - (1 - h * b) * rate; }
};

// Numbers of two shapes: those of higher priority, or a mean by their weights (solmix).
Compliance mixed(const Compliance& x, const Compliance& y) {
  const double share = x.mix > least && y.mix > least ? x.mix / (x.mix + y.mix) : x.mix > least ? 1 : y.mix > least ? 0 : 0.5;
  Compliance out = x;
  const bool times = x.reference[0] > 0 && y.reference[0] > 0;
  for (int k = 0; k < 2; ++k)
    out.reference[k] = times ? share * x.reference[k] + (1 - share) * y.reference[k] : std::min(x.reference[k], y.reference[k]);
  for (int k = 0; k < 5; ++k) out.impedance[k] = share * x.impedance[k] + (1 - share) * y.impedance[k];
  return out;
}

// Rows of a connect or weld as MuJoCo has them: each end is pulled at its own anchor, and a rotation's error is twice the
// vector x of its quaternion (w, x), whose rate is w omega + omega x x.
struct FileRows {
  MovingFrame<double> A, B;
  Vec3<double> x = Vec3<double>::zero();
  double w = 1;

  FileRows(const Model& m, const Data<double>& d, const ConstraintInstance<double>& s, const double* v, const double* a)
      : A(moving_frame(m, d, s.c.body2, s.c.X2, v, a)), B(moving_frame(m, d, s.c.body1, s.c.X1, v, a)) {
    if (a) A.a -= turned(m, d, s.c.body2, v), B.a -= turned(m, d, s.c.body1, v);
    if (s.c.type != DYN_CONSTRAINT_TYPE_WELD) return;
    const Quaternion<double> q = quaternion(transpose(A.R) * B.R);
    const double sign = q.w < 0 ? -1 : 1;
    x = q.v * sign, w = q.w * sign;
  }
  static bool are_of(const ConstraintInstance<double>& s) {
    return s.c.type == DYN_CONSTRAINT_TYPE_CONNECT || s.c.type == DYN_CONSTRAINT_TYPE_WELD;
  }
  Vec3<double> force(int i) const { return A.R * unit3<double>(i); }
  Vec3<double> moment(int i) const { return A.R * (unit3<double>(i) * w + cross(x, unit3<double>(i))); }
  // Acceleration of a free flyer whose velocity is constant in its own axes: a = 0 is one that is constant in the world's.
  static Vec3<double> turned(const Model& m, const Data<double>& d, Index body, const double* v) {
    if (body == 0) return Vec3<double>::zero();
    while (m.bodies()[body].parent != 0) body = m.bodies()[body].parent;
    const Body& b = m.bodies()[body];
    if (b.type != BodyType::FreeFlyer) return Vec3<double>::zero();
    return d.R[body] * cross(load3(v + b.idx_v + 3), load3(v + b.idx_v));
  }
  // Second rates of the errors: where a is zero, J' v.
  void second_rates(Index rows, double* out) const {
    for (int i = 0; i < 3; ++i) out[i] = dot(force(i), B.a - A.a);
    if (rows == 3) return;
    const Mat3<double> Rt = transpose(A.R);
    const Vec3<double> omega = Rt * (B.w - A.w), turning = Rt * (B.dw - A.dw - cross(A.w, B.w));
    const Vec3<double> dx = (omega * w + cross(omega, x)) * 0.5;
    const Vec3<double> rate = turning * w + cross(turning, x) + omega * (-0.5 * dot(omega, x)) + cross(omega, dx);
    for (int i = 0; i < 3; ++i) out[3 + i] = rate[i];
  }
};

struct AsFile {
  Island& x;
  const Model& m = x.m;
  Data<double>& d = x.d;
  const Workspace& w = x.w;

  Motion<double> velocity(Index body) const {
    return body_motion(m, d, body, x.v_before, static_cast<const double*>(nullptr)).V;
  }
  // Velocities of an instance's rows at the beginning of the step.
  void rates(const ConstraintInstance<double>& s, double* out) const {
    if (of_path(s.c) || of_ball(s.c)) {
      out[0] = box_rate(m, d, s, x.v_before);
    } else if (between_joints(s.c.type)) {
      out[0] = s.g1 * x.v_before[s.c.v1] + (s.c.body2 ? s.g2 * x.v_before[s.c.v2] : 0);
    } else {
      using Six = SixEights<double>;
      (Six::load(s.F1).dot(velocity(s.c.body1)) + Six::load(s.F2).dot(velocity(s.c.body2))).store(out);
    }
  }
  // A constraint that the caller made has MuJoCo's defaults and the inverse inertia of its own rows.
  struct Law {
    ComplianceRecord record;
    bool own = false;
  };
  Law law_of(const ActiveConstraint& a) const {
    const ConstraintInstance<double>& s = *a.s;
    const bool friction = s.c.type == DYN_CONSTRAINT_TYPE_FRICTION;
    if (friction) return {of_path(s.c) ? m.tendon_friction_compliances()[s.c.path - 1] : m.dof_compliances()[s.c.v1]};
    if (of_path(s.c)) {
      const Index path = s.c.path - 1;
      return {path < m.n.tendons ? m.tendon_compliances()[path] : m.coupling_compliances()[path - m.n.tendons]};
    }
    if (a.index >= 0) return {m.limit_compliances()[a.index]};
    const Index slot = Index(&s - d.slots);
    if (slot < m.n.constraints && s.c.type == m.constraints()[slot].spec.type) return {m.constraint_compliances()[slot]};
    return {{Compliance(), {0, 0}, 1, 0}, true};
  }
  // Largest entry of the diagonal of G of some rows.
  double largest_diagonal(const ActiveConstraint& a, Index first, Index end) const {
    const double* Dinv = inverse_pivots(m, d);
    const PropagatedRows of = x.rows_of(a);
    double most = 0;
    for (Index r = first; r < end; ++r) {
      double sum = 0;
      for (Index n = 0; n < a.support_count; ++n) sum += of.Y[row_lanes * n + r] * of.Y[row_lanes * n + r] * Dinv[of.support[n]];
      most = std::max(most, sum);
    }
    return most;
  }

  void equality(const ActiveConstraint& a) const {
    const ConstraintInstance<double>& s = *a.s;
    if (s.c.stiffness > 0 || s.c.damping > 0) return;  // the caller's gains
    const Law law = law_of(a);
    alignas(64) double rate[row_lanes], drift[row_lanes] = {};
    rates(s, rate);
    if (FileRows::are_of(s)) FileRows(m, d, s, x.v_before, d.zero).second_rates(s.rows, drift);
    const Index turns = s.c.type == DYN_CONSTRAINT_TYPE_WELD ? 3 : s.rows;  // the first row that is an angle
    const double scale = 0.5 * law.record.law.scale;  // MuJoCo's row is the vector of the quaternion, times torquescale
    double size = 0;
    for (Index r = 0; r < s.rows; ++r) size += s.error[r] * s.error[r] * (r < turns ? 1 : scale * scale);
    for (Index r = 0; r < s.rows; ++r) {
      const bool turn = r >= turns;
      const double weight = law.own ? largest_diagonal(a, turn ? turns : 0, turn ? s.rows : turns)
                                    : law.record.weight[turn] / (turn ? std::max(1e-12, scale * scale) : 1);
      set(s.first + r, Soft(law.record.law, law.record.law.reference, std::sqrt(size), weight, x.h), s.error[r], rate[r]);
      x.bias[s.first + r] += x.h * drift[r];
    }
  }
  // Dry friction of a joint or a tendon: what the caller made a constraint stays rigid.
  bool is_friction_of_file(const ActiveConstraint& a) const {
    const Index row = a.index - m.n.limits, path = a.s->c.path - 1;
    if (of_path(a.s->c)) return path < m.n.tendons && row == path_rows_of_tendon * path + 2;
    return a.s->c.type == DYN_CONSTRAINT_TYPE_FRICTION && a.s >= w.instances && a.s < w.instances + step_instances(m);
  }
  // A limit, or dry friction: it has no error.
  void limit(const ActiveConstraint& a, Index k) const {
    const ConstraintInstance<double>& s = *a.s;
    if (s.c.type != DYN_CONSTRAINT_TYPE_LIMIT && !is_friction_of_file(a)) return;
    if (s.c.type == DYN_CONSTRAINT_TYPE_LIMIT && s.error[0] >= 0) {
      x.lower[k] = x.upper[k] = x.lambda[a.first] = x.bias[a.first] = 0;
      return;
    }
    const Law law = law_of(a);
    alignas(64) double rate[row_lanes];
    rates(s, rate);
    const double weight = law.own ? largest_diagonal(a, 0, 1) : law.record.weight[0];
    set(a.first, Soft(law.record.law, law.record.law.reference, s.error[0], weight, x.h), s.error[0], rate[0]);
  }
  void contact(const ActiveConstraint& a, Index k) const {
    const ContactLaw& c = w.laws[a.index];
    const dynContact& point = w.contacts[a.index].contact;
    const ComplianceRecord &A = m.geom_compliances()[c.geom_a], &B = m.geom_compliances()[c.geom_b];
    const Index own = point.pair >= 0 ? m.pairs()[point.pair].material() : 0;
    const int first = w.materials[c.geom_a].priority, second = w.materials[c.geom_b].priority;
    const Compliance law = own              ? m.material_compliances()[own - 1].law
                           : first > second ? A.law
                           : first < second ? B.law
                                            : mixed(A.law, B.law);
    const double weight = A.weight[0] + B.weight[0], gap = point.distance, mu = c.material.friction;
    const Index normal = normal_row(a.rows);
    // pyramid: each of 2 (rows - 1) edges n + mu t has R = 2 mu^2 / ratio R0, and R0 counts mu
    const bool pyramid = A.pyramidal != 0 && a.rows > 1;
    const Soft soft(law, law.reference, gap, pyramid ? weight * (1 + mu * mu) : weight, x.h);
    const bool has_across = law.across[0] != 0 || law.across[1] != 0;
    const Soft across(law, has_across && !pyramid ? law.across : law.reference, gap, weight, x.h);
    alignas(64) double rate[row_lanes];
    rates(contact_wrenches(m, d, a), rate);
    for (Index r = 0; r < a.rows; ++r) {
      const Index i = a.first + r;
      if (r == normal) {
        set(i, soft, gap, rate[r]);
        if (pyramid) x.compliance[i] *= mu * mu / (A.ratio * double(a.rows - 1));
        continue;
      }
      const double own_mu = r < 2 ? mu : r == a.rows - 1 ? c.material.torsion : c.material.rolling;
      set(i, across, 0, rate[r] + (r < 2 ? c.slip[r] : 0));
      x.compliance[i] = soft.R / A.ratio * mu * mu / (own_mu * own_mu);
    }
    x.restitution[k] = 0;
  }
  void set(Index i, const Soft& soft, double error, double rate) const {
    x.compliance[i] = soft.R, x.bias[i] = soft.bias(x.h, error, rate);
  }
};

}  // namespace

void keep_touching(const Model& m, Workspace& w) {
  Index count = 0;
  for (Index k = 0; k < w.contact_count; ++k) {
    dynContact& c = w.contacts[k].contact;
    const double a = m.geom_compliances()[w.laws[k].geom_a].law.margin, b = m.geom_compliances()[w.laws[k].geom_b].law.margin;
    const Index own = c.pair >= 0 ? m.pairs()[c.pair].material() : 0;
    // surfaces are raised by the shapes' margins, and a pair's own may be less; the point is in the middle between the real ones
    if (own) c.distance += std::max(0.0, a + b - m.material_compliances()[own - 1].law.margin);
    if (!(c.distance < 0)) continue;
    for (int i = 0; i < 3; ++i) c.position[i] -= 0.5 * (a - b) * c.normal[i];
    w.contacts[count] = w.contacts[k], w.laws[count] = w.laws[k];
    ContactLaw& law = w.laws[count++];
    law.idle = false, law.material.restitution = law.material.stiffness = law.material.damping = 0;
  }
  w.contact_count = count;
}

void set_file_rows(const Model& m, const Data<double>& d, ConstraintInstance<double>& s, const double* v) {
  if (!FileRows::are_of(s)) return;
  const FileRows rows(m, d, s, v, nullptr);
  const Vec3<double> none = Vec3<double>::zero();
  for (int i = 0; i < 3; ++i) {
    const Vec3<double> force = rows.force(i), moment = rows.moment(i);
    if (s.c.body2) store_lane(Force<double>{-force, -cross(rows.A.x, force)}, s.F2, i);
    s.rate[i] = dot(force, rows.B.v - rows.A.v);
    if (s.rows == 3) continue;
    if (s.c.body1) store_lane(Force<double>{none, moment}, s.F1, 3 + i);
    if (s.c.body2) store_lane(Force<double>{none, -moment}, s.F2, 3 + i);
    s.error[3 + i] = 2 * rows.x[i], s.rate[3 + i] = dot(moment, rows.B.w - rows.A.w);
  }
}

void Island::fill_as_file() {
  const AsFile as{*this};
  for (Index k = 0, in_boxes = 0, in_contacts = 0; k < constraint_count; ++k) {
    const ActiveConstraint& a = constraint(k);
    if (a.kind == RowKind::Equality) as.equality(a);
    else if (a.kind == RowKind::Box) as.limit(a, in_boxes++);
    else as.contact(a, in_contacts++);
  }
}

}  // namespace dyn::simulation
