// The numbers of what a builder holds, one by one.
#include <algorithm>
#include <cmath>

#include "builder_impl.hpp"
#include "effect/list.hpp"
#include "model/constraints.hpp"
#include "shape/geometry.hpp"
#include "spatial/explog.hpp"

namespace dyn {

namespace {

using Numbers = std::vector<double>;

// x, y, z and a rotation vector.
Numbers six_of(const SE3<double>& X) {
  Numbers out(6);
  store3(X.p, out.data()), store3(log3(X.R), out.data() + 3);
  return out;
}
SE3<double> se3_of(const Numbers& x) { return {exp3(load3(x.data() + 3)), load3(x.data())}; }

// Of a symmetric matrix: xx, yy, zz, xy, xz, yz.
constexpr std::size_t six_entries[] = {0, 4, 8, 3, 6, 7}, mirrored[] = {0, 4, 8, 1, 2, 5};

void check_finite(const std::string& who, const char* quantity, const Numbers& x) {
  for (const double value : x)
    if (!std::isfinite(value))
      refuse(DYN_ERROR_NONFINITE, who + ": " + quantity + " is " + number(value) + ": give finite numbers");
}

}  // namespace

class ParameterLister {
 public:
  ParameterLister(Builder& builder, Builder::Impl& impl, std::vector<Parameter>& out)
      : builder_(builder), impl_(impl), out_(out) {}
  void all() {
    model();
    for (std::size_t k = 0; k < impl_.joints.size(); ++k) joint(k);
    for (std::size_t k = 1; k < impl_.frames.size(); ++k) frame(k);
    for (std::size_t k = 0; k < impl_.shapes.size(); ++k)
      if (impl_.shapes[k].shape.role == DYN_SHAPE_ROLE_COLLISION) shape(k);
    for (std::size_t k = 0; k < impl_.pairs.size(); ++k)
      if (impl_.pairs[k].material) pair(k);
    for (std::size_t k = 0; k < impl_.tendons.size(); ++k) tendon(k);
    for (std::size_t k = 0; k < impl_.couplings.size(); ++k) coupling(k);
    for (std::size_t k = 0; k < impl_.actuators.size(); ++k) actuator(k);
    for (std::size_t k = 0; k < impl_.constraints.size(); ++k) constraint(k);
  }

 private:
  Builder& builder_;
  Builder::Impl& impl_;
  std::vector<Parameter>& out_;
  const char* object_ = "model";  // of what is listed now
  std::string name_;

  template <class Get, class Set>
  void add(dynParameterGroup group, const char* quantity, Get get, Set set) {
    out_.push_back({group, object_, name_, quantity, get(), get, set});
  }
  std::string who() const { return name_.empty() ? object_ : std::string(object_) + " '" + name_ + "'"; }

  // n numbers of what at() refers to, and replace(a changed copy), which throws where they are refused.
  template <class At, class Replace, class Select>
  void fields(dynParameterGroup group, const char* quantity, At at, Replace replace, Select select, std::size_t n) {
    add(
        group, quantity,
        [=] {
          auto copy = at();
          const double* x = select(copy);
          return Numbers(x, x + n);
        },
        [=](const Numbers& x) {
          auto copy = at();
          std::copy(x.begin(), x.end(), select(copy));
          replace(copy);
        });
  }

  void model() {
    Builder* b = &builder_;
    Builder::Impl* i = &impl_;
    add(
        DYN_PARAMETER_GROUP_GRAVITY, "gravity", [i] { return Numbers(i->gravity.begin(), i->gravity.end()); },
        [b](const Numbers& x) { b->gravity({x[0], x[1], x[2]}); });
    add(
        DYN_PARAMETER_GROUP_MEDIUM, "density", [i] { return Numbers{i->density}; },
        [b, i](const Numbers& x) { b->medium(x[0], i->viscosity, i->wind); });
    add(
        DYN_PARAMETER_GROUP_MEDIUM, "viscosity", [i] { return Numbers{i->viscosity}; },
        [b, i](const Numbers& x) { b->medium(i->density, x[0], i->wind); });
    add(
        DYN_PARAMETER_GROUP_MEDIUM, "wind", [i] { return Numbers(i->wind.begin(), i->wind.end()); },
        [b, i](const Numbers& x) { b->medium(i->density, i->viscosity, {x[0], x[1], x[2]}); });
  }

