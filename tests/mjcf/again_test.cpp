// A model that is written as MJCF and loaded again has the same actuators, tendons, sensors, keys and contacts, number by
// number.
#include "mjcf/parts.hpp"

namespace dyn_test::mjcf_again {
namespace {

using namespace mjcf;

using Numbers = std::vector<double>;

void expect_same(const Numbers& a, const Numbers& b, const std::string& what, double tolerance = 1e-13) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k] == b[k]) continue;
    EXPECT_NEAR(a[k], b[k], tolerance * std::max(1.0, std::abs(a[k]))) << what << ", number " << k;
  }
}
void add(Numbers& to, const double* x, std::ptrdiff_t n) { to.insert(to.end(), x, x + n); }

// Laws by their numbers: a servo that is filtered early is written as <general>.
Numbers of(const ActuatorRecord& r) {
  const dynActuator& a = r.spec;
  const bool own = a.type >= DYN_ACTUATOR_TYPE_MUSCLE;
  Numbers out = {
      own ? double(a.type) : 0, own ? a.kp : 0, own ? a.kv : 0,   double(a.transmission), double(r.v),    double(a.component),
      double(a.tendon),   a.gear,         a.time_constant,  double(a.integrates),   a.rod,          a.ki,
      a.integral_limit,   a.slew,         double(a.inputs), double(a.in_parent),    double(a.late), double(a.activations),
      double(a.idx_act),  double(a.idx_u)};
  add(out, r.gain, 3), add(out, r.bias, 3), add(out, a.gain_slope, 2), add(out, a.wrench, 6);
  for (const double* range : {a.control_range, a.force_range, a.act_range, a.velocity_range, a.feedforward_range})
    add(out, range, 2);
  if (a.type == DYN_ACTUATOR_TYPE_MUSCLE) {
    const dynMuscle& x = a.muscle;
    for (const double n : {x.force, x.lmin, x.lmax, x.vmax, x.fpmax, x.fvmax, x.t_act, x.t_deact, x.smoothing})
      out.push_back(n);
    add(out, x.range, 2), add(out, x.length_range, 2);
  }
  if (a.type == DYN_ACTUATOR_TYPE_DC_MOTOR) {
    const dynDcMotor& x = a.motor;
    for (const double n : {x.resistance, x.constant, x.temperature_coefficient, x.reference, x.ambient, x.thermal_resistance,
                           x.heat_capacity, x.time_constant, x.rate, x.kp, x.kd, x.voltage_limit, x.bristle_stiffness,
                           x.bristle_damping, x.coulomb, x.breakaway, x.stribeck})
      out.push_back(n);
    add(out, x.cogging, 3);
  }
  return out;
}
Numbers of(const TendonRecord& r) {
  const dynTendon& t = r.spec;
  return {double(t.type), t.stiffness, t.rest[0],  t.rest[1],  t.damping,
          t.friction,     t.armature,  t.range[0], t.range[1], double(t.elements)};
}
// Ids of frames and shapes may differ.
Numbers of(const SensorRecord& r) {
  const dynSensor& s = r.spec;
  Numbers out = {double(s.quantity),
                 s.cutoff,
                 s.noise,
                 s.delay,
                 double(s.side),
                 double(s.other_side),
                 double(s.values),
                 double(s.reduction),
                 double(s.count),
                 double(s.idx),
                 double(s.size)};
  if (s.quantity == DYN_QUANTITY_MAGNETOMETER) add(out, s.field, 3);
  return out;
}
Numbers of(const Compliance& x) {
  Numbers out = {x.mix, x.scale, x.margin};
  add(out, x.reference, 2), add(out, x.impedance, 5), add(out, x.across, 2);
  return out;
}

