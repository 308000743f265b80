// Derivatives of frame motions, Jacobians, the centre of mass and the forces at rest, against differences in quadruple precision.
#include "algorithm/rates.hpp"
#include "algorithm/center_of_mass_derivatives.hpp"
#include "algorithm/frame_derivatives.hpp"
#include "algorithm/gravity_derivatives.hpp"
#include "algorithm/rnea.hpp"

namespace dyn_test {
namespace {

constexpr double stale = 7.25e77;

// 6 x nv numbers that the call must write all of.
struct Columns {
  VectorXd x;
  explicit Columns(Index n) : x(VectorXd::Constant(n, stale)) {}
  operator double*() { return x.data(); }
  MatrixXd matrix(Index rows) const { return Eigen::Map<const MatrixXd>(x.data(), rows, x.size() / std::max<Index>(rows, 1)); }
};

// The world, a merged link or user frame, and frames of joints.
std::vector<Index> some_frames(const Model& m) {
  std::vector<Index> out = {0, m.n.frames - 1};
  for (Index f = 1; f < m.n.frames - 1; f += 1 + m.n.frames / 4) out.push_back(f);
  return out;
}

void expect_near(const Columns& got, const MatrixXd& expected, double scale, const char* what) {
  EXPECT_LE(gap(got.matrix(6), expected), tol * (scale + largest(expected))) << what;
}

// f(frame, reference) of some frames, in each reference.
template <class F>
void for_frames(const Model& m, F&& f) {
  for (Index frame : some_frames(m))
    for (dynReference r : references) f(frame, r);
}

TEST(FrameDerivatives, OfVelocityAndAccelerations) {
  for_trees(
      [](Case& c) {
        Work<Quad> w(c.m);
        // of each frame in each reference: velocity, spatial and classical acceleration
        auto motions = [&](const Quads& q, const Quads& v, const Quads& a) {
          Quads out;
          w.q(q).v(v).a(a);
          forward_kinematics<2>(c.m, w.d);
          for_frames(c.m, [&](Index frame, dynReference r) {
            Quad x[18];
            frame_velocity(c.m, w.d, frame, r, x);
            for (bool classical : {false, true}) frame_acceleration(c.m, w.d, frame, r, classical, x + 6 + 6 * classical);
            out.insert(out.end(), x, x + 18);
          });
          return out;
        };
        const MatrixXd by_each[] = {by_q(c, motions), by_v(c, motions), by(c, input_a, motions)};
        forward_kinematics<2>(c.m, c.w.d);
        Eigen::Index row = 0;
        for_frames(c.m, [&](Index frame, dynReference r) {
          SCOPED_TRACE(testing::Message() << "frame " << frame << " reference " << r);
          auto expected = [&](int input) { return MatrixXd(by_each[input].middleRows(row, 6)); };
          const Index n = 6 * c.nv;
          Columns dv_dq(n), dv_dv(n);
          frame_velocity_derivatives<double>(c.m, c.w.d, frame, r, dv_dq, dv_dv);
          expect_near(dv_dq, expected(0), 1, "dv_dq"), expect_near(dv_dv, expected(1), 1, "dv_dv");
          frame_velocity_derivatives<double>(c.m, c.w.d, frame, r, nullptr, nullptr);
          row += 6;
          for (bool classical : {false, true}) {
            Columns da_dq(n), da_dv(n), da_da(n);
            frame_acceleration_derivatives<double>(c.m, c.w.d, frame, r, classical, da_dq, da_dv, da_da);
            const MatrixXd dq = expected(0);
            expect_near(da_dq, dq, 1, "da_dq"), expect_near(da_dv, expected(1), 1 + largest(dq), "da_dv");
            expect_near(da_da, expected(2), 1, "da_da");
            row += 6;
          }
        });
      },
      25, up_to(8));
}

TEST(FrameDerivatives, KinematicHessian) {
  for_trees(
      [](Case& c) {
        Work<Quad> w(c.m);
        const std::size_t size = std::size_t(6 * c.nv);
        auto jacobians = [&](const Quads& q, const Quads&, const Quads&) {
          Quads out;
          w.q(q);
          forward_kinematics<0>(c.m, w.d);
          for_frames(c.m, [&](Index frame, dynReference r) {
            out.resize(out.size() + size);
            frame_jacobian(c.m, w.d, frame, r, out.data() + out.size() - size);
          });
          return out;
        };
        const MatrixXd all = by_q(c, jacobians);
        forward_kinematics<0>(c.m, c.w.d);
        Eigen::Index row = 0;
        for_frames(c.m, [&](Index frame, dynReference r) {
          Columns H(6 * c.nv * c.nv);
          frame_kinematic_hessian<double>(c.m, c.w.d, frame, r, H);
          const MatrixXd expected = all.middleRows(row, Eigen::Index(size));
          EXPECT_LE(gap(H.matrix(6 * c.nv), expected), tol * (1 + largest(expected)))
              << "frame " << frame << " reference " << r;
          row += Eigen::Index(size);
        });
      },
      40, up_to(10));
}

// J' = sum of H_k v_k
TEST(FrameDerivatives, HessianTimesVelocityIsTheRateOfTheJacobian) {
  for_trees([](Case& c) {
    if (c.nv > 60) return;
    forward_kinematics<1>(c.m, c.w.d);
    for (dynReference r : references) {
      Columns H(6 * c.nv * c.nv), dJ(6 * c.nv);
      frame_kinematic_hessian<double>(c.m, c.w.d, c.m.n.frames - 1, r, H);
      frame_jacobian_time_variation<double>(c.m, c.w.d, c.m.n.frames - 1, r, dJ);
      EXPECT_LE(gap(H.matrix(6 * c.nv) * c.x.v, dJ.x), tol * (1 + (H.matrix(6 * c.nv).cwiseAbs() * c.x.v.cwiseAbs()).maxCoeff()))
          << r;
    }
  });
}

TEST(CenterOfMassDerivatives, OfVelocity) {
  for_trees(
      [](Case& c) {
        Work<Quad> w(c.m);
        auto velocity = [&](const Quads& q, const Quads& v, const Quads&) {
          w.q(q).v(v);
          center_of_mass(c.m, w.d, 1);
          return Quads(w.d.vcom, w.d.vcom + 3);
        };
        std::fill_n(c.w.d.dvcom_dq, 3 * c.nv, stale), std::fill_n(c.w.d.Jcom, 3 * c.nv, stale);
        center_of_mass_velocity_derivatives(c.m, c.w.d);
        const MatrixXd dq = by_q(c, velocity), dv = by_v(c, velocity);
        EXPECT_LE(gap(matrix(c.w.d.dvcom_dq, 3, c.nv), dq), tol * (1 + largest(dq)));
        EXPECT_LE(gap(matrix(c.w.d.Jcom, 3, c.nv), dv), tol * (1 + largest(dv)));
      },
      60, up_to(12));
}

TEST(GravityDerivatives, OfGravityAndStaticTorque) {
  for_trees(
      [](Case& c) {
        Dice dice(7);
        const auto fext = dice.vector(6 * c.m.n.joints, 10);
        const Quads f(fext.begin(), fext.end());
        Work<Quad> w(c.m, DYN_PART_INVERSE);
        for (bool external : {false, true}) {
          auto torque = [&](const Quads& q, const Quads&, const Quads&) {
            Quads out(std::size_t(c.nv));
            w.q(q);
            inverse_dynamics<Quad>(c.m, w.d, w.d.zero, w.d.zero, external ? f.data() : nullptr, out.data());
            return out;
          };
          double* got = external ? c.w.d.dstatic_torque_dq : c.w.d.dg_dq;
          gravity_derivatives(c.m, c.w.d, external ? fext.data() : nullptr, got);
          const MatrixXd expected = by_q(c, torque);
          EXPECT_LE(gap(matrix(got, c.nv, c.nv), expected), tol * (largest(c.gravity()) + largest(expected) + 10)) << external;
        }
      },
      60, up_to(12));
}

// They are those of inverse dynamics at rest, also in trees of many branches.
TEST(GravityDerivatives, AgreeWithInverseDynamicsAtRest) {
  for_trees([](Case& c) {
    Dice dice(8);
    const auto fext = dice.vector(6 * c.m.n.joints, 10);
    rnea_derivatives<double>(c.m, c.w.d, c.w.d.zero, c.w.d.zero, fext.data());
    gravity_derivatives<double>(c.m, c.w.d, fext.data(), c.w.d.dstatic_torque_dq);
    const MatrixXd expected = matrix(c.w.d.dtau_dq, c.nv, c.nv);
    EXPECT_LE(gap(matrix(c.w.d.dstatic_torque_dq, c.nv, c.nv), expected), tol * largest(expected));
  });
}

}  // namespace
}  // namespace dyn_test