  void joint(std::size_t k) {
    object_ = "joint", name_ = impl_.joints[k].spec.name;
    const std::string who = this->who();
    Builder::Impl* i = &impl_;
    const auto entry = [i, k]() -> JointEntry& { return i->joints[k]; };
    const auto replace = [=](const JointSpec& s) {
      auto parts = entry().parts;
      if (s.type != DYN_JOINT_TYPE_COMPOSITE) parts[0].axis = s.axis, parts[0].axis2 = s.axis2, parts[0].pitch = s.pitch;
      auto elements = elements_of(s, parts);
      check_joint_numbers(who, s, elements);
      entry().spec = s, entry().parts = std::move(parts), entry().elements = std::move(elements);
    };
    const auto spec = [=] { return entry().spec; };
    const JointSpec& s = entry().spec;
    add(
        DYN_PARAMETER_GROUP_FRAMES, "placement", [=] { return six_of(entry().placement); },
        [=](const Numbers& x) {
          check_finite(who, "placement", x);
          entry().placement = se3_of(x);
        });
    if (s.type != DYN_JOINT_TYPE_COMPOSITE) {
      fields(DYN_PARAMETER_GROUP_FRAMES, "axis", spec, replace, [](JointSpec& x) { return x.axis.data(); }, 3);
      fields(DYN_PARAMETER_GROUP_FRAMES, "axis2", spec, replace, [](JointSpec& x) { return x.axis2.data(); }, 3);
      fields(DYN_PARAMETER_GROUP_FRAMES, "pitch", spec, replace, [](JointSpec& x) { return &x.pitch; }, 1);
    }
    // an absent list is that of the joint without the quantity
    const auto list = [&](dynParameterGroup group, const char* quantity, Numbers JointSpec::* member, const Numbers& absent) {
      fields(
          group, quantity, spec, replace,
          [=](JointSpec& x) {
            if ((x.*member).empty()) x.*member = absent;
            return (x.*member).data();
          },
          absent.size());
    };
    const std::size_t nv = std::size_t(spec_nv(s)), nq = std::size_t(spec_nq(s));
    const auto of_dof = [&](double x) { return Numbers(nv, x); };
    struct {
#define COEFFICIENT(name, has, sentence) std::pair<const char*, Numbers JointSpec::*> name = {#name, &JointSpec::name};
#include "effect/coefficients.def"
    } coefficients;
    for_each_coefficient([&]<class E>() {
      const auto& [quantity, member] = E::of(coefficients);
      list(E::group, quantity, member, of_dof(0));
    });
    if (nv == 1) {
      fields(DYN_PARAMETER_GROUP_ARMATURE, "rotor_inertia", spec, replace, [](JointSpec& x) { return &x.rotor_inertia; }, 1);
      fields(DYN_PARAMETER_GROUP_ARMATURE, "gear_ratio", spec, replace, [](JointSpec& x) { return &x.gear_ratio; }, 1);
    }
    if (!s.mimic.empty()) {
      fields(DYN_PARAMETER_GROUP_MIMIC, "mimic_ratio", spec, replace, [](JointSpec& x) { return &x.mimic_ratio; }, 1);
      fields(DYN_PARAMETER_GROUP_MIMIC, "mimic_offset", spec, replace, [](JointSpec& x) { return &x.mimic_offset; }, 1);
      return;
    }
    list(DYN_PARAMETER_GROUP_SPRINGS, "spring_reference", &JointSpec::spring_reference, neutral_of(entry()));
    list(DYN_PARAMETER_GROUP_LIMITS, "lower", &JointSpec::lower, Numbers(nq, -HUGE_VAL));
    list(DYN_PARAMETER_GROUP_LIMITS, "upper", &JointSpec::upper, Numbers(nq, HUGE_VAL));
    list(DYN_PARAMETER_GROUP_LIMITS, "velocity", &JointSpec::velocity, of_dof(HUGE_VAL));
    list(DYN_PARAMETER_GROUP_LIMITS, "effort", &JointSpec::effort, of_dof(HUGE_VAL));
  }

