// Momentum about the centre of mass, its matrix, its rate and their derivatives: against sums over the links, the joint-space
// inertia, and differences in quadruple precision.
#include "algorithm/centroidal_derivatives.hpp"

#include "algorithm/trees.hpp"

namespace dyn_test {
namespace {

struct Centroidal {
  V3 com;
  MatrixXd Ag, dAg, Ig, hg, dhg, dh_dq, dhdot_dq, dhdot_dv;

  explicit Centroidal(Case& c) {
    center_of_mass(c.m, c.w.d, 0);
    com = V3(c.w.d.com);
    centroidal_map<true>(c.m, c.w.d);
    Ag = matrix(c.w.d.Ag, 6, c.nv), dAg = matrix(c.w.d.dAg, 6, c.nv), Ig = matrix(c.w.d.Ig, 6, 6);
    centroidal_momentum<true>(c.m, c.w.d);
    hg = matrix(c.w.d.hg, 6), dhg = matrix(c.w.d.dhg, 6);
    centroidal_derivatives(c.m, c.w.d);
    dh_dq = matrix(c.w.d.dh_dq, 6, c.nv), dhdot_dq = matrix(c.w.d.dhdot_dq, 6, c.nv), dhdot_dv = matrix(c.w.d.dhdot_dv, 6, c.nv);
  }
  // what a product adds up without signs: rounding is measured by it
  static double size(const MatrixXd& A, const VectorXd& x) { return (A.cwiseAbs() * x.cwiseAbs()).maxCoeff(); }
};

// The same by templates in quadruple precision, at any state.
struct Exact {
  const Model& m;
  Work<Quad> w;
  explicit Exact(const Model& model) : m(model), w(model, DYN_PART_CENTROIDAL) {}
  Quads momenta() {  // hg, then dhg
    centroidal_momentum<true>(m, w.d);
    Quads out(w.d.hg, w.d.hg + 6);
    out.insert(out.end(), w.d.dhg, w.d.dhg + 6);
    return out;
  }
};
Quads line(const VectorXd& v, const VectorXd& a, Quad t) {
  Quads out;
  for (Eigen::Index k = 0; k < v.size(); ++k) out.push_back(Quad(v[k]) + t * Quad(a[k]));
  return out;
}

// Rows of a derivative have units of their own, and angular ones may be far larger.
double row_gap(const MatrixXd& a, const MatrixXd& b) {
  double worst = 0;
  for (Index r : {0, 3})
    if (const double size = largest(b.middleRows(r, 3)); size > 0)
      worst = std::max(worst, gap(a.middleRows(r, 3), b.middleRows(r, 3)) / size);
  return worst;
}

TEST(Centroidal, MomentumAndInertiaAreSumsOverTheLinks) {
  for_trees([](Case& c) {
    const Centroidal x(c);
    V6 h = V6::Zero();
    M3 I = M3::Zero();
    double mass = 0, scale = 0;
    forward_kinematics<1>(c.m, c.w.d);
    for (Index k = 0; k < c.m.n.frames; ++k) {
      const FrameRecord& f = c.m.frames()[k];
      if (f.type != DYN_FRAME_TYPE_BODY || f.joint == 0) continue;
      const LinkRecord& link = c.m.links()[f.link];
      double X[12];
      V6 V;
      frame_placement(c.m, c.w.d, k, X), frame_velocity(c.m, c.w.d, k, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, V.data());
      const M3 R = eigen(X).topLeftCorner<3, 3>(), Ic = R * Eigen::Map<const M3>(link.inertia) * R.transpose();
      const V3 w = V.tail<3>(), arm = R * V3(link.com), p = link.mass * (V.head<3>() + w.cross(arm)), r = V3(X + 9) + arm - x.com;
      h.head<3>() += p;
      h.tail<3>() += Ic * w + r.cross(p);
      I += Ic - link.mass * hat(r) * hat(r);
      mass += link.mass, scale += largest(p) * (1 + largest(r)) + largest(Ic) * largest(w);
    }
    EXPECT_LE(gap(x.hg, h), tol * scale);
    EXPECT_LE(gap(x.Ig.bottomRightCorner(3, 3), I), tol * largest(I));
    EXPECT_LE(gap(x.Ig.topLeftCorner(3, 3), mass * M3::Identity()), tol * mass);
    EXPECT_TRUE(x.Ig.topRightCorner(3, 3).isZero(0) && x.Ig.bottomLeftCorner(3, 3).isZero(0));
    EXPECT_EQ(0, gap(x.Ig, x.Ig.transpose()));
  });
}

TEST(Centroidal, MapTimesVelocityIsMomentum) {
  for_trees([](Case& c) {
    const Centroidal x(c);
    const double scale = x.size(x.Ag, c.x.v);
    EXPECT_LE(gap(x.Ag * c.x.v, x.hg), tol * scale);
    centroidal_map<false>(c.m, c.w.d);
    EXPECT_LE(gap(matrix(c.w.d.hg, 6), x.hg), tol * scale);
    // the linear rows are those of the centre of mass
    MatrixXd J(3, c.nv);
    center_of_mass(c.m, c.w.d, 0);
    center_of_mass_jacobian(c.m, c.w.d, 0, J.data());
    EXPECT_LE(gap(x.Ag.topRows(3), c.m.total_mass * J), tol * largest(x.Ag));
  });
}

TEST(Centroidal, RateIsMapTimesAccelerationPlusItsVariationTimesVelocity) {
  for_trees([](Case& c) {
    const Centroidal x(c);
    EXPECT_LE(gap(x.Ag * c.x.a + x.dAg * c.x.v, x.dhg), tol * (x.size(x.Ag, c.x.a) + x.size(x.dAg, c.x.v)));
  });
}

// The same robot on a free base.
Tree floating(Tree tree) {
  JointSpec base;
  base.name = "base", base.type = DYN_JOINT_TYPE_FREE_FLYER;
  for (JointSpec& s : tree.joints)
    if (s.parent.name.empty()) s.parent.name = "base";
  tree.joints.insert(tree.joints.begin(), base);
  Dice dice(1);
  tree.bodies.push_back(random_body(dice, "trunk", "base"));
  return tree;
}

// The base's columns are those of a rigid body of inertia Ig, and its rows of M are the forces of all columns.
TEST(Centroidal, BaseBlockIsTheTransformedInertia) {
  for_trees([](Case& c) {
    const ModelPtr model = floating(c.tree).build();
    const State s(*model, 3);
    Work<double> w(*model);
    w.q(s.q).v(s.v);
    center_of_mass(*model, w.d, 0), centroidal_map<false>(*model, w.d), crba(*model, w.d);
    const Index nv = model->n.nv;
    const MatrixXd Ag = matrix(w.d.Ag, 6, nv), Ig = matrix(w.d.Ig, 6, 6), M = matrix(w.d.M, nv, nv);
    M4 X;  // of the base, from the centre of mass, world axes
    X << eigen(w.d.R[1]), eigen(w.d.p[1]) - V3(w.d.com), 0, 0, 0, 1;
    const M6 A = motion_matrix(X);
    EXPECT_LE(gap(Ag.leftCols(6), Ig * A), tol * largest(Ag));
    EXPECT_LE(gap(M.topRows(6), A.transpose() * Ag), 4 * tol * largest(M));
  });
}

// Under forces between the links alone: weight, and no moment.
TEST(Centroidal, FreeFall) {
  for_trees([&](Case& c) {
    const Tree tree = floating(c.tree);
    const ModelPtr model = tree.build();
    State s(*model, 3);
    s.tau.head<6>().setZero();
    Work<double> w(*model);
    VectorXd ddq(model->n.nv);
    w.q(s.q).v(s.v);
    ASSERT_EQ(0, (forward_dynamics<double>(*model, w.d, s.v.data(), s.tau.data(), nullptr, ddq.data())));
    w.a(ddq);
    centroidal_map<true>(*model, w.d);
    centroidal_momentum<true>(*model, w.d);
    const MatrixXd dhg = matrix(w.d.dhg, 6), Ag = matrix(w.d.Ag, 6, model->n.nv), dAg = matrix(w.d.dAg, 6, model->n.nv);
    const double scale = Centroidal::size(Ag, ddq) + Centroidal::size(dAg, s.v) + 10 * model->total_mass;
    EXPECT_LE(gap(V3(dhg.topRows(3)), model->total_mass * tree.gravity), tol * scale);
    EXPECT_LE(largest(dhg.bottomRows(3)), 4 * tol * scale);
  });
}

TEST(Centroidal, RatesAreThoseOfMapAndMomentum) {
  for_trees([](Case& c) {
    const Centroidal x(c);
    Exact e(c.m);
    const VectorXd none = VectorXd::Zero(c.nv);
    const MatrixXd dAg = rate(
        [&](Quad t) {
          centroidal_map<false>(c.m, e.w.q(on_path(c.m, c.x.q, c.x.v, none, t)).d);
          return Quads(e.w.d.Ag, e.w.d.Ag + 6 * c.nv);
        },
        6);
    EXPECT_LE(gap(x.dAg, dAg), tol * (largest(dAg) + largest(x.Ag)));
    const MatrixXd dhg = rate(
        [&](Quad t) {
          centroidal_momentum<false>(c.m, e.w.q(on_path(c.m, c.x.q, c.x.v, c.x.a, t)).v(line(c.x.v, c.x.a, t)).d);
          return Quads(e.w.d.hg, e.w.d.hg + 6);
        },
        6);
    EXPECT_LE(gap(x.dhg, dhg), tol * (x.size(x.Ag, c.x.a) + x.size(x.dAg, c.x.v)));
  });
}

TEST(CentroidalDerivatives, AlongRandomDirections) {
  for_trees([](Case& c) {
    const Centroidal x(c);
    Exact e(c.m);
    const VectorXd none = VectorXd::Zero(c.nv), u = Dice(7).vector(c.nv);
    e.w.v(c.x.v).a(c.x.a);
    const MatrixXd by_q = rate([&](Quad t) { return e.w.q(on_path(c.m, c.x.q, u, none, t)), e.momenta(); }, 12);
    e.w.q(c.x.q);
    const MatrixXd by_v = rate([&](Quad t) { return e.w.v(line(c.x.v, u, t)), e.momenta(); }, 12);
    EXPECT_LE(gap(x.dh_dq * u, by_q.topRows(6)), tol * (x.size(x.dh_dq, u) + largest(x.Ag)));
    EXPECT_LE(gap(x.dhdot_dq * u, by_q.bottomRows(6)), tol * (x.size(x.dhdot_dq, u) + largest(x.dh_dq) + largest(x.Ag)));
    EXPECT_LE(gap(x.dhdot_dv * u, by_v.bottomRows(6)), tol * (x.size(x.dhdot_dv, u) + largest(x.Ag)));
    EXPECT_LE(gap(x.Ag * u, by_v.topRows(6)), tol * x.size(x.Ag, u));
  });
}

// Every column of every derivative to 1e-12 of the largest one: far below 1e-8, since the differences are free of rounding.
TEST(CentroidalDerivatives, ColumnByColumn) {
  TreeOptions small;
  small.joints = 6;
  for_trees(
      [](Case& c) {
        const Centroidal x(c);
        Exact e(c.m);
        const VectorXd none = VectorXd::Zero(c.nv);
        MatrixXd by_q(12, c.nv), by_v(12, c.nv);
        e.w.v(c.x.v).a(c.x.a);
        for (Index k = 0; k < c.nv; ++k)
          by_q.col(k) =
              rate([&](Quad t) { return e.w.q(on_path(c.m, c.x.q, VectorXd::Unit(c.nv, k), none, t)), e.momenta(); }, 12);
        e.w.q(c.x.q);
        for (Index k = 0; k < c.nv; ++k)
          by_v.col(k) = rate([&](Quad t) { return e.w.v(line(c.x.v, VectorXd::Unit(c.nv, k), t)), e.momenta(); }, 12);
        EXPECT_LE(row_gap(x.dh_dq, by_q.topRows(6)), 1e-12);
        EXPECT_LE(row_gap(x.dhdot_dq, by_q.bottomRows(6)), 1e-12);
        EXPECT_LE(row_gap(x.dhdot_dv, by_v.bottomRows(6)), 1e-12);
        EXPECT_LE(row_gap(x.Ag, by_v.topRows(6)), 1e-12);
      },
      60, small);
}

// What the derivatives compute on the way is what the other functions compute.
TEST(CentroidalDerivatives, IncludeTheRest) {
  for_trees([](Case& c) {
    const Centroidal x(c);  // its last call computed the derivatives
    EXPECT_LE(gap(matrix(c.w.d.Ag, 6, c.nv), x.Ag), tol * largest(x.Ag));
    EXPECT_LE(gap(matrix(c.w.d.Ig, 6, 6), x.Ig), tol * largest(x.Ig));
    EXPECT_LE(gap(matrix(c.w.d.hg, 6), x.hg), tol * x.size(x.Ag, c.x.v));
    EXPECT_LE(gap(matrix(c.w.d.dhg, 6), x.dhg), tol * (x.size(x.Ag, c.x.a) + x.size(x.dAg, c.x.v)));
  });
}

TEST(Centroidal, WithoutMassEverythingIsZero) {
  Builder b("empty");
  const ModelPtr model = b.finish();
  Work<double> w(*model);
  centroidal_map<true>(*model, w.d), centroidal_momentum<true>(*model, w.d), centroidal_derivatives(*model, w.d);
  EXPECT_TRUE(matrix(w.d.Ig, 6, 6).isZero(0) && matrix(w.d.hg, 6).isZero(0) && matrix(w.d.dhg, 6).isZero(0));
}

}  // namespace
}  // namespace dyn_test
