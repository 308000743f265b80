// Times libdyn's C calls beside functions of the same names in shared objects that bench/generated_code.py makes.
//
// usage: time MODEL.urdf --fixed|--floating ROUNDS FOLDER COMPILER... -- ALGORITHM...
//
// FOLDER/ALGORITHM_COMPILER.so has the function ALGORITHM of (q, v, a or tau) with CasADi's C signature. Its results are compared
// with libdyn's in each of the 64 states first. In a round each call is timed once, 64 states for 200 us or more, the programs in
// turn; a time is the median over the rounds. Output: JSON, ns of a call by algorithm and program, and the largest difference
// relative to the largest entry.
#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "../rows.hpp"

namespace {

using bench::require, bench::states;
using Matrix = std::vector<double>;

// A function of CasADi's C, with its work arrays and results.
class Generated {
 public:
  Generated(const std::string& file, const std::string& name) {
    void* const object = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!object) std::fprintf(stderr, "time: %s\n", dlerror()), std::exit(1);
    const auto symbol = [&](const char* end) {
      void* const s = dlsym(object, (name + end).c_str());
      if (!s) std::fprintf(stderr, "time: %s has no %s%s\n", file.c_str(), name.c_str(), end), std::exit(1);
      return s;
    };
    call_ = reinterpret_cast<Call>(symbol(""));
    sparsity_ = reinterpret_cast<const long long* (*)(long long)>(symbol("_sparsity_out"));
    long long arguments = 0, results = 0, integers = 0, reals = 0;
    using Work = int (*)(long long*, long long*, long long*, long long*);
    reinterpret_cast<Work>(symbol("_work"))(&arguments, &results, &integers, &reals);
    outputs = int(reinterpret_cast<long long (*)()>(symbol("_n_out"))());
    arguments_.resize(std::size_t(arguments)), results_.resize(std::size_t(results));
    integers_.resize(std::size_t(integers)), reals_.resize(std::size_t(reals)), values_.resize(std::size_t(outputs));
    for (int k = 0; k < outputs; ++k) {
      const long long *s = sparsity_(k), columns = s[1];
      values_[std::size_t(k)].resize(std::size_t(s[2] == 1 ? s[0] * columns : s[2 + columns]));  // 1: dense
      results_[std::size_t(k)] = values_[std::size_t(k)].data();
    }
  }
  void operator()(const double* q, const double* v, const double* a) {
    arguments_[0] = q, arguments_[1] = v, arguments_[2] = a;
    call_(arguments_.data(), results_.data(), integers_.data(), reals_.data(), 0);
  }
  // Largest difference of result k from want, by columns, over want's largest entry.
  double difference(int k, const Matrix& want) const {
    const long long *s = sparsity_(k), rows = s[0], columns = s[1];
    const std::vector<double>& x = values_[std::size_t(k)];
    double worst = 0, largest = 1e-300;
    const auto see = [&](long long i, long long j, double y) {
      const double w = want[std::size_t(j * rows + i)];
      largest = std::max(largest, std::abs(w)), worst = std::max(worst, std::isnan(y) ? INFINITY : std::abs(y - w));
    };
    std::size_t next = 0;
    for (long long j = 0; j < columns; ++j)
      if (s[2] == 1)
        for (long long i = 0; i < rows; ++i) see(i, j, x[next++]);
      else
        for (long long e = s[2 + j]; e < s[3 + j]; ++e) see(s[3 + columns + e], j, x[next++]);
    return worst / largest;
  }

  int outputs = 0;

 private:
  using Call = int (*)(const double**, double**, long long*, double*, int);
  Call call_;
  const long long* (*sparsity_)(long long);
  std::vector<const double*> arguments_;
  std::vector<double*> results_;
  std::vector<long long> integers_;
  std::vector<double> reals_;
  std::vector<std::vector<double>> values_;
};

