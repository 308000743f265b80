#include "accuracy/distance_sweep.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

namespace cli {
namespace {

using Placement = std::array<double, 12>;
using Mesh = std::unique_ptr<dynMesh, Deleter<dyn_mesh_free>>;

struct Query {
  const dynGeometry *a, *b;
  Placement A, B;
};
using Queries = std::vector<Query>;

// X Y of placements [R p], columns first
Placement product(const double* X, const double* Y) {
  Placement Z;
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t r = 0; r < 3; ++r) {
      Z[3 * c + r] = c == 3 ? X[9 + r] : 0;
      for (std::size_t k = 0; k < 3; ++k) Z[3 * c + r] += X[3 * k + r] * Y[3 * c + k];
    }
  return Z;
}

// A robot's collision shapes by themselves.
struct Shapes {
  std::vector<dynShapeInfo> info;
  std::vector<dynGeometry> geometry;
  std::vector<Mesh> meshes;

  explicit Shapes(const Robot& robot) : info(std::size_t(dyn_model_nshapes(robot))), geometry(info.size()) {
    for (std::size_t k = 0; k < info.size(); ++k) {
      dynShapeInfo& s = info[k];
      dynGeometry& g = geometry[k];
      s.struct_size = sizeof s;
      check(dyn_model_shape_info(robot, int(k), &s));
      dyn_geometry_init(&g);
      g.type = s.type, g.radius = s.radius;
      if (s.type != DYN_SHAPE_TYPE_CONVEX && s.type != DYN_SHAPE_TYPE_TRIANGLES && s.type != DYN_SHAPE_TYPE_HEIGHT_FIELD) {
        std::copy(s.size, s.size + 3, g.size);
        continue;
      }
      dynMesh* mesh = nullptr;
      check(dyn_model_shape_mesh(robot, int(k), &mesh));
      meshes.emplace_back(mesh);
      g.surface = mesh;
    }
  }
};

std::map<std::string, Queries> queries_by_kind(const Robot& robot, const Shapes& shapes, const std::vector<Vector>& states) {
  const Data data(robot, DYN_PART_COLLISION);
  const std::vector<int> pairs = tested_pairs(robot, data);
  std::map<std::string, Queries> out;
  std::vector<Placement> X(shapes.info.size());
  for (const Vector& q : states) {
    check(dyn_forward_kinematics(robot, data, q.data(), nullptr, nullptr));
    for (std::size_t k = 0; k < X.size(); ++k) {
      double frame[12];
      check(dyn_frame_placement(robot, data, shapes.info[k].frame, frame));
      X[k] = product(frame, shapes.info[k].placement);
    }
    for (const int pair : pairs) {
      int first, second;
      check(dyn_model_pair(robot, pair, &first, &second, nullptr));
      const std::size_t a = std::size_t(first), b = std::size_t(second);
      const auto [low, high] =
          std::minmax<std::string>(shape_type_name(shapes.info[a].type), shape_type_name(shapes.info[b].type));
      out[low + "-" + high].push_back({&shapes.geometry[a], &shapes.geometry[b], X[a], X[b]});
    }
  }
  return out;
}

bool ask(const Query& x, const dynDistanceOptions& options, dynDistance& out) {
  return dyn_geometry_distance(x.a, x.A.data(), x.b, x.B.data(), &options, &out) == DYN_OK &&
         out.status != DYN_DISTANCE_STATUS_FAILED && !std::isnan(out.distance);
}

double median(Vector x) {
  if (x.empty()) return 0;
  const auto middle = x.begin() + std::ptrdiff_t(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}

// One method at one tolerance on the queries of one kind: what it answers, and the seconds of all of them in each run.
struct Trial {
  dynDistanceOptions options;
  Vector errors, seconds;
  int queries, failed = 0, by_method = 0;

  Trial(const dynDistanceOptions& o, const Queries& queries_, const Vector& exact) : options(o), queries(int(queries_.size())) {
    for (std::size_t k = 0; k < queries_.size(); ++k) {
      dynDistance d{};
      d.struct_size = sizeof d;
      if (!ask(queries_[k], options, d)) {
        ++failed;
        continue;
      }
      by_method += d.method == options.method;
      errors.push_back(d.distance == exact[k] ? 0 : std::abs(d.distance - exact[k]));  // of infinite ones, too
    }
  }
  // few queries are asked several times over: the clock has to see them
  void time(const Queries& of) {
    using Clock = std::chrono::steady_clock;
    const std::size_t repeats = 1 + 200 / of.size();
    dynDistance d{};
    d.struct_size = sizeof d;
    const Clock::time_point start = Clock::now();
    for (std::size_t r = 0; r < repeats; ++r)
      for (const Query& x : of) ask(x, options, d);
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count() / double(repeats));
  }
  void add(const Trial& t) {
    errors.insert(errors.end(), t.errors.begin(), t.errors.end());
    for (std::size_t k = 0; k < seconds.size(); ++k) seconds[k] += t.seconds[k];
    queries += t.queries, failed += t.failed, by_method += t.by_method;
  }
  DistanceCost cost(const std::string& kind) const {
    return {kind,
            options.method,
            options.tolerance,
            errors.empty() ? 0 : *std::max_element(errors.begin(), errors.end()),
            median(errors),
            median(seconds) / queries,
            queries,
            failed,
            by_method};
  }
};

std::vector<dynDistanceOptions> settings(const Query& any) {
  std::vector<dynDistanceOptions> out;
  dynDistance d{};
  d.struct_size = sizeof d;
  for (const Choice& method : choices("dynDistanceMethod"))
    for (int digits = 2; digits <= 12; ++digits) {
      dynDistanceOptions o;
      dyn_distance_options_init(&o);
      o.method = static_cast<dynDistanceMethod>(method.value), o.tolerance = std::pow(10.0, -digits);
      if (dyn_geometry_distance(any.a, any.A.data(), any.b, any.B.data(), &o, &d) != DYN_ERROR_UNSUPPORTED) out.push_back(o);
    }
  return out;
}

std::vector<Trial> trials(const Queries& queries, int runs) {
  dynDistanceOptions reference;
  dyn_distance_options_init(&reference);
  reference.tolerance = distance_reference;
  Vector exact;
  for (const Query& x : queries) {
    dynDistance d{};
    d.struct_size = sizeof d;
    check(dyn_geometry_distance(x.a, x.A.data(), x.b, x.B.data(), &reference, &d));
    exact.push_back(d.distance);
  }
  std::vector<Trial> out;
  for (const dynDistanceOptions& o : settings(queries.front())) out.emplace_back(o, queries, exact);
  for (int run = 0; run < runs; ++run)  // turn by turn: a drift of the machine hits all alike
    for (Trial& t : out) t.time(queries);
  return out;
}

}  // namespace

