// Two models: each kind of difference is given to the other side, alone, and what is left is measured.
#include <algorithm>
#include <cmath>
#include <set>

#include "explain.hpp"

namespace cli::compare {

namespace {

constexpr int least_moments = 100;
constexpr double same = 1e-12;           // relative: rounding of rotations and files
constexpr double noise = 1e-10;          // m, rad: no divergence
constexpr std::size_t most_single = 40;  // differing quantities that are measured one by one

bool equal(const Vector& a, const Vector& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k] != b[k] && !(std::abs(a[k] - b[k]) <= same * std::max({std::abs(a[k]), std::abs(b[k]), 1e-6})) &&
        !(std::isnan(a[k]) && std::isnan(b[k])))
      return false;
  return true;
}

json numbers_json(const Vector& x) {
  json out = json::array();
  for (const double value : x) out.push_back(std::isfinite(value) ? json(value) : json(short_number(value)));
  return out.size() == 1 ? out[0] : out;
}

// A side with something of the other's.
struct Mixed {
  Changes changes;
  Stepping stepping;
  State start;
};

class Pair {
 public:
  Pair(const Side& a, const Side& b, double duration) : a_(a), b_(b), shared_(shared_frames(a.robot(), b.robot())) {
    if (shared_.frames.empty()) fail("the models have no frame of the same name and type: there is nothing to compare.");
    every_of(duration);
  }

  Comparison explain() {
    Comparison out;
    out.every = every_;
    const Mixed A{{}, a_.stepping, a_.start}, B{{}, b_.stepping, b_.start};
    const Path pa = path(a_, A), pb = path(b_, B);
    for (const auto& [p, who] : {std::pair{&pa, "A"}, {&pb, "B"}})
      if (!p->error.empty())
        out.notes.push_back(std::string(who) + " ends at t = " + short_number(every_ * static_cast<double>(p->places.size())) +
                            " s: " + p->error);
    moments_ = static_cast<int>(std::min(pa.places.size(), pb.places.size()));
    if (moments_ < 2) fail(out.notes.front());
    out.divergence = distances(shared_, pa, pb, moments_);
    out.error_a = own_error(a_.robot(), a_.stepping, a_.start, every_, moments_, pa);
    out.error_b = own_error(b_.robot(), b_.stepping, b_.start, every_, moments_, pb);
    int frame = 0;
    distance(shared_, pa.places[static_cast<std::size_t>(moments_) - 1], pb.places[static_cast<std::size_t>(moments_) - 1],
             &frame);
    out.where = shared_.names[static_cast<std::size_t>(frame)];
    find_begin(out);
    structure(out);
    collect();
    Mixed all_a = A;
    for (Found& f : found_) {
      const Cause& c = f.cause;
      Cause done = c;
      Mixed forth = A, back = B;
      f.give_b(forth), f.give_a(back), f.give_b(all_a);
      try {
        const Path with = path(a_, forth);
        done.remaining = distances(shared_, with, pb, moments_);
        done.alone = distances(shared_, with, pa, moments_).back();
        done.explained = share(out.divergence, done.remaining);
        done.explained = (done.explained + share(out.divergence, distances(shared_, path(b_, back), pa, moments_))) / 2;
      } catch (const Failure& failure) {
        done.measured = false, out.notes.push_back(c.name + ": " + failure.message);
      }
      if (f.single.size() == done.differences.size() && singles_ <= most_single)
        for (std::size_t k = 0; k < f.single.size(); ++k) try {
            Mixed one = A;
            one.changes.push_back(f.single[k]);
            done.differences[k].explained = share(out.divergence, distances(shared_, path(a_, one), pb, moments_));
          } catch (const Failure&) {
          }
      if (f.single.size() == done.differences.size() && singles_ <= most_single)
        std::stable_sort(done.differences.begin(), done.differences.end(),
                         [](const Difference& x, const Difference& y) { return x.explained > y.explained; });
      out.causes.push_back(std::move(done));
    }
    try {
      out.unexplained = found_.empty() ? 1 : 1 - share(out.divergence, distances(shared_, path(a_, all_a), pb, moments_));
    } catch (const Failure&) {
      out.unexplained = 1;
    }
    if (out.begins < 0) out.unexplained = 0;
    std::stable_sort(out.causes.begin(), out.causes.end(), [](const Cause& x, const Cause& y) {
      return x.explained != y.explained ? x.explained > y.explained : x.alone > y.alone;
    });
    if (!structure_.differences.empty()) {
      structure_.measured = false, structure_.explained = out.unexplained;
      const auto at =
          std::find_if(out.causes.begin(), out.causes.end(), [&](const Cause& c) { return c.explained < structure_.explained; });
      out.causes.insert(at, structure_);
    }
    return out;
  }

