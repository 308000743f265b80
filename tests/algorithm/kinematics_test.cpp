// Placements, velocities, accelerations and Jacobians of frames, against differences of placements in quadruple precision.
#include "algorithm/jacobian.hpp"

#include "algorithm/trees.hpp"

namespace dyn_test {
namespace {

// A frame carried by some joint of the tree, one for each seed.
Index some_frame(const Case& c) {
  const Index f = Index(c.x.q.size() * 31 % c.m.n.frames);
  return f ? f : c.m.n.frames - 1;
}

// Positions in quadruple precision along the case's path.
struct Path {
  const Case& c;
  Index frame;
  Work<Quad> w;
  Path(const Case& c_, Index f) : c(c_), frame(f), w(c_.m, DYN_PART_KINEMATICS) {}
  Quads placement(Quad t, const VectorXd& v, const VectorXd& a) {
    forward_kinematics<0>(c.m, w.q(on_path(c.m, c.x.q, v, a, t)).d);
    Quads X(12);
    frame_placement(c.m, w.d, frame, X.data());
    return X;
  }
  // [dp/dt; omega] of the frame's origin, world axes
  V6 velocity(const VectorXd& v) {
    const VectorXd none = VectorXd::Zero(v.size());
    const MatrixXd dX = rate([&](Quad t) { return placement(t, v, none); }, 12);
    const Quads X = placement(Quad(0), v, none);
    const M3 W = M3(dX.data()) * M3(matrix(X.data(), 9).data()).transpose();
    V6 out;
    out << dX.bottomRows(3), W(2, 1), W(0, 2), W(1, 0);
    EXPECT_LE(gap(W, -W.transpose()), 1e-14 * (1 + largest(W)));
    return out;
  }
};
V6 expressed(const M4& X, dynReference reference, const V6& at_origin) {
  const V3 p = X.topRightCorner<3, 1>(), w = at_origin.tail<3>();
  const M3 R = X.topLeftCorner<3, 3>();
  V6 out = at_origin;
  if (reference == DYN_REFERENCE_WORLD) out.head<3>() += p.cross(w);
  if (reference == DYN_REFERENCE_LOCAL) out << R.transpose() * at_origin.head<3>(), R.transpose() * w;
  return out;
}
M4 pose(Case& c, Index frame) {
  double X[12];
  frame_placement(c.m, c.w.d, frame, X);
  return eigen(X);
}

TEST(Kinematics, VelocityIsTheRateOfThePlacement) {
  for_trees([](Case& c) {
    const Index f = some_frame(c);
    const V6 expected = Path(c, f).velocity(c.x.v);
    forward_kinematics<1>(c.m, c.w.d);
    for (dynReference r : references) {
      V6 v;
      frame_velocity(c.m, c.w.d, f, r, v.data());
      EXPECT_LE(gap(v, expressed(pose(c, f), r, expected)), tol * (1 + largest(v)));
    }
  });
}

TEST(Kinematics, JacobianTimesVelocityIsTheFramesVelocity) {
  for_trees([](Case& c) {
    forward_kinematics<1>(c.m, c.w.d);
    MatrixXd J(6, c.nv);
    for (Index f = 0; f < c.m.n.frames; f += 1 + c.m.n.frames / 7)
      for (dynReference r : references) {
        V6 v;
        frame_velocity(c.m, c.w.d, f, r, v.data());
        J.setConstant(777);  // fully written
        frame_jacobian(c.m, c.w.d, f, r, J.data());
        EXPECT_LE(gap(J * c.x.v, v), tol * (1 + largest(J)));
      }
  });
}

TEST(Kinematics, JacobianColumnsAreRatesOfThePlacement) {
  TreeOptions small;
  small.joints = 6;
  for_trees(
      [](Case& c) {
        const Index f = c.m.n.frames - 1;
        Path path(c, f);
        forward_kinematics<0>(c.m, c.w.d);
        MatrixXd J(6, c.nv);
        frame_jacobian(c.m, c.w.d, f, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, J.data());
        for (Index k = 0; k < c.nv; ++k) EXPECT_LE(gap(path.velocity(VectorXd::Unit(c.nv, k)), J.col(k)), tol * (1 + largest(J)));
      },
      100, small);
}

TEST(Kinematics, JointJacobiansAreThoseOfTheJointsFrames) {
  for_trees(
      [](Case& c) {
        joint_jacobians_time_variation(c.m, c.w.d);
        const MatrixXd J = matrix(c.w.d.J, 6, c.nv), dJ = matrix(c.w.d.dJ, 6, c.nv);
        MatrixXd of_frame(6, c.nv);
        for (Index j = 1; j < c.m.n.joints; ++j) {
          const JointRecord& joint = c.m.joints()[j];
          if (c.m.has_mimic || joint.nv == 0) continue;
          frame_jacobian(c.m, c.w.d, joint_frame(c.m, j), DYN_REFERENCE_WORLD, of_frame.data());
          EXPECT_LE(gap(of_frame.middleCols(joint.idx_v, joint.nv), J.middleCols(joint.idx_v, joint.nv)), tol * (1 + largest(J)));
          frame_jacobian_time_variation(c.m, c.w.d, joint_frame(c.m, j), DYN_REFERENCE_WORLD, of_frame.data());
          EXPECT_LE(gap(of_frame.middleCols(joint.idx_v, joint.nv), dJ.middleCols(joint.idx_v, joint.nv)),
                    tol * (1 + largest(dJ)));
        }
      },
      100);
}

TEST(Kinematics, TimeVariationOfTheJacobianIsItsRate) {
  for_trees([](Case& c) {
    const Index f = some_frame(c);
    const VectorXd none = VectorXd::Zero(c.nv);
    Work<Quad> q(c.m, DYN_PART_KINEMATICS);
    forward_kinematics<1>(c.m, c.w.d);
    MatrixXd dJ(6, c.nv);
    for (dynReference r : references) {
      dJ.setConstant(777);
      frame_jacobian_time_variation(c.m, c.w.d, f, r, dJ.data());
      const MatrixXd expected = rate(
          [&](Quad t) {
            forward_kinematics<0>(c.m, q.q(on_path(c.m, c.x.q, c.x.v, none, t)).d);
            Quads J(std::size_t(6 * c.nv));
            frame_jacobian(c.m, q.d, f, r, J.data());
            return J;
          },
          6);
      EXPECT_LE(gap(dJ, expected), tol * (1 + largest(expected)));
    }
  });
}

TEST(Kinematics, TimeVariationOfTheJointJacobiansIsTheirRate) {
  for_trees(
      [](Case& c) {
        const VectorXd none = VectorXd::Zero(c.nv);
        Work<Quad> q(c.m, DYN_PART_JACOBIANS);
        joint_jacobians_time_variation(c.m, c.w.d);
        const MatrixXd expected = rate(
            [&](Quad t) {
              joint_jacobians(c.m, q.q(on_path(c.m, c.x.q, c.x.v, none, t)).d);
              return Quads(q.d.J, q.d.J + 6 * c.nv);
            },
            6);
        EXPECT_LE(gap(matrix(c.w.d.dJ, 6, c.nv), expected), tol * (1 + largest(expected)));
      },
      100);
}

TEST(Kinematics, ClassicalAccelerationIsTheSecondDerivativeOfThePosition) {
  for_trees([](Case& c) {
    const Index f = some_frame(c);
    Path path(c, f);
    const MatrixXd ddX = second_rate([&](Quad t) { return path.placement(t, c.x.v, c.x.a); }, 12);
    forward_kinematics<2>(c.m, c.w.d);
    const M4 X = pose(c, f);
    V6 v, a, spatial;
    frame_velocity(c.m, c.w.d, f, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, v.data());
    frame_acceleration(c.m, c.w.d, f, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, true, a.data());
    // ddR R^T = [alpha] + [omega]^2
    const M3 W = hat(v.tail<3>()), A = M3(ddX.data()) * X.topLeftCorner<3, 3>().transpose() - W * W;
    const double scale = 1 + largest(ddX) + largest(a) + largest(W * W);
    EXPECT_LE(gap(V3(a.head<3>()), ddX.bottomRows(3)), 10 * tol * scale);  // second differences: 1e-12 of |v|^4
    EXPECT_LE(gap(hat(a.tail<3>()), A), 10 * tol * scale);
    // spatial = classical - omega x v
    frame_acceleration(c.m, c.w.d, f, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, false, spatial.data());
    EXPECT_LE(gap(spatial.head<3>(), a.head<3>() - v.tail<3>().cross(v.head<3>())), tol * scale);
    EXPECT_EQ(0, gap(spatial.tail<3>(), a.tail<3>()));
    // the same in the other references; WORLD spatial is the derivative of the WORLD velocity
    for (dynReference r : references) {
      V6 vr, ar, sr;
      frame_velocity(c.m, c.w.d, f, r, vr.data());
      frame_acceleration(c.m, c.w.d, f, r, true, ar.data());
      frame_acceleration(c.m, c.w.d, f, r, false, sr.data());
      EXPECT_LE(gap(sr, expressed(X, r, spatial)), tol * scale * (1 + largest(X)));
      EXPECT_LE(gap(ar.head<3>(), sr.head<3>() + vr.tail<3>().cross(vr.head<3>())), tol * scale * (1 + largest(X) * largest(X)));
      if (r == DYN_REFERENCE_LOCAL) {
        EXPECT_LE(gap(ar, expressed(X, r, a)), tol * scale);
      }
    }
  });
}

TEST(Kinematics, SpatialAccelerationIsJacobianTimesAccelerationPlusItsRate) {
  for_trees([](Case& c) {
    forward_kinematics<2>(c.m, c.w.d);
    const Index f = some_frame(c);
    MatrixXd J(6, c.nv), dJ(6, c.nv);
    for (dynReference r : {DYN_REFERENCE_WORLD, DYN_REFERENCE_LOCAL}) {
      V6 a;
      frame_jacobian(c.m, c.w.d, f, r, J.data());
      frame_jacobian_time_variation(c.m, c.w.d, f, r, dJ.data());
      frame_acceleration(c.m, c.w.d, f, r, false, a.data());
      EXPECT_LE(gap(J * c.x.a + dJ * c.x.v, a), tol * (1 + largest(a) + largest(J) + largest(dJ)));
    }
    V6 a;  // aligned: J's origin moves with the frame, so that its rate gives the classical one
    frame_jacobian(c.m, c.w.d, f, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, J.data());
    frame_jacobian_time_variation(c.m, c.w.d, f, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, dJ.data());
    frame_acceleration(c.m, c.w.d, f, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, true, a.data());
    EXPECT_LE(gap(J * c.x.a + dJ * c.x.v, a), tol * (1 + largest(a) + largest(J) + largest(dJ)));
  });
}

TEST(Kinematics, UniverseStandsStill) {
  for_trees(
      [](Case& c) {
        forward_kinematics<2>(c.m, c.w.d);
        V6 x;
        EXPECT_EQ(0, gap(pose(c, 0), M4::Identity()));
        frame_velocity(c.m, c.w.d, 0, DYN_REFERENCE_WORLD, x.data());
        EXPECT_EQ(0, largest(x));
        frame_acceleration(c.m, c.w.d, 0, DYN_REFERENCE_LOCAL, true, x.data());
        EXPECT_EQ(0, largest(x)) << "no gravity in kinematics";
      },
      10);
}

}  // namespace
}  // namespace dyn_test