struct Both {
  SaveReport lines;
  ModelPtr a, b;
  explicit Both(const std::string& inside) : a(model(inside)), b(again(*a, DYN_FORMAT_MJCF, DYN_BASE_UNSPECIFIED, &lines)) {}
  bool notes(const char* words) const {
    return std::any_of(lines.begin(), lines.end(),
                       [&](const SaveEntry& e) { return e.message.find(words) != std::string::npos; });
  }
  // The list of records of both, with their names.
  template <class F, class N>
  void compare(Index ModelSizes::*count, F list, N name) const {
    ASSERT_EQ(a->n.*count, b->n.*count);
    for (Index k = 0; k < a->n.*count; ++k) {
      EXPECT_STREQ(a->string(name(*a, k)), b->string(name(*b, k)));
      expect_same(of(list(*a, k)), of(list(*b, k)), a->string(name(*a, k)));
    }
  }
  void compare_actuators() const {
    compare(
        &ModelSizes::actuators, [](const Model& m, Index k) -> const auto& { return m.actuators()[k]; },
        [](const Model& m, Index k) { return m.actuators()[k].name; });
  }
  void compare_tendons() const {
    compare(
        &ModelSizes::tendons, [](const Model& m, Index k) -> const auto& { return m.tendons()[k]; },
        [](const Model& m, Index k) { return m.tendons()[k].name; });
  }
};

constexpr const char* arm =
    "<worldbody><site name='hook' pos='1 0 .2'/><body name='link' pos='0 0 .2'><joint name='j' axis='0 0 1' range='-90 120' "
    "ref='30'/>"
    "<geom name='ball' size='.1' mass='2' pos='0 .1 0'/><geom name='drum' type='cylinder' size='.05 .2' pos='.3 0 0'/>"
    "<site name='tip' pos='.5 0 .1'/><site name='beside' pos='0 .4 0'/><body name='cart' pos='.5 0 0'>"
    "<joint name='s' type='slide' axis='1 0 0' ref='.1' actuatorfrcrange='-7 8' actuatorgravcomp='true'/><geom name='box' "
    "type='box' size='.1 .1 .1'/>"
    "<site name='c'/></body></body><body name='globe' pos='0 2 0'><joint name='b' type='ball'/><geom "
    "size='.1'/></body></worldbody>";

TEST(MjcfAgain, Actuators) {
  const Both m(
      std::string(arm) +
      "<tendon><fixed name='t' actuatorfrcrange='-3 4'><joint joint='j' coef='2'/></fixed></tendon><actuator>"
      "<motor name='motor' joint='j' gear='-3' ctrlrange='-1 2' forcerange='-4 5'/>"
      "<position name='position' joint='j' kp='20' kv='2'/><position name='filtered' joint='j' kp='20' kv='2' timeconst='.1'/>"
      "<position name='early' joint='j' kp='20' timeconst='.1' actearly='true' actrange='-3 4'/>"
      "<velocity name='velocity' joint='s' kv='3' gear='2'/><intvelocity name='intvelocity' joint='j' kp='3' kv='1' "
      "actrange='-1 2'/>"
      "<intvelocity name='early_too' joint='j' kp='3' kv='1' actearly='true'/>"
      "<damper name='damper' joint='j' kv='2' ctrlrange='0 1'/><cylinder name='cylinder' joint='j' area='5' bias='1 -2 -3' "
      "timeconst='.2'/>"
      "<adhesion name='adhesion' body='link' gain='4' ctrlrange='0 1'/>"
      "<general name='general' joint='s' gaintype='affine' gainprm='4 5 6' biastype='affine' biasprm='7 8 9' "
      "dyntype='integrator'/>"
      "<motor name='ball' joint='b' gear='0 2 0'/><motor name='axes' joint='b' gear='1 2 3'/>"
      "<motor name='outer' jointinparent='b' gear='1 2 3'/><motor name='tendon' tendon='t' gear='5'/><motor name='both' "
      "tendon='t'/>"
      "<motor name='site' site='tip' refsite='hook' gear='1 2 3 4 5 6'/>"
      "<motor name='crank' cranksite='c' slidersite='tip' cranklength='.7' gear='2'/>"
      "<muscle name='muscle' joint='j' range='.6 1.1' force='33' lmin='.4' lmax='1.7' vmax='1.4' fpmax='1.2' fvmax='1.1' "
      "timeconst='.02 .06' tausmooth='.1' lengthrange='.1 .9'/></actuator>");
  m.compare_actuators();
  ASSERT_EQ(m.a->n.force_limits, m.b->n.force_limits);
  ASSERT_EQ(2, m.a->n.force_limits);
  for (Index k = 0; k < 2; ++k) {
    const ForceLimitRecord &x = m.a->force_limits()[k], &y = m.b->force_limits()[k];
    expect_same({x.range[0], x.range[1], double(x.joint), double(x.tendon), double(x.with_weight)},
                {y.range[0], y.range[1], double(y.joint), double(y.tendon), double(y.with_weight)}, "limit of forces");
  }
}