std::vector<DistanceCost> distance_sweep(const Robot& robot, const std::vector<Vector>& states, int runs) {
  const Shapes shapes(robot);
  std::vector<DistanceCost> out;
  std::vector<Trial> all;
  for (const auto& [kind, queries] : queries_by_kind(robot, shapes, states)) {
    const std::vector<Trial> of_kind = trials(queries, runs);
    for (const Trial& t : of_kind) out.push_back(t.cost(kind));
    if (all.empty())
      all = of_kind;
    else
      for (std::size_t k = 0; k < all.size(); ++k) all[k].add(of_kind[k]);
  }
  for (const Trial& t : all) out.push_back(t.cost("all"));
  return out;
}

json sweep_json(const std::vector<DistanceCost>& sweep) {
  json out = json::array();
  for (const DistanceCost& c : sweep)
    out.push_back({{"kind", c.kind},
                   {"method", name_of("dynDistanceMethod", c.method)},
                   {"tolerance", c.tolerance},
                   {"max_error", c.max_error},
                   {"median_error", c.median_error},
                   {"wall_s", c.wall_s},
                   {"queries", c.queries},
                   {"failed", c.failed},
                   {"by_method", c.by_method}});
  return out;
}

std::string sweep_text(const std::vector<DistanceCost>& sweep) {
  std::vector<std::vector<std::string>> rows = {
      {"pairs", "method", "tolerance", "largest error m", "median m", "ns a query", "failed", "by method"}};
  for (const DistanceCost& c : sweep)
    if (c.by_method > 0)
      rows.push_back({c.kind, name_of("dynDistanceMethod", c.method), short_number(c.tolerance, 2), short_number(c.max_error, 2),
                      short_number(c.median_error, 2), short_number(std::round(c.wall_s * 1e9)), std::to_string(c.failed),
                      std::to_string(c.by_method) + " of " + std::to_string(c.queries)});
  return table(rows);
}

}  // namespace cli
