// Times of libdyn's algorithms through its C interface, in the form that bench/compare.py reads.
//
// usage: dyn_bench MODEL.urdf --fixed|--floating [--seconds S] [--rounds R] [--only a,b,c] [--json]
//
// Each call takes the next of 64 random states; results stay in the data, as in Pinocchio. A row is timed in R rounds that go
// over all rows, S seconds in all; ns_median is the median over the rounds of the medians over batches.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "dyn.h"

namespace {

constexpr int states = 64;

void require(dynStatus s) {
  if (s == DYN_OK) return;
  std::fprintf(stderr, "dyn_bench: %s: %s\n", dyn_status_name(s), dyn_last_error());
  std::exit(1);
}

double seconds_now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + std::ptrdiff_t(x.size() / 2), x.end());
  return x[x.size() / 2];
}

struct Row {
  std::string name;
  std::function<void(int)> call;  // with state k
  std::vector<double> rounds;     // median of each, ns
  double best = 1e300;

  void time(double budget) {
    long batch = 1;
    std::vector<double> samples;
    const double end = seconds_now() + budget;
    for (int k = 0; k < states; ++k) call(k);  // warm
    int next = 0;
    while (samples.size() < 5 || seconds_now() < end) {
      const double start = seconds_now();
      for (long i = 0; i < batch; ++i) call(next), next = (next + 1) % states;
      const double t = seconds_now() - start;
      if (t < 20e-6 && samples.empty()) {
        batch *= 2;
        continue;
      }
      samples.push_back(t / double(batch) * 1e9);
      if (samples.size() >= 5 && seconds_now() > end + budget) break;
    }
    rounds.push_back(median(samples));
    best = std::min(best, *std::min_element(samples.begin(), samples.end()));
  }
};

struct Bench {
  dynModel* m;
  dynData* d = nullptr;
  int nq, nv;
  std::vector<double> q, v, a, tau, x, columns, tensors;
  std::vector<Row> rows;

