// Times of libdyn's algorithms through its C interface, in the form that bench/compare.py reads.
//
// usage: dyn_bench MODEL.urdf --fixed|--floating [--seconds S] [--rounds R] [--only a,b,c] [--joint NAME] [--count] [--json]
//
// Each call takes the next of 64 random states; results stay in the data, as in Pinocchio. A row is timed in R rounds that go
// over all rows, S seconds in all; ns_median is the median over the rounds of the medians over batches. Rows about one frame are
// about that of joint NAME (default: the last one), kinematics included. With --count, instead of times: "instructions" of a
// call, on the first state.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "count.hpp"
#include "rows.hpp"

namespace {

using bench::Row, bench::require, bench::states;

double seconds_now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + std::ptrdiff_t(x.size() / 2), x.end());
  return x[x.size() / 2];
}

void time_round(Row& row, double budget) {
  if (row.prepare) row.prepare();
  long batch = 1;
  std::vector<double> samples;
  const double end = seconds_now() + budget;
  int next = 0;
  auto sample = [&] {
    const double start = seconds_now();
    for (long i = 0; i < batch; ++i) row.call(next), next = (next + 1) % states;
    return seconds_now() - start;
  };
  const double warm = seconds_now() + 0.15 * budget;
  do sample();
  while (seconds_now() < warm);
  while (samples.size() < 3 || seconds_now() < end) {
    const double t = sample();
    if (t < 20e-6 && samples.empty()) {
      batch *= 2;
      continue;
    }
    samples.push_back(t / double(batch) * 1e9);
  }
  row.rounds.push_back(median(samples));
  row.best = std::min(row.best, *std::min_element(samples.begin(), samples.end()));
}

long instructions(const Row& row) {
  if (row.prepare) row.prepare();
  row.call(1);
  const long n = bench::instructions([&] { row.call(0); });
  if (n < 0) std::fprintf(stderr, "dyn_bench: --count: this system does not let a process trace its child\n"), std::exit(1);
  return n;
}

[[noreturn]] void usage() {
  std::fprintf(stderr,
               "usage: dyn_bench MODEL.urdf --fixed|--floating [--seconds S] [--rounds R] [--only a,b,c] [--joint NAME] "
               "[--count] [--json]\n");
  std::exit(2);
}

}  // namespace

int main(int argc, char** argv) {
  std::string path, only, joint;
  double seconds = 0.25;
  int rounds = 5;
  bool counting = false;
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
    else if (s == "--joint") joint = value();
    else if (s == "--count") counting = true;
    else if (s == "--json") continue;
    else if (s[0] == '-' || !path.empty()) usage();
    else path = s;
  }
  if (path.empty() || !(seconds > 0) || rounds < 1) usage();

  dynModel* m = nullptr;
  require(dyn_model_load(path.c_str(), &options, &m));
  {
    bench::Robot robot(m, joint);
    if (!only.empty())
      std::erase_if(robot.rows, [&](const Row& r) { return only.find("," + r.name + ",") == std::string::npos; });
    if (robot.rows.empty()) std::fprintf(stderr, "dyn_bench: --only names no known row\n"), std::exit(1);
    for (int r = 0; r < rounds && !counting; ++r)
      for (Row& row : robot.rows) time_round(row, seconds / rounds);

    std::printf(
        "{\"library\":\"libdyn\",\"version\":\"%s\",\"compiler\":\"%s\",\"flags\":\"as "
        "shipped\",\"model\":\"%s\",\"nq\":%d,\"nv\":%d,\"rows\":[",
        dyn_version(), dyn_build_info(), dyn_model_name(m), robot.nq, robot.nv);
    const char* separator = "\n";
    for (Row& row : robot.rows) {
      std::printf("%s{\"name\":\"%s\",", separator, row.name.c_str());
      if (counting) std::printf("\"instructions\":%ld}", instructions(row));
      else std::printf("\"ns_median\":%.2f,\"ns_min\":%.2f}", median(row.rounds), row.best);
      separator = ",\n";
    }
    std::printf("]}\n");
  }
  dyn_model_free(m);
}
