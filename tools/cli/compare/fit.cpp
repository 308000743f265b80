// A log and a model: from row to row of the log the model makes its own steps, and what it misses is explained by one number of
// the model at a time, at the value that explains most. Errors of one row do not add up, so that chaos does not hide the cause.
#include <algorithm>
#include <cmath>
#include <map>

#include "explain.hpp"

namespace cli::compare {

namespace {

constexpr std::size_t most_rows = 80;  // that are tried for each number
constexpr std::size_t refined = 12;    // numbers whose value is sought by iteration
constexpr int iterations = 6;
constexpr std::size_t best_causes = 6;  // that are tried over the whole log
constexpr double exact = 1e-9;          // of the motion from row to row: the model is that of the log

double norm(const Vector& x) {
  double sum = 0;
  for (const double y : x) sum += y * y;
  return std::sqrt(sum);
}

// What the model misses between rows: of each, velocity and configuration by its time.
class Defects {
 public:
  Defects(const Log& log, const State& like) : log_(log), like_(like) {
    const std::size_t n = log.t.size() - 1, stride = std::max<std::size_t>(1, (n + most_rows - 1) / most_rows);
    for (std::size_t k = 0; k < n; k += stride) rows_.push_back(k);
    weight_.assign(rows_.size(), 1);
  }

  // Empty where a step fails.
  std::vector<Vector> of(const Robot& robot, const Stepping& stepping, const Vector& more_ctrl = {}) const {
    const Data data(robot, DYN_PART_SIMULATION, stepping.effects);
    set_stepping(robot, data, stepping.integrator, stepping.dt, 0, stepping.solver);
    const double *q = state_view(robot, data, "q"), *v = state_view(robot, data, "v");
    std::vector<Vector> out;
    for (const std::size_t k : rows_) {
      const double h = log_.t[k + 1] - log_.t[k];
      const Vector& tau = log_.tau.empty() ? like_.tau : log_.tau[k];
      Vector ctrl = log_.ctrl.empty() ? like_.ctrl : log_.ctrl[k];
      for (std::size_t i = 0; i < more_ctrl.size(); ++i) ctrl[i] += more_ctrl[i];
      check(dyn_data_set_state(robot, data, log_.q[k].data(), log_.v[k].data(), nullptr, tau.data()));
      check(dyn_data_set_control(robot, data, ctrl.data()));
      if (dyn_advance(robot, data, h) != DYN_OK) return {};
      Vector r(2 * static_cast<std::size_t>(robot.nv));
      check(dyn_difference(robot, q, log_.q[k + 1].data(), r.data()));
      for (int i = 0; i < robot.nv; ++i) r[i] /= h, r[robot.nv + i] = log_.v[k + 1][i] - v[i];
      out.push_back(std::move(r));
    }
    return out;
  }

  // Rows count by their size, not by its square: one impact is one row.
  void weigh(const std::vector<Vector>& first) {
    double sum = 0;
    for (const Vector& r : first) sum += norm(r);
    const double least = 1e-3 * sum / static_cast<double>(first.size());
    for (std::size_t k = 0; k < first.size(); ++k) weight_[k] = 1 / std::max(norm(first[k]), std::max(least, 1e-300));
  }
  double cost(const std::vector<Vector>& r) const {
    if (r.empty()) return HUGE_VAL;
    double sum = 0;
    for (std::size_t k = 0; k < r.size(); ++k) sum += weight_[k] * norm(r[k]) * norm(r[k]);
    return sum;
  }
  double product(const std::vector<Vector>& a, const std::vector<Vector>& b) const {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      double part = 0;
      for (std::size_t i = 0; i < a[k].size(); ++i) part += a[k][i] * b[k][i];
      sum += weight_[k] * part;
    }
    return sum;
  }
  // Of the motion between rows: change of velocity and distance by time.
  double motion(const Robot& robot) const {
    double sum = 0;
    for (const std::size_t k : rows_) {
      Vector d(static_cast<std::size_t>(robot.nv));
      check(dyn_difference(robot, log_.q[k].data(), log_.q[k + 1].data(), d.data()));
      sum += norm(d) / (log_.t[k + 1] - log_.t[k]);
    }
    return sum / static_cast<double>(rows_.size());
  }
  double mean(const std::vector<Vector>& r) const {
    double sum = 0;
    for (const Vector& x : r) sum += norm(x);
    return sum / static_cast<double>(std::max<std::size_t>(r.size(), 1));
  }