  void frame(std::size_t k) {
    const FrameEntry& f = impl_.frames[k];
    if (f.type == DYN_FRAME_TYPE_JOINT) return;
    object_ = f.type == DYN_FRAME_TYPE_BODY ? "link" : "frame", name_ = f.name;
    const std::string who = this->who();
    Builder::Impl* i = &impl_;
    const auto entry = [i, k]() -> FrameEntry& { return i->frames[k]; };
    const bool link = f.type == DYN_FRAME_TYPE_BODY;
    const auto replace = [=](FrameEntry x) {
      if (link) {
        check_link_numbers(who, x.mass, x.com, x.inertia), check_moments(who, x.mass, x.inertia);
        x.Y = act(x.X, Inertia<double>::at_com(x.mass, load3(x.com.data()), load33(x.inertia.data())));
      }
      entry() = std::move(x);
    };
    const auto copy = [=] { return entry(); };
    add(
        DYN_PARAMETER_GROUP_FRAMES, "placement", [=] { return six_of(entry().X); },
        [=](const Numbers& x) {
          check_finite(who, "placement", x);
          FrameEntry changed = entry();
          changed.X = se3_of(x);
          replace(std::move(changed));
        });
    if (!link) return;
    fields(DYN_PARAMETER_GROUP_MASS, "mass", copy, replace, [](FrameEntry& x) { return &x.mass; }, 1);
    fields(DYN_PARAMETER_GROUP_INERTIA, "com", copy, replace, [](FrameEntry& x) { return x.com.data(); }, 3);
    add(
        DYN_PARAMETER_GROUP_INERTIA, "inertia",
        [=] {
          Numbers out;
          for (const std::size_t e : six_entries) out.push_back(entry().inertia[e]);
          return out;
        },
        [=](const Numbers& x) {
          FrameEntry changed = entry();
          for (std::size_t e = 0; e < 6; ++e) changed.inertia[six_entries[e]] = changed.inertia[mirrored[e]] = x[e];
          replace(std::move(changed));
        });
    add(
        DYN_PARAMETER_GROUP_COMPENSATION, "gravity_compensation", [=] { return Numbers{entry().compensation}; },
        [=](const Numbers& x) {
          check_finite(who, "gravity_compensation", x);
          entry().compensation = x[0];
        });
  }

  // The entry at k of a list replaced by one that add makes, which throws where it is refused.
  template <class List, class Add>
  static void replace_by(List& list, std::size_t k, Add add) {
    const std::string name = name_in(list[k]);
    name_in(list[k]) += '\1';  // free for the new one
    try {
      add(name);
    } catch (...) {
      name_in(list[k]) = name;
      throw;
    }
    list[k] = std::move(list.back());
    list.pop_back();
  }
  static std::string& name_in(ActuatorEntry& x) { return x.name; }
  static std::string& name_in(ShapeEntry& x) { return x.shape.name; }

  template <class At, class Replace, class Of>
  void material(At at, Replace replace, Of of) {
    const auto number_of = [&](const char* quantity, double dynMaterial::* member) {
      fields(DYN_PARAMETER_GROUP_CONTACT, quantity, at, replace, [=](auto& x) { return &(of(x).*member); }, 1);
    };
    number_of("friction", &dynMaterial::friction), number_of("torsion", &dynMaterial::torsion);
    number_of("rolling", &dynMaterial::rolling), number_of("restitution", &dynMaterial::restitution);
    number_of("stiffness", &dynMaterial::stiffness), number_of("damping", &dynMaterial::damping);
    fields(DYN_PARAMETER_GROUP_CONTACT, "surface_velocity", at, replace, [=](auto& x) { return of(x).surface_velocity; }, 3);
  }

