// G = Y^T Y of an island in the units of its blocks (solver/sweep.hpp), by z = Y y: c = Y^T z + g, with softness on the diagonal.
// A block costs as much as it has supporting degrees of freedom, however many rows the island has.
#pragma once

#include "algorithm/constrained/delassus.hpp"
#include "simulation/island.hpp"

namespace dyn::simulation {

template <class Operator>
struct IslandOperator {
  const Island& x;
  const double* g = nullptr;  // velocities without impulses

  Index size() const { return x.constraint_count; }
  solver::Block& block(Index k) const { return x.w.blocks[k]; }
  template <int rows>
  DYN_INLINE void velocity(Index k, const double* y, double* c) const {
    static_cast<const Operator&>(*this).template gather<rows>(k, c);
    add_own<rows>(block(k), y, c);
  }
  template <int rows>
  DYN_INLINE void add_own(const solver::Block& s, const double* y, double* c) const {
    for (int i = 0; i < rows; ++i) c[i] += g[s.first + i] + s.soft[i] * y[i];
  }
  template <int rows>
  DYN_INLINE void change(Index k, const double* by) const {
    static_cast<const Operator&>(*this).template scatter<rows>(k, by);
  }
  // A cone that is not kept between sweeps.
  void set_cone(Index k, solver::LocalCone& own) const {
    double G[max_rows * max_rows];
    x.scaled_block(k, G);
    own.set(G, block(k).rows, block(k).rows);
  }
  // Calls f(block, its number).
  template <class F>
  void for_each(F&& f) const {
    for (Index k = 0; k < size(); ++k) f(block(k), k);
  }
  // y and velocities without impulses, from the island's
  void load(double* y, double* without) const {
    for_each([&](const solver::Block& s, Index) {
      for (Index i = 0; i < s.rows; ++i) {
        const Index in = s.first + s.order[i];
        y[s.first + i] = s.unit[i] > 0 ? x.lambda[in] / s.unit[i] : 0;
        without[s.first + i] = s.unit[i] * (x.g[in] + x.bias[in]);
      }
    });
  }
  // the island's lambda from y
  void write(const double* y) const {
    for_each([&](const solver::Block& s, Index) {
      for (Index i = 0; i < s.rows; ++i) x.lambda[s.first + s.order[i]] = s.unit[i] * y[s.first + i];
    });
  }
  // z = Y y
  void start(const double* y) const {
    const Operator& own = static_cast<const Operator&>(*this);
    own.clear();
    for_each([&](const solver::Block& s, Index k) {
      solver::by_rows(s, [&]<int rows>() DYN_INLINE_LAMBDA { own.template scatter<rows>(k, y + s.first); });
    });
  }
};

// z by segments. Needs Island::build_rows.
struct BySegments : IslandOperator<BySegments> {
  static constexpr int W = segment_lanes;
  using P = Simd<double, W>;
  const Elimination& e = x.w.elimination;
  double* z = x.w.by_segment;

  explicit BySegments(const Island& island) : IslandOperator{island} {}
  void clear() const { std::fill_n(z, W * std::ptrdiff_t(e.size), 0.0); }
  // c = Y^T z, z += Y by
  template <int rows>
  DYN_INLINE void gather(Index k, double* c) const {
    P sum[rows];
#pragma GCC unroll 6
    for (int i = 0; i < rows; ++i) sum[i] = P::zero();
    for (Index r = e.first_run[k]; r < e.first_run[k + 1]; ++r) {
      const ConstraintRun& run = e.runs[r];
      const P at = P::load(z + W * run.segment);
#pragma GCC unroll 6
      for (int i = 0; i < rows; ++i) sum[i] = sum[i] + P::load(run.rows + W * i) * at;
    }
#pragma GCC unroll 6
    for (int i = 0; i < rows; ++i) c[i] = dyn::sum(sum[i]);
  }
  template <int rows>
  DYN_INLINE void scatter(Index k, const double* by) const {
    for (Index r = e.first_run[k]; r < e.first_run[k + 1]; ++r) {
      const ConstraintRun& run = e.runs[r];
      double* const to = z + W * run.segment;
      P sum = P::load(to);
#pragma GCC unroll 6
      for (int i = 0; i < rows; ++i) sum = sum + P::load(run.rows + W * i) * by[i];
      sum.store(to);
    }
  }
  // Sets the island's by_dof.
  void to_dofs() const {
    const double* Dinv = inverse_pivots(x.m, x.d);
    for (Index k = 0; k < e.size; ++k) {
      const Index begin = x.w.segments.first[e.segment[k]], end = x.w.segments.first[e.segment[k] + 1];
      for (Index dof = begin; dof < end; ++dof)
        if (Dinv[dof] > 0) x.by_dof[dof] = z[W * k + dof - begin] / std::sqrt(Dinv[dof]);
    }
  }

 private:
  static DYN_INLINE double sum_of(const P& a) {
    double half[W / 2];
    for (int k = 0; k < W / 2; ++k) half[k] = a[k] + a[k + W / 2];
    return (half[0] + half[2]) + (half[1] + half[3]);
  }
};

// z is the island's by_dof. Needs its blocks alone.
struct ByDofs : IslandOperator<ByDofs> {
  const double* Dinv = inverse_pivots(x.m, x.d);

  explicit ByDofs(const Island& island) : IslandOperator{island} {}
  void clear() const { x.clear_supporting_dofs(); }
  template <int rows>
  DYN_INLINE void gather(Index k, double* c) const {
    const solver::Block& s = block(k);
    const auto of = x.gather(x.constraint(k), Dinv);
    for (int i = 0; i < rows; ++i) c[i] = s.unit[i] * of[int(s.order[i])];
  }
  template <int rows>
  DYN_INLINE void scatter(Index k, const double* by) const {
    const solver::Block& s = block(k);
    double of[max_rows] = {};
    for (int i = 0; i < rows; ++i) of[s.order[i]] = s.unit[i] * by[i];
    x.scatter(x.constraint(k), of);
  }
  void to_dofs() const {}
};

}  // namespace dyn::simulation