 private:
  const Log& log_;
  const State& like_;
  std::vector<std::size_t> rows_;
  Vector weight_;
};

// One unknown: an entry of a quantity, a common factor of several, or an offset of a control.
struct Unknown {
  std::string group, what;
  json now;
  double value, step;                      // to begin with; of the difference
  std::function<Changes(double)> changes;  // x is the number itself
  int control = -1;                        // index, whose offset x is
};

double step_of(const Quantity& p, double x) {
  if (x != 0) return 1e-3 * std::abs(x);
  if (p.group == "frames" || p.quantity == "com") return 1e-4;
  if (p.group == "inertia") return 1e-6;
  return 1e-3;
}

// Numbers that steps go by. Placements of links and frames without inertia act on nothing; sizes of shapes do.
bool acts(const Quantity& p) {
  if (p.group == "frames") return p.object == "joint" && p.quantity != "axis2" && p.quantity != "pitch";
  if (p.group == "limits") return p.quantity == "lower" || p.quantity == "upper";
  return p.quantity != "contype" && p.quantity != "conaffinity" && p.quantity != "gear_ratio";
}

std::vector<Unknown> unknowns_of(const Side& side) {
  std::vector<Unknown> out;
  std::map<std::pair<std::string, std::string>, std::vector<const Quantity*>> alike;  // of a group and quantity
  for (const Quantity& p : side.quantities()) {
    if (!acts(p)) continue;
    bool any = false;
    for (std::size_t i = 0; i < p.values.size(); ++i) {
      const double x = p.values[i];
      if (!std::isfinite(x) || (p.quantity == "mass" && x == 0) || (p.quantity == "inertia" && x == 0)) continue;
      any = any || x != 0;
      out.push_back({p.group, p.text() + (p.values.size() > 1 ? "[" + std::to_string(i) + "]" : ""), x, x, step_of(p, x),
                     [&p, i](double y) {
                       Vector values = p.values;
                       values[i] = y;
                       return Changes{{p.index, values}};
                     }});
    }
    if (any && p.group != "frames" && p.group != "limits") alike[{p.group, p.quantity}].push_back(&p);
  }
  for (const auto& [of, list] : alike) {
    if (list.size() == 1 && list[0]->values.size() == 1) continue;
    const std::vector<const Quantity*> quantities = list;
    out.push_back(
        {of.first,
         "factor of " + std::string(list.size() == 1 ? list[0]->text() : "every " + list[0]->object + "'s " + of.second), 1, 1,
         1e-3, [quantities](double y) {
           Changes all;
           for (const Quantity* p : quantities) {
             Vector values = p->values;
             for (double& x : values)
               if (std::isfinite(x)) x *= y;
             all.emplace_back(p->index, values);
           }
           return all;
         }});
  }
  for (int k = 0; k < dyn_model_nu(side.robot()); ++k)
    out.push_back({"controls", "control " + std::to_string(k) + ", offset", 0, 0, 1e-3, nullptr, k});
  return out;
}

struct Fitted {
  const Unknown* unknown;
  double value, explained;
  std::vector<Vector> slope;
};

class Fit {
 public:
  Fit(const Log& log, const Side& side)
      : side_(side), defects_(log, side.start), first_(defects_.of(side.robot(), side.stepping)) {
    if (first_.empty()) fail("the model cannot step from a row of the log: " + std::string(dyn_last_error()));
    defects_.weigh(first_);
    cost_ = defects_.cost(first_);
  }
  const Defects& defects() const { return defects_; }
  const std::vector<Vector>& first() const { return first_; }
  double explained(const std::vector<Vector>& r) const {
    return cost_ > 0 ? 1 - std::sqrt(std::min(defects_.cost(r) / cost_, 1e6)) : 0;
  }

  std::vector<Vector> at(const Unknown& u, double x) const {
    try {
      if (u.control >= 0) {
        Vector more(static_cast<std::size_t>(dyn_model_nu(side_.robot())));
        more[static_cast<std::size_t>(u.control)] = x;
        return defects_.of(side_.robot(), side_.stepping, more);
      }
      return defects_.of(*side_.with(u.changes(x)), side_.stepping);
    } catch (const Failure&) {
      return {};
    }
  }

