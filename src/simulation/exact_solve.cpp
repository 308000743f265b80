// The solve to a tolerance: the guess, Newton's method, then sweeps, the dense matrix and fixed corrections.
#include "simulation/newton.hpp"
#include "simulation/sweeps.hpp"

namespace dyn::simulation {

using namespace tuning::sweeps;

// f(sweeps), by segments where they fit.
template <class F>
void Island::with_sweeps(F&& f) {
  if (!has_runs()) return f(Sweeps<ByDofs>(*this));
  build_rows();
  f(Sweeps<BySegments>(*this));
}

double Island::residual() { return Sweeps<ByDofs>(*this).settle(); }

bool Island::accept_guess(dynContactReport& report) {
  if (bounces) return false;
  const Sweeps<ByDofs> sweeps(*this);
  report.residual = sweeps.settle();
  const auto is_near = [&] { return report.residual > tolerance && report.residual < tuning::island::tolerance; };
  for (int k = 0; k < guess_sweeps && left(report) > 0 && is_near(); ++k) {
    sweeps.sweep(), ++report.iterations;
    sweeps.write(), report.residual = sweeps.settle();
  }
  tolerance = wanted(report.residual, tolerance);
  return report.residual <= tolerance;
}

void Island::accelerated_sweeps(Index most, dynContactReport& report) {
  with_sweeps([&](auto&& sweeps) { sweeps.run(most, report), report.residual = sweeps.finish(); });
}

// Wedged contacts press on each other with any force, which may grow from step to step until rounding hides the velocities. A few
// sweeps from none bound it. A contact whose bodies move in one direction alone may wedge by itself: then without friction.
void Island::solve_without_guess(dynContactReport& report) {
  std::fill_n(lambda, rows, 0.0);
  with_sweeps([&](auto&& sweeps) {
    for (Index k = 0; k < first_sweeps; ++k) sweeps.sweep(), ++report.iterations;
    report.residual = sweeps.finish();
    if (report.residual < HUGE_VAL) return;
    sweeps.frictionless(correction_sweeps, tolerance, 0);
    report.residual = sweeps.finish();
  });
}

// Each Newton attempt gets twice as many sweeps as the last, from the second on an interior point start.
// At least one sweep: the guess need not lie in its cones.
void Island::sweeps_and_newton(dynContactReport& report) {
  double best = HUGE_VAL;  // residual of what is kept
  with_sweeps([&](auto&& sweeps) {
    report.residual = sweeps.residual();
    Index tries = 0;
    const auto may_sweep = [&] { return report.iterations == 0 || within_budget(report); };
    const bool alone = !has_room_for_matrix();
    for (Index some = first_sweeps; (alone || some <= max_small) && report.residual > enough && may_sweep(); some *= 2) {
      w.limit.expect(solver::TimeLimit::Unit::Sweep, rows);
      for (Index k = 0; k < some && may_sweep(); ++k) sweeps.sweep(), ++report.iterations;
      report.residual = sweeps.finish();
      if (report.residual <= enough || newton(report, ++tries >= 2)) return;
      if (report.residual < best) best = report.residual, std::copy_n(lambda, rows, kept);
      sweeps.load();
    }
  });
  if (report.residual > best) report.residual = best, std::copy_n(kept, rows, lambda);
}

void Island::sweep_while_improving(dynContactReport& report) {
  std::copy_n(lambda, rows, kept);
  const double before = report.residual;
  with_sweeps([&](auto&& sweeps) {
    sweeps.run(std::min(solver::tuning::sweeps_a_check * w.method_iterations() / 2, left(report)), report);
    report.residual = sweeps.finish();
  });
  if (report.residual > before) report.residual = before, std::copy_n(kept, rows, lambda);
}

// Approximate displacement for position corrections; later steps correct the rest. Sweeps hardly move a tall stack, and change it
// as they change rows that contradict each other: Newton's method finds what they leave of large islands. Derivatives of a step
// (step_correction.cpp) follow the sweeps. Sets by_dof. Returns false if rows contradict each other.
bool Island::correct_by_sweeps(double softness) {
  const double least =
      std::max(correction_change, uses_sweeps_only() ? tolerance : 0);  // of the largest change in the first sweep
  bool agree = true;
  with_sweeps([&](auto&& sweeps) { agree = sweeps.frictionless(correction_sweeps, least, softness); });
  if (large() && softness == 0 && !uses_sweeps_only() && has_runs() && ordered() && !w.time_is_up())
    build_rows(), agree |= Newton(*this).frictionless(least);
  clear_supporting_dofs(), scatter_all();
  return agree;
}

// What Newton's method from the guess does not solve.
void Island::solve_exactly(dynContactReport& report) {
  const auto is_above = [&](double wanted) { return report.residual > wanted && !w.time_is_up(); };
  const bool by_sweeps = !has_room_for_matrix() || (!bounces && sparse());
  w.limit.expect(by_sweeps ? solver::TimeLimit::Unit::Sweep : solver::TimeLimit::Unit::Matrix,
                 by_sweeps ? rows : double(rows) * rows);
  if (w.time_is_up()) scale_restitution(1), sweeps_and_newton(report);
  else if (by_sweeps) sweeps_and_newton(report);
  if (has_room_for_matrix() && is_above(tolerance)) {
    if (report.iterations == 0) report.residual = HUGE_VAL;  // the guess need not lie in its cones
    solve(report);
  }
  const bool nearly = report.residual < tuning::island::tolerance && left(report) > 0;
  if (!bounces && is_above(enough) && nearly) sweep_while_improving(report);
  if (!bounces && is_above(enough)) solve_fixed_correction(report);
}

}  // namespace dyn::simulation