TEST(MjcfAgain, Drivers) {
  const std::string pid =
                        "<pid name='p' joint='j' input='pos ff' kp='1' kv='2' ki='3' imax='4' slewmax='5' posrange='-6 7' "
                        "velrange='-8 9' ffrange='-10 11' forcerange='-12 13'",
                    motor =
                        "<dcmotor name='m' joint='j' input='pos voltage' motorconst='.2 .8' resistance='2' inductance='.5 9' "
                        "cogging='1 2 3' controller='4 5 6 7 8 9' saturation='10 0 11' thermal='12 13 0 14 15 16' "
                        "lugre='17 18 19 20 21' velrange='-8 9' ctrlrange='-3 4'/>";
  const auto with = [](const std::string& actuators) { return Both(arm + ("<actuator>" + actuators + "</actuator>")); };
  const Both all =
      with(pid + "/><pid name='q' joint='s' kp='1'/>" + motor + "<dcmotor name='n' joint='s' motorconst='.1' resistance='3'/>");
  all.compare_actuators();
  const char* const early = "integrals of <pid> are those of the beginning of a step";
  EXPECT_FALSE(all.notes(early));
  EXPECT_TRUE(with(pid + " actearly='true'/>").notes(early));
  EXPECT_FALSE(with("<pid joint='j' kp='1' slewmax='5' actearly='true'/>").notes(early));
}

TEST(MjcfAgain, Tendons) {
  const Both m(
      std::string(arm) +
      "<tendon><fixed name='f' stiffness='2' damping='3' frictionloss='4' armature='5' springlength='-.1 .3' range='-1 2' "
      "solreflimit='.03 2' solimplimit='.7 .8 .01 .4 3' solreffriction='.04 3'><joint joint='j' coef='2'/><joint joint='s' "
      "coef='-3'/>"
      "</fixed><spatial name='s' stiffness='1'><site site='hook'/><geom geom='ball' sidesite='beside'/><site site='tip'/>"
      "<pulley divisor='4'/><site site='hook'/><geom geom='drum'/><site site='tip'/></spatial></tendon>"
      "<equality><tendon name='e' tendon1='f' tendon2='s' polycoef='.1 2 .3 .4 .5' solref='.05 2'/><tendon name='g' "
      "tendon1='s'/></equality>");
  m.compare_tendons();
  ASSERT_EQ(m.a->n.paths, m.b->n.paths);
  for (Index k = 0; k < m.a->n.paths; ++k) {
    const PathRecord &x = m.a->paths()[k], &y = m.b->paths()[k];
    EXPECT_EQ(x.kind, y.kind);
    expect_same(Numbers(x.polynomial, x.polynomial + 5), Numbers(y.polynomial, y.polynomial + 5), "polynomial");
    expect_same(Numbers(x.neutral, x.neutral + 2), Numbers(y.neutral, y.neutral + 2), "lengths");
    for (Index i = 0; x.kind != PathKind::Coupling && i < x.elements; ++i) {
      const PathElement &e = m.a->path_elements()[x.first + i], &f = m.b->path_elements()[y.first + i];
      EXPECT_EQ(e.type, f.type);
      EXPECT_EQ(e.value, f.value);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.X.p[c], f.X.p[c], 1e-14);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.side[c], f.side[c], 1e-14);
    }
  }
  for (Index k = 0; k < 2; ++k) {
    expect_same(of(m.a->tendon_compliances()[k].law), of(m.b->tendon_compliances()[k].law), "limits of tendons");
    expect_same(of(m.a->tendon_friction_compliances()[k].law), of(m.b->tendon_friction_compliances()[k].law),
                "friction of tendons");
    expect_same(of(m.a->coupling_compliances()[k].law), of(m.b->coupling_compliances()[k].law), "couplings");
  }
}