  // The value that explains most, by the slope at the model's own.
  Fitted linear(const Unknown& u) const {
    Fitted out{&u, u.value, 0, {}};
    double h = u.step;
    std::vector<Vector> r = at(u, u.value + h);
    if (r.empty()) r = at(u, u.value - (h = -h, u.step));
    if (r.empty()) return out;
    for (std::size_t k = 0; k < r.size(); ++k)
      for (std::size_t i = 0; i < r[k].size(); ++i) r[k][i] = (r[k][i] - first_[k][i]) / h;
    const double square = defects_.product(r, r), along = defects_.product(r, first_);
    if (!(square > 0)) return out;
    out.value = u.value - along / square;
    out.explained = 1 - std::sqrt(std::max(0.0, 1 - along * along / (square * cost_)));
    out.slope = std::move(r);
    return out;
  }

  // From there on by secants, as the defects themselves say.
  void refine(Fitted& f) const {
    const Unknown& u = *f.unknown;
    double x0 = u.value, x1 = f.value, best = 0, value = u.value;
    std::vector<Vector> r0 = first_;
    for (int k = 0; k < iterations; ++k) {
      std::vector<Vector> r1 = at(u, x1);
      for (int halved = 0; halved < 6 && (r1.empty() || explained(r1) < best - 1); ++halved) x1 = (x0 + x1) / 2, r1 = at(u, x1);
      if (r1.empty()) break;
      if (const double e = explained(r1); e > best) best = e, value = x1;
      std::vector<Vector> slope = r1;
      for (std::size_t i = 0; i < slope.size(); ++i)
        for (std::size_t j = 0; j < slope[i].size(); ++j) slope[i][j] = (r1[i][j] - r0[i][j]) / (x1 - x0);
      const double square = defects_.product(slope, slope);
      if (!(square > 0) || x1 == x0) break;
      const double next = x1 - defects_.product(slope, r1) / square;
      x0 = x1, r0 = std::move(r1), x1 = next;
      if (!std::isfinite(x1) || std::abs(x1 - x0) <= 1e-9 * std::max(std::abs(x0), std::abs(u.step))) break;
    }
    f.explained = best, f.value = value;
  }

 private:
  const Side& side_;
  Defects defects_;
  std::vector<Vector> first_;
  double cost_ = 0;
};

// Steps that a log's engine may have made between rows.
std::vector<double> steps_of(const Log& log, double own) {
  const double h = log.t[1] - log.t[0];
  std::vector<double> out;
  for (const double n : {1.0, 2.0, 4.0, 5.0, 8.0, 10.0, 20.0})
    if (std::abs(h / n - own) > 1e-9 * own && h / n > own / 32) out.push_back(h / n);
  return out;
}

}  // namespace

