#include "sweep.hpp"

#include <algorithm>
#include <cmath>

namespace cli::accuracy {

namespace {

constexpr double steps_of[] = {2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5};
constexpr double accuracies[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12};
constexpr double short_run = 0.02;  // s: those below are run again, for their time

constexpr int perturbed_runs = 6;      // of a reference by statistics
constexpr double perturbation = 1e-7;  // m, rad, of their starts
constexpr double hopeless = 1e-2;      // m: a reference known no better is one of many motions that are as likely
constexpr double good_enough = 1e-7;   // m: finer steps are not looked for

Point point_of(const Scene& scene, const Setting& setting, const Reference& reference, double most_s) {
  Point p;
  p.setting = setting;
  JointRun first = run_within(scene, setting, most_s);
  p.wall_s = first.wall_s, p.evaluations = first.evaluations, p.steps = first.steps;
  p.penetration = first.penetration, p.residual = first.residual, p.failure = first.error;
  if (!p.failure.empty()) return p;
  for (int again = 0; again < 4 && p.wall_s < short_run; ++again) p.wall_s = std::min(p.wall_s, run(scene, setting).wall_s);
  p.error = error_from(scene, reference, first.samples);
  p.samples = std::move(first.samples);
  return p;
}

// One of an earlier run, by today's reference.
Point again(const Scene& scene, const Point& earlier, const Reference& reference) {
  Point p = earlier;
  if (p.failure.empty()) p.error = error_from(scene, reference, p.samples);
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

// Steps for an accuracy, of orders 8 and 5: what they differ by, and what each gains by a tenth of the accuracy. No kind: they
// fail.
Reference by_accuracy(const Scene& scene, const Setting& contact, const Budget& budget) {
  const double kept = budget.left() * 2 / 3;
  Reference best;
  best.smooth = false, best.uncertainty.m = HUGE_VAL;
  Setting high = contact, low = contact;
  high.integrator = integrators()[DYN_INTEGRATOR_REFERENCE], low.integrator = integrators()[DYN_INTEGRATOR_RK45];
  JointRun before;
  for (double accuracy = 1e-4; accuracy > 1e-12 && budget.left() > kept; accuracy /= 10) {
    high.accuracy = low.accuracy = accuracy;
    JointRun a = run_within(scene, high, (budget.left() - kept) / 2);
    if (!a.error.empty()) break;
    const JointRun b = run_within(scene, low, (budget.left() - kept) / 2);
    if (!b.error.empty()) break;
    const Error orders = error_between(scene.robot, a.samples, b.samples);
    const Error finer = before.samples.empty() ? Error{HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL}
                                               : error_between(scene.robot, a.samples, before.samples);
    if (finer.m == 0 && finer.rad == 0) break;  // the same steps: they say nothing
    if (const double m = std::max(orders.m, finer.m); m < best.uncertainty.m) {
      best.uncertainty = {m, std::max(orders.rad, finer.rad), std::max(orders.energy, finer.energy),
                          std::max(orders.momentum, finer.momentum)};
      best.run = a, best.kind = "steps for an accuracy of " + short_number(accuracy);
      best.confidence = "ten times the accuracy differs by " + short_number(finer.m, 3) + " m" +
                        (orders.m > 0 ? ", order 5 by " + short_number(orders.m, 3) + " m" : std::string()) + ": they agree";
    } else if (m > 100 * best.uncertainty.m) {
      break;  // rounding, or chaos
    }
    before = std::move(a);
  }
  return best;
}

// The finest steps that a third of the budget allows. Infinite uncertainty: they end early, as confidence says.
Reference by_steps(const Scene& scene, const Setting& contact, const Budget& budget) {
  Reference out;
  out.smooth = false;
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
    if (!r->error.empty() || r->samples.empty()) {
      out.uncertainty.m = HUGE_VAL;
      out.confidence =
          "steps of " + short_number(fine.dt) + " s and more end early: " + (r->error.empty() ? std::string(too_long) : r->error);
      return out;
    }
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

// Means over starts that differ by less than anyone knows them.
Reference by_statistics(const Scene& scene, const Setting& contact, const Budget& budget) {
  Setting s = contact;
  s.integrator = integrators()[DYN_INTEGRATOR_IMPLICIT_FAST];
  const double kept = budget.left() / 2;
  std::vector<JointRun> runs;
  std::uint64_t seed = 1;
  const auto random = [&seed] {  // -1 .. 1
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(seed >> 11) * 0x1p-52 - 1;
  };
  const auto perturbed = [&](double most_s) {
    Scene x = scene;
    Vector by(static_cast<std::size_t>(scene.robot.nv));
    for (double& d : by) d = perturbation * random();
    check(dyn_integrate(scene.robot, scene.start.q.data(), by.data(), x.start.q.data()));
    return run_within(x, s, most_s);
  };
  JointRun first;
  for (s.dt = std::min(1e-3, scene.duration / samples); s.dt < 0.02; s.dt *= 2) {  // the finest that leaves time for the others
    first = perturbed((budget.left() - kept) / perturbed_runs);
    if (first.error.empty()) break;
  }
  Reference out;
  if (!first.error.empty() || first.samples.empty()) return out.confidence = first.error, out;
  runs.push_back(first);
  while (runs.size() < perturbed_runs && budget.left() > kept)
    if (JointRun r = perturbed(budget.left() - kept); r.error.empty()) runs.push_back(std::move(r));
  if (runs.size() < 3) return out.confidence = too_long, out;
  out.run = runs[0];
  const double n = static_cast<double>(runs.size());
  for (std::size_t k = 0; k < out.run.samples.size(); ++k) {
    Sample& mean = out.run.samples[k];
    mean.energy = 0;
    for (int i = 0; i < 3; ++i) mean.com[i] = mean.momentum[i] = 0;
    for (const JointRun& r : runs) {
      mean.energy += r.samples[k].energy / n;
      for (int i = 0; i < 3; ++i) mean.com[i] += r.samples[k].com[i] / n, mean.momentum[i] += r.samples[k].momentum[i] / n;
    }
  }
  for (const JointRun& r : runs) {
    const Error e = statistics_between(r.samples, out.run.samples);
    out.uncertainty = {std::max(out.uncertainty.m, e.m), 0, std::max(out.uncertainty.energy, e.energy),
                       std::max(out.uncertainty.momentum, e.momentum)};
  }
  out.smooth = false, out.statistics = true;
  out.kind = "means of " + std::to_string(runs.size()) + " runs from starts that differ by " + short_number(perturbation) +
             " m and rad, in steps of " + short_number(s.dt, 3) + " s";
  out.confidence =
      "the motion amplifies errors, so that no single one is known: errors are those of the centre of mass, energy and "
      "momentum; single runs differ from the means by this";
  return out;
}

}  // namespace

Error error_from(const Scene& scene, const Reference& reference, const Samples& samples) {
  return reference.statistics ? statistics_between(samples, reference.run.samples)
                              : error_between(scene.robot, samples, reference.run.samples);
}

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
  Reference adaptive = by_accuracy(scene, contact, budget);
  if (adaptive.uncertainty.m <= good_enough) return adaptive;
  Reference steps = by_steps(scene, contact, budget);
  Reference& better = adaptive.uncertainty.m <= steps.uncertainty.m ? adaptive : steps;
  if (better.uncertainty.m <= hopeless) return better;
  Reference means = by_statistics(scene, contact, budget);
  if (means.statistics) return means;
  if (better.uncertainty.m < HUGE_VAL) return better;
  fail("there is no reference, since " + steps.confidence + ", and of perturbed starts: " + means.confidence +
       " (--budget gives it more time, --reference another one)");
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
        points.push_back(again(scene, *earlier, reference)), m.last_s = earlier->wall_s, m.last = value;
        continue;
      }
      // the next one is not begun where it would hardly end
      const double expected = m.last > 0 ? m.last_s * (m.adaptive ? m.growth : m.last / value) : 0;
      if (expected > budget.share()) {
        m.ended = true;
        continue;
      }
      Point p = point_of(scene, s, reference, budget.share());
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
  Reference best;
  best.run = run_within(scene, s, budget.left());
  std::vector<Point> points;
  if (!best.run.error.empty()) return points;
  for (const Solver& solver : solvers())
    for (int e = 2; e <= 10; e += 2) {
      s.solver = solver.id, s.tolerance = std::pow(10.0, -e);
      if (budget.left() < 0) return points;
      const Point* earlier = known("solver " + key_of(s));
      points.push_back(earlier ? again(scene, *earlier, best) : point_of(scene, s, best, budget.left()));
      if (!earlier) done(points.back());
    }
  mark_front(points);
  return points;
}

const Point* refine_cheapest(const Scene& scene, const Reference& reference, const Budget& budget,
                             const std::function<bool(const Error&)>& within, std::vector<Point>& points) {
  constexpr int finer = 3;    // settings between two of the sweep
  constexpr double near = 3;  // times the cheapest: what may become it
  constexpr double tolerances[] = {0, 1e-1, 1e-2, 1e-3, 1e-6};
  constexpr double longer[] = {1, 1.1, 1.2, 1.33, 1.5, 2};  // steps with these: impacts fall otherwise, and errors with them
  const auto passes = [&](const Point& p) { return p.failure.empty() && within(p.error); };
  const auto cheapest = [&] {
    const Point* best = nullptr;
    for (const Point& p : points)
      if (passes(p) && (!best || p.wall_s < best->wall_s)) best = &p;
    return best;
  };
  if (!cheapest()) return nullptr;
  const auto tried = [&](const Setting& s) {
    const double left = std::max(budget.share(), 20 * cheapest()->wall_s);  // what is recommended is looked at, whatever is left
    points.push_back(point_of(scene, s, reference, std::min(left, std::max(2 * near * cheapest()->wall_s, 0.05))));
    return passes(points.back());
  };
  const auto size = [](const Setting& s) { return s.accuracy > 0 ? s.accuracy : s.dt; };
  std::vector<Setting> starts;  // of each method the coarsest that passes
  for (const Point& p : points) {
    if (!passes(p) || p.wall_s > near * cheapest()->wall_s) continue;
    const auto at = std::find_if(starts.begin(), starts.end(), [&](const Setting& s) {
      return s.integrator.id == p.setting.integrator.id && (s.accuracy > 0) == (p.setting.accuracy > 0);
    });
    if (at == starts.end())
      starts.push_back(p.setting);
    else if (size(p.setting) > size(*at))
      *at = p.setting;
  }
  for (Setting s : starts) {
    const auto scaled = [&](double by) {
      Setting x = s;
      (x.accuracy > 0 ? x.accuracy : x.dt) *= by;
      if (x.accuracy <= 0) x.dt = std::min(x.dt, scene.duration / samples);
      return x;
    };
    double by = s.accuracy > 0 ? std::sqrt(10.0) : std::sqrt(2.0);
    for (int k = 0; k < finer; ++k, by = 1 + (by - 1) / 2) {
      const Setting x = scaled(by);
      if (size(x) > size(s) && tried(x)) s = x;
    }
  }
  if (!reference.smooth) {
    const Setting base = cheapest()->setting;
    const double each = 3 * cheapest()->wall_s * static_cast<double>(solvers().size() * std::size(tolerances));
    for (const double by : longer) {
      if (by > 1 && each > budget.left()) break;
      for (const Solver& solver : solvers())
        for (const double tolerance : tolerances) {
          Setting s = base;
          s.solver = solver.id, s.tolerance = tolerance, (s.accuracy > 0 ? s.accuracy : s.dt) *= by;
          if (s.accuracy <= 0 && s.dt > scene.duration / samples) continue;
          if (by > 1 || s.solver != base.solver || s.tolerance != base.tolerance) tried(s);
        }
    }
  }
  for (Point& p : points)  // the time of one run may be a chance
    if (passes(p) && p.wall_s < 1.5 * cheapest()->wall_s)
      for (int more = 0; more < 2; ++more) p.wall_s = std::min(p.wall_s, run(scene, p.setting).wall_s);
  mark_front(points);
  return cheapest();
}

}  // namespace cli::accuracy