  explicit Bench(dynModel* model) : m(model), nq(dyn_nq(m)), nv(dyn_nv(m)) {
    // beyond 2000 degrees of freedom nothing of size nv x nv
    const bool small = nv <= 2000;
    const dynParts square = DYN_PART_MASS | DYN_PART_FACTOR | DYN_PART_MINV | DYN_PART_CORIOLIS | DYN_PART_REGRESSOR;
    require(dyn_data_new(m, small ? dynParts(DYN_PART_ALL) : DYN_PART_ALL & ~square, &d));
    for (int k = 0; k < states; ++k) {
      q.resize(q.size() + std::size_t(nq));
      std::vector<double> low(std::size_t(nq), -1), high(std::size_t(nq), 1);
      require(dyn_random(m, std::uint64_t(k + 1), low.data(), high.data(), q.data() + std::ptrdiff_t(k) * nq));
    }
    std::srand(1);
    for (auto* w : {&v, &a, &tau})
      for (int k = 0; k < states * nv; ++k) w->push_back(2.0 * std::rand() / RAND_MAX - 1);
    x.resize(std::size_t(std::max(nq, nv)));
    auto Q = [this](int k) { return q.data() + std::ptrdiff_t(k) * nq; };
    auto V = [this](int k) { return v.data() + std::ptrdiff_t(k) * nv; };
    auto A = [this](int k) { return a.data() + std::ptrdiff_t(k) * nv; };
    auto U = [this](int k) { return tau.data() + std::ptrdiff_t(k) * nv; };
    auto add = [&, this](const char* name, std::function<void(int)> f) {
      const std::string squares = ",rnea_derivatives,aba_derivatives,second_order_product,gravity_derivatives,static_torque_derivatives,crba,cholesky,solve,minv,all_terms,coriolis,torque_regressor,static_regressor,"
                                  "kinetic_energy_regressor,potential_energy_regressor,";
      if (small || squares.find("," + std::string(name) + ",") == std::string::npos) rows.push_back({name, std::move(f), {}});
    };
    add("fk", [=, this](int k) { dyn_forward_kinematics(m, d, Q(k), nullptr, nullptr); });
    add("fk_qva", [=, this](int k) { dyn_forward_kinematics(m, d, Q(k), V(k), A(k)); });
    add("jacobians", [=, this](int k) { dyn_joint_jacobians(m, d, Q(k), nullptr); });
    add("rnea", [=, this](int k) { dyn_rnea(m, d, Q(k), V(k), A(k), nullptr, nullptr); });
    add("nle", [=, this](int k) { dyn_nonlinear_effects(m, d, Q(k), V(k), nullptr); });
    add("gravity", [=, this](int k) { dyn_gravity(m, d, Q(k), nullptr); });
    add("aba", [=, this](int k) { dyn_aba(m, d, Q(k), V(k), U(k), nullptr, nullptr); });
    add("crba", [=, this](int k) { dyn_crba(m, d, Q(k), nullptr); });
    add("cholesky", [=, this](int k) {
      if (k == 0) dyn_crba(m, d, Q(0), nullptr);
      dyn_factorize(m, d);
    });
    add("solve", [=, this](int k) {
      if (k == 0) dyn_crba(m, d, Q(0), nullptr), dyn_factorize(m, d);
      dyn_solve(m, d, U(k), 1, x.data());
    });
    add("minv", [=, this](int k) { dyn_minverse(m, d, Q(k), nullptr); });
    add("com", [=, this](int k) { dyn_center_of_mass(m, d, Q(k), nullptr, nullptr, nullptr, nullptr, nullptr); });
    add("jcom", [=, this](int k) { dyn_center_of_mass_jacobian(m, d, Q(k), nullptr); });
    add("all_terms", [=, this](int k) {
      dyn_all_terms(m, d, DYN_TERM_ALL & ~unsigned(DYN_TERM_FACTOR | DYN_TERM_MINV | DYN_TERM_CORIOLIS | DYN_TERM_FRAMES), Q(k), V(k), nullptr);
    });
    add("integrate", [=, this](int k) { dyn_integrate(m, Q(k), V(k), x.data()); });
    add("difference", [=, this](int k) { dyn_difference(m, Q(k), Q((k + 1) % states), x.data()); });
    add("rnea_derivatives", [=, this](int k) { dyn_rnea_derivatives(m, d, Q(k), V(k), A(k), nullptr, nullptr, nullptr); });
    add("aba_derivatives", [=, this](int k) { dyn_aba_derivatives(m, d, Q(k), V(k), U(k), nullptr, nullptr, nullptr, nullptr); });
    add("gravity_derivatives", [=, this](int k) { dyn_gravity_derivatives(m, d, Q(k), nullptr); });
    add("static_torque_derivatives", [=, this](int k) { dyn_static_torque_derivatives(m, d, Q(k), nullptr, nullptr); });
    add("com_velocity_derivatives", [=, this](int k) { dyn_center_of_mass_velocity_derivatives(m, d, Q(k), V(k), nullptr, nullptr); });
    // of the last joint's frame, kinematics included
    int last = 0;
    for (int f = 0; f < dyn_nframes(m); ++f) {
      dynFrameInfo info{};
      info.struct_size = sizeof info;
      require(dyn_frame_info(m, f, &info));
      if (info.type == DYN_FRAME_JOINT && info.joint == dyn_njoints(m) - 1) last = f;
    }
    columns.resize(6 * std::size_t(nv) * std::size_t(std::max(3, nv <= 150 ? nv : 0)));
    add("frame_derivatives", [=, this](int k) {
      dyn_forward_kinematics(m, d, Q(k), V(k), A(k));
      dyn_frame_acceleration_derivatives(m, d, last, DYN_LOCAL, columns.data(), columns.data() + 6 * nv, columns.data() + 12 * nv);
    });
    if (nv <= 150) {
      add("kinematic_hessian", [=, this](int k) {
        dyn_forward_kinematics(m, d, Q(k), nullptr, nullptr);
        dyn_frame_kinematic_hessian(m, d, last, DYN_LOCAL, columns.data());
      });
    }
    add("second_order_product", [=, this](int k) {
      dyn_rnea_second_order_product(m, d, Q(k), V(k), A(k), nullptr, U(k), nullptr, nullptr, nullptr, nullptr);
    });
    if (nv <= 150) {
      tensors.resize(4 * std::size_t(nv) * std::size_t(nv) * std::size_t(nv));
      const std::ptrdiff_t cube = std::ptrdiff_t(nv) * nv * nv;
      add("second_order", [=, this](int k) {
        double* x = tensors.data();
        dyn_rnea_second_order_derivatives(m, d, Q(k), V(k), A(k), nullptr, x, x + cube, x + 2 * cube, x + 3 * cube);
      });
    }
    add("coriolis", [=, this](int k) { dyn_coriolis_matrix(m, d, Q(k), V(k), nullptr); });
    add("djacobians", [=, this](int k) { dyn_joint_jacobians_time_variation(m, d, Q(k), V(k), nullptr); });
    add("kinetic_energy", [=, this](int k) { dyn_kinetic_energy(m, d, Q(k), V(k), nullptr); });
    add("potential_energy", [=, this](int k) { dyn_potential_energy(m, d, Q(k), nullptr); });
    add("centroidal_map", [=, this](int k) { dyn_centroidal_map(m, d, Q(k), V(k), nullptr, nullptr, nullptr); });
    add("centroidal_map_rate", [=, this](int k) { dyn_centroidal_map_time_variation(m, d, Q(k), V(k), nullptr); });
    add("centroidal_momentum", [=, this](int k) { dyn_centroidal_momentum(m, d, Q(k), V(k), nullptr); });
    add("centroidal_momentum_rate", [=, this](int k) { dyn_centroidal_momentum_rate(m, d, Q(k), V(k), A(k), nullptr); });
    add("centroidal_derivatives", [=, this](int k) { dyn_centroidal_derivatives(m, d, Q(k), V(k), A(k), nullptr, nullptr, nullptr, nullptr); });
    add("torque_regressor", [=, this](int k) { dyn_joint_torque_regressor(m, d, Q(k), V(k), A(k), nullptr); });
    add("static_regressor", [=, this](int k) { dyn_static_regressor(m, d, Q(k), nullptr); });
    add("kinetic_energy_regressor", [=, this](int k) { dyn_kinetic_energy_regressor(m, d, Q(k), V(k), nullptr); });
    add("potential_energy_regressor", [=, this](int k) { dyn_potential_energy_regressor(m, d, Q(k), nullptr); });
  }
};