Comparison explain_log(const Log& log, const Side& b, bool own_start) {
  const Robot& robot = b.robot();
  Comparison out;
  const std::size_t n = log.t.size();
  out.every = (log.t.back() - log.t.front()) / static_cast<double>(n - 1);
  for (std::size_t k = 1; k < n; ++k)
    if (std::abs(log.t[k] - log.t[k - 1] - out.every) > 0.01 * out.every) {
      out.notes.push_back(
          "the log's rows are not equally far apart in time: moments are those of its rows, in their mean distance");
      break;
    }
  State logged = b.start;
  logged.in_configuration = false, logged.q = log.q[0], logged.v = log.v[0];
  const Data mind(robot, DYN_PART_FRAMES);
  Path of_log;
  for (const Vector& q : log.q) of_log.places.push_back(places_of(robot, mind, q.data()));
  const int moments = static_cast<int>(n);
  const Shared shared = shared_frames(robot, robot);
  // of a model from a start, under the log's controls and forces
  const auto path = [&](const Robot& r, const Stepping& s, const State& start) {
    const Data data(r, DYN_PART_SIMULATION, s.effects), places(r, DYN_PART_FRAMES);
    set_start(r, data, start);
    set_stepping(r, data, s.integrator, s.dt, 0, s.solver);
    const double* q = state_view(r, data, "q");
    Path p;
    p.places.push_back(places_of(r, places, q));
    for (std::size_t k = 0; k + 1 < n; ++k) {
      if (!log.ctrl.empty()) check(dyn_data_set_control(r, data, log.ctrl[k].data()));
      if (!log.tau.empty()) check(dyn_data_set_state(r, data, nullptr, nullptr, nullptr, log.tau[k].data()));
      if (dyn_advance(r, data, log.t[k + 1] - log.t[k]) != DYN_OK) {
        p.error = dyn_last_error();
        break;
      }
      p.places.push_back(places_of(r, places, q));
    }
    return p;
  };
  const State& start = own_start ? b.start : logged;
  const Path of_model = path(robot, b.stepping, start);
  if (!of_model.error.empty()) out.notes.push_back("the model's run ends early: " + of_model.error);
  out.divergence = distances(shared, of_log, of_model, moments);
  out.divergence.resize(of_model.places.size());
  int frame = 0;
  distance(shared, of_log.places[of_model.places.size() - 1], of_model.places.back(), &frame);
  if (!shared.names.empty()) out.where = shared.names[static_cast<std::size_t>(frame)];
  if (integrators()[b.stepping.integrator].order > 0) {
    const double scale = std::exp2(integrators()[b.stepping.integrator].order);
    Stepping half = b.stepping;
    half.dt /= 2;
    out.error_b = distances(shared, of_model, path(robot, half, start), moments);
    for (double& x : out.error_b) x *= scale / (scale - 1);
  }
  find_begin(out);

  double d = 0, dv = 0;
  check(dyn_configuration_distance(robot, b.start.q.data(), log.q[0].data(), &d));
  for (int i = 0; i < robot.nv; ++i) dv = std::max(dv, std::abs(b.start.v[i] - log.v[0][i]));
  if (own_start && std::max(d, dv) > 1e-9) {
    Cause c{"start", 0, 0, true, distances(shared, of_log, path(robot, b.stepping, logged), moments), {}};
    const bool of_q = d > 1e-9;
    const Vector &x = of_q ? log.q[0] : log.v[0], &y = of_q ? b.start.q : b.start.v;
    c.differences.push_back({of_q ? "q at the start" : "v at the start", vector_json(x.data(), static_cast<int>(x.size())),
                             vector_json(y.data(), static_cast<int>(y.size()))});
    c.explained = share(out.divergence, c.remaining);
    c.alone = distances(shared, of_model, path(robot, b.stepping, logged), moments).back();
    out.causes.push_back(std::move(c));
  }

  const Fit fit(log, b);
  const double missed = fit.defects().mean(fit.first()) / std::max(fit.defects().motion(robot), 1e-300);
  out.notes.push_back("from row to row the model misses " + short_number(missed, 3) + " of the log's motion");
  if (missed > exact) {
    std::map<std::string, Cause> by_name;
    const auto take = [&](const std::string& name, const Difference& difference) {
      Cause& c = by_name[name];
      c.name = name, c.differences.push_back(difference);
    };
    for (const double h : steps_of(log, b.stepping.dt)) {
      Stepping s = b.stepping;
      s.dt = h;
      take("step", {"step, s", h, b.stepping.dt, fit.explained(fit.defects().of(robot, s))});
    }
    for (const Integrator& i : integrators())
      if (i.id != b.stepping.integrator) {
        Stepping s = b.stepping;
        s.integrator = i.id;
        take("integrator",
             {"integrator", i.name, integrators()[b.stepping.integrator].name, fit.explained(fit.defects().of(robot, s))});
      }
    const std::vector<Unknown> unknowns = unknowns_of(b);
    std::vector<Fitted> fitted;
    Progress progress(static_cast<long long>(unknowns.size()), "numbers");
    for (const Unknown& u : unknowns) progress.at(static_cast<long long>(fitted.size())), fitted.push_back(fit.linear(u));
    std::stable_sort(fitted.begin(), fitted.end(), [](const Fitted& x, const Fitted& y) { return x.explained > y.explained; });
    std::map<std::string, int> tried;
    std::size_t left = refined;
    for (Fitted& f : fitted) {
      int& of_group = tried[f.unknown->group];  // the best of every group is refined, whatever others say
      const bool wanted = f.explained > 0.01 && (of_group == 0 || (left > 0 && of_group < 4));
      if (!wanted) continue;
      ++of_group;
      if (left) --left;
      fit.refine(f);
      take(f.unknown->group, {f.unknown->what, f.value, f.unknown->now, f.explained});
    }
    for (auto& [name, c] : by_name) {
      std::stable_sort(c.differences.begin(), c.differences.end(),
                       [](const Difference& x, const Difference& y) { return x.explained > y.explained; });
      if (c.differences.size() > 4) c.differences.resize(4);
      c.explained = std::max(0.0, c.differences[0].explained);
      out.causes.push_back(c);
    }
    // what explains the start explains the whole motion, and what explains the steps only what the start leaves
    const double rest = out.causes.empty() || out.causes[0].name != "start" ? 1 : std::max(0.0, 1 - out.causes[0].explained);
    for (Cause& c : out.causes)
      if (c.name != "start") c.explained *= rest;
    std::stable_sort(out.causes.begin(), out.causes.end(),
                     [](const Cause& x, const Cause& y) { return x.explained > y.explained; });
    std::map<std::string, double> whole;  // share of the whole motion that the best ones explain: between equals it decides
    for (std::size_t k = 0; k < std::min(out.causes.size(), best_causes); ++k) {
      Cause& c = out.causes[k];
      if (c.name == "start" || c.name == "controls") {
        whole[c.name] = c.explained;
        continue;
      }
      Stepping s = b.stepping;
      std::unique_ptr<Robot> changed;
      if (c.name == "step")
        s.dt = c.differences[0].a;
      else if (c.name == "integrator")
        s.integrator = integrator_named(c.differences[0].a).id;
      else
        for (const Fitted& f : fitted)
          if (c.name == f.unknown->group && f.unknown->what == c.differences[0].what)
            changed = b.with(f.unknown->changes(f.value));
      const Path with = path(changed ? *changed : robot, s, start);
      c.remaining = distances(shared, of_log, with, moments), c.alone = distances(shared, of_model, with, moments).back();
      whole[c.name] = std::clamp(share(out.divergence, c.remaining), -1.0, 1.0);
    }
    const std::vector<std::string> groups = names_of("dynParameterGroup");
    const auto rank = [&](const Cause& c) {  // equal ones in the order of the groups: damping before gains that act alike
      const auto at = std::find(groups.begin(), groups.end(), c.name) - groups.begin();
      return std::pair(-std::round(1e4 * (c.explained + (whole.contains(c.name) ? whole[c.name] : -1) / 2)), at);
    };
    std::stable_sort(out.causes.begin(), out.causes.end(), [&](const Cause& x, const Cause& y) { return rank(x) < rank(y); });
  }
  out.unexplained = out.begins < 0 ? 0 : out.causes.empty() ? 1 : 1 - out.causes[0].explained;
  return out;
}

