// Second derivatives of inverse dynamics against differences, in quadruple precision, of the first ones.
#include "algorithm/rates.hpp"
#include "algorithm/second_order_tensors.hpp"

namespace dyn_test {
namespace {

// Adds lambda^T X, row by row: the gradients whose derivatives are asked for.
void add_times(const Quads& lambda, const Quad* X, Quads& out) {
  for (std::size_t j = 0; j < lambda.size(); ++j) {
    Quad sum(0);
    for (std::size_t i = 0; i < lambda.size(); ++i) sum += lambda[i] * X[i + j * lambda.size()];
    out.push_back(sum);
  }
}

TEST(SecondOrder, ProductIsTheDerivativeOfTheFirstOrder) {
  for_trees(
      [](Case& c) {
        Dice dice(9);
        const auto fext = dice.vector(6 * c.m.n.joints, 10), lambda = dice.vector(c.nv);
        const Quads f(fext.begin(), fext.end()), l(lambda.begin(), lambda.end());
        Work<Quad> w(c.m);
        // by q, by v, by a: nv rows each
        auto gradients = [&](const Quads& q, const Quads& v, const Quads& a) {
          Quads out;
          w.q(q).v(v).a(a);
          rnea_derivatives<Quad>(c.m, w.d, w.d.v, w.d.a, f.data());
          for (const Quad* X : {w.d.dtau_dq, w.d.dtau_dv, w.d.M}) add_times(l, X, out);
          return out;
        };
        Data<double>& d = c.w.d;
        second_order_columns<double>(c.m, d, d.v, d.a, fext.data());
        second_order_product<double>(c.m, d, lambda.data(),
                                     {d.lambda_d2tau_dqdq, d.lambda_d2tau_dvdv, d.lambda_d2tau_dqdv, d.lambda_d2tau_dadq});
        const MatrixXd of_q = by_q(c, gradients), of_v = by_v(c, gradients);
        const MatrixXd qq = of_q.topRows(c.nv), vv = of_v.middleRows(c.nv, c.nv), qv = of_v.topRows(c.nv),
                       aq = of_q.bottomRows(c.nv);
        const double scale = c.terms(c.x.a) + largest(qq) + 10;
        EXPECT_LE(gap(matrix(d.lambda_d2tau_dqdq, c.nv, c.nv), qq), tol * scale) << "dqdq";
        EXPECT_LE(gap(matrix(d.lambda_d2tau_dvdv, c.nv, c.nv), vv), tol * (scale + largest(vv))) << "dvdv";
        EXPECT_LE(gap(matrix(d.lambda_d2tau_dqdv, c.nv, c.nv), qv), tol * (scale + largest(qv))) << "dqdv";
        EXPECT_LE(gap(matrix(d.lambda_d2tau_dadq, c.nv, c.nv), aq), tol * (scale + largest(aq))) << "dadq";
      },
      40, up_to(10));
}

// The i-th matrix of each tensor is the product with e_i, whatever the buffers held.
TEST(SecondOrder, TensorsAreProductsWithUnitVectors) {
  for_trees(
      [](Case& c) {
        const std::ptrdiff_t square = std::ptrdiff_t(c.nv) * c.nv;
        Data<double>& d = c.w.d;
        std::vector<VectorXd> tensors(4, VectorXd::Constant(square * c.nv, 7.25e77));
        second_order_columns<double>(c.m, d, d.v, d.a, nullptr);
        second_order_derivatives<double>(c.m, d, {tensors[0].data(), tensors[1].data(), tensors[2].data(), tensors[3].data()});
        second_order_derivatives<double>(c.m, d, {nullptr, nullptr, nullptr, nullptr});
        const double* products[] = {d.lambda_d2tau_dqdq, d.lambda_d2tau_dvdv, d.lambda_d2tau_dqdv, d.lambda_d2tau_dadq};
        for (Index i = 0; i < c.nv; ++i) {
          const VectorXd lambda = VectorXd::Unit(c.nv, i);
          second_order_product<double>(c.m, d, lambda.data(),
                                       {d.lambda_d2tau_dqdq, d.lambda_d2tau_dvdv, d.lambda_d2tau_dqdv, d.lambda_d2tau_dadq});
          for (std::size_t k = 0; k < 4; ++k) {
            const MatrixXd product = matrix(products[k], c.nv, c.nv);
            const double scale = tensors[k].lpNorm<Eigen::Infinity>();
            ASSERT_LE(gap(matrix(tensors[k].data() + square * i, c.nv, c.nv), product), 1e-14 * scale)
                << "tensor " << k << ", row " << i;
          }
        }
      },
      100, up_to(25));
}

}  // namespace
}  // namespace dyn_test
