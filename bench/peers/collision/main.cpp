// Distance and contact queries of libdyn, Coal, MuJoCo and libccd on the same poses, in batches, turn by turn; as JSON, a line
// for each pair of shapes and class of poses.   usage: collision_bench [--adversarial N] [--contacts] [part of a pair's name]
// --contacts: contact queries alone
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>

#include "collision/surfaces.hpp"
#include "collision/survey.hpp"
#include "engine.hpp"

namespace {

using namespace dyn_bench;

// the true distance: within the bounds of the planes apart, and no deeper than brute force finds
double truth(const Scene& s) {
  collision::Options exact;
  exact.tolerance = 1e-15;
  const dyn_test::Result r = query(s, exact);
  const bool deep = r.distance < 0 && s.a.shape.type != Type::HalfSpace && s.b.shape.type != Type::HalfSpace;
  if (!deep) return r.distance;
  const double least = BruteForce(s).depth();
  return least < -r.distance * (1 - 1e-6) ? -least : r.distance;
}

struct Score {
  double ns = NAN, worst = 0;
  int asked = 0, wrong = 0;  // wrong: off by more than a thousandth of the size, or not a number
  void add(double found, double truth, double size, bool depths_only) {
    if (depths_only && truth > 0 && !(found < 0)) return;  // apart, and said so
    if (depths_only && !(found < 0)) found = 0;
    ++asked;
    if (found == truth) return;  // infinite, too
    if (std::isnan(truth)) return;  // each engine has a depth of meshes of its own
    const double error = std::abs(found - truth) / size;
    if (error <= 1e-3)
      worst = std::max(worst, error);
    else
      ++wrong;
  }
};

void print(const std::string& pair, const char* poses, const std::vector<std::unique_ptr<Engine>>& engines,
           const std::vector<Score>& scores) {
  std::printf("{\"pair\": \"%s\", \"poses\": \"%s\"", pair.c_str(), poses);
  for (std::size_t e = 0; e < engines.size(); ++e) {
    const Score& s = scores[e];
    if (s.asked == 0) continue;
    std::printf(", \"%s\": {\"asked\": %d, \"wrong\": %d, \"error\": %.2g", engines[e]->name(), s.asked, s.wrong, s.worst);
    if (!std::isnan(s.ns)) std::printf(", \"ns\": %.4g", s.ns);
    std::printf("}");
  }
  std::printf("}\n");
  std::fflush(stdout);
}

// the least over passes of the mean time; of quick pairs more passes, until a twentieth of a second has gone
void measure(const PairOfShapes& pair, const std::vector<Scene>& scenes, const std::vector<double>& truths,
             std::vector<std::unique_ptr<Engine>>& engines, std::vector<Score>& scores, bool contacts = false) {
  std::vector<double> found(scenes.size());
  const auto ask = [&](Engine& e) {
    if (contacts) return e.contacts(found.data());
    return e.ask(found.data()), true;
  };
  std::vector<bool> loaded;
  for (std::size_t e = 0; e < engines.size(); ++e) {
    loaded.push_back(engines[e]->load(pair.a, pair.b));
    if (!loaded[e]) continue;
    engines[e]->place(scenes);
    loaded[e] = ask(*engines[e]);
    for (std::size_t i = 0; i < scenes.size() && loaded[e]; ++i)
      scores[e].add(found[i], truths[i], smaller(scenes[i]), engines[e]->depths_only());
    if (loaded[e]) scores[e].ns = shape::infinity;
  }
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(50);
  for (int k = 0; k < passes || Clock::now() < end; ++k)
    for (std::size_t e = 0; e < engines.size(); ++e) {
      if (!loaded[e]) continue;
      const auto start = Clock::now();
      ask(*engines[e]);
      const std::chrono::duration<double, std::nano> t = Clock::now() - start;
      scores[e].ns = std::min(scores[e].ns, t.count() / double(scenes.size()));
    }
}

bool round_core(const Solid& s) { return s.shape.type == Type::Sphere || s.shape.type == Type::Capsule || s.shape.radius == 0; }

// Touching, aligned, coincident, of extreme sizes, thin, far from the origin, deep; without the roundings that only libdyn has.
void adversarial(Type a, Type b, int count, std::vector<std::unique_ptr<Engine>>& engines, std::vector<Score>& scores) {
  for (int c = 1; c < int(Case::count); ++c)
    for (int i = 0; i < count; ++i) {
      const Scene s = scene(a, b, Case(c), std::uint64_t(i));
      if (!round_core(s.a) || !round_core(s.b)) continue;
      const double d = truth(s);
      if (!std::isfinite(d)) continue;
      for (std::size_t e = 0; e < engines.size(); ++e) {
        double found = NAN;
        try {
          if (!engines[e]->load(s.a, s.b)) continue;
          engines[e]->place({s});
          engines[e]->ask(&found);
        } catch (const std::exception&) {
        }
        scores[e].add(found, d, smaller(s), engines[e]->depths_only());
      }
    }
}

// Contact queries of a pair: apart, near, penetrating, and at rest on each other.
void contact_queries(const std::string& name, const PairOfShapes& pair, std::vector<std::unique_ptr<Engine>>& engines) {
  static const char* const names[classes + 1] = {"contacts apart", "contacts near", "contacts penetrating", "contacts at rest"};
  for (int c = 0; c <= classes; ++c) {
    const std::vector<Scene> scenes = c < classes ? pair.scenes[c] : at_rest(pair);
    std::vector<double> truths;
    for (const Scene& s : scenes) {
      const double d = truth(s);
      truths.push_back(d > 0 ? shape::infinity : d);
    }
    std::vector<Score> scores(engines.size());
    measure(pair, scenes, truths, engines, scores, true);
    print(name, names[c], engines, scores);
  }
}

// Poses of a mesh's pair by how far its distance is.
PairOfShapes mesh_pair(const Solid& mesh, const Solid& other) {
  static constexpr double low[] = {0.1, 1e-4, -0.05}, high[] = {2, 0.05, -1e-4};
  PairOfShapes pair = {mesh, other, {}};
  for (std::uint64_t k = 0; k < 3000; ++k) {
    Chance g(k);
    Scene s = {mesh, other, {g.rotation(), g.direction()}, {g.rotation(), Vec::zero()}};
    s.B.p = s.A.p + g.direction() * g.uniform(0.2, 2.5);
    const double d = query(s).distance;
    for (int c = 0; c < classes; ++c)
      if (low[c] <= d && d <= high[c] && pair.scenes[c].size() < 200) pair.scenes[c].push_back(s);
  }
  return pair;
}

// Rings of triangles beside other shapes and themselves.
void meshes(const char* part, std::vector<std::unique_ptr<Engine>>& engines, const char* const* names) {
  for (const auto& [n, m] : {std::pair<Index, Index>{24, 12}, {200, 100}}) {
    Faceted ring;
    ring_mesh(ring, n, m);
    const Solid mesh = {ring.shape, nullptr};
    for (const Solid& other : {sphere(0.1), capsule(0.1, 0.3), box(0.2, 0.3, 0.4), cylinder(0.1, 0.3), mesh}) {
      const std::string name = std::to_string(ring.count()) + " triangles-" +
                               (other.shape.type == Type::Triangles ? "the same" : name_of(other.shape.type));
      if (name.find(part) == std::string::npos) continue;
      const PairOfShapes pair = mesh_pair(mesh, other);
      for (int c = 0; c < classes; ++c) {
        std::vector<double> truths;
        for (const Scene& s : pair.scenes[c]) truths.push_back(c == Penetrating ? NAN : truth(s));
        std::vector<Score> scores(engines.size());
        if (!truths.empty()) measure(pair, pair.scenes[c], truths, engines, scores);
        print(name, names[c], engines, scores);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  int count = 20;
  const char* part = "";
  bool contacts_only = false;
  for (int i = 1; i < argc; ++i)
    if (!std::strcmp(argv[i], "--adversarial") && i + 1 < argc)
      count = std::atoi(argv[++i]);
    else if (!std::strcmp(argv[i], "--contacts"))
      contacts_only = true;
    else
      part = argv[i];
  std::vector<std::unique_ptr<Engine>> engines;
  engines.push_back(make_dyn()), engines.push_back(make_coal()), engines.push_back(make_mujoco()), engines.push_back(make_ccd());
  static const char* const names[classes] = {"apart", "near", "penetrating"};
  for (int a = 0; a < shape::type_count; ++a)
    for (int b = std::max(a, 1); b < shape::type_count; ++b) {
      const std::string name = std::string(name_of(Type(a))) + "-" + name_of(Type(b));
      if (name.find(part) == std::string::npos) continue;
      const PairOfShapes pair = make_pair(Type(a), Type(b));
      contact_queries(name, pair, engines);
      if (contacts_only) continue;
      for (int c = 0; c < classes; ++c) {
        std::vector<double> truths;
        for (const Scene& s : pair.scenes[c]) truths.push_back(truth(s));
        std::vector<Score> scores(engines.size());
        measure(pair, pair.scenes[c], truths, engines, scores);
        print(name, names[c], engines, scores);
      }
      if (count == 0) continue;
      std::vector<Score> scores(engines.size());
      adversarial(Type(a), Type(b), count, engines, scores);
      print(name, "adversarial", engines, scores);
    }
  if (!contacts_only) meshes(part, engines, names);
}