Comparison explain_tables(const Table& a, const Table& b) {
  const auto time_of = [](const Table& x) {
    for (std::size_t k = 0; k < x.names.size(); ++k)
      if (x.names[k] == "t" || x.names[k] == "time") return k;
    fail("a log has no column t, the time in seconds.");
  };
  const std::size_t ta = time_of(a), tb = time_of(b);
  std::vector<std::pair<std::size_t, std::size_t>> columns;
  for (std::size_t k = 0; k < a.names.size(); ++k)
    for (std::size_t j = 0; j < b.names.size(); ++j)
      if (k != ta && a.names[k] == b.names[j]) columns.emplace_back(k, j);
  if (columns.empty()) fail("the logs have no column of the same name beside t: give --model, the robot, and --layout of each.");
  Comparison out;
  const double first = std::max(a.rows.front()[ta], b.rows.front()[tb]), last = std::min(a.rows.back()[ta], b.rows.back()[tb]);
  if (!(last > first)) fail("the logs have no time in common.");
  const std::size_t n = std::min(std::max(a.rows.size(), b.rows.size()), std::size_t(10001));
  out.every = (last - first) / static_cast<double>(n - 1);
  // between rows by straight lines
  const auto at = [](const Table& x, std::size_t time, double t, std::size_t column) {
    const auto next =
        std::upper_bound(x.rows.begin() + 1, x.rows.end() - 1, t, [&](double s, const Vector& r) { return s < r[time]; });
    const Vector &p = next[-1], &q = *next;
    const double s = std::clamp((t - p[time]) / (q[time] - p[time]), 0.0, 1.0);
    return p[column] + s * (q[column] - p[column]);
  };
  Vector at_start, at_end;
  for (std::size_t k = 0; k < n; ++k) {
    const double t = first + out.every * static_cast<double>(k);
    double most = 0;
    Vector apart;
    for (const auto& [i, j] : columns)
      apart.push_back(std::abs(at(a, ta, t, i) - at(b, tb, t, j))), most = std::max(most, apart.back());
    out.divergence.push_back(most);
    if (k == 0) at_start = apart;
    at_end = apart;
  }
  out.where = a.names[columns[static_cast<std::size_t>(std::max_element(at_end.begin(), at_end.end()) - at_end.begin())].first];
  find_begin(out);
  Cause start{"start", 0, 0, false, {}, {}};
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (at_start[k] > 1e-9)
      start.differences.push_back(
          {a.names[columns[k].first], at(a, ta, first, columns[k].first), at(b, tb, first, columns[k].second)});
  if (!start.differences.empty()) out.causes.push_back(start);
  out.unexplained = out.begins < 0 ? 0 : 1;
  out.notes.push_back("columns of the same names are compared as they are: --model FILE names the cause");
  return out;
}

}  // namespace cli::compare