TEST(MjcfAgain, Sensors) {
  const Both m(
      "<option magnetic='1 2 3'/>" + std::string(arm) +
      "<tendon><fixed name='t'><joint joint='j' coef='2'/></fixed></tendon><actuator><motor name='m' "
      "joint='j'/></actuator><sensor>"
      "<jointpos name='a' joint='j' cutoff='.5' noise='.25' delay='.01' nsample='7'/><jointvel name='b' joint='s'/>"
      "<tendonpos name='c' tendon='t' noise='.5'/><actuatorfrc name='d' actuator='m' cutoff='2'/><ballquat name='e' joint='b'/>"
      "<magnetometer name='f' site='tip'/><gyro name='g' site='tip' delay='.002'/>"
      "<framepos name='h' objtype='geom' objname='ball' reftype='site' refname='c'/><framezaxis name='i' objtype='xbody' "
      "objname='link'/>"
      "<rangefinder name='k' site='tip' data='dist normal'/><clock name='l'/><user name='n' dim='4'/>"
      "<contact name='o' geom1='ball' body2='globe' num='3' data='found force dist' reduce='maxforce'/>"
      "<contact name='p' subtree1='link'/><distance name='q' geom1='ball' body2='globe' cutoff='1'/></sensor>");
  m.compare(
      &ModelSizes::sensors, [](const Model& x, Index k) -> const auto& { return x.sensors()[k]; },
      [](const Model& x, Index k) { return x.sensors()[k].name; });
  ASSERT_EQ(15, m.a->n.sensors);
  // where sensors of frames are
  const VectorXd qa = Eigen::Map<const VectorXd>(m.a->neutral(), m.a->n.nq);
  const std::vector<M4> x = frames_at(*m.a, qa), y = frames_at(*m.b, qa);
  const auto placed = [](const std::vector<M4>& frames, Index frame, const double* placement) {
    M4 X = M4::Identity();
    for (int c = 0; c < 4; ++c) X.col(c).head<3>() = Eigen::Map<const Eigen::Vector3d>(placement + 3 * c);
    return M4(frames[std::size_t(frame)] * X);
  };
  for (Index k = 0; k < 15; ++k) {
    const dynSensor &s = m.a->sensors()[k].spec, &t = m.b->sensors()[k].spec;
    if (s.quantity < DYN_QUANTITY_FRAMEPOS || s.quantity > DYN_QUANTITY_MAGNETOMETER) continue;
    EXPECT_LE((placed(x, s.object, s.placement) - placed(y, t.object, t.placement)).cwiseAbs().maxCoeff(), 1e-14) << k;
    if (s.reference < 0) continue;
    const M4 to = placed(x, s.reference, s.reference_placement), back = placed(y, t.reference, t.reference_placement);
    EXPECT_LE((to - back).cwiseAbs().maxCoeff(), 1e-14) << k;
  }
}

TEST(MjcfAgain, KeysWithTheirStates) {
  const Both m(
      "<worldbody><body name='m' mocap='true' pos='1 1 1'/><body name='free' pos='3 2 1'><freejoint/><geom size='.1'/></body>"
      "<body name='two' pos='0 3 0'><joint name='j' ref='20'/><joint name='k' type='slide' axis='0 1 0' ref='.3'/><geom "
      "size='.1'/></body>"
      "<body name='globe' pos='0 6 0'><joint type='ball'/><geom size='.1'/></body></worldbody>"
      "<actuator><motor joint='j'/><position joint='j' kp='1' timeconst='1'/><intvelocity joint='k' kp='1'/></actuator>"
      "<keyframe><key name='u' qpos='1 2 3 .6 0 0 .8 .5 .7 .8 0 .6 0' qvel='1 2 3 4 5 6 7 8 9 10 11' ctrl='12 13 14' act='15 "
      "16' time='17' "
      "mpos='18 19 20' mquat='.6 .8 0 0'/><key name='v' time='3'/><key name='w' ctrl='0 0 2'/></keyframe>");
  ASSERT_EQ(m.a->n.configurations, m.b->n.configurations);
  const auto state = [](const Model& x, Index k) {
    const std::ptrdiff_t n = x.n.nv + x.n.nu + x.n.na + 1;
    Numbers out;
    add(out, x.configurations() + std::ptrdiff_t(k) * x.n.nq, x.n.nq), add(out, x.configuration_state(k), n);
    add(out, x.configuration_mocaps() + std::ptrdiff_t(k) * x.n.mocaps * 12, 12);
    return out;
  };
  for (Index k = 0; k < m.a->n.configurations; ++k) {
    EXPECT_STREQ(m.a->string(m.a->configuration_names()[k]), m.b->string(m.b->configuration_names()[k]));
    expect_same(state(*m.a, k), state(*m.b, k), m.a->string(m.a->configuration_names()[k]));
  }
  EXPECT_EQ(m.a->simulation()->initial, m.b->simulation()->initial);
}

