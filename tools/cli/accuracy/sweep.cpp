#include "sweep.hpp"

#include <algorithm>
#include <cmath>

namespace cli::accuracy {

namespace {

constexpr double steps_of[] = {2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5};
constexpr double accuracies[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12};
constexpr double short_run = 0.02;  // s: those below are run again, for their time

Point point_of(const Scene& scene, const Setting& setting, const Samples& reference, double most_s) {
  Point p;
  p.setting = setting;
  JointRun first = run_within(scene, setting, most_s);
  p.wall_s = first.wall_s, p.evaluations = first.evaluations, p.steps = first.steps;
  p.penetration = first.penetration, p.residual = first.residual, p.failure = first.error;
  if (!p.failure.empty()) return p;
  for (int again = 0; again < 4 && p.wall_s < short_run; ++again) p.wall_s = std::min(p.wall_s, run(scene, setting).wall_s);
  p.error = error_between(scene.robot, first.samples, reference);
  p.samples = std::move(first.samples);
  return p;
}

// One of an earlier run, by today's reference.
Point again(const Scene& scene, const Point& earlier, const Samples& reference) {
  Point p = earlier;
  if (p.failure.empty()) p.error = error_between(scene.robot, p.samples, reference);
  return p;
}

void mark_front(std::vector<Point>& points) {
  for (Point& p : points) {
    p.pareto = p.failure.empty();
    for (const Point& x : points)
      if (x.failure.empty() && x.wall_s <= p.wall_s && x.error.m <= p.error.m && (x.wall_s < p.wall_s || x.error.m < p.error.m))
        p.pareto = false;
  }
}

}  // namespace

std::string name_of(const Setting& s) {
  return s.accuracy > 0 ? std::string(s.integrator.id == DYN_INTEGRATOR_RK45 ? "rk45" : "reference") + " accuracy " +
                              short_number(s.accuracy)
                        : std::string(s.integrator.name) + " dt " + short_number(s.dt);
}

std::string key_of(const Setting& s) { return name_of(s) + " " + solvers()[s.solver].name + " " + short_number(s.tolerance); }

Reference make_reference(const Scene& scene, const Setting& contact, const Budget& budget) {
  Setting probe = contact;
  probe.integrator = integrators()[DYN_INTEGRATOR_RK4], probe.dt = std::min(1e-3, scene.duration / samples);
  JointRun first = run_within(scene, probe, budget.left() / 4);
  if (!first.error.empty() && first.error != too_long) {  // explicit steps refuse what is too stiff for them
    probe.integrator = integrators()[DYN_INTEGRATOR_IMPLICIT_FAST];
    first = run_within(scene, probe, budget.left() / 4);
  }
  if (!first.error.empty() && first.error != too_long && first.steps < 3) fail("the scene cannot be simulated: " + first.error);
  Reference out;
  out.smooth = first.error.empty() && first.rows == 0;
  Setting best = contact;
  best.integrator = integrators()[DYN_INTEGRATOR_REFERENCE];
  for (const int parts : {1, 10, 100}) {  // a long step that might meet something is none of order 8
    if (!out.smooth) break;
    best.parts = parts;
    out.run = run_within(scene, best, budget.left() / 3);
    best.parts = 3 * parts;
    const JointRun other = run_within(scene, best, budget.left() / 3);
    if (out.run.error.empty() && other.error.empty() && out.run.rows == 0 && other.rows == 0) {
      out.kind = "order 8 to rounding";
      out.uncertainty = error_between(scene.robot, out.run.samples, other.samples);
      out.confidence = "the same with three times as many beginnings differs by this";
      return out;
    }
  }
  // velocities jump: the finest steps that a third of the budget allows
  Setting fine = contact;
  fine.integrator = integrators()[DYN_INTEGRATOR_IMPLICIT_FAST];
  fine.dt = std::min(4e-4, scene.duration / samples);
  const double kept = budget.left() * 2 / 3;
  JointRun far, near;
  out.run = run_within(scene, fine, budget.left() / 3);
  const auto halve = [&](double most_s) {
    Setting next = fine;
    next.dt /= 2;
    JointRun r = run_within(scene, next, most_s);
    if (r.error == too_long) return false;
    far = std::move(near), near = std::move(out.run), out.run = std::move(r), fine = next;
    return out.run.error.empty();
  };
  bool going = out.run.error.empty() && halve(budget.left()) && halve(budget.left());
  while (going && fine.dt > 1e-8 && 2.5 * out.run.wall_s < budget.left() - kept) going = halve(budget.left() - kept);
  for (const JointRun* r : std::initializer_list<const JointRun*>{&far, &near, &out.run})
    if (!r->error.empty() || r->samples.empty())
      fail("there is no reference, since steps of " + short_number(fine.dt) + " s and more end early: " +
           (r->error.empty() ? std::string(too_long) : r->error) + " (--budget gives it more time, --reference another one)");
  out.smooth = false;
  out.kind = "steps of " + short_number(fine.dt, 3) + " s, the finest that a third of the budget allows";
  const Error halved = error_between(scene.robot, out.run.samples, near.samples);
  const double before = error_between(scene.robot, near.samples, far.samples).m,
               ratio = halved.m > 0 ? before / halved.m : HUGE_VAL;
  // what a geometric series of that ratio leaves, which is what the last halving changed where errors halve; four times that
  // where they hardly do
  const double rest = std::clamp(1 / std::max(ratio - 1, 1e-3), 1.0, 4.0);
  out.uncertainty = {rest * halved.m, rest * halved.rad, rest * halved.energy, rest * halved.momentum};
  out.confidence = ratio > 1.5
                       ? "twice and four times as long steps differ from it by " + short_number(halved.m, 3) + " m and " +
                             short_number(before, 3) + " m: it converges"
                       : "low: twice as long steps are off by " + short_number(halved.m, 3) +
                             " m, hardly less than four times as long ones: the motion is chaotic, or the steps are too long";
  return out;
}

Reference given_reference(const Scene& scene, const Vector& q, const Vector& v) {
  Scene end = scene;
  end.start.q = q, end.start.v = v, end.duration = 1e-18 * samples;  // it is where it is
  Setting still;
  still.integrator = integrators()[DYN_INTEGRATOR_SEMI_IMPLICIT_EULER], still.dt = 1e-18;
  Reference out;
  const JointRun all = run(end, still);
  if (all.samples.empty()) fail("--reference: " + all.error);
  out.run.samples = {all.samples.front()};
  out.kind = "given, at the end", out.confidence = "the file's";
  return out;
}

std::vector<Point> integrator_sweep(const Scene& scene, const Reference& reference, const Setting& contact, const Budget& budget,
                                    const Known& known, const Done& done) {
  struct Method {
    Setting setting;
    bool adaptive;
    double last_s = 0, last = 0;  // of the run before: its time, its step or accuracy
    double growth = 2;            // of the time of an adaptive one, from rung to rung
    bool ended = false;
  };
  std::vector<Method> methods;
  for (const Integrator& i : integrators()) {
    Setting s = contact;
    s.integrator = i;
    if (i.id != DYN_INTEGRATOR_REFERENCE) methods.push_back({s, false});
    if (i.id == DYN_INTEGRATOR_REFERENCE || i.id == DYN_INTEGRATOR_RK45)
      methods.push_back({s, true, 0, 0, reference.smooth ? 2.0 : 12.0});
  }
  std::vector<Point> points;
  const std::size_t rungs = std::max(std::size(steps_of), std::size(accuracies));
  Progress progress(static_cast<long long>(rungs * methods.size()), "settings");
  for (std::size_t rung = 0; rung < rungs; ++rung)
    for (Method& m : methods) {
      progress.at(static_cast<long long>(rung * methods.size()) + (&m - methods.data()));
      if (m.ended || rung >= (m.adaptive ? std::size(accuracies) : std::size(steps_of))) continue;
      const double value = m.adaptive ? accuracies[rung] : steps_of[rung];
      if (!m.adaptive && value > scene.duration / samples) continue;
      Setting s = m.setting;
      (m.adaptive ? s.accuracy : s.dt) = value;
      if (const Point* earlier = known(key_of(s))) {
        points.push_back(again(scene, *earlier, reference.run.samples)), m.last_s = earlier->wall_s, m.last = value;
        continue;
      }
      // the next one is not begun where it would hardly end
      const double expected = m.last > 0 ? m.last_s * (m.adaptive ? m.growth : m.last / value) : 0;
      if (expected > budget.share()) {
        m.ended = true;
        continue;
      }
      Point p = point_of(scene, s, reference.run.samples, budget.share());
      if (m.last_s > short_run) m.growth = std::max(m.growth, p.wall_s / m.last_s);
      m.last_s = p.wall_s, m.last = value;
      m.ended = p.failure == too_long;
      if (!m.ended) done(p), points.push_back(std::move(p));
    }
  mark_front(points);
  std::stable_sort(points.begin(), points.end(), [](const Point& a, const Point& b) {
    return std::pair(a.setting.accuracy > 0, int(a.setting.integrator.id)) <
           std::pair(b.setting.accuracy > 0, int(b.setting.integrator.id));
  });
  return points;
}

std::vector<Point> solver_sweep(const Scene& scene, double dt, const Budget& budget, const Known& known, const Done& done) {
  Setting s;
  s.integrator = integrators()[DYN_INTEGRATOR_IMPLICIT_FAST], s.dt = dt, s.tolerance = 1e-12;
  const JointRun best = run_within(scene, s, budget.left());
  std::vector<Point> points;
  if (!best.error.empty()) return points;
  for (const Solver& solver : solvers())
    for (int e = 2; e <= 10; e += 2) {
      s.solver = solver.id, s.tolerance = std::pow(10.0, -e);
      if (budget.left() < 0) return points;
      const Point* earlier = known("solver " + key_of(s));
      points.push_back(earlier ? again(scene, *earlier, best.samples) : point_of(scene, s, best.samples, budget.left()));
      if (!earlier) done(points.back());
    }
  mark_front(points);
  return points;
}

}  // namespace cli::accuracy
