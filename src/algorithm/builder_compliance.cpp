// Inverse inertias of compliances, as MuJoCo's regularisation has them: at the initial configuration, J M^-1 J^T of a limit, a
// joint or a tendon, and the mean over three directions of forces and of moments at a link's centre of mass.
#include <algorithm>
#include <cmath>
#include <new>

#include "algorithm/constrained/constrained_dynamics.hpp"
#include "algorithm/constrained/path_row.hpp"
#include "algorithm/paths.hpp"
#include "model/block.hpp"
#include "model/builder_impl.hpp"

namespace dyn {

namespace {

// Of models without mimic joints.
class InverseInertia {
 public:
  explicit InverseInertia(const Model& m)
      : m_(m),
        data_(data_bytes<double>(m, DYN_PART_CONSTRAINTS)),
        rows_(sizeof(double) * row_lanes * std::size_t(m.n.nvx)),
        support_(std::size_t(m.n.nvx)) {
    if (!data_.memory || !rows_.memory) throw std::bad_alloc();
    data_layout(m, DYN_PART_CONSTRAINTS, data_.memory, d_);
    forward_kinematics<0>(m, d_);
    if (m.n.paths > 0) measure_paths(m, d_);
    defined_ = constraint_factor(m, d_) == 0;
  }
  // Whether forward dynamics is defined.
  explicit operator bool() const { return defined_; }

  double of_dof(Index dof) {
    ConstraintInstance<double> s = row(DYN_CONSTRAINT_TYPE_LIMIT);
    s.c.body1 = 1, s.c.v1 = dof;
    double out[row_lanes];
    diagonal(s, out);
    return out[0];
  }
  // Mean over the degrees of freedom of a joint.
  double of_joint(Index joint) { return mean(joint, 0, m_.joints()[joint].nv); }
  // Of a joint's degree of freedom: the mean over the three translations or rotations that it is one of.
  double of_dof_of(Index joint, Index k) {
    const Index nv = m_.joints()[joint].nv;
    return nv % 3 == 0 ? mean(joint, k / 3 * 3, 3) : mean(joint, k, 1);
  }
  double of_tendon(Index tendon) {
    if (m_.paths()[tendon].dofs == 0) return 0;
    ConstraintInstance<double> s = row(DYN_CONSTRAINT_TYPE_LIMIT);
    s.c.path = tendon + 1;
    double out[row_lanes];
    diagonal(s, out);
    return out[0];
  }
  // Of forces and moments at the centre of mass of the link that a frame is on.
  std::array<double, 2> of_link(Index frame) {
    const FrameRecord& f = m_.frames()[frame];
    if (f.body == 0) return {0, 0};
    if (f.link < 0 && f.parent > 0) return of_link(f.parent);
    if (slides_along_axes(f)) return {1 / m_.links()[f.link].mass, 0};
    const Vec3<double> at = f.X.act(f.link < 0 ? Vec3<double>::zero() : load3(m_.links()[f.link].com)),
                       arm = d_.rel[f.body] + d_.R[f.body] * at;
    ConstraintInstance<double> s = row(DYN_CONSTRAINT_TYPE_POINT);
    s.rows = 6, s.c.body1 = f.body;
    for (int k = 0; k < 3; ++k) {
      const Vec3<double> axis = unit3<double>(k);
      store_lane(Force<double>{axis, cross(arm, axis)}, s.F1, k);
      store_lane(Force<double>{Vec3<double>::zero(), axis}, s.F1, 3 + k);
    }
    double out[row_lanes];
    diagonal(s, out);
    return {(out[0] + out[1] + out[2]) / 3, (out[3] + out[4] + out[5]) / 3};
  }

 private:
  double mean(Index joint, Index first, Index count) {
    double sum = 0;
    for (Index k = first; k < first + count; ++k) sum += of_dof(m_.joints()[joint].idx_v + k);
    return count > 0 ? sum / double(count) : 0;
  }
  // What MuJoCo takes for a free mass: a link of its own that slides along its axes alone, with its centre of mass at the origin.
  bool slides_along_axes(const FrameRecord& f) const {
    if (f.link < 0 || m_.subtree_end()[f.body] != f.body + 1) return false;
    const LinkRecord& link = m_.links()[f.link];
    if (!(link.mass > 0) || link.mass != m_.bodies()[f.body].m || dot(load3(link.com), load3(link.com)) > 0) return false;
    const Mat3<double> R = d_.R[f.body] * f.X.R;
    for (Index i = f.body; i != 0; i = m_.bodies()[i].parent) {
      const Body& b = m_.bodies()[i];
      if (b.type != BodyType::Prismatic) return false;
      const Vec3<double> axis = transpose(R) * d_.S[b.idx_v].linear;
      if (std::max({std::abs(axis[0]), std::abs(axis[1]), std::abs(axis[2])}) < 1 - 1e-12) return false;
    }
    return true;
  }
  static ConstraintInstance<double> row(dynConstraintType type) {
    ConstraintInstance<double> s{};
    s.c.type = type, s.rows = 1, s.g1 = 1;
    return s;
  }
  void diagonal(ConstraintInstance<double>& s, double* out) {
    double* const Y = static_cast<double*>(rows_.memory);
    if (of_path(s.c)) propagate_path(m_, d_, s, support_.data(), Y);
    else propagate(m_, d_, s, support_.data(), Y);
    std::fill_n(out, row_lanes, 0.0);
    for (Index n = 0; n < s.support_count; ++n)
      for (Index r = 0; r < s.rows; ++r) {
        const double y = Y[row_lanes * n + r];
        out[r] += y * y * d_.Dinv[support_[std::size_t(n)]];
      }
  }

  const Model& m_;
  Zeros data_, rows_;
  std::vector<Index> support_;
  Data<double> d_;
  bool defined_ = false;
};

}  // namespace

void settle_compliances(Model& m) {
  InverseInertia of(m);
  if (!of) return;
  auto* x = const_cast<ComplianceRecord*>(m.compliances());
  const auto set = [&](const std::array<double, 2>& weight) { x->weight[0] = weight[0], x->weight[1] = weight[1], ++x; };
  for (Index k = 0; k < m.n.geoms; ++k) set(of.of_link(m.shapes()[m.geoms()[k].shape].frame));
  for (Index k = 0; k < m.n.limits; ++k) set({of.of_joint(m.bodies()[m.limits()[k].body].joint), 0});
  for (Index k = 0; k < m.n.constraints; ++k) {
    const dynConstraint& c = m.constraints()[k].spec;
    const bool joints = between_joints(c.type);
    const auto end = [&](Index at) {
      return at <= 0 ? std::array<double, 2>{0, 0} : joints ? std::array<double, 2>{of.of_joint(at), 0} : of.of_link(at);
    };
    const auto a = end(c.first), b = end(c.second);
    set({a[0] + b[0], a[1] + b[1]});
  }
  for (Index k = 0; k < m.n.tendons; ++k) set({of.of_tendon(k), 0});
  for (Index k = 0; k < m.n.couplings; ++k) {
    const PathRecord& p = m.paths()[m.n.tendons + k];
    set({of.of_tendon(p.first) + (p.elements >= 0 ? of.of_tendon(p.elements) : 0), 0});
  }
  x += m.n.materials;  // weights of contacts are those of their shapes
  for (Index j = 1; j < m.n.joints; ++j)
    for (Index k = 0; k < m.joints()[j].nv; ++k) set({of.of_dof_of(j, k), 0});
  for (Index k = 0; k < m.n.tendons; ++k) set({of.of_tendon(k), 0});
}

}  // namespace dyn