TEST(MjcfAgain, ContactsAndCompliances) {
  const Both m(
      "<option impratio='4' cone='elliptic' timestep='.004' integrator='implicitfast'/><worldbody><geom name='floor' "
      "type='plane' size='1 1 1' "
      "friction='.7 .01 .002'/><body name='one' pos='0 0 1'><joint name='j' type='slide' axis='0 0 1' range='-1 1' "
      "solreflimit='.03 2' "
      "solimplimit='.6 .7 .02 .3 1' solreffriction='.05 3' frictionloss='1'/><geom name='a' size='.1' solref='-1e4 -20' "
      "solmix='3' margin='.01' condim='6' "
      "friction='.5 .02 .003' priority='1' surfacevel='1 2 3'/></body><body name='two' pos='0 0 2'><joint name='k' "
      "type='slide' axis='0 0 1'/>"
      "<geom name='b' size='.1' solref='.05 2' solimp='.7 .8 .01 .4 3' contype='2' conaffinity='4' "
      "condim='1'/></body></worldbody>"
      "<contact><pair geom1='a' geom2='b' condim='4' friction='.9 .9 .04 0 0' solref='.03 1.5' solreffriction='.07 2' "
      "solimp='.5 .6 .02 .3 1' "
      "margin='.2'/><exclude body1='one' body2='world'/></contact>"
      "<equality><weld name='w' body1='one' body2='two' torquescale='.7' solref='.05 2' solimp='.7 .8 .01 .4 3'/>"
      "<joint name='c' joint1='j' joint2='k' polycoef='.1 2 3 4 5' solref='.06 3' active='false'/></equality>");
  const Model &a = *m.a, &b = *m.b;
  EXPECT_EQ(a.simulation()->dt, b.simulation()->dt);
  EXPECT_EQ(a.simulation()->integrator, b.simulation()->integrator);
  ASSERT_EQ(a.n.compliances, b.n.compliances);
  EXPECT_EQ(a.compliances()[0].ratio, b.compliances()[0].ratio);
  EXPECT_EQ(a.compliances()[0].pyramidal, b.compliances()[0].pyramidal);
  for (Index k = 0; k < a.n.compliances; ++k)
    expect_same(of(a.compliances()[k].law), of(b.compliances()[k].law), "compliance " + std::to_string(k), 1e-12);
  ASSERT_EQ(a.n.shapes, b.n.shapes);
  for (Index k = 0; k < a.n.shapes; ++k) {
    const ShapeRecord &x = a.shapes()[k], &y = b.shapes()[k];
    EXPECT_EQ(x.latent, y.latent);
    EXPECT_EQ(x.priority, y.priority);
    EXPECT_EQ(x.radius, y.radius);
    const dynMaterial &u = a.materials()[x.material], &v = b.materials()[y.material];
    expect_same({u.friction, u.torsion, u.rolling, u.restitution, u.surface_velocity[0], u.surface_velocity[2]},
                {v.friction, v.torsion, v.rolling, v.restitution, v.surface_velocity[0], v.surface_velocity[2]},
                a.string(x.name));
  }
  ASSERT_EQ(a.n.disabled, b.n.disabled);
  ASSERT_EQ(1, b.n.disabled);
  ASSERT_EQ(a.n.constraints, b.n.constraints);
  for (Index k = 0; k < a.n.constraints; ++k) {
    const dynConstraint &x = a.constraints()[k].spec, &y = b.constraints()[k].spec;
    EXPECT_EQ(x.enabled, y.enabled);
    expect_same(Numbers(x.coefficients, x.coefficients + 5), Numbers(y.coefficients, y.coefficients + 5), "coefficients");
  }
}