 private:
  struct Found {
    Cause cause;
    std::function<void(Mixed&)> give_b, give_a;  // to side A what B has; to side B what A has
    Changes single;                              // of A, one a difference
  };
  const Side &a_, &b_;
  Shared shared_;
  double every_ = 0;
  int moments_ = 0;
  std::vector<Found> found_;
  std::size_t singles_ = 0;
  Cause structure_{"structure", 0, 0, false, {}, {}};

  // Moments at which steps of both end, where there are such.
  void every_of(double duration) {
    const double longer = std::max(a_.stepping.dt, b_.stepping.dt), shorter = std::min(a_.stepping.dt, b_.stepping.dt);
    const long long first = std::max(1LL, std::llround(duration / (least_moments * longer)));
    every_ = static_cast<double>(first) * longer;
    for (long long n = first; n < first + 20; ++n) {
      const double ratio = static_cast<double>(n) * longer / shorter;
      if (std::abs(ratio - std::round(ratio)) > 1e-6 * ratio) continue;
      every_ = static_cast<double>(n) * longer;
      break;
    }
    every_ = std::min(every_, duration);
    moments_ = 1 + static_cast<int>(std::max(1LL, std::llround(duration / every_)));
  }

  Path path(const Side& side, const Mixed& x) const {
    if (x.changes.empty()) return run(side.robot(), x.stepping, x.start, every_, moments_);
    return run(*side.with(x.changes), x.stepping, x.start, every_, moments_);
  }

  // Joints, actuators and other objects that one side alone has, or that are of another kind.
  void structure(Comparison& out) {
    const Robot &a = a_.robot(), &b = b_.robot();
    const auto kind = [](const Robot& r, int id) -> json {
      if (id < 1) return nullptr;
      const dynJointInfo j = r.joint(id);
      return std::string(joint_type_name(j.type)) + " on '" + dyn_model_joint_name(r, j.parent) + "'" +
             (j.mimic_leader >= 0 ? ", follows '" + std::string(dyn_model_joint_name(r, j.mimic_leader)) + "'" : "");
    };
    std::set<std::string> names;
    for (const Robot* r : {&a, &b})
      for (int j = 1; j < r->njoints; ++j) names.insert(dyn_model_joint_name(*r, j));
    bool mimic = false;
    for (const std::string& name : names) {
      const int in_a = dyn_model_joint_id(a, name.c_str()), in_b = dyn_model_joint_id(b, name.c_str());
      const json ka = kind(a, in_a), kb = kind(b, in_b);
      if (ka == kb) continue;
      structure_.differences.push_back({"joint '" + name + "'", ka, kb});
      mimic = mimic || (in_a > 0 && in_b > 0 && (a.joint(in_a).mimic_leader >= 0) != (b.joint(in_b).mimic_leader >= 0));
    }
    std::set<std::string> objects;  // of quantities that one side lacks
    const auto lacking = [&](const Side& x, const Side& y, bool first) {
      for (const Quantity& p : x.quantities())
        if (!y.find(p.key()) && p.object != "joint" && objects.insert(p.object + p.name).second)
          structure_.differences.push_back({p.object + " '" + p.name + "'", first ? json("is there") : json(nullptr),
                                            first ? json(nullptr) : json("is there")});
    };
    lacking(a_, b_, true), lacking(b_, a_, false);
    if (mimic) structure_.name = "mimic";
    if (!structure_.differences.empty())
      out.notes.push_back("the models are built differently: frames of the same names are compared");
  }