  void shape(std::size_t k) {
    const Shape& s = impl_.shapes[k].shape;
    object_ = "shape", name_ = s.name;
    if (name_.empty()) {
      const int frame = impl_.shapes[k].frame;
      int before = 0;
      for (std::size_t j = k; j-- > 0 && impl_.shapes[j].frame == frame;)
        before += impl_.shapes[j].shape.role == DYN_SHAPE_ROLE_COLLISION;
      name_ = impl_.frames[std::size_t(frame)].name + ", shape " + std::to_string(before);
    }
    Builder* b = &builder_;
    Builder::Impl* i = &impl_;
    const auto at = [i, k] { return i->shapes[k].shape; };
    const auto replace = [b, i, k](const Shape& x) {
      const int frame = i->shapes[k].frame;
      replace_by(i->shapes, k, [&](const std::string&) { b->shape(x); });
      i->shapes[k].frame = frame;
    };
    const std::size_t sizes = std::size_t(shape::size_count(s.type));
    if (sizes) fields(DYN_PARAMETER_GROUP_SHAPES, "size", at, replace, [](Shape& x) { return x.size.data(); }, sizes);
    fields(DYN_PARAMETER_GROUP_SHAPES, "radius", at, replace, [](Shape& x) { return &x.radius; }, 1);
    const std::string who = this->who();
    add(
        DYN_PARAMETER_GROUP_SHAPES, "placement", [=] { return six_of(load_se3(at().placement.data())); },
        [=](const Numbers& x) {
          check_finite(who, "placement", x);
          const SE3<double> X = se3_of(x);
          store33(X.R, i->shapes[k].shape.placement.data()), store3(X.p, i->shapes[k].shape.placement.data() + 9);
        });
    const auto mask = [&](const char* quantity, std::uint32_t Shape::* member) {
      add(
          DYN_PARAMETER_GROUP_SHAPES, quantity, [=] { return Numbers{double(at().*member)}; },
          [=](const Numbers& x) {
            if (!(x[0] >= 0 && x[0] <= double(UINT32_MAX) && x[0] == std::floor(x[0])))
              refuse(DYN_ERROR_INVALID, who + ": " + quantity + " is " + number(x[0]) + ": give a whole number of 32 bits");
            i->shapes[k].shape.*member = std::uint32_t(x[0]);
          });
    };
    mask("contype", &Shape::contype), mask("conaffinity", &Shape::conaffinity);
    material(at, replace, [](Shape& x) -> dynMaterial& { return x.material; });
  }

  void pair(std::size_t k) {
    Builder::Impl* i = &impl_;
    const PairEntry& p = impl_.pairs[k];
    object_ = "pair",
    name_ = impl_.shapes[std::size_t(p.shape1)].shape.name + ", " + impl_.shapes[std::size_t(p.shape2)].shape.name;
    const std::string who = this->who();
    material([i, k] { return *i->pairs[k].material; },
             [=](const dynMaterial& x) {
               if (const shape::BadNumber bad = shape::bad_number(x); bad.name)
                 refuse(DYN_ERROR_INVALID, who + ": " + bad.name + " is " + number(bad.value));
               i->pairs[k].material = x;
             },
             [](dynMaterial& x) -> dynMaterial& { return x; });
  }

