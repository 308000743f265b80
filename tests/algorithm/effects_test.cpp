// What joints do beside moving bodies, switched on and off joint by joint.
#include "algorithm/rates.hpp"
#include "algorithm/aba_derivatives.hpp"
#include "algorithm/energy.hpp"
#include "algorithm/gravity_derivatives.hpp"
#include "algorithm/second_order_tensors.hpp"
#include "integrator/runge_kutta.hpp"

namespace dyn_test {
namespace {

TreeOptions resisting(int joints) {
  TreeOptions options;
  options.joints = joints, options.resistance = 0.6;
  return options;
}

// Slow enough that dry friction is not saturated everywhere.
void slow_down(Case& c) {
  for (Index k = 0; k < c.nv; k += 2) c.x.v[k] *= 0.02;
  c.w.v(c.x.v);
}

// r(q, v) by its definition: the part that dissipates, and all of it.
static_assert(DYN_EFFECT_ALL == 0xdff,
              "an effect that joints have beside their rotors is defined here");
VectorXd dissipative(const Case& c) {
  VectorXd r(c.nv);
  for (Index k = 0; k < c.nv; ++k)
    r[k] = c.m.damping()[k] * c.x.v[k] + c.m.friction()[k] * std::tanh(c.x.v[k] / DYN_FRICTION_VELOCITY);
  return r;
}
VectorXd resistance(const Case& c) {
  VectorXd r(c.nv), e(c.nv);
  difference(c.m, c.m.spring_reference(), c.x.q.data(), e.data());
  for (Index j = 1; j < c.m.n.joints; ++j) {
    const JointRecord& joint = c.m.joints()[j];
    if (joint.type == DYN_JOINT_TYPE_CONTINUOUS && joint.nv)
      e[joint.idx_v] = c.x.q[joint.idx_q] - c.m.spring_reference()[joint.idx_q];  // turns count
  }
  for (Index k = 0; k < c.nv; ++k) r[k] = c.m.stiffness()[k] * e[k];
  return dissipative(c) + r;
}

void set_effects(Case& c, std::uint32_t on) {
  std::fill_n(c.w.d.effects, c.m.n.joints, on);
  apply_effects(c.m, c.w.d);
}

TEST(Effects, InverseDynamicsAddsThem) {
  for_trees(
      [](Case& c) {
        slow_down(c);
        const VectorXd with = c.rnea(c.x.v, c.x.a);
        set_effects(c, DYN_EFFECT_ARMATURE);
        const VectorXd without = c.rnea(c.x.v, c.x.a);
        EXPECT_LE(gap(with - without, resistance(c)), tol * (c.terms(c.x.a) + largest(with)));
        set_effects(c, 0);
        VectorXd rotors = without;
        for (Index k = 0; k < c.nv; ++k) rotors[k] -= c.m.armature()[k] * c.x.a[k];
        EXPECT_LE(gap(c.rnea(c.x.v, c.x.a), rotors), tol * c.terms(c.x.a));
      },
      200, resisting(0));
}

TEST(Effects, ForwardDynamicsIsTheInverse) {
  for_trees(
      [](Case& c) {
        slow_down(c);
        const VectorXd tau = c.rnea(c.x.v, c.x.a);
        const MatrixXd M = c.M();
        EXPECT_LE(gap(M * (c.aba(tau) - c.x.a), VectorXd::Zero(c.nv)), 1e-12 * (c.terms(c.x.a) + largest(tau)));
      },
      200, resisting(0));
}

// Only what the joint itself has goes, when one is switched off.
TEST(Effects, OfOneJoint) {
  for_trees(
      [](Case& c) {
        slow_down(c);
        const VectorXd r = resistance(c), with = c.rnea(c.x.v, c.x.a);
        for (Index j = 1; j < c.m.n.joints; ++j) {
          const JointRecord& joint = c.m.joints()[j];
          set_effects(c, DYN_EFFECT_ALL);
          c.w.d.effects[j] = DYN_EFFECT_ARMATURE;
          apply_effects(c.m, c.w.d);
          VectorXd expected = with;
          expected.segment(joint.idx_v, joint.nv) -= r.segment(joint.idx_v, joint.nv);
          EXPECT_LE(gap(c.rnea(c.x.v, c.x.a), expected), tol * (c.terms(c.x.a) + largest(with)));
        }
      },
      40, resisting(8));
}

TEST(Effects, DerivativesOfInverseDynamics) {
  for_trees(
      [](Case& c) {
        slow_down(c);
        Work<Quad> w(c.m, DYN_PART_INVERSE);
        auto tau = [&](const Quads& q, const Quads& v, const Quads&) {
          Quads out(std::size_t(c.nv));
          w.q(q).v(v).a(c.x.a);
          inverse_dynamics<Quad>(c.m, w.d, w.d.v, w.d.a, nullptr, out.data());
          return out;
        };
        rnea_derivatives<double>(c.m, c.w.d, c.w.d.v, c.w.d.a, nullptr);
        const MatrixXd dq = by_q(c, tau), dv = by_v(c, tau);
        const double scale = c.terms(c.x.a) + largest(dq);
        EXPECT_LE(gap(matrix(c.w.d.dtau_dq, c.nv, c.nv), dq), tol * scale);
        EXPECT_LE(gap(matrix(c.w.d.dtau_dv, c.nv, c.nv), dv), tol * (scale + largest(dv)));
        EXPECT_LE(gap(matrix(c.w.d.tau, c.nv), c.rnea(c.x.v, c.x.a)), tol * scale);
      },
      60, resisting(10));
}

TEST(Effects, DerivativesOfForwardDynamics) {
  for_trees(
      [](Case& c) {
        slow_down(c);
        const Quads tau(c.x.tau.begin(), c.x.tau.end());
        Work<Quad> w(c.m);
        auto ddq = [&](const Quads& q, const Quads& v, const Quads&) {
          Quads out(std::size_t(c.nv));
          w.q(q).v(v);
          EXPECT_EQ(0, forward_dynamics<Quad>(c.m, w.d, w.d.v, tau.data(), nullptr, out.data()));
          return out;
        };
        ASSERT_EQ(0, aba_derivatives<double>(c.m, c.w.d, c.w.d.v, c.w.d.tau_applied, nullptr));
        const MatrixXd dq = by_q(c, ddq), dv = by_v(c, ddq), Minv = matrix(c.w.d.Minv, c.nv, c.nv);
        const MatrixXd dtau_dq = matrix(c.w.d.dtau_dq, c.nv, c.nv), dtau_dv = matrix(c.w.d.dtau_dv, c.nv, c.nv);
        const double grow = (Minv.cwiseAbs() * c.M().cwiseAbs()).maxCoeff();
        EXPECT_LE(gap(matrix(c.w.d.ddq_dq, c.nv, c.nv), dq), 1e-13 * grow * (Minv.cwiseAbs() * dtau_dq.cwiseAbs()).maxCoeff());
        EXPECT_LE(gap(matrix(c.w.d.ddq_dv, c.nv, c.nv), dv), 1e-13 * grow * (Minv.cwiseAbs() * dtau_dv.cwiseAbs()).maxCoeff());
      },
      40, resisting(8));
}

TEST(Effects, SecondOrder) {
  for_trees(
      [](Case& c) {
        slow_down(c);
        Dice dice(9);
        const auto lambda = dice.vector(c.nv);
        Work<Quad> w(c.m);
        auto gradient = [&](Quad* Data<Quad>::*of) {
          return [&, of](const Quads& q, const Quads& v, const Quads& a) {
            w.q(q).v(v).a(a);
            rnea_derivatives<Quad>(c.m, w.d, w.d.v, w.d.a, nullptr);
            Quads out;
            for (Index j = 0; j < c.nv; ++j) {
              Quad sum(0);
              for (Index i = 0; i < c.nv; ++i) sum += Quad(lambda[i]) * (w.d.*of)[i + j * c.nv];
              out.push_back(sum);
            }
            return out;
          };
        };
        Data<double>& d = c.w.d;
        second_order_columns<double>(c.m, d, d.v, d.a, nullptr);
        second_order_product<double>(c.m, d, lambda.data(),
                                     {d.lambda_d2tau_dqdq, d.lambda_d2tau_dvdv, d.lambda_d2tau_dqdv, d.lambda_d2tau_dadq});
        const MatrixXd qq = by_q(c, gradient(&Data<Quad>::dtau_dq)), vv = by_v(c, gradient(&Data<Quad>::dtau_dv));
        const double scale = c.terms(c.x.a) + largest(qq) + 10;
        EXPECT_LE(gap(matrix(d.lambda_d2tau_dqdq, c.nv, c.nv), qq), tol * scale) << "dqdq";
        EXPECT_LE(gap(matrix(d.lambda_d2tau_dvdv, c.nv, c.nv), vv), tol * (scale + largest(vv))) << "dvdv";
        const std::ptrdiff_t square = std::ptrdiff_t(c.nv) * c.nv;
        VectorXd of_q(square * c.nv), of_v(square * c.nv);
        second_order_derivatives<double>(c.m, d, {of_q.data(), of_v.data(), nullptr, nullptr});
        MatrixXd sum_q = MatrixXd::Zero(c.nv, c.nv), sum_v = sum_q;
        for (Index i = 0; i < c.nv; ++i)
          sum_q += lambda[i] * matrix(of_q.data() + square * i, c.nv, c.nv),
              sum_v += lambda[i] * matrix(of_v.data() + square * i, c.nv, c.nv);
        EXPECT_LE(gap(sum_q, qq), tol * scale);
        EXPECT_LE(gap(sum_v, vv), tol * (scale + largest(vv)));
      },
      40, resisting(8));
}

TEST(Effects, OfStaticTorqueButNotOfGravity) {
  for_trees(
      [](Case& c) {
        Work<Quad> w(c.m, DYN_PART_INVERSE | DYN_PART_ENERGY);
        auto at_rest = [&](auto&& f) {
          return [&w, &c, f](const Quads& q, const Quads&, const Quads&) {
            Quads out(std::size_t(c.nv));
            w.q(q);
            f(out.data());
            return out;
          };
        };
        const MatrixXd all =
            by_q(c, at_rest([&](Quad* out) { inverse_dynamics<Quad>(c.m, w.d, w.d.zero, w.d.zero, nullptr, out); }));
        const MatrixXd weight =
            by_q(c, at_rest([&](Quad* out) { rigid_inverse_dynamics<Quad>(c.m, w.d, w.d.zero, w.d.zero, nullptr, out); }));
        static_torque_derivatives<double>(c.m, c.w.d, nullptr, c.w.d.dstatic_torque_dq);
        gravity_derivatives<double>(c.m, c.w.d, nullptr, c.w.d.dg_dq);
        const double scale = c.terms(c.x.a) + largest(all);
        EXPECT_LE(gap(matrix(c.w.d.dstatic_torque_dq, c.nv, c.nv), all), tol * scale);
        EXPECT_LE(gap(matrix(c.w.d.dg_dq, c.nv, c.nv), weight), tol * scale);
        // and it is the gradient of the potential energy
        const MatrixXd gradient = by_q(c, [&](const Quads& q, const Quads&, const Quads&) {
          w.q(q);
          potential_energy(c.m, w.d);
          return Quads{w.d.potential[0]};
        });
        EXPECT_LE(gap(gradient.transpose(), c.gravity()), tol * scale);
      },
      60, resisting(10));
}

// dE/dt = v . (tau - damping v - friction)
TEST(Effects, PowerBalance) {
  for_trees(
      [](Case& c) {
        slow_down(c);
        Work<Quad> w(c.m);
        const VectorXd ddq = c.aba(c.x.tau);
        auto energy = [&](Quad t) {
          w.q(on_path(c.m, c.x.q, c.x.v, ddq, t));
          Quads v;
          for (Index k = 0; k < c.nv; ++k) v.emplace_back(Quad(c.x.v[k]) + t * Quad(ddq[k]));
          w.v(v);
          kinetic_energy(c.m, w.d), potential_energy(c.m, w.d);
          return Quads{w.d.kinetic[0] + w.d.potential[0]};
        };
        const VectorXd net = c.x.tau - dissipative(c);
        const double power = c.x.v.dot(net), scale = (c.x.v.cwiseAbs().transpose() * c.M().cwiseAbs() * ddq.cwiseAbs())(0) +
                                                     c.x.v.cwiseAbs().sum() * c.terms(ddq);
        EXPECT_LE(std::abs(rate(energy, 1)(0, 0) - power), 1e-12 * scale);
      },
      60, resisting(12));
}

// A wheel on a spring, with damping and dry friction one at a time, against closed forms.
struct Wheel {
  ModelPtr model;
  Work<double> w;
  explicit Wheel(const JointSpec& s)
      : model([&] {
          Builder b("wheel");
          b.gravity({0, 0, 0});
          b.joint(s);
          b.body("disc", {s.name, 0}, identity_placement, 1, {0, 0, 0}, {2, 0, 0, 0, 2, 0, 0, 0, 2});
          return b.finish();
        }()),
        w(*model) {}
};
JointSpec wheel() {
  JointSpec s;
  s.name = "axle", s.type = DYN_JOINT_TYPE_REVOLUTE;
  return s;
}

TEST(Effects, RungeKuttaOnDampedOscillation) {
  JointSpec s = wheel();
  s.stiffness = {18}, s.damping = {1.2}, s.spring_reference = {0.3};  // I = 2: omega_0 = 3, delta = 0.3
  Wheel x(s);
  x.w.q(std::vector{1.3});
  for (int k = 0; k < 2000; ++k) ASSERT_EQ(0, take_step(*x.model, x.w.d, DYN_INTEGRATOR_RK4, 1e-3));
  const double t = 2, delta = 0.3, omega = std::sqrt(9 - delta * delta);
  EXPECT_NEAR(0.3 + std::exp(-delta * t) * (std::cos(omega * t) + delta / omega * std::sin(omega * t)), x.w.d.q[0], 1e-11);
}

// No coefficient is too large for the semi-implicit step: v decays and never changes its sign.
TEST(Effects, StiffDampingAndFrictionStayStable) {
  for (const double damping : {0., 1e9})
    for (const double friction : {0., 1e7}) {
      JointSpec s = wheel();
      s.damping = {damping}, s.friction = {friction};
      Wheel x(s);
      x.w.v(std::vector{5.});
      double before = 5;
      for (int k = 0; k < 1000; ++k) {
        ASSERT_EQ(0, take_step(*x.model, x.w.d, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-2));
        ASSERT_LE(0, x.w.d.v[0]);
        ASSERT_LE(x.w.d.v[0], before);
        before = x.w.d.v[0];
      }
      EXPECT_LE(before, damping + friction > 0 ? 1e-9 : 5);
    }
}

// Dry friction stops a sliding disc when v^2 I / (2 friction) of path is used up, but for the viscous creep.
TEST(Effects, DryFrictionStops) {
  JointSpec s = wheel();
  s.friction = {0.5};
  Wheel x(s);
  x.w.v(std::vector{2.});
  for (int k = 0; k < 100000; ++k) ASSERT_EQ(0, take_step(*x.model, x.w.d, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-4));
  // 4 s of -0.25 rad/s^2 a second: 2^2 * 2 / (2 * 0.5) / 2 = 8 ... less what tanh lacks
  EXPECT_NEAR(2. * 2 * 2 / (2 * 0.5), x.w.d.q[0], 2e-3);
  EXPECT_LE(x.w.d.v[0], 1e-12);
}

TEST(Effects, TwoSpringsOfAFollowerAreOne) {
  Builder b("pair");
  JointSpec leader = wheel(), follower = wheel();
  leader.stiffness = {3}, leader.spring_reference = {0.5};
  follower.name = "follower", follower.mimic = "axle", follower.mimic_ratio = -2, follower.mimic_offset = 0.1;
  follower.stiffness = {5}, follower.spring_reference = {0.7};
  b.gravity({0, 0, 0});
  for (const JointSpec& s : {leader, follower}) {
    b.joint(s);
    b.body(s.name + "_disc", {s.name, 0}, identity_placement, 1, {0, 0, 0}, {2, 0, 0, 0, 2, 0, 0, 0, 2});
  }
  const ModelPtr m = b.finish();
  Work<double> w(*m);
  for (const double q : {-1., 0., 0.4}) {
    w.q(std::vector{q});
    double tau;
    inverse_dynamics<double>(*m, w.d, w.d.zero, w.d.zero, nullptr, &tau);
    EXPECT_NEAR(3 * (q - 0.5) - 2 * 5 * (-2 * q + 0.1 - 0.7), tau, 1e-13);
  }
  const ModelPtr copy = Builder(*m).finish();
  EXPECT_EQ(m->stiffness()[0], copy->stiffness()[0]);
  EXPECT_EQ(m->spring_reference()[0], copy->spring_reference()[0]);
}

// The derivative of Jlog3^T l, through the angles where its coefficients change their formula.
TEST(Effects, DerivativeOfTheLogarithmsJacobian) {
  Dice dice(31);
  for (const double angle : {0., 1e-9, 1e-3, 0.3, 0.999999, 1.000001, 2., 3., 3.1415}) {
    const V3 w = dice.direction() * angle, l = dice.direction();
    const Mat3<double> H = dJlog3(Vec3<double>::make(w[0], w[1], w[2]), Vec3<double>::make(l[0], l[1], l[2]));
    for (int k = 0; k < 3; ++k) {
      auto row = [&](Quad t) {
        const Mat3<Quad> J =
            Jlog3(Vec3<Quad>::make(Quad(w[0]) + (k == 0 ? t : 0), Quad(w[1]) + (k == 1 ? t : 0), Quad(w[2]) + (k == 2 ? t : 0)));
        Quads out;
        for (int c = 0; c < 3; ++c) out.push_back(J(0, c) * Quad(l[0]) + J(1, c) * Quad(l[1]) + J(2, c) * Quad(l[2]));
        return out;
      };
      const MatrixXd expected = rate(row, 3);
      for (int r = 0; r < 3; ++r) EXPECT_NEAR(expected(r, 0), H(r, k), 1e-13 * (1 + 1 / (3.1416 - angle))) << angle;
    }
  }
}

}  // namespace
}  // namespace dyn_test
