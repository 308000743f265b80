// Tendons, their couplings, and what else actuators act through.
#include <algorithm>
#include <cmath>
#include <set>

#include "builder_compile.hpp"
#include "table/enums.hpp"

namespace dyn {

namespace {

using Type = dynTendonElementType;

bool is_wrap(Type t) { return t == DYN_TENDON_ELEMENT_TYPE_SPHERE || t == DYN_TENDON_ELEMENT_TYPE_CYLINDER; }

void check_name(const std::string& name, const char* what) {
  if (name.empty()) refuse(DYN_ERROR_ARGUMENT, std::string(what) + " has no name: give one");
  if (name.find('\0') != std::string::npos)
    refuse(DYN_ERROR_ARGUMENT, std::string(what) + " '" + std::string(name.c_str()) + "': the name holds a zero byte");
}

void check_coefficient(const std::string& who, const char* what, double x) {
  if (!std::isfinite(x)) refuse(DYN_ERROR_NONFINITE, who + ": " + what + " is " + number(x) + ": give a finite number");
  if (x < 0) refuse(DYN_ERROR_INVALID, who + ": " + what + " is " + number(x) + ": it can't be negative");
}

// Sites, a wrap between two of them at most, branches of two sites at least.
void check_branches(const std::string& who, const std::vector<TendonElement>& elements) {
  std::size_t sites = 0;
  bool wraps = false;
  const auto end_branch = [&](const std::string& where) {
    if (wraps) refuse(DYN_ERROR_INVALID, who + ": a wrap stands before " + where + ": a site must follow it");
    if (sites < 2) refuse(DYN_ERROR_INVALID, who + ": a branch before " + where + " has fewer than two sites");
    sites = 0;
  };
  for (std::size_t k = 0; k < elements.size(); ++k) {
    const Type t = elements[k].type;
    if (t == DYN_TENDON_ELEMENT_TYPE_SITE) {
      ++sites, wraps = false;
    } else if (is_wrap(t)) {
      if (sites == 0 || wraps)
        refuse(DYN_ERROR_INVALID, who + ": element " + std::to_string(k) + " wraps: a site must precede it");
      wraps = true;
    } else if (k > 0) {
      end_branch("element " + std::to_string(k));
    }
  }
  end_branch("the end");
}

}  // namespace

void check_tendon_numbers(const std::string& who, const dynTendon& t) {
  if (!is_value(t.type)) refuse(DYN_ERROR_ARGUMENT, who + ": type " + std::to_string(int(t.type)) + " is no dynTendonType");
  check_coefficient(who, "stiffness", t.stiffness), check_coefficient(who, "damping", t.damping);
  check_coefficient(who, "friction", t.friction), check_coefficient(who, "armature", t.armature);
  if (std::isnan(t.rest[0]) != std::isnan(t.rest[1]) || std::isinf(t.rest[0]) || std::isinf(t.rest[1]) || t.rest[0] > t.rest[1])
    refuse(DYN_ERROR_INVALID, who + ": rest is [" + number(t.rest[0]) + ", " + number(t.rest[1]) +
                                  "]: give a lower end, then an upper one, or two NaN");
  if (!(t.range[0] <= t.range[1]) || t.range[0] == HUGE_VAL || t.range[1] == -HUGE_VAL)
    refuse(DYN_ERROR_INVALID, who + ": range is [" + number(t.range[0]) + ", " + number(t.range[1]) +
                                  "]: give a lower end, then an upper one");
}

void Builder::Impl::check_tendon_name(const std::string& name) const {
  check_name(name, "tendon");
  if (names.tendons.find(tendons, name) >= 0)
    refuse(DYN_ERROR_NAME, "tendon '" + name + "' is there already: choose another name");
}
void Builder::Impl::check_coupling_name(const std::string& name) const {
  check_name(name, "coupling of tendons");
  if (names.couplings.find(couplings, name) >= 0)
    refuse(DYN_ERROR_NAME, "coupling '" + name + "' is there already: choose another name");
}
int Builder::Impl::find_frame(const std::string& name, const std::string& who) const {
  if (!frame_index.contains(name)) refuse(DYN_ERROR_NAME, who + ": there is no frame '" + name + "': add it first");
  return find({name, 0}, who);
}
int Builder::Impl::find_tendon(const std::string& name, const std::string& who) const {
  if (const int k = names.tendons.find(tendons, name); k >= 0) return k;
  refuse(DYN_ERROR_NAME, who + ": there is no tendon '" + name + "': add it first");
}

void Builder::tendon(const std::string& name, const dynTendon& spec, const std::vector<TendonElement>& elements,
                     const Compliance& compliance, const Compliance& friction) {
  impl->check_tendon_name(name);
  const std::string who = "tendon '" + name + "'";
  check_tendon_numbers(who, spec);
  if (elements.empty()) refuse(DYN_ERROR_INVALID, who + ": it has no element");
  TendonEntry entry{name, spec, {}, compliance, friction};
  for (std::size_t k = 0; k < elements.size(); ++k) {
    const TendonElement& e = elements[k];
    const std::string at = who + ": element " + std::to_string(k);
    if (!is_value(e.type))
      refuse(DYN_ERROR_ARGUMENT, at + ": type " + std::to_string(int(e.type)) + " is no dynTendonElementType");
    const bool joint = e.type == DYN_TENDON_ELEMENT_TYPE_JOINT, pulley = e.type == DYN_TENDON_ELEMENT_TYPE_PULLEY;
    if (joint != (spec.type == DYN_TENDON_TYPE_FIXED))
      refuse(DYN_ERROR_INVALID, at + (joint ? " is a joint: only FIXED tendons have those"
                                              : " is no joint: FIXED tendons have nothing else"));
    if (!std::isfinite(e.value)) refuse(DYN_ERROR_NONFINITE, at + ": value is " + number(e.value) + ": give a finite number");
    if ((pulley || is_wrap(e.type)) && !(e.value > 0))
      refuse(DYN_ERROR_INVALID, at + ": value is " + number(e.value) + ": it must be positive");
    if (pulley != e.name.empty()) refuse(DYN_ERROR_ARGUMENT, at + (pulley ? ": a pulley has no name" : ": it has no name"));
    if (!e.side.empty() && !is_wrap(e.type)) refuse(DYN_ERROR_ARGUMENT, at + ": only spheres and cylinders have a side");
    TendonElementEntry out{e.type, -1, -1, e.value};
    if (joint) {
      out.id = impl->find_joint(e.name);
      if (out.id < 0) refuse(DYN_ERROR_NAME, at + ": there is no moving joint '" + e.name + "'");
      if (const int nq = spec_nq(impl->joints[std::size_t(out.id)].spec); nq != 1)
        refuse(DYN_ERROR_INVALID,
               at + ": joint '" + e.name + "' has " + std::to_string(nq) + " coordinates: one is needed");
    } else if (!pulley) {
      out.id = impl->find_frame(e.name, at);
      if (!e.side.empty()) out.side = impl->find_frame(e.side, at);
    }
    entry.elements.push_back(out);
  }
  if (spec.type == DYN_TENDON_TYPE_SPATIAL) check_branches(who, elements);
  impl->tendons.push_back(std::move(entry));
}

void Builder::couple_tendons(const std::string& name, const std::string& tendon1, const std::string& tendon2,
                             const std::array<double, 5>& coefficients, const Compliance& compliance) {
  impl->check_coupling_name(name);
  const std::string who = "coupling '" + name + "'";
  const int one = impl->find_tendon(tendon1, who), two = tendon2.empty() ? -1 : impl->find_tendon(tendon2, who);
  if (one == two) refuse(DYN_ERROR_INVALID, who + ": that is one tendon");
  for (const double c : coefficients)
    if (!std::isfinite(c)) refuse(DYN_ERROR_NONFINITE, who + ": a coefficient is " + number(c) + ": give a finite number");
  impl->couplings.push_back({name, one, two, coefficients, compliance});
}

void Compiler::add_paths() {
  std::vector<std::set<Index>> moved_by;  // the user's degrees of freedom of each path
  const auto begin = [&](PathKind kind) -> PathRecord& {
    PathRecord& p = a.paths.emplace_back();
    p.kind = kind, p.first = Index(a.path_elements.size());
    moved_by.emplace_back();
    return p;
  };
  const auto add_carriers = [&](Index body) {
    for (Index i = body; i != 0; i = a.bodies[std::size_t(i)].parent)
      for (Index k = 0; k < primitive_nv(a.bodies[std::size_t(i)].type); ++k)
        moved_by.back().insert(a.bodies[std::size_t(i)].user_v + k);
  };
  const auto add_element = [&](const TendonElementEntry& e) {
    PathElement x{};
    x.X = SE3<double>::identity(), x.side = Vec3<double>::zero();
    x.type = e.type, x.value = e.value, x.id = x.side_id = x.q = x.dof = -1;
    if (e.type == DYN_TENDON_ELEMENT_TYPE_JOINT) {
      const JointRecord& j = a.joints[std::size_t(id[std::size_t(e.id)])];
      x.id = id[std::size_t(e.id)], x.q = j.idx_q, x.dof = j.idx_v, x.body = x.place = j.last_body;
      add_carriers(x.body), moved_by.back().insert(x.dof);
    } else if (e.type != DYN_TENDON_ELEMENT_TYPE_PULLEY) {
      const FrameRecord& f = a.frames[std::size_t(e.id)];
      x.id = Index(e.id), x.X = f.X, x.body = f.body, x.place = f.place;
      add_carriers(x.body);
      if (e.side >= 0) {
        const FrameRecord& s = a.frames[std::size_t(e.side)];
        x.side_id = Index(e.side), x.side = s.X.p, x.side_place = s.place;
      }
    }
    a.path_elements.push_back(x);
    ++a.paths.back().elements;
  };
  for (const TendonEntry& t : in.tendons) {
    TendonRecord r{t.spec, text.add(t.name), 0};
    r.spec.struct_size = sizeof r.spec, r.spec.elements = Index(t.elements.size());
    a.tendons.push_back(r);
    const bool fixed = t.spec.type == DYN_TENDON_TYPE_FIXED;
    begin(fixed ? PathKind::Fixed : PathKind::Spatial);
    for (const TendonElementEntry& e : t.elements) add_element(e);
    a.paths.back().angular =
        fixed && a.bodies[std::size_t(a.path_elements[std::size_t(a.paths.back().first)].body)].type != BodyType::Prismatic;
    a.tendons.back().spec.angular = a.paths.back().angular;
    if (fixed && t.elements.size() == 1) a.paths.back().joint = a.path_elements.back().id;
  }
  for (const TendonCoupling& c : in.couplings) {
    PathRecord& p = begin(PathKind::Coupling);
    p.name = text.add(c.name), p.first = Index(c.tendon1), p.elements = Index(c.tendon2);
    std::copy(c.coefficients.begin(), c.coefficients.end(), p.polynomial);
    p.angular = a.paths[std::size_t(c.tendon1)].angular;
    for (const int t : {c.tendon1, c.tendon2})
      if (t >= 0) moved_by.back().insert(moved_by[std::size_t(t)].begin(), moved_by[std::size_t(t)].end());
  }
  for (std::size_t k = 0; k < in.actuators.size(); ++k) {
    const ActuatorEntry& e = in.actuators[k];
    if (a.actuators[k].path < n.tendons + n.couplings) continue;
    const dynTransmission by = e.spec.transmission;
    if (by == DYN_TRANSMISSION_AXES) {
      std::copy_n(e.spec.wrench, 6, begin(e.spec.in_parent ? PathKind::AxesInParent : PathKind::Axes).wrench);
      a.paths.back().joint = a.actuators[k].spec.joint;
      add_element({DYN_TENDON_ELEMENT_TYPE_JOINT, e.target, -1, 1});
    } else if (by == DYN_TRANSMISSION_BODY) {
      begin(PathKind::Adhesion), ++n.adhesions;
      add_element({DYN_TENDON_ELEMENT_TYPE_SITE, e.target, -1, 1});
      for (Index i = 0; i < n.nv; ++i) moved_by.back().insert(i);  // it may touch anything
    } else if (by == DYN_TRANSMISSION_SLIDER_CRANK) {
      begin(PathKind::SliderCrank).wrench[0] = e.spec.rod;
      add_element({DYN_TENDON_ELEMENT_TYPE_SITE, e.target, -1, 1});
      add_element({DYN_TENDON_ELEMENT_TYPE_SITE, e.reference, -1, 1});
    } else if (by == DYN_TRANSMISSION_JOINT) {
      PathRecord& p = begin(PathKind::Fixed);
      p.joint = a.actuators[k].spec.joint;
      add_element({DYN_TENDON_ELEMENT_TYPE_JOINT, e.target, -1, 1});
    } else {
      std::copy_n(e.spec.wrench, 6, begin(PathKind::Site).wrench);
      add_element({DYN_TENDON_ELEMENT_TYPE_SITE, e.target, -1, 1});
      if (e.reference >= 0) add_element({DYN_TENDON_ELEMENT_TYPE_SITE, e.reference, -1, 1});
    }
  }
  // with mimic joints the elimination tree, which comes later, may add any
  for (std::size_t p = 0; p < a.paths.size(); ++p) {
    const std::set<Index>& dofs = moved_by[p];
    a.paths[p].first_dof = Index(a.path_dofs.size()), a.paths[p].dofs = Index(dofs.size());
    a.path_dofs.insert(a.path_dofs.end(), dofs.rbegin(), dofs.rend());
    if (mimic) a.path_dofs.resize(std::size_t(a.paths[p].first_dof + n.nv));
  }
  a.path_parents.assign(a.path_dofs.size(), -1);
  n.paths_in_space = Index(std::count_if(a.paths.begin(), a.paths.end(), [](const PathRecord& p) {
    return p.kind != PathKind::Fixed && p.kind != PathKind::Coupling;
  }));
  for (const ForceLimitEntry& e : in.force_limits) {
    const Index joint = e.tendon ? -1 : id[std::size_t(e.target)];
    a.force_limits.push_back({{e.range[0], e.range[1]}, joint, e.tendon ? Index(e.target) : -1,
                              e.tendon ? -1 : a.joints[std::size_t(joint)].idx_v, e.with_weight});
    n.paths_in_space += e.with_weight && n.paths > 0;
  }
  n.force_limits = Index(a.force_limits.size());
  n.path_elements = Index(a.path_elements.size()), n.path_dofs = Index(a.path_dofs.size());
}

// Closes the degrees of freedom of each path under the parents of the elimination tree.
void Compiler::fill_path_dofs() {
  PathRecord* const paths = array<PathRecord>(Model::Field::paths);
  Index *const dofs = array<Index>(Model::Field::path_dofs), *const parents = array<Index>(Model::Field::path_parents);
  for (Index p = 0; p < n.paths; ++p) {
    Index *const own = dofs + paths[p].first_dof, *const up = parents + paths[p].first_dof;
    std::set<Index> closed;
    for (Index k = 0; k < paths[p].dofs; ++k)
      for (Index dof = own[k]; dof >= 0; dof = a.dof_parent[std::size_t(dof)]) closed.insert(dof);
    paths[p].dofs = Index(closed.size());
    std::copy(closed.rbegin(), closed.rend(), own);
    for (Index k = 0; k < paths[p].dofs; ++k) {
      const Index parent = a.dof_parent[std::size_t(own[k])];
      up[k] = parent < 0 ? -1 : Index(std::find(own, own + paths[p].dofs, parent) - own);
    }
    model->n.carriers = std::max(model->n.carriers, paths[p].dofs);
  }
}

}  // namespace dyn
