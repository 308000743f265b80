// What users say of a constraint: checked, and turned into what the algorithms read.
#include <algorithm>
#include <cstdarg>

#include "base/format.hpp"
#include "model/constraints.hpp"

namespace dyn {

namespace {

// A message of printf's format; the status.
struct Refusal {
  char* message;
  std::size_t room;
  dynStatus operator()(dynStatus status, const char* format, ...) const __attribute__((format(printf, 3, 4))) {
    va_list args;
    va_start(args, format);
    vwrite_text(message, room, format, args);
    va_end(args);
    return status;
  }
};

bool finite(const double* x, int n) {
  return std::all_of(x, x + n, [](double e) { return std::isfinite(e); });
}

// A rotation to within what text of six digits gives.
bool placed(const double* x) {
  const Mat3<double> R = load33(x);
  const Mat3<double> off = times_transpose(R, R) - Mat3<double>::identity();
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      if (!(std::abs(off(r, c)) < 1e-5)) return false;
  return dot(cross(R.x, R.y), R.z) > 0;
}

Vec3<double> unit(const double* x) {
  const Vec3<double> a = load3(x);
  const Vec3<double> s = sizes(a);
  const double most = std::max({s[0], s[1], s[2]});
  const Vec3<double> b = a * (1 / most);
  return b * (1 / std::sqrt(dot(b, b)));
}

// The nearest rotation to one that is written with few digits, to first order and then exactly.
Mat3<double> orthonormal(const Mat3<double>& R) {
  const Vec3<double> x = R.x * (1 / std::sqrt(dot(R.x, R.x))), y = R.y - x * dot(x, R.y), u = y * (1 / std::sqrt(dot(y, y)));
  return {x, u, cross(x, u)};
}

const char* joint_name(const Model& m, Index joint) { return m.string(m.joints()[joint].name); }

}  // namespace

dynConstraint default_constraint(dynConstraintType type) {
  dynConstraint c{};
  c.struct_size = sizeof c;
  c.type = type;
  for (double* X : {c.placement1, c.placement2}) X[0] = X[4] = X[8] = 1;
  c.joint_type = DYN_JOINT_TYPE_REVOLUTE;
  c.axis[2] = c.axis2[0] = 1;
  c.length = 1;
  c.coefficients[1] = 1;
  c.damping = type == DYN_CONSTRAINT_TYPE_FRICTION ? 100 : 0;
  c.enabled = 1;
  return c;
}

dynStatus check_constraint_numbers(const dynConstraint& s, char* message, std::size_t room) {
  const Refusal refuse{message, room};
  bool known = s.type == DYN_CONSTRAINT_TYPE_NONE;
  const auto is_known = [&]<class K>() { known = true; };
  visit_frame_constraint(s.type, is_known), visit_joint_constraint(s.type, is_known);
  if (!known) return refuse(DYN_ERROR_ARGUMENT, "type %d does not exist: use a constraint type", int(s.type));
  const struct {
    const char* name;
    const double* x;
    int n;
  } numbers[] = {{"placement1", s.placement1, 12},
                 {"placement2", s.placement2, 12},
                 {"axis", s.axis, 3},
                 {"axis2", s.axis2, 3},
                 {"pitch", &s.pitch, 1},
                 {"length", &s.length, 1},
                 {"coefficients", s.coefficients, 5},
                 {"force", &s.force, 1},
                 {"stiffness", &s.stiffness, 1},
                 {"damping", &s.damping, 1},
                 {"restitution", &s.restitution, 1}};
  for (const auto& x : numbers)
    if (!finite(x.x, x.n)) return refuse(DYN_ERROR_NONFINITE, "%s is not finite: give finite numbers", x.name);
  if (s.stiffness < 0) return refuse(DYN_ERROR_ARGUMENT, "stiffness is %g: give 0 or more", s.stiffness);
  if (s.damping < 0) return refuse(DYN_ERROR_ARGUMENT, "damping is %g: give 0 or more", s.damping);
  if (s.restitution < 0 || s.restitution > 1) return refuse(DYN_ERROR_ARGUMENT, "restitution is %g: give 0 to 1", s.restitution);
  if (s.type == DYN_CONSTRAINT_TYPE_NONE) return DYN_OK;
  if (!between_joints(s.type)) {
    if (!placed(s.placement1)) return refuse(DYN_ERROR_ARGUMENT, "placement1 has no rotation: start from the default constraint");
    if (!placed(s.placement2)) return refuse(DYN_ERROR_ARGUMENT, "placement2 has no rotation: start from the default constraint");
  }
  if (s.type == DYN_CONSTRAINT_TYPE_DISTANCE && !(s.length > 0))
    return refuse(DYN_ERROR_ARGUMENT, "length is %g: give more than 0, or use CONNECT", s.length);
  if (s.type == DYN_CONSTRAINT_TYPE_FRICTION && s.force < 0)
    return refuse(DYN_ERROR_ARGUMENT, "force is %g: give 0 or more", s.force);
  if (s.type == DYN_CONSTRAINT_TYPE_LOOP) {
    if (constraint::Loop::rows(s.joint_type) == 0)
      return refuse(DYN_ERROR_ARGUMENT,
                    "joint_type is %d: a loop needs a simple joint with 1 to 5 degrees of freedom; for FIXED use the type WELD",
                    int(s.joint_type));
    const Vec3<double> none = Vec3<double>::zero();
    if (is_zero(Motion<double>{load3(s.axis), none})) return refuse(DYN_ERROR_INVALID, "axis is zero: give a direction");
    if (s.joint_type == DYN_JOINT_TYPE_UNIVERSAL) {
      if (is_zero(Motion<double>{load3(s.axis2), none})) return refuse(DYN_ERROR_INVALID, "axis2 is zero: give a direction");
      if (std::abs(dot(unit(s.axis), unit(s.axis2))) > 1 - 1e-9)
        return refuse(DYN_ERROR_INVALID, "axis and axis2 are parallel: give two different directions");
    }
  }
  return DYN_OK;
}

dynStatus check_constraint(const Model& m, const dynConstraint& s, char* message, std::size_t room) {
  const Refusal refuse{message, room};
  if (const dynStatus status = check_constraint_numbers(s, message, room)) return status;
  if (s.type == DYN_CONSTRAINT_TYPE_NONE) return DYN_OK;
  const bool two = !between_joints(s.type) || (s.type == DYN_CONSTRAINT_TYPE_COUPLING && s.second != 0);
  if (!between_joints(s.type)) {
    for (const int frame : {s.first, s.second})
      if (frame < 0 || frame >= m.n.frames)
        return refuse(DYN_ERROR_ARGUMENT, "frame %d does not exist: the model has frames 0 to %d", frame, int(m.n.frames) - 1);
    const FrameRecord &a = m.frames()[s.first], &b = m.frames()[s.second];
    if (a.body == b.body)
      return refuse(DYN_ERROR_INVALID, "first, '%s', and second, '%s', are on the same body: nothing can move between them",
                    m.string(a.name), m.string(b.name));
    return DYN_OK;
  }
  for (const int joint : {s.first, two ? s.second : s.first}) {
    if (joint < 1 || joint >= m.n.joints)
      return refuse(DYN_ERROR_ARGUMENT, "joint %d does not exist: the model has joints 1 to %d", joint, int(m.n.joints) - 1);
    const JointRecord& j = m.joints()[joint];
    if (j.leader >= 0)
      return refuse(DYN_ERROR_INVALID, "joint '%s' mimics '%s': constrain '%s'", joint_name(m, joint), joint_name(m, j.leader),
                    joint_name(m, j.leader));
    if (j.nq != 1 || j.nv != 1)
      return refuse(DYN_ERROR_INVALID, "joint '%s' has %d coordinates: choose a joint with one", joint_name(m, joint), int(j.nq));
  }
  if (two && s.first == s.second) return refuse(DYN_ERROR_INVALID, "joint '%s' is coupled with itself", joint_name(m, s.first));
  if (s.type == DYN_CONSTRAINT_TYPE_LIMIT) {
    const Index q = m.joints()[s.first].idx_q;
    if (!std::isfinite(m.lower_limit()[q]) && !std::isfinite(m.upper_limit()[q]))
      return refuse(DYN_ERROR_INVALID, "joint '%s' has no limits", joint_name(m, s.first));
  }
  return DYN_OK;
}

Constraint resolve_constraint(const Model& m, const dynConstraint& s) {
  Constraint c{};
  c.X1 = c.X2 = SE3<double>::identity();
  c.axis = c.n1 = c.n2 = c.axis2 = Vec3<double>::zero();
  c.type = s.type;
  if (s.type == DYN_CONSTRAINT_TYPE_NONE) return c;
  c.stiffness = s.stiffness, c.damping = s.damping, c.restitution = s.restitution;
  if (between_joints(s.type)) {
    auto coordinate = [&](int joint, Index& body, Index& q, Index& v) {
      const JointRecord& j = m.joints()[joint];
      body = j.last_body, q = j.idx_q, v = m.bodies()[body].idx_v;
    };
    coordinate(s.first, c.body1, c.q1, c.v1);
    if (s.type == DYN_CONSTRAINT_TYPE_COUPLING && s.second != 0) coordinate(s.second, c.body2, c.q2, c.v2);
    c.lower = m.lower_limit()[c.q1], c.upper = m.upper_limit()[c.q1];
    c.force = s.force;
    std::copy(s.coefficients, s.coefficients + 5, c.coefficients);
    return c;
  }
  const FrameRecord &a = m.frames()[s.first], &b = m.frames()[s.second];
  auto place = [](const FrameRecord& f, const double* x) {
    const SE3<double> X = load_se3(x);
    return f.X * SE3<double>{orthonormal(X.R), X.p};
  };
  c.body1 = a.body, c.body2 = b.body;
  c.X1 = place(a, s.placement1), c.X2 = place(b, s.placement2);
  c.length = s.length, c.pitch = s.pitch, c.joint_type = s.joint_type;
  if (s.type == DYN_CONSTRAINT_TYPE_LOOP) {
    c.axis = unit(s.axis);
    // across the axis: of the axes of A, the one that leans most away from it
    const Vec3<double> size = sizes(c.axis);
    const int away = size[0] <= size[1] && size[0] <= size[2] ? 0 : size[1] <= size[2] ? 1 : 2;
    const Vec3<double> across = cross(c.axis, unit3<double>(away));
    c.n1 = across * (1 / std::sqrt(dot(across, across)));
    c.n2 = cross(c.axis, c.n1);
    if (s.joint_type == DYN_JOINT_TYPE_UNIVERSAL) c.axis2 = unit(s.axis2);
  }
  return c;
}

}  // namespace dyn