// libdyn's results in state k, in the order of the generated function's.
std::vector<Matrix> results(const std::string& name, const dynModel* m, dynData* d, const bench::Robot& r, int k) {
  const std::size_t n = std::size_t(r.nv);
  Matrix x(n), A(n * n), B(n * n), C(n * n);
  if (name == "crba") {
    require(dyn_crba(m, d, r.Q(k), A.data()));
    return {A};
  }
  if (name == "aba" || name == "aba_derivatives") require(dyn_aba(m, d, r.Q(k), r.V(k), r.U(k), nullptr, x.data()));
  else require(dyn_rnea(m, d, r.Q(k), r.V(k), r.A(k), nullptr, x.data()));
  if (name == "rnea" || name == "aba") return {x};
  if (name == "rnea_derivatives") {
    require(dyn_rnea_derivatives(m, d, r.Q(k), r.V(k), r.A(k), nullptr, A.data(), B.data()));
    require(dyn_crba(m, d, r.Q(k), C.data()));
  } else {
    dynAbaDerivatives out;
    dyn_aba_derivatives_init(&out);
    out.ddq_dq = A.data(), out.ddq_dv = B.data(), out.ddq_dtau = C.data();
    require(dyn_aba_derivatives(m, d, r.Q(k), r.V(k), r.U(k), nullptr, &out));
  }
  return {A, B, C, x};
}

double ns_of(const std::function<void(int)>& call) {
  using clock = std::chrono::steady_clock;
  long calls = 0;
  const auto start = clock::now();
  double ns = 0;
  do {
    for (int k = 0; k < states; ++k) call(k);
    calls += states, ns = std::chrono::duration<double, std::nano>(clock::now() - start).count();
  } while (ns < 200e3);
  return ns / double(calls);
}

double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 8) {
    std::fprintf(stderr, "usage: time MODEL.urdf --fixed|--floating ROUNDS FOLDER COMPILER... -- ALGORITHM...\n");
    return 2;
  }
  const std::vector<std::string> all(argv + 5, argv + argc);
  const auto middle = std::find(all.begin(), all.end(), "--");
  const std::vector<std::string> compilers(all.begin(), middle), algorithms(middle == all.end() ? middle : middle + 1, all.end());
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = argv[2] == std::string("--floating") ? DYN_BASE_FLOATING : DYN_BASE_FIXED;
  options.meshes = DYN_MESH_USE_NONE;
  const int rounds = std::atoi(argv[3]);
  dynModel* m = nullptr;
  require(dyn_model_load(argv[1], &options, &m));
  dynData* d = nullptr;
  require(dyn_data_new(m, DYN_PART_ALL, &d));
  bench::Robot robot(m, "");
  const char* separator = "{";
  for (const std::string& name : algorithms) {
    const auto row = std::find_if(robot.rows.begin(), robot.rows.end(), [&](const bench::Row& r) { return r.name == name; });
    const bool forward = name.starts_with("aba");
    std::vector<std::pair<std::string, std::function<void(int)>>> calls{{"libdyn", row->call}};
    double difference = 0;
    std::vector<Generated> generated;
    for (const std::string& c : compilers) generated.emplace_back(std::string(argv[4]) + "/" + name + "_" + c + ".so", name);
    for (std::size_t c = 0; c < compilers.size(); ++c) {
      Generated& f = generated[c];
      const auto call = [&](int k) { f(robot.Q(k), robot.V(k), forward ? robot.U(k) : robot.A(k)); };
      for (int k = 0; k < states; ++k) {
        call(k);
        const std::vector<Matrix> want = results(name, m, d, robot, k);
        for (int o = 0; o < f.outputs; ++o) difference = std::max(difference, f.difference(o, want[std::size_t(o)]));
      }
      calls.emplace_back(compilers[c], call);
    }
    std::map<std::string, std::vector<double>> times;
    for (const auto& [program, call] : calls) ns_of(call);
    for (int r = 0; r < rounds; ++r)
      for (const auto& [program, call] : calls) times[program].push_back(ns_of(call));
    std::printf("%s\"%s\": {\"difference\": %.3g", separator, name.c_str(), difference);
    for (const auto& [program, ns] : times) std::printf(", \"%s\": %.2f", program.c_str(), median(ns));
    std::printf("}"), separator = ",\n ";
  }
  std::printf("}\n");
}