  void collect() {
    for (const Quantity& p : a_.quantities()) {
      const Quantity* const other = b_.find(p.key());
      if (!other || equal(p.values, other->values) || p.values.size() != other->values.size()) continue;
      auto at = std::find_if(found_.begin(), found_.end(), [&](const Found& f) { return f.cause.name == p.group; });
      if (at == found_.end()) at = found_.insert(found_.end(), Found{Cause{p.group, 0, 0, true, {}, {}}, {}, {}, {}});
      at->cause.differences.push_back({p.text(), numbers_json(p.values), numbers_json(other->values)});
      at->single.emplace_back(p.index, other->values), ++singles_;
    }
    for (Found& f : found_) {
      const Changes to_a = f.single;
      Changes to_b;
      for (const auto& [index, values] : to_a) {
        const Quantity& p = a_.quantities()[static_cast<std::size_t>(index)];
        to_b.emplace_back(b_.find(p.key())->index, p.values);
      }
      const auto append = [](Mixed& x, const Changes& more) { x.changes.insert(x.changes.end(), more.begin(), more.end()); };
      f.give_b = [=](Mixed& x) { append(x, to_a); };
      f.give_a = [=](Mixed& x) { append(x, to_b); };
    }
    const auto other = [&](const char* name, const Difference& d, auto give_b, auto give_a) {
      found_.push_back({Cause{name, 0, 0, true, {}, {d}}, give_b, give_a, {}});
    };
    const Stepping &sa = a_.stepping, &sb = b_.stepping;
    if (sa.dt != sb.dt)
      other(
          "step", {"step, s", sa.dt, sb.dt}, [sb](Mixed& x) { x.stepping.dt = sb.dt; },
          [sa](Mixed& x) { x.stepping.dt = sa.dt; });
    if (sa.integrator != sb.integrator)
      other(
          "integrator", {"integrator", integrators()[sa.integrator].name, integrators()[sb.integrator].name},
          [sb](Mixed& x) { x.stepping.integrator = sb.integrator; }, [sa](Mixed& x) { x.stepping.integrator = sa.integrator; });
    if (sa.effects != sb.effects)
      other(
          "effects", {"effects that act", effects_json(sa.effects), effects_json(sb.effects)},
          [sb](Mixed& x) { x.stepping.effects = sb.effects; }, [sa](Mixed& x) { x.stepping.effects = sa.effects; });
    const State b_in_a = moved(b_.robot(), a_.robot(), b_.start), a_in_b = moved(a_.robot(), b_.robot(), a_.start);
    const auto differs = [&](Vector State::* x) { return !equal(a_.start.*x, b_in_a.*x) && !equal(b_.start.*x, a_in_b.*x); };
    const auto vector = [&](const char* what, Vector State::* x) {
      return Difference{what, vector_json((a_.start.*x).data(), static_cast<int>((a_.start.*x).size())),
                        vector_json((b_.start.*x).data(), static_cast<int>((b_.start.*x).size()))};
    };
    if (differs(&State::q) || differs(&State::v)) {
      const auto take = [](State& to, const State& from) { to.q = from.q, to.v = from.v; };
      other(
          "start", vector(differs(&State::q) ? "q at the start" : "v at the start", differs(&State::q) ? &State::q : &State::v),
          [=](Mixed& x) { take(x.start, b_in_a); }, [=](Mixed& x) { take(x.start, a_in_b); });
    }
    if (differs(&State::ctrl) || differs(&State::tau)) {
      const auto take = [](State& to, const State& from) { to.ctrl = from.ctrl, to.tau = from.tau; };
      other(
          "controls", vector(differs(&State::ctrl) ? "controls" : "tau", differs(&State::ctrl) ? &State::ctrl : &State::tau),
          [=](Mixed& x) { take(x.start, b_in_a); }, [=](Mixed& x) { take(x.start, a_in_b); });
    }
  }

  static json effects_json(std::uint32_t on) {
    json out = json::array();
    for (const Choice& c : choices("dynEffects"))
      if (const auto bit = static_cast<std::uint32_t>(c.value); bit && !(bit & (bit - 1)) && bit & DYN_EFFECT_ALL && on & bit)
        out.push_back(c.name);
    return out;
  }
};

}  // namespace

double share(const Vector& all, const Vector& left) {
  double sum = 0;
  int counted = 0;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (all[k] > noise) sum += 1 - std::min(k < left.size() ? left[k] / all[k] : 10.0, 10.0), ++counted;
  return counted ? sum / counted : 0;
}

void find_begin(Comparison& c) {
  for (std::size_t k = 0; k < c.divergence.size(); ++k) {
    const double t = c.every * static_cast<double>(k), x = c.divergence[k];
    if (c.begins < 0 && x > noise) c.begins = t;
    const double errors = (k < c.error_a.size() ? c.error_a[k] : 0) + (k < c.error_b.size() ? c.error_b[k] : 0);
    if (c.beyond < 0 && x > noise && x > errors) c.beyond = t;
  }
}

Vector own_error(const Robot& robot, const Stepping& stepping, const State& start, double every, int moments, const Path& path) {
  if (integrators()[stepping.integrator].order == 0) return {};
  Stepping half = stepping;
  half.dt /= 2;
  const Path fine = run(robot, half, start, every, moments);
  Vector out = distances(shared_frames(robot, robot), path, fine, moments);
  for (double& x : out) x *= 2;  // of order 1 at least, as at impacts; higher orders err less
  return out;
}

Comparison explain_models(const Side& a, const Side& b, double duration) { return Pair(a, b, duration).explain(); }

}  // namespace cli::compare