// Flags that switch effects off are written, one by one.
TEST(MjcfAgain, EffectsThatAreOff) {
  for (const char* flag : {"limit", "frictionloss", "spring", "damper", "passive", "actuation", "filterparent"}) {
    const Both m("<option><flag " + std::string(flag) +
                 "='disable'/></option><worldbody><body name='a'><joint/><geom size='.1'/><body "
                 "name='b' pos='0 0 1'><joint/><geom size='.1'/></body></body></worldbody>");
    EXPECT_EQ(m.a->simulation()->effects, m.b->simulation()->effects) << flag;
    for (Index k = 0; k < m.a->n.shapes; ++k) EXPECT_EQ(m.a->shapes()[k].filter, m.b->shapes()[k].filter) << flag;
    EXPECT_EQ(m.a->n.pairs, m.b->n.pairs) << flag;
  }
}

TEST(MjcfAgain, ShapesAndFluidForces) {
  const Both m(
      "<asset><hfield name='h' nrow='2' ncol='3' size='2 1 .8 .5' elevation='4 5 9 1 2 3'/><mesh name='t' vertex='0 0 0 1 0 0 "
      "0 1 0 0 0 1' "
      "face='0 2 1 0 1 3 1 2 3 0 3 2'/></asset><option density='1' viscosity='2'/><worldbody><geom type='hfield' hfield='h'/>"
      "<body><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/><geom name='e' type='ellipsoid' size='.1 .2 .3' "
      "fluidshape='ellipsoid' "
      "fluidcoef='.1 .2 .3 .4 .5' rgba='.2 .4 .6 .8'/><geom name='c' type='cylinder' size='.1 .2' pos='1 2 3' quat='.6 .8 0 "
      "0'/>"
      "<geom name='b' type='box' size='.1 .2 .3'/><geom name='p' type='capsule' size='.1 .2' contype='0' conaffinity='0' "
      "rgba='1 0 0 1'/>"
      "</body></worldbody>");
  ASSERT_EQ(m.a->n.shapes, m.b->n.shapes);
  for (Index k = 0; k < m.a->n.shapes; ++k) {
    const ShapeRecord &x = m.a->shapes()[k], &y = m.b->shapes()[k];
    EXPECT_EQ(x.type, y.type);
    EXPECT_EQ(x.role, y.role);
    EXPECT_EQ(x.colour, y.colour);
    expect_same(Numbers(x.size, x.size + 3), Numbers(y.size, y.size + 3), "sizes");
    expect_same(Numbers(x.placement, x.placement + 12), Numbers(y.placement, y.placement + 12), "placement");
  }
  ASSERT_EQ(1, m.b->n.fluid_shapes);
  const FluidEllipsoid &x = m.a->fluid_ellipsoids()[0], &y = m.b->fluid_ellipsoids()[0];
  expect_same(Numbers(x.coefficients, x.coefficients + 5), Numbers(y.coefficients, y.coefficients + 5), "coefficients");
  expect_same(Numbers(x.half, x.half + 3), Numbers(y.half, y.half + 3), "semiaxes");
  // heights, from the lowest of the written ones on
  ASSERT_EQ(1, m.b->n.grids);
  ASSERT_EQ(m.a->n.surface_numbers, m.b->n.surface_numbers);
  for (Index k = 0; k < m.a->n.surface_numbers; ++k)
    EXPECT_NEAR(m.a->surface_numbers()[k], m.b->surface_numbers()[k], 1e-14) << k;
}

}  // namespace
}  // namespace dyn_test::mjcf_again