[[noreturn]] void usage() {
  std::fprintf(stderr, "usage: dyn_bench MODEL.urdf --fixed|--floating [--seconds S] [--rounds R] [--only a,b,c] [--json]\n");
  std::exit(2);
}

}  // namespace

int main(int argc, char** argv) {
  std::string path, only;
  double seconds = 0.25;
  int rounds = 5;
  dynLoadOptions options;
  dyn_load_options_init(&options);
  for (int k = 1; k < argc; ++k) {
    const std::string s = argv[k];
    auto value = [&] { return ++k < argc ? argv[k] : (usage(), ""); };
    if (s == "--fixed") options.base = DYN_BASE_FIXED;
    else if (s == "--floating") options.base = DYN_BASE_FLOATING;
    else if (s == "--seconds") seconds = std::atof(value());
    else if (s == "--rounds") rounds = std::atoi(value());
    else if (s == "--only") only = "," + std::string(value()) + ",";
    else if (s == "--json") continue;
    else if (s[0] == '-' || !path.empty()) usage();
    else path = s;
  }
  if (path.empty() || !(seconds > 0) || rounds < 1) usage();
  dynModel* m = nullptr;
  require(dyn_model_load(path.c_str(), &options, &m));
  Bench bench(m);
  auto wanted = [&](const Row& r) { return only.empty() || only.find("," + r.name + ",") != std::string::npos; };
  for (int r = 0; r < rounds; ++r)
    for (Row& row : bench.rows)
      if (wanted(row)) row.time(seconds / rounds);
  std::printf("{\"library\":\"libdyn\",\"version\":\"%s\",\"compiler\":\"%s\",\"flags\":\"as shipped\",\"model\":\"%s\",\"nq\":%d,\"nv\":%d,\"rows\":[", dyn_version(),
              dyn_build_info(), dyn_model_name(m), bench.nq, bench.nv);
  bool first = true;
  for (const Row& row : bench.rows) {
    if (!wanted(row)) continue;
    std::printf("%s\n{\"name\":\"%s\",\"ns_median\":%.2f,\"ns_min\":%.2f}", first ? "" : ",", row.name.c_str(), median(row.rounds), row.best);
    first = false;
  }
  std::printf("]}\n");
  dyn_data_free(bench.d);
  dyn_model_free(m);
}
