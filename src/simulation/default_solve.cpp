// The solve of steps without a tolerance: Newton's method near a solution, accelerated sweeps and the smoothing method elsewhere.
// max_iterations bounds their sum.
#include "simulation/smoothing.hpp"
#include "simulation/sweeps.hpp"

namespace dyn::simulation {

bool Island::relaxation_is_due() const { return std::llround(d.time[0] / h) % tuning::island::relaxed_every == 0; }

// Takes the smallest impulses of an island at rest, if their residual is tolerated: stress that redundant contacts keep from an
// impact does not stay. Returns whether it did.
bool Island::relax(double tolerated) {
  if (contacts == 0 || equalities > 0 || bounces || w.closed_gap > 0 || (d.acting & DYN_EFFECT_SLEEPING) || !has_runs() ||
      !ordered())
    return false;
  build_rows();
  return Newton(*this).least_norm(tolerated);
}

// Newton's method on the exact law goes on to the fine residual: bodies at rest then stay at rest, and the next steps have
// nothing to solve. Returns false if the residual is above the tolerance.
bool Island::solve_finely(Index most, double fine, dynContactReport& report) {
  const double wanted = tolerance;
  tolerance = std::min(wanted, fine);
  Newton method(*this);
  if (!method.run(most, wanted, report)) method.write_best(report);
  tolerance = wanted;
  return report.residual <= tolerance;
}

// Sweeps remove what is wrong at single contacts, the smoothing method what is wrong with the whole.
void Island::solve_by_segments(double fine, Sweeps<BySegments>& sweeps, dynContactReport& report) {
  using namespace tuning::default_solve;
  if (!large() || report.residual <= near_guess) {
    if (solve_finely(large() ? large_steps : small_steps, fine, report)) return;
  } else {
    sweeps.load();  // segments are numbered anew once ordered
    sweeps.run(few_sweeps, report), sweeps.write();
    report.residual = sweeps.residual();
  }
  const auto unsolved = [&] { return report.residual > tolerance && within_budget(report); };
  if (unsolved()) Smoothing(*this).run(smoothing_steps, report);
  if (unsolved() && large() && rows <= tuning::island::dense_rows) newton(report, true);
  if (report.residual <= tolerance) solve_finely(fine_steps, fine, report);
}

// Small islands and few sweeps leave iterations for methods that large mass ratios do not slow down.
void Island::solve_to_default(dynContactReport& report) {
  using namespace tuning::default_solve;
  allowance = w.max_iterations();
  build_rows();
  Sweeps<BySegments> sweeps(*this);
  const auto unsolved = [&] { return report.residual > tolerance && within_budget(report); };
  report.residual = sweeps.residual();
  if (report.residual <= tuning::island::tolerance && relaxation_is_due()) {
    relax(tuning::island::tolerance), sweeps.load();  // the sweeps' sums share its memory
    report.residual = sweeps.residual();
  }
  const double fine = wanted(report.residual, tuning::island::fine);
  if (report.residual > fine && !w.time_is_up() && ordered()) solve_by_segments(fine, sweeps, report), sweeps.load();
  w.limit.expect(solver::TimeLimit::Unit::Sweep, rows);
  if (report.residual > tolerance && (report.newton_steps == 0 || (!large() && within_budget(report)))) {
    const Index most = std::max<Index>(1, left(report));
    sweeps.run(large() ? most : std::min(most, few_sweeps), report);
    if (!large()) {
      report.residual = sweeps.residual(), sweeps.write();
      if (unsolved()) {
        if (!sparse()) solve(report);
        else if (!newton(report, true) && unsolved()) solve(report);
        sweeps.load();
      }
    }
  }
  report.residual = sweeps.finish();
  if (equalities > 0) report.residual = std::max(report.residual, inconsistency);
}

}  // namespace dyn::simulation