  void tendon(std::size_t k) {
    object_ = "tendon", name_ = impl_.tendons[k].name;
    Builder::Impl* i = &impl_;
    const std::string who = this->who();
    const auto at = [i, k] { return i->tendons[k].spec; };
    const auto replace = [=](const dynTendon& x) { check_tendon_numbers(who, x), i->tendons[k].spec = x; };
    const auto number_of = [&](const char* quantity, double dynTendon::* member) {
      fields(DYN_PARAMETER_GROUP_TENDONS, quantity, at, replace, [=](dynTendon& x) { return &(x.*member); }, 1);
    };
    number_of("stiffness", &dynTendon::stiffness), number_of("damping", &dynTendon::damping);
    number_of("friction", &dynTendon::friction), number_of("armature", &dynTendon::armature);
    fields(DYN_PARAMETER_GROUP_TENDONS, "rest", at, replace, [](dynTendon& x) { return x.rest; }, 2);
    fields(DYN_PARAMETER_GROUP_TENDONS, "range", at, replace, [](dynTendon& x) { return x.range; }, 2);
    add(
        DYN_PARAMETER_GROUP_TENDONS, "elements",
        [=] {
          Numbers out;
          for (const TendonElementEntry& e : i->tendons[k].elements) out.push_back(e.value);
          return out;
        },
        [=](const Numbers& x) {
          check_finite(who, "elements", x);
          for (std::size_t e = 0; e < x.size(); ++e) {
            const dynTendonElementType type = i->tendons[k].elements[e].type;
            if (type != DYN_TENDON_ELEMENT_TYPE_JOINT && type != DYN_TENDON_ELEMENT_TYPE_SITE && !(x[e] > 0))
              refuse(DYN_ERROR_INVALID, who + ": element " + std::to_string(e) + " is " + number(x[e]) + ": it must be positive");
          }
          for (std::size_t e = 0; e < x.size(); ++e) i->tendons[k].elements[e].value = x[e];
        });
  }

  void coupling(std::size_t k) {
    object_ = "coupling", name_ = impl_.couplings[k].name;
    Builder::Impl* i = &impl_;
    const std::string who = this->who();
    fields(
        DYN_PARAMETER_GROUP_TENDONS, "coefficients", [i, k] { return i->couplings[k].coefficients; },
        [=](const std::array<double, 5>& x) {
          check_finite(who, "coefficients", Numbers(x.begin(), x.end()));
          i->couplings[k].coefficients = x;
        },
        [](std::array<double, 5>& x) { return x.data(); }, 5);
  }

  void actuator(std::size_t k) {
    object_ = "actuator", name_ = impl_.actuators[k].name;
    Builder* b = &builder_;
    Builder::Impl* i = &impl_;
    const auto at = [i, k] { return i->actuators[k].spec; };
    const auto replace = [b, i, k](const dynActuator& x) {
      const ActuatorEntry old = i->actuators[k];
      const auto frame = [i](int f) { return i->frames[std::size_t(f)].name; };
      const std::string target = x.transmission == DYN_TRANSMISSION_JOINT    ? i->joints[std::size_t(old.target)].spec.name
                                 : x.transmission == DYN_TRANSMISSION_TENDON ? i->tendons[std::size_t(old.target)].name
                                                                             : frame(old.target);
      i->names.actuators.forget();
      replace_by(i->actuators, k,
                 [&](const std::string& name) { b->actuator(name, x, target, old.reference < 0 ? "" : frame(old.reference)); });
      i->names.actuators.forget();
      i->actuators[k].target = old.target, i->actuators[k].reference = old.reference;
    };
    const auto number_of = [&](const char* quantity, auto select, std::size_t n) {
      fields(DYN_PARAMETER_GROUP_ACTUATORS, quantity, at, replace, select, n);
    };
    number_of("gear", [](dynActuator& x) { return &x.gear; }, 1);
    number_of("kp", [](dynActuator& x) { return &x.kp; }, 1);
    number_of("kv", [](dynActuator& x) { return &x.kv; }, 1);
    number_of("gain", [](dynActuator& x) { return &x.gain; }, 1);
    number_of("bias", [](dynActuator& x) { return x.bias; }, 3);
    number_of("time_constant", [](dynActuator& x) { return &x.time_constant; }, 1);
    number_of("control_range", [](dynActuator& x) { return x.control_range; }, 2);
    number_of("force_range", [](dynActuator& x) { return x.force_range; }, 2);
    number_of("act_range", [](dynActuator& x) { return x.act_range; }, 2);
    if (at().transmission == DYN_TRANSMISSION_SITE) number_of("wrench", [](dynActuator& x) { return x.wrench; }, 6);
    if (at().type != DYN_ACTUATOR_TYPE_MUSCLE) return;
    number_of("muscle force", [](dynActuator& x) { return &x.muscle.force; }, 1);
    number_of("muscle range", [](dynActuator& x) { return x.muscle.range; }, 2);
    number_of("muscle length_range", [](dynActuator& x) { return x.muscle.length_range; }, 2);
    number_of("muscle curves", [](dynActuator& x) { return &x.muscle.lmin; }, 5);
    number_of("muscle times", [](dynActuator& x) { return &x.muscle.t_act; }, 3);
  }

