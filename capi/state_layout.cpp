#include "state_layout.hpp"
#include "reflection.hpp"

#include <algorithm>

#include "table/names.hpp"

namespace dyn::capi {

namespace {

constexpr const char* function = "dyn_state_layout_convert";
constexpr int some = 4096;  // of joints or coordinates at a time: no heap

}  // namespace

Layout::Layout(const dynModel* model, const dynStateLayout* layout) {
  if ((status = check(model)) != DYN_OK) return;
  m = model->m.get();
  status = read(model, layout);
  if (status == DYN_OK) status = place();
  if (status == DYN_OK) status = complete();
  if (status == DYN_OK) status = disjoint(true);
  if (status == DYN_OK) status = disjoint(false);
}

peer::Ends Layout::ends(Index joint) const {
  const JointRecord& r = m->joints()[joint];
  peer::Ends e = {SE3<double>::identity(), SE3<double>::identity(), true};
  if (r.type != DYN_JOINT_TYPE_FREE_FLYER) return e;
  const bool of_joint = l.convention == DYN_CONVENTION_DYN || l.convention == DYN_CONVENTION_PINOCCHIO;
  if (r.parent == 0 && !of_joint) e.start = load_se3(r.placement);
  if (child >= 0 && m->frames()[child].joint == joint) e.frame = load_se3(m->frames()[child].placement);
  auto identity = [](const SE3<double>& X) {
    double x[12];
    store_se3(X, x);
    static constexpr double unit[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    return std::equal(x, x + 12, unit);
  };
  e.trivial = identity(e.start) && identity(e.frame);
  return e;
}

peer::Form Layout::form(const Body& b) const {
  using peer::Form;
  const bool pair =
      l.continuous == DYN_ANGLE_COS_SIN || (l.continuous == DYN_ANGLE_BY_CONVENTION && l.convention == DYN_CONVENTION_PINOCCHIO);
  const bool as_ours = l.continuous == DYN_ANGLE_BY_CONVENTION && l.convention == DYN_CONVENTION_DYN;
  const bool mujoco = l.convention == DYN_CONVENTION_MUJOCO, drake = l.convention == DYN_CONVENTION_DRAKE;
  switch (b.type) {
    case BodyType::Revolute: return b.wraps && pair ? Form::CosSin : Form::Same;
    case BodyType::RevoluteUnbounded: return pair || as_ours ? Form::Same : Form::Angle;
    case BodyType::Spherical: return mujoco ? Form::Ball : drake ? Form::RollPitchYaw : Form::Same;
    case BodyType::FreeFlyer: return mujoco ? Form::FreeMixed : drake ? Form::FreeWorld : Form::FreeBody;
    default: return Form::Same;
  }
}

peer::Size Layout::size(Index joint) const {
  peer::Size sum = {0, 0};
  parts(joint, [&](peer::Form form, peer::Size ours) {
    const peer::Size n = peer::size(form, ours);
    sum.nq += n.nq, sum.nv += n.nv;
  });
  return sum;
}

dynStatus Layout::read(const dynModel* model, const dynStateLayout* layout) {
  if (!layout) return fail(DYN_ERROR_ARGUMENT, "%s: layout is NULL: fill one with dyn_state_layout_init", function);
  const Given<dynStateLayout> given(function, layout);
  if (given.status != DYN_OK) return given.status;
  handle = model, l = *given;
  if (const dynStatus s = check_value(l.convention, function, "convention")) return s;
  if (const dynStatus s = check_value(l.continuous, function, "continuous")) return s;
  if (l.joints_count && !l.joints) return fail(DYN_ERROR_ARGUMENT, "%s: joints is NULL but joints_count is not 0", function);
  if (!l.idx_q != !l.idx_v)
    return fail(DYN_ERROR_ARGUMENT, "%s: idx_q and idx_v go together: %s is NULL", function, l.idx_q ? "idx_v" : "idx_q");
  if (l.idx_q && !l.joints)
    return fail(DYN_ERROR_ARGUMENT, "%s: idx_q is given without joints: name the joints that it is of", function);
  if (l.nq < 0 || l.nv < 0)
    return fail(DYN_ERROR_SIZE, "%s: nq is %d and nv %d: they can't be negative", function, int(l.nq), int(l.nv));
  for (std::size_t k = 0; l.joints && k < l.joints_count; ++k) {
    if (!l.joints[k]) return fail(DYN_ERROR_ARGUMENT, "%s: joints[%zu] is NULL", function, k);
    const int id = dyn_model_joint_id(model, l.joints[k]);
    if (id < 0) return DYN_ERROR_NAME;
    if (id == 0) return fail(DYN_ERROR_NAME, "%s: the universe has no coordinates: leave it out", function);
  }
  if (!l.child_frame) return DYN_OK;
  child = dyn_model_frame_id(model, l.child_frame);
  if (child < 0) return DYN_ERROR_NAME;
  if (const Index j = m->frames()[child].joint; m->joints()[j].type != DYN_JOINT_TYPE_FREE_FLYER)
    return fail(
        DYN_ERROR_ARGUMENT,
        "%s: child_frame '%.200s' is carried by joint '%.200s', which is no free flyer: name a frame of the floating base",
        function, l.child_frame, name(j));
  return DYN_OK;
}

dynStatus Layout::place() {
  std::int64_t end_q = 0, end_v = 0;
  const dynStatus s = each([&](const Item& x) {
    const peer::Size n = size(x.joint);
    const JointRecord& r = m->joints()[x.joint];
    if (l.convention == DYN_CONVENTION_ROS && r.type != DYN_JOINT_TYPE_FREE_FLYER && n.nv != 1)
      return fail(DYN_ERROR_UNSUPPORTED,
                  "%s: joint '%.200s' (%s) has %d degrees of freedom: sensor_msgs/JointState holds joints of one", function,
                  name(x.joint), name_of(r.type), n.nv);
    if (x.q < 0 || x.v < 0)
      return fail(DYN_ERROR_ARGUMENT, "%s: joint '%.200s' begins at q[%d], v[%d]: indices can't be negative", function,
                  name(x.joint), int(x.q), int(x.v));
    if ((l.nq && x.q + n.nq > l.nq) || (l.nv && x.v + n.nv > l.nv))
      return fail(DYN_ERROR_SIZE, "%s: joint '%.200s' ends before q[%lld], v[%lld], but the peer's nq is %d and nv %d", function,
                  name(x.joint), static_cast<long long>(x.q + n.nq), static_cast<long long>(x.v + n.nv), int(l.nq), int(l.nv));
    end_q = std::max(end_q, x.q + n.nq), end_v = std::max(end_v, x.v + n.nv);
    return DYN_OK;
  });
  sizes[0] = l.nq ? l.nq : end_q, sizes[1] = l.nv ? l.nv : end_v;
  return s;
}

dynStatus Layout::complete() const {
  for (Index first = 1; l.joints && first < m->n.joints; first += some) {
    bool seen[some] = {};
    const dynStatus s = each([&](const Item& x) {
      const std::int64_t k = std::int64_t(x.joint) - first;
      if (k < 0 || k >= some) return DYN_OK;
      if (seen[k])
        return fail(DYN_ERROR_NAME, "%s: joint '%.200s' is named twice: name each joint once", function, name(x.joint));
      seen[k] = true;
      return DYN_OK;
    });
    if (s != DYN_OK) return s;
    for (Index j = first; j < m->n.joints && j - first < some; ++j)
      if (!seen[j - first] && !follows(j))
        return fail(DYN_ERROR_NAME, "%s: the peer's joints leave out '%.200s': name every joint that moves by itself", function,
                    name(j));
  }
  return DYN_OK;
}

dynStatus Layout::disjoint(bool of_q) const {
  for (std::int64_t first = 0; l.idx_q && first < sizes[of_q ? 0 : 1]; first += some) {
    Index owner[some] = {};
    const dynStatus s = each([&](const Item& x) {
      const peer::Size n = size(x.joint);
      const std::int64_t begin = of_q ? x.q : x.v, end = begin + (of_q ? n.nq : n.nv);
      for (std::int64_t k = std::max(begin, first); k < std::min(end, first + some); ++k) {
        if (const Index other = owner[k - first])
          return fail(DYN_ERROR_ARGUMENT, "%s: joints '%.200s' and '%.200s' both have %s[%lld]", function, name(other),
                      name(x.joint), of_q ? "q" : "v", static_cast<long long>(k));
        owner[k - first] = x.joint;
      }
      return DYN_OK;
    });
    if (s != DYN_OK) return s;
  }
  return DYN_OK;
}

}  // namespace dyn::capi