  void constraint(std::size_t k) {
    object_ = "constraint", name_ = impl_.constraints[k].name;
    Builder::Impl* i = &impl_;
    const std::string who = this->who();
    const auto at = [i, k] { return i->constraints[k].spec; };
    const auto replace = [=](const dynConstraint& x) {
      char message[256];
      if (const dynStatus status = check_constraint_numbers(x, message, sizeof message)) refuse(status, who + ": " + message);
      i->constraints[k].spec = x;
    };
    const auto number_of = [&](const char* quantity, auto select, std::size_t n) {
      fields(DYN_PARAMETER_GROUP_CONSTRAINTS, quantity, at, replace, select, n);
    };
    for (double (dynConstraint::*member)[12] : {&dynConstraint::placement1, &dynConstraint::placement2})
      add(
          DYN_PARAMETER_GROUP_CONSTRAINTS, member == &dynConstraint::placement1 ? "placement1" : "placement2",
          [=] { return six_of(load_se3((i->constraints[k].spec.*member))); },
          [=](const Numbers& x) {
            check_finite(who, "placement", x);
            const SE3<double> X = se3_of(x);
            double* to = i->constraints[k].spec.*member;
            store33(X.R, to), store3(X.p, to + 9);
          });
    number_of("axis", [](dynConstraint& x) { return x.axis; }, 3);
    number_of("axis2", [](dynConstraint& x) { return x.axis2; }, 3);
    number_of("pitch", [](dynConstraint& x) { return &x.pitch; }, 1);
    number_of("length", [](dynConstraint& x) { return &x.length; }, 1);
    number_of("coefficients", [](dynConstraint& x) { return x.coefficients; }, 5);
    number_of("force", [](dynConstraint& x) { return &x.force; }, 1);
    number_of("stiffness", [](dynConstraint& x) { return &x.stiffness; }, 1);
    number_of("damping", [](dynConstraint& x) { return &x.damping; }, 1);
    number_of("restitution", [](dynConstraint& x) { return &x.restitution; }, 1);
  }
};

const std::vector<Parameter>& Builder::parameters() {
  if (parameters_.empty()) ParameterLister(*this, *impl, parameters_).all();
  return parameters_;
}

void Builder::set_parameter(std::size_t index, const std::vector<double>& values) {
  parameters();
  Parameter& p = parameters_.at(index);
  const std::string who = p.name.empty() ? p.object : std::string(p.object) + " '" + p.name + "'";
  if (values.size() != p.values.size())
    refuse(DYN_ERROR_SIZE, who + ": " + p.quantity + " has " + std::to_string(p.values.size()) + " numbers, and " +
                               std::to_string(values.size()) + " are given");
  for (std::size_t k = 0; k < values.size(); ++k)
    if (std::isnan(values[k]) && !std::isnan(p.values[k]))
      refuse(DYN_ERROR_NONFINITE, who + ": " + p.quantity + " is NaN: give numbers");
  if (values == p.values) return;  // rotations keep their bits
  p.set(values);
  p.values = p.get();
}

}  // namespace dyn
